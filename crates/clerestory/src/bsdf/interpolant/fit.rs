//! From scattered points to lobes.
//!
//! The hemisphere is divided, in a square of equal solid angles, where points are many and do not lie on a plane within their
//! noise. Each cell is the place of a lobe; the amplitudes, 0 or more, are those of least squares, weighed by noise. So neither
//! the points' density nor a cell's centre of gravity biases the result, and negative readings pull as much as positive ones.

use super::distribution::{CELLS, Distribution, WORDS, cell_middle, cell_of, chord2, from_square, to_square};
use super::lobe::{Lobe, Vector, kernel, unit_flux, vector};
use crate::direction::Disk;
use crate::error::{Error, Result};

/// Levels of division: 8 cells an axis at least (18°), 512 at most (0.3°).
const FIRST: u32 = 3;
const LAST: u32 = 9;
/// Radius of a lobe in widths of its cell.
const OVERLAP: f64 = 2.3;
/// Share of a value that lobes need not resolve.
const TOLERANCE: f64 = 0.02;
/// Sweeps over all amplitudes.
const SWEEPS: usize = 40;
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

struct Cell {
    corner: [f64; 2],
    width: f64,
    points: Vec<u32>,
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
    let cells = divide(&all);
    distribution.lobes = amplitudes(&all, &cells, floor);
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

/// Cells of the square, finer where the points ask for it.
fn divide(points: &[Point]) -> Vec<Cell> {
    let n = 1_usize << FIRST;
    let width = 1.0 / n as f64;
    let mut first: Vec<Cell> = (0..n * n)
        .map(|k| Cell {
            corner: [(k % n) as f64 * width, (k / n) as f64 * width],
            width,
            points: Vec::new(),
        })
        .collect();
    for (k, point) in points.iter().enumerate() {
        let [x, y] = point.square.map(|c| (c * n as f64) as usize);
        first[y * n + x].points.push(k as u32);
    }
    let mut done = Vec::new();
    let mut open: Vec<(u32, bool, Cell)> = first.into_iter().map(|cell| (FIRST, false, cell)).collect();
    while let Some((level, steep, cell)) = open.pop() {
        // Below cells of several points that are far from a plane there is one more level, of a point a cell.
        let enough = cell.points.len() >= LEAST;
        let chi2 = if enough { unevenness(points, &cell) } else { 0.0 };
        let split = if enough {
            chi2 > UNEVEN
        } else {
            steep && cell.points.len() > 1
        };
        if level >= LAST || !split {
            done.push(cell);
            continue;
        }
        let half = 0.5 * cell.width;
        let mut quarters: [Cell; 4] = std::array::from_fn(|k| Cell {
            corner: [
                cell.corner[0] + half * (k % 2) as f64,
                cell.corner[1] + half * (k / 2) as f64,
            ],
            width: half,
            points: Vec::new(),
        });
        for &k in &cell.points {
            let square = points[k as usize].square;
            let x = usize::from(square[0] >= cell.corner[0] + half);
            let y = usize::from(square[1] >= cell.corner[1] + half);
            quarters[2 * y + x].points.push(k);
        }
        if enough && quarters.iter().filter(|q| q.points.is_empty()).count() > 1 && chi2 < STEEP {
            done.push(cell);
            continue;
        }
        open.extend(
            quarters
                .into_iter()
                .map(|quarter| (level + 1, enough && chi2 > STEEP, quarter)),
        );
    }
    done
}

/// Points that a cell needs to be tested.
const LEAST: usize = 4;
/// Limits of the unevenness of a cell that is divided, and of one that is divided to single points.
const UNEVEN: f64 = 2.5;
const STEEP: f64 = 12.0;

/// How far the points of a cell lie from a plane: mean square over noise and tolerance.
fn unevenness(points: &[Point], cell: &Cell) -> f64 {
    let n = cell.points.len();
    let mean = cell.points.iter().map(|&k| points[k as usize].value).sum::<f64>() / n as f64;
    // Normal equations of a plane about the middle of the points.
    let mut middle = [0.0; 2];
    for &k in &cell.points {
        let s = points[k as usize].square;
        middle[0] += s[0] / n as f64;
        middle[1] += s[1] / n as f64;
    }
    let (mut xx, mut xy, mut yy, mut xv, mut yv) = (1e-12, 0.0, 1e-12, 0.0, 0.0);
    for &k in &cell.points {
        let p = &points[k as usize];
        let (x, y, v) = (p.square[0] - middle[0], p.square[1] - middle[1], p.value - mean);
        xx += x * x;
        xy += x * y;
        yy += y * y;
        xv += x * v;
        yv += y * v;
    }
    let det = xx * yy - xy * xy;
    let (a, b) = if n > LEAST && det > 1e-6 * xx * yy {
        ((xv * yy - yv * xy) / det, (yv * xx - xv * xy) / det)
    } else {
        (0.0, 0.0)
    };
    let freedom = (n as f64 - if n > LEAST { 3.0 } else { 1.0 }).max(1.0);
    let chi2: f64 = cell
        .points
        .iter()
        .map(|&k| {
            let p = &points[k as usize];
            let (x, y) = (p.square[0] - middle[0], p.square[1] - middle[1]);
            let miss = p.value - mean - a * x - b * y;
            miss * miss / (p.error.powi(2) + (TOLERANCE * mean).powi(2) + f64::MIN_POSITIVE)
        })
        .sum();
    chi2 / freedom
}

/// Value in the middle of a cell without points, by the nearest ones.
fn near(points: &[Point], cell: &Cell) -> f64 {
    let middle = vector(from_square(cell.corner.map(|c| c + 0.5 * cell.width)));
    let mut nearest = [(f64::INFINITY, 0.0); NEIGHBOURS];
    for point in points {
        let distance2 = chord2(middle, point.at);
        if distance2 < nearest[NEIGHBOURS - 1].0 {
            let place = nearest.partition_point(|n| n.0 < distance2);
            nearest[place..].rotate_right(1);
            nearest[place] = (distance2, point.value);
        }
    }
    let known = nearest.iter().filter(|n| n.0.is_finite());
    let (sum, weight) = known.fold((0.0, 0.0), |(sum, weight), &(distance2, value)| {
        let w = 1.0 / (distance2 + 1e-9);
        (sum + w * value, weight + w)
    });
    sum / weight
}

/// Means over cells of 9°, without those below 0.
fn coarse_means(points: &[Point]) -> Vec<f64> {
    let mut sums = vec![[0.0; 2]; CELLS * CELLS];
    for point in points {
        let [x, y] = point.square.map(|c| (c * CELLS as f64) as usize);
        let sum = &mut sums[y * CELLS + x];
        sum[0] += point.value.max(0.0);
        sum[1] += 1.0;
    }
    sums.into_iter()
        .map(|[sum, count]| if count > 0.0 { sum / count } else { 0.0 })
        .collect()
}

/// Amplitudes of 0 or more by least squares, coordinate after coordinate; where points say little they stay near the mean of
/// their cell.
fn amplitudes(points: &[Point], cells: &[Cell], floor: f64) -> Vec<Lobe> {
    const RIDGE: f64 = 0.003;
    const LEAST_SHARE: f64 = 1e-7;
    const BESIDE: f64 = 0.5;
    let coarse = coarse_means(points);
    let brightness = |square: [f64; 2]| {
        let [x, y] = square.map(|c| (c * CELLS as f64) as usize);
        coarse[y * CELLS + x]
    };
    let mut weights = vec![0.0; points.len()];
    let mut start = vec![0.0; cells.len()];
    for (cell, start) in cells.iter().zip(&mut start) {
        let mean = if cell.points.is_empty() {
            near(points, cell)
        } else {
            cell.points.iter().map(|&k| points[k as usize].value).sum::<f64>() / cell.points.len() as f64
        };
        // So many lobes lie over each other.
        *start = mean.max(0.0) / (0.25 * std::f64::consts::PI * OVERLAP * OVERLAP);
        for &k in &cell.points {
            let error = points[k as usize].error;
            // What lies beside something bright is not known better than that is resolved.
            let level = floor + mean.abs().max(BESIDE * brightness(points[k as usize].square));
            weights[k as usize] = 1.0 / (error * error + (TOLERANCE * level).powi(2) + f64::MIN_POSITIVE);
        }
    }
    let places: Vec<(Disk, f64)> = cells
        .iter()
        .map(|cell| {
            let middle = cell.corner.map(|c| c + 0.5 * cell.width);
            let radius = OVERLAP * cell.width * std::f64::consts::TAU.sqrt();
            (from_square(middle), radius * radius)
        })
        .collect();
    let columns: Vec<Vec<(u32, f64)>> = places
        .iter()
        .map(|&(centre, radius2)| {
            let c = vector(centre);
            let value = |(k, p): (usize, &Point)| {
                let below = [p.at[0], p.at[1], -p.at[2]];
                let v = kernel(chord2(c, p.at) / radius2) + kernel(chord2(c, below) / radius2);
                (v > 0.0).then_some((k as u32, v))
            };
            points.iter().enumerate().filter_map(value).collect()
        })
        .collect();
    let mut amplitudes = start.clone();
    let mut rest: Vec<f64> = points.iter().map(|p| p.value).collect();
    for (column, amplitude) in columns.iter().zip(&amplitudes) {
        for &(k, v) in column {
            rest[k as usize] -= v * amplitude;
        }
    }
    let curvature: Vec<f64> = columns
        .iter()
        .map(|column| column.iter().map(|&(k, v)| weights[k as usize] * v * v).sum::<f64>())
        .collect();
    for _ in 0..SWEEPS {
        for (j, column) in columns.iter().enumerate() {
            let ridge = RIDGE * curvature[j];
            if ridge <= 0.0 {
                continue;
            }
            let gradient: f64 = column
                .iter()
                .map(|&(k, v)| weights[k as usize] * v * rest[k as usize])
                .sum();
            let step = (gradient - ridge * (amplitudes[j] - start[j])) / (curvature[j] + ridge);
            let next = (amplitudes[j] + step).max(0.0);
            let change = next - amplitudes[j];
            if change != 0.0 {
                amplitudes[j] = next;
                for &(k, v) in column {
                    rest[k as usize] -= v * change;
                }
            }
        }
    }
    let lobes: Vec<Lobe> = places
        .iter()
        .zip(&amplitudes)
        .map(|(&(centre, radius2), amplitude)| Lobe {
            centre,
            radius2,
            flux: amplitude * unit_flux(centre, radius2),
        })
        .collect();
    let total: f64 = lobes.iter().map(|l| l.flux).sum::<f64>() + std::f64::consts::PI * floor;
    lobes.into_iter().filter(|l| l.flux > LEAST_SHARE * total).collect()
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
