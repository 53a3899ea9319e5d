//! Matrix BSDF: one value for each pair of an incident and an outgoing patch (Klems 1994 and any other basis).
//!
//! Piecewise constant, no interpolation. Negative values, which noisy measurements hold, are kept as they are and count
//! as zero in every optical result.

use std::sync::{Arc, OnceLock};

use super::separated::{Cell, Tabular};
use super::{Estimate, Part, Peak, Region, Sample, Scatterer};
use crate::basis::Basis;
use crate::direction::Disk;
use crate::error::{Error, Result};

/// BSDF values on a pair of angle bases.
#[derive(Debug, Clone)]
pub struct Matrix {
    incident: Arc<Basis>,
    outgoing: Arc<Basis>,
    /// Incident patch by incident patch: `values[i * outgoing.len() + o]`, 1/sr.
    values: Vec<f64>,
    standard_errors: Option<Vec<f64>>,
    /// Standard errors of the direct-hemispherical values, one an incident patch, where more is known of them than that the
    /// values are independent.
    total_standard_errors: Option<Vec<f64>>,
    /// Running sums of flux over outgoing patches for each incident one; the last is its direct-hemispherical value.
    cumulative: OnceLock<Vec<f64>>,
}

impl PartialEq for Matrix {
    fn eq(&self, other: &Self) -> bool {
        self.incident == other.incident
            && self.outgoing == other.outgoing
            && self.values == other.values
            && self.standard_errors == other.standard_errors
            && self.total_standard_errors == other.total_standard_errors
    }
}

impl Matrix {
    /// From values (1/sr) listed incident patch by incident patch.
    pub fn new(incident: Arc<Basis>, outgoing: Arc<Basis>, values: Vec<f64>) -> Result<Self> {
        let expected = incident.len() * outgoing.len();
        if values.len() != expected {
            return Err(Error::Argument(format!(
                "{} values for {} incident and {} outgoing patches (give {expected})",
                values.len(),
                incident.len(),
                outgoing.len()
            )));
        }
        // Without an early end the check is fast.
        if !values.iter().fold(true, |all, v| all & v.is_finite())
            && let Some(k) = values.iter().position(|v| !v.is_finite())
        {
            return Err(Error::Argument(format!(
                "value {} for incident patch {} and outgoing patch {} is not a finite number",
                values[k],
                k / outgoing.len() + 1,
                k % outgoing.len() + 1
            )));
        }
        Ok(Self {
            incident,
            outgoing,
            values,
            standard_errors: None,
            total_standard_errors: None,
            cumulative: OnceLock::new(),
        })
    }

    /// From a function of (incident, outgoing) patch.
    pub fn from_fn(incident: Arc<Basis>, outgoing: Arc<Basis>, f: impl Fn(usize, usize) -> f64) -> Result<Self> {
        let (n_in, n_out) = (incident.len(), outgoing.len());
        let values = (0..n_in * n_out).map(|k| f(k / n_out, k % n_out)).collect();
        Self::new(incident, outgoing, values)
    }

    /// With one standard error a value, in the same order.
    pub fn with_standard_errors(mut self, errors: Vec<f64>) -> Result<Self> {
        if errors.len() != self.values.len() || errors.iter().any(|e| !(e.is_finite() && *e >= 0.0)) {
            return Err(Error::Argument(format!(
                "standard errors must be {} finite numbers of 0 or more",
                self.values.len()
            )));
        }
        self.standard_errors = Some(errors);
        Ok(self)
    }

    /// With one standard error a direct-hemispherical value. Errors of one measurement's values are not independent, so these
    /// tell more than the values' own.
    pub fn with_total_standard_errors(mut self, errors: Vec<f64>) -> Result<Self> {
        if errors.len() != self.incident.len() || errors.iter().any(|e| !(e.is_finite() && *e >= 0.0)) {
            return Err(Error::Argument(format!(
                "standard errors of totals must be {} finite numbers of 0 or more",
                self.incident.len()
            )));
        }
        self.total_standard_errors = Some(errors);
        Ok(self)
    }

    /// Basis of incident directions.
    pub fn incident(&self) -> &Arc<Basis> {
        &self.incident
    }

    /// Basis of outgoing directions.
    pub fn outgoing(&self) -> &Arc<Basis> {
        &self.outgoing
    }

    /// Values as given (1/sr), incident patch by incident patch.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Standard errors (1/sr) in the order of [`Matrix::values`].
    pub fn standard_errors(&self) -> Option<&[f64]> {
        self.standard_errors.as_deref()
    }

    /// Standard errors of direct-hemispherical values, one an incident patch, where they are known by themselves.
    pub fn total_standard_errors(&self) -> Option<&[f64]> {
        self.total_standard_errors.as_deref()
    }

    /// Value for a pair of patches (1/sr); a negative one counts as zero.
    pub fn value(&self, incident: usize, outgoing: usize) -> f64 {
        self.values[incident * self.outgoing.len() + outgoing].max(0.0)
    }

    /// Values multiplied by a factor for each incident patch.
    #[must_use]
    pub fn scaled(&self, factor: impl Fn(usize) -> f64) -> Self {
        let n = self.outgoing.len();
        let scale = |v: &[f64]| v.iter().enumerate().map(|(k, v)| v * factor(k / n)).collect();
        Self {
            incident: self.incident.clone(),
            outgoing: self.outgoing.clone(),
            values: scale(&self.values),
            standard_errors: self.standard_errors.as_deref().map(scale),
            total_standard_errors: self
                .total_standard_errors
                .as_ref()
                .map(|e| e.iter().enumerate().map(|(i, e)| e * factor(i)).collect()),
            cumulative: OnceLock::new(),
        }
    }

    /// Values by the patches that they come from: `values[i][o]` of the result is `self[of_incident(i)][of_outgoing(o)]`.
    /// None where a patch has no source.
    pub fn permuted(
        &self,
        of_incident: impl Fn(usize) -> Option<usize>,
        of_outgoing: impl Fn(usize) -> Option<usize>,
    ) -> Option<Self> {
        let n = self.outgoing.len();
        let rows: Vec<usize> = (0..self.incident.len()).map(of_incident).collect::<Option<_>>()?;
        let columns: Vec<usize> = (0..n).map(of_outgoing).collect::<Option<_>>()?;
        let pick = |v: &[f64]| {
            rows.iter()
                .flat_map(|&i| columns.iter().map(move |&o| v[i * n + o]))
                .collect()
        };
        Some(Self {
            incident: self.incident.clone(),
            outgoing: self.outgoing.clone(),
            values: pick(&self.values),
            standard_errors: self.standard_errors.as_deref().map(pick),
            total_standard_errors: self
                .total_standard_errors
                .as_ref()
                .map(|e| rows.iter().map(|&i| e[i]).collect()),
            cumulative: OnceLock::new(),
        })
    }

    /// All paths travelled backwards, T_b = Q·T_fᵀ·Q with Q a turn by 180°. None where a basis cannot be reversed.
    pub fn reversed(&self) -> Option<Self> {
        let (n_in, n_out) = (self.incident.len(), self.outgoing.len());
        let from_in: Vec<usize> = (0..n_in).map(|p| self.incident.reversed(p)).collect::<Option<_>>()?;
        let from_out: Vec<usize> = (0..n_out).map(|p| self.outgoing.reversed(p)).collect::<Option<_>>()?;
        let turn = |v: &[f64]| {
            from_out
                .iter()
                .flat_map(|&o| from_in.iter().map(move |&i| v[i * n_out + o]))
                .collect()
        };
        Some(Self {
            incident: self.outgoing.clone(),
            outgoing: self.incident.clone(),
            values: turn(&self.values),
            standard_errors: self.standard_errors.as_deref().map(turn),
            total_standard_errors: None,
            cumulative: OnceLock::new(),
        })
    }

    /// Direct-hemispherical value of an incident patch.
    pub fn direct_hemispherical(&self, incident: usize) -> f64 {
        self.running(incident)[self.outgoing.len() - 1]
    }

    /// Running sums of flux for one incident patch.
    fn running(&self, incident: usize) -> &[f64] {
        let n = self.outgoing.len();
        let sums = self.cumulative.get_or_init(|| {
            let areas = self.outgoing.projected_solid_angles();
            let mut sums = Vec::with_capacity(self.values.len());
            for row in self.values.chunks_exact(n) {
                let mut sum = 0.0;
                sums.extend(row.iter().zip(&areas).map(|(v, a)| {
                    sum += v.max(0.0) * a;
                    sum
                }));
            }
            sums
        });
        &sums[incident * n..(incident + 1) * n]
    }

    fn standard_error_of(&self, incident: usize, patches: impl Iterator<Item = usize>) -> Option<f64> {
        let n = self.outgoing.len();
        let errors = &self.standard_errors.as_ref()?[incident * n..(incident + 1) * n];
        let variance: f64 = patches
            .map(|o| (errors[o] * self.outgoing.projected_solid_angle(o)).powi(2))
            .sum();
        Some(variance.sqrt())
    }
}

impl Scatterer for Matrix {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.value(self.incident.patch_of(incident), self.outgoing.patch_of(outgoing))
    }

    fn peaks(&self, _: Disk) -> Vec<Peak> {
        Vec::new()
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        let running = self.running(self.incident.patch_of(incident));
        let total = running[running.len() - 1];
        if total <= 0.0 {
            return None;
        }
        let target = u[0] * total;
        let patch = running.partition_point(|&sum| sum <= target).min(running.len() - 1);
        let below = if patch == 0 { 0.0 } else { running[patch - 1] };
        let inner = ((target - below) / (running[patch] - below)).clamp(0.0, 1.0 - f64::EPSILON);
        Some(Sample {
            outgoing: self.outgoing.sample_cosine(patch, [inner, u[1]]),
            weight: total,
            peak: false,
        })
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        let patch = self.incident.patch_of(incident);
        let total = self.direct_hemispherical(patch);
        if total <= 0.0 {
            return 0.0;
        }
        self.value(patch, self.outgoing.patch_of(outgoing)) * outgoing.cos_theta() / total
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        if part == Part::Direct {
            return 0.0.into();
        }
        let patch = self.incident.patch_of(incident);
        Estimate {
            value: self.direct_hemispherical(patch),
            standard_error: match &self.total_standard_errors {
                Some(errors) => Some(errors[patch]),
                None => self.standard_error_of(patch, 0..self.outgoing.len()),
            },
        }
    }

    fn integrate(&self, incident: Disk, region: &Region, part: Part) -> Estimate {
        // On its own patches the sum is exact.
        if let Region::Patches { basis, patches, turn } = region
            && *turn == super::Turn::NONE
            && *basis == self.outgoing
            && part != Part::Direct
        {
            let i = self.incident.patch_of(incident);
            let value = patches
                .iter()
                .map(|&o| self.value(i, o) * self.outgoing.projected_solid_angle(o))
                .sum();
            return Estimate {
                value,
                standard_error: self.standard_error_of(i, patches.iter().copied()),
            };
        }
        match region {
            Region::Hemisphere => self.total(incident, part),
            _ if part == Part::Direct => 0.0.into(),
            _ => super::scatterer::integrate_scattered(self, incident, region).into(),
        }
    }

    fn resolution(&self, incident: Disk) -> f64 {
        self.outgoing
            .resolution(self.outgoing.patch_of(incident))
            .max(self.incident.resolution(self.incident.patch_of(incident)))
    }
}

/// Upper limit of the distance between a point and others of its patch.
pub(super) fn patch_extent(basis: &Basis, point: Disk) -> f64 {
    let (theta, phi) = basis.limits(basis.patch_of(point));
    let [inner, outer] = theta.map(f64::sin);
    // Across a ring and along its outer limit; never more than across the whole ring.
    (outer - inner + outer * (phi[1] - phi[0])).min(2.0 * outer)
}

impl Tabular for Matrix {
    fn cell(&self, incident: Disk, outgoing: Disk) -> Cell {
        let (i, o) = (self.incident.patch_of(incident), self.outgoing.patch_of(outgoing));
        Cell {
            id: (i * self.outgoing.len() + o) as u64,
            value: self.value(i, o),
            area: self
                .incident
                .projected_solid_angle(i)
                .min(self.outgoing.projected_solid_angle(o)),
            outgoing_area: self.outgoing.projected_solid_angle(o),
        }
    }

    fn cells(&self, incident: Disk, outgoing: &[Disk], cells: &mut [Cell]) {
        let i = self.incident.patch_of(incident);
        let area = self.incident.projected_solid_angle(i);
        for (cell, &point) in cells.iter_mut().zip(outgoing) {
            let o = self.outgoing.patch_of(point);
            let outgoing_area = self.outgoing.projected_solid_angle(o);
            *cell = Cell {
                id: (i * self.outgoing.len() + o) as u64,
                value: self.value(i, o),
                area: area.min(outgoing_area),
                outgoing_area,
            };
        }
    }

    fn extent(&self, _: Disk, outgoing: Disk) -> f64 {
        patch_extent(&self.outgoing, outgoing)
    }

    fn smallest_area(&self) -> f64 {
        [&self.incident, &self.outgoing]
            .iter()
            .flat_map(|b| b.projected_solid_angles())
            .fold(f64::INFINITY, f64::min)
    }

    fn floor(&self) -> f64 {
        self.values.iter().copied().fold(f64::INFINITY, f64::min).max(0.0)
    }
}
