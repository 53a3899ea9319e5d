//! What each pixel of a picture counts: its solid angle, and its cosine to the line of sight.

use rayon::prelude::*;

use crate::error::{Error, Result};
use crate::picture::{Camera, Projection, mirrored};

/// Geometry of a picture's pixels; pictures of one view and size share it.
#[derive(Debug, Clone)]
pub struct Lens {
    camera: Camera,
    width: usize,
    height: usize,
    /// Solid angle of each pixel (steradians), 0 for one that is behind the eye or cut by the projection's rim.
    solid_angles: Vec<f64>,
    /// Cosine between each pixel's centre and the line of sight.
    cosines: Vec<f64>,
}

impl Lens {
    /// For a view and a size (pixels).
    ///
    /// # Errors
    /// The view is parallel: it has no angles.
    pub fn new(camera: Camera, width: usize, height: usize) -> Result<Self> {
        if camera.view().projection == Projection::Parallel {
            return Err(Error::Argument(
                "a parallel view has no angles at an eye (give a fisheye, such as -vta -vh 180 -vv 180)".into(),
            ));
        }
        if width == 0 || height == 0 {
            return Err(Error::Argument("the picture has no pixels (give another)".into()));
        }
        let [across, down] = camera.distinct(width, height);
        let mut cosines = vec![0.0; across * down];
        let (dx, dy) = (1.0 / width as f64, 1.0 / height as f64);
        cosines.par_chunks_mut(across).enumerate().for_each(|(row, cosines)| {
            let y = 1.0 - (row as f64 + 0.5) * dy;
            for (column, cosine) in cosines.iter_mut().enumerate() {
                *cosine = camera
                    .local((column as f64 + 0.5) * dx, y)
                    .map_or(0.0, |d| d[2].max(0.0));
            }
        });
        let cosines = mirrored(&cosines, [across, down], [width, height]);
        let mut solid_angles = camera.solid_angles(width, height);
        for (omega, cosine) in solid_angles.iter_mut().zip(&cosines) {
            if *cosine <= 0.0 {
                *omega = 0.0;
            }
        }
        Ok(Self {
            camera,
            width,
            height,
            solid_angles,
            cosines,
        })
    }

    /// The view.
    pub const fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Pixels a row, and rows.
    pub const fn size(&self) -> [usize; 2] {
        [self.width, self.height]
    }

    /// Solid angle of each pixel that counts (steradians), row by row from the top.
    pub fn solid_angles(&self) -> &[f64] {
        &self.solid_angles
    }

    /// Cosine of each pixel that counts to the line of sight.
    pub fn cosines(&self) -> &[f64] {
        &self.cosines
    }

    /// Direction of a pixel's centre in the eye's frame (right, up, forward).
    pub fn direction(&self, pixel: usize) -> Option<[f64; 3]> {
        let (row, column) = (pixel / self.width, pixel % self.width);
        self.camera.local(
            (column as f64 + 0.5) / self.width as f64,
            1.0 - (row as f64 + 0.5) / self.height as f64,
        )
    }

    /// Angle between the pixel in the middle and the one diagonal to it (radians).
    pub fn pitch(&self) -> f64 {
        let (row, column) = (self.height / 2, self.width / 2);
        let next = row.saturating_sub(1) * self.width + column.saturating_sub(1);
        match (self.direction(row * self.width + column), self.direction(next)) {
            (Some(a), Some(b)) => (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]).min(1.0).acos(),
            _ => f64::INFINITY,
        }
    }
}
