//! Tensor tree: a BSDF of variable resolution, fine where it changes and coarse where it does not (Ward, Kurt, Bonneel
//! 2012).
//!
//! Rank 4 is anisotropic: axes 0 and 1 are the incident direction's square point, 2 and 3 the outgoing one's. Rank 3 is
//! isotropic: axis 0 is the incident radius, 1 and 2 the outgoing square point, in a frame turned so that the light
//! travels toward +x. The value is constant in a cell; nothing is interpolated.
//!
//! Storage is one array of 32-bit entries. A branch is a block of 2^rank entries, child n holding the upper half of axis k
//! where bit k of n is set. An entry is a value (the bits of a float that is not negative) or, with the highest bit set,
//! the number of a block.

mod text;

use std::f64::consts::PI;

use super::separated::{Cell, Tabular};
use super::{Estimate, Part, Peak, Sample, Scatterer, Turn};
use crate::direction::Disk;
use crate::error::{Error, Result};

pub use text::{Clamped, parse};

/// Marks an entry as the number of a block.
const BRANCH: u32 = 1 << 31;

/// Deepest tree: 2^16 cells an axis.
pub const MAX_DEPTH: u32 = 16;

/// Isotropic or anisotropic.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Rank {
    /// Rank 3.
    Isotropic,
    /// Rank 4.
    Anisotropic,
}

impl Rank {
    /// Number of axes.
    pub fn axes(self) -> u32 {
        match self {
            Self::Isotropic => 3,
            Self::Anisotropic => 4,
        }
    }

    /// Number of axes of the incident direction.
    pub fn incident_axes(self) -> u32 {
        self.axes() - 2
    }

    /// Entries of a block.
    pub fn children(self) -> usize {
        1 << self.axes()
    }
}

/// A tensor tree.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    rank: Rank,
    /// The root's entry, then blocks.
    root: u32,
    entries: Vec<u32>,
    depth: u32,
}

impl Tree {
    /// One value everywhere.
    pub fn constant(rank: Rank, value: f32) -> Result<Self> {
        Self::from_entries(rank, encode(value)?, Vec::new())
    }

    /// From the root's entry and the blocks that it leads to.
    pub fn from_entries(rank: Rank, root: u32, entries: Vec<u32>) -> Result<Self> {
        let mut tree = Self {
            rank,
            root,
            entries,
            depth: 0,
        };
        tree.depth = tree.check()?;
        Ok(tree)
    }

    /// Depth, after making sure that every block is used once and all values are sound.
    fn check(&self) -> Result<u32> {
        let size = self.rank.children();
        let blocks = self.entries.len() / size;
        let broken = || Error::Argument("the tensor tree's blocks do not form a tree".into());
        if !self.entries.len().is_multiple_of(size) || blocks >= BRANCH as usize {
            return Err(broken());
        }
        let mut seen = 0;
        let mut deepest = 0;
        let mut stack = vec![(self.root, 0)];
        while let Some((entry, depth)) = stack.pop() {
            match decode(entry) {
                Entry::Value(value) if value.is_finite() => deepest = deepest.max(depth),
                Entry::Value(value) => {
                    return Err(Error::Argument(format!("the tensor tree holds the value {value}")));
                }
                Entry::Block(block) => {
                    seen += 1;
                    if block >= blocks || seen > blocks || depth >= MAX_DEPTH {
                        return Err(broken());
                    }
                    stack.extend(self.block(block).iter().map(|&e| (e, depth + 1)));
                }
            }
        }
        if seen == blocks { Ok(deepest) } else { Err(broken()) }
    }

    /// Isotropic or anisotropic.
    pub fn rank(&self) -> Rank {
        self.rank
    }

    /// The root's entry.
    pub fn root(&self) -> u32 {
        self.root
    }

    /// Blocks of 2^rank entries.
    pub fn entries(&self) -> &[u32] {
        &self.entries
    }

    /// Levels below the root: 2^depth cells an axis at the finest.
    pub fn depth(&self) -> u32 {
        self.depth
    }

    /// Number of values.
    pub fn leaves(&self) -> usize {
        self.entries.len() - self.entries.len() / self.rank.children() + 1
    }

    fn block(&self, block: usize) -> &[u32] {
        let size = self.rank.children();
        &self.entries[block * size..(block + 1) * size]
    }

    /// Tree coordinates of a pair of directions.
    pub fn coordinates(&self, incident: Disk, outgoing: Disk) -> [f64; 4] {
        match self.rank {
            Rank::Anisotropic => {
                let (i, o) = (incident.to_square(), outgoing.to_square());
                [i[0], i[1], o[0], o[1]]
            }
            Rank::Isotropic => {
                let r = incident.x.hypot(incident.y);
                let (sin, cos) = if r > 0.0 {
                    (-incident.y / r, incident.x / r)
                } else {
                    (0.0, 1.0)
                };
                let o = outgoing.turned(sin, cos).to_square();
                // Normal incidence stays below the unused half.
                [(0.5 - 0.5 * r).min(0.5 - 5e-7), o[0], o[1], 0.0]
            }
        }
    }

    /// Walks to the leaf of tree coordinates: the entry's place in the storage, value and depth.
    fn find(&self, mut x: [f64; 4]) -> (usize, f32, u32) {
        let axes = self.rank.axes() as usize;
        let (mut entry, mut place, mut depth) = (self.root, usize::MAX, 0);
        loop {
            match decode(entry) {
                Entry::Value(value) => return (place, value, depth),
                Entry::Block(block) => {
                    let mut child = 0;
                    for (axis, c) in x[..axes].iter_mut().enumerate() {
                        *c *= 2.0;
                        if *c >= 1.0 {
                            *c -= 1.0;
                            child |= 1 << axis;
                        }
                    }
                    place = block * self.rank.children() + child;
                    entry = self.entries[place];
                    depth += 1;
                }
            }
        }
    }

    /// All values multiplied by a factor of 0 or more.
    pub fn scaled(&self, factor: f64) -> Result<Self> {
        let scale = |entry: u32| match decode(entry) {
            Entry::Value(value) => encode((f64::from(value) * factor) as f32),
            Entry::Block(_) => Ok(entry),
        };
        Self::from_entries(
            self.rank,
            scale(self.root)?,
            self.entries.iter().map(|&e| scale(e)).collect::<Result<_>>()?,
        )
    }

    /// The tree of the turned or mirrored sample, where its grid can be turned so: by quarter turns, or by any angle if
    /// isotropic.
    pub fn turned(&self, turn: Turn) -> Option<Self> {
        let quarters = turn.angle() / std::f64::consts::FRAC_PI_2;
        let whole = quarters.round();
        let steps = match self.rank {
            Rank::Isotropic => 0,
            Rank::Anisotropic if (quarters - whole).abs() < 1e-12 => whole.rem_euclid(4.0) as usize,
            Rank::Anisotropic => return None,
        };
        // Where the value of a child comes from, for a pair of axes (bits) of one direction.
        let back = |bits: usize| {
            let (mut x, mut y) = (bits & 1, bits >> 1);
            for _ in 0..steps {
                // A quarter turn back: (x, y) comes from (y, -x).
                (x, y) = (y, 1 - x);
            }
            if turn.mirror() {
                x = 1 - x;
            }
            x | y << 1
        };
        let source = |child: usize| match self.rank {
            Rank::Anisotropic => back(child & 3) | back(child >> 2) << 2,
            // In the frame of the light's own plane a mirror image is left to right of that plane: axis 2.
            Rank::Isotropic if turn.mirror() => child ^ 4,
            Rank::Isotropic => child,
        };
        Some(self.permuted(source))
    }

    /// All paths travelled backwards; a tree of its own for rank 4 only.
    pub fn reversed(&self) -> Option<Self> {
        match self.rank {
            // f'(i; o) = f(1 - o; 1 - i).
            Rank::Anisotropic => Some(self.permuted(|child| {
                let flipped = 15 ^ child;
                flipped >> 2 | (flipped & 3) << 2
            })),
            Rank::Isotropic => None,
        }
    }

    /// Children of every block rearranged: child n comes from `source(n)`.
    fn permuted(&self, source: impl Fn(usize) -> usize) -> Self {
        let size = self.rank.children();
        let order: Vec<usize> = (0..size).map(source).collect();
        let entries = self
            .entries
            .chunks_exact(size)
            .flat_map(|block| order.iter().map(|&n| block[n]))
            .collect();
        Self {
            entries,
            ..self.clone()
        }
    }

    /// Outgoing cells for one incident direction, in the tree's frame: corner and edge in the square, value, place.
    fn slice(&self, incident: Disk) -> Vec<SliceCell> {
        let axes = self.rank.incident_axes();
        let x = self.coordinates(incident, Disk::NORMAL);
        let mut cells = Vec::new();
        let mut stack = vec![(self.root, usize::MAX, [0.0, 0.0], 1.0, [x[0], x[1]])];
        while let Some((entry, place, corner, edge, at)) = stack.pop() {
            match decode(entry) {
                Entry::Value(value) => cells.push(SliceCell {
                    corner,
                    edge,
                    value: f64::from(value),
                    place,
                }),
                Entry::Block(block) => {
                    let mut below = 0;
                    let mut next = at;
                    for axis in 0..axes as usize {
                        next[axis] *= 2.0;
                        if next[axis] >= 1.0 {
                            next[axis] -= 1.0;
                            below |= 1 << axis;
                        }
                    }
                    let half = edge / 2.0;
                    for out in 0..4 {
                        let child = block * self.rank.children() + (below | out << axes);
                        let corner = [
                            corner[0] + half * (out & 1) as f64,
                            corner[1] + half * (out >> 1) as f64,
                        ];
                        stack.push((self.entries[child], child, corner, half, next));
                    }
                }
            }
        }
        cells
    }

    /// From the tree's frame to the sample's.
    fn unturn(&self, incident: Disk, outgoing: Disk) -> Disk {
        let r = incident.x.hypot(incident.y);
        if self.rank == Rank::Anisotropic || r == 0.0 {
            return outgoing;
        }
        outgoing.turned(incident.y / r, incident.x / r)
    }
}

/// An outgoing cell of a tree.
struct SliceCell {
    corner: [f64; 2],
    edge: f64,
    value: f64,
    place: usize,
}

/// What an entry of the storage means.
enum Entry {
    Value(f32),
    Block(usize),
}

fn decode(entry: u32) -> Entry {
    if entry & BRANCH == 0 {
        Entry::Value(f32::from_bits(entry))
    } else {
        Entry::Block((entry & !BRANCH) as usize)
    }
}

fn encode(value: f32) -> Result<u32> {
    if value.is_finite() && value >= 0.0 {
        // + 0.0 clears the sign of -0.
        Ok((value + 0.0).to_bits() & !BRANCH)
    } else {
        Err(Error::Argument(format!(
            "{value} cannot be a value of a tensor tree (give finite numbers of 0 or more)"
        )))
    }
}

impl Scatterer for Tree {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        f64::from(self.find(self.coordinates(incident, outgoing)).1)
    }

    fn peaks(&self, _: Disk) -> Vec<Peak> {
        Vec::new()
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        let cells = self.slice(incident);
        let flux = |c: &SliceCell| c.value * c.edge * c.edge * PI;
        let total: f64 = cells.iter().map(flux).sum();
        let mut target = u[0] * total;
        let mut chosen = None;
        for cell in &cells {
            let flux = flux(cell);
            if flux > 0.0 {
                chosen = Some((cell, (target / flux).clamp(0.0, 1.0 - f64::EPSILON)));
                if target < flux {
                    break;
                }
            }
            target -= flux;
        }
        let (cell, inner) = chosen?;
        let square = [cell.corner[0] + cell.edge * inner, cell.corner[1] + cell.edge * u[1]];
        Some(Sample {
            outgoing: self.unturn(incident, Disk::from_square(square)),
            weight: total,
            peak: false,
        })
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        let total = self.total(incident, Part::All).value;
        if total <= 0.0 {
            return 0.0;
        }
        self.evaluate(incident, outgoing) * outgoing.cos_theta() / total
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        if part == Part::Direct {
            return 0.0.into();
        }
        let sum: f64 = self.slice(incident).iter().map(|c| c.value * c.edge * c.edge).sum();
        (PI * sum).into()
    }

    fn resolution(&self, incident: Disk) -> f64 {
        let edge = self.slice(incident).iter().map(|c| c.edge).fold(1.0, f64::min);
        2.0 * edge
    }
}

impl Tabular for Tree {
    fn cell(&self, incident: Disk, outgoing: Disk) -> Cell {
        let (place, value, depth) = self.find(self.coordinates(incident, outgoing));
        Cell {
            id: place as u64,
            value: f64::from(value),
            area: PI * 0.25_f64.powi(depth as i32),
        }
    }

    fn smallest_area(&self) -> f64 {
        PI * 0.25_f64.powi(self.depth as i32)
    }

    fn floor(&self) -> f64 {
        let least = std::iter::once(self.root)
            .chain(self.entries.iter().copied())
            .filter_map(|entry| match decode(entry) {
                Entry::Value(value) => Some(f64::from(value)),
                Entry::Block(_) => None,
            })
            .fold(f64::INFINITY, f64::min);
        if least > 1.5 / PI { 0.0 } else { least }
    }
}
