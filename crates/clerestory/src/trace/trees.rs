//! Tensor trees measured cell by cell, without ever holding the whole grid.
//!
//! Incident cells are taken in chunks, a small square (rank 4) or ring (rank 3) of them. The counts of a chunk's outgoing
//! cells are dense; they become the lower levels of the tree at once ([`Growth`]), in which cells that differ by no more than
//! chance are one. When all chunks are there, the upper levels are grown over them.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use rayon::prelude::*;

use super::balance::{Balance, add};
use super::flight::{Collector, Flight, Leaving};
use super::goniophotometer::{Goniophotometer, Measured, Totals, estimate, hemispherical, places};
use super::growth::{Growth, Merging, Node, WORDS};
use super::sample::Sample;
use super::scene::{Scene, with_bands};
use super::settings::{LEAST_VALUE, within_cone};
use super::state::{State, Unit};
use crate::bsdf::{Band, Beam, Bsdf, Cells, Estimate, Metadata, Model, Rank, Sum, Tree};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};
use crate::geometry::Area;
use crate::progress::Progress;
use crate::sequence::mix;

/// A tree to be measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TreeTarget {
    /// Rank 4, or rank 3 for a sample that is known to scatter alike from all azimuths: then light comes from all of them.
    pub rank: Rank,
    /// 2^levels cells an axis: 6 are 4,096 directions, 7 are 16,384.
    pub levels: u32,
    /// When cells are one.
    pub merging: Merging,
}

impl TreeTarget {
    /// With the usual merging.
    pub fn new(rank: Rank, levels: u32) -> Self {
        Self {
            rank,
            levels,
            merging: Merging::default(),
        }
    }
}

/// Finest resolution.
const MOST_LEVELS: u32 = 8;
/// Numbers that a chunk holds at a time, for each thread: more make smaller chunks.
const DENSE: usize = 1 << 23;

/// How the work is cut up.
#[derive(Debug, Clone, Copy)]
struct Plan {
    rank: Rank,
    levels: u32,
    /// Level of the chunks.
    level: u32,
    bands: usize,
}

impl Plan {
    fn new(target: &TreeTarget, bands: usize) -> Self {
        let (rank, levels) = (target.rank, target.levels);
        let outgoing = 1_usize << (2 * levels);
        // Up to 4 cells an axis, if they fit; rings lie in the used half of the radius.
        let mut below = 2.min(levels - u32::from(rank == Rank::Isotropic));
        while below > 0 && (outgoing << (below * rank.incident_axes())) * bands * 2 > DENSE {
            below -= 1;
        }
        Self {
            rank,
            levels,
            level: levels - below,
            bands,
        }
    }

    /// Number of chunks.
    fn chunks(self) -> usize {
        self.incident(self.level)
    }

    /// Incident cells of a level that are used.
    fn incident(self, level: u32) -> usize {
        match self.rank {
            Rank::Anisotropic => 1 << (2 * level),
            Rank::Isotropic => 1 << level.saturating_sub(1),
        }
    }

    /// Cells of a chunk.
    fn cells(self) -> usize {
        1 << (self.rank.incident_axes() * (self.levels - self.level))
    }

    fn outgoing(self) -> usize {
        1 << (2 * self.levels)
    }

    /// Number of a cell within [`Cells::Tree`] from that in Morton order.
    fn row_major(self, morton: usize) -> usize {
        match self.rank {
            Rank::Isotropic => morton,
            Rank::Anisotropic => {
                let (x, y) = (gathered(morton), gathered(morton >> 1));
                y << self.levels | x
            }
        }
    }

    /// Values of a unit: for each cell its paths, then by scatter and band beam and all light, mean and variance of each.
    fn values(self) -> usize {
        self.cells() * self.each()
    }

    fn each(self) -> usize {
        1 + 2 * self.bands * 4
    }

    fn place(self, cell: usize, scatter: Scatter, band: usize) -> usize {
        cell * self.each() + 1 + (scatter as usize * self.bands + band) * 4
    }

    /// Largest relative standard error of a cell's totals; as that of patches.
    fn worst_of_cell(self, values: &[f64], cell: usize) -> f64 {
        let least = 1.0 / values[cell * self.each()];
        let mut worst = 0.0_f64;
        for scatter in Scatter::BOTH {
            for band in 0..self.bands {
                let k = self.place(cell, scatter, band);
                let (value, variance) = (values[k + 2], values[k + 3]);
                worst = worst.max(variance.sqrt().hypot(least) / value.max(LEAST_VALUE));
            }
        }
        worst
    }

    fn worst(self, unit: &Unit) -> f64 {
        (0..self.cells())
            .map(|cell| self.worst_of_cell(&unit.values, cell))
            .fold(0.0, f64::max)
    }
}

/// Every second bit, from the lowest.
fn gathered(morton: usize) -> usize {
    let mut x = morton & 0x5555_5555;
    x = (x | x >> 1) & 0x3333_3333;
    x = (x | x >> 2) & 0x0f0f_0f0f;
    x = (x | x >> 4) & 0x00ff_00ff;
    (x | x >> 8) & 0xffff
}

/// The opposite.
fn scattered(x: usize) -> usize {
    let mut x = x & 0xffff;
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// Counts of one incident cell.
struct Counts<const N: usize> {
    plan: Plan,
    detector: f64,
    keeps_beams: bool,
    /// By scatter and outgoing cell in Morton order: sums and sums of squares.
    cells: [Vec<[[f64; 2]; N]>; 2],
    /// Of the present replication: by scatter, beam and all light.
    totals: [[[f64; N]; 2]; 2],
}

impl<const N: usize> Collector<N> for Counts<N> {
    #[inline]
    fn collect(&mut self, path: &Leaving<'_, N>) {
        let scatter = path.scatter as usize;
        add(&mut self.totals[scatter][1], path.weight);
        if path.beam && self.keeps_beams {
            add(&mut self.totals[scatter][0], path.weight);
            return;
        }
        let mut outgoing = path.outgoing;
        if self.detector > 0.0 {
            let mut draws = path.draws;
            outgoing = within_cone(outgoing, self.detector, [draws.next(), draws.next()]);
        }
        let n = f64::from(1_u32 << self.plan.levels);
        let [x, y] = self
            .plan
            .rank
            .into_frame(path.incident, outgoing)
            .to_square()
            .map(|c| scattered((c * n) as usize));
        let cell = &mut self.cells[scatter][x | y << 1];
        for (c, w) in cell.iter_mut().zip(path.weight) {
            c[0] += w;
            c[1] += w * w;
        }
    }
}

/// What all chunks have in common.
struct Work<'a> {
    instrument: &'a Goniophotometer,
    scene: &'a Scene<'a>,
    area: Area,
    plan: Plan,
    merging: Merging,
    cells: Cells,
}

impl Goniophotometer {
    /// Tensor trees, each value with its standard error, in memory that grows with their leaves only. What the state holds is
    /// not measured again; after an interruption it holds what was finished, and in the end it is empty.
    ///
    /// Standard errors of leaves are those of independent paths: a lattice of many paths scatters less, one of few may
    /// scatter a little more in narrow cells. Those of totals are from replications.
    pub fn trees(
        &self,
        sample: &Sample,
        target: &TreeTarget,
        state: &mut State,
        progress: &Progress,
    ) -> Result<Measured> {
        self.settings.check()?;
        if !(1..=MOST_LEVELS).contains(&target.levels) {
            return Err(Error::Argument(format!(
                "a tree of 2^{} cells an axis cannot be measured (give 2^1 to 2^{MOST_LEVELS})",
                target.levels
            )));
        }
        let Merging { chance, bound } = target.merging;
        if !(chance > 0.0 && chance.is_finite() && (0.0..=1.0).contains(&bound)) {
            return Err(Error::Argument(format!(
                "cells cannot be merged by {chance} standard deviations and a share of {bound} (give more than 0, and 0 to 1)"
            )));
        }
        if self.settings.reciprocal && target.rank == Rank::Isotropic {
            return Err(Error::Unsupported(
                "an isotropic tree cannot be averaged with its reverse (measure a tree of rank 4, or leave it out)"
                    .into(),
            ));
        }
        with_bands!(sample, self.trees_of(target, state, progress))
    }

    fn trees_of<const N: usize>(
        &self,
        scene: &Scene<'_>,
        target: &TreeTarget,
        state: &mut State,
        progress: &Progress,
    ) -> Result<Measured> {
        let plan = Plan::new(target, scene.bands());
        let work = Work {
            instrument: self,
            scene,
            area: scene.sample.area()?,
            plan,
            merging: target.merging,
            cells: Cells::Tree(target.rank, target.levels),
        };
        let sides = &self.settings.sides;
        let count = sides.len() * plan.chunks();
        let mut units = state.take(count, Some(plan.values()), 7 * plan.bands)?;
        progress.expect(count * plan.cells());
        let outcomes: Vec<Result<()>> = units
            .par_iter_mut()
            .enumerate()
            .map(|(number, unit)| {
                if unit.is_none() {
                    let side = sides[number / plan.chunks()];
                    *unit = Some(work.chunk::<N>(side, number % plan.chunks(), number, progress)?);
                } else {
                    for _ in 0..plan.cells() {
                        progress.step()?;
                    }
                }
                progress.tell_error(unit.as_ref().map_or(0.0, |u| plan.worst(u)));
                Ok(())
            })
            .collect();
        if let Some(error) = outcomes.into_iter().find_map(Result::err) {
            state.put(units);
            return Err(error);
        }
        let units: Vec<Unit> = units.into_iter().flatten().collect();
        let mut jobs = Vec::new();
        for band in 0..plan.bands {
            for k in 0..sides.len() {
                jobs.extend(Scatter::BOTH.map(|scatter| (band, k, scatter)));
            }
        }
        let models: Vec<(Model, Totals)> = jobs
            .par_iter()
            .map(|&(band, k, scatter)| {
                let of_side = &units[k * plan.chunks()..(k + 1) * plan.chunks()];
                work.component(of_side, sides[k], scatter, band)
            })
            .collect::<Result<_>>()?;
        let mut bands: Vec<Band> = scene.sample.bands.iter().map(Band::new).collect();
        let mut totals = Vec::with_capacity(models.len());
        for ((band, k, scatter), (model, of_model)) in jobs.into_iter().zip(models) {
            bands[band].set(sides[k], scatter, Some(Arc::new(model)));
            totals.push(of_model);
        }
        let all: Vec<&Unit> = units.iter().collect();
        let places = places(&all, sides, plan.bands, |unit| plan.worst(unit));
        self.finished(Bsdf::new(bands, Metadata::default())?, places, totals)
    }
}

impl Work<'_> {
    /// Measures the cells of a chunk and grows their part of the tree.
    fn chunk<const N: usize>(&self, side: Side, chunk: usize, number: usize, progress: &Progress) -> Result<Unit> {
        let plan = self.plan;
        let mut unit = Unit {
            rounds: 1,
            values: vec![0.0; plan.values()],
            balance: vec![0.0; 7 * plan.bands],
            ..Unit::default()
        };
        let mut counts = Counts::<N> {
            plan,
            detector: self.instrument.settings.cones.detector,
            keeps_beams: self.instrument.settings.keeps_beams(),
            cells: [(); 2].map(|()| vec![[[0.0; 2]; N]; plan.outgoing()]),
            totals: [[[0.0; N]; 2]; 2],
        };
        // Value and standard error by scatter and band, then incident cell, then outgoing cell.
        let mut dense = vec![[0.0_f32; 2]; 2 * plan.bands * plan.cells() * plan.outgoing()];
        let mut balance = Balance::<N>::default();
        let density = plan.outgoing() as f64 / PI;
        for cell in 0..plan.cells() {
            let key = mix(mix(mix(self.instrument.settings.seed) ^ number as u64) ^ cell as u64);
            let incident = plan.row_major(chunk * plan.cells() + cell);
            self.measure(
                side,
                incident,
                key,
                cell,
                &mut unit,
                &mut counts,
                &mut balance,
                progress,
            )?;
            let n = unit.values[cell * plan.each()];
            for scatter in Scatter::BOTH {
                for (o, sums) in counts.cells[scatter as usize].iter_mut().enumerate() {
                    for (band, [sum, squares]) in sums[..plan.bands].iter().enumerate() {
                        let part = scatter as usize * plan.bands + band;
                        let variance = (squares - sum * sum / n).max(0.0);
                        dense[(part * plan.cells() + cell) * plan.outgoing() + o] =
                            [sum / n * density, variance.sqrt() / n * density].map(|v| v as f32);
                    }
                    *sums = [[0.0; 2]; N];
                }
            }
            progress.step()?;
        }
        for (band, tallies) in unit.balance.chunks_exact_mut(7).enumerate() {
            tallies.copy_from_slice(&balance.of_band(band));
        }
        for part in dense.chunks_exact(plan.cells() * plan.outgoing()) {
            let mut growth = Growth::new(plan.rank, self.merging);
            let roots: Vec<Node> = (0..1_usize << (2 * plan.level))
                .map(|o| self.node(part, &mut growth, plan.level, 0, o))
                .collect();
            unit.entries.push(growth.entries.len() as u32);
            unit.entries.extend(roots.into_iter().flat_map(Node::to_words));
            unit.entries.extend(&growth.entries);
            unit.entries.extend(growth.errors.iter().map(|e| e.to_bits()));
        }
        unit.finished = true;
        Ok(unit)
    }

    /// Rounds of replications for one incident cell. Sums of its outgoing cells stay in `counts`.
    #[allow(clippy::too_many_arguments)] // One place that is called.
    fn measure<const N: usize>(
        &self,
        side: Side,
        incident: usize,
        key: u64,
        cell: usize,
        unit: &mut Unit,
        counts: &mut Counts<N>,
        balance: &mut Balance<N>,
        progress: &Progress,
    ) -> Result<()> {
        let (plan, settings) = (self.plan, &self.instrument.settings);
        let cone = settings.cones.source;
        let mut flight = Flight::<N>::new(self.scene, self.area, settings.limits);
        let mut rounds = 0_u64;
        let at = cell * plan.each();
        let replications = f64::from(settings.replications);
        while let Some(paths) = settings.next_round(unit.values[at] as u64, |aim| {
            plan.worst_of_cell(&unit.values, cell) / aim
        }) {
            let mut moments = vec![[0.0; 2]; plan.each()];
            for replication in 0..settings.replications {
                counts.totals = [[[0.0; N]; 2]; 2];
                let key = mix(mix(key ^ rounds) ^ u64::from(replication));
                let draw = |u: [f64; 2]| {
                    let point = if cone > 0.0 {
                        within_cone(self.cells.sample(incident, [0.5; 2]), cone, u)
                    } else {
                        self.cells.sample(incident, u)
                    };
                    match plan.rank {
                        Rank::Anisotropic => point,
                        // From all azimuths.
                        Rank::Isotropic => {
                            let (sin, cos) = (TAU * u[1]).sin_cos();
                            point.turned(sin, cos)
                        }
                    }
                };
                flight.run(side, key, 0..paths as u32, draw, counts, balance, progress)?;
                for scatter in Scatter::BOTH {
                    for band in 0..plan.bands {
                        let k = plan.place(cell, scatter, band) - at;
                        for (j, total) in counts.totals[scatter as usize].iter().enumerate() {
                            let mean = total[band] / paths as f64;
                            moments[k + 2 * j][0] += mean;
                            moments[k + 2 * j][1] += mean * mean;
                        }
                    }
                }
            }
            let new = paths as f64 * replications;
            let weight = new / (unit.values[at] + new);
            for k in (1..plan.each()).step_by(2) {
                let [sum, squares] = moments[k];
                let mean = sum / replications;
                let variance = (squares / replications - mean * mean).max(0.0) / (replications - 1.0);
                let value = &mut unit.values[at + k];
                *value += weight * (mean - *value);
                let of_mean = &mut unit.values[at + k + 1];
                *of_mean = (1.0 - weight).powi(2) * *of_mean + weight * weight * variance;
            }
            unit.values[at] += new;
            unit.paths += new as u64;
            rounds += 1;
        }
        Ok(())
    }

    /// A node of a chunk: incident cells of it at `level`, outgoing ones of the whole square, both in Morton order.
    fn node(&self, dense: &[[f32; 2]], growth: &mut Growth, level: u32, incident: usize, outgoing: usize) -> Node {
        let plan = self.plan;
        if level == plan.levels {
            let [value, error] = dense[incident * plan.outgoing() + outgoing];
            return Node::cell(f64::from(value), f64::from(error));
        }
        let axes = plan.rank.incident_axes();
        let mark = growth.mark();
        let mut children = [Node::default(); 16];
        let children = &mut children[..plan.rank.children()];
        for (n, child) in children.iter_mut().enumerate() {
            let (i, o) = (incident << axes | n & ((1 << axes) - 1), outgoing << 2 | n >> axes);
            *child = self.node(dense, growth, level + 1, i, o);
        }
        growth.join(children, mark, level)
    }

    /// The levels above the chunks, over the parts of the tree that the chunks hold.
    fn upper(
        &self,
        parts: &[Part<'_>],
        growth: &mut Growth,
        level: u32,
        incident: usize,
        outgoing: usize,
    ) -> Result<Node> {
        let plan = self.plan;
        if incident >= plan.incident(level) {
            // The unused half of rank 3.
            return Ok(Node::default());
        }
        if level == plan.level {
            let part = &parts[incident];
            let node = Node::from_words(&part.roots[WORDS * outgoing..WORDS * (outgoing + 1)]);
            return growth.graft(node, part.entries, &part.errors);
        }
        let axes = plan.rank.incident_axes();
        let mark = growth.mark();
        let mut children = [Node::default(); 16];
        let children = &mut children[..plan.rank.children()];
        for (n, child) in children.iter_mut().enumerate() {
            let (i, o) = (incident << axes | n & ((1 << axes) - 1), outgoing << 2 | n >> axes);
            *child = self.upper(parts, growth, level + 1, i, o)?;
        }
        Ok(growth.join(children, mark, level))
    }

    /// Scattered light as a tree, with a beam where there is one.
    fn component(&self, units: &[Unit], side: Side, scatter: Scatter, band: usize) -> Result<(Model, Totals)> {
        let plan = self.plan;
        let number = scatter as usize * plan.bands + band;
        let parts: Vec<Part<'_>> = units
            .iter()
            .map(|unit| self.part(unit, number))
            .collect::<Result<_>>()?;
        let mut growth = Growth::new(plan.rank, self.merging);
        let root = self.upper(&parts, &mut growth, 0, 0, 0)?;
        let tree = Tree::from_entries(plan.rank, root.entry, growth.entries)?
            .with_standard_errors(root.error, growth.errors)?;
        let mut beam = vec![[0.0; 2]; self.cells.len()];
        let mut totals = vec![Estimate::from(0.0); self.cells.len()];
        for (chunk, unit) in units.iter().enumerate() {
            for cell in 0..plan.cells() {
                let at = plan.row_major(chunk * plan.cells() + cell);
                let k = plan.place(cell, scatter, band);
                beam[at] = [unit.values[k], unit.values[k + 1].sqrt()];
                totals[at] = estimate([unit.values[k + 2], unit.values[k + 3].sqrt()]);
            }
        }
        let totals = Totals {
            band: self.scene.sample.bands[band].clone(),
            side,
            scatter,
            hemispherical: Some(hemispherical(&totals, |cell| self.cells.share(cell))),
            values: totals,
        };
        let tree = Model::Tree(tree);
        if beam.iter().all(|[value, _]| *value == 0.0) {
            return Ok((tree, totals));
        }
        let beam = Beam::new(self.cells.clone(), beam.iter().map(|b| b[0]).collect())?
            .with_standard_errors(beam.iter().map(|b| b[1]).collect())?;
        let parts = [tree, Model::Beam(beam)].map(|m| (1.0, Arc::new(m)));
        Ok((Model::Sum(Sum::new(parts.to_vec())?), totals))
    }

    /// A part of a unit's trees.
    fn part<'u>(&self, unit: &'u Unit, number: usize) -> Result<Part<'u>> {
        let broken = || Error::Argument("the state that was kept is damaged (measure from the start)".into());
        let roots = WORDS << (2 * self.plan.level);
        let mut rest = unit.entries.as_slice();
        for k in 0..=number {
            let (&count, after) = rest.split_first().ok_or_else(broken)?;
            let count = count as usize;
            let (roots, after) = after.split_at_checked(roots).ok_or_else(broken)?;
            let (entries, after) = after.split_at_checked(count).ok_or_else(broken)?;
            let (errors, after) = after.split_at_checked(count).ok_or_else(broken)?;
            if k == number {
                return Ok(Part {
                    roots,
                    entries,
                    errors: errors.iter().map(|&e| f32::from_bits(e)).collect(),
                });
            }
            rest = after;
        }
        Err(broken())
    }
}

/// A chunk's part of one tree.
struct Part<'u> {
    roots: &'u [u32],
    entries: &'u [u32],
    errors: Vec<f32>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::{Part as Of, Scatterer};
    use crate::direction::Disk;
    use crate::sequence::r2;
    use crate::trace::testing::{blind, empty, fused, lambertian, sheet};
    use crate::trace::{Settings, Stop};

    fn instrument(paths: u64, sides: &[Side]) -> Goniophotometer {
        Goniophotometer {
            settings: Settings {
                sides: sides.to_vec(),
                stop: Stop::Paths(paths),
                replications: 8,
                seed: 3,
                ..Settings::default()
            },
        }
    }

    fn measure(instrument: &Goniophotometer, sample: &Sample, target: &TreeTarget) -> Measured {
        let state = &mut State::new("");
        instrument
            .trees(sample, target, state, &Progress::default())
            .expect("it runs")
    }

    fn model(measured: &Measured, side: Side, scatter: Scatter) -> Arc<Model> {
        measured
            .bsdf
            .component(None, side, scatter)
            .expect("is there")
            .component
    }

    #[test]
    fn numbers_of_cells_are_interleaved_and_back() {
        for k in 0..4096 {
            assert_eq!(scattered(gathered(k)) | scattered(gathered(k >> 1)) << 1, k);
        }
    }

    #[test]
    fn a_diffusing_sheet_is_one_leaf_or_few() {
        for (rank, levels) in [(Rank::Anisotropic, 4), (Rank::Isotropic, 5)] {
            let sample = sheet(lambertian(0.5, 0.3, 1), 1);
            let measured = measure(&instrument(512, &Side::BOTH), &sample, &TreeTarget::new(rank, levels));
            for (scatter, value) in [(Scatter::Transmission, 0.3), (Scatter::Reflection, 0.5)] {
                let model = model(&measured, Side::Exterior, scatter);
                let Model::Tree(tree) = &*model else { panic!("no beam") };
                // Of 65,536 and 16,384: a lattice of few paths, seen in narrow cells, is not quite random.
                assert!(tree.leaves() < 1000, "{rank:?}: {}", tree.leaves());
                for k in 0..50 {
                    let i = Disk::uniform(r2(k, [0.0; 2]));
                    let total = tree.total(i, Of::All);
                    assert!((total.value - value).abs() < 0.01, "{rank:?} {total:?}");
                    let error = tree.standard_error(i, i).expect("is known");
                    assert!(error > 0.0 && error < 0.05);
                }
            }
        }
    }

    #[test]
    fn trees_and_matrices_have_the_same_totals() {
        let instrument = instrument(2048, &[Side::Exterior]);
        let basis = Arc::new(Basis::klems_quarter());
        let table = instrument
            .matrices(&blind(0.6), &basis, &basis, &mut State::new(""), &Progress::default())
            .expect("it runs");
        let tree = measure(&instrument, &blind(0.6), &TreeTarget::new(Rank::Anisotropic, 4));
        for (a, b) in tree.totals.iter().zip(&table.totals) {
            let (a, b) = (a.hemispherical.expect("is known"), b.hemispherical.expect("is known"));
            let error = a
                .standard_error
                .expect("is known")
                .hypot(b.standard_error.expect("is known"));
            assert!((a.value - b.value).abs() < 4.0 * error, "{a:?} {b:?}");
        }
        for scatter in Scatter::BOTH {
            let (a, b) = (
                model(&tree, Side::Exterior, scatter),
                model(&table, Side::Exterior, scatter),
            );
            assert_eq!(
                a.kind(),
                if scatter == Scatter::Transmission {
                    "sum"
                } else {
                    "tensor tree"
                }
            );
            // The light of a patch, over many directions within it.
            for patch in 0..41 {
                let mean = |m: &Model, part| -> f64 {
                    let points = (0..200).map(|k| basis.sample_cosine(patch, r2(k, [0.0; 2])));
                    points.map(|i| m.total(i, part).value).sum::<f64>() / 200.0
                };
                for part in [Of::All, Of::Direct] {
                    let (a, b) = (mean(&a, part), mean(&b, part));
                    assert!((a - b).abs() < 0.05, "{scatter:?} {patch} {part:?}: {a} {b}");
                }
            }
        }
        let [traced, rest @ ..] = tree.balance[0];
        assert!((rest.iter().sum::<f64>() / traced - 1.0).abs() < 1e-9 && traced == 2048.0 * 256.0);
    }

    #[test]
    fn beams_stay_beams_on_the_cells() {
        for rank in [Rank::Anisotropic, Rank::Isotropic] {
            let measured = measure(&instrument(64, &[Side::Interior]), &empty(), &TreeTarget::new(rank, 3));
            let through = model(&measured, Side::Interior, Scatter::Transmission);
            for k in 0..50 {
                let i = Disk::uniform(r2(k, [0.0; 2]));
                assert!((through.total(i, Of::Direct).value - 1.0).abs() < 1e-12);
                assert_eq!(through.total(i, Of::Scattered).value, 0.0);
            }
            let Model::Tree(tree) = through.unseparated() else {
                panic!("a tree")
            };
            assert!((tree.total(Disk::new(0.2, 0.3), Of::All).value - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn threads_and_interruptions_change_nothing() {
        let instrument = instrument(256, &Side::BOTH);
        let target = TreeTarget::new(Rank::Anisotropic, 4);
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| format!("{:?}", measure(&instrument, &blind(0.6), &target)))
        };
        let whole = with(1);
        assert_eq!(whole, with(2));
        let mut state = State::new("a");
        let (sample, progress) = fused(blind(0.6), 100_000);
        let outcome = instrument.trees(&sample, &target, &mut state, &progress);
        assert_eq!(outcome.unwrap_err(), Error::Interrupted);
        let (done, all) = state.done();
        assert!(done > 0 && done < all, "{done} of {all}");
        let mut state = State::from_arrays("a", "a", &state.to_arrays()).expect("is sound");
        let progress = Progress::default();
        let again = instrument
            .trees(&blind(0.6), &target, &mut state, &progress)
            .expect("it goes on");
        assert_eq!(format!("{again:?}"), whole);
        assert_eq!((progress.fraction(), state.done()), (1.0, (0, 0)));
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let fails = |target: TreeTarget, reciprocal: bool| {
            let mut instrument = instrument(64, &Side::BOTH);
            instrument.settings.reciprocal = reciprocal;
            instrument
                .trees(&empty(), &target, &mut State::new(""), &Progress::default())
                .is_err()
        };
        assert!(fails(TreeTarget::new(Rank::Anisotropic, 0), false));
        assert!(fails(TreeTarget::new(Rank::Anisotropic, 9), false));
        assert!(fails(TreeTarget::new(Rank::Isotropic, 3), true));
        let mut target = TreeTarget::new(Rank::Anisotropic, 2);
        assert!(!fails(target, true));
        target.merging.chance = 0.0;
        assert!(fails(target, false));
    }
}
