//! Exact overlaps of the patches of a basis with the square cells of a tensor tree.
//!
//! The concentric map keeps areas, and in each quarter of the square, between the diagonals, it is linear along rays: a patch
//! becomes a trapezoid there. Its overlap with a cell is the area of a clipped polygon.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::basis::Basis;
use crate::bsdf::Turn;

/// Patches of a basis and the projected solid angles (sr) that they have in common with the cells of a grid, level by level.
pub struct Cover {
    levels: Vec<Vec<Vec<(u32, f64)>>>,
}

impl Cover {
    /// Of all patches of a basis, in the frame of a sample that was turned by `turn`, over 2^depth cells an axis.
    pub fn new(basis: &Basis, turn: Turn, depth: u32) -> Self {
        let n = 1_usize << depth;
        let mut finest = vec![Vec::new(); n * n];
        for patch in 0..basis.len() {
            for (trapezoid, quarter) in trapezoids(basis, patch, turn) {
                add(&mut finest, n, patch as u32, &turned(trapezoid, quarter));
            }
        }
        let mut levels = vec![finest];
        for level in (0..depth).rev() {
            let n = 1_usize << level;
            let finer = levels.last().expect("one at least");
            let join = |cell: usize| {
                let (x, y) = (cell % n, cell / n);
                let mut all: Vec<(u32, f64)> = (0..4)
                    .flat_map(|k| finer[(2 * y + k / 2) * 2 * n + 2 * x + k % 2].iter().copied())
                    .collect();
                all.sort_by_key(|c| c.0);
                all.dedup_by(|next, kept| {
                    let same = next.0 == kept.0;
                    if same {
                        kept.1 += next.1;
                    }
                    same
                });
                all
            };
            let coarser = (0..n * n).map(join).collect();
            levels.push(coarser);
        }
        levels.reverse();
        Self { levels }
    }

    /// Patches that share a cell, and how much.
    pub fn of(&self, level: usize, [x, y]: [usize; 2]) -> &[(u32, f64)] {
        &self.levels[level][(y << level) + x]
    }
}

type Point = [f64; 2];

/// A patch as trapezoids of the quarter about +x of the square from -1 to 1, and the quarter turns that take them to their
/// places.
fn trapezoids(basis: &Basis, patch: usize, turn: Turn) -> Vec<([Point; 4], usize)> {
    let (theta, phi) = basis.limits(patch);
    let [inner, outer] = theta.map(f64::sin);
    // The patch's azimuths in the sample's frame before it was turned.
    let (mut low, mut high) = (phi[0] - turn.angle(), phi[1] - turn.angle());
    if turn.mirror() {
        (low, high) = (PI - high, PI - low);
    }
    // Quarter k reaches from -45° to 45° about k · 90°.
    let mut quarter = ((low + FRAC_PI_4) / FRAC_PI_2).floor();
    let mut parts = Vec::new();
    while quarter * FRAC_PI_2 - FRAC_PI_4 < high {
        let middle = quarter * FRAC_PI_2;
        let slope = |azimuth: f64| ((azimuth - middle) / FRAC_PI_4).clamp(-1.0, 1.0);
        let (a, b) = (slope(low), slope(high));
        if b > a {
            let corners = [
                [inner, inner * a],
                [outer, outer * a],
                [outer, outer * b],
                [inner, inner * b],
            ];
            parts.push((corners, (quarter as i64).rem_euclid(4) as usize));
        }
        quarter += 1.0;
    }
    parts
}

fn turned(corners: [Point; 4], quarters: usize) -> [Point; 4] {
    corners.map(|[x, y]| match quarters {
        0 => [x, y],
        1 => [-y, x],
        2 => [-x, -y],
        _ => [y, -x],
    })
}

/// Adds a convex polygon to the cells that it touches.
fn add(cells: &mut [Vec<(u32, f64)>], n: usize, patch: u32, corners: &[Point; 4]) {
    let scale = n as f64 / 2.0;
    let range = |axis: usize| {
        let values = corners.map(|c| (c[axis] + 1.0) * scale);
        let low = values.into_iter().fold(f64::INFINITY, f64::min).floor().max(0.0) as usize;
        let high = values.into_iter().fold(0.0, f64::max).ceil().min(n as f64) as usize;
        low..high
    };
    let edge = |k: usize| k as f64 / scale - 1.0;
    for y in range(1) {
        let strip = clipped(&clipped(corners, 1, edge(y), 1.0), 1, edge(y + 1), -1.0);
        for x in range(0) {
            let part = clipped(&clipped(&strip, 0, edge(x), 1.0), 0, edge(x + 1), -1.0);
            // The square of area 4 is the hemisphere of π.
            let shared = area(&part) * FRAC_PI_4;
            if shared > 1e-15 {
                let cell = &mut cells[y * n + x];
                match cell.last_mut() {
                    Some((last, sum)) if *last == patch => *sum += shared,
                    _ => cell.push((patch, shared)),
                }
            }
        }
    }
}

/// The part of a convex polygon on the upper (`sign` 1) or lower (-1) side of a line across an axis.
fn clipped(polygon: &[Point], axis: usize, line: f64, sign: f64) -> Vec<Point> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &here) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let (a, b) = (sign * (here[axis] - line), sign * (next[axis] - line));
        if a >= 0.0 {
            kept.push(here);
        }
        if (a > 0.0 && b < 0.0) || (a < 0.0 && b > 0.0) {
            let t = a / (a - b);
            kept.push([here[0] + t * (next[0] - here[0]), here[1] + t * (next[1] - here[1])]);
        }
    }
    kept
}

fn area(polygon: &[Point]) -> f64 {
    let Some(&first) = polygon.first() else { return 0.0 };
    let cross = |a: Point, b: Point| (a[0] - first[0]) * (b[1] - first[1]) - (a[1] - first[1]) * (b[0] - first[0]);
    (0.5 * polygon.windows(2).map(|w| cross(w[0], w[1])).sum::<f64>()).abs()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::Disk;

    #[test]
    fn patches_and_cells_are_covered_wholly() {
        for basis in [Basis::klems_full(), Basis::klems_quarter(), Basis::iea21()] {
            for turn in [Turn::NONE, Turn::new(0.7, true)] {
                let cover = Cover::new(&basis, turn, 4);
                for level in 0..=4 {
                    let n = 1 << level;
                    let mut patches = vec![0.0; basis.len()];
                    for cell in 0..n * n {
                        let parts = cover.of(level, [cell % n, cell / n]);
                        let sum: f64 = parts.iter().map(|c| c.1).sum();
                        assert!((sum * (n * n) as f64 - PI).abs() < 1e-9, "{level} {cell} {sum}");
                        for &(patch, shared) in parts {
                            patches[patch as usize] += shared;
                        }
                    }
                    for (p, sum) in patches.iter().enumerate() {
                        assert!(
                            (sum - basis.projected_solid_angle(p)).abs() < 1e-9,
                            "{} {p}",
                            basis.name()
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn overlaps_are_what_points_show() {
        let basis = Basis::klems_half();
        for turn in [Turn::NONE, Turn::new(0.4, false), Turn::new(-1.9, true)] {
            let cover = Cover::new(&basis, turn, 3);
            for (x, y) in [(0, 0), (3, 4), (7, 2), (5, 6), (4, 3)] {
                let points = 20_000;
                let mut counts = vec![0; basis.len()];
                for k in 0..points {
                    let u = crate::sequence::r2(k, [0.2, 0.9]);
                    let square = [(f64::from(x) + u[0]) / 8.0, (f64::from(y) + u[1]) / 8.0];
                    counts[basis.patch_of(turn.apply(Disk::from_square(square)))] += 1;
                }
                for (p, &count) in counts.iter().enumerate() {
                    let parts = cover.of(3, [x as usize, y as usize]).iter();
                    let share: f64 = parts.filter(|c| c.0 as usize == p).map(|c| c.1 * 64.0 / PI).sum();
                    let seen = f64::from(count) / f64::from(points);
                    assert!(
                        (share - seen).abs() < 2e-3,
                        "{turn:?} cell {x} {y} patch {p}: {share} {seen}"
                    );
                }
            }
        }
    }
}
