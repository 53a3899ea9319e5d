//! Codes: all coordinates of a point of a tree interleaved into one number, so that a look-up takes the next child from
//! the next few bits.
//!
//! A code has [`MAX_DEPTH`] groups of as many bits as the tree has axes. The highest group belongs to the root; within a
//! group axis 0 is the lowest bit, so a group is the number of a child. The codes of an incident and of an outgoing
//! direction are joined by `|`.

use super::{MAX_DEPTH, Rank};
use crate::direction::Disk;

impl Rank {
    /// Code of an incident direction.
    pub fn incident_code(self, incident: Disk) -> u64 {
        match self {
            Self::Anisotropic => {
                let [a, b] = incident.to_square();
                spread4(a) | spread4(b) << 1
            }
            Self::Isotropic => {
                let r = incident.sin2_theta().sqrt();
                // Normal incidence stays below the unused half.
                spread3((0.5 - 0.5 * r).clamp(0.0, 0.5 - 5e-7))
            }
        }
    }

    /// Code of an outgoing direction in the tree's frame (see [`Rank::into_frame`]).
    pub fn outgoing_code(self, outgoing: Disk) -> u64 {
        let [a, b] = outgoing.to_square();
        match self {
            Self::Anisotropic => spread4(a) << 2 | spread4(b) << 3,
            Self::Isotropic => spread3(a) << 1 | spread3(b) << 2,
        }
    }

    /// An outgoing direction of the sample in the tree's frame: the sample's own for rank 4; for rank 3 turned so that
    /// the incident light travels toward +x.
    pub fn into_frame(self, incident: Disk, outgoing: Disk) -> Disk {
        match self.azimuth(incident) {
            Some([sin, cos]) => outgoing.turned(-sin, cos),
            None => outgoing,
        }
    }

    /// From the tree's frame back to the sample's.
    pub fn out_of_frame(self, incident: Disk, outgoing: Disk) -> Disk {
        match self.azimuth(incident) {
            Some([sin, cos]) => outgoing.turned(sin, cos),
            None => outgoing,
        }
    }

    /// Sine and cosine by which the tree's frame is turned; none if it is not.
    fn azimuth(self, incident: Disk) -> Option<[f64; 2]> {
        let r2 = incident.sin2_theta();
        if self == Self::Anisotropic || r2 == 0.0 {
            return None;
        }
        let r = r2.sqrt();
        Some([incident.y / r, incident.x / r])
    }

    /// Code of a pair of directions.
    pub fn code(self, incident: Disk, outgoing: Disk) -> u64 {
        self.incident_code(incident) | self.outgoing_code(self.into_frame(incident, outgoing))
    }

    /// Which half of each incident axis a code lies in, `level` levels below the root.
    pub(super) fn incident_child(self, code: u64, level: u32) -> usize {
        let group = code >> (self.axes() * (MAX_DEPTH - 1 - level));
        group as usize & ((1 << self.incident_axes()) - 1)
    }
}

/// A coordinate in [0, 1) as the number of one of 2^16 equal cells.
fn cell(coordinate: f64) -> u64 {
    (coordinate * f64::from(1_u32 << MAX_DEPTH)) as u64
}

/// Bits of a coordinate, each fourth bit of the result.
fn spread4(coordinate: f64) -> u64 {
    let x = cell(coordinate);
    let x = (x | x << 24) & 0x0000_00ff_0000_00ff;
    let x = (x | x << 12) & 0x000f_000f_000f_000f;
    let x = (x | x << 6) & 0x0303_0303_0303_0303;
    (x | x << 3) & 0x1111_1111_1111_1111
}

/// Bits of a coordinate, each third bit of the result.
fn spread3(coordinate: f64) -> u64 {
    let x = cell(coordinate);
    let x = (x | x << 16) & 0x0000_0000_ff00_00ff;
    let x = (x | x << 8) & 0x100f_00f0_0f00_f00f;
    let x = (x | x << 4) & 0x10c3_0c30_c30c_30c3;
    (x | x << 2) & 0x1249_2492_4924_9249
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::uniform;

    #[test]
    fn bits_of_a_coordinate_are_spread() {
        for k in 0..2000 {
            let x = uniform(5, k);
            for (spread, step) in [(spread3(x), 3), (spread4(x), 4)] {
                let expected: u64 = (0..16).map(|b| (cell(x) >> b & 1) << (b * step)).sum();
                assert_eq!(spread, expected, "step {step}");
            }
        }
    }

    #[test]
    fn groups_of_a_code_are_the_halves_of_the_axes() {
        for k in 0..500 {
            let point = |n| Disk::uniform([uniform(n, k), uniform(n + 1, k)]);
            let (i, o) = (point(10), point(20));
            let [a, b] = i.to_square();
            let [c, d] = o.to_square();
            let code = Rank::Anisotropic.code(i, o);
            for level in 0..MAX_DEPTH {
                let bit = |x: f64| (x * 2_f64.powi(level as i32 + 1)).floor() as u64 & 1;
                let child = bit(a) | bit(b) << 1 | bit(c) << 2 | bit(d) << 3;
                assert_eq!(code >> (4 * (15 - level)) & 15, child);
                assert_eq!(
                    Rank::Anisotropic.incident_child(code, level) as u64,
                    bit(a) | bit(b) << 1
                );
            }
        }
    }

    #[test]
    fn the_frame_of_rank_3_has_the_light_travelling_toward_x() {
        let i = Disk::from_angles(0.7, 2.1);
        let turned = Rank::Isotropic.into_frame(i, i);
        assert!((turned.x - 0.7_f64.sin()).abs() < 1e-14 && turned.y.abs() < 1e-14);
        let back = Rank::Isotropic.out_of_frame(i, turned);
        assert!((back.x - i.x).abs() < 1e-14 && (back.y - i.y).abs() < 1e-14);
        assert_eq!(Rank::Anisotropic.into_frame(i, i), i);
        assert_eq!(Rank::Isotropic.into_frame(Disk::NORMAL, i), i);
        // Normal incidence belongs to the lower half, as 0.4999995 does.
        assert_eq!(Rank::Isotropic.incident_code(Disk::NORMAL), spread3(0.499_999_5));
    }
}
