//! From scattered points to lobes.
//!
//! The hemisphere is divided in a square of equal solid angles. Each cell is the place of a lobe; the amplitudes, 0 or more, are
//! those of least squares, weighed by noise. Cells whose points the lobes miss are divided and all amplitudes found anew, until
//! the points are met or are too few to tell more. So neither the points' density nor a cell's centre of gravity biases the
//! result, negative readings pull as much as positive ones, and there are no more lobes than the light has detail.

use super::distribution::{CELLS, Distribution, WORDS, cell_middle, cell_of, chord2, from_square, to_square};
use super::lobe::{Lobe, Vector, kernel, unit_flux, vector};
use super::state::box_about;
use crate::direction::Disk;
use crate::error::{Error, Result};

/// Levels of division: 8 cells an axis at least (18°), 512 at most (0.3°).
const FIRST: u32 = 3;
const LAST: u32 = 9;
/// Radius of a lobe in widths of its cell: narrower ones sag between points that are as far apart as the light is wide.
const OVERLAP: f64 = 2.6;
/// Share of a value that lobes need not resolve.
const TOLERANCE: f64 = 0.02;
/// Points about a place that was not measured from which it is guessed.
const NEIGHBOURS: usize = 6;
/// Cells an axis in which places without points are looked for.
const FINE: usize = 32;

/// What was seen of light from one direction.
#[derive(Debug, Clone)]
pub struct Points<'a> {
    /// Where the light travels to.
    pub outgoing: &'a [Disk],
    /// BSDF (1/sr).
    pub values: &'a [f64],
    /// One standard deviation each (1/sr).
    pub errors: &'a [f64],
}

#[derive(Clone, Copy)]
struct Point {
    at: Vector,
    square: [f64; 2],
    value: f64,
    error: f64,
}

/// A part of the square and its lobe.
struct Cell {
    level: u32,
    corner: [f64; 2],
    points: Vec<u32>,
    centre: Disk,
    radius2: f64,
    amplitude: f64,
    /// What the lobe of amplitude 1 is at the points that it reaches.
    column: Vec<(u32, f64)>,
}

/// Lobes of measured points.
pub fn fit(incident: Disk, points: &Points<'_>) -> Result<Distribution> {
    if points.outgoing.len() < 4 {
        return Err(Error::Argument(format!(
            "{} points of light from {:.1}° are too few for a model (give 4 or more)",
            points.outgoing.len(),
            incident.theta().to_degrees()
        )));
    }
    let mut all: Vec<Point> = points
        .outgoing
        .iter()
        .zip(points.values.iter().zip(points.errors))
        .map(|(&o, (&value, &error))| point(o, value, error))
        .collect();
    let limit = points.outgoing.iter().map(|o| o.theta()).fold(0.0, f64::max);
    let mut covered = [0; WORDS];
    for &o in points.outgoing {
        let cell = cell_of(o, CELLS);
        covered[cell / 32] |= 1 << (cell % 32);
    }
    let floor = floor(&all);
    let mut distribution = Distribution {
        incident,
        lobes: Vec::new(),
        floor,
        beam: 0.0,
        extent: 0.0,
        limit,
        covered,
    };
    complete_peak(&mut all, &distribution);
    guess(&mut all, &distribution);
    for point in &mut all {
        point.value -= floor;
    }
    distribution.lobes = lobes(&all, floor);
    Ok(distribution)
}

fn point(at: Disk, value: f64, error: f64) -> Point {
    Point {
        at: vector(at),
        square: to_square(at),
        value,
        error,
    }
}

/// A value that nearly all directions reach: the low end of the means of cells.
fn floor(points: &[Point]) -> f64 {
    const LOW: f64 = 0.05;
    let mut sums = vec![[0.0; 2]; CELLS * CELLS];
    for point in points {
        let [x, y] = point.square.map(|c| (c * CELLS as f64) as usize);
        let sum = &mut sums[y * CELLS + x];
        sum[0] += point.value;
        sum[1] += 1.0;
    }
    let mut means: Vec<f64> = sums.iter().filter(|s| s[1] > 0.0).map(|s| s[0] / s[1]).collect();
    means.sort_by(f64::total_cmp);
    (0.95 * means[(LOW * means.len() as f64) as usize]).max(0.0)
}

/// Of a peak about the straight direction that the instrument's limit cuts, what lies beyond is taken from the opposite side.
fn complete_peak(points: &mut Vec<Point>, known: &Distribution) {
    const ABOUT: f64 = 0.14;
    const DOUBT: f64 = 0.1;
    let axis = vector(known.incident);
    if known.incident.theta() + ABOUT < known.limit {
        return;
    }
    let opposite = |p: &Point| {
        if chord2(axis, p.at) > ABOUT * ABOUT {
            return None;
        }
        let along = 2.0 * (axis[0] * p.at[0] + axis[1] * p.at[1] + axis[2] * p.at[2]);
        let [x, y, z]: Vector = std::array::from_fn(|k| along * axis[k] - p.at[k]);
        let image = Disk::new(x, y);
        (z > 0.0 && image.theta() > known.limit).then(|| point(image, p.value, p.error + DOUBT * p.value.abs()))
    };
    let images: Vec<Point> = points.iter().filter_map(opposite).collect();
    points.extend(images);
}

/// Adds points where none were measured: the mean of the nearest ones, so that the BSDF stays what it is and BSDF times cosine
/// falls to 0 at the horizon. They weigh little.
fn guess(points: &mut Vec<Point>, known: &Distribution) {
    const DOUBT: f64 = 0.3;
    const NEAR: f64 = 0.05;
    let measured = points.len();
    // Images of a peak stand for themselves.
    let known_points = points
        .iter()
        .take_while(|p| p.at[2] >= known.limit.cos() - 1e-9)
        .count();
    // Means of fine cells stand for the points, so that dense scans do not outvote others.
    let mut sums = vec![[0.0; 6]; FINE * FINE];
    for point in &points[..measured] {
        let [x, y] = point.square.map(|c| (c * FINE as f64) as usize);
        let sum = &mut sums[y * FINE + x];
        let [px, py, pz] = point.at;
        for (s, v) in sum.iter_mut().zip([px, py, pz, point.value, point.error, 1.0]) {
            *s += v;
        }
    }
    let means: Vec<(Vector, f64, f64)> = sums
        .iter()
        .filter(|s| s[5] > 0.0)
        .map(|s| ([s[0] / s[5], s[1] / s[5], s[2] / s[5]], s[3] / s[5], s[4] / s[5]))
        .collect();
    for cell in 0..FINE * FINE {
        let middle = cell_middle(cell, FINE);
        let at = vector(middle);
        if known.measured(middle) || points[known_points..].iter().any(|p| chord2(p.at, at) < NEAR * NEAR) {
            continue;
        }
        let mut nearest: Vec<(f64, usize)> = means.iter().enumerate().map(|(k, m)| (chord2(at, m.0), k)).collect();
        let count = NEIGHBOURS.min(nearest.len());
        nearest.select_nth_unstable_by(count - 1, |a, b| a.0.total_cmp(&b.0));
        let (mut sum, mut error, mut weight) = (0.0, 0.0, 0.0);
        for &(distance2, k) in &nearest[..count] {
            let w = 1.0 / (distance2 * distance2 + 1e-6);
            sum += w * means[k].1;
            error += w * means[k].2;
            weight += w;
        }
        let value = sum / weight;
        points.push(point(middle, value, error / weight + DOUBT * value.abs()));
    }
}

/// Lobes that meet the points.
fn lobes(points: &[Point], floor: f64) -> Vec<Lobe> {
    const LEAST_SHARE: f64 = 1e-7;
    let weights = weights(points, floor);
    let buckets = Buckets::new(points);
    let mut cells = first_cells(points, &buckets);
    loop {
        let rest = solve(points, &weights, &mut cells);
        let before = cells.len();
        divide(points, &weights, &rest, &buckets, &mut cells);
        if cells.len() == before {
            break;
        }
    }
    let lobes: Vec<Lobe> = cells
        .iter()
        .map(|cell| Lobe {
            centre: cell.centre,
            radius2: cell.radius2,
            flux: cell.amplitude * unit_flux(cell.centre, cell.radius2),
        })
        .collect();
    let total: f64 = lobes.iter().map(|l| l.flux).sum::<f64>() + std::f64::consts::PI * floor;
    lobes.into_iter().filter(|l| l.flux > LEAST_SHARE * total).collect()
}

/// 1 / variance of what lobes need to meet: noise, and a share of the level about a point. What lies beside something bright is
/// not known better than that is resolved.
fn weights(points: &[Point], floor: f64) -> Vec<f64> {
    const NEAR: usize = 64;
    const BESIDE: f64 = 0.1;
    const AMONG: f64 = 0.5;
    let (near, coarse) = (means(points, NEAR), means(points, CELLS));
    let about = |k: usize| k.saturating_sub(1)..(k + 2).min(NEAR);
    points
        .iter()
        .map(|p| {
            let [x, y] = p.square.map(|c| (c * NEAR as f64) as usize);
            let beside = about(y)
                .flat_map(|row| near[row * NEAR..][about(x)].iter().copied())
                .fold(0.0, f64::max);
            let [u, v] = p.square.map(|c| (c * CELLS as f64) as usize);
            let among = AMONG * coarse[v * CELLS + u];
            let level = floor + near[y * NEAR + x].max(among).max(BESIDE * beside);
            1.0 / (p.error * p.error + (TOLERANCE * level).powi(2) + f64::MIN_POSITIVE)
        })
        .collect()
}

/// Mean values of cells, without values below 0; 0 where there are no points.
fn means(points: &[Point], cells: usize) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; cells * cells];
    for point in points {
        let [x, y] = point.square.map(|c| (c * cells as f64) as usize);
        let sum = &mut sums[y * cells + x];
        sum[0] += point.value.max(0.0);
        sum[1] += 1.0;
    }
    sums.into_iter()
        .map(|[sum, count]| if count > 0.0 { sum / count } else { 0.0 })
        .collect()
}

/// Points by place.
struct Buckets<'a> {
    points: &'a [Point],
    numbers: Vec<Vec<u32>>,
}

impl<'a> Buckets<'a> {
    fn new(points: &'a [Point]) -> Self {
        let mut numbers = vec![Vec::new(); FINE * FINE];
        for (k, point) in points.iter().enumerate() {
            let [x, y] = point.square.map(|c| (c * FINE as f64) as usize);
            numbers[y * FINE + x].push(k as u32);
        }
        Self { points, numbers }
    }

    /// The points that a lobe reaches, and what it is there.
    fn column(&self, centre: Vector, radius2: f64) -> Vec<(u32, f64)> {
        let [x, y] = box_about(centre, radius2.sqrt(), FINE);
        let mut column = Vec::new();
        for row in y.0..y.1 {
            for &k in self.numbers[row * FINE + x.0..row * FINE + x.1].iter().flatten() {
                let at = self.points[k as usize].at;
                let below = [at[0], at[1], -at[2]];
                let v = kernel(chord2(centre, at) / radius2) + kernel(chord2(centre, below) / radius2);
                if v > 0.0 {
                    column.push((k, v));
                }
            }
        }
        column
    }
}

impl Cell {
    fn new(level: u32, corner: [f64; 2], points: Vec<u32>, amplitude: f64, buckets: &Buckets<'_>) -> Self {
        let width = width(level);
        let centre = from_square(corner.map(|c| c + 0.5 * width));
        let radius = OVERLAP * width * std::f64::consts::TAU.sqrt();
        let radius2 = radius * radius;
        Self {
            level,
            corner,
            points,
            centre,
            radius2,
            amplitude,
            column: buckets.column(vector(centre), radius2),
        }
    }
}

fn width(level: u32) -> f64 {
    1.0 / f64::from(1_u32 << level)
}

fn first_cells(points: &[Point], buckets: &Buckets<'_>) -> Vec<Cell> {
    let n = 1_usize << FIRST;
    let mut own = vec![Vec::new(); n * n];
    for (k, point) in points.iter().enumerate() {
        let [x, y] = point.square.map(|c| (c * n as f64) as usize);
        own[y * n + x].push(k as u32);
    }
    let cell = |(k, own): (usize, Vec<u32>)| {
        let mean = own.iter().map(|&k| points[k as usize].value).sum::<f64>() / own.len().max(1) as f64;
        // So many lobes lie over each other.
        let amplitude = mean.max(0.0) / (0.25 * std::f64::consts::PI * OVERLAP * OVERLAP);
        let corner = [k % n, k / n].map(|c| c as f64 * width(FIRST));
        Cell::new(FIRST, corner, own, amplitude, buckets)
    };
    own.into_iter().enumerate().map(cell).collect()
}

/// Adds quarters to cells whose points are missed, if there are enough points about to tell where.
fn divide(points: &[Point], weights: &[f64], rest: &[f64], buckets: &Buckets<'_>, cells: &mut Vec<Cell>) {
    /// Mean square over what is allowed; noise alone comes to 1.
    const MISSED: f64 = 1.5;
    const LEAST: usize = 14;
    for k in 0..cells.len() {
        let cell = &mut cells[k];
        let miss = |&k: &u32| weights[k as usize] * rest[k as usize].powi(2);
        let chi2 = cell.points.iter().map(miss).sum::<f64>() / cell.points.len().max(1) as f64;
        if cell.level == LAST || chi2 < MISSED || cell.column.len() < LEAST {
            continue;
        }
        let (level, half, corner) = (cell.level + 1, width(cell.level + 1), cell.corner);
        let mut own: [Vec<u32>; 4] = Default::default();
        for k in std::mem::take(&mut cell.points) {
            let square = points[k as usize].square;
            let x = usize::from(square[0] >= corner[0] + half);
            let y = usize::from(square[1] >= corner[1] + half);
            own[2 * y + x].push(k);
        }
        for (k, own) in own.into_iter().enumerate() {
            let corner = [corner[0] + half * (k % 2) as f64, corner[1] + half * (k / 2) as f64];
            cells.push(Cell::new(level, corner, own, 0.0, buckets));
        }
    }
}

/// Amplitudes of 0 or more by least squares, coordinate after coordinate, and what they leave of the points' values. Where points
/// say little a lobe is small.
fn solve(points: &[Point], weights: &[f64], cells: &mut [Cell]) -> Vec<f64> {
    const SWEEPS: usize = 60;
    const ASKED: usize = 4;
    const STILL: f64 = 1e-4;
    const BEYOND: f64 = 1.6;
    const RIDGE: f64 = 0.0005;
    let mut rest: Vec<f64> = points.iter().map(|p| p.value).collect();
    for cell in &*cells {
        for &(k, v) in &cell.column {
            rest[k as usize] -= v * cell.amplitude;
        }
    }
    // Curvature, and the pull toward 0: as that of a lobe with a point of the mean weight about it.
    let stiffness: Vec<(f64, f64)> = cells
        .iter()
        .map(|cell| {
            let (mut curvature, mut weighed, mut sum) = (0.0, 0.0, 0.0);
            for &(k, v) in &cell.column {
                let weight = weights[k as usize];
                curvature += weight * v * v;
                weighed += weight * v;
                sum += v;
            }
            let mean = if sum > 0.0 { weighed / sum } else { 0.0 };
            (curvature, RIDGE * curvature.max(mean))
        })
        .collect();
    for sweep in 0..SWEEPS {
        let (mut moved, mut whole) = (0.0, 0.0);
        for (j, &(curvature, ridge)) in stiffness.iter().enumerate() {
            let amplitude = cells[j].amplitude;
            // What is 0 mostly stays so: it is asked now and then.
            if ridge <= 0.0 || (amplitude == 0.0 && sweep % ASKED > 0) {
                continue;
            }
            let pull: f64 = cells[j]
                .column
                .iter()
                .map(|&(k, v)| weights[k as usize] * v * rest[k as usize])
                .sum();
            let step = (pull - ridge * amplitude) / (curvature + ridge);
            let next = (amplitude + BEYOND * step).max(0.0);
            let change = next - amplitude;
            moved += change.abs() * cells[j].radius2;
            whole += next * cells[j].radius2;
            if change != 0.0 {
                cells[j].amplitude = next;
                for &(k, v) in &cells[j].column {
                    rest[k as usize] -= v * change;
                }
            }
        }
        if moved < STILL * whole {
            break;
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::{r2, uniform};

    /// Points of a lobe and a floor, evenly over the hemisphere up to 80°, finer about the lobe.
    fn seen(f: impl Fn(Disk) -> f64, peak: Disk, noise: f64) -> Distribution {
        let even = (0..3000).map(|k| from_square(r2(k, [0.1; 2])));
        let fine = (0..2000).map(|k| {
            let [u, v] = r2(k, [0.6; 2]);
            super::super::lobe::draw(vector(peak), 0.02, [u * u, v])
        });
        let outgoing: Vec<Disk> = even.chain(fine).filter(|o| o.theta() < 80_f64.to_radians()).collect();
        let normal = |k: usize| (0..12).map(|j| uniform(j, k as u64)).sum::<f64>() - 6.0;
        let values: Vec<f64> = outgoing
            .iter()
            .enumerate()
            .map(|(k, &o)| f(o) + noise * normal(k))
            .collect();
        let errors = vec![noise; values.len()];
        fit(
            Disk::NORMAL,
            &Points {
                outgoing: &outgoing,
                values: &values,
                errors: &errors,
            },
        )
        .unwrap()
    }

    #[test]
    fn integrals_come_back() {
        let peak = Disk::from_angles(0.6, 1.0);
        for (height, width) in [(0.0, 0.1), (30.0, 0.02), (3.0, 0.2)] {
            let f = |o: Disk| 0.1 + height * (-0.5 * chord2(vector(o), vector(peak)) / (width * width)).exp();
            let n = 1 << 18;
            let truth: f64 =
                (0..n).map(|k| f(Disk::uniform(r2(k, [0.0; 2])))).sum::<f64>() / f64::from(n) * std::f64::consts::PI;
            for noise in [1e-4, 0.02] {
                let found = seen(f, peak, noise).scattered();
                assert!(
                    (found / truth - 1.0).abs() < 0.01,
                    "{height} {width} {noise}: {found} {truth}"
                );
            }
        }
    }

    #[test]
    fn noise_about_nothing_is_nearly_nothing() {
        let found = seen(|_| 0.0, Disk::NORMAL, 0.01).scattered();
        assert!(found < 0.003, "{found}");
    }
}
