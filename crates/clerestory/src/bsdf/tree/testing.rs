//! Trees for tests.

use super::{BRANCH, Rank, Tree};
use crate::direction::Disk;
use crate::sequence::uniform;

/// Numbers of a stream.
pub(super) struct Stream(u64, u64);

impl Stream {
    pub fn new(seed: u64) -> Self {
        Self(seed, 0)
    }

    pub fn next(&mut self) -> f64 {
        self.1 += 1;
        uniform(self.0, self.1)
    }

    pub fn disk(&mut self) -> Disk {
        Disk::uniform([self.next(), self.next()])
    }
}

/// A tree of leaves of several sizes, some of them zero, with values from 0 to 1 and some much larger ones.
pub(in crate::bsdf) fn random(rank: Rank, depth: u32, seed: u64) -> Tree {
    fn node(rank: Rank, left: u32, stream: &mut Stream, entries: &mut Vec<u32>) -> u32 {
        if left == 0 || (stream.next() < 0.4 && !entries.is_empty()) {
            let value = match stream.next() {
                u if u < 0.3 => 0.0,
                u if u < 0.4 => 30.0 * stream.next(),
                _ => stream.next(),
            };
            return (value as f32).to_bits();
        }
        let (first, size) = (entries.len(), rank.children());
        entries.resize(first + size, 0);
        for child in 0..size {
            entries[first + child] = node(rank, left - 1, stream, entries);
        }
        BRANCH | (first / size) as u32
    }
    let mut entries = Vec::new();
    let root = node(rank, depth, &mut Stream::new(seed), &mut entries);
    Tree::from_entries(rank, root, entries).unwrap()
}
