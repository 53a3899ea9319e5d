//! Transport distance (Wasserstein-1, earth mover's distance) between two distributions of light on a hemisphere, with the
//! angle between directions as the cost: the least mean angle by which light has to be turned to make one from the other.
//!
//! Each distribution is gathered into cells of about 7° that carry its flux at its own centre of gravity, and peaks at their
//! own direction. Between two such sets of points the distance is exact, hence a metric. A narrow lobe keeps its
//! position to a fraction of a cell however it falls on the cells; what differs within one cell and has the same centre
//! of gravity there is not seen. One diffuser on two different partitions comes out at up to 0.2°: the floor of the method
//! for broad light.

use std::f64::consts::{FRAC_PI_2, TAU};
use std::sync::LazyLock;

use super::Distribution;
use crate::basis::{Basis, Ring};
use crate::direction::{Direction, Side};
use crate::simplex::{MAX_COST, transport_cost};

/// Rings about the middle cell, which is as wide as they are.
const RINGS: u32 = 12;
/// Width of a cell (radians), 7.2°.
pub const CELL_WIDTH: f64 = FRAC_PI_2 / (RINGS as f64 + 0.5);
/// Flux is counted in this many parts, as whole numbers.
const PARTS: f64 = (1_u64 << 50) as f64;

static CELLS: LazyLock<Basis> = LazyLock::new(|| {
    let width = CELL_WIDTH.to_degrees();
    let mut rings = vec![Ring {
        lower_deg: 0.0,
        upper_deg: 0.5 * width,
        nominal_deg: 0.0,
        count: 1,
    }];
    for k in 1..=RINGS {
        let middle = f64::from(k) * width;
        rings.push(Ring {
            lower_deg: middle - 0.5 * width,
            upper_deg: middle + 0.5 * width,
            nominal_deg: middle,
            count: (TAU * middle.to_radians().sin() / CELL_WIDTH).round() as usize,
        });
    }
    Basis::from_rings("cells of the transport distance", rings).expect("the rings join")
});

/// A distribution gathered into points.
#[derive(Debug, Clone)]
pub struct Support {
    directions: Vec<Direction>,
    /// In parts of the total, which they sum to.
    masses: Vec<u64>,
    /// Cell of each point; a peak has none.
    cells: Vec<Option<usize>>,
}

impl Support {
    /// Gathers a distribution. It is empty if that is dark.
    pub fn of(light: &Distribution) -> Self {
        let total = light.total();
        let mut sums = vec![[0.0; 4]; CELLS.len()];
        for point in &light.points {
            let d = point.outgoing.outgoing(Side::Interior);
            let sum = &mut sums[CELLS.patch_of(point.outgoing)];
            for (s, v) in sum.iter_mut().zip([1.0, d.x, d.y, d.z]) {
                *s += point.flux * v;
            }
        }
        let mut support = Self {
            directions: Vec::new(),
            masses: Vec::new(),
            cells: Vec::new(),
        };
        for (cell, [flux, x, y, z]) in sums.into_iter().enumerate() {
            if let Ok(direction) = Direction::new(x, y, z) {
                support.push(direction, flux / total, Some(cell));
            }
        }
        for &(outgoing, value) in &light.peaks {
            support.push(outgoing.outgoing(Side::Interior), value / total, None);
        }
        support.balance();
        support
    }

    fn push(&mut self, direction: Direction, share: f64, cell: Option<usize>) {
        let mass = (share * PARTS).round();
        if mass >= 1.0 {
            self.directions.push(direction);
            self.masses.push(mass as u64);
            self.cells.push(cell);
        }
    }

    /// Lets the largest mass take what rounding left, so that all sum to the same whole.
    fn balance(&mut self) {
        let sum: u64 = self.masses.iter().sum();
        if let Some(largest) = self.masses.iter_mut().max() {
            *largest = (*largest + PARTS as u64).saturating_sub(sum).max(1);
        }
    }
}

/// Least mean angle (radians) by which light has to be turned to make one distribution from the other, both of total 1.
/// None where one is dark.
pub fn transport(a: &Support, b: &Support) -> Option<f64> {
    if a.masses.is_empty() || b.masses.is_empty() {
        return None;
    }
    let mut costs = Vec::with_capacity(a.masses.len() * b.masses.len());
    for from in &a.directions {
        costs.extend(b.directions.iter().map(|to| angle(*from, *to)));
    }
    debug_assert!(costs.iter().all(|c| (0.0..=MAX_COST).contains(c)));
    let mut in_cell = vec![None; CELLS.len()];
    for (j, cell) in b.cells.iter().enumerate() {
        if let Some(cell) = cell {
            in_cell[*cell] = Some(j);
        }
    }
    let pairs: Vec<(usize, usize)> = a
        .cells
        .iter()
        .enumerate()
        .filter_map(|(i, cell)| Some((i, in_cell[(*cell)?]?)))
        .collect();
    Some(transport_cost(&a.masses, &b.masses, &costs, &pairs) / PARTS)
}

/// Angle between unit vectors (radians) by their chord, accurate for small angles.
fn angle(a: Direction, b: Direction) -> f64 {
    let chord2 = (a.x - b.x).powi(2) + (a.y - b.y).powi(2) + (a.z - b.z).powi(2);
    2.0 * (0.5 * chord2.sqrt()).min(1.0).asin()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::compare::Point;
    use crate::direction::Disk;

    /// Points of a lobe of a given width about a direction, and a part of diffuse light.
    fn lobe(theta_deg: f64, phi_deg: f64, width_deg: f64, diffuse: f64) -> Support {
        let axis = Disk::from_angles(theta_deg.to_radians(), phi_deg.to_radians()).outgoing(Side::Interior);
        let (st, ct) = theta_deg.to_radians().sin_cos();
        let (sp, cp) = phi_deg.to_radians().sin_cos();
        let (u, v) = ([ct * cp, ct * sp, -st], [-sp, cp, 0.0]);
        let mut points = Vec::new();
        let n = 60;
        for k in 0..n * n {
            let x = (f64::from(k % n) + 0.5) / f64::from(n) * 6.0 - 3.0;
            let y = (f64::from(k / n) + 0.5) / f64::from(n) * 6.0 - 3.0;
            let w = width_deg.to_radians();
            let d = Direction::new(
                axis.x + w * (x * u[0] + y * v[0]),
                axis.y + w * (x * u[1] + y * v[1]),
                axis.z + w * (x * u[2] + y * v[2]),
            )
            .unwrap();
            if d.z > 0.0 {
                points.push((d.outgoing_disk(), (-0.5 * (x * x + y * y)).exp()));
            }
        }
        let sum: f64 = points.iter().map(|p| p.1).sum();
        for p in &mut points {
            p.1 *= (1.0 - diffuse) / sum;
        }
        for k in 0..128 * 128 {
            let square = [f64::from(k % 128) + 0.5, (f64::from(k / 128)) + 0.5].map(|v| v / 128.0);
            points.push((Disk::from_square(square), diffuse / f64::from(128 * 128)));
        }
        let points = points
            .into_iter()
            .map(|(outgoing, flux)| Point {
                outgoing,
                flux,
                value: 1.0,
            })
            .collect();
        Support::of(&Distribution {
            points,
            ..Distribution::default()
        })
    }

    #[test]
    fn shifted_lobes_count_their_shift() {
        for (theta, phi) in [(0.0, 0.0), (3.0, 77.0), (22.0, 10.0), (41.0, 200.0), (60.0, 271.0)] {
            for width in [0.05, 1.0, 3.0] {
                let base = lobe(theta, phi, width, 0.3);
                for shift in [0.5, 1.0, 3.0, 20.0] {
                    // Away from the normal, and across.
                    let along = lobe(theta + shift, phi, width, 0.3);
                    let (st, ct) = f64::to_radians(theta).sin_cos();
                    let (ss, cs) = f64::to_radians(shift).sin_cos();
                    let turned = phi + ss.atan2(cs * st).to_degrees();
                    let across = lobe((cs * ct).acos().to_degrees(), turned, width, 0.3);
                    for moved in [along, across] {
                        let expected = 0.7 * shift;
                        let found = transport(&base, &moved).unwrap().to_degrees();
                        assert!(
                            (found / expected - 1.0).abs() < 0.1,
                            "lobe of {width}° at {theta}°, {phi}° shifted by {shift}°: {found}° for {expected}°"
                        );
                    }
                }
            }
        }
    }
}
