//! Scattered light seen through beams: what a layer scatters, weakened on its way to the layer and on its way out.
//!
//! Panes keep the disk point of what they pass or mirror. So light that reaches a layer through panes, is scattered there
//! once and leaves through panes is the layer's own BSDF times a function of each direction, at the layer's own resolution.

use std::sync::Arc;

use super::{Estimate, Matrix, Model, Part, Peak, Sample, Scatterer};
use crate::basis::Basis;
use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::sequence::r2;

/// a(vᵢ) · f(vᵢ, vₒ) · b(vₒ), without the peaks of f.
#[derive(Debug, Clone)]
pub struct Filtered {
    base: Arc<Model>,
    before: Arc<Model>,
    after: Arc<Model>,
    /// Mean of `after` over the disk.
    mean: f64,
    /// Its means over the outgoing patches, where the base is a matrix.
    means: Option<Vec<f64>>,
}

/// Points for a mean over the disk, and over a patch.
const POINTS: u32 = 4096;
const PATCH_POINTS: u32 = 64;
/// Samples for a direct-hemispherical value where there is no table.
const SAMPLES: u32 = 4096;

impl Filtered {
    /// `base` with what its incident light and its outgoing light are multiplied by; both must be beams.
    pub fn new(base: Arc<Model>, before: Arc<Model>, after: Arc<Model>) -> Result<Self> {
        for filter in [&before, &after] {
            if !is_beam(filter) {
                return Err(Error::Argument(format!(
                    "light is filtered by beams, not by a {} model (give specular ones)",
                    filter.kind()
                )));
            }
        }
        let mean = (0..POINTS)
            .map(|k| value(&after, Disk::uniform(r2(k, [0.0; 2]))))
            .sum::<f64>()
            / f64::from(POINTS);
        let means = match &*base {
            Model::Matrix(matrix) => Some(patch_means(&after, matrix.outgoing())),
            _ => None,
        };
        Ok(Self {
            base,
            before,
            after,
            mean,
            means,
        })
    }

    /// What scatters.
    pub fn base(&self) -> &Arc<Model> {
        &self.base
    }

    /// What incident light is multiplied by.
    pub fn before(&self) -> &Arc<Model> {
        &self.before
    }

    /// What outgoing light is multiplied by.
    pub fn after(&self) -> &Arc<Model> {
        &self.after
    }

    /// The same light with each of the three models changed.
    pub fn try_map(&self, change: impl Fn(&Model) -> Result<Model>) -> Result<Self> {
        Self::new(
            Arc::new(change(&self.base)?),
            Arc::new(change(&self.before)?),
            Arc::new(change(&self.after)?),
        )
    }

    /// The same filters before and after another model.
    pub fn with_base(&self, base: Model) -> Result<Self> {
        Self::new(Arc::new(base), self.before.clone(), self.after.clone())
    }

    /// The same of the reversed paths.
    #[must_use]
    pub fn reciprocal(&self) -> Self {
        Self::new(
            Arc::new(self.base.reciprocal()),
            Arc::new(self.after.reciprocal()),
            Arc::new(self.before.reciprocal()),
        )
        .expect("a beam backwards is one")
    }

    /// What leaves of light that reached the base, where that is known without sampling.
    fn known(&self, incident: Disk) -> Option<f64> {
        match (&*self.base, &self.means) {
            (Model::Matrix(matrix), Some(means)) => Some(of_matrix(matrix, means, incident)),
            (Model::Lambertian(diffuser), _) => Some(diffuser.value() * self.mean),
            _ => None,
        }
    }

    fn scattered(&self, incident: Disk) -> f64 {
        if let Some(known) = self.known(incident) {
            return known;
        }
        let total = self.base.total(incident, Part::Scattered).value;
        // The mean is known without sampling; samples tell how the light differs from it.
        let difference: f64 = (0..SAMPLES)
            .filter_map(|k| self.base.sample(incident, r2(k, [0.0; 2])))
            .filter(|sample| !sample.peak)
            .map(|sample| sample.weight * (value(&self.after, sample.outgoing) - self.mean))
            .sum();
        (total * self.mean + difference / f64::from(SAMPLES)).max(0.0)
    }
}

fn of_matrix(matrix: &Matrix, means: &[f64], incident: Disk) -> f64 {
    let patch = matrix.incident().patch_of(incident);
    let areas = matrix.outgoing().projected_solid_angles();
    means
        .iter()
        .zip(areas)
        .enumerate()
        .map(|(o, (mean, area))| matrix.value(patch, o).max(0.0) * area * mean)
        .sum()
}

fn patch_means(filter: &Model, basis: &Basis) -> Vec<f64> {
    let mean = |patch| {
        let sum: f64 = (0..PATCH_POINTS)
            .map(|k| value(filter, basis.sample_cosine(patch, r2(k, [0.0; 2]))))
            .sum();
        sum / f64::from(PATCH_POINTS)
    };
    (0..basis.len()).map(mean).collect()
}

fn value(filter: &Model, point: Disk) -> f64 {
    match filter {
        Model::Specular(beam) => beam.value(point),
        Model::Beam(beam) => beam.value(point),
        other => other.total(point, Part::Direct).value,
    }
}

fn is_beam(model: &Model) -> bool {
    match model {
        Model::Specular(_) | Model::Beam(_) => true,
        Model::Turned(t) => is_beam(t.base()),
        _ => false,
    }
}

impl Scatterer for Filtered {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        value(&self.before, incident) * self.base.evaluate(incident, outgoing) * value(&self.after, outgoing)
    }

    fn evaluate_all(&self, incident: Disk, outgoing: &[Disk], values: &mut [f64]) {
        self.base.evaluate_all(incident, outgoing, values);
        let before = value(&self.before, incident);
        for (found, &point) in values.iter_mut().zip(outgoing) {
            *found *= before * value(&self.after, point);
        }
    }

    fn peaks(&self, _: Disk) -> Vec<Peak> {
        Vec::new()
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        let before = value(&self.before, incident);
        if before <= 0.0 {
            return None;
        }
        let sample = self.base.sample(incident, u).filter(|sample| !sample.peak)?;
        let weight = sample.weight * before * value(&self.after, sample.outgoing);
        (weight > 0.0).then_some(Sample { weight, ..sample })
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        if value(&self.before, incident) <= 0.0 || value(&self.after, outgoing) <= 0.0 {
            return 0.0;
        }
        self.base.pdf(incident, outgoing)
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        let before = value(&self.before, incident);
        if part == Part::Direct || before <= 0.0 {
            return 0.0.into();
        }
        let error = self.base.total(incident, Part::Scattered).standard_error;
        Estimate {
            value: before * self.scattered(incident),
            standard_error: error.map(|e| e * before * self.mean),
        }
    }

    fn weight(&self, incident: Disk) -> f64 {
        let after = self
            .known(incident)
            .unwrap_or_else(|| self.base.weight(incident) * self.mean);
        value(&self.before, incident) * after
    }

    fn resolution(&self, incident: Disk) -> f64 {
        self.base.resolution(incident)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Lambertian, Specular};
    use crate::sequence::uniform;

    fn pass(values: &[f64]) -> Arc<Model> {
        Arc::new(Model::Specular(Specular::cosine(values.to_vec()).unwrap()))
    }

    #[test]
    fn a_diffuser_behind_beams_is_the_product() {
        let base = Arc::new(Model::Lambertian(Lambertian::new(0.6).unwrap()));
        // b = cosθ: its mean over projected solid angle is 2/3.
        let seen = Filtered::new(base, pass(&[0.2, 0.8]), pass(&[0.0, 1.0])).unwrap();
        let (i, o) = (Disk::new(0.6, 0.0), Disk::new(0.0, -0.8));
        let before = 0.2 + 0.6 * 0.8;
        assert!((seen.evaluate(i, o) - before * 0.6 / std::f64::consts::PI * 0.6).abs() < 1e-12);
        let total = seen.total(i, Part::All).value;
        assert!((total - before * 0.6 * 2.0 / 3.0).abs() < 2e-4, "{total}");
        assert!(seen.peaks(i).is_empty());
    }

    #[test]
    fn a_table_behind_beams_has_exact_totals() {
        let basis = Arc::new(Basis::klems_quarter());
        let matrix = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| uniform(1, (i * 41 + o) as u64)).unwrap();
        let base = Arc::new(Model::Matrix(matrix));
        let seen = Filtered::new(base.clone(), pass(&[0.5, 0.5]), pass(&[0.4, 0.4])).unwrap();
        let i = Disk::new(-0.3, 0.5);
        assert!((seen.total(i, Part::All).value - 0.2 * base.total(i, Part::All).value).abs() < 1e-12);
        let backwards = seen.reciprocal();
        let o = Disk::new(0.1, 0.2);
        assert!((backwards.evaluate(o.reversed(), i.reversed()) - seen.evaluate(i, o)).abs() < 1e-12);
    }

    #[test]
    fn only_beams_filter() {
        let base = Arc::new(Model::Lambertian(Lambertian::new(0.6).unwrap()));
        assert!(Filtered::new(base.clone(), base.clone(), pass(&[1.0, 1.0])).is_err());
    }
}
