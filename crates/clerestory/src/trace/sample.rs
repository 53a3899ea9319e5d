//! A sample: what rays can meet in it.

use crate::error::{Error, Result};
use crate::geometry::{Area, Geometry};
use crate::material::{Material, Medium, Surface};

/// Layers of geometry with their surfaces, materials and media.
pub struct Sample {
    /// Names of the bands; all spectral values are in their order.
    pub bands: Vec<String>,
    /// From the exterior to the interior, their depths not overlapping.
    pub layers: Vec<Box<dyn Geometry>>,
    /// What the pieces of the layers refer to.
    pub surfaces: Vec<Surface>,
    /// What the surfaces refer to.
    pub materials: Vec<Material>,
    /// What the surfaces refer to; the first fills the space about the sample.
    pub media: Vec<Medium>,
}

impl Sample {
    /// Least and greatest z (metres).
    pub fn depth(&self) -> [f64; 2] {
        let depths = || self.layers.iter().map(|l| l.depth());
        [
            depths().map(|d| d[0]).fold(f64::INFINITY, f64::min),
            depths().map(|d| d[1]).fold(f64::NEG_INFINITY, f64::max),
        ]
    }

    /// Where rays start. Layers of different periods are covered over many of them, so that every shift of one against the
    /// other has its share.
    pub fn area(&self) -> Result<Area> {
        let first = self
            .layers
            .first()
            .ok_or_else(|| Error::Missing("the sample has no layers (give at least one)".into()))?;
        if let [_] = self.layers[..] {
            return Ok(first.area());
        }
        let side = |axis: usize| {
            let periods: Vec<f64> = self
                .layers
                .iter()
                .map(|l| l.period()[axis])
                .filter(|p| *p > 0.0)
                .collect();
            let greatest = periods.iter().copied().fold(0.0, f64::max);
            if greatest.is_infinite() {
                return None;
            }
            // The least common multiple, if there is one within reason.
            let common = (1..=64)
                .map(|k| greatest * f64::from(k))
                .find(|side| periods.iter().all(|p| ((side / p).round() - side / p).abs() < 1e-6));
            Some([0.0, common.unwrap_or(64.0 * greatest)])
        };
        match (side(0), side(1)) {
            (Some(x), Some(y)) => Ok(Area { x, y }),
            _ => Err(Error::Unsupported(
                "layers of which one is not repeated cannot be put together (give its period)".into(),
            )),
        }
    }
}
