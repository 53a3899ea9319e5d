//! Interpolants as tensor trees without sampling outgoing directions: all lobes of one incident direction are spread over
//! all cells at once.

use std::f64::consts::PI;

use rayon::prelude::*;

use crate::bsdf::interpolant::{Interpolant, Raster};
use crate::bsdf::tree::Grid;
use crate::bsdf::{Rank, Tree};
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;

/// Incident directions an axis of a cell: so many where a cell is sampled at all.
const ACROSS: usize = 2;

/// Means over the cells of a tree of rank 4, or of rank 3 for an isotropic interpolant.
pub fn to_tree(model: &Interpolant, rank: Rank, grid: Grid, progress: &Progress) -> Result<Tree> {
    let n = 1_usize << grid.levels;
    let raster = Raster::new(n);
    let across = if grid.samples == 1 { 1 } else { ACROSS };
    let (incident, points) = match rank {
        Rank::Anisotropic => (n * n, across * across),
        // Half of the first axis: no direction reaches the other one.
        Rank::Isotropic => ((n / 2).max(1), across),
    };
    let place = |cell: usize, k: usize| {
        let inner = |k: usize| (k as f64 + 0.5) / across as f64;
        let at = |c: usize, k: usize| (c as f64 + inner(k)) / n as f64;
        match rank {
            Rank::Anisotropic => Disk::from_square([at(cell / n, k / across), at(cell % n, k % across)]),
            Rank::Isotropic => {
                let [outer, inside] = [cell, cell + 1].map(|c| (1.0 - 2.0 * c as f64 / n as f64).max(0.0));
                let r2 = outer * outer + (inside * inside - outer * outer) * inner(k);
                Disk::new(r2.sqrt(), 0.0)
            }
        }
    };
    // A peak that follows the light is drawn out by what lies between the incident points.
    let spread2 = PI / (n * n * points) as f64 / 12.0;
    progress.expect(incident);
    let mut values = vec![0.0_f32; incident * n * n];
    values.par_chunks_exact_mut(n * n).enumerate().try_for_each_init(
        || vec![0.0; n * n],
        |sums, (cell, row)| {
            sums.fill(0.0);
            for k in 0..points {
                model.state(place(cell, k)).add_to(&raster, sums, spread2);
            }
            for (value, sum) in row.iter_mut().zip(sums.iter()) {
                *value = (sum / points as f64) as f32;
            }
            progress.step()
        },
    )?;
    Tree::from_grid(rank, grid.levels, &values)
}
