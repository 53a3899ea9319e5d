//! What light from one direction sees of a tree: its outgoing cells.

use super::{BRANCH, Tree};
use crate::direction::Disk;

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
