//! Many lights through one sample at once: what every direction sends, light by light or group by group.

use rayon::prelude::*;

use crate::direction::Disk;

use super::Scatterer;

/// A light from one direction.
#[derive(Clone, Copy, Debug)]
pub struct Light {
    /// Where it comes from, as a point of the disk of travel.
    pub incident: Disk,
    /// What it gives to the sample's plane, or its share of a group's projected solid angle.
    pub irradiance: f64,
    /// The group that it counts in, from 0.
    pub group: usize,
}

/// Outgoing directions that are found together.
const TOGETHER: usize = 64;

/// Scattered radiance of outgoing directions by each of `groups` of lights: a row of `groups` a direction.
///
/// Negative values of measured data count as zero.
pub fn gather<S: Scatterer + Sync>(model: &S, lights: &[Light], groups: usize, outgoing: &[Disk]) -> Vec<f32> {
    let mut found = vec![0.0_f32; outgoing.len() * groups];
    if groups == 0 {
        return found;
    }
    found
        .par_chunks_mut(TOGETHER * groups)
        .zip(outgoing.par_chunks(TOGETHER))
        .for_each_init(
            || (vec![0.0_f64; TOGETHER * groups], [0.0_f64; TOGETHER]),
            |(sums, values), (rows, some)| {
                sums.fill(0.0);
                for light in lights {
                    let values = &mut values[..some.len()];
                    model.evaluate_all(light.incident, some, values);
                    for (sums, value) in sums.chunks_exact_mut(groups).zip(values) {
                        sums[light.group] += value.max(0.0) * light.irradiance;
                    }
                }
                for (value, sum) in rows.iter_mut().zip(sums) {
                    *value = *sum as f32;
                }
            },
        );
    found
}

#[cfg(test)]
mod tests {
    use super::{Light, gather};
    use crate::bsdf::Lambertian;
    use crate::direction::Disk;

    #[test]
    fn lights_count_in_their_groups() {
        let model = Lambertian::new(0.5).unwrap();
        let light = |x, irradiance, group| Light {
            incident: Disk::new(x, 0.0),
            irradiance,
            group,
        };
        let lights = [light(0.1, 2.0, 1), light(0.2, 1.0, 0), light(-0.3, 4.0, 1)];
        let found = gather(&model, &lights, 3, &[Disk::new(0.0, 0.0), Disk::new(0.5, 0.5)]);
        let one = 0.5 / std::f64::consts::PI;
        for row in found.chunks(3) {
            for (value, expected) in row.iter().zip([one, 6.0 * one, 0.0]) {
                assert!((f64::from(*value) - expected).abs() < 1e-7);
            }
        }
    }
}
