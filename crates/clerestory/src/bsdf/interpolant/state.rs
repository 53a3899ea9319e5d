//! The distribution of one incident direction, ready to be asked.

use std::cell::{Cell, OnceCell};
use std::f64::consts::{PI, TAU};
use std::ops::Range;

use super::distribution::{cell_middle, chord2, to_square};
use super::lobe::{Lobe, Vector, around, draw, kernel, solid_angle, vector};
use crate::bsdf::{Peak, Sample};
use crate::direction::Disk;

/// Cells an axis of the index of lobes.
const CELLS: usize = 24;
/// Half of the largest diagonal of such a cell, as a chord.
const CELL_RADIUS: f64 = 0.13;
/// So many lobes are all looked at without an index.
const FEW: usize = 48;
/// So often a distribution is asked before an index is worth its making.
const OFTEN: u32 = 24;

/// Lobes of one incident direction.
pub struct State {
    lobes: Vec<Ready>,
    /// Sums of what the lobes before carry.
    sums: Vec<f64>,
    floor: f64,
    /// Scattered light.
    pub scattered: f64,
    /// The beam.
    pub peak: Option<Peak>,
    index: OnceCell<Vec<Vec<u32>>>,
    asked: Cell<u32>,
}

#[derive(Clone, Copy)]
struct Ready {
    at: Vector,
    radius2: f64,
    /// 1 / radius².
    inverse: f64,
    /// BSDF in the middle (1/sr).
    amplitude: f64,
    /// Flux over the solid angle: what it is drawn with (1/sr).
    density: f64,
}

impl State {
    /// Of lobes, a floor (1/sr) and a beam.
    pub fn new(lobes: &[Lobe], floor: f64, peak: Option<Peak>) -> Self {
        let mut sums = Vec::with_capacity(lobes.len());
        let mut sum = 0.0;
        let ready = lobes
            .iter()
            .map(|lobe| {
                sum += lobe.flux;
                sums.push(sum);
                Ready {
                    at: vector(lobe.centre),
                    radius2: lobe.radius2,
                    inverse: 1.0 / lobe.radius2,
                    amplitude: lobe.amplitude(),
                    density: lobe.flux / solid_angle(lobe.radius2),
                }
            })
            .collect();
        Self {
            lobes: ready,
            sums,
            floor,
            scattered: sum + PI * floor,
            peak,
            index: OnceCell::new(),
            asked: Cell::new(0),
        }
    }

    fn total(&self) -> f64 {
        self.scattered + self.peak.map_or(0.0, |p| p.value)
    }

    /// Lobes that reach a cell, for every cell.
    fn index(&self) -> &[Vec<u32>] {
        self.index.get_or_init(|| {
            let middles: Vec<Vector> = (0..CELLS * CELLS).map(|c| vector(cell_middle(c, CELLS))).collect();
            let mut cells = vec![Vec::new(); CELLS * CELLS];
            for (k, lobe) in self.lobes.iter().enumerate() {
                let radius = lobe.radius2.sqrt();
                let [x, y] = box_about(lobe.at, radius, CELLS);
                let reach = (radius + CELL_RADIUS).powi(2);
                for row in y.0..y.1 {
                    for cell in row * CELLS + x.0..row * CELLS + x.1 {
                        if chord2(middles[cell], lobe.at) < reach {
                            cells[cell].push(k as u32);
                        }
                    }
                }
            }
            cells
        })
    }

    /// Sum over lobes of a factor each.
    #[inline]
    fn sum(&self, outgoing: Disk, factor: impl Fn(&Ready) -> f64) -> f64 {
        let at = vector(outgoing);
        let one = |lobe: &Ready| {
            let level = lobe.at[0] * at[0] + lobe.at[1] * at[1];
            let height = lobe.at[2] * at[2];
            let above = kernel((2.0 - 2.0 * (level + height)) * lobe.inverse);
            let below = kernel((2.0 - 2.0 * (level - height)) * lobe.inverse);
            factor(lobe) * (above + below)
        };
        self.asked.set(self.asked.get().saturating_add(1));
        if self.lobes.len() <= FEW || self.asked.get() < OFTEN {
            return self.lobes.iter().map(one).sum();
        }
        let [x, y] = to_square(outgoing).map(|c| (c * CELLS as f64) as usize);
        self.index()[y * CELLS + x]
            .iter()
            .map(|&k| one(&self.lobes[k as usize]))
            .sum()
    }

    /// BSDF of the scattered part (1/sr).
    pub fn evaluate(&self, outgoing: Disk) -> f64 {
        self.floor + self.sum(outgoing, |l| l.amplitude)
    }

    /// Density of scattered samples (1/sr).
    pub fn pdf(&self, outgoing: Disk) -> f64 {
        let total = self.total();
        if total <= 0.0 {
            return 0.0;
        }
        (self.floor * outgoing.cos_theta() + self.sum(outgoing, |l| l.density)) / total
    }

    /// A direction, its weight, and whether it is the beam.
    pub fn sample(&self, [u, v]: [f64; 2]) -> Option<Sample> {
        let total = self.total();
        if total <= 0.0 {
            return None;
        }
        let mut target = u * total;
        if let Some(peak) = self.peak.filter(|p| p.value > 0.0) {
            if target < peak.value {
                return Some(Sample {
                    outgoing: peak.outgoing,
                    weight: total,
                    peak: true,
                });
            }
            target -= peak.value;
        }
        let even = PI * self.floor;
        let in_lobes = self.sums.last().copied().unwrap_or(0.0);
        let outgoing = if target < even || in_lobes <= 0.0 {
            Disk::uniform([(target / even).clamp(0.0, 1.0 - f64::EPSILON), v])
        } else {
            target -= even;
            let k = self.sums.partition_point(|&s| s <= target).min(self.lobes.len() - 1);
            let before = if k == 0 { 0.0 } else { self.sums[k - 1] };
            let inner = ((target - before) / (self.sums[k] - before)).clamp(0.0, 1.0 - f64::EPSILON);
            draw(self.lobes[k].at, self.lobes[k].radius2, [inner, v])
        };
        let pdf = self.pdf(outgoing);
        (pdf > 0.0).then(|| Sample {
            outgoing,
            weight: self.evaluate(outgoing) * outgoing.cos_theta() / pdf,
            peak: false,
        })
    }

    /// Where the BSDF is highest: the centre of gravity of what is above half of the maximum about it; on a crest, which may bend,
    /// the top of a line across it.
    pub fn brightest(&self) -> Disk {
        const RINGS: usize = 24;
        const SPOKES: usize = 32;
        const STEPS: usize = 3;
        /// Ratio of the variances along and across from which a hill is a crest.
        const CREST: f64 = 2.0;
        let middle = |l: &Ready| Disk::new(l.at[0], l.at[1]);
        let best = self.lobes.iter().map(|l| (self.evaluate(middle(l)), l));
        let Some((_, lobe)) = best.max_by(|a, b| a.0.total_cmp(&b.0)) else {
            return Disk::NORMAL;
        };
        let mut at = middle(lobe);
        for _ in 0..STEPS {
            let half = 0.5 * self.evaluate(at);
            // Chord to which the hill is higher than that on half of the spokes.
            let ring = |radius: f64| (0..SPOKES).map(move |k| (radius, k as f64 / SPOKES as f64));
            let place = |at: Disk, radius: f64, turn: f64| around(vector(at), radius, turn);
            let mut radius = 0.01;
            while radius < 1.0 {
                let above = ring(radius).filter(|&(r, t)| place(at, r, t).is_some_and(|o| self.evaluate(o) > half));
                if above.count() < SPOKES / 2 {
                    break;
                }
                radius *= 1.2;
            }
            // Sums of weights, of places, and of the square of what is along and across, as an angle of twice the turn.
            let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
            let (mut squares, mut even, mut odd) = (0.0, 0.0, 0.0);
            for k in 0..RINGS {
                let r = 1.3 * radius * (k as f64 + 0.5) / RINGS as f64;
                for (r, turn) in ring(r) {
                    let Some(o) = place(at, r, turn) else { continue };
                    let weight = (self.evaluate(o) - half).max(0.0) * r;
                    sum += weight;
                    x += weight * o.x;
                    y += weight * o.y;
                    let (sin, cos) = (2.0 * TAU * turn).sin_cos();
                    squares += weight * r * r;
                    even += weight * r * r * cos;
                    odd += weight * r * r * sin;
                }
            }
            if sum <= 0.0 {
                break;
            }
            at = Disk::new(x / sum, y / sum);
            let long = even.hypot(odd);
            if squares + long < CREST * (squares - long) {
                continue;
            }
            let across = odd.atan2(even) / (2.0 * TAU) + 0.25;
            let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
            for k in 0..RINGS {
                let r = 1.3 * radius * (k as f64 + 0.5) / RINGS as f64;
                for o in [across, across + 0.5].into_iter().filter_map(|turn| place(at, r, turn)) {
                    let weight = (self.evaluate(o) - half).max(0.0);
                    sum += weight;
                    x += weight * o.x;
                    y += weight * o.y;
                }
            }
            if sum > 0.0 {
                at = Disk::new(x / sum, y / sum);
            }
        }
        at
    }

    /// Full width at half of the maximum of the narrowest lobe that matters (radians).
    pub fn resolution(&self) -> f64 {
        const MATTERS: f64 = 1e-3;
        const HALF: f64 = 0.908;
        let least = MATTERS * self.scattered;
        let flux = |l: &&Ready| l.density * solid_angle(l.radius2) > least;
        let narrowest = self.lobes.iter().filter(flux).map(|l| l.radius2).fold(1.0, f64::min);
        HALF * narrowest.sqrt()
    }

    /// Adds the mean BSDF over cells of equal projected solid angle, whose middles are given, to `values`. A lobe is widened by
    /// the cells' own width, and carries what it carries however few middles it covers.
    pub fn add_to(&self, cells: &Raster, values: &mut [f64], spread2: f64) {
        for value in values.iter_mut() {
            *value += self.floor;
        }
        let n = cells.count;
        let area = PI / (n * n) as f64;
        let mut reached = vec![0.0_f32; n * n];
        for (k, lobe) in self.lobes.iter().enumerate() {
            let before = if k == 0 { 0.0 } else { self.sums[k - 1] };
            let flux = self.sums[k] - before;
            // A cell's variance an axis is width²/12, a lobe's radius²/10. Near the horizon a cell is high.
            let width2 = area / lobe.at[2].max(0.15);
            let radius2 = lobe.radius2 + (width2 / 12.0 + spread2) * 10.0;
            let [x, y] = cells.box_about(lobe.at, radius2.sqrt());
            let mirrored = lobe.at[2] * lobe.at[2] < radius2;
            let at = lobe.at.map(|c| c as f32);
            let inverse = (1.0 / radius2) as f32;
            let width = y.1 - y.0;
            let mut sum = 0.0;
            for row in x.0..x.1 {
                let own = row * n + y.0..row * n + y.1;
                let reached = &mut reached[(row - x.0) * width..][..width];
                sum += f64::from(cells.reach(own, at, inverse, mirrored, reached));
            }
            if sum <= 0.0 {
                values[cells.cell_of(lobe.at)] += flux / area;
                continue;
            }
            let scale = (flux / (sum * area)) as f32;
            for row in x.0..x.1 {
                let values = &mut values[row * n + y.0..row * n + y.1];
                for (value, v) in values.iter_mut().zip(&reached[(row - x.0) * width..]) {
                    *value += f64::from(v * scale);
                }
            }
        }
        if let Some(peak) = self.peak {
            values[cells.cell_of(vector(peak.outgoing))] += peak.value / area;
        }
    }
}

/// Range of cells, along each axis of the square of equal solid angles, that a lobe may reach.
pub fn box_about(at: Vector, radius: f64, cells: usize) -> [(usize, usize); 2] {
    to_square(Disk::new(at[0], at[1])).map(|c| range(c, radius + 1.0 / cells as f64, cells))
}

fn range(middle: f64, reach: f64, cells: usize) -> (usize, usize) {
    let n = cells as f64;
    (
        ((middle - reach) * n).floor().max(0.0) as usize,
        (((middle + reach) * n).ceil().max(0.0) as usize).min(cells),
    )
}

/// Middles of the outgoing cells of a tensor tree, the first axis slowest.
pub struct Raster {
    count: usize,
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl Raster {
    /// So many cells an axis.
    pub fn new(count: usize) -> Self {
        let at = |k: usize| (k as f64 + 0.5) / count as f64;
        let middles = (0..count * count).map(|k| vector(Disk::from_square([at(k / count), at(k % count)])));
        let mut raster = Self {
            count,
            x: Vec::new(),
            y: Vec::new(),
            z: Vec::new(),
        };
        for [x, y, z] in middles {
            raster.x.push(x as f32);
            raster.y.push(y as f32);
            raster.z.push(z as f32);
        }
        raster
    }

    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.x.len()
    }

    fn cell_of(&self, at: Vector) -> usize {
        let [x, y] = Disk::new(at[0], at[1])
            .to_square()
            .map(|c| (c * self.count as f64) as usize);
        x * self.count + y
    }

    /// A lobe of amplitude 1 in some cells, and the sum over them.
    fn reach(&self, cells: Range<usize>, at: [f32; 3], inverse: f32, mirrored: bool, reached: &mut [f32]) -> f32 {
        let kernel = |q: f32| {
            let rest = (1.0 - q).max(0.0);
            rest * rest * rest
        };
        let middles = self.x[cells.clone()]
            .iter()
            .zip(&self.y[cells.clone()])
            .zip(&self.z[cells]);
        for (value, ((x, y), z)) in reached.iter_mut().zip(middles) {
            let level = (x - at[0]) * (x - at[0]) + (y - at[1]) * (y - at[1]);
            *value = kernel((level + (z - at[2]) * (z - at[2])) * inverse);
            if mirrored {
                *value += kernel((level + (z + at[2]) * (z + at[2])) * inverse);
            }
        }
        // In lanes that the processor can add together.
        let (lanes, rest) = reached.as_chunks::<8>();
        let mut sums = [0.0_f32; 8];
        for lane in lanes {
            for (sum, value) in sums.iter_mut().zip(lane) {
                *sum += value;
            }
        }
        sums.iter().chain(rest).sum()
    }

    fn box_about(&self, at: Vector, radius: f64) -> [(usize, usize); 2] {
        // On the disk nothing is farther than on the sphere; along the square's axes the map stretches by 0.64 at most, and
        // less than by 0.91 about its corners.
        let reach = 0.91 * radius + 1.0 / self.count as f64;
        Disk::new(at[0], at[1]).to_square().map(|c| range(c, reach, self.count))
    }
}
