//! Weighted sums and mixtures of models, kept at each one's own resolution.

use std::sync::Arc;

use super::{Estimate, Model, Part, Peak, Region, Sample, Scatterer};
use crate::direction::Disk;
use crate::error::{Error, Result};

/// Σ wⱼ fⱼ with weights that are not negative.
#[derive(Debug, Clone)]
pub struct Sum {
    parts: Vec<(f64, Arc<Model>)>,
}

impl Sum {
    /// From weights and models; at least one.
    pub fn new(parts: Vec<(f64, Arc<Model>)>) -> Result<Self> {
        if parts.is_empty() {
            return Err(Error::Argument("a sum needs at least one model".into()));
        }
        if let Some((w, _)) = parts.iter().find(|(w, _)| !(w.is_finite() && *w >= 0.0)) {
            return Err(Error::Argument(format!(
                "weight {w} of a sum is not a finite number of 0 or more"
            )));
        }
        Ok(Self { parts })
    }

    /// The same sum of other models.
    #[must_use]
    pub fn map(&self, change: impl Fn(&Model) -> Model) -> Self {
        let parts = self.parts.iter().map(|(w, model)| (*w, Arc::new(change(model))));
        Self { parts: parts.collect() }
    }

    /// Weights and models.
    pub fn parts(&self) -> &[(f64, Arc<Model>)] {
        &self.parts
    }

    /// The parts' shares: the probabilities of sampling them.
    fn shares(&self, incident: Disk) -> Option<Vec<f64>> {
        let mut shares: Vec<f64> = self.parts.iter().map(|(w, m)| w * m.weight(incident)).collect();
        let total: f64 = shares.iter().sum();
        if total <= 0.0 {
            return None;
        }
        for share in &mut shares {
            *share /= total;
        }
        Some(shares)
    }

    fn add(&self, of: impl Fn(&Model) -> Estimate) -> Estimate {
        let mut value = 0.0;
        let mut variance = None;
        for (w, model) in &self.parts {
            let part = of(model);
            value += w * part.value;
            if let Some(error) = part.standard_error {
                variance = Some(variance.unwrap_or(0.0) + (w * error).powi(2));
            }
        }
        Estimate {
            value,
            standard_error: variance.map(f64::sqrt),
        }
    }
}

impl Scatterer for Sum {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.parts.iter().map(|(w, m)| w * m.evaluate(incident, outgoing)).sum()
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        self.parts
            .iter()
            .flat_map(|(w, m)| {
                m.peaks(incident).into_iter().map(move |p| Peak {
                    value: w * p.value,
                    ..p
                })
            })
            .collect()
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        let shares = self.shares(incident)?;
        let mut below = 0.0;
        // Rounding can leave u past the last share: then the last part that has one.
        let mut chosen = None;
        for (k, &share) in shares.iter().enumerate() {
            if share > 0.0 {
                chosen = Some((k, share, below));
                if u[0] < below + share {
                    break;
                }
                below += share;
            }
        }
        let (k, share, below) = chosen?;
        let inner = ((u[0] - below) / share).clamp(0.0, 1.0 - f64::EPSILON);
        let (w, model) = &self.parts[k];
        let sample = model.sample(incident, [inner, u[1]])?;
        let weight = if sample.peak {
            w * sample.weight / share
        } else {
            let pdf = self.pdf_with(&shares, incident, sample.outgoing);
            if pdf <= 0.0 {
                return None;
            }
            self.evaluate(incident, sample.outgoing) * sample.outgoing.cos_theta() / pdf
        };
        Some(Sample { weight, ..sample })
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.shares(incident)
            .map_or(0.0, |shares| self.pdf_with(&shares, incident, outgoing))
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        self.add(|m| m.total(incident, part))
    }

    fn weight(&self, incident: Disk) -> f64 {
        self.parts.iter().map(|(w, m)| w * m.weight(incident)).sum()
    }

    fn integrate(&self, incident: Disk, region: &Region, part: Part) -> Estimate {
        self.add(|m| m.integrate(incident, region, part))
    }

    fn resolution(&self, incident: Disk) -> f64 {
        let tables = self.parts.iter().map(|(_, m)| m.resolution(incident));
        // Parts without a grid resolve everything, and say nothing of the tables beside them.
        tables.filter(|&r| r > 0.0).reduce(f64::min).unwrap_or(0.0)
    }
}

impl Sum {
    fn pdf_with(&self, shares: &[f64], incident: Disk, outgoing: Disk) -> f64 {
        self.parts
            .iter()
            .zip(shares)
            .filter(|&(_, &share)| share > 0.0)
            .map(|((_, m), share)| share * m.pdf(incident, outgoing))
            .sum()
    }
}
