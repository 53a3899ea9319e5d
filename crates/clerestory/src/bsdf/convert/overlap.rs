//! Exact overlaps of the patches of two bases. Patches are rectangles in (sin²θ, azimuth), in which projected solid angle
//! is area, so overlaps are products of two lengths.

use std::f64::consts::TAU;

use crate::basis::Basis;
use crate::bsdf::Turn;

/// For each patch of `target` the patches of `source`, turned by `turn`, that cover it, and the share of its projected solid
/// angle that each one covers. The shares of a patch sum to 1.
pub fn shares(target: &Basis, source: &Basis, turn: Turn) -> Vec<Vec<(usize, f64)>> {
    let rings = |basis: &Basis| -> Vec<[f64; 2]> {
        let count = basis.rings().len();
        (0..count)
            .map(|ring| {
                let sin2 = |patch: usize, end: usize| basis.limits(patch).0[end].sin().powi(2);
                let first = basis.first_of_ring(ring);
                // The same limit gives the same bits on both sides, and the last one is 1.
                let lower = if ring == 0 {
                    0.0
                } else {
                    sin2(basis.first_of_ring(ring - 1), 1)
                };
                [lower, if ring + 1 == count { 1.0 } else { sin2(first, 1) }]
            })
            .collect()
    };
    let (target_rings, source_rings) = (rings(target), rings(source));
    (0..target.len())
        .map(|patch| {
            let (ring, cell) = target.place(patch);
            let [low, high] = target_rings[ring];
            let mut covers = Vec::new();
            for (s, &[a, b]) in source_rings.iter().enumerate() {
                let radial = (high.min(b) - low.max(a)) / (high - low);
                if radial <= 1e-12 {
                    continue;
                }
                for (other, share) in arcs(target.rings()[ring].count, cell, source.rings()[s].count, turn) {
                    covers.push((source.first_of_ring(s) + other, radial * share));
                }
            }
            let sum: f64 = covers.iter().map(|c| c.1).sum();
            for cover in &mut covers {
                cover.1 /= sum;
            }
            covers
        })
        .collect()
}

/// Cells of a ring of `source` equal arcs, mirrored and turned, that cover cell `cell` of `target` equal arcs, with shares.
fn arcs(target: usize, cell: usize, source: usize, turn: Turn) -> Vec<(usize, f64)> {
    if source == 1 {
        return vec![(0, 1.0)];
    }
    // The cell's limits in the source's frame, in units of the source's cells counted from the lower end of cell 0.
    let width = source as f64 / target as f64;
    let mut centre = cell as f64 * width - turn.angle() / TAU * source as f64;
    if turn.mirror() {
        // A mirror image takes azimuth φ to 180° − φ.
        centre = source as f64 / 2.0 - centre;
    }
    let (low, high) = (centre - width / 2.0 + 0.5, centre + width / 2.0 + 0.5);
    let mut covers = Vec::new();
    let mut at = low.floor();
    while at < high {
        let share = (high.min(at + 1.0) - low.max(at)) / width;
        if share > 1e-12 {
            covers.push(((at as i64).rem_euclid(source as i64) as usize, share));
        }
        at += 1.0;
    }
    covers
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_basis_covers_itself_patch_by_patch() {
        for basis in [
            Basis::klems_full(),
            Basis::klems_quarter(),
            Basis::tregenza(),
            Basis::iea21(),
        ] {
            for (patch, covers) in shares(&basis, &basis, Turn::NONE).iter().enumerate() {
                assert_eq!(covers.len(), 1, "{} {patch} {covers:?}", basis.name());
                assert!(covers[0].0 == patch && (covers[0].1 - 1.0).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn shares_are_what_points_show() {
        let (target, source) = (Basis::klems_half(), Basis::klems_full());
        for turn in [Turn::NONE, Turn::new(0.3, false), Turn::new(-1.1, true)] {
            for (patch, covers) in shares(&target, &source, turn).iter().enumerate() {
                let n = 20_000;
                let mut counts = vec![0; source.len()];
                for k in 0..n {
                    let point = target.sample_cosine(patch, crate::sequence::r2(k, [0.1, 0.7]));
                    counts[source.patch_of(turn.inverse().apply(point))] += 1;
                }
                for (s, &count) in counts.iter().enumerate() {
                    let share: f64 = covers.iter().filter(|c| c.0 == s).map(|c| c.1).sum();
                    let seen = f64::from(count) / f64::from(n);
                    assert!(
                        (share - seen).abs() < 2e-3,
                        "{turn:?} patch {patch} source {s}: {share} {seen}"
                    );
                }
            }
        }
    }
}
