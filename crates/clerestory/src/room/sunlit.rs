//! Surfaces of the room that the sun lights through beams of windows, as an eye sees them.

use rayon::prelude::*;

use super::aperture::{NONE, OPEN};
use super::{Role, Room};
use crate::error::Result;
use crate::geometry::{Geometry, Meeting, NO_PIECE, Ray, Vec3};
use crate::material::Arrival;
use crate::picture::colour::LUMINANCE;
use crate::progress::Progress;

/// What a direction of an eye shows of a sun.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sunlit {
    /// As [`Room::windows_towards`] tells it of the surface that is seen.
    pub window: u16,
    /// Radiance by the irradiance of a plane that faces the sun, if all of it came through (1/sr), photopic.
    pub radiance: f32,
}

impl Room {
    /// Of an eye at a point, for each direction (rows) and each sun (columns), unit vectors both.
    pub fn lit_by_suns(
        &self,
        point: Vec3,
        directions: &[Vec3],
        suns: &[Vec3],
        progress: &Progress,
    ) -> Result<Vec<Sunlit>> {
        progress.expect(directions.len());
        let rows: Vec<Vec<Sunlit>> = directions
            .par_iter()
            .map(|&direction| {
                progress.check()?;
                let row = self.lit_along(point, direction, suns);
                progress.step()?;
                Ok(row)
            })
            .collect::<Result<_>>()?;
        Ok(rows.concat())
    }

    fn lit_along(&self, point: Vec3, direction: Vec3, suns: &[Vec3]) -> Vec<Sunlit> {
        let dark = Sunlit {
            window: NONE,
            radiance: 0.0,
        };
        let mut ray = Ray {
            origin: point,
            direction,
            piece: NO_PIECE,
        };
        let Meeting::Hit(hit) = self.mesh.meet(&mut ray) else {
            return vec![dark; suns.len()];
        };
        let Role::Solid(surface) = &self.roles[hit.surface as usize] else {
            return vec![dark; suns.len()];
        };
        let face = usize::from(direction.dot(hit.normal) > 0.0);
        let normal = if face == 0 { hit.normal } else { -hit.normal };
        let arrival = Arrival {
            direction,
            normal,
            here: &self.media[0],
            beyond: &self.media[usize::from(surface.media[1 - face])],
        };
        let material = &self.materials[surface.materials[face] as usize];
        let lit = |sun: Vec3| {
            let cos = sun.dot(normal);
            let f = material.evaluate::<3>(&arrival, sun);
            let radiance = (0..3).map(|c| LUMINANCE[c] * f[c]).sum::<f64>() * cos.abs();
            if cos <= 0.0 || radiance <= 0.0 {
                return dark;
            }
            let mut towards = Ray { direction: sun, ..ray };
            match self.window_along(&mut towards) {
                OPEN | NONE => dark,
                window => Sunlit {
                    window,
                    radiance: radiance as f32,
                },
            }
        };
        suns.iter().map(|&sun| lit(sun)).collect()
    }
}
