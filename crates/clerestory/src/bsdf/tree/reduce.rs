//! Reduction ("culling"): parts that hardly differ become one value.
//!
//! Two ways: a share of the finest blocks, as Radiance's converters do it, or a bound on the error that is caused.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use super::assembler::Assembler;
use super::{BRANCH, Entry, Rank, Tree, decode, encode};
use crate::error::{Error, Result};

/// A reduced tree and the error that the reduction caused.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduction {
    /// The result.
    pub tree: Tree,
    /// Root of the mean squared difference of the BSDF, over all incident and outgoing directions weighted by projected
    /// solid angle, divided by the mean of the original.
    pub rms_error: f64,
    /// Largest difference of direct-hemispherical values, over all incident directions.
    pub worst_direct_hemispherical: f64,
    /// Number of values before.
    pub leaves_before: usize,
    /// Number of values after.
    pub leaves_after: usize,
}

impl Tree {
    /// Merges about `percent` of the finest blocks, those of the smallest contrast, and all that is smooth above them.
    ///
    /// The measure of a block is √((max − min) / (√mean + 0.03)); the threshold is read from a histogram of all blocks of
    /// the finest level, as Radiance's `rttree_reduce` does it. At 0 % only equal values are merged.
    pub fn reduced_by_percent(&self, percent: f64) -> Result<Reduction> {
        if !(0.0..=100.0).contains(&percent) {
            return Err(Error::Argument(format!("{percent} is not a percentage from 0 to 100")));
        }
        let mut statistics = vec![Block::default(); self.entries.len() / self.rank.children()];
        let mut histogram = Histogram::default();
        if self.depth > 0 {
            self.measure(self.root, 0, &mut statistics, &mut histogram);
        }
        let threshold = histogram.threshold(percent);
        let mut assembler = Assembler::new(self.rank);
        let root = self.culled(self.root, threshold, &statistics, &mut assembler)?;
        Ok(self.reduction(assembler.finish(root)?))
    }

    /// Merges blocks of the smallest differences, as many as the error allows.
    ///
    /// `bound` is on the root of the mean squared difference of the BSDF, over all incident and outgoing directions
    /// weighted by projected solid angle, divided by the mean BSDF: what [`Reduction::rms_error`] reports. A merged part
    /// keeps its mean, so hemispherical-hemispherical values stay.
    pub fn reduced_by_error(&self, bound: f64) -> Result<Reduction> {
        if !(bound.is_finite() && bound >= 0.0) {
            return Err(Error::Argument(format!(
                "{bound} is not a bound on an error (give 0 or more; 0.05 is 5 % of the mean)"
            )));
        }
        let mut merger = Merger::new(self);
        merger.run((bound * merger.mean).powi(2));
        let mut assembler = Assembler::new(self.rank);
        let root = merger.merged(self.root, &mut assembler)?;
        Ok(self.reduction(assembler.finish(root)?))
    }

    fn reduction(&self, tree: Self) -> Reduction {
        let difference = Difference::between(self, &tree);
        Reduction {
            rms_error: difference.rms_over_mean(),
            worst_direct_hemispherical: self.slices().worst_difference(tree.slices()),
            leaves_before: self.leaves(),
            leaves_after: tree.leaves(),
            tree,
        }
    }

    /// Statistics of an entry; puts those of all blocks below it into their places and the finest ones into the histogram.
    fn measure(&self, entry: u32, level: u32, statistics: &mut [Block], histogram: &mut Histogram) -> Block {
        let finest = self.depth - 1;
        let result = match decode(entry) {
            Entry::Value(value) => Block {
                least: value,
                largest: value,
                mean: f64::from(value),
            },
            Entry::Block(block) => {
                let mut all = Block {
                    least: f32::INFINITY,
                    largest: 0.0,
                    mean: 0.0,
                };
                for &child in self.block(block) {
                    let child = self.measure(child, level + 1, statistics, histogram);
                    all.least = all.least.min(child.least);
                    all.largest = all.largest.max(child.largest);
                    all.mean += child.mean;
                }
                all.mean /= self.rank.children() as f64;
                statistics[block] = all;
                all
            }
        };
        if level == finest {
            histogram.add(result.contrast(), 1.0);
        } else if level < finest && entry & BRANCH == 0 {
            // Stands for many finest blocks of no contrast.
            histogram.add(0.0, 2_f64.powi((self.rank.axes() * (finest - level)) as i32));
        }
        result
    }

    fn culled(&self, entry: u32, threshold: f64, statistics: &[Block], assembler: &mut Assembler) -> Result<u32> {
        let Entry::Block(block) = decode(entry) else {
            return Ok(entry);
        };
        if statistics[block].contrast() <= threshold {
            return encode(statistics[block].mean as f32);
        }
        let mut children = [0; 16];
        let children = &mut children[..self.rank.children()];
        for (child, &below) in children.iter_mut().zip(self.block(block)) {
            *child = self.culled(below, threshold, statistics, assembler)?;
        }
        Ok(assembler.join(children))
    }
}

/// Extremes and mean of a block.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    least: f32,
    largest: f32,
    mean: f64,
}

impl Block {
    fn contrast(self) -> f64 {
        (f64::from(self.largest - self.least) / (self.mean.sqrt() + 0.03)).sqrt()
    }
}

/// Contrasts of the finest blocks.
struct Histogram {
    counts: [f64; Self::BINS],
}

impl Default for Histogram {
    fn default() -> Self {
        Self {
            counts: [0.0; Self::BINS],
        }
    }
}

impl Histogram {
    const BINS: usize = 300;
    /// Contrasts above this are in the last bin.
    const LARGEST: f64 = 4.0;

    fn add(&mut self, contrast: f64, count: f64) {
        let bin = (contrast * (Self::BINS as f64 / Self::LARGEST)) as usize;
        self.counts[bin.min(Self::BINS - 1)] += count;
    }

    /// Upper edge of the bin in which the share is reached.
    fn threshold(&self, percent: f64) -> f64 {
        let mut left = (percent / 100.0 * self.counts.iter().sum::<f64>()).floor();
        if left <= 0.0 {
            return 0.0;
        }
        let mut bins = 0;
        for count in self.counts {
            bins += 1;
            left -= count;
            if left <= 0.0 {
                break;
            }
        }
        Self::LARGEST * f64::from(bins) / Self::BINS as f64
    }
}

/// Share of all incident directions (of the disk's area) in a part of axis 0 and of the cell's other axes.
#[derive(Debug, Clone, Copy)]
struct Extent {
    rank: Rank,
    /// Axis 0 for rank 3.
    start: f64,
    edge: f64,
    level: u32,
}

impl Extent {
    fn whole(rank: Rank) -> Self {
        Self {
            rank,
            start: 0.0,
            edge: 1.0,
            level: 0,
        }
    }

    fn child(self, child: usize) -> Self {
        let edge = 0.5 * self.edge;
        Self {
            start: self.start + edge * (child & 1) as f64,
            edge,
            level: self.level + 1,
            ..self
        }
    }

    /// Share of all pairs of directions, by projected solid angle on both sides.
    fn weight(self) -> f64 {
        match self.rank {
            Rank::Anisotropic => 0.0625_f64.powi(self.level as i32),
            Rank::Isotropic => {
                let [outer, inner] = [self.start, self.start + self.edge].map(|x| (1.0 - 2.0 * x).clamp(0.0, 1.0));
                (outer * outer - inner * inner) * 0.25_f64.powi(self.level as i32)
            }
        }
    }
}

/// Weighted sums over a pair of trees.
struct Difference {
    mean: f64,
    squared: f64,
}

impl Difference {
    fn between(a: &Tree, b: &Tree) -> Self {
        let mut sums = Self {
            mean: 0.0,
            squared: 0.0,
        };
        sums.add([a, b], [a.root, b.root], Extent::whole(a.rank));
        sums
    }

    fn add(&mut self, trees: [&Tree; 2], entries: [u32; 2], extent: Extent) {
        if let [Entry::Value(a), Entry::Value(b)] = entries.map(decode) {
            let (a, weight) = (f64::from(a), extent.weight());
            self.mean += weight * a;
            self.squared += weight * (a - f64::from(b)).powi(2);
            return;
        }
        for child in 0..extent.rank.children() {
            let below = [0, 1].map(|k| match decode(entries[k]) {
                Entry::Value(_) => entries[k],
                Entry::Block(block) => trees[k].block(block)[child],
            });
            self.add(trees, below, extent.child(child));
        }
    }

    fn rms_over_mean(&self) -> f64 {
        if self.squared <= 0.0 {
            return 0.0;
        }
        self.squared.sqrt() / self.mean
    }
}

/// Blocks merged one after the other, that of the least error first.
///
/// Merging a block whose children are values adds Σ w (child − mean)² to the squared error, whatever was merged before
/// below it, because each value is the mean of what it stands for.
struct Merger<'a> {
    tree: &'a Tree,
    /// Mean BSDF.
    mean: f64,
    blocks: Vec<Mergeable>,
    /// Error (bits of a float that is not negative sort as it does) and block.
    queue: BinaryHeap<Reverse<(u64, usize)>>,
}

#[derive(Debug, Clone, Copy, Default)]
struct Mergeable {
    /// Mean over its directions.
    mean: f64,
    /// Squared error that merging it adds, as a share of all directions.
    cost: f64,
    /// Itself, if it is the root.
    parent: usize,
    /// Children that are blocks still.
    open: u8,
    merged: bool,
}

impl<'a> Merger<'a> {
    fn new(tree: &'a Tree) -> Self {
        let mut merger = Self {
            tree,
            mean: 0.0,
            blocks: vec![Mergeable::default(); tree.entries.len() / tree.rank.children()],
            queue: BinaryHeap::new(),
        };
        merger.mean = merger.visit(tree.root, None, Extent::whole(tree.rank));
        for (block, of) in merger.blocks.iter().enumerate() {
            if of.open == 0 {
                merger.queue.push(Reverse((of.cost.to_bits(), block)));
            }
        }
        merger
    }

    /// Mean of an entry.
    fn visit(&mut self, entry: u32, parent: Option<usize>, extent: Extent) -> f64 {
        let block = match decode(entry) {
            Entry::Value(value) => return f64::from(value),
            Entry::Block(block) => block,
        };
        let size = self.tree.rank.children();
        let (mut means, mut weights) = ([0.0; 16], [0.0; 16]);
        let mut open = 0;
        for child in 0..size {
            let below = self.tree.block(block)[child];
            let extent = extent.child(child);
            open += u8::from(below & BRANCH != 0);
            weights[child] = extent.weight();
            means[child] = self.visit(below, Some(block), extent);
        }
        let weight: f64 = weights.iter().sum();
        // The unused half of rank 3 has no weight.
        let mean = if weight > 0.0 {
            means.iter().zip(weights).map(|(m, w)| m * w).sum::<f64>() / weight
        } else {
            means.iter().sum::<f64>() / size as f64
        };
        let cost = means.iter().zip(weights).map(|(m, w)| w * (m - mean).powi(2)).sum();
        self.blocks[block] = Mergeable {
            mean,
            cost,
            parent: parent.unwrap_or(block),
            open,
            merged: false,
        };
        mean
    }

    /// Merges as long as the sum of squared errors stays within `limit`.
    fn run(&mut self, limit: f64) {
        let mut error = 0.0;
        while let Some(Reverse((cost, block))) = self.queue.pop() {
            error += f64::from_bits(cost);
            if error > limit {
                break;
            }
            self.blocks[block].merged = true;
            let parent = self.blocks[block].parent;
            if parent != block {
                self.blocks[parent].open -= 1;
                if self.blocks[parent].open == 0 {
                    self.queue.push(Reverse((self.blocks[parent].cost.to_bits(), parent)));
                }
            }
        }
    }

    fn merged(&self, entry: u32, assembler: &mut Assembler) -> Result<u32> {
        let Entry::Block(block) = decode(entry) else {
            return Ok(entry);
        };
        if self.blocks[block].merged {
            return encode(self.blocks[block].mean as f32);
        }
        let mut children = [0; 16];
        let children = &mut children[..self.tree.rank.children()];
        for (child, &below) in children.iter_mut().zip(self.tree.block(block)) {
            *child = self.merged(below, assembler)?;
        }
        Ok(assembler.join(children))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::tree::parse;
    use crate::bsdf::tree::testing::random;
    use crate::bsdf::{Part, Scatterer};
    use crate::direction::Disk;

    const RANKS: [Rank; 2] = [Rank::Isotropic, Rank::Anisotropic];

    fn running_index(rank: Rank, count: usize) -> Tree {
        let values: Vec<f32> = (0..count).map(|k| k as f32).collect();
        Tree::from_grid(rank, 2, &values).unwrap()
    }

    #[test]
    fn published_examples() {
        let tree = running_index(Rank::Isotropic, 32);
        assert_eq!(tree.reduced_by_percent(0.0).unwrap().tree, tree);
        let text = "{{0 1 4 5 16 17 20 21}{0}{18.5}{0}{12.5}{0}{20.5}{0}}";
        let reduction = tree.reduced_by_percent(99.0).unwrap();
        assert_eq!(reduction.tree, parse(Rank::Isotropic, text.as_bytes()).unwrap().0);
        assert_eq!((reduction.leaves_before, reduction.leaves_after), (36, 15));
        let tree = running_index(Rank::Anisotropic, 256);
        assert_eq!(tree.reduced_by_percent(0.0).unwrap().tree, tree);
    }

    /// Differences of trees of 16 cells an axis, from look-ups in all cells.
    fn difference_of_cells(a: &Tree, b: &Tree) -> (f64, f64) {
        const CELLS: usize = 16;
        let middle = |k: usize| (k as f64 + 0.5) / CELLS as f64;
        let square = |k: usize| Disk::from_square([middle(k % CELLS), middle(k / CELLS)]);
        // Incident points and their shares.
        let incident: Vec<(Disk, f64)> = match a.rank {
            Rank::Anisotropic => (0..CELLS * CELLS)
                .map(|k| (square(k), 1.0 / (CELLS * CELLS) as f64))
                .collect(),
            Rank::Isotropic => (0..CELLS / 2)
                .map(|k| {
                    let [outer, inner] = [k, k + 1].map(|k| 1.0 - 2.0 * k as f64 / CELLS as f64);
                    (Disk::new(1.0 - 2.0 * middle(k), 0.0), outer * outer - inner * inner)
                })
                .collect(),
        };
        let (mut mean, mut squared, mut worst) = (0.0, 0.0, 0.0_f64);
        for (i, share) in incident {
            for k in 0..CELLS * CELLS {
                let weight = share / (CELLS * CELLS) as f64;
                let [a, b] = [a, b].map(|tree| tree.evaluate(i, square(k)));
                mean += weight * a;
                squared += weight * (a - b).powi(2);
            }
            let [a, b] = [a, b].map(|tree| tree.total(i, Part::All).value);
            worst = worst.max((a - b).abs());
        }
        (squared.sqrt() / mean, worst)
    }

    #[test]
    fn the_error_is_measured_as_it_is() {
        for rank in RANKS {
            let tree = random(rank, 4, 11);
            for reduction in [
                tree.reduced_by_percent(95.0).unwrap(),
                tree.reduced_by_error(0.3).unwrap(),
            ] {
                assert!(reduction.leaves_after < reduction.leaves_before);
                assert_eq!(reduction.tree.leaves(), reduction.leaves_after);
                let (rms, worst) = difference_of_cells(&tree, &reduction.tree);
                let reported = (reduction.rms_error, reduction.worst_direct_hemispherical);
                assert!(
                    rms > 0.0 && (reported.0 - rms).abs() < 1e-9 * rms,
                    "{rank:?} {reported:?} {rms}"
                );
                assert!((reported.1 - worst).abs() < 1e-12, "{rank:?} {reported:?} {worst}");
            }
        }
    }

    #[test]
    fn an_error_bound_is_kept_and_used() {
        for rank in RANKS {
            let tree = random(rank, 4, 12);
            let mut leaves = usize::MAX;
            for bound in [0.0, 0.02, 0.1, 0.5, 2.0] {
                let reduction = tree.reduced_by_error(bound).unwrap();
                assert!(
                    reduction.rms_error <= bound * (1.0 + 1e-6),
                    "{} {bound}",
                    reduction.rms_error
                );
                assert!(reduction.leaves_after <= leaves);
                leaves = reduction.leaves_after;
            }
            let all = tree.reduced_by_error(100.0).unwrap();
            assert_eq!(all.leaves_after, 1);
            // Hemispherical-hemispherical values are kept.
            let mean = |t: &Tree| Difference::between(t, t).mean;
            assert!((mean(&all.tree) - mean(&tree)).abs() < 1e-6 * mean(&tree));
        }
    }

    #[test]
    fn a_bound_of_zero_merges_only_what_is_equal() {
        let text = "{{1 1 1 1 1 1 1 1}{0}{1}{0}{1}{0}{1 1 1 1 1 1 1 1}{0}}";
        let (tree, _) = parse(Rank::Isotropic, text.as_bytes()).unwrap();
        let reduction = tree.reduced_by_error(0.0).unwrap();
        assert_eq!((reduction.rms_error, reduction.worst_direct_hemispherical), (0.0, 0.0));
        // The unused half does not count.
        assert_eq!(reduction.tree, Tree::constant(Rank::Isotropic, 1.0).unwrap());
    }

    #[test]
    fn one_value_and_nonsense() {
        let tree = Tree::constant(Rank::Anisotropic, 0.5).unwrap();
        assert_eq!(tree.reduced_by_percent(90.0).unwrap().tree, tree);
        assert_eq!(tree.reduced_by_error(0.1).unwrap().tree, tree);
        let black = Tree::constant(Rank::Anisotropic, 0.0).unwrap();
        assert_eq!(black.reduced_by_error(0.1).unwrap().rms_error, 0.0);
        for percent in [-1.0, 101.0, f64::NAN] {
            assert!(tree.reduced_by_percent(percent).is_err());
        }
        for bound in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(tree.reduced_by_error(bound).is_err());
        }
    }
}
