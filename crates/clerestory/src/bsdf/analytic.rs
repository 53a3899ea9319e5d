//! Models with a formula: an ideal diffuser and ideal beams.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{Estimate, Part, Peak, Sample, Scatterer, Slab};
use crate::basis::Basis;
use crate::direction::{Disk, Scatter};
use crate::error::{Error, Result};

/// Ideal diffuser (Lambert): the same BSDF for all directions. Energy-conserving and reciprocal for values up to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambertian {
    value: f64,
}

impl Lambertian {
    /// From its direct-hemispherical transmittance or reflectance.
    pub fn new(value: f64) -> Result<Self> {
        check(&[value]).map(|()| Self { value })
    }

    /// Direct-hemispherical value.
    pub fn value(&self) -> f64 {
        self.value
    }
}

impl Scatterer for Lambertian {
    fn evaluate(&self, _: Disk, _: Disk) -> f64 {
        self.value / PI
    }

    fn peaks(&self, _: Disk) -> Vec<Peak> {
        Vec::new()
    }

    fn sample(&self, _: Disk, u: [f64; 2]) -> Option<Sample> {
        (self.value > 0.0).then(|| Sample {
            outgoing: Disk::uniform(u),
            weight: self.value,
            peak: false,
        })
    }

    fn pdf(&self, _: Disk, outgoing: Disk) -> f64 {
        if self.value > 0.0 {
            outgoing.cos_theta() / PI
        } else {
            0.0
        }
    }

    fn total(&self, _: Disk, part: Part) -> Estimate {
        if part == Part::Direct { 0.0 } else { self.value }.into()
    }

    fn resolution(&self, _: Disk) -> f64 {
        0.0
    }
}

/// Ideal beam: straight transmission or mirror reflection, both of which keep the disk point.
#[derive(Debug, Clone, PartialEq)]
pub enum Specular {
    /// The same for all directions.
    Constant(f64),
    /// By polar angle: values at equal steps of sin²θ from 0 to 1, linear between them. Poor for glass near grazing
    /// incidence, where its values go with cosθ: [`Specular::Pane`] is exact.
    Angular(Vec<f64>),
    /// By polar angle: values at equal steps of cosθ from 0 (grazing) to 1 (the normal), linear between them, as suits glass.
    Cosine(Vec<f64>),
    /// Clear uncoated pane.
    Pane(Slab, Scatter),
    /// By incident patch.
    Patches {
        /// Where the values hold.
        basis: Arc<Basis>,
        /// One a patch.
        values: Vec<f64>,
    },
}

impl Specular {
    /// The same value for all directions.
    pub fn constant(value: f64) -> Result<Self> {
        check(&[value]).map(|()| Self::Constant(value))
    }

    /// Values at equal steps of sin²θ from 0 to 1, two or more.
    pub fn angular(values: Vec<f64>) -> Result<Self> {
        if values.len() < 2 {
            return Err(Error::Argument(
                "values by angle need at least two (at 0° and 90°)".into(),
            ));
        }
        check(&values).map(|()| Self::Angular(values))
    }

    /// Values at equal steps of cosθ from 0 to 1, two or more.
    pub fn cosine(values: Vec<f64>) -> Result<Self> {
        if values.len() < 2 {
            return Err(Error::Argument(
                "values by angle need at least two (at 90° and 0°)".into(),
            ));
        }
        check(&values).map(|()| Self::Cosine(values))
    }

    /// One value a patch.
    pub fn patches(basis: Arc<Basis>, values: Vec<f64>) -> Result<Self> {
        if values.len() != basis.len() {
            return Err(Error::Argument(format!(
                "{} values for {} patches of {}",
                values.len(),
                basis.len(),
                basis.name()
            )));
        }
        check(&values).map(|()| Self::Patches { basis, values })
    }

    /// Transmittance or reflectance of the beam.
    pub fn value(&self, incident: Disk) -> f64 {
        match self {
            Self::Constant(value) => *value,
            Self::Angular(values) => between(values, incident.sin2_theta().min(1.0)),
            Self::Cosine(values) => between(values, incident.cos_theta()),
            Self::Pane(slab, scatter) => slab.value(incident, *scatter),
            Self::Patches { basis, values } => values[basis.patch_of(incident)],
        }
    }
}

/// Between values at equal steps from 0 to 1.
fn between(values: &[f64], at: f64) -> f64 {
    let x = at * (values.len() - 1) as f64;
    let k = (x as usize).min(values.len() - 2);
    let t = x - k as f64;
    values[k] * (1.0 - t) + values[k + 1] * t
}

fn check(values: &[f64]) -> Result<()> {
    match values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        Some(v) => Err(Error::Argument(format!(
            "{v} is not a transmittance or reflectance (give a number from 0 to 1)"
        ))),
        None => Ok(()),
    }
}

impl Scatterer for Specular {
    fn evaluate(&self, _: Disk, _: Disk) -> f64 {
        0.0
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        Peak::straight(incident, self.value(incident))
    }

    fn sample(&self, incident: Disk, _: [f64; 2]) -> Option<Sample> {
        Sample::straight(incident, self.value(incident))
    }

    fn pdf(&self, _: Disk, _: Disk) -> f64 {
        0.0
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        if part == Part::Scattered {
            0.0.into()
        } else {
            self.value(incident).into()
        }
    }

    fn resolution(&self, _: Disk) -> f64 {
        0.0
    }
}
