//! The light that leaves a sample, path by path, for other programs.

use rayon::prelude::*;

use super::balance::{Balance, Tallies};
use super::flight::{Collector, Flight, Leaving};
use super::goniophotometer::Goniophotometer;
use super::sample::Sample;
use super::scene::{Scene, with_bands};
use super::settings::within_cone;
use crate::direction::{Direction, Disk, Scatter, Side};
use crate::error::{Error, Result};
use crate::geometry::Area;
use crate::progress::Progress;
use crate::sequence::mix;

/// Rays that leave, side by side in plain lists.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rays {
    /// Where they cross the plane at the end of the sample's depth (metres), within one period for what is repeated: x, y, z
    /// of each.
    pub positions: Vec<f64>,
    /// Unit vectors of travel: x, y, z of each.
    pub directions: Vec<f64>,
    /// Flux as a share of all that was sent in, one a band and ray.
    pub flux: Vec<f64>,
    /// Whether each one was reflected; the others were transmitted.
    pub reflected: Vec<bool>,
}

impl Rays {
    /// Number of rays.
    pub fn len(&self) -> usize {
        self.reflected.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.reflected.is_empty()
    }
}

/// Where the light comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RaySource {
    /// One direction, pointing to the source; with a source cone from about it.
    Direction(Direction),
    /// Evenly diffuse light from one side.
    Diffuse(Side),
}

/// Paths of a part; parts are traced side by side and written in order.
const PART: u32 = 1 << 13;
/// Parts in memory at a time.
const PARTS: u32 = 32;

struct Recorder<'a, const N: usize> {
    rays: Rays,
    bands: usize,
    share: f64,
    depth: [f64; 2],
    detector: f64,
    scene: &'a Scene<'a>,
    area: Area,
}

impl<const N: usize> Collector<N> for Recorder<'_, N> {
    fn collect(&mut self, path: &Leaving<'_, N>) {
        let up = path.ray.direction.z > 0.0;
        let mut direction = path.ray.direction;
        // From where it was last to the end of the sample.
        let end = self.depth[usize::from(up)];
        let way = (end - path.ray.origin.z) / direction.z;
        let mut position = path.ray.origin;
        if way.is_finite() {
            position += direction * way;
        }
        if let [layer] = &self.scene.sample.layers[..] {
            let within = |x: f64, [low, high]: [f64; 2], period: f64| {
                if period > 0.0 && period.is_finite() && high > low {
                    low + (x - low).rem_euclid(high - low)
                } else {
                    x
                }
            };
            let period = layer.period();
            position.x = within(position.x, self.area.x, period[0]);
            position.y = within(position.y, self.area.y, period[1]);
        }
        if self.detector > 0.0 {
            let mut draws = path.draws;
            let seen = within_cone(path.outgoing, self.detector, [draws.next(), draws.next()]);
            direction.x = seen.x;
            direction.y = seen.y;
            direction.z = seen.cos_theta().copysign(direction.z);
        }
        self.rays.positions.extend([position.x, position.y, position.z]);
        self.rays.directions.extend([direction.x, direction.y, direction.z]);
        self.rays
            .flux
            .extend(path.weight[..self.bands].iter().map(|w| w * self.share));
        self.rays.reflected.push(path.scatter == Scatter::Reflection);
    }
}

impl Goniophotometer {
    /// Follows `paths` paths and gives those that leave to `write`, in chunks of bounded size and always in the same order.
    /// Returns the tallies, one a band.
    pub fn rays(
        &self,
        sample: &Sample,
        source: RaySource,
        paths: u32,
        write: &mut dyn FnMut(&Rays) -> Result<()>,
        progress: &Progress,
    ) -> Result<Vec<Tallies>> {
        self.settings.check()?;
        if paths == 0 {
            return Err(Error::Argument("no paths, no rays (give 1 or more)".into()));
        }
        with_bands!(sample, self.rays_of(source, paths, write, progress))
    }

    fn rays_of<const N: usize>(
        &self,
        scene: &Scene<'_>,
        source: RaySource,
        paths: u32,
        write: &mut dyn FnMut(&Rays) -> Result<()>,
        progress: &Progress,
    ) -> Result<Vec<Tallies>> {
        let area = scene.sample.area()?;
        let key = mix(mix(self.settings.seed));
        let cone = self.settings.cones.source;
        let part = |number: u32| {
            let mut recorder = Recorder::<N> {
                rays: Rays::default(),
                bands: scene.bands(),
                share: 1.0 / f64::from(paths),
                depth: scene.depth,
                detector: self.settings.cones.detector,
                scene,
                area,
            };
            let mut balance = Balance::default();
            let mut flight = Flight::<N>::new(scene, area, self.settings.limits);
            let first = number * PART;
            let indices = first..paths.min(first.saturating_add(PART));
            match source {
                RaySource::Direction(d) => {
                    let incident = |u| within_cone(d.incident_disk(), cone, u);
                    flight.run(d.side(), key, indices, incident, &mut recorder, &mut balance, progress)
                }
                RaySource::Diffuse(side) => {
                    flight.run(side, key, indices, Disk::uniform, &mut recorder, &mut balance, progress)
                }
            }?;
            Ok((recorder.rays, balance))
        };
        let count = paths.div_ceil(PART);
        progress.expect(count as usize);
        let mut balance = Balance::<N>::default();
        for first in (0..count).step_by(PARTS as usize) {
            let parts: Vec<(Rays, Balance<N>)> = (first..count.min(first + PARTS))
                .into_par_iter()
                .map(part)
                .collect::<Result<_>>()?;
            for (rays, of_part) in &parts {
                balance.merge(of_part);
                if !rays.is_empty() {
                    write(rays)?;
                }
                progress.step()?;
            }
        }
        Ok((0..scene.bands()).map(|b| balance.of_band(b)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::testing::{blind, lambertian, sheet};

    #[test]
    fn rays_carry_what_leaves() {
        let source = RaySource::Direction(Direction::from_angles(Side::Exterior, 0.5, 1.0));
        let instrument = Goniophotometer::default();
        let mut all = Rays::default();
        let mut chunks = 0;
        let tallies = instrument
            .rays(
                &blind(0.6),
                source,
                20_000,
                &mut |rays| {
                    chunks += 1;
                    all.positions.extend(&rays.positions);
                    all.directions.extend(&rays.directions);
                    all.flux.extend(&rays.flux);
                    all.reflected.extend(&rays.reflected);
                    Ok(())
                },
                &Progress::default(),
            )
            .expect("it runs");
        assert_eq!(chunks, 3);
        let [traced, transmitted, reflected, ..] = tallies[0];
        let sum = |back: bool| -> f64 {
            let pairs = all.flux.iter().zip(&all.reflected);
            pairs.filter(|(_, r)| **r == back).map(|(f, _)| f).sum()
        };
        assert!((sum(false) - transmitted / traced).abs() < 1e-12 && (sum(true) - reflected / traced).abs() < 1e-12);
        for (k, back) in all.reflected.iter().enumerate() {
            let [y, z, dz] = [
                all.positions[3 * k + 1],
                all.positions[3 * k + 2],
                all.directions[3 * k + 2],
            ];
            let end = if *back { -0.04 } else { 0.04 };
            assert!(
                (z - end).abs() < 1e-6 && (dz > 0.0) != *back && (0.0..0.072).contains(&y),
                "{y} {z} {dz}"
            );
        }
    }

    #[test]
    fn the_same_rays_in_the_same_order_and_a_failure_ends_it() {
        let run = |threads: usize, fail: bool| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            let mut first = Vec::new();
            let outcome = pool.install(|| {
                let sample = sheet(lambertian(0.4, 0.3, 2), 2);
                let write = &mut |rays: &Rays| {
                    first.push(rays.clone());
                    if fail {
                        Err(Error::Io("disk full".into()))
                    } else {
                        Ok(())
                    }
                };
                let source = RaySource::Diffuse(Side::Interior);
                Goniophotometer::default().rays(&sample, source, 30_000, write, &Progress::default())
            });
            (first, outcome)
        };
        let (one, two) = (run(1, false), run(2, false));
        assert_eq!(one, two);
        assert_eq!(one.0[0].flux.len(), 2 * one.0[0].len());
        let (chunks, outcome) = run(2, true);
        assert!(chunks.len() == 1 && outcome == Err(Error::Io("disk full".into())));
    }
}
