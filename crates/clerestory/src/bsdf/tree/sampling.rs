//! Sampling of trees in as many steps as the tree is deep.
//!
//! Light from one incident position sees a *slice* of the tree: a quadtree over the outgoing square. A sample descends
//! through it and needs at each step the shares of four quadrants. They are found once for the whole tree. The mean of a
//! block over its outgoing extent is constant in the cells of a quadtree over its incident extent (a binary tree for rank
//! 3), the *profile*: the common refinement of the profiles of its children. Each of its cells becomes a [`Step`] with the
//! four quadrants' shares and the cell of their own profiles that comes next, so nothing has to be searched on the way
//! down. A dense tree has one step for twelve leaves.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use rayon::prelude::*;

use super::{BRANCH, Entry, Rank, Tree, decode};
use crate::bsdf::{Estimate, Part, Peak, Sample, Scatterer};
use crate::direction::Disk;

/// What follows for an outgoing quadrant.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Next {
    /// Nothing: it is one cell.
    Cell,
    /// A step.
    Step(usize),
    /// Four values, read from the block itself.
    Values(usize),
}

/// [`Next`] in 32 bits: the two highest say which.
#[derive(Debug, Clone, Copy)]
struct Packed(u32);

const STEP: u32 = 1 << 30;
const VALUES: u32 = 2 << 30;

impl Packed {
    const CELL: Self = Self(0);

    fn step(number: usize) -> Self {
        assert!(number < STEP as usize, "the memory of a tree ends earlier");
        Self(STEP | number as u32)
    }

    fn values(block: usize) -> Self {
        Self(VALUES | block as u32)
    }

    /// The same after so many more steps before it.
    fn after(self, steps: usize) -> Self {
        match self.get() {
            Next::Step(number) => Self::step(number + steps),
            Next::Cell | Next::Values(_) => self,
        }
    }

    fn get(self) -> Next {
        let number = (self.0 & (STEP - 1)) as usize;
        match self.0 & !(STEP - 1) {
            0 => Next::Cell,
            STEP => Next::Step(number),
            _ => Next::Values(number),
        }
    }
}

/// One step of a descent.
#[derive(Debug)]
struct Step {
    /// Of the outgoing quadrants, relative to the largest one.
    shares: [f32; 4],
    next: [Packed; 4],
}

/// What light from a cell of incident positions sees of a block.
#[derive(Debug, Clone, Copy)]
struct Slice {
    /// Mean over the block's outgoing extent.
    mean: f64,
    /// Levels below the block.
    levels: u32,
    next: Packed,
}

/// A block's slices over its incident extent.
enum Profile {
    Same(Slice),
    Split(Vec<Profile>),
}

impl Profile {
    /// The same after so many more steps before its own.
    fn after(&mut self, steps: usize) {
        match self {
            Self::Same(slice) => slice.next = slice.next.after(steps),
            Self::Split(split) => split.iter_mut().for_each(|part| part.after(steps)),
        }
    }
}

/// Level at whose blocks the work is divided: 16 or 64 parts, of which light fills at most half for rank 3.
fn task_level(rank: Rank) -> u32 {
    match rank {
        Rank::Isotropic => 2,
        Rank::Anisotropic => 1,
    }
}

/// Makes profiles and the steps that they lead to.
struct Maker<'a> {
    tree: &'a Tree,
    steps: Vec<Step>,
    /// Profiles that are known, by their block.
    known: BTreeMap<usize, Profile>,
}

/// Slices of a tree.
#[derive(Debug)]
pub(super) struct Slices {
    rank: Rank,
    steps: Vec<Step>,
    /// Tree over incident positions: with the highest bit the first entry of a node, else a slice.
    root: u32,
    nodes: Vec<u32>,
    distinct: Vec<Slice>,
}

impl Slices {
    /// Of all incident positions of a tree.
    pub(super) fn new(tree: &Tree) -> Self {
        let mut maker = Maker::with_known(tree);
        let profile = maker.profile(tree.root);
        let mut slices = Self {
            rank: tree.rank,
            steps: maker.steps,
            root: 0,
            nodes: Vec::new(),
            distinct: Vec::new(),
        };
        slices.root = slices.store(&profile);
        slices
    }
}

impl<'a> Maker<'a> {
    fn new(tree: &'a Tree) -> Self {
        Self {
            tree,
            steps: Vec::new(),
            known: BTreeMap::new(),
        }
    }

    /// With the profiles of some way down, made all at the same time and put together in their order.
    fn with_known(tree: &'a Tree) -> Self {
        let mut blocks = vec![tree.root];
        for _ in 0..task_level(tree.rank) {
            let below = blocks.iter().filter_map(|&entry| match decode(entry) {
                Entry::Block(block) => Some(tree.block(block)),
                Entry::Value(_) => None,
            });
            blocks = below.flatten().copied().collect();
        }
        blocks.retain(|entry| entry & BRANCH != 0);
        let mut parts: Vec<(Profile, Vec<Step>)> = blocks
            .par_iter()
            .map(|&entry| {
                let mut maker = Self::new(tree);
                let profile = maker.profile(entry);
                (profile, maker.steps)
            })
            .collect();
        let mut count = 0;
        let first: Vec<usize> = parts
            .iter()
            .map(|(_, steps)| {
                count += steps.len();
                count - steps.len()
            })
            .collect();
        parts.par_iter_mut().zip(first).for_each(|((profile, steps), first)| {
            profile.after(first);
            for step in steps {
                step.next = step.next.map(|next| next.after(first));
            }
        });
        let mut maker = Self::new(tree);
        maker.steps.reserve(count);
        for (&entry, (profile, steps)) in blocks.iter().zip(parts) {
            maker.steps.extend(steps);
            maker.known.insert((entry & !BRANCH) as usize, profile);
        }
        maker
    }

    fn profile(&mut self, entry: u32) -> Profile {
        let block = match decode(entry) {
            Entry::Value(value) => {
                return Profile::Same(Slice {
                    mean: f64::from(value),
                    levels: 0,
                    next: Packed::CELL,
                });
            }
            Entry::Block(block) => block,
        };
        if let Some(profile) = self.known.remove(&block) {
            return profile;
        }
        let positions = 0..1 << self.tree.rank.incident_axes();
        let split = positions.map(|position| {
            let children = self.tree.outgoing_children(block, position);
            if children.iter().all(|e| e & BRANCH == 0) {
                let values = children.map(|e| f64::from(f32::from_bits(e)));
                return Profile::Same(Slice {
                    mean: values.iter().sum::<f64>() / 4.0,
                    levels: 1,
                    next: Packed::values(block),
                });
            }
            let parts = children.map(|e| self.profile(e));
            self.join(parts.each_ref())
        });
        Profile::Split(split.collect())
    }

    /// The common refinement of the profiles of four outgoing quadrants.
    fn join(&mut self, parts: [&Profile; 4]) -> Profile {
        if let [Profile::Same(a), Profile::Same(b), Profile::Same(c), Profile::Same(d)] = parts {
            let parts = [a, b, c, d];
            let largest = parts.iter().fold(0.0, |m: f64, p| m.max(p.mean));
            let scale = if largest > 0.0 { 1.0 / largest } else { 0.0 };
            let step = Packed::step(self.steps.len());
            self.steps.push(Step {
                shares: parts.map(|p| (p.mean * scale) as f32),
                next: parts.map(|p| p.next),
            });
            return Profile::Same(Slice {
                mean: parts.iter().map(|p| p.mean).sum::<f64>() / 4.0,
                levels: 1 + parts.iter().map(|p| p.levels).max().unwrap_or(0),
                next: step,
            });
        }
        let positions = 0..1 << self.tree.rank.incident_axes();
        let split = positions.map(|position| {
            self.join(parts.map(|part| match part {
                Profile::Same(_) => part,
                Profile::Split(split) => &split[position],
            }))
        });
        Profile::Split(split.collect())
    }
}

impl Slices {
    fn store(&mut self, profile: &Profile) -> u32 {
        match profile {
            Profile::Same(slice) => {
                self.distinct.push(*slice);
                (self.distinct.len() - 1) as u32
            }
            Profile::Split(split) => {
                let first = self.nodes.len();
                self.nodes.resize(first + split.len(), 0);
                for (k, part) in split.iter().enumerate() {
                    self.nodes[first + k] = self.store(part);
                }
                BRANCH | first as u32
            }
        }
    }

    /// What the incident position of a code sees of the whole tree.
    fn at(&self, code: u64) -> &Slice {
        let (mut entry, mut level) = (self.root, 0);
        while entry & BRANCH != 0 {
            entry = self.nodes[(entry & !BRANCH) as usize + self.rank.incident_child(code, level)];
            level += 1;
        }
        &self.distinct[entry as usize]
    }
}

impl Slices {
    /// Largest difference of direct-hemispherical values to those of another tree of this rank.
    pub(super) fn worst_difference(&self, other: &Self) -> f64 {
        PI * self.worst_mean(self.root, other, other.root)
    }

    fn worst_mean(&self, entry: u32, other: &Self, theirs: u32) -> f64 {
        if (entry | theirs) & BRANCH == 0 {
            return (self.distinct[entry as usize].mean - other.distinct[theirs as usize].mean).abs();
        }
        let below = |of: &Self, entry: u32, position: usize| match entry & BRANCH {
            0 => entry,
            _ => of.nodes[(entry & !BRANCH) as usize + position],
        };
        let positions = match self.rank {
            // The upper half of the radius at the root is unused.
            Rank::Isotropic if entry == self.root && theirs == other.root => 0..1,
            _ => 0..1 << self.rank.incident_axes(),
        };
        positions
            .map(|position| self.worst_mean(below(self, entry, position), other, below(other, theirs, position)))
            .fold(0.0, f64::max)
    }
}

impl Tree {
    /// Entries of a block's four outgoing quadrants for one of its incident positions.
    fn outgoing_children(&self, block: usize, position: usize) -> [u32; 4] {
        let block = self.block(block);
        std::array::from_fn(|o| block[position | o << self.rank.incident_axes()])
    }

    fn slice(&self, incident: Disk) -> &Slice {
        self.slices().at(self.rank.incident_code(incident))
    }
}

/// Chooses one of two halves by their shares and stretches the rest of the number over it.
fn choose(u: &mut f64, first: f64, second: f64) -> usize {
    let target = *u * (first + second);
    let is_first = target < first || second <= 0.0;
    let (part, whole) = if is_first {
        (target, first)
    } else {
        (target - first, second)
    };
    *u = (part / whole).clamp(0.0, 1.0 - f64::EPSILON);
    usize::from(!is_first)
}

impl Scatterer for Tree {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        f64::from(self.value_at(self.rank.code(incident, outgoing)))
    }

    fn peaks(&self, _: Disk) -> Vec<Peak> {
        Vec::new()
    }

    /// Samples by hierarchical warping (Clarberg, Jarosz, Akenine-Möller, Jensen 2005), so that well spread numbers give
    /// well spread directions.
    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        // Rounding must not move a point at a cell's edge into the neighbour.
        const MARGIN: f64 = 1e-9;
        let code = self.rank.incident_code(incident);
        let slices = self.slices();
        let slice = slices.at(code);
        if slice.mean <= 0.0 {
            return None;
        }
        let [mut ux, mut uy] = u;
        let (mut x, mut y, mut level) = (0_u32, 0_u32, 0);
        let mut next = slice.next;
        loop {
            let (shares, step) = match next.get() {
                Next::Cell => break,
                Next::Step(step) => {
                    let step = &slices.steps[step];
                    (step.shares.map(f64::from), Some(step))
                }
                Next::Values(block) => {
                    let position = self.rank.incident_child(code, level);
                    let values = self.outgoing_children(block, position);
                    (values.map(|e| f64::from(f32::from_bits(e))), None)
                }
            };
            let row = choose(&mut uy, shares[0] + shares[1], shares[2] + shares[3]);
            let column = choose(&mut ux, shares[2 * row], shares[2 * row + 1]);
            x = x << 1 | column as u32;
            y = y << 1 | row as u32;
            level += 1;
            next = step.map_or(Packed::CELL, |step| step.next[column | row << 1]);
        }
        let edge = 0.5_f64.powi(level as i32);
        let place = |cell: u32, u: f64| (f64::from(cell) + u.clamp(MARGIN, 1.0 - MARGIN)) * edge;
        let outgoing = Disk::from_square([place(x, ux), place(y, uy)]);
        Some(Sample {
            outgoing: self.rank.out_of_frame(incident, outgoing),
            weight: PI * slice.mean,
            peak: false,
        })
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        let code = self.rank.incident_code(incident);
        let total = PI * self.slices().at(code).mean;
        if total <= 0.0 {
            return 0.0;
        }
        let code = code | self.rank.outgoing_code(self.rank.into_frame(incident, outgoing));
        f64::from(self.value_at(code)) * outgoing.cos_theta() / total
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        if part == Part::Direct {
            return 0.0.into();
        }
        Estimate {
            value: PI * self.slice(incident).mean,
            standard_error: self.standard_error_of_total(incident),
        }
    }

    fn resolution(&self, incident: Disk) -> f64 {
        2.0 * 0.5_f64.powi(self.slice(incident).levels as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::tree::testing::{Stream, random};
    use crate::sequence::r2;

    const RANKS: [Rank; 2] = [Rank::Isotropic, Rank::Anisotropic];
    /// Cells an axis on which all of the trees here are constant.
    const FINE: usize = 32;

    /// Middles of the finest outgoing cells, in the sample's frame.
    fn outgoing_cells(rank: Rank, incident: Disk) -> impl Iterator<Item = Disk> {
        (0..FINE * FINE).map(move |k| {
            let square = [k % FINE, k / FINE].map(|c| (c as f64 + 0.5) / FINE as f64);
            rank.out_of_frame(incident, Disk::from_square(square))
        })
    }

    fn values(tree: &Tree, incident: Disk) -> Vec<f64> {
        outgoing_cells(tree.rank, incident)
            .map(|o| tree.evaluate(incident, o))
            .collect()
    }

    #[test]
    fn totals_are_sums_over_all_cells() {
        for rank in RANKS {
            for seed in 0..4 {
                let tree = random(rank, 5, seed);
                let mut stream = Stream::new(100 + seed);
                for _ in 0..20 {
                    let incident = stream.disk();
                    let values = values(&tree, incident);
                    let exact = PI * values.iter().sum::<f64>() / values.len() as f64;
                    let total = tree.total(incident, Part::All).value;
                    assert!((total - exact).abs() <= 1e-12 * exact, "{total} {exact}");
                    assert_eq!(tree.total(incident, Part::Scattered).value, total);
                    assert_eq!(tree.total(incident, Part::Direct).value, 0.0);
                }
            }
        }
    }

    #[test]
    fn tables_do_not_depend_on_the_number_of_threads() {
        for rank in RANKS {
            let tree = random(rank, 5, 6);
            let build = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
                pool.install(|| format!("{:?}", Slices::new(&tree)))
            };
            assert_eq!(build(1), build(3));
        }
    }

    #[test]
    fn a_tree_of_one_value_is_sampled_with_the_cosine() {
        for rank in RANKS {
            let tree = Tree::constant(rank, 0.25).unwrap();
            let sample = tree.sample(Disk::NORMAL, [0.3, 0.8]).unwrap();
            let expected = Disk::from_square([0.3, 0.8]);
            assert!((sample.outgoing.x - expected.x).abs() < 1e-12 && (sample.outgoing.y - expected.y).abs() < 1e-12);
            assert_eq!(sample.weight, PI * 0.25);
            assert!((tree.pdf(Disk::NORMAL, expected) - expected.cos_theta() / PI).abs() < 1e-15);
            assert_eq!(tree.resolution(Disk::NORMAL), 2.0);
            assert!(
                Tree::constant(rank, 0.0)
                    .unwrap()
                    .sample(Disk::NORMAL, [0.3, 0.8])
                    .is_none()
            );
        }
    }

    /// z of the chi-squared statistic of draws over bins of `bins` cells an axis, shifted by `shift` of a bin: 0 aligns
    /// them with the tree's cells, any other value lets them lie across. `wrong` falsifies the densest cell by a factor.
    fn chi_squared(tree: &Tree, incident: Disk, bins: usize, shift: f64, wrong: f64) -> f64 {
        const DRAWS: u32 = 1_000_000;
        // Sub-cells that belong wholly to one bin and one cell of the tree if the shift is a quarter.
        let fine = 4 * FINE;
        let bin = |square: [f64; 2]| {
            let [a, b] = square.map(|c| (((c * bins as f64 + shift) as usize) % bins).min(bins - 1));
            b * bins + a
        };
        let mut expected = vec![0.0; bins * bins];
        let mut total = 0.0;
        for k in 0..fine * fine {
            let square = [k % fine, k / fine].map(|c| (c as f64 + 0.5) / fine as f64);
            let outgoing = Disk::from_square(square);
            let density = tree.pdf(incident, tree.rank.out_of_frame(incident, outgoing)) / outgoing.cos_theta();
            expected[bin(square)] += density;
            total += density;
        }
        assert!((total * PI / (fine * fine) as f64 - 1.0).abs() < 1e-9);
        let densest = (0..expected.len())
            .max_by(|&a, &b| expected[a].total_cmp(&expected[b]))
            .unwrap();
        expected[densest] *= wrong;
        let mut counts = vec![0.0; bins * bins];
        for k in 0..DRAWS {
            let u = [
                crate::sequence::uniform(1, k.into()),
                crate::sequence::uniform(2, k.into()),
            ];
            let outgoing = tree.sample(incident, u).unwrap().outgoing;
            counts[bin(tree.rank.into_frame(incident, outgoing).to_square())] += 1.0;
        }
        // Bins of fewer than 5 expected draws are pooled.
        let (mut sum, mut degrees, mut pooled) = (0.0, -1.0, [0.0, 0.0]);
        for (count, share) in counts.iter().zip(&expected) {
            let expected = share / total * f64::from(DRAWS);
            if expected < 5.0 {
                assert!(expected > 0.0 || *count == 0.0);
                pooled = [pooled[0] + count, pooled[1] + expected];
            } else {
                sum += (count - expected).powi(2) / expected;
                degrees += 1.0;
            }
        }
        if pooled[1] >= 5.0 {
            sum += (pooled[0] - pooled[1]).powi(2) / pooled[1];
            degrees += 1.0;
        }
        // Wilson and Hilferty (1931): the cube root of chi-squared is nearly normal.
        let spread: f64 = 2.0 / (9.0 * degrees);
        ((sum / degrees).cbrt() - (1.0 - spread)) / spread.sqrt()
    }

    #[test]
    fn samples_are_distributed_as_the_density_says() {
        for rank in RANKS {
            let tree = random(rank, 5, 7);
            let mut stream = Stream::new(9);
            for _ in 0..2 {
                let incident = stream.disk();
                // 8 tests: 3.2 is a level of 0.5 % for all of them together.
                for (bins, shift) in [(FINE, 0.0), (8, 0.25)] {
                    let z = chi_squared(&tree, incident, bins, shift, 1.0);
                    assert!(z.abs() < 3.2, "{rank:?} {bins} {z}");
                }
            }
        }
    }

    #[test]
    fn the_test_of_distributions_sees_a_wrong_cell() {
        let tree = random(Rank::Anisotropic, 3, 7);
        let incident = Stream::new(9).disk();
        for factor in [0.95, 1.05] {
            assert!(chi_squared(&tree, incident, 8, 0.0, factor) > 4.0);
        }
    }

    #[test]
    fn well_spread_numbers_give_well_spread_samples() {
        // Flux into the quarters of the square from few samples: the error is far below that of random ones.
        let tree = random(Rank::Anisotropic, 4, 3);
        let incident = Disk::from_angles(0.5, 0.3);
        let values = values(&tree, incident);
        let flux: f64 = values.iter().sum();
        let n = 4096;
        let mut counts = [0.0; 4];
        for k in 0..n {
            let square = tree.sample(incident, r2(k, [0.0; 2])).unwrap().outgoing.to_square();
            counts[usize::from(square[0] >= 0.5) | usize::from(square[1] >= 0.5) << 1] += 1.0 / f64::from(n);
        }
        for (quarter, count) in counts.iter().enumerate() {
            let inside =
                |k: usize| (k % FINE >= FINE / 2, k / FINE >= FINE / 2) == (quarter & 1 == 1, quarter >> 1 == 1);
            let exact: f64 = (0..values.len()).filter(|&k| inside(k)).map(|k| values[k]).sum::<f64>() / flux;
            assert!((count - exact).abs() < 2e-3, "{count} {exact}");
        }
    }

    #[test]
    fn weights_are_totals_and_samples_stay_in_their_cells() {
        for rank in RANKS {
            let tree = random(rank, 5, 21);
            let mut stream = Stream::new(22);
            for k in 0..20_000 {
                let incident = stream.disk();
                // Extremes of the unit square too.
                let edge = |u: f64| match k % 3 {
                    0 => 0.0,
                    1 => 1.0 - f64::EPSILON / 2.0,
                    _ => u,
                };
                let u = [edge(stream.next()), edge(stream.next())];
                let total = tree.total(incident, Part::All).value;
                match tree.sample(incident, u) {
                    Some(sample) => {
                        assert_eq!(sample.weight, total);
                        let density = tree.pdf(incident, sample.outgoing);
                        let weight = tree.evaluate(incident, sample.outgoing) * sample.outgoing.cos_theta() / density;
                        assert!(density > 0.0 && (weight - total).abs() < 1e-9 * total);
                    }
                    None => assert_eq!(total, 0.0),
                }
            }
        }
    }

    #[test]
    fn resolution_is_the_finest_cell_of_the_slice() {
        // The lower half of axis 0 is one value, the upper one has a fine corner.
        let text = "{{1}{{1}{1}{1}{1}{1}{1}{1}{1 2 3 4 5 6 7 8}}{1}{1}{1}{1}{1}{1}}";
        let (tree, _) = crate::bsdf::tree::parse(Rank::Isotropic, text.as_bytes()).unwrap();
        let at = |x0: f64| tree.resolution(Disk::new(1.0 - 2.0 * x0, 0.0));
        assert_eq!(at(0.2), 1.0);
        let text = "{{{1}{1}{1}{1}{1}{1}{1}{1 2 3 4 5 6 7 8}}{1}{1}{1}{1}{1}{1}{1}}";
        let (tree, _) = crate::bsdf::tree::parse(Rank::Isotropic, text.as_bytes()).unwrap();
        let at = |x0: f64| tree.resolution(Disk::new(1.0 - 2.0 * x0, 0.0));
        assert_eq!(at(0.1), 0.5);
        assert_eq!(at(0.3), 0.25);
    }

    #[test]
    fn values_that_vanish_beside_others_are_still_sampled() {
        let mut entries = vec![0; 8];
        entries[0] = 1e-45_f32.to_bits();
        let tree = Tree::from_entries(Rank::Isotropic, BRANCH, entries.clone()).unwrap();
        let incident = Disk::new(0.9, 0.0);
        assert!(tree.total(incident, Part::All).value > 0.0);
        assert!(tree.sample(incident, [0.9, 0.9]).is_some());
        entries[4] = f32::MAX.to_bits();
        let tree = Tree::from_entries(Rank::Isotropic, BRANCH, entries).unwrap();
        assert!(tree.total(incident, Part::All).value.is_finite());
        let sample = tree.sample(incident, [0.5, 0.5]).unwrap();
        assert!(tree.pdf(incident, sample.outgoing) > 0.0);
    }
}
