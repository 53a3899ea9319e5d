//! Look-ups in tensor trees by codes made beforehand: the bits of all coordinates, level by level from the highest.

use std::f64::consts::{FRAC_PI_4, TAU};

use crate::bsdf::{Tree, Turn};
use crate::direction::Disk;

/// Bits of a coordinate: as many as a tree may have levels.
const BITS: u32 = crate::bsdf::tree::MAX_DEPTH;

/// The value at a code of `AXES` bits a level, the first level in the highest bits.
pub fn walk<const AXES: u32>(tree: &Tree, mut code: u64) -> f32 {
    const BRANCH: u32 = 1 << 31;
    let entries = tree.entries();
    let mut entry = tree.root();
    while entry & BRANCH != 0 {
        let child = (code >> (64 - AXES)) as usize;
        code <<= AXES;
        entry = entries[((entry & !BRANCH) as usize) << AXES | child];
    }
    f32::from_bits(entry)
}

/// Every byte with its bits `AXES` apart.
const fn spread_table<const AXES: u32>() -> [u32; 256] {
    let mut table = [0; 256];
    let mut byte = 0;
    while byte < 256 {
        let mut bit = 0;
        while bit < 8 {
            table[byte] |= ((byte as u32 >> bit) & 1) << (bit * AXES);
            bit += 1;
        }
        byte += 1;
    }
    table
}

const SPREAD_3: [u32; 256] = spread_table::<3>();
const SPREAD_4: [u32; 256] = spread_table::<4>();

/// A coordinate in [0, 1) on one axis, as its part of a code.
fn part<const AXES: u32>(table: &[u32; 256], x: f64, axis: u32) -> u64 {
    let bits = ((x * f64::from(1_u32 << BITS)) as usize).min((1 << BITS) - 1);
    let spread = u64::from(table[bits >> 8]) << (8 * AXES) | u64::from(table[bits & 255]);
    spread << (64 - AXES * BITS + axis)
}

/// Codes of one direction of a pair for rank 4, whose axes begin with `axis`.
pub fn anisotropic_codes(points: &[Disk], turn: Turn, axis: u32) -> Vec<u64> {
    let back = turn.inverse();
    let code = |&p: &Disk| {
        let [x, y] = back.apply(p).to_square();
        part::<4>(&SPREAD_4, x, axis) | part::<4>(&SPREAD_4, y, axis + 1)
    };
    points.iter().map(code).collect()
}

/// Points ready to be paired for rank 3: radius and azimuth.
pub struct Isotropic(Vec<[f64; 2]>);

impl Isotropic {
    /// `points` as they lie in the sample before it is turned.
    pub fn new(points: &[Disk], turn: Turn) -> Self {
        let back = turn.inverse();
        let polar = |&p: &Disk| {
            let p = back.apply(p);
            [p.x.hypot(p.y), p.y.atan2(p.x)]
        };
        Self(points.iter().map(polar).collect())
    }

    /// Code of incident point `i` of these and point `o` of `outgoing`.
    pub fn code(&self, i: usize, outgoing: &Self, o: usize) -> u64 {
        let [r, phi] = self.0[i];
        let [radius, azimuth] = outgoing.0[o];
        let [x, y] = polar_to_square(radius, azimuth - phi);
        // Normal incidence stays below the unused half, as in a tree's coordinates.
        let depth = (0.5 - 0.5 * r).min(0.5 - 5e-7);
        part::<3>(&SPREAD_3, depth, 0) | part::<3>(&SPREAD_3, x, 1) | part::<3>(&SPREAD_3, y, 2)
    }
}

/// The concentric map of [`Disk::to_square`] from polar coordinates: it is linear in the azimuth.
fn polar_to_square(radius: f64, azimuth: f64) -> [f64; 2] {
    let r = radius.min(1.0) * (1.0 - 1e-13);
    // Azimuth in eighths of a turn, from -1 up: -1 to 1 is the side toward +x, 1 to 3 toward +y, and so on.
    let eighths = (azimuth / FRAC_PI_4 + 1.0).rem_euclid(TAU / FRAC_PI_4) - 1.0;
    let (a, b) = if eighths < 1.0 {
        (r, r * eighths)
    } else if eighths < 3.0 {
        (r * (2.0 - eighths), r)
    } else if eighths < 5.0 {
        (-r, r * (4.0 - eighths))
    } else {
        (r * (eighths - 6.0), -r)
    };
    [(a + 1.0) * 0.5, (b + 1.0) * 0.5]
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::bsdf::{Rank, Scatterer};
    use crate::sequence::{mix, uniform};

    /// A tree that is fine in some places.
    pub fn bushy(rank: Rank) -> Tree {
        fn grow(size: usize, depth: u32, key: u64, entries: &mut Vec<u32>) -> u32 {
            if depth == 0 || (depth < 3 && mix(key).is_multiple_of(3)) {
                return (uniform(key, 5) as f32).to_bits();
            }
            let block = entries.len();
            entries.resize(block + size, 0);
            for child in 0..size {
                entries[block + child] = grow(size, depth - 1, mix(key ^ (child as u64) << 7), entries);
            }
            1 << 31 | (block / size) as u32
        }
        let mut entries = Vec::new();
        let root = grow(rank.children(), 4, 3, &mut entries);
        Tree::from_entries(rank, root, entries).unwrap()
    }

    #[test]
    fn codes_find_what_evaluate_finds() {
        let disk = |k: u64| Disk::uniform([uniform(1, k), uniform(2, k)]);
        let (incident, outgoing): (Vec<Disk>, Vec<Disk>) = (0..5000).map(|k| (disk(2 * k), disk(2 * k + 1))).unzip();
        for turn in [Turn::NONE, Turn::new(0.4, true)] {
            let back = turn.inverse();
            let (four, three) = (bushy(Rank::Anisotropic), bushy(Rank::Isotropic));
            let (a, b) = (
                anisotropic_codes(&incident, turn, 0),
                anisotropic_codes(&outgoing, turn, 2),
            );
            let (c, d) = (Isotropic::new(&incident, turn), Isotropic::new(&outgoing, turn));
            for k in 0..incident.len() {
                let (i, o) = (back.apply(incident[k]), back.apply(outgoing[k]));
                assert_eq!(f64::from(walk::<4>(&four, a[k] | b[k])), four.evaluate(i, o));
                assert_eq!(f64::from(walk::<3>(&three, c.code(k, &d, k))), three.evaluate(i, o));
            }
        }
    }
}
