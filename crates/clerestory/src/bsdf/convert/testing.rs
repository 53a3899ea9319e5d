//! A tree for tests.

use crate::bsdf::{Rank, Tree};
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
