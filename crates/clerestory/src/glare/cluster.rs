//! Pixels that are not further apart than an angle, directly or over others, are one source.
//!
//! Directions fall into cubic cells so small that all in one belong together; then only cells near each other that are not
//! yet joined have to be compared. The outcome does not depend on the order.

use std::collections::HashMap;

/// Number of the group of each direction (of length 1), counted in the order in which groups begin.
pub(super) fn groups(directions: &[[f64; 3]], angle: f64) -> Vec<u32> {
    let all: Vec<u32> = (0..directions.len() as u32).collect();
    Neighbourhood::new(directions, angle).groups(directions, &all)
}

/// What is near what among directions, some of which are asked about again and again.
#[derive(Debug, Clone)]
pub(super) struct Neighbourhood {
    /// Cell of each direction.
    of: Vec<u32>,
    cells: usize,
    /// Cells that can hold directions within reach of each other. Near cells first: they join most, and pairs that are joined
    /// need no search.
    pairs: Vec<(u32, u32)>,
    /// Square of the largest chord.
    limit: f64,
}

impl Neighbourhood {
    /// Of directions (of length 1) that belong together within an angle.
    pub(super) fn new(directions: &[[f64; 3]], angle: f64) -> Self {
        let chord = 2.0 * (0.5 * angle.min(std::f64::consts::PI)).sin();
        let side = chord / 3.0_f64.sqrt() * (1.0 - 1e-9);
        let Cells { of, keys, index } = Cells::new(directions, side);
        let mut pairs = Vec::new();
        for step in steps() {
            for (cell, key) in keys.iter().enumerate() {
                if let Some(&other) = index.get(&key.wrapping_add_signed(step)) {
                    pairs.push((cell as u32, other));
                }
            }
        }
        Self {
            of,
            cells: keys.len(),
            pairs,
            // A pair that is exactly at the limit belongs together, whatever the last digit.
            limit: chord * chord * (1.0 + 1e-12),
        }
    }

    /// Number of the group of each of some of the directions, counted in the order in which groups begin.
    pub(super) fn groups(&self, directions: &[[f64; 3]], chosen: &[u32]) -> Vec<u32> {
        // Members of each cell, one cell after another.
        let mut first = vec![0_u32; self.cells + 1];
        for &k in chosen {
            first[self.of[k as usize] as usize + 1] += 1;
        }
        for k in 1..first.len() {
            first[k] += first[k - 1];
        }
        let mut at = first.clone();
        let mut members = vec![0; chosen.len()];
        for &k in chosen {
            let cell = self.of[k as usize] as usize;
            members[at[cell] as usize] = k;
            at[cell] += 1;
        }
        let members = |cell: u32| &members[first[cell as usize] as usize..first[cell as usize + 1] as usize];
        let mut parents: Vec<u32> = (0..self.cells as u32).collect();
        for &(one, other) in &self.pairs {
            if members(one).is_empty() || members(other).is_empty() {
                continue;
            }
            let (a, b) = (root(&mut parents, one), root(&mut parents, other));
            if a != b && near(directions, members(one), members(other), self.limit) {
                parents[a.max(b) as usize] = a.min(b);
            }
        }
        let mut numbers = vec![u32::MAX; self.cells];
        let mut count = 0;
        chosen
            .iter()
            .map(|&k| {
                let number = &mut numbers[root(&mut parents, self.of[k as usize]) as usize];
                if *number == u32::MAX {
                    *number = count;
                    count += 1;
                }
                *number
            })
            .collect()
    }
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
        Self { of, keys, index }
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
