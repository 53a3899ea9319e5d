//! Light from one side of a data set, transmitted and reflected and in several bands together.

use super::{Bsdf, Component, Peak, Sample, Scatterer};
use crate::direction::{Direction, Disk, Scatter, Side};
use crate::error::Result;

/// A data set's models for light from one side, ready for many evaluations: one list of bands for transmission and
/// reflection.
#[derive(Debug, Clone)]
pub struct Lobes {
    side: Side,
    bands: usize,
    /// By scatter, then by band.
    models: Vec<(Scatter, Vec<Component>)>,
}

/// A sampled direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LobeSample {
    /// Direction that the light leaves to.
    pub outgoing: Direction,
    /// Whether it is a peak.
    pub peak: bool,
}

impl Lobes {
    /// Models of `bands` for light from `side`, transmitted, reflected or (`None`) both.
    pub fn new(bsdf: &Bsdf, bands: &[Option<&str>], side: Side, scatter: Option<Scatter>) -> Result<Self> {
        let scatters = scatter.map_or(Scatter::BOTH.to_vec(), |s| vec![s]);
        let models = scatters
            .into_iter()
            .map(|scatter| {
                let components = bands
                    .iter()
                    .map(|band| bsdf.component(*band, side, scatter).map(|o| o.component))
                    .collect::<Result<Vec<_>>>()?;
                Ok((scatter, components))
            })
            .collect::<Result<_>>()?;
        Ok(Self {
            side,
            bands: bands.len(),
            models,
        })
    }

    /// With more bands, which are as the last one.
    #[must_use]
    pub fn padded(&self, bands: usize) -> Self {
        let mut lobes = self.clone();
        lobes.bands = bands;
        for (_, models) in &mut lobes.models {
            let last = models.last().cloned();
            models.resize_with(bands, || last.clone().expect("there is a band"));
        }
        lobes
    }

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.bands
    }

    fn models_to(&self, outgoing: Side) -> &[Component] {
        self.models
            .iter()
            .find(|(scatter, _)| scatter.outgoing_side(self.side) == outgoing)
            .map_or(&[], |(_, models)| models)
    }

    /// BSDF of scattered light (1/sr), one a band.
    pub fn evaluate(&self, incident: Direction, outgoing: Direction, values: &mut [f64]) {
        let (ti, to) = (incident.incident_disk(), outgoing.outgoing_disk());
        values.fill(0.0);
        for (value, model) in values.iter_mut().zip(self.models_to(outgoing.side())) {
            *value = model.evaluate(ti, to);
        }
    }

    /// A direction drawn from the mean of the bands' densities, over transmission and reflection together, and one weight
    /// a band: BSDF times cosine over density. Where nothing leaves there is none and the weights are 0.
    pub fn sample(&self, incident: Direction, u: [f64; 2], weights: &mut [f64]) -> Option<LobeSample> {
        let ti = incident.incident_disk();
        weights.fill(0.0);
        let (scatter, Sample { outgoing, peak, .. }) = match self.models.as_slice() {
            [(scatter, models)] if models.len() == 1 => {
                let sample = models[0].sample(ti, u)?;
                weights[0] = sample.weight;
                (*scatter, sample)
            }
            _ => self.sample_mixture(ti, u, weights)?,
        };
        Some(LobeSample {
            outgoing: outgoing.outgoing(scatter.outgoing_side(self.side)),
            peak,
        })
    }

    fn sample_mixture(&self, incident: Disk, u: [f64; 2], weights: &mut [f64]) -> Option<(Scatter, Sample)> {
        let shares: Vec<f64> = self.all().map(|m| m.weight(incident)).collect();
        let sum: f64 = shares.iter().sum();
        let mut target = u[0] * sum;
        // Rounding can leave the target past the last share: then the last one that is not zero.
        let mut chosen = None;
        for (k, &share) in shares.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            chosen = Some((k, (target / share).clamp(0.0, 1.0 - f64::EPSILON)));
            if target < share {
                break;
            }
            target -= share;
        }
        let (k, inner) = chosen?;
        let (scatter, models) = &self.models[k / self.bands];
        let shares = &shares[k / self.bands * self.bands..][..self.bands];
        let sample = models[k % self.bands].sample(incident, [inner, u[1]])?;
        let mut density = 0.0;
        for ((weight, model), share) in weights.iter_mut().zip(models).zip(shares) {
            if sample.peak {
                // A peak of value v is drawn with probability v / sum over all bands.
                let same = |p: &Peak| (p.outgoing.x - sample.outgoing.x).hypot(p.outgoing.y - sample.outgoing.y) < 1e-9;
                *weight = model.peaks(incident).iter().filter(|p| same(p)).map(|p| p.value).sum();
                density += *weight / sum;
            } else {
                *weight = model.evaluate(incident, sample.outgoing) * sample.outgoing.cos_theta();
                if *share > 0.0 {
                    density += share / sum * model.pdf(incident, sample.outgoing);
                }
            }
        }
        for weight in weights.iter_mut() {
            *weight = if density > 0.0 { *weight / density } else { 0.0 };
        }
        (density > 0.0).then_some((*scatter, sample))
    }

    /// Density of scattered directions of [`Lobes::sample`] (1/sr).
    pub fn pdf(&self, incident: Direction, outgoing: Direction) -> f64 {
        let (ti, to) = (incident.incident_disk(), outgoing.outgoing_disk());
        let models = self.models_to(outgoing.side());
        if self.models.len() == 1 && self.bands == 1 {
            return models.iter().map(|m| m.pdf(ti, to)).sum();
        }
        let sum: f64 = self.all().map(|m| m.weight(ti)).sum();
        if sum <= 0.0 {
            return 0.0;
        }
        models.iter().map(|m| m.weight(ti) / sum * m.pdf(ti, to)).sum()
    }

    fn all(&self) -> impl Iterator<Item = &Component> {
        self.models.iter().flat_map(|(_, models)| models)
    }
}
