//! Pixels that are not further apart than an angle, directly or over others, are one source.
//!
//! Directions fall into cubic cells so small that all in one belong together; then only cells near each other that are not
//! yet joined have to be compared. The outcome does not depend on the order.

use std::collections::HashMap;

/// Number of the group of each direction (of length 1), counted in the order in which groups begin.
pub(super) fn groups(directions: &[[f64; 3]], angle: f64) -> Vec<u32> {
    let chord = 2.0 * (0.5 * angle.min(std::f64::consts::PI)).sin();
    // A pair that is exactly at the limit belongs together, whatever the last digit.
    let limit = chord * chord * (1.0 + 1e-12);
    let side = chord / 3.0_f64.sqrt() * (1.0 - 1e-9);
    let cells = Cells::new(directions, side);
    let mut parents: Vec<u32> = (0..cells.keys.len() as u32).collect();
    // Near cells first: they join most, and pairs that are joined need no search.
    for step in steps() {
        for (index, key) in cells.keys.iter().enumerate() {
            let Some(&other) = cells.index.get(&key.wrapping_add_signed(step)) else {
                continue;
            };
            let (a, b) = (root(&mut parents, index as u32), root(&mut parents, other));
            if a != b && near(directions, cells.members(index as u32), cells.members(other), limit) {
                parents[a.max(b) as usize] = a.min(b);
            }
        }
    }
    let mut numbers: HashMap<u32, u32> = HashMap::new();
    cells
        .of
        .iter()
        .map(|&cell| {
            let count = numbers.len() as u32;
            *numbers.entry(root(&mut parents, cell)).or_insert(count)
        })
        .collect()
}

fn near(directions: &[[f64; 3]], a: &[u32], b: &[u32], limit: f64) -> bool {
    a.iter().any(|&i| {
        let p = directions[i as usize];
        b.iter().any(|&j| {
            let q = directions[j as usize];
            (p[0] - q[0]).powi(2) + (p[1] - q[1]).powi(2) + (p[2] - q[2]).powi(2) <= limit
        })
    })
}

fn root(parents: &mut [u32], mut at: u32) -> u32 {
    while parents[at as usize] != at {
        let grandparent = parents[parents[at as usize] as usize];
        parents[at as usize] = grandparent;
        at = grandparent;
    }
    at
}

/// Bits of a cell's coordinate.
const BITS: u32 = 21;

struct Cells {
    /// Cell of each direction.
    of: Vec<u32>,
    /// Key of each cell, and back.
    keys: Vec<u64>,
    index: HashMap<u64, u32>,
    /// Members of each cell, one cell after another.
    members: Vec<u32>,
    first: Vec<u32>,
}

impl Cells {
    fn new(directions: &[[f64; 3]], side: f64) -> Self {
        // Two empty cells on either side, so that neighbours need no check of borders.
        let most = (1_u64 << BITS) - 5;
        let coordinate = |v: f64| (((v + 1.0) / side) as u64).min(most) + 2;
        let mut keys = Vec::new();
        let mut index = HashMap::new();
        let mut last = (u64::MAX, 0);
        let of: Vec<u32> = directions
            .iter()
            .map(|d| {
                let key = coordinate(d[0]) << (2 * BITS) | coordinate(d[1]) << BITS | coordinate(d[2]);
                if key != last.0 {
                    let next = keys.len() as u32;
                    let cell = *index.entry(key).or_insert(next);
                    if cell == next {
                        keys.push(key);
                    }
                    last = (key, cell);
                }
                last.1
            })
            .collect();
        let mut first = vec![0_u32; keys.len() + 1];
        for &cell in &of {
            first[cell as usize + 1] += 1;
        }
        for k in 1..first.len() {
            first[k] += first[k - 1];
        }
        let mut at = first.clone();
        let mut members = vec![0; of.len()];
        for (k, &cell) in of.iter().enumerate() {
            members[at[cell as usize] as usize] = k as u32;
            at[cell as usize] += 1;
        }
        Self {
            of,
            keys,
            index,
            members,
            first,
        }
    }

    fn members(&self, cell: u32) -> &[u32] {
        &self.members[self.first[cell as usize] as usize..self.first[cell as usize + 1] as usize]
    }
}

/// Steps from the key of a cell to those of one half of the cells that can hold directions within reach, by distance; the
/// other half sees it from its side.
fn steps() -> Vec<i64> {
    let range = -2_i64..=2;
    let mut offsets: Vec<(i64, i64, i64)> = range
        .clone()
        .flat_map(|x| range.clone().flat_map(move |y| (-2..=2).map(move |z| (x, y, z))))
        .filter(|&offset| offset > (0, 0, 0))
        .collect();
    offsets.sort_by_key(|(x, y, z)| x * x + y * y + z * z);
    offsets
        .into_iter()
        .map(|(x, y, z)| (x << (2 * BITS)) + (y << BITS) + z)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::uniform;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn groups_are_those_of_all_pairs(seed in 0_u64..1000, count in 1_usize..150, angle in 0.01_f64..0.6) {
            let directions: Vec<[f64; 3]> = (0..count as u64)
                .map(|k| {
                    let (z, phi) = (uniform(seed, 2 * k), std::f64::consts::TAU * uniform(seed, 2 * k + 1));
                    let r = (1.0 - z * z).sqrt();
                    [r * phi.cos(), r * phi.sin(), z]
                })
                .collect();
            let found = groups(&directions, angle);
            let mut expected: Vec<usize> = (0..count).collect();
            for i in 0..count {
                for j in 0..i {
                    let (a, b) = (directions[i], directions[j]);
                    let cosine: f64 = (0..3).map(|c| a[c] * b[c]).sum();
                    if cosine.clamp(-1.0, 1.0).acos() <= angle {
                        let (old, new) = (expected[i].max(expected[j]), expected[i].min(expected[j]));
                        expected.iter_mut().filter(|e| **e == old).for_each(|e| *e = new);
                    }
                }
            }
            for i in 0..count {
                for j in 0..i {
                    prop_assert_eq!(found[i] == found[j], expected[i] == expected[j]);
                }
            }
        }
    }
}
