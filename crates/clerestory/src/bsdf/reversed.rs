//! The other side's transmission, or the same reflection, by reciprocity: f(vᵢ, vₒ) = f(vₒ, vᵢ).
//!
//! Matrices with reversible bases and 4D trees become such tables exactly (see [`Model::reciprocal`]). This view serves
//! the rest, such as isotropic trees, point by point; it samples cosine-weighted directions, which is right but noisy
//! where the model is peaked.

use std::f64::consts::PI;
use std::sync::Arc;

use super::separated::{Cell, Tabular, tabular};
use super::{Estimate, Model, Part, Peak, Sample, Scatterer};
use crate::direction::Disk;
use crate::sequence::r2;

/// Another model, its paths travelled backwards.
#[derive(Debug, Clone)]
pub struct Reversed {
    base: Arc<Model>,
}

/// Points on which totals are integrated.
const POINTS: u32 = 1 << 15;
/// Points for a rough total.
const ROUGH: u32 = 64;
/// Least rough total, so that light which the rough points miss is sampled all the same.
const LEAST: f64 = 0.001;

impl Reversed {
    /// `base` backwards. `base` is a table: it has no peaks.
    pub fn new(base: Arc<Model>) -> Self {
        Self { base }
    }

    /// Total by low-discrepancy points.
    fn sum(&self, incident: Disk, points: u32) -> f64 {
        let value: f64 = (0..points)
            .map(|k| self.evaluate(incident, Disk::uniform(r2(k, [0.0; 2]))))
            .sum();
        value * PI / f64::from(points)
    }

    /// The model whose paths are reversed.
    pub fn base(&self) -> &Arc<Model> {
        &self.base
    }
}

impl Scatterer for Reversed {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.base.evaluate(outgoing.reversed(), incident.reversed())
    }

    fn peaks(&self, _: Disk) -> Vec<Peak> {
        Vec::new()
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        let outgoing = Disk::uniform(u);
        Some(Sample {
            outgoing,
            weight: PI * self.evaluate(incident, outgoing),
            peak: false,
        })
    }

    fn pdf(&self, _: Disk, outgoing: Disk) -> f64 {
        outgoing.cos_theta() / PI
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        if part == Part::Direct {
            0.0
        } else {
            self.sum(incident, POINTS)
        }
        .into()
    }

    /// A rough total: the full one would cost thousands of evaluations for every sample.
    fn weight(&self, incident: Disk) -> f64 {
        self.sum(incident, ROUGH).max(LEAST)
    }

    fn resolution(&self, incident: Disk) -> f64 {
        self.base.resolution(incident.reversed())
    }
}

/// A table's reverse, where the base is a table; [`super::Separated`] asks for it only then.
impl Tabular for Reversed {
    fn cell(&self, incident: Disk, outgoing: Disk) -> Cell {
        self.table().cell(outgoing.reversed(), incident.reversed())
    }

    fn smallest_area(&self) -> f64 {
        self.table().smallest_area()
    }

    fn floor(&self) -> f64 {
        self.table().floor()
    }

    fn extent(&self, _: Disk) -> f64 {
        // An isotropic tree's cell, seen backwards, may reach all around the normal.
        2.0
    }
}

impl Reversed {
    fn table(&self) -> &dyn Tabular {
        tabular(&self.base).expect("asked for tables only")
    }
}
