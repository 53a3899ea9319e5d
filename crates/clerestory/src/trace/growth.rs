//! Trees grown from noisy counts: cells that differ by no more than chance are one cell.
//!
//! A block's children are compared with their mean: the squares of the differences, over the mean of their squared standard
//! errors, sum to about their number less one if chance alone made them different (the index of dispersion; it holds for
//! single counts too). Sums of whole incident and outgoing quadrants are compared in the same way, which finds differences
//! that lie in one direction only. Evidence is summed up from the finest cells on, so that a few chance differences among
//! many blocks do not hold up what is alike as a whole, while a block that no chance can explain stays for good.

use crate::bsdf::Rank;
use crate::error::{Error, Result};

/// Marks an entry as the number of a block, as in [`crate::bsdf::Tree`].
const BRANCH: u32 = 1 << 31;

/// When cells are one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Merging {
    /// Differences by chance reach so many standard deviations.
    pub chance: f64,
    /// A block whose differences move less than this share of the incident light is one cell in any case.
    pub bound: f64,
}

impl Default for Merging {
    fn default() -> Self {
        Self {
            chance: 3.0,
            bound: 0.0,
        }
    }
}

/// Beyond so many times [`Merging::chance`] nothing is chance.
const CERTAIN: f64 = 3.0;

/// Over many cells chance is known better than the variance is: points of a lattice may lie a little closer together than
/// independent ones.
const TOLERATED: f64 = 1.1;

/// A cell or a block, and the evidence that it is not even.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Node {
    /// Value or block.
    pub entry: u32,
    /// Mean (1/sr).
    pub value: f32,
    /// Standard error of the mean.
    pub error: f32,
    /// Sum of squared differences below it, in units of their variance.
    pub dispersion: f32,
    /// How many of them are free; the highest bit is set where chance cannot explain them.
    pub freedom: u32,
}

/// Numbers of a node as 32-bit words.
pub const WORDS: usize = 5;

impl Node {
    /// A finest cell.
    pub fn cell(value: f64, error: f64) -> Self {
        let value = value as f32;
        Self {
            entry: value.to_bits() & !BRANCH,
            value,
            error: error as f32,
            ..Self::default()
        }
    }

    fn is_block(self) -> bool {
        self.entry & BRANCH != 0
    }

    fn is_certain(self) -> bool {
        self.freedom & BRANCH != 0
    }

    pub fn to_words(self) -> [u32; WORDS] {
        [
            self.entry,
            self.value.to_bits(),
            self.error.to_bits(),
            self.dispersion.to_bits(),
            self.freedom,
        ]
    }

    pub fn from_words(words: &[u32]) -> Self {
        Self {
            entry: words[0],
            value: f32::from_bits(words[1]),
            error: f32::from_bits(words[2]),
            dispersion: f32::from_bits(words[3]),
            freedom: words[4],
        }
    }
}

/// Blocks of a tree that grows depth first, with a standard error for each value.
#[derive(Debug, Clone, PartialEq)]
pub struct Growth {
    rank: Rank,
    merging: Merging,
    pub entries: Vec<u32>,
    /// As long; for values only.
    pub errors: Vec<f32>,
}

impl Growth {
    pub fn new(rank: Rank, merging: Merging) -> Self {
        Self {
            rank,
            merging,
            entries: Vec::new(),
            errors: Vec::new(),
        }
    }

    /// Number of entries so far; children that come after it can be taken back by [`Growth::join`].
    pub fn mark(&self) -> usize {
        self.entries.len()
    }

    /// The node over children that were grown since a mark, at a level below the root.
    pub fn join(&mut self, children: &[Node], mark: usize, level: u32) -> Node {
        let incident_axes = self.rank.incident_axes();
        let root_of_rings = self.rank == Rank::Isotropic && level == 0;
        // The outer half of the radius is not used.
        let used = |n: &usize| !root_of_rings || n & 1 == 0;
        let live: Vec<Node> = (0..children.len()).filter(used).map(|n| children[n]).collect();
        let count = live.len() as f64;
        let mean = live.iter().map(|c| f64::from(c.value)).sum::<f64>() / count;
        let variance = live.iter().map(|c| f64::from(c.error).powi(2)).sum::<f64>() / count;
        let squares: f64 = live.iter().map(|c| (f64::from(c.value) - mean).powi(2)).sum();
        let chance = self.merging.chance;
        let within = |dispersion: f64, freedom: f64, times: f64| deviations(dispersion, freedom) <= times * chance;
        // In units of the variance; no variance and no difference is none.
        let units = |squares: f64, variance: f64| {
            if squares <= 1e-12 * mean * mean * count {
                0.0
            } else if variance > 0.0 {
                squares / variance
            } else {
                f64::INFINITY
            }
        };
        let own = units(squares, variance);
        let mut alike = within(own, count - 1.0, 1.0);
        let mut certain = !within(own, count - 1.0, CERTAIN) || live.iter().any(|c| c.is_certain());
        // Quadrants of the incident direction, and of the outgoing one.
        let sides = [(0, 1 << incident_axes), (incident_axes, 4)];
        for (shift, groups) in sides {
            if root_of_rings && shift == 0 {
                continue;
            }
            let mut means = vec![0.0; groups];
            for (n, child) in children.iter().enumerate().filter(|(n, _)| used(n)) {
                means[n >> shift & (groups - 1)] += f64::from(child.value) * groups as f64 / count;
            }
            let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
            let dispersion = units(squares, variance * groups as f64 / count);
            alike &= within(dispersion, groups as f64 - 1.0, 1.0);
            certain |= !within(dispersion, groups as f64 - 1.0, CERTAIN);
        }
        let dispersion = own + live.iter().map(|c| f64::from(c.dispersion)).sum::<f64>();
        let freedom = count - 1.0 + live.iter().map(|c| f64::from(c.freedom & !BRANCH)).sum::<f64>();
        alike &= within(dispersion / TOLERATED, freedom, 1.0);
        let moved = live.iter().map(|c| (f64::from(c.value) - mean).abs()).sum::<f64>() / count;
        let share = moved * std::f64::consts::PI * 0.25_f64.powi(level as i32);
        let small = share <= self.merging.bound && live.iter().all(|c| !c.is_block());
        let merged = small || (alike && !certain);
        certain &= !merged;
        let mut node = Node {
            dispersion: dispersion.min(f64::from(f32::MAX)) as f32,
            freedom: (freedom as u32).min(BRANCH - 1) | if certain { BRANCH } else { 0 },
            error: ((variance / count).sqrt()) as f32,
            ..Node::cell(mean, 0.0)
        };
        if merged {
            self.entries.truncate(mark);
            self.errors.truncate(mark);
        } else {
            node.entry = BRANCH | (self.entries.len() / children.len()) as u32;
            self.entries.extend(children.iter().map(|c| c.entry));
            self.errors.extend(children.iter().map(|c| c.error));
        }
        node
    }

    /// Takes over what hangs on a node of another tree.
    pub fn graft(&mut self, node: Node, entries: &[u32], errors: &[f32]) -> Result<Node> {
        let size = self.rank.children();
        if !node.is_block() {
            return Ok(node);
        }
        let first = (node.entry & !BRANCH) as usize * size;
        let broken = || Error::Argument("the state that was kept is damaged (measure from the start)".into());
        let children = entries.get(first..first + size).ok_or_else(broken)?;
        let mut own = [0; 16];
        for (n, &entry) in children.iter().enumerate() {
            // Blocks are listed after those that they lead to.
            if entry & BRANCH != 0 && (entry & !BRANCH) as usize * size >= first {
                return Err(broken());
            }
            own[n] = self
                .graft(
                    Node {
                        entry,
                        ..Node::default()
                    },
                    entries,
                    errors,
                )?
                .entry;
        }
        let entry = BRANCH | (self.entries.len() / size) as u32;
        self.entries.extend(&own[..size]);
        self.errors.extend(&errors[first..first + size]);
        Ok(Node { entry, ..node })
    }
}

/// How many standard deviations a sum of squares lies above what chance gives, by the cube root of Wilson and Hilferty (1931),
/// which is nearly normal for few free ones, too.
fn deviations(dispersion: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    ((dispersion / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::uniform;

    /// Grows a whole tree of rank 4 from cells of 2^levels an axis.
    fn grow(levels: u32, cell: &dyn Fn(usize, usize) -> Node) -> (Growth, Node) {
        fn node(
            growth: &mut Growth,
            levels: u32,
            level: u32,
            i: usize,
            o: usize,
            cell: &dyn Fn(usize, usize) -> Node,
        ) -> Node {
            if level == levels {
                return cell(i, o);
            }
            let mark = growth.mark();
            let children: Vec<Node> = (0..16)
                .map(|n| node(growth, levels, level + 1, i << 2 | n & 3, o << 2 | n >> 2, cell))
                .collect();
            growth.join(&children, mark, level)
        }
        let mut growth = Growth::new(Rank::Anisotropic, Merging::default());
        let root = node(&mut growth, levels, 0, 0, 0, cell);
        (growth, root)
    }

    fn noise(i: usize, o: usize) -> f64 {
        let k = 2 * (i * 256 + o) as u64;
        (-2.0 * (1.0 - uniform(5, k)).ln()).sqrt() * (std::f64::consts::TAU * uniform(5, k + 1)).cos()
    }

    #[test]
    fn noise_is_merged_and_differences_stay() {
        let (growth, root) = grow(4, &|i, o| Node::cell(1.0 + 0.1 * noise(i, o), 0.1));
        assert_eq!(growth.entries.len(), 0);
        assert!((root.value - 1.0).abs() < 3.0 * root.error && (root.error - 0.1 / 256.0).abs() < 1e-6);
        // A spot in one cell stays, in its place.
        let (growth, _) = grow(4, &|i, o| {
            let spot = if (i, o) == (77, 130) { 5.0 } else { 0.0 };
            Node::cell(1.0 + 0.1 * noise(i, o) + spot, 0.1)
        });
        assert_eq!(growth.entries.len(), 4 * 16);
        // Incident halves that differ by a fraction of the noise do too.
        let (growth, root) = grow(4, &|i, o| {
            let step = if i >> 6 & 1 == 1 { 0.02 } else { 0.0 };
            Node::cell(1.0 + 0.1 * noise(i, o) + step, 0.1)
        });
        assert!(
            root.is_block() && growth.entries.len() <= 5 * 16,
            "{}",
            growth.entries.len()
        );
    }

    #[test]
    fn single_counts_are_no_difference() {
        // One path in a hundred cells.
        let (growth, root) = grow(4, &|i, o| {
            let hit = f64::from(u8::from(uniform(8, (i * 256 + o) as u64) < 0.01));
            Node::cell(hit, hit)
        });
        assert!(growth.entries.len() < 20 * 16, "{}", growth.entries.len());
        assert!((root.value - 0.01).abs() < 1.5e-3);
        let (growth, root) = grow(3, &|_, _| Node::cell(0.0, 0.0));
        assert!(growth.entries.is_empty() && root.entry == 0);
    }

    #[test]
    fn deviations_are_those_of_tables() {
        // Quantiles of 99.865 %, three standard deviations, of the chi-squared distribution.
        for (freedom, quantile) in [(3.0, 15.6306), (15.0, 36.8078), (255.0, 328.107)] {
            assert!(
                (deviations(quantile, freedom) - 3.0).abs() < 0.04,
                "{}",
                deviations(quantile, freedom)
            );
        }
    }

    #[test]
    fn a_graft_is_the_same_tree() {
        let (growth, root) = grow(2, &|i, o| Node::cell((i * 16 + o) as f64, 0.0));
        let mut other = Growth::new(Rank::Anisotropic, Merging::default());
        let again = other.graft(root, &growth.entries, &growth.errors).unwrap();
        assert_eq!((again, &other.entries), (root, &growth.entries));
        assert!(other.graft(root, &growth.entries[16..], &growth.errors).is_err());
        assert_eq!(Node::from_words(&root.to_words()), root);
    }
}
