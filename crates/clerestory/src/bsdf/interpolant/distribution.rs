//! What was measured of light from one direction.

use super::lobe::{Lobe, Vector};
use super::state::{Raster, State};
use crate::bsdf::{Peak, Turn};
use crate::direction::Disk;

/// Cells an axis of the record of what was measured.
pub const CELLS: usize = 16;
/// Words of that record.
pub const WORDS: usize = CELLS * CELLS / 32;

/// Scattered light from one incident direction as lobes over an even floor, a beam, and where there were points.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// Direction of travel of the light that comes.
    pub incident: Disk,
    /// What stands out of the floor.
    pub lobes: Vec<Lobe>,
    /// BSDF that is everywhere (1/sr).
    pub floor: f64,
    /// Transmittance or reflectance of the beam that was not scattered.
    pub beam: f64,
    /// Full angle of that beam (radians).
    pub extent: f64,
    /// Largest polar angle of a measured point (radians).
    pub limit: f64,
    /// A bit for each cell of equal solid angle, set where there were points.
    pub covered: [u32; WORDS],
}

impl Distribution {
    /// Scattered light over all directions.
    pub fn scattered(&self) -> f64 {
        self.lobes.iter().map(|l| l.flux).sum::<f64>() + std::f64::consts::PI * self.floor
    }

    /// Whether there were points about a direction.
    pub fn measured(&self, outgoing: Disk) -> bool {
        let cell = cell_of(outgoing, CELLS);
        outgoing.theta() <= self.limit + 1e-9 && self.covered[cell / 32] >> (cell % 32) & 1 == 1
    }

    /// Ready to be asked.
    pub fn state(&self) -> State {
        let peak = (self.beam > 0.0).then_some(Peak {
            outgoing: self.incident,
            value: self.beam,
            extent: self.extent,
        });
        State::new(&self.lobes, self.floor, peak)
    }

    /// Beside what others say of the same direction: their total, the share of the light that is in another place, and the angle
    /// between the maxima (radians).
    pub fn compared(&self, other: &State) -> (f64, f64, f64) {
        const CELLS: usize = 96;
        let own = self.state();
        let raster = Raster::new(CELLS);
        let of = |state: &State| {
            let mut values = vec![0.0; raster.cells()];
            state.add_to(&raster, &mut values, 0.0);
            values
        };
        let (a, b) = (of(&own), of(other));
        let difference: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).abs()).sum();
        let whole: f64 = a.iter().sum();
        (
            other.scattered + other.peak.map_or(0.0, |p| p.value),
            if whole > 0.0 { 0.5 * difference / whole } else { 0.0 },
            own.brightest().angle_to(other.brightest()),
        )
    }

    /// Of the sample turned or mirrored.
    #[must_use]
    pub fn turned(&self, turn: Turn) -> Self {
        let mut covered = [0; WORDS];
        for cell in 0..CELLS * CELLS {
            let from = cell_of(turn.inverse().apply(cell_middle(cell, CELLS)), CELLS);
            covered[cell / 32] |= (self.covered[from / 32] >> (from % 32) & 1) << (cell % 32);
        }
        Self {
            incident: turn.apply(self.incident),
            lobes: self
                .lobes
                .iter()
                .map(|l| Lobe {
                    centre: turn.apply(l.centre),
                    ..*l
                })
                .collect(),
            covered,
            ..*self
        }
    }
}

/// Cell of a direction on a square grid of equal solid angles.
pub fn cell_of(point: Disk, cells: usize) -> usize {
    let [x, y] = to_square(point).map(|c| (c * cells as f64) as usize);
    y * cells + x
}

/// Middle of such a cell.
pub fn cell_middle(cell: usize, cells: usize) -> Disk {
    let at = |k: usize| (k as f64 + 0.5) / cells as f64;
    from_square([at(cell % cells), at(cell / cells)])
}

/// The unit square of equal solid angles: Lambert's projection and the concentric map.
pub fn to_square(point: Disk) -> [f64; 2] {
    let scale = (1.0 + point.cos_theta()).sqrt();
    Disk::new(point.x / scale, point.y / scale).to_square()
}

/// Its inverse.
pub fn from_square(square: [f64; 2]) -> Disk {
    let point = Disk::from_square(square);
    let scale = (2.0 - point.sin2_theta()).sqrt();
    Disk::new(point.x * scale, point.y * scale)
}

/// Squared chord between two unit vectors.
#[inline]
pub fn chord2(a: Vector, b: Vector) -> f64 {
    (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::r2;

    #[test]
    fn the_square_keeps_solid_angles() {
        // Half of the solid angle lies within 60°.
        let n = 1 << 14;
        let inside = (0..n)
            .filter(|&k| from_square(r2(k, [0.0; 2])).cos_theta() > 0.5)
            .count();
        assert!((inside as f64 / f64::from(n) - 0.5).abs() < 1e-2);
        for k in 0..100 {
            let u = r2(k, [0.4; 2]);
            let back = to_square(from_square(u));
            assert!((back[0] - u[0]).abs() < 1e-7 && (back[1] - u[1]).abs() < 1e-7);
        }
    }
}
