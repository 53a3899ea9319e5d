//! Any model as a tensor tree.

use std::f64::consts::{PI, TAU};

use rayon::prelude::*;

use super::isotropy::{anisotropy, by_construction};
use super::lobes;
use crate::bsdf::tree::Grid;
use crate::bsdf::{Model, Part, Rank, Scatterer, Tree};
use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::sequence::{mix, uniform};

/// Largest share of the light that a turn may move for a model to be stored as an isotropic tree.
pub const MAX_ANISOTROPY: f64 = 0.05;

/// Pairs of directions, and incident directions, at which the result is compared with its source.
const CHECKED_PAIRS: u64 = 1 << 16;
/// So many of these pairs have one incident direction: some models first find what light from there does.
const CHECKED_EACH: u64 = 64;
const CHECKED_TOTALS: u64 = 256;

/// A tensor tree made of another model, and how well it stands for it.
#[derive(Debug, Clone)]
pub struct TreeConversion {
    /// The result.
    pub tree: Tree,
    /// RMS difference to the source at pseudo-random pairs of directions, uniform in projected solid angle, over the mean:
    /// resolution, sampling and reduction together. None for a source with ideal beams.
    pub rms_error: Option<f64>,
    /// Largest difference of direct-hemispherical values to the source's at pseudo-random directions.
    pub worst_direct_hemispherical: f64,
}

/// Mean BSDF of `model` over the cells of a tree. Peaks become the mean BSDF of the finest cell that they fall into.
///
/// Rank 3 is the mean over all azimuths; it is refused for a model in which a turn moves more than [`MAX_ANISOTROPY`] of the
/// light. `reduction` merges that percentage of the finest blocks, the smoothest first.
pub fn to_tree(
    model: &Model,
    rank: Rank,
    grid: Grid,
    reduction: Option<f64>,
    progress: &Progress,
) -> Result<TreeConversion> {
    let model = &model.without_separated();
    if rank == Rank::Isotropic {
        let measured = anisotropy(model, progress)?;
        if measured > MAX_ANISOTROPY {
            return Err(Error::Unsupported(format!(
                "an isotropic tensor tree cannot hold this {} model: a turn in its plane moves {:.0} % of the light, more than \
                 {:.0} % (use tensor4)",
                model.kind(),
                100.0 * measured,
                100.0 * MAX_ANISOTROPY
            )));
        }
    }
    let beams = has_beams(model);
    let averaged = rank == Rank::Isotropic && !by_construction(model);
    let source = |incident: Disk, outgoing: Disk| {
        let turn = if averaged {
            let key = mix(incident.x.to_bits() ^ mix(outgoing.x.to_bits() ^ mix(outgoing.y.to_bits() ^ grid.seed)));
            (uniform(key, 0) * TAU).sin_cos()
        } else {
            (0.0, 1.0)
        };
        let i = incident.turned(turn.0, turn.1);
        let beam = if beams {
            beam_in_cell(model, i, outgoing, turn, grid.levels)
        } else {
            0.0
        };
        model.evaluate(i, outgoing.turned(turn.0, turn.1)) + beam
    };
    let mut tree = match model {
        Model::Interpolant(i) if rank == Rank::Anisotropic || i.isotropic() => lobes::to_tree(i, rank, grid, progress)?,
        _ => Tree::from_fn(rank, grid, &source, progress)?,
    };
    if let Some(percent) = reduction {
        tree = tree.reduced_by_percent(percent)?.tree;
    }
    let rms_error = (!beams).then(|| rms_difference(&tree, model));
    let worst_direct_hemispherical = worst_total(&tree, model);
    Ok(TreeConversion {
        tree,
        rms_error,
        worst_direct_hemispherical,
    })
}

/// BSDF of the peaks for light from `i` that fall into the cell of `outgoing`, which is turned by sine and cosine to lie in the
/// model.
fn beam_in_cell(model: &Model, i: Disk, outgoing: Disk, (sin, cos): (f64, f64), levels: u32) -> f64 {
    let cells = f64::from(1_u32 << levels);
    let cell = |point: Disk| point.to_square().map(|c| (c * cells) as u32);
    let here = cell(outgoing);
    let peaks = model.peaks(i);
    let share = peaks.iter().map(|peak| {
        let back = peak.outgoing.turned(-sin, cos);
        // A beam on the border of two cells, as in the plane of incidence of rank 3, belongs to both by half.
        let sides = [1e-9, -1e-9].map(|dy| cell(Disk::new(back.x, back.y + dy)));
        peak.value * 0.5 * sides.iter().filter(|&&side| side == here).count() as f64
    });
    share.sum::<f64>() * cells * cells / PI
}

fn has_beams(model: &Model) -> bool {
    match model {
        Model::Specular(_) | Model::Beam(_) | Model::Separated(_) => true,
        Model::Sum(s) => s.parts().iter().any(|(_, m)| has_beams(m)),
        Model::Turned(t) => has_beams(t.base()),
        Model::Interpolant(i) => i.distributions().iter().any(|d| d.beam > 0.0),
        Model::Matrix(_) | Model::Tree(_) | Model::Lambertian(_) | Model::Reversed(_) | Model::Filtered(_) => false,
    }
}

/// Pseudo-random direction `k` of stream `stream`.
fn random(stream: u64, k: u64) -> Disk {
    Disk::uniform([uniform(2 * stream, k), uniform(2 * stream + 1, k)])
}

fn rms_difference(tree: &Tree, model: &Model) -> f64 {
    // Chunks of one size, added in order: the same sum for any number of threads.
    const CHUNK: u64 = 4096;
    let sums: Vec<[f64; 2]> = (0..CHECKED_PAIRS / CHUNK)
        .into_par_iter()
        .map(|chunk| {
            (chunk * CHUNK..(chunk + 1) * CHUNK).fold([0.0; 2], |[square, sum], k| {
                let (i, o) = (random(11, k / CHECKED_EACH), random(12, k));
                let value = model.evaluate(i, o);
                [square + (tree.evaluate(i, o) - value).powi(2), sum + value]
            })
        })
        .collect();
    let n = CHECKED_PAIRS as f64;
    let [square, sum] = sums.iter().fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
    if sum > 0.0 {
        (square / n).sqrt() / (sum / n)
    } else {
        0.0
    }
}

fn worst_total(tree: &Tree, model: &Model) -> f64 {
    let difference = |k| {
        let incident = random(13, k);
        (tree.total(incident, Part::All).value - model.total(incident, Part::All).value).abs()
    };
    (0..CHECKED_TOTALS)
        .into_par_iter()
        .map(difference)
        .reduce(|| 0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::convert::testing::bushy;
    use crate::bsdf::convert::{Sampling, to_matrix};
    use crate::bsdf::{Beam, Cells, Lambertian, Matrix, Separated, Specular, Sum};

    fn grid(levels: u32, samples: u32) -> Grid {
        Grid {
            levels,
            samples,
            seed: 0,
        }
    }

    fn convert(model: &Model, rank: Rank, grid: Grid) -> TreeConversion {
        to_tree(model, rank, grid, None, &Progress::default()).unwrap()
    }

    fn noisy() -> Model {
        let basis = Arc::new(Basis::klems_full());
        Model::Matrix(Matrix::from_fn(basis.clone(), basis, |i, o| uniform(1, (i * 145 + o) as u64)).unwrap())
    }

    #[test]
    fn a_tree_becomes_itself() {
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let tree = bushy(rank);
            let conversion = convert(&Model::Tree(tree.clone()), rank, grid(4, 2));
            // Zero in the half of rank 3 that no direction reaches.
            assert!(conversion.rms_error.unwrap() < 1e-6, "{rank:?}");
            assert!(conversion.worst_direct_hemispherical < 1e-5);
        }
    }

    #[test]
    fn beams_and_diffusers_keep_their_value() {
        let parts = vec![
            (1.0, Arc::new(Model::Specular(Specular::constant(0.4).unwrap()))),
            (1.0, Arc::new(Model::Lambertian(Lambertian::new(0.3).unwrap()))),
        ];
        let model = Model::Sum(Sum::new(parts).unwrap());
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let conversion = convert(&model, rank, grid(4, 4));
            assert!(conversion.worst_direct_hemispherical < 1e-5, "{rank:?} {conversion:?}");
            assert_eq!(conversion.rms_error, None);
            // The beam goes straight on.
            let (i, cell) = (Disk::new(0.31, 0.22), PI / 256.0);
            let beam = conversion.tree.evaluate(i, i) - 0.3 / PI;
            let whole = if rank == Rank::Isotropic { 0.2 } else { 0.4 };
            assert!((beam * cell - whole).abs() < 1e-5, "{rank:?} {}", beam * cell);
        }
    }

    #[test]
    fn measured_beams_keep_their_light() {
        for rank in [Rank::Anisotropic, Rank::Isotropic] {
            let beam = Beam::new(Cells::Tree(rank, 4), vec![0.4; Cells::Tree(rank, 4).len()]).unwrap();
            let parts = vec![
                (0.5, Arc::new(Model::Beam(beam))),
                (1.0, Arc::new(Model::Lambertian(Lambertian::new(0.3).unwrap()))),
            ];
            let conversion = convert(&Model::Sum(Sum::new(parts).unwrap()), rank, grid(4, 4));
            assert!(conversion.worst_direct_hemispherical < 1e-5, "{rank:?} {conversion:?}");
            assert!(conversion.tree.total(Disk::NORMAL, Part::All).value > 0.49);
        }
    }

    #[test]
    fn a_matrix_keeps_its_flux() {
        let conversion = convert(&noisy(), Rank::Anisotropic, grid(4, 4));
        let rms = conversion.rms_error.unwrap();
        assert!(rms > 0.01 && rms < 0.6, "{rms}");
        let basis = Arc::new(Basis::klems_quarter());
        let matrix = |m: &Model| {
            to_matrix(m, &basis, &basis, Sampling::of(64), &Progress::default())
                .unwrap()
                .matrix
        };
        let (a, b) = (matrix(&noisy()), matrix(&Model::Tree(conversion.tree)));
        for i in 0..41 {
            assert!((a.direct_hemispherical(i) - b.direct_hemispherical(i)).abs() < 0.1);
        }
    }

    #[test]
    fn anisotropic_models_are_no_isotropic_trees() {
        let error = to_tree(
            &Model::Tree(bushy(Rank::Anisotropic)),
            Rank::Isotropic,
            grid(3, 2),
            None,
            &Progress::default(),
        );
        let text = error.unwrap_err().to_string();
        assert!(text.contains("use tensor4"), "{text}");
        let measured = anisotropy(&Model::Tree(bushy(Rank::Anisotropic)), &Progress::default()).unwrap();
        assert!(measured > MAX_ANISOTROPY && measured < 1.0, "{measured}");
    }

    #[test]
    fn a_table_of_an_isotropic_sample_is_isotropic() {
        // A forward lobe on Klems patches, whose rings have different numbers of cells.
        let basis = Arc::new(Basis::klems_full());
        let lobe = |i: usize, o: usize| (-40.0 * basis.centre(i).angle_to(basis.centre(o)).powi(2)).exp();
        let model = Model::Matrix(Matrix::from_fn(basis.clone(), basis.clone(), lobe).unwrap());
        let measured = anisotropy(&model, &Progress::default()).unwrap();
        assert!(measured < MAX_ANISOTROPY, "{measured}");
        let conversion = convert(&model, Rank::Isotropic, grid(4, 16));
        assert!(conversion.worst_direct_hemispherical < 0.05, "{conversion:?}");
    }

    #[test]
    fn separated_peaks_go_back_into_the_table() {
        let base = Arc::new(Model::Tree(bushy(Rank::Anisotropic)));
        let separated = Model::Separated(Separated::new(base.clone()).unwrap());
        let (a, b) = (
            convert(&separated, Rank::Anisotropic, grid(3, 2)),
            convert(&base, Rank::Anisotropic, grid(3, 2)),
        );
        assert_eq!(a.tree, b.tree);
    }
}
