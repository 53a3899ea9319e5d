//! Tensor trees as matrices without sampling: each leaf gives its value to the patches that its cell overlaps.

use rayon::prelude::*;

use super::cover::Cover;
use crate::basis::{Basis, Ring};
use crate::bsdf::{Rank, Tree, Turn};
use crate::error::Result;
use crate::progress::Progress;

/// Deepest tree that is converted so: 2^10 × 2^10 cells for each direction.
pub const MAX_DEPTH: u32 = 10;

/// Means of a tree, turned by `turn`, over patch pairs `[i * n_out + o]` (1/sr).
pub fn means(tree: &Tree, turn: Turn, incident: &Basis, outgoing: &Basis, progress: &Progress) -> Result<Vec<f64>> {
    match (tree.rank(), tree.turned(turn)) {
        (Rank::Isotropic, Some(turned)) => of_isotropic(&turned, incident, outgoing, progress),
        _ => of_anisotropic(tree, turn, incident, outgoing, progress),
    }
}

fn of_anisotropic(
    tree: &Tree,
    turn: Turn,
    incident: &Basis,
    outgoing: &Basis,
    progress: &Progress,
) -> Result<Vec<f64>> {
    let from = Cover::new(incident, turn, tree.depth());
    let same = incident == outgoing;
    let other = (!same).then(|| Cover::new(outgoing, turn, tree.depth()));
    let to = other.as_ref().unwrap_or(&from);
    let n_out = outgoing.len();
    let incident_parts = |level: usize, cell: [usize; 4]| from.of(level, [cell[0], cell[1]]);
    let mut sums = spread(
        tree,
        incident.len() * n_out,
        &|sums, level, cell, value| {
            for &(i, area_in) in incident_parts(level, cell) {
                let row = &mut sums[i as usize * n_out..(i as usize + 1) * n_out];
                for &(o, area_out) in to.of(level, [cell[2], cell[3]]) {
                    row[o as usize] += value * area_in * area_out;
                }
            }
        },
        progress,
    )?;
    let areas = outgoing.projected_solid_angles();
    for (i, row) in sums.chunks_exact_mut(n_out).enumerate() {
        let area_in = incident.projected_solid_angle(i);
        for (sum, area_out) in row.iter_mut().zip(&areas) {
            *sum /= area_in * area_out;
        }
    }
    Ok(sums)
}

/// Azimuths relative to the incident light are told apart by this many steps a turn.
const STEPS: usize = 1440;

/// First the means over incident rings, and over steps of relative azimuth in outgoing rings; then a patch pair takes these by
/// how often its azimuths differ by each step. The azimuth is the only thing that is not exact, and it conserves energy.
fn of_isotropic(tree: &Tree, incident: &Basis, outgoing: &Basis, progress: &Progress) -> Result<Vec<f64>> {
    let (rings_in, rings_out) = (incident.rings(), outgoing.rings());
    let steps: Vec<Ring> = rings_out
        .iter()
        .map(|ring| Ring {
            count: STEPS,
            ..ring.clone()
        })
        .collect();
    let cover = Cover::new(&Basis::from_rings("relative azimuth", steps)?, Turn::NONE, tree.depth());
    let width = rings_out.len() * STEPS;
    let radii: Vec<[f64; 2]> = (0..rings_in.len())
        .map(|ring| incident.limits(incident.first_of_ring(ring)).0.map(f64::sin))
        .collect();
    let by_steps = spread(
        tree,
        rings_in.len() * width,
        &|sums, level, cell, value| {
            let n = (1_usize << level) as f64;
            // The outermost radius comes first.
            let outer = 1.0 - 2.0 * cell[0] as f64 / n;
            let inner = (outer - 2.0 / n).max(0.0);
            if outer <= 0.0 {
                return;
            }
            for (&[low, high], sums) in radii.iter().zip(sums.chunks_exact_mut(width)) {
                let (a, b) = (low.max(inner), high.min(outer));
                if b > a {
                    let share = value * (b * b - a * a) / (high * high - low * low);
                    for &(step, area) in cover.of(level, [cell[1], cell[2]]) {
                        sums[step as usize] += share * area;
                    }
                }
            }
        },
        progress,
    )?;
    let mut means = Vec::with_capacity(incident.len() * outgoing.len());
    for i in 0..incident.len() {
        let (ring_in, cell_in) = incident.place(i);
        for o in 0..outgoing.len() {
            let (ring_out, cell_out) = outgoing.place(o);
            let (count_in, count_out) = (rings_in[ring_in].count, rings_out[ring_out].count);
            let first = ring_in * width + ring_out * STEPS;
            let between = cell_out as f64 / count_out as f64 - cell_in as f64 / count_in as f64;
            let flux = differing(&by_steps[first..first + STEPS], between, count_in, count_out);
            // The flux of a ring of patches that are alike, by that of one.
            means.push(flux / (outgoing.projected_solid_angle(o) * count_out as f64));
        }
    }
    Ok(means)
}

/// Mean over azimuths in two cells of rings, `between` apart (in turns), of what `steps` hold, times their number.
fn differing(steps: &[f64], between: f64, count_in: usize, count_out: usize) -> f64 {
    let n = steps.len() as f64;
    let (a, b) = (1.0 / count_in as f64, 1.0 / count_out as f64);
    // Chance that two uniform azimuths of widths a and b differ by less than x from their middles' difference.
    let ramp = |x: f64| 0.5 * x.max(0.0).powi(2);
    let (wide, narrow) = (0.5 * (a + b), 0.5 * (a - b));
    let below = |x: f64| (ramp(x + wide) - ramp(x + narrow) - ramp(x - narrow) + ramp(x - wide)) / (a * b);
    let first = ((between - wide) * n - 0.5).floor() as i64;
    let last = ((between + wide) * n + 0.5).ceil() as i64;
    let mut sum = 0.0;
    let mut lower = below((first as f64 - 0.5) / n - between);
    for step in first..=last {
        let upper = below((step as f64 + 0.5) / n - between);
        sum += steps[step.rem_euclid(steps.len() as i64) as usize] * (upper - lower);
        lower = upper;
    }
    sum * n
}

/// What a leaf adds to the sums: level, cell and value.
type Add<'a> = &'a (dyn Fn(&mut [f64], usize, [usize; 4], f64) + Sync);

/// Sums over all leaves, the parts of the root's children added in their order.
fn spread(tree: &Tree, size: usize, add: Add<'_>, progress: &Progress) -> Result<Vec<f64>> {
    let parts: Vec<Vec<f64>> = tree
        .top()
        .into_par_iter()
        .map(|top| {
            let mut sums = vec![0.0; size];
            let mut check = |level: usize| if level <= 3 { progress.check() } else { Ok(()) };
            tree.visit_leaves(top, &mut check, &mut |level, cell, value| {
                add(&mut sums, level, cell, value);
            })?;
            Ok(sums)
        })
        .collect::<Result<_>>()?;
    let mut sums = vec![0.0; size];
    for part in parts {
        for (sum, p) in sums.iter_mut().zip(part) {
            *sum += p;
        }
    }
    Ok(sums)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::bsdf::convert::testing::bushy;
    use crate::bsdf::convert::{Sampling, to_matrix};
    use crate::bsdf::{Model, Reversed, Turned};

    /// The same model by another way, on which only sampling is possible.
    fn sampled(model: &Model, turn: Turn) -> Model {
        let turned = Model::Turned(Turned::new(Arc::new(model.clone()), turn));
        Model::Reversed(Reversed::new(Arc::new(Model::Reversed(Reversed::new(Arc::new(
            turned,
        ))))))
    }

    #[test]
    fn leaves_and_samples_agree() {
        let bases = [Arc::new(Basis::klems_quarter()), Arc::new(Basis::klems_half())];
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let model = Model::Tree(bushy(rank));
            for turn in [Turn::NONE, Turn::new(0.6, false), Turn::new(2.0, true)] {
                let Model::Tree(tree) = &model else { unreachable!() };
                let exact = means(tree, turn, &bases[0], &bases[1], &Progress::default()).unwrap();
                let sampling = Sampling { samples: 1024, seed: 5 };
                let source = sampled(&model, turn);
                let other = to_matrix(&source, &bases[0], &bases[1], sampling, &Progress::default()).unwrap();
                let mean: f64 = exact.iter().sum::<f64>() / exact.len() as f64;
                let pairs = exact.iter().zip(other.matrix.values());
                let rms = (pairs.map(|(a, b)| (a - b).powi(2)).sum::<f64>() / exact.len() as f64).sqrt() / mean;
                assert!(
                    rms < 3.0 * other.rms_error + 1e-4,
                    "{rank:?} {turn:?}: {rms} {}",
                    other.rms_error
                );
                assert!(other.rms_error < 0.03);
            }
        }
    }

    #[test]
    fn a_constant_stays_a_constant() {
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let tree = Tree::constant(rank, 0.25).unwrap();
            let (full, quarter) = (Basis::klems_full(), Basis::klems_quarter());
            for value in means(&tree, Turn::new(0.3, true), &full, &quarter, &Progress::default()).unwrap() {
                assert!((value - 0.25).abs() < 1e-9, "{rank:?} {value}");
            }
        }
    }

    #[test]
    fn azimuths_differ_as_two_uniform_ones() {
        // All of the light in one step: the chances of the pairs of a ring sum to the whole.
        let mut steps = vec![0.0; STEPS];
        steps[37] = 1.0;
        for (a, b) in [(24, 24), (8, 20), (1, 16), (1, 1)] {
            let sum: f64 = (0..b)
                .map(|cell| differing(&steps, f64::from(cell) / f64::from(b), a, b as usize))
                .sum();
            assert!((sum / f64::from(b) - 1.0).abs() < 1e-9, "{a} {b}: {sum}");
        }
    }
}
