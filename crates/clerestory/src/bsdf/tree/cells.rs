//! The cells of a tree: all of them, and those that light from one direction sees.

use super::{BRANCH, Tree};
use crate::direction::Disk;

/// Where a walk over leaves begins: an entry, its level and its cell.
#[derive(Debug, Clone, Copy)]
pub struct Top {
    entry: u32,
    level: usize,
    cell: [usize; 4],
}

/// An outgoing cell, in the tree's frame (see [`Rank::out_of_frame`](super::Rank::out_of_frame)).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OutgoingCell {
    /// Lower corner in the unit square of [`Disk::to_square`].
    pub corner: [f64; 2],
    /// Its width there.
    pub edge: f64,
    /// BSDF (1/sr).
    pub value: f64,
}

impl Tree {
    /// Parts of the tree that can be walked side by side: the root's children in their order, or the root where it is a leaf.
    pub fn top(&self) -> Vec<Top> {
        let root = Top {
            entry: self.root,
            level: 0,
            cell: [0; 4],
        };
        if self.root & BRANCH == 0 {
            vec![root]
        } else {
            self.below(root).collect()
        }
    }

    /// Calls `leaf(level, cell, value)` for each leaf of a value above 0. A cell is counted along each axis in widths of 2^-level.
    ///
    /// # Errors
    ///
    /// Those of `check`, which is asked before each branch, with its level.
    pub fn visit_leaves<E>(
        &self,
        from: Top,
        check: &mut impl FnMut(usize) -> Result<(), E>,
        leaf: &mut impl FnMut(usize, [usize; 4], f64),
    ) -> Result<(), E> {
        if from.entry & BRANCH == 0 {
            let value = f64::from(f32::from_bits(from.entry));
            if value > 0.0 {
                leaf(from.level, from.cell, value);
            }
            return Ok(());
        }
        check(from.level)?;
        self.below(from)
            .try_for_each(|child| self.visit_leaves(child, check, leaf))
    }

    fn below(&self, branch: Top) -> impl Iterator<Item = Top> {
        let axes = self.rank.axes() as usize;
        let block = self.block((branch.entry & !BRANCH) as usize);
        block.iter().enumerate().map(move |(child, &entry)| Top {
            entry,
            level: branch.level + 1,
            cell: std::array::from_fn(|axis| {
                if axis < axes {
                    branch.cell[axis] << 1 | child >> axis & 1
                } else {
                    0
                }
            }),
        })
    }

    /// The outgoing cells for light from one direction. They fill the square.
    pub fn outgoing_cells(&self, incident: Disk) -> Vec<OutgoingCell> {
        let axes = self.rank.incident_axes();
        let code = self.rank.incident_code(incident);
        let mut cells = Vec::new();
        let mut stack = vec![(self.root, [0.0, 0.0], 0_u32)];
        while let Some((entry, corner, level)) = stack.pop() {
            let edge = 0.5_f64.powi(level as i32);
            if entry & BRANCH == 0 {
                cells.push(OutgoingCell {
                    corner,
                    edge,
                    value: f64::from(f32::from_bits(entry)),
                });
                continue;
            }
            let position = self.rank.incident_child(code, level);
            let block = self.block((entry & !BRANCH) as usize);
            for quadrant in 0..4 {
                let half = 0.5 * edge;
                let corner = [
                    corner[0] + half * (quadrant & 1) as f64,
                    corner[1] + half * (quadrant >> 1) as f64,
                ];
                stack.push((block[position | quadrant << axes], corner, level + 1));
            }
        }
        cells
    }
}

#[cfg(test)]
mod tests {
    use super::super::Rank;
    use super::super::testing::{Stream, random};
    use super::*;
    use crate::bsdf::Scatterer;

    #[test]
    fn cells_fill_the_square_and_hold_what_a_look_up_finds() {
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let tree = random(rank, 5, 3);
            let mut stream = Stream::new(4);
            for _ in 0..20 {
                let incident = stream.disk();
                let cells = tree.outgoing_cells(incident);
                let area: f64 = cells.iter().map(|c| c.edge * c.edge).sum();
                assert!((area - 1.0).abs() < 1e-12);
                for cell in cells {
                    let middle = cell.corner.map(|c| c + 0.5 * cell.edge);
                    let outgoing = rank.out_of_frame(incident, Disk::from_square(middle));
                    assert_eq!(tree.evaluate(incident, outgoing), cell.value);
                }
            }
        }
    }
}
