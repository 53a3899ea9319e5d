//! Any model as a matrix.

use std::sync::Arc;

use super::Sampling;
use super::kernel::{means, steps, totals};
use super::points::{Points, Role};
use crate::basis::Basis;
use crate::bsdf::{Matrix, Model, Turn};
use crate::error::Result;
use crate::progress::Progress;

/// A matrix made of another model, and how well it stands for it.
#[derive(Debug, Clone)]
pub struct Conversion {
    /// The result. Standard errors are those that the source's own cause.
    pub matrix: Matrix,
    /// Pairs of directions a patch pair; 0 where the result is exact.
    pub samples: u32,
    /// Estimated sampling error of the values: RMS over the mean, both weighted by projected solid angle.
    pub rms_error: f64,
    /// Largest difference between a patch's direct-hemispherical value and the mean of the source's over the patch.
    pub worst_direct_hemispherical: f64,
}

/// Mean BSDF of `model` over every pair of patches, cosine-weighted in both. Ideal beams become the mean BSDF of the patch
/// that they fall into; separated peaks go back into their tables. Nothing is scaled afterwards: the error of the direct-hemispherical values is reported instead.
///
/// Matrices, tensor trees, Lambertian models and ideal beams of one value are converted exactly, by the overlaps of patches and
/// cells (isotropic trees in steps of a quarter degree of azimuth). Interpolants spread the light of one incident direction for
/// every 16 pairs. All others are sampled, by the same directions for every number of threads.
pub fn to_matrix(
    model: &Model,
    incident: &Arc<Basis>,
    outgoing: &Arc<Basis>,
    sampling: Sampling,
    progress: &Progress,
) -> Result<Conversion> {
    sampling.check(incident.len() + outgoing.len())?;
    let model = &model.without_separated();
    if let Model::Matrix(m) = model
        && m.incident() == incident
        && m.outgoing() == outgoing
    {
        return Ok(Conversion {
            matrix: m.clone(),
            samples: 0,
            rms_error: 0.0,
            worst_direct_hemispherical: 0.0,
        });
    }
    progress.expect(steps(model, incident.len()));
    let sources = Points::new(incident, Role::Incident, sampling);
    let targets = Points::new(outgoing, Role::Outgoing, sampling);
    progress.check()?;
    let means = means(model, Turn::NONE, &sources, &targets, progress)?;
    let n = f64::from(sampling.samples);
    let weights = [(n / 2.0).ceil() / n, (n / 2.0).floor() / n];
    let [even, odd] = &means.halves;
    let values: Vec<f64> = even
        .iter()
        .zip(odd)
        .map(|(a, b)| weights[0] * a + weights[1] * b)
        .collect();
    let rms_error = rms_error(even, odd, incident, outgoing);
    let mut matrix = Matrix::new(incident.clone(), outgoing.clone(), values)?;
    if let Some(variance) = means.variance {
        matrix = matrix.with_standard_errors(variance.into_iter().map(f64::sqrt).collect())?;
    }
    let exact = even == odd;
    let worst_direct_hemispherical = if exact {
        0.0
    } else {
        let difference = |(i, total): (usize, &f64)| (matrix.direct_hemispherical(i) - total).abs();
        totals(model, &sources)
            .iter()
            .enumerate()
            .map(difference)
            .fold(0.0, f64::max)
    };
    Ok(Conversion {
        matrix,
        samples: if exact { 0 } else { sampling.samples },
        rms_error,
        worst_direct_hemispherical,
    })
}

/// Half of the difference of the two halves is one standard deviation of their mean.
fn rms_error(even: &[f64], odd: &[f64], incident: &Basis, outgoing: &Basis) -> f64 {
    let (areas_in, areas_out) = (incident.projected_solid_angles(), outgoing.projected_solid_angles());
    let (mut square, mut mean, mut weight) = (0.0, 0.0, 0.0);
    for (i, area_in) in areas_in.iter().enumerate() {
        for (o, area_out) in areas_out.iter().enumerate() {
            let (a, b) = (even[i * areas_out.len() + o], odd[i * areas_out.len() + o]);
            let area = area_in * area_out;
            square += area * (0.5 * (a - b)).powi(2);
            mean += area * 0.5 * (a + b);
            weight += area;
        }
    }
    if mean > 0.0 {
        (square / weight).sqrt() / (mean / weight)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::convert::testing::bushy;
    use crate::bsdf::{Beam, Cells, Lambertian, Part, Rank, Reversed, Scatterer, Separated, Specular, Sum, Turned};
    use crate::sequence::uniform;

    fn full() -> Arc<Basis> {
        Arc::new(Basis::klems_full())
    }

    fn bases() -> [Arc<Basis>; 3] {
        [full(), Arc::new(Basis::klems_quarter()), Arc::new(Basis::tregenza())]
    }

    fn noisy() -> Matrix {
        Matrix::from_fn(full(), full(), |i, o| uniform(8, (i * 145 + o) as u64))
            .unwrap()
            .with_standard_errors((0..145 * 145).map(|k| uniform(9, k)).collect())
            .unwrap()
    }

    fn convert(model: &Model, basis: &Arc<Basis>, sampling: Sampling) -> Conversion {
        to_matrix(model, basis, basis, sampling, &Progress::default()).unwrap()
    }

    /// The same model, but one that has to be sampled.
    fn sampled_only(model: Model) -> Model {
        let reversed = Arc::new(Model::Reversed(Reversed::new(Arc::new(model))));
        Model::Reversed(Reversed::new(reversed))
    }

    fn of(samples: u32) -> Sampling {
        Sampling { samples, seed: 0 }
    }

    /// Mean over the hemisphere of the square of the difference of two tables, over the mean of the second.
    fn rms(a: &Matrix, b: &Matrix) -> f64 {
        let (areas_in, areas_out) = (
            a.incident().projected_solid_angles(),
            a.outgoing().projected_solid_angles(),
        );
        let (mut square, mut mean) = (0.0, 0.0);
        for (i, x) in areas_in.iter().enumerate() {
            for (o, y) in areas_out.iter().enumerate() {
                square += x * y * (a.value(i, o) - b.value(i, o)).powi(2);
                mean += x * y * b.value(i, o);
            }
        }
        let weight = std::f64::consts::PI.powi(2);
        (square / weight).sqrt() / (mean / weight)
    }

    #[test]
    fn a_matrix_on_its_own_bases_stays_as_it_is() {
        let matrix = noisy();
        let conversion = convert(&Model::Matrix(matrix.clone()), &full(), of(2));
        assert_eq!(conversion.matrix, matrix);
        // Also when it goes through the overlaps.
        let turned = Model::Turned(Turned::new(
            Arc::new(Model::Matrix(matrix.clone())),
            Turn::new(0.0, false),
        ));
        let again = convert(&turned, &full(), of(2)).matrix;
        for (a, b) in again.values().iter().zip(matrix.values()) {
            assert!((a - b).abs() < 1e-12);
        }
        for (a, b) in again
            .standard_errors()
            .unwrap()
            .iter()
            .zip(matrix.standard_errors().unwrap())
        {
            assert!((a - b).abs() < 1e-12);
        }
    }

    #[test]
    fn diffusers_and_beams_keep_their_value_on_every_basis() {
        for basis in bases() {
            for (model, value) in [
                (Model::Lambertian(Lambertian::new(0.6).unwrap()), 0.6),
                (Model::Specular(Specular::constant(0.3).unwrap()), 0.3),
                (Model::Specular(Specular::angular(vec![0.8, 0.8]).unwrap()), 0.8),
            ] {
                let conversion = to_matrix(&model, &full(), &basis, of(64), &Progress::default()).unwrap();
                for i in 0..145 {
                    assert!(
                        (conversion.matrix.direct_hemispherical(i) - value).abs() < 1e-9,
                        "{}",
                        model.kind()
                    );
                }
                assert!(conversion.worst_direct_hemispherical < 1e-9);
            }
        }
    }

    #[test]
    fn a_beam_stays_in_its_patch() {
        for model in [
            Specular::constant(0.5).unwrap(),
            Specular::angular(vec![0.5, 0.5]).unwrap(),
        ] {
            let matrix = convert(&Model::Specular(model), &full(), of(100)).matrix;
            for i in 0..145 {
                let flux = matrix.value(i, i) * matrix.outgoing().projected_solid_angle(i);
                assert!((flux - 0.5).abs() < 1e-9, "{i}: {flux}");
            }
        }
    }

    #[test]
    fn a_coarser_basis_keeps_the_flux() {
        let matrix = noisy();
        for basis in bases() {
            let conversion = convert(&Model::Matrix(matrix.clone()), &basis, of(256));
            let hemispherical = |m: &Matrix| -> f64 {
                let areas = m.incident().projected_solid_angles();
                areas
                    .iter()
                    .enumerate()
                    .map(|(i, a)| a * m.direct_hemispherical(i))
                    .sum()
            };
            let (new, old) = (hemispherical(&conversion.matrix), hemispherical(&matrix));
            assert!((new - old).abs() < 1e-9 * old, "{new} {old}");
            assert_eq!(conversion.samples, 0);
        }
    }

    #[test]
    fn standard_errors_shrink_where_independent_values_are_averaged() {
        let matrix = Matrix::from_fn(full(), full(), |_, _| 1.0).unwrap();
        let matrix = matrix.with_standard_errors(vec![0.1; 145 * 145]).unwrap();
        let coarse = convert(&Model::Matrix(matrix), &Arc::new(Basis::klems_quarter()), of(2)).matrix;
        let errors = coarse.standard_errors().unwrap();
        assert!(errors.iter().all(|&e| e > 0.0 && e < 0.1));
    }

    #[test]
    fn overlaps_and_points_agree_on_a_turned_matrix() {
        let base = Arc::new(Model::Matrix(noisy()));
        let turned = Turned::new(base, Turn::new(0.5, true));
        // Twice reversed is the same model, but has to be sampled.
        let twice = Reversed::new(Arc::new(Model::Reversed(Reversed::new(Arc::new(Model::Turned(
            turned.clone(),
        ))))));
        let basis = Arc::new(Basis::klems_quarter());
        let exact = convert(&Model::Turned(turned), &basis, of(256));
        let sampled = convert(&Model::Reversed(twice), &basis, of(256));
        assert_eq!(exact.samples, 0);
        assert!(sampled.worst_direct_hemispherical < 0.01);
        let error = rms(&sampled.matrix, &exact.matrix);
        assert!(
            error > 0.0 && error < 2.0 * sampled.rms_error + 1e-3,
            "{error} {}",
            sampled.rms_error
        );
    }

    #[test]
    fn trees_keep_their_direct_hemispherical_values() {
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let model = Model::Tree(bushy(rank));
            let conversion = to_matrix(&model, &full(), &bases()[1], of(256), &Progress::default()).unwrap();
            assert_eq!(conversion.samples, 0);
            for i in [0, 40, 87, 129] {
                let points = (0..2000).map(|k| full().sample_cosine(i, crate::sequence::r2(k, [0.3; 2])));
                let mean = points.map(|p| model.total(p, Part::All).value).sum::<f64>() / 2000.0;
                assert!((conversion.matrix.direct_hemispherical(i) - mean).abs() < 0.01 * mean);
            }
        }
    }

    #[test]
    fn the_error_estimate_is_honest() {
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let model = Model::Tree(bushy(rank));
            let basis = Arc::new(Basis::klems_quarter());
            let reference = convert(&model, &basis, of(2)).matrix;
            let model = sampled_only(model);
            for samples in [64, 256] {
                let (mut actual, mut estimated) = (0.0, 0.0);
                for seed in 0..4 {
                    let conversion = convert(&model, &basis, Sampling { samples, seed });
                    actual += rms(&conversion.matrix, &reference).powi(2) / 4.0;
                    estimated += conversion.rms_error.powi(2) / 4.0;
                }
                let ratio = (estimated / actual).sqrt();
                assert!(
                    (0.7..1.8).contains(&ratio),
                    "{rank:?} {samples}: {ratio} {}",
                    actual.sqrt()
                );
            }
        }
    }

    #[test]
    fn sums_and_separated_tables_convert_like_their_parts() {
        let base = Arc::new(Model::Tree(bushy(Rank::Anisotropic)));
        let quarter = Arc::new(Basis::klems_quarter());
        let plain = convert(&base, &quarter, of(64)).matrix;
        let separated = Model::Separated(Separated::new(base.clone()).unwrap());
        let parts = vec![
            (0.5, base),
            (0.25, Arc::new(Model::Lambertian(Lambertian::new(1.0).unwrap()))),
        ];
        let sum = convert(&Model::Sum(Sum::new(parts).unwrap()), &quarter, of(64)).matrix;
        for (s, p) in sum.values().iter().zip(plain.values()) {
            assert!((s - (0.5 * p + 0.25 / std::f64::consts::PI)).abs() < 1e-12);
        }
        let beams = convert(&separated, &quarter, of(64)).matrix;
        assert_eq!(beams, plain);
    }

    #[test]
    fn measured_beams_keep_their_light() {
        let beam = Beam::new(
            Cells::Patches(full()),
            (0..145).map(|k| 0.2 + 0.004 * f64::from(k)).collect(),
        )
        .unwrap();
        let beam = beam.with_standard_errors(vec![0.01; 145]).unwrap();
        let table = Matrix::from_fn(full(), full(), |_, _| 0.05).unwrap();
        let table = table.with_standard_errors(vec![0.001; 145 * 145]).unwrap();
        let parts = vec![
            (1.0, Arc::new(Model::Matrix(table))),
            (0.5, Arc::new(Model::Beam(beam))),
        ];
        let model = Model::Sum(Sum::new(parts).unwrap());
        let own = convert(&model, &full(), of(16));
        assert_eq!(own.samples, 0);
        for i in 0..145 {
            let (total, value) = (
                model.total(full().centre(i), Part::All).value,
                own.matrix.direct_hemispherical(i),
            );
            assert!((total - value).abs() < 1e-12, "{total} {value}");
            let area = full().projected_solid_angle(i);
            let error = own.matrix.standard_errors().unwrap()[i * 145 + i];
            assert!((error - 0.001_f64.hypot(0.005 / area)).abs() < 1e-9);
        }
        for basis in bases() {
            assert!(convert(&model, &basis, of(512)).worst_direct_hemispherical < 1e-9);
        }
    }

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let model = sampled_only(Model::Tree(bushy(Rank::Anisotropic)));
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| convert(&model, &Arc::new(Basis::klems_quarter()), of(16)))
        };
        let (one, three) = (with(1), with(3));
        assert_eq!(one.matrix, three.matrix);
        assert_eq!(one.rms_error, three.rms_error);
    }

    #[test]
    fn stops_when_asked() {
        let progress = Progress::default();
        progress.stop();
        let model = Model::Tree(bushy(Rank::Anisotropic));
        let outcome = to_matrix(&model, &full(), &full(), of(256), &progress);
        assert_eq!(outcome.unwrap_err(), crate::Error::Interrupted);
        assert!(to_matrix(&model, &full(), &full(), of(1), &Progress::default()).is_err());
    }

    #[test]
    fn isotropic_trees_give_tables_of_full_symmetry() {
        let matrix = convert(&Model::Tree(bushy(Rank::Isotropic)), &full(), of(16)).matrix;
        // Ring 7 has 24 cells, ring 8 has 16: turned by three and two cells.
        let (a, b) = (full().first_of_ring(6), full().first_of_ring(7));
        for o in 0..16 {
            assert!((matrix.value(a + 3, b + (o + 2) % 16) - matrix.value(a, b + o)).abs() < 1e-9);
        }
    }
}
