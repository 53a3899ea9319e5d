//! How far apart two models of one sample are.
//!
//! * By how much the flux differs, direction by direction: [`relative_l1`]. A peak that is shifted by more than its own
//!   width counts in full.
//! * How far the light would have to be turned: [`transport`], an angle. A peak that is shifted by 1° counts 1°.
//! * Both for many models and incident directions: [`pairwise`].

mod distribution;
mod transport;

use std::sync::Arc;

use rayon::prelude::*;

pub use distribution::{Distribution, Point};
pub use transport::{CELL_WIDTH, Support, transport};

use crate::bsdf::{Model, Scatterer};
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;

/// Peaks closer than this (radians) are one.
const SAME_PEAK: f64 = 1e-4;

/// Two models compared for one incident direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance {
    /// ∫ |f₁ − f₂| cosθ dω over the mean of both totals: 0 to 2; 0 if both are dark.
    pub relative_l1: f64,
    /// Mean angle by which light has to be turned (radians), totals aside; None where one of them is dark.
    pub transport: Option<f64>,
}

/// Two models compared for one incident direction.
pub fn distance(a: &Model, b: &Model, incident: Disk) -> Distance {
    let lights = [a, b].map(|model| Distribution::of(model, incident));
    let supports = [Support::of(&lights[0]), Support::of(&lights[1])];
    Distance {
        relative_l1: relative_l1([a, b], [&lights[0], &lights[1]], incident),
        transport: transport(&supports[0], &supports[1]),
    }
}

/// ∫ |f₁ − f₂| cosθ dω over the mean of both totals, for distributions of the models themselves.
///
/// The integral is taken on the probes of both: |f₁ − f₂| = (f₁ + f₂) w with w = |f₁ − f₂| / (f₁ + f₂), so that it is the sum
/// of w over both distributions' flux, and fine cells of either model count as they are. Peaks of one direction cancel.
pub fn relative_l1(models: [&Model; 2], lights: [&Distribution; 2], incident: Disk) -> f64 {
    let mean = 0.5 * (lights[0].total() + lights[1].total());
    if mean <= 0.0 {
        return 0.0;
    }
    if let [Model::Matrix(a), Model::Matrix(b)] = models
        && a.outgoing() == b.outgoing()
    {
        // The same sum patch by patch.
        let patches = [a, b].map(|m| m.incident().patch_of(incident));
        let basis = a.outgoing();
        let difference = |o| (a.value(patches[0], o) - b.value(patches[1], o)).abs();
        let sum: f64 = (0..basis.len())
            .map(|o| difference(o) * basis.projected_solid_angle(o))
            .sum();
        return sum / mean;
    }
    let one_sided = |light: &Distribution, other: &Model| -> f64 {
        light
            .probes
            .iter()
            .filter(|p| p.flux > 0.0)
            .map(|p| {
                let theirs = other.evaluate(incident, p.outgoing).max(0.0);
                p.flux * (p.value - theirs).abs() / (p.value + theirs)
            })
            .sum()
    };
    let scattered = one_sided(lights[0], models[1]) + one_sided(lights[1], models[0]);
    let mut theirs = lights[1].peaks.clone();
    let mut peaks = 0.0;
    for &(direction, value) in &lights[0].peaks {
        let same = theirs.iter().position(|p| p.0.angle_to(direction) < SAME_PEAK);
        peaks += (value - same.map_or(0.0, |k| theirs.swap_remove(k).1)).abs();
    }
    peaks += theirs.iter().map(|p| p.1).sum::<f64>();
    (scattered + peaks) / mean
}

/// Distances between the first `own` models and all others: `result[k][i]` is of the pair k, in the order (0, 1), (0, 2) …
/// (1, 2) …, for incident direction i. Models after the first `own` are not compared with each other.
pub fn pairwise(
    models: &[Arc<Model>],
    own: usize,
    incidents: &[Disk],
    progress: &Progress,
) -> Result<Vec<Vec<Distance>>> {
    let pairs: Vec<(usize, usize)> = (0..own.min(models.len()))
        .flat_map(|a| (a + 1..models.len()).map(move |b| (a, b)))
        .collect();
    let mut result: Vec<Vec<Distance>> = vec![Vec::with_capacity(incidents.len()); pairs.len()];
    progress.expect(incidents.len());
    for &incident in incidents {
        let lights: Vec<(Distribution, Support)> = models
            .par_iter()
            .map(|model| {
                let light = Distribution::of(model, incident);
                let support = Support::of(&light);
                (light, support)
            })
            .collect();
        let distances: Vec<Distance> = pairs
            .par_iter()
            .map(|&(a, b)| Distance {
                relative_l1: relative_l1([&models[a], &models[b]], [&lights[a].0, &lights[b].0], incident),
                transport: transport(&lights[a].1, &lights[b].1),
            })
            .collect();
        for (list, distance) in result.iter_mut().zip(distances) {
            list.push(distance);
        }
        progress.step()?;
    }
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::{Lambertian, Matrix, Specular, Sum};

    fn lambertian(value: f64) -> Model {
        Model::Lambertian(Lambertian::new(value).unwrap())
    }

    fn with_beam(beam: f64, scattered: f64) -> Model {
        let beam = Arc::new(Model::Specular(Specular::constant(beam).unwrap()));
        Model::Sum(Sum::new(vec![(1.0, beam), (1.0, Arc::new(lambertian(scattered)))]).unwrap())
    }

    fn matrix(basis: Basis, f: impl Fn(Disk, Disk) -> f64) -> Model {
        let basis = Arc::new(basis);
        let centres: Vec<Disk> = (0..basis.len()).map(|p| basis.centre(p)).collect();
        Model::Matrix(Matrix::from_fn(basis.clone(), basis, |i, o| f(centres[i], centres[o])).unwrap())
    }

    #[test]
    fn a_model_is_at_no_distance_from_itself() {
        let lobe = |i: Disk, o: Disk| (-(i.angle_to(o) / 0.3).powi(2)).exp();
        for model in [lambertian(0.4), with_beam(0.3, 0.2), matrix(Basis::klems_full(), lobe)] {
            let d = distance(&model, &model, Disk::new(-0.2, -0.5));
            assert_eq!(d.relative_l1, 0.0);
            assert!(d.transport.unwrap() < 1e-12);
        }
    }

    #[test]
    fn magnitude_counts_in_l1_and_not_in_transport() {
        let d = distance(&lambertian(0.3), &lambertian(0.6), Disk::NORMAL);
        assert!((d.relative_l1 - 0.3 / 0.45).abs() < 1e-9);
        assert!(d.transport.unwrap() < 1e-9);
    }

    #[test]
    fn points_and_patches_give_one_sum() {
        let lobe = |w: f64| move |i: Disk, o: Disk| 0.02 + (-(i.angle_to(o) / w).powi(2)).exp();
        let (a, b) = (
            matrix(Basis::klems_full(), lobe(0.3)),
            matrix(Basis::klems_full(), lobe(0.4)),
        );
        let as_sum = Model::Sum(Sum::new(vec![(1.0, Arc::new(b.clone()))]).unwrap());
        for incident in [Disk::NORMAL, Disk::new(-0.2, 0.7)] {
            let (patches, points) = (distance(&a, &b, incident), distance(&a, &as_sum, incident));
            assert!((patches.relative_l1 - points.relative_l1).abs() < 1e-9);
            assert!(patches.relative_l1 > 0.1);
        }
    }

    #[test]
    fn beams_of_one_direction_cancel() {
        let d = distance(&with_beam(0.5, 0.2), &with_beam(0.3, 0.2), Disk::new(-0.3, 0.1));
        assert!((d.relative_l1 - 0.2 / 0.6).abs() < 1e-9, "{}", d.relative_l1);
    }

    #[test]
    fn beam_against_diffuser_is_the_mean_angle_of_the_diffuser_from_the_beam() {
        let beam = Model::Specular(Specular::constant(0.4).unwrap());
        let d = distance(&beam, &lambertian(0.4), Disk::NORMAL);
        assert!((d.relative_l1 - 2.0).abs() < 1e-9);
        // ∫ θ 2 sinθ cosθ dθ from 0 to π/2 is π/4.
        let angle = d.transport.unwrap();
        assert!((angle - std::f64::consts::FRAC_PI_4).abs() < 2e-3, "{angle}");
    }

    #[test]
    fn the_dark_has_no_transport_distance() {
        let dark = lambertian(0.0);
        let d = distance(&dark, &lambertian(0.4), Disk::NORMAL);
        assert!((d.relative_l1 - 2.0).abs() < 1e-9);
        assert_eq!(d.transport, None);
        assert_eq!(distance(&dark, &dark, Disk::NORMAL).relative_l1, 0.0);
    }

    #[test]
    fn one_diffuser_on_many_partitions_is_the_same() {
        let models = [
            lambertian(0.4),
            matrix(Basis::klems_full(), |_, _| 0.4 / std::f64::consts::PI),
            matrix(Basis::klems_quarter(), |_, _| 0.4 / std::f64::consts::PI),
            matrix(Basis::iea21(), |_, _| 0.4 / std::f64::consts::PI),
        ];
        for a in &models {
            for b in &models {
                let d = distance(a, b, Disk::new(0.0, -0.5));
                assert!(d.relative_l1 < 1e-9);
                let degrees = d.transport.unwrap().to_degrees();
                assert!(degrees < 0.25, "{degrees}");
            }
        }
    }

    #[test]
    fn pairs_are_symmetric_and_obey_the_triangle_inequality() {
        let width = |w: f64| move |i: Disk, o: Disk| 0.05 + (-(i.angle_to(o) / w).powi(2)).exp();
        let models: Vec<Arc<Model>> = [
            matrix(Basis::klems_full(), width(0.2)),
            matrix(Basis::klems_quarter(), width(0.4)),
            matrix(Basis::klems_half(), |i, o| width(0.3)(i, Disk::new(o.x - 0.1, o.y))),
            with_beam(0.1, 0.2),
        ]
        .into_iter()
        .map(Arc::new)
        .collect();
        let incidents = [Disk::NORMAL, Disk::new(0.0, -0.6)];
        let all = pairwise(&models, 4, &incidents, &Progress::default()).unwrap();
        assert_eq!(all.len(), 6);
        let index = |a: usize, b: usize| [[9, 0, 1, 2], [0, 9, 3, 4], [1, 3, 9, 5], [2, 4, 5, 9]][a][b];
        for (i, &incident) in incidents.iter().enumerate() {
            for a in 0..4 {
                for b in (0..4).filter(|&b| b != a) {
                    let direct = all[index(a, b)][i];
                    let turned = distance(&models[b], &models[a], incident);
                    assert!((direct.relative_l1 - turned.relative_l1).abs() < 1e-12);
                    assert!((direct.transport.unwrap() - turned.transport.unwrap()).abs() < 1e-9);
                    for c in (0..4).filter(|&c| c != a && c != b) {
                        let detour = [all[index(a, c)][i], all[index(c, b)][i]];
                        let angle = detour[0].transport.unwrap() + detour[1].transport.unwrap();
                        assert!(direct.transport.unwrap() <= angle + 1e-9);
                        let l1 = detour[0].relative_l1 + detour[1].relative_l1;
                        assert!(direct.relative_l1 <= 1.02 * l1);
                    }
                }
            }
        }
    }

    #[test]
    fn stopping_is_an_error_of_its_own() {
        let models = [Arc::new(lambertian(0.1)), Arc::new(lambertian(0.2))];
        let progress = Progress::default();
        progress.stop();
        let result = pairwise(&models, 2, &[Disk::NORMAL], &progress);
        assert_eq!(result, Err(crate::Error::Interrupted));
    }
}
