//! Interpolants as tensor trees and matrices without sampling outgoing directions: all lobes of one incident direction are
//! spread over all cells at once.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::kernel::{Means, rows};
use super::points::Points;
use crate::basis::Basis;
use crate::bsdf::interpolant::{Interpolant, Lobe, Raster, State};
use crate::bsdf::tree::Grid;
use crate::bsdf::{Model, Rank, Tree, Turn};
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;
use crate::sequence::r2;

/// The tree that stands for an interpolant where its paths are travelled backwards: 64 cells an axis for an isotropic one, 32 for
/// all others.
pub fn as_tree(model: &Interpolant) -> Model {
    let (rank, levels) = if model.isotropic() {
        (Rank::Isotropic, 6)
    } else {
        (Rank::Anisotropic, 5)
    };
    let grid = Grid {
        levels,
        samples: 1,
        seed: 0,
    };
    let tree = to_tree(model, rank, grid, &Progress::default());
    Model::Tree(tree.expect("an interpolant's values are finite and not negative"))
}

/// Means over the cells of a tree of rank 4, or of rank 3 for an isotropic interpolant.
pub fn to_tree(model: &Interpolant, rank: Rank, grid: Grid, progress: &Progress) -> Result<Tree> {
    let n = 1_usize << grid.levels;
    let raster = Raster::new(n);
    let incident = match rank {
        Rank::Anisotropic => n * n,
        // Half of the first axis: no direction reaches the other one.
        Rank::Isotropic => (n / 2).max(1),
    };
    // The middle of a cell, by area.
    let middle = |cell: usize| {
        let at = |c: usize| (c as f64 + 0.5) / n as f64;
        match rank {
            Rank::Anisotropic => Disk::from_square([at(cell / n), at(cell % n)]),
            Rank::Isotropic => {
                let [outer, inside] = [cell, cell + 1].map(|c| (1.0 - 2.0 * c as f64 / n as f64).max(0.0));
                Disk::new((0.5 * (outer * outer + inside * inside)).sqrt(), 0.0)
            }
        }
    };
    // A peak that follows the light is drawn out by the cell that the light comes from.
    let spread2 = PI / (n * n) as f64 / 12.0;
    progress.expect(incident);
    let mut values = vec![0.0_f32; incident * n * n];
    values.par_chunks_exact_mut(n * n).enumerate().try_for_each_init(
        || vec![0.0; n * n],
        |sums, (cell, row)| {
            sums.fill(0.0);
            model.state(middle(cell)).add_to(&raster, sums, spread2);
            for (value, sum) in row.iter_mut().zip(sums.iter()) {
                *value = *sum as f32;
            }
            progress.step()
        },
    )?;
    Tree::from_grid(rank, grid.levels, &values)
}

/// Means over pairs of patches. One incident direction stands for 16 pairs of directions, as all light from it is known.
///
/// Wide lobes are spread over cells, of which it is known in which patches they lie; narrow ones are drawn from, as cells would
/// smear them over the patches' borders.
pub fn means(
    model: &Interpolant,
    turn: Turn,
    incident: &Points,
    outgoing: &Points,
    progress: &Progress,
) -> Result<Means> {
    const PAIRS: usize = 16;
    /// Cells a patch, at least.
    const CELLS: usize = 25;
    const MOST: usize = 512;
    /// Radius of a narrow lobe, in cells.
    const NARROW: f64 = 4.0;
    const DRAWS: usize = 16;
    let incident = incident.thinned(PAIRS);
    let n = ((CELLS * outgoing.basis.len()) as f64).sqrt().ceil() as usize;
    let n = n.next_power_of_two().min(MOST);
    let (raster, patches) = (Raster::new(n), Patches::new(n, turn, &outgoing.basis));
    let narrow2 = NARROW * NARROW * PI / (n * n) as f64;
    let back = turn.inverse();
    rows(&incident, outgoing, progress, |i, halves| {
        let mut sums = vec![0.0; raster.cells()];
        let mut drawn = 0;
        for (half, row) in halves.iter_mut().enumerate() {
            sums.fill(0.0);
            let mut add = |to: Disk, flux: f64| {
                let o = outgoing.basis.patch_of(turn.apply(to));
                row[o] += flux / outgoing.basis.projected_solid_angle(o);
            };
            for &point in incident.of(i).iter().skip(half).step_by(2) {
                let (lobes, floor, peak) = model.parts(back.apply(point));
                if let Some(peak) = peak {
                    add(peak.outgoing, peak.value);
                }
                let (narrow, wide): (Vec<Lobe>, Vec<Lobe>) = lobes.into_iter().partition(|l| l.radius2 < narrow2);
                for lobe in narrow {
                    let to: [Disk; DRAWS] = std::array::from_fn(|k| lobe.draw(r2(drawn + k as u32, [0.5; 2])));
                    drawn += DRAWS as u32;
                    let heights: f64 = to.iter().map(|t| t.cos_theta()).sum();
                    for t in to {
                        add(t, lobe.flux * t.cos_theta() / heights);
                    }
                }
                State::new(&wide, floor, None).add_to(&raster, &mut sums, 0.0);
            }
            patches.add(&sums, row);
        }
    })
}

/// Which patches the cells of a raster lie in.
struct Patches {
    /// By cell: patches, and the share of the patch that lies in the cell.
    shares: Vec<Vec<(usize, f64)>>,
}

impl Patches {
    /// For `n` cells an axis, turned by `turn`.
    fn new(n: usize, turn: Turn, basis: &Basis) -> Self {
        /// Points an axis of a cell.
        const FINE: usize = 16;
        let all = n * FINE;
        let at = |k: usize| (k as f64 + 0.5) / all as f64;
        let patch = |x: usize, y: usize| basis.patch_of(turn.apply(Disk::from_square([at(x), at(y)])));
        let mut shares: Vec<Vec<(usize, f64)>> = (0..n * n)
            .into_par_iter()
            .map(|cell| {
                let (x, y) = (cell / n * FINE, cell % n * FINE);
                let mut own: Vec<(usize, f64)> = Vec::new();
                for k in 0..FINE * FINE {
                    let o = patch(x + k / FINE, y + k % FINE);
                    match own.iter_mut().find(|(p, _)| *p == o) {
                        Some((_, count)) => *count += 1.0,
                        None => own.push((o, 1.0)),
                    }
                }
                own
            })
            .collect();
        let mut counts = vec![0.0; basis.len()];
        for &(o, count) in shares.iter().flatten() {
            counts[o] += count;
        }
        for (o, share) in shares.iter_mut().flatten() {
            *share /= counts[*o];
        }
        Self { shares }
    }

    /// Adds the means over patches of values of cells.
    fn add(&self, values: &[f64], row: &mut [f64]) {
        for (own, value) in self.shares.iter().zip(values) {
            for &(o, share) in own {
                row[o] += share * value;
            }
        }
    }
}
