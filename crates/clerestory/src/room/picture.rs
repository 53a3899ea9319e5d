//! Radiance by pixel.

use rayon::prelude::*;

use super::path::Tracer;
use super::{Rgb, Role, Room};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Meeting, NO_PIECE, Ray};
use crate::material::Draws;
use crate::picture::Camera;
use crate::progress::Progress;
use crate::sequence::{mix, r2};

/// A picture that is to be made.
#[derive(Debug, Clone)]
pub struct Picture {
    /// Where it looks, and how it is projected.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// Of the random numbers.
    pub seed: u64,
}

/// What was found so far, by pixel, top row first.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Accumulated {
    /// Sums over paths of the radiance, without the sun's disc.
    pub sums: Vec<Rgb>,
    /// Sums of the squares of the mean of the three channels.
    pub squares: Vec<f64>,
    /// Paths of every pixel so far.
    pub samples: u32,
}

/// Points of the sun's disc that are put into the picture one by one.
const SUN_POINTS: u32 = 16_384;

impl Picture {
    /// Adds paths to every pixel; pixels outside of the projection stay 0. The same for any number of threads, and for any
    /// division of the same number of paths into calls. What was found stays as it was if this fails or is stopped.
    pub fn add(&self, room: &Room, samples: u32, found: &mut Accumulated, progress: &Progress) -> Result<()> {
        let [width, height] = self.size;
        let pixels = width * height;
        let mut next = if found.sums.is_empty() {
            Accumulated {
                sums: vec![[0.0; 3]; pixels],
                squares: vec![0.0; pixels],
                samples: 0,
            }
        } else {
            found.clone()
        };
        if next.sums.len() != pixels || next.squares.len() != pixels || width == 0 {
            return Err(Error::Argument(format!(
                "{} pixels were found and the picture has {pixels} (go on with a picture of the same size)",
                next.sums.len()
            )));
        }
        let first = next.samples;
        let Some(last) = first.checked_add(samples).filter(|last| *last <= 1 << 24) else {
            return Err(Error::Argument(format!(
                "{first} and {samples} paths a pixel are more than {}",
                1 << 24
            )));
        };
        progress.expect(height);
        next.sums
            .par_chunks_mut(width)
            .zip(next.squares.par_chunks_mut(width))
            .enumerate()
            .try_for_each(|(row, (sums, squares))| {
                let mut tracer = Tracer::new(room);
                for index in first..last {
                    progress.check()?;
                    let mut pixels = Vec::with_capacity(width);
                    for column in 0..width {
                        let mut draws = Draws::new(mix(self.seed ^ mix((row * width + column) as u64)), index);
                        let x = (column as f64 + draws.next()) / width as f64;
                        let y = 1.0 - (row as f64 + draws.next()) / height as f64;
                        if let Some([origin, direction]) = self.camera.ray(x, y) {
                            tracer.look(origin, direction, draws);
                            pixels.push(column);
                        }
                    }
                    for (column, radiance) in pixels.into_iter().zip(tracer.finish()) {
                        for c in 0..3 {
                            sums[column][c] += radiance[c];
                        }
                        squares[column] += (radiance.iter().sum::<f64>() / 3.0).powi(2);
                    }
                }
                progress.step()
            })?;
        next.samples = last;
        *found = next;
        Ok(())
    }

    /// Radiance of the sun's disc by pixel, as it is seen directly or through the beams of windows: its flux is exact.
    pub fn sun(&self, room: &Room) -> Vec<Rgb> {
        let [width, height] = self.size;
        let mut seen = vec![[0.0; 3]; width * height];
        let Some(sun) = &room.sun else { return seen };
        let Some([origin, _]) = self.camera.ray(0.5, 0.5) else {
            return seen;
        };
        if self.camera.locate(sun.direction).is_none() {
            return seen;
        }
        let solid_angles = self.camera.exact_solid_angles(width, height);
        let share = sun.solid_angle / f64::from(SUN_POINTS);
        for k in 0..SUN_POINTS {
            let direction = sun.sample(r2(k, [0.5; 2]));
            let Some([x, y]) = self.camera.locate(direction) else {
                continue;
            };
            let (column, row) = (x * width as f64, (1.0 - y) * height as f64);
            if !(0.0..width as f64).contains(&column) || !(0.0..height as f64).contains(&row) {
                continue;
            }
            let pixel = row as usize * width + column as usize;
            let Some(passed) = room.passed(Ray {
                origin,
                direction,
                piece: NO_PIECE,
            }) else {
                continue;
            };
            if solid_angles[pixel] > 0.0 {
                for c in 0..3 {
                    seen[pixel][c] += passed[c] * sun.radiance[c] * share / solid_angles[pixel];
                }
            }
        }
        seen
    }
}

impl Room {
    /// What the beams of windows let pass straight on the way out; None where anything else is in the way.
    pub(super) fn passed(&self, mut ray: Ray) -> Option<Rgb> {
        let mut passed = [1.0; 3];
        loop {
            let Meeting::Hit(hit) = self.mesh.meet(&mut ray) else {
                return Some(passed);
            };
            let Role::Window(number) = self.roles[hit.surface as usize] else {
                return None;
            };
            if ray.direction.dot(hit.normal) > 0.0 {
                return None;
            }
            let window = &self.windows[number as usize];
            let beam = window.beam(window.disk(-ray.direction));
            if beam.iter().all(|b| *b <= 0.0) {
                return None;
            }
            for c in 0..3 {
                passed[c] *= beam[c];
            }
        }
    }
}
