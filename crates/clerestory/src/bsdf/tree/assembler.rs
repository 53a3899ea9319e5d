//! Puts trees together from the bottom up.

use super::{BRANCH, Rank, Tree};
use crate::error::Result;

/// Blocks of a tree that grows. Children that are one value everywhere become that value, so a tree holds no needless
/// leaves.
pub(super) struct Assembler {
    rank: Rank,
    entries: Vec<u32>,
}

impl Assembler {
    pub fn new(rank: Rank) -> Self {
        Self {
            rank,
            entries: Vec::new(),
        }
    }

    /// With room for so many entries.
    pub fn with_room(rank: Rank, entries: usize) -> Self {
        Self {
            rank,
            entries: Vec::with_capacity(entries),
        }
    }

    /// Number of entries so far.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// The entry that stands for these 2^rank children.
    pub fn join(&mut self, children: &[u32]) -> u32 {
        let first = children[0];
        if first & BRANCH == 0 && children.iter().all(|&child| child == first) {
            return first;
        }
        let block = self.entries.len() / self.rank.children();
        self.entries.extend_from_slice(children);
        BRANCH | block as u32
    }

    /// Takes over another assembler's blocks; its root's entry here.
    pub fn append(&mut self, other: Self, root: u32) -> u32 {
        let offset = (self.entries.len() / self.rank.children()) as u32;
        let moved = |entry: u32| if entry & BRANCH == 0 { entry } else { entry + offset };
        self.entries.extend(other.entries.into_iter().map(moved));
        moved(root)
    }

    /// The tree.
    pub fn finish(self, root: u32) -> Result<Tree> {
        Tree::from_entries(self.rank, root, self.entries)
    }
}
