//! Irradiance at points.

use rayon::prelude::*;

use super::path::Tracer;
use super::{Rgb, Room};
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::material::Draws;
use crate::progress::Progress;
use crate::sequence::mix;

/// A point that measures irradiance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sensor {
    /// Where it is (metres).
    pub point: Vec3,
    /// Where it faces; any length but 0.
    pub normal: Vec3,
}

/// Irradiance (W/m²) with its standard error, by channel.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Estimate {
    /// Mean of the replications.
    pub value: Rgb,
    /// Standard error of it.
    pub standard_error: Rgb,
}

/// Independent replications, from which errors are estimated.
pub(super) const REPLICATIONS: u32 = 16;
/// Paths that are followed together.
const BATCH: u32 = 1024;
/// A sensor is lifted so far off a surface that it lies on (metres).
pub(super) const LIFT: f64 = 1e-6;

impl Room {
    /// Irradiance at sensors by `samples` paths each, a multiple of the 16 replications; the same for any number of threads.
    pub fn irradiance(
        &self,
        sensors: &[Sensor],
        samples: u32,
        seed: u64,
        progress: &Progress,
    ) -> Result<Vec<Estimate>> {
        check_samples(samples)?;
        check_sensors(sensors)?;
        progress.expect(sensors.len() * REPLICATIONS as usize);
        let paths = samples / REPLICATIONS;
        let means: Vec<Rgb> = (0..sensors.len() * REPLICATIONS as usize)
            .into_par_iter()
            .map(|unit| {
                let sensor = &sensors[unit / REPLICATIONS as usize];
                let normal = sensor.normal.unit();
                let key = mix(seed ^ mix(unit as u64));
                let mut tracer = Tracer::new(self);
                let mut sum = [0.0; 3];
                let mut next = 0;
                while next < paths {
                    progress.check()?;
                    let last = paths.min(next + BATCH);
                    for index in next..last {
                        tracer.sense(sensor.point + normal * LIFT, normal, Draws::new(key, index));
                    }
                    for found in tracer.finish() {
                        for c in 0..3 {
                            sum[c] += found[c];
                        }
                    }
                    next = last;
                }
                progress.step()?;
                Ok(sum.map(|s| s * std::f64::consts::PI / f64::from(paths)))
            })
            .collect::<Result<_>>()?;
        Ok(means.chunks(REPLICATIONS as usize).map(estimate).collect())
    }
}

/// Fails where so many paths cannot be divided into replications.
pub(super) fn check_samples(samples: u32) -> Result<()> {
    if samples == 0 || !samples.is_multiple_of(REPLICATIONS) || samples / REPLICATIONS >= 1 << 24 {
        return Err(Error::Argument(format!(
            "{samples} paths (give a multiple of {REPLICATIONS} from {REPLICATIONS} to {})",
            REPLICATIONS << 23
        )));
    }
    Ok(())
}

/// Fails where a sensor has no place or direction.
pub(super) fn check_sensors(sensors: &[Sensor]) -> Result<()> {
    for (k, sensor) in sensors.iter().enumerate() {
        let mut numbers = sensor.point.array().into_iter().chain(sensor.normal.array());
        if !numbers.all(f64::is_finite) || sensor.normal.length() == 0.0 {
            return Err(Error::Argument(format!(
                "sensor {} has no place or no direction (give finite numbers and a normal that is not zero)",
                k + 1
            )));
        }
    }
    Ok(())
}

fn estimate(means: &[Rgb]) -> Estimate {
    let n = means.len() as f64;
    let of = |c: usize| {
        let mean = means.iter().map(|m| m[c]).sum::<f64>() / n;
        let variance = means.iter().map(|m| (m[c] - mean).powi(2)).sum::<f64>() / (n - 1.0);
        (mean, (variance / n).sqrt())
    };
    Estimate {
        value: std::array::from_fn(|c| of(c).0),
        standard_error: std::array::from_fn(|c| of(c).1),
    }
}
