//! Interpolants as tensor trees without sampling outgoing directions: all lobes of one incident direction are spread over
//! all cells at once.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::bsdf::interpolant::{Interpolant, Raster};
use crate::bsdf::tree::Grid;
use crate::bsdf::{Model, Rank, Tree};
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;

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
