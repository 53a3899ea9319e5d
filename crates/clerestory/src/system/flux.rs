//! Light from patch to patch as flux: a diagonal of beams and, where light is scattered, a matrix.
//!
//! Beams keep their patch when they pass or are mirrored, so a product or a solution of beams is one of numbers. Keeping
//! them apart leaves what travelled along specular paths alone as a beam, and glass costs next to nothing.

use std::f64::consts::PI;
use std::sync::Arc;

use ndarray::{Array1, Array2, Axis};

use super::linear;
use crate::basis::Basis;
use crate::bsdf::convert::{Sampling, to_matrix};
use crate::bsdf::{Matrix, Model, Part, Scatterer, Separated, Specular, Sum};
use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Which value of a specular layer stands for a patch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum PatchValue {
    /// That of its nominal centre, as WINDOW does.
    #[default]
    Centre,
    /// The mean over its projected solid angle.
    Mean,
}

/// Shares of the flux of incident patches that leave into outgoing ones.
#[derive(Debug, Clone)]
pub struct Flux {
    /// Of each incident patch, what stays a beam.
    beam: Array1<f64>,
    /// What is scattered, (outgoing, incident); none where it is all zero.
    scattered: Option<Array2<f64>>,
}

/// The model as matrices on a basis, diffusers and beams; `notes` takes what had to be converted.
///
/// Fails for a matrix on other patches: a person must choose how to convert that.
pub fn on_basis(model: &Arc<Model>, basis: &Arc<Basis>, notes: &mut Vec<String>) -> Result<Arc<Model>> {
    let beam = |m: &Model| matches!(m, Model::Specular(_) | Model::Beam(_));
    match &**model {
        Model::Matrix(matrix) => match [matrix.incident(), matrix.outgoing()].into_iter().find(|b| *b != basis) {
            None => Ok(model.clone()),
            Some(other) => Err(Error::Argument(format!(
                "its patches are those of {:?}, not of {:?} (convert it first)",
                other.name(),
                basis.name()
            ))),
        },
        Model::Lambertian(_) | Model::Specular(_) | Model::Beam(_) => Ok(model.clone()),
        Model::Turned(turned) if beam(turned.base()) => Ok(model.clone()),
        Model::Sum(sum) => {
            let parts = sum
                .parts()
                .iter()
                .map(|(weight, part)| Ok((*weight, on_basis(part, basis, notes)?)))
                .collect::<Result<_>>()?;
            Ok(Arc::new(Model::Sum(Sum::new(parts)?)))
        }
        Model::Separated(separated) => match &**separated.base() {
            Model::Matrix(matrix) if matrix.incident() == basis && matrix.outgoing() == basis => {
                split(separated, matrix, basis)
            }
            _ => converted(model, basis, notes),
        },
        Model::Tree(_) | Model::Turned(_) | Model::Reversed(_) | Model::Filtered(_) | Model::Interpolant(_) => {
            converted(model, basis, notes)
        }
    }
}

/// A matrix whose beams were found, with both as they are at the patches' centres.
fn split(separated: &Separated, matrix: &Matrix, basis: &Arc<Basis>) -> Result<Arc<Model>> {
    let centres: Vec<Disk> = (0..basis.len()).map(|p| basis.centre(p)).collect();
    let mut scattered = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| {
        separated.evaluate(centres[i], centres[o])
    })?;
    if let Some(errors) = matrix.standard_errors() {
        scattered = scattered.with_standard_errors(errors.to_vec())?;
    }
    let beams = centres
        .iter()
        .map(|&c| separated.total(c, Part::Direct).value)
        .collect();
    let beams = Specular::patches(basis.clone(), beams)?;
    let parts = [Model::Matrix(scattered), Model::Specular(beams)];
    Ok(Arc::new(Model::Sum(Sum::new(
        parts.into_iter().map(|m| (1.0, Arc::new(m))).collect(),
    )?)))
}

fn converted(model: &Model, basis: &Arc<Basis>, notes: &mut Vec<String>) -> Result<Arc<Model>> {
    let conversion = to_matrix(model, basis, basis, Sampling::default(), &Progress::default())?;
    notes.push(format!(
        "{} model converted to {}, with a sampling error of {:.2} %",
        model.kind(),
        basis.name(),
        100.0 * conversion.rms_error
    ));
    Ok(Arc::new(Model::Matrix(conversion.matrix)))
}

impl Flux {
    /// No light at all.
    pub fn none(patches: usize) -> Self {
        Self {
            beam: Array1::zeros(patches),
            scattered: None,
        }
    }

    /// Every patch to itself.
    pub fn identity(patches: usize) -> Self {
        Self {
            beam: Array1::ones(patches),
            scattered: None,
        }
    }

    /// From a model that [`on_basis`] gave.
    pub fn of(model: &Model, basis: &Arc<Basis>, specular: PatchValue) -> Result<Self> {
        let n = basis.len();
        match model {
            Model::Matrix(matrix) => {
                let areas = basis.projected_solid_angles();
                Ok(Self {
                    beam: Array1::zeros(n),
                    scattered: Some(Array2::from_shape_fn((n, n), |(o, i)| matrix.value(i, o) * areas[o])),
                })
            }
            Model::Lambertian(diffuser) => {
                let areas = basis.projected_solid_angles();
                let value = diffuser.value() / PI;
                Ok(Self {
                    beam: Array1::zeros(n),
                    scattered: (value > 0.0).then(|| Array2::from_shape_fn((n, n), |(o, _)| value * areas[o])),
                })
            }
            Model::Specular(beam) => Ok(Self {
                beam: beam_values(basis, specular, |point| beam.value(point)),
                scattered: None,
            }),
            Model::Turned(_) | Model::Beam(_) => Ok(Self {
                beam: beam_values(basis, specular, |point| model.total(point, Part::Direct).value),
                scattered: None,
            }),
            Model::Sum(sum) => {
                let mut total = Self::none(n);
                for (weight, part) in sum.parts() {
                    total = total.plus(Self::of(part, basis, specular)?.times(*weight));
                }
                Ok(total)
            }
            other => Err(Error::Unsupported(format!(
                "a {} model has no values by patch",
                other.kind()
            ))),
        }
    }

    /// The model that sends light so: scattered light as a matrix, beams as peaks.
    pub fn model(&self, basis: &Arc<Basis>, standard_errors: Option<Vec<f64>>) -> Result<Model> {
        let mut parts = Vec::new();
        let has_beam = self.beam.iter().any(|&b| b > 0.0);
        if self.scattered.is_some() || standard_errors.is_some() || !has_beam {
            let areas = basis.projected_solid_angles();
            let value = |i, o| self.scattered.as_ref().map_or(0.0, |s| s[[o, i]] / areas[o]);
            let mut matrix = Matrix::from_fn(basis.clone(), basis.clone(), value)?;
            if let Some(errors) = standard_errors {
                matrix = matrix.with_standard_errors(errors)?;
            }
            parts.push(Model::Matrix(matrix));
        }
        if has_beam {
            let beam = Specular::patches(basis.clone(), self.beam.to_vec())?;
            parts.push(Model::Specular(beam));
        }
        if parts.len() == 1 {
            return Ok(parts.remove(0));
        }
        Ok(Model::Sum(Sum::new(
            parts.into_iter().map(|m| (1.0, Arc::new(m))).collect(),
        )?))
    }

    /// All of it by a factor.
    fn times(mut self, factor: f64) -> Self {
        self.beam *= factor;
        if let Some(scattered) = &mut self.scattered {
            *scattered *= factor;
        }
        self
    }

    /// Both together.
    #[must_use]
    pub fn plus(&self, other: Self) -> Self {
        Self {
            beam: &self.beam + &other.beam,
            scattered: add(self.scattered.clone(), other.scattered),
        }
    }

    /// First `first`, then this.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        // A beam scales the rows of what comes before it and the columns of what comes after it.
        let ahead = first.scattered.as_ref().and_then(|s| rows_by(&self.beam, s));
        let behind = self.scattered.as_ref().and_then(|s| columns_by(s, &first.beam));
        let both = self
            .scattered
            .as_ref()
            .zip(first.scattered.as_ref())
            .map(|(a, b)| linear::product(a, b));
        Self {
            beam: &self.beam * &first.beam,
            scattered: add(add(both, ahead), behind),
        }
    }

    /// All that comes of `light` if a round trip of this kind follows again and again: (1 − this)⁻¹ light.
    pub fn again_and_again(&self, light: &Self) -> Result<Self> {
        let trapped = || {
            Error::Argument(
                "light that gets between two layers never leaves them (one of them must let some go)".into(),
            )
        };
        let mut beam = light.beam.clone();
        for (value, round) in beam.iter_mut().zip(&self.beam) {
            if *value != 0.0 {
                let kept = 1.0 - round;
                if kept < 1e-12 {
                    return Err(trapped());
                }
                *value /= kept;
            }
        }
        // The rest: (1 − d − m) x = light.scattered + m · beam.
        let source = add(
            light.scattered.clone(),
            self.scattered.as_ref().and_then(|m| columns_by(m, &beam)),
        );
        let scattered = match (source, &self.scattered) {
            (None, _) => None,
            (Some(mut source), None) => {
                for (mut row, round) in source.rows_mut().into_iter().zip(&self.beam) {
                    let kept = 1.0 - round;
                    if row.iter().any(|&v| v != 0.0) {
                        if kept < 1e-12 {
                            return Err(trapped());
                        }
                        row /= kept;
                    }
                }
                Some(source)
            }
            (Some(source), Some(m)) => {
                let mut left = -m;
                for (k, round) in self.beam.iter().enumerate() {
                    // A beam that never leaves is nothing where no light gets into it, as at grazing incidence.
                    let closed = 1.0 - round < 1e-12 && [m, &source].iter().all(|a| a.row(k).iter().all(|&v| v == 0.0));
                    left[[k, k]] += if closed { 1.0 } else { 1.0 - round };
                }
                Some(linear::solve(&left, &source).ok_or_else(trapped)?)
            }
        };
        Ok(Self { beam, scattered })
    }

    /// Sum of what leaves, by incident patch.
    pub fn totals(&self) -> Array1<f64> {
        match &self.scattered {
            Some(s) => s.sum_axis(Axis(0)) + &self.beam,
            None => self.beam.clone(),
        }
    }

    /// What a meter with these responses to outgoing patches reads, by incident patch.
    pub fn seen_by(&self, responses: &Array1<f64>) -> Array1<f64> {
        let mut result = responses * &self.beam;
        if let Some(s) = &self.scattered {
            result += &responses.dot(s);
        }
        result
    }

    /// All of it as one matrix, (outgoing, incident).
    pub fn matrix(&self) -> Array2<f64> {
        let beam = Array2::from_diag(&self.beam);
        match &self.scattered {
            Some(s) => beam + s,
            None => beam,
        }
    }
}

fn beam_values(basis: &Basis, specular: PatchValue, value: impl Fn(Disk) -> f64) -> Array1<f64> {
    const RADII: usize = 64;
    const AZIMUTHS: usize = 8;
    (0..basis.len())
        .map(|patch| match specular {
            PatchValue::Centre => value(basis.centre(patch)),
            PatchValue::Mean => {
                let mut sum = 0.0;
                for k in 0..RADII * AZIMUTHS {
                    let u = (((k / AZIMUTHS) as f64) + 0.5) / RADII as f64;
                    let v = (((k % AZIMUTHS) as f64) + 0.5) / AZIMUTHS as f64;
                    sum += value(basis.sample_cosine(patch, [u, v]));
                }
                sum / (RADII * AZIMUTHS) as f64
            }
        })
        .collect()
}

fn add(a: Option<Array2<f64>>, b: Option<Array2<f64>>) -> Option<Array2<f64>> {
    match (a, b) {
        (Some(a), Some(b)) => Some(a + b),
        (a, b) => a.or(b),
    }
}

fn rows_by(factors: &Array1<f64>, matrix: &Array2<f64>) -> Option<Array2<f64>> {
    some(factors).then(|| matrix * &factors.view().insert_axis(Axis(1)))
}

fn columns_by(matrix: &Array2<f64>, factors: &Array1<f64>) -> Option<Array2<f64>> {
    some(factors).then(|| matrix * factors)
}

fn some(factors: &Array1<f64>) -> bool {
    factors.iter().any(|&f| f != 0.0)
}
