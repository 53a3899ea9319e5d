//! A picture: radiances row by row, with what its file said of them.

use rayon::prelude::*;

use super::camera::Camera;
use super::colour::{EFFICACY, PRIMARIES, luminance_weights};
use super::view::View;
use crate::error::{Error, Result};

/// Most pixels of a picture that is read: 1.6 GB.
pub const MOST_PIXELS: usize = 1 << 27;

/// Radiances of three channels (W/(m² sr)), exposure taken out.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Picture {
    /// Pixels a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue, row by row from the top, each from the left.
    pub pixels: Vec<[f32; 3]>,
    /// All lines of the file's header, as they are.
    pub header: Vec<String>,
    /// What the eye sees, if the header says so in a way that makes sense.
    pub view: Option<View>,
    /// Product of the exposures of the header: what the values of the file were divided by.
    pub exposure: f64,
    /// Chromaticities of red, green, blue and white, if the header gives them.
    pub primaries: Option<[f64; 8]>,
    /// Height of a pixel over its width.
    pub pixel_aspect: f64,
    /// What was faulty in the file but could be understood.
    pub warnings: Vec<String>,
}

impl Picture {
    /// From pixels row by row from the top.
    pub fn new(width: usize, height: usize, pixels: Vec<[f32; 3]>) -> Result<Self> {
        if width == 0 || height == 0 || pixels.len() != width * height {
            return Err(Error::Argument(format!(
                "{} pixels are no picture of {width} × {height} (give one colour a pixel)",
                pixels.len()
            )));
        }
        Ok(Self {
            width,
            height,
            pixels,
            exposure: 1.0,
            pixel_aspect: 1.0,
            ..Self::default()
        })
    }

    /// The checked view.
    pub fn camera(&self) -> Result<Camera> {
        let view = self.view.ok_or_else(|| {
            Error::Missing("the picture does not say what it shows (give a view, such as -vta -vh 180 -vv 180)".into())
        })?;
        Camera::new(view)
    }

    /// Whether the picture's primaries are others than Radiance's, which some writers spell out.
    pub fn has_other_primaries(&self) -> bool {
        self.primaries
            .is_some_and(|p| p.iter().zip(PRIMARIES).any(|(a, b)| (a - b).abs() > 2e-4))
    }

    /// Shares of the channels in the luminance, by the picture's primaries.
    pub fn luminance_weights(&self) -> Result<[f64; 3]> {
        luminance_weights(self.primaries.as_ref())
    }

    /// Luminance of each pixel (cd/m²), row by row from the top.
    pub fn luminance(&self) -> Result<Vec<f32>> {
        Ok(self.weighted(self.luminance_weights()?))
    }

    /// Luminance of each pixel (cd/m²) with other shares of the channels.
    pub fn weighted(&self, weights: [f64; 3]) -> Vec<f32> {
        let [r, g, b] = weights.map(|w| EFFICACY * w);
        self.pixels
            .par_iter()
            .with_min_len(1 << 14)
            .map(|p| (r * f64::from(p[0]) + g * f64::from(p[1]) + b * f64::from(p[2])) as f32)
            .collect()
    }
}
