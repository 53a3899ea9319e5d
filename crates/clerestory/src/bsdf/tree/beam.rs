//! Beams put into a tree.

use std::f64::consts::PI;

use super::assembler::Assembler;
use super::{Entry, Rank, Tree, decode, encode};
use crate::error::Result;

impl Tree {
    /// With a beam straight on, of a value for each of its 2^levels incident cells an axis (see
    /// [`Cells::Tree`](crate::bsdf::Cells)): it fills the outgoing cell in the same place. For rank 3 that place is on the
    /// border of two cells, which take half each.
    pub(in crate::bsdf) fn with_beam(&self, levels: u32, values: &[f64]) -> Result<Self> {
        let beam = Beam {
            tree: self,
            levels,
            values,
        };
        let mut assembler = Assembler::new(self.rank);
        let root = beam.node(self.root, 0, [0; 4], &mut assembler)?;
        assembler.finish(root)
    }
}

struct Beam<'a> {
    tree: &'a Tree,
    levels: u32,
    values: &'a [f64],
}

impl Beam<'_> {
    /// Whether a beam passes through a cell.
    fn passes(&self, level: u32, cell: [u32; 4]) -> bool {
        let n = 1_u32 << level;
        match self.tree.rank {
            Rank::Anisotropic => cell[..2] == cell[2..],
            // From the outermost radius inward; the last axis is cut in its middle.
            Rank::Isotropic if level == 0 => true,
            Rank::Isotropic => {
                cell[0] < n / 2 && cell[1] == n - 1 - cell[0] && (cell[2] == n / 2 || cell[2] == n / 2 - 1)
            }
        }
    }

    /// What it adds in one of its finest cells (1/sr).
    fn value(&self, cell: [u32; 4]) -> f64 {
        let n = 1_usize << self.levels;
        let density = (n * n) as f64 / PI;
        match self.tree.rank {
            Rank::Anisotropic => self.values[cell[1] as usize * n + cell[0] as usize] * density,
            Rank::Isotropic if self.levels == 0 => self.values[0] * density,
            Rank::Isotropic => 0.5 * self.values[cell[0] as usize] * density,
        }
    }

    fn node(&self, entry: u32, level: u32, cell: [u32; 4], assembler: &mut Assembler) -> Result<u32> {
        if !self.passes(level, cell) {
            return self.raised(entry, 0.0, assembler);
        }
        if level == self.levels {
            return self.raised(entry, self.value(cell), assembler);
        }
        let axes = self.tree.rank.axes() as usize;
        let mut children = [0; 16];
        let children = &mut children[..1 << axes];
        for (n, child) in children.iter_mut().enumerate() {
            let finer = std::array::from_fn(|axis| {
                if axis < axes {
                    cell[axis] << 1 | (n >> axis & 1) as u32
                } else {
                    0
                }
            });
            let below = match decode(entry) {
                Entry::Value(_) => entry,
                Entry::Block(block) => self.tree.block(block)[n],
            };
            *child = self.node(below, level + 1, finer, assembler)?;
        }
        Ok(assembler.join(children))
    }

    /// All below an entry, with so much more.
    fn raised(&self, entry: u32, by: f64, assembler: &mut Assembler) -> Result<u32> {
        let block = match decode(entry) {
            Entry::Value(value) => return encode((f64::from(value) + by) as f32),
            Entry::Block(block) => block,
        };
        let mut children = [0; 16];
        let children = &mut children[..self.tree.rank.children()];
        for (child, &below) in children.iter_mut().zip(self.tree.block(block)) {
            *child = self.raised(below, by, assembler)?;
        }
        Ok(assembler.join(children))
    }
}
