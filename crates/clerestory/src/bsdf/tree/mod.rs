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

mod assembler;
mod backwards;
mod beam;
mod build;
mod cells;
mod code;
mod combine;
mod errors;
mod reduce;
mod sampling;
#[cfg(test)]
pub(super) mod testing;
mod text;

use std::f64::consts::PI;
use std::sync::{Arc, OnceLock};

use super::Turn;
use super::separated::{Cell, Tabular};
use crate::direction::Disk;
use crate::error::{Error, Result};
use errors::LeafErrors;
use sampling::Slices;

pub(super) use backwards::Backwards;
pub use build::Grid;
pub use cells::OutgoingCell;
pub use reduce::Reduction;
pub use text::{Clamped, parse};

/// Marks an entry as the number of a block.
const BRANCH: u32 = 1 << 31;

/// Deepest tree: 2^16 cells an axis.
pub const MAX_DEPTH: u32 = 16;

/// Most blocks; at 4 bytes an entry memory ends earlier.
const MAX_BLOCKS: usize = 1 << 29;

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
#[derive(Debug, Clone)]
pub struct Tree {
    rank: Rank,
    /// The root's entry, then blocks.
    root: u32,
    entries: Vec<u32>,
    depth: u32,
    /// Where they are known.
    errors: Option<Arc<LeafErrors>>,
    /// Made when first needed.
    slices: OnceLock<Arc<Slices>>,
}

/// The same cells with the same values, in whatever order they are stored.
impl PartialEq for Tree {
    fn eq(&self, other: &Self) -> bool {
        self.rank == other.rank && self.same(self.root, other, other.root)
    }
}

impl Tree {
    /// One value everywhere.
    pub fn constant(rank: Rank, value: f32) -> Result<Self> {
        Self::from_entries(rank, encode(value)?, Vec::new())
    }

    /// From the root's entry and the blocks that it leads to.
    pub fn from_entries(rank: Rank, root: u32, entries: Vec<u32>) -> Result<Self> {
        let mut tree = Self::assembled(rank, root, entries, 0);
        tree.depth = tree.check()?;
        Ok(tree)
    }

    /// From parts that are known to be sound.
    fn assembled(rank: Rank, root: u32, entries: Vec<u32>, depth: u32) -> Self {
        Self {
            rank,
            root,
            entries,
            depth,
            errors: None,
            slices: OnceLock::new(),
        }
    }

    fn slices(&self) -> &Slices {
        self.slices.get_or_init(|| Arc::new(Slices::new(self)))
    }

    fn same(&self, entry: u32, other: &Self, theirs: u32) -> bool {
        match (decode(entry), decode(theirs)) {
            (Entry::Block(a), Entry::Block(b)) => {
                let mut pairs = self.block(a).iter().zip(other.block(b));
                pairs.all(|(&a, &b)| self.same(a, other, b))
            }
            (Entry::Value(a), Entry::Value(b)) => a == b,
            _ => false,
        }
    }

    /// Depth, after making sure that every block is used once and all values are sound.
    fn check(&self) -> Result<u32> {
        let size = self.rank.children();
        let blocks = self.entries.len() / size;
        let broken = || Error::Argument("the tensor tree's blocks do not form a tree".into());
        if !self.entries.len().is_multiple_of(size) || blocks > MAX_BLOCKS {
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

    /// Value of a code: that of an incident joined with that of an outgoing direction.
    pub fn value_at(&self, code: u64) -> f32 {
        match self.rank {
            Rank::Isotropic => self.walk::<3>(code).0,
            Rank::Anisotropic => self.walk::<4>(code).0,
        }
    }

    /// Walks to the leaf of a code: value, place in the storage, depth.
    fn walk<const AXES: u32>(&self, code: u64) -> (f32, usize, u32) {
        let (mut entry, mut place, mut shift) = (self.root, usize::MAX, AXES * MAX_DEPTH);
        while entry & BRANCH != 0 {
            shift -= AXES;
            let child = (code >> shift) as usize & ((1 << AXES) - 1);
            place = ((entry & !BRANCH) as usize) << AXES | child;
            entry = self.entries[place];
        }
        (f32::from_bits(entry), place, MAX_DEPTH - shift / AXES)
    }

    /// All values multiplied by a factor of 0 or more.
    pub fn scaled(&self, factor: f64) -> Result<Self> {
        let scale = |entry: u32| match decode(entry) {
            Entry::Value(value) => encode((f64::from(value) * factor) as f32),
            Entry::Block(_) => Ok(entry),
        };
        let mut tree = Self::from_entries(
            self.rank,
            scale(self.root)?,
            self.entries.iter().map(|&e| scale(e)).collect::<Result<_>>()?,
        )?;
        tree.errors = self.errors.as_ref().map(|e| Arc::new(e.scaled(factor)));
        Ok(tree)
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
        let mut tree = Self::assembled(self.rank, self.root, entries, self.depth);
        tree.errors = self.errors.as_ref().map(|errors| {
            let blocks = errors.entries.chunks_exact(size);
            Arc::new(LeafErrors {
                root: errors.root,
                entries: blocks.flat_map(|block| order.iter().map(|&n| block[n])).collect(),
            })
        });
        tree
    }
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

impl Tree {
    fn cell_of(&self, code: u64) -> (Cell, u32) {
        let (value, place, depth) = match self.rank {
            Rank::Isotropic => self.walk::<3>(code),
            Rank::Anisotropic => self.walk::<4>(code),
        };
        let area = PI * 0.25_f64.powi(depth as i32);
        let cell = Cell {
            id: place as u64,
            value: f64::from(value),
            area,
            outgoing_area: area,
        };
        (cell, depth)
    }

    /// The cell of a pair of directions and its level below the root.
    pub(super) fn leaf(&self, incident: Disk, outgoing: Disk) -> (Cell, u32) {
        self.cell_of(self.rank.code(incident, outgoing))
    }
}

impl Tabular for Tree {
    fn cell(&self, incident: Disk, outgoing: Disk) -> Cell {
        self.leaf(incident, outgoing).0
    }

    fn cells(&self, incident: Disk, outgoing: &[Disk], cells: &mut [Cell]) {
        let code = self.rank.incident_code(incident);
        for (cell, &point) in cells.iter_mut().zip(outgoing) {
            let code = code | self.rank.outgoing_code(self.rank.into_frame(incident, point));
            *cell = self.cell_of(code).0;
        }
    }

    fn extent(&self, _: Disk, _: Disk) -> f64 {
        // From the square of edge 1 to the disk of radius 1 one side of a cell grows by at most 2 √(1 + (π/4)²) = 2.55, the
        // other by π/2; the diagonal is no longer than both together.
        4.2 * 0.5_f64.powi(self.depth as i32)
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

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::testing::{Stream, random};
    use super::*;
    use crate::bsdf::Scatterer;

    const RANKS: [Rank; 2] = [Rank::Isotropic, Rank::Anisotropic];

    #[test]
    fn turned_trees_are_looked_up_as_their_originals_are_before_the_turn() {
        for rank in RANKS {
            let tree = random(rank, 4, 1);
            let mut stream = Stream::new(2);
            for quarters in -1..5 {
                for mirror in [false, true] {
                    let turn = Turn::new(f64::from(quarters) * FRAC_PI_2, mirror);
                    let turned = tree.turned(turn).unwrap();
                    for _ in 0..300 {
                        let (i, o) = (stream.disk(), stream.disk());
                        assert_eq!(
                            turned.evaluate(turn.apply(i), turn.apply(o)),
                            tree.evaluate(i, o),
                            "{rank:?} {turn:?} {i:?} {o:?}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn only_isotropic_trees_turn_by_any_angle() {
        let turn = Turn::new(0.3, true);
        assert!(random(Rank::Anisotropic, 2, 1).turned(turn).is_none());
        let tree = random(Rank::Isotropic, 4, 1);
        let turned = tree.turned(turn).unwrap();
        let mut stream = Stream::new(3);
        for _ in 0..300 {
            let (i, o) = (stream.disk(), stream.disk());
            assert_eq!(turned.evaluate(turn.apply(i), turn.apply(o)), tree.evaluate(i, o));
        }
    }

    #[test]
    fn reversed_trees_swap_the_directions() {
        let tree = random(Rank::Anisotropic, 4, 4);
        let reversed = tree.reversed().unwrap();
        let mut stream = Stream::new(5);
        for _ in 0..1000 {
            let (i, o) = (stream.disk(), stream.disk());
            assert_eq!(reversed.evaluate(o.reversed(), i.reversed()), tree.evaluate(i, o));
        }
        assert_eq!(reversed.reversed().unwrap(), tree);
        assert!(random(Rank::Isotropic, 2, 4).reversed().is_none());
    }

    #[test]
    fn scaled_values_are_multiplied() {
        let tree = random(Rank::Anisotropic, 3, 4);
        let twice = tree.scaled(2.0).unwrap();
        let mut stream = Stream::new(6);
        for _ in 0..100 {
            let (i, o) = (stream.disk(), stream.disk());
            assert_eq!(twice.evaluate(i, o), 2.0 * tree.evaluate(i, o));
            let (total, base) = (
                twice.total(i, super::super::Part::All),
                tree.total(i, super::super::Part::All),
            );
            assert!((total.value - 2.0 * base.value).abs() < 1e-12 * total.value);
        }
        assert!(tree.scaled(f64::INFINITY).is_err());
    }

    #[test]
    fn cells_tell_their_area_and_their_place() {
        let tree = random(Rank::Anisotropic, 3, 8);
        let mut stream = Stream::new(9);
        for _ in 0..200 {
            let (i, o) = (stream.disk(), stream.disk());
            let cell = tree.cell(i, o);
            assert_eq!(cell.value, tree.evaluate(i, o));
            assert_eq!(f64::from(f32::from_bits(tree.entries()[cell.id as usize])), cell.value);
            assert!(cell.area >= tree.smallest_area() && cell.area <= PI / 4.0);
        }
    }

    #[test]
    fn blocks_that_form_no_tree_are_refused() {
        let values = |n: usize| vec![1.0_f32.to_bits(); n];
        let with = |place: usize, entry: u32, n: usize| {
            let mut entries = values(n);
            entries[place] = entry;
            entries
        };
        for (root, entries) in [
            (BRANCH, values(7)),
            (BRANCH, values(16)),
            (BRANCH | 1, values(8)),
            (BRANCH, with(3, BRANCH, 8)),
            (BRANCH, with(3, BRANCH | 5, 8)),
            (1.0_f32.to_bits(), values(8)),
            (BRANCH, with(0, f32::NAN.to_bits(), 8)),
            (f32::INFINITY.to_bits(), Vec::new()),
        ] {
            assert!(Tree::from_entries(Rank::Isotropic, root, entries).is_err());
        }
        assert!(Tree::constant(Rank::Isotropic, -1.0).is_err());
    }
}
