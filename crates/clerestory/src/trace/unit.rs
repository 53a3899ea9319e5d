//! One unit of work: light from one side and one incident patch or direction, collected in patches.
//!
//! A unit is measured in rounds, a round in independent replications. A replication's paths are a lattice of its own random
//! shift; the scatter of the replications tells the standard errors. Every number follows from the unit's number, the round's and
//! the replication's, so neither threads nor interruptions change the result.

use rayon::prelude::*;

use super::balance::{Balance, add};
use super::flight::{Collector, Flight, Leaving};
use super::scene::Scene;
use super::settings::{LEAST_VALUE, Settings, Stop, within_cone};
use super::state::{State, Unit};
use crate::basis::Basis;
use crate::direction::{Disk, Scatter, Side};
use crate::error::{Error, Result};
use crate::geometry::Area;
use crate::progress::Progress;
use crate::sequence::mix;

/// Where the light of a unit comes from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Source {
    /// Evenly from a patch.
    Patch(usize),
    /// From one direction of travel.
    Direction(Disk),
}

/// What all units of a measurement have in common.
pub struct Bench<'a> {
    pub scene: &'a Scene<'a>,
    pub settings: &'a Settings,
    pub area: Area,
    /// Of incident patches.
    pub incident: &'a Basis,
    pub outgoing: &'a Basis,
}

/// Values beside the outgoing patches': the beam, all scattered light, all light.
pub const EXTRA: usize = 3;

/// Where the values of a unit lie: means, then their variances; each by scatter, band and outgoing patch, with the [`EXTRA`]
/// ones after the patches.
#[derive(Debug, Clone, Copy)]
pub struct Layout {
    pub bands: usize,
    pub patches: usize,
}

impl Layout {
    /// Values a unit.
    pub fn len(self) -> usize {
        2 * self.half()
    }

    fn half(self) -> usize {
        2 * self.bands * (self.patches + EXTRA)
    }

    fn place(self, scatter: Scatter, band: usize, patch: usize) -> usize {
        (scatter as usize * self.bands + band) * (self.patches + EXTRA) + patch
    }

    /// Mean and standard error. Patch `patches` is the beam, the next one all scattered light, the last one all light.
    pub fn get(self, unit: &Unit, scatter: Scatter, band: usize, patch: usize) -> [f64; 2] {
        let k = self.place(scatter, band, patch);
        [unit.values[k], unit.values[self.half() + k].sqrt()]
    }

    /// All light: mean and standard error.
    pub fn total(self, unit: &Unit, scatter: Scatter, band: usize) -> [f64; 2] {
        self.get(unit, scatter, band, self.patches + 2)
    }

    /// Largest relative standard error of the unit's totals. A path more or less is the least error that is taken for
    /// known, so that light which no path has found yet is looked for.
    pub fn worst(self, unit: &Unit) -> f64 {
        let least = 1.0 / unit.paths as f64;
        let mut worst = 0.0_f64;
        for scatter in Scatter::BOTH {
            for band in 0..self.bands {
                let [value, error] = self.total(unit, scatter, band);
                worst = worst.max(error.hypot(least) / value.max(LEAST_VALUE));
            }
        }
        worst
    }
}

/// Flux of one replication.
struct Histogram<'a, const N: usize> {
    basis: &'a Basis,
    detector: f64,
    keeps_beams: bool,
    /// By scatter and outgoing patch.
    flux: [Vec<[f64; N]>; 2],
    beam: [[f64; N]; 2],
}

impl<const N: usize> Collector<N> for Histogram<'_, N> {
    #[inline]
    fn collect(&mut self, path: &Leaving<'_, N>) {
        let scatter = path.scatter as usize;
        if path.beam && self.keeps_beams {
            add(&mut self.beam[scatter], path.weight);
            return;
        }
        let outgoing = if self.detector > 0.0 {
            let mut draws = path.draws;
            within_cone(path.outgoing, self.detector, [draws.next(), draws.next()])
        } else {
            path.outgoing
        };
        add(&mut self.flux[scatter][self.basis.patch_of(outgoing)], path.weight);
    }
}

/// Sums over replications, shifted by the first one's values against cancellation.
struct Moments {
    first: Vec<f64>,
    sum: Vec<f64>,
    squares: Vec<f64>,
    count: u32,
}

impl Moments {
    fn new(n: usize) -> Self {
        Self {
            first: vec![0.0; n],
            sum: vec![0.0; n],
            squares: vec![0.0; n],
            count: 0,
        }
    }

    fn add(&mut self, k: usize, value: f64) {
        if self.count == 0 {
            self.first[k] = value;
        } else {
            let d = value - self.first[k];
            self.sum[k] += d;
            self.squares[k] += d * d;
        }
    }

    /// Mean and variance of the mean.
    fn get(&self, k: usize) -> [f64; 2] {
        let n = f64::from(self.count);
        let mean = self.sum[k] / n;
        let variance = (self.squares[k] / n - mean * mean).max(0.0) / (n - 1.0);
        [self.first[k] + mean, variance]
    }
}

impl Bench<'_> {
    /// Measures all units that are not finished in the state. An interruption leaves in it what was done.
    pub fn measure<const N: usize>(
        &self,
        work: &[(Side, Source)],
        state: &mut State,
        progress: &Progress,
    ) -> Result<()> {
        let layout = self.layout();
        let mut units = state.take(work.len(), Some(layout.len()), 7 * layout.bands)?;
        let steps = self.settings.rounds();
        progress.expect(work.len() * steps);
        // Few units are too few for all threads.
        let inner = work.len() < 4 * rayon::current_num_threads();
        let outcomes: Vec<Result<()>> = units
            .par_iter_mut()
            .enumerate()
            .map(|(number, unit)| {
                let mut own = unit.take().unwrap_or_else(|| self.empty());
                let fixed = matches!(self.settings.stop, Stop::Paths(_));
                let before = if fixed {
                    own.rounds as usize
                } else {
                    usize::from(own.finished)
                };
                for _ in 0..before.min(steps) {
                    progress.step()?;
                }
                let result = self.rounds::<N>(work[number], number, inner, &mut own, progress, fixed);
                if own.finished {
                    progress.tell_error(layout.worst(&own));
                }
                if own.rounds > 0 {
                    *unit = Some(own);
                }
                result
            })
            .collect();
        state.put(units);
        outcomes.into_iter().collect()
    }

    /// Where values lie.
    pub fn layout(&self) -> Layout {
        Layout {
            bands: self.scene.bands(),
            patches: self.outgoing.len(),
        }
    }

    fn empty(&self) -> Unit {
        let layout = self.layout();
        Unit {
            values: vec![0.0; layout.len()],
            balance: vec![0.0; 7 * layout.bands],
            ..Unit::default()
        }
    }

    fn rounds<const N: usize>(
        &self,
        work: (Side, Source),
        number: usize,
        inner: bool,
        unit: &mut Unit,
        progress: &Progress,
        fixed: bool,
    ) -> Result<()> {
        let layout = self.layout();
        while let Some(paths) = self
            .settings
            .next_round(unit.paths, |aim| layout.worst(unit) / aim)
            .filter(|_| !unit.finished)
        {
            let paths = u32::try_from(paths).map_err(|_| Error::Argument("a round of too many paths".into()))?;
            self.round::<N>(work, number, paths, inner, unit, progress)?;
            if fixed {
                progress.step()?;
            }
        }
        if !unit.finished {
            unit.finished = true;
            if !fixed {
                progress.step()?;
            }
        }
        Ok(())
    }

    /// One round: all replications, taken into the unit's estimates by the number of their paths.
    fn round<const N: usize>(
        &self,
        work: (Side, Source),
        number: usize,
        paths: u32,
        inner: bool,
        unit: &mut Unit,
        progress: &Progress,
    ) -> Result<()> {
        let layout = self.layout();
        let key = mix(mix(mix(self.settings.seed) ^ number as u64) ^ u64::from(unit.rounds));
        let replications = 0..self.settings.replications;
        let mut moments = Moments::new(layout.half());
        let mut balance = Balance::<N>::default();
        if inner {
            let done: Vec<(Histogram<N>, Balance<N>)> = replications
                .into_par_iter()
                .map(|replication| {
                    let mut histogram = self.histogram();
                    let mut balance = Balance::default();
                    let key = mix(key ^ u64::from(replication));
                    self.replication(work, key, paths, &mut histogram, &mut balance, progress)?;
                    Ok((histogram, balance))
                })
                .collect::<Result<_>>()?;
            for (mut histogram, part) in done {
                self.take_in(&mut histogram, paths, &mut moments);
                balance.merge(&part);
            }
        } else {
            let mut histogram = self.histogram();
            for replication in replications {
                let mut part = Balance::default();
                let key = mix(key ^ u64::from(replication));
                self.replication(work, key, paths, &mut histogram, &mut part, progress)?;
                self.take_in(&mut histogram, paths, &mut moments);
                balance.merge(&part);
            }
        }
        let new = u64::from(paths) * u64::from(self.settings.replications);
        let weight = new as f64 / (unit.paths + new) as f64;
        for k in 0..layout.half() {
            let [mean, variance] = moments.get(k);
            let value = &mut unit.values[k];
            *value += weight * (mean - *value);
            let of_mean = &mut unit.values[layout.half() + k];
            *of_mean = (1.0 - weight).powi(2) * *of_mean + weight * weight * variance;
        }
        for (band, tallies) in unit.balance.chunks_exact_mut(7).enumerate() {
            for (tally, more) in tallies.iter_mut().zip(balance.of_band(band)) {
                *tally += more;
            }
        }
        unit.paths += new;
        unit.rounds += 1;
        Ok(())
    }

    fn histogram<const N: usize>(&self) -> Histogram<'_, N> {
        Histogram {
            basis: self.outgoing,
            detector: self.settings.cones.detector,
            keeps_beams: self.settings.keeps_beams(),
            flux: [(); 2].map(|()| vec![[0.0; N]; self.outgoing.len()]),
            beam: [[0.0; N]; 2],
        }
    }

    fn replication<const N: usize>(
        &self,
        (side, source): (Side, Source),
        key: u64,
        paths: u32,
        histogram: &mut Histogram<'_, N>,
        balance: &mut Balance<N>,
        progress: &Progress,
    ) -> Result<()> {
        let cone = self.settings.cones.source;
        let mut flight = Flight::<N>::new(self.scene, self.area, self.settings.limits);
        match source {
            Source::Patch(patch) if cone == 0.0 => {
                let incident = |u| self.incident.sample_cosine(patch, u);
                flight.run(side, key, 0..paths, incident, histogram, balance, progress)
            }
            Source::Patch(_) | Source::Direction(_) => {
                let axis = match source {
                    Source::Patch(patch) => self.incident.centre(patch),
                    Source::Direction(direction) => direction,
                };
                let incident = |u| within_cone(axis, cone, u);
                flight.run(side, key, 0..paths, incident, histogram, balance, progress)
            }
        }
    }

    /// Takes a replication into the moments and empties it.
    fn take_in<const N: usize>(&self, histogram: &mut Histogram<'_, N>, paths: u32, moments: &mut Moments) {
        let layout = self.layout();
        let share = 1.0 / f64::from(paths);
        for scatter in Scatter::BOTH {
            let flux = &mut histogram.flux[scatter as usize];
            let beam = &mut histogram.beam[scatter as usize];
            for band in 0..layout.bands {
                let first = layout.place(scatter, band, 0);
                let mut scattered = 0.0;
                for (patch, cell) in flux.iter().enumerate() {
                    scattered += cell[band];
                    moments.add(first + patch, cell[band] * share);
                }
                let extra = [beam[band], scattered, scattered + beam[band]];
                for (k, value) in extra.into_iter().enumerate() {
                    moments.add(first + layout.patches + k, value * share);
                }
            }
            flux.fill([0.0; N]);
            *beam = [0.0; N];
        }
        moments.count += 1;
    }
}
