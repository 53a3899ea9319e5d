//! All models under one type, so that data sets can be stored, converted and written.

use std::sync::Arc;

use super::convert;
use super::{
    Beam, Estimate, Filtered, Interpolant, Lambertian, Matrix, Part, Peak, Region, Reversed, Sample, Scatterer,
    Separated, Specular, Sum, Tree, Turn, Turned,
};
use crate::direction::Disk;
use crate::error::{Error, Result};

/// One component's model.
#[derive(Debug, Clone)]
pub enum Model {
    /// Table on a pair of bases.
    Matrix(Matrix),
    /// Tensor tree.
    Tree(Tree),
    /// Ideal diffuser.
    Lambertian(Lambertian),
    /// Ideal beam.
    Specular(Specular),
    /// Beam that keeps its disk point, with a value and a standard error for each incident patch.
    Beam(Beam),
    /// Weighted sum.
    Sum(Sum),
    /// Turned or mirrored.
    Turned(Turned),
    /// By reciprocity.
    Reversed(Reversed),
    /// With its through-beam as an explicit peak.
    Separated(Separated),
    /// Between measured incident directions.
    Interpolant(Interpolant),
    /// Scattered light on its way through beams.
    Filtered(Filtered),
}

macro_rules! each {
    ($self:ident, $model:ident => $body:expr) => {
        match $self {
            Model::Matrix($model) => $body,
            Model::Tree($model) => $body,
            Model::Lambertian($model) => $body,
            Model::Specular($model) => $body,
            Model::Beam($model) => $body,
            Model::Sum($model) => $body,
            Model::Turned($model) => $body,
            Model::Reversed($model) => $body,
            Model::Separated($model) => $body,
            Model::Interpolant($model) => $body,
            Model::Filtered($model) => $body,
        }
    };
}

impl Scatterer for Model {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        each!(self, m => m.evaluate(incident, outgoing))
    }

    fn evaluate_all(&self, incident: Disk, outgoing: &[Disk], values: &mut [f64]) {
        each!(self, m => m.evaluate_all(incident, outgoing, values));
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        each!(self, m => m.peaks(incident))
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        each!(self, m => m.sample(incident, u))
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        each!(self, m => m.pdf(incident, outgoing))
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        each!(self, m => m.total(incident, part))
    }

    fn weight(&self, incident: Disk) -> f64 {
        each!(self, m => m.weight(incident))
    }

    fn integrate(&self, incident: Disk, region: &Region, part: Part) -> Estimate {
        each!(self, m => m.integrate(incident, region, part))
    }

    fn resolution(&self, incident: Disk) -> f64 {
        each!(self, m => m.resolution(incident))
    }
}

impl Model {
    /// What kind of model it is, for people.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Matrix(_) => "matrix",
            Self::Tree(_) => "tensor tree",
            Self::Lambertian(_) => "Lambertian",
            Self::Specular(_) => "specular",
            Self::Beam(_) => "beam",
            Self::Sum(_) => "sum",
            Self::Turned(_) => "turned",
            Self::Reversed(_) => "reversed",
            Self::Separated(_) => "separated",
            Self::Interpolant(_) => "interpolant",
            Self::Filtered(_) => "filtered",
        }
    }

    /// All values multiplied by a factor of 0 or more.
    pub fn scaled(&self, factor: f64) -> Result<Self> {
        if !(factor.is_finite() && factor >= 0.0) {
            return Err(Error::Argument(format!(
                "factor {factor} is not a finite number of 0 or more"
            )));
        }
        Ok(match self {
            Self::Matrix(m) => Self::Matrix(m.scaled(|_| factor)),
            Self::Tree(t) => Self::Tree(t.scaled(factor)?),
            Self::Lambertian(l) => Self::Lambertian(Lambertian::new(l.value() * factor)?),
            Self::Specular(Specular::Constant(v)) => Self::Specular(Specular::Constant(v * factor)),
            Self::Specular(Specular::Angular(v)) => {
                Self::Specular(Specular::Angular(v.iter().map(|v| v * factor).collect()))
            }
            Self::Specular(Specular::Cosine(v)) => {
                Self::Specular(Specular::Cosine(v.iter().map(|v| v * factor).collect()))
            }
            Self::Specular(Specular::Patches { basis, values }) => Self::Specular(Specular::Patches {
                basis: basis.clone(),
                values: values.iter().map(|v| v * factor).collect(),
            }),
            Self::Specular(Specular::Pane(..)) | Self::Separated(_) | Self::Interpolant(_) => {
                Self::Sum(Sum::new(vec![(factor, Arc::new(self.clone()))])?)
            }
            Self::Beam(b) => Self::Beam(b.scaled(|_| factor)),
            Self::Sum(s) => Self::Sum(Sum::new(
                s.parts().iter().map(|(w, m)| (w * factor, m.clone())).collect(),
            )?),
            Self::Turned(t) => Self::Turned(Turned::new(Arc::new(t.base().scaled(factor)?), t.turn())),
            Self::Reversed(r) => Self::Reversed(Reversed::new(Arc::new(r.base().scaled(factor)?))),
            Self::Filtered(f) => Self::Filtered(f.with_base(f.base().scaled(factor)?)?),
        })
    }

    /// The same sample, mirrored or turned in its plane; a table of its own where that is exact.
    #[must_use]
    pub fn turned(&self, turn: Turn) -> Self {
        if turn == Turn::NONE {
            return self.clone();
        }
        let exact = match self {
            Self::Matrix(m) => turn_matrix(m, turn).map(Self::Matrix),
            Self::Tree(t) => t.turned(turn).map(Self::Tree),
            Self::Lambertian(_)
            | Self::Specular(Specular::Constant(_) | Specular::Angular(_) | Specular::Cosine(_) | Specular::Pane(..)) => {
                Some(self.clone())
            }
            Self::Beam(b) => b.turned(turn).map(Self::Beam),
            Self::Turned(t) => Some(t.base().turned(turn.after(t.turn()))),
            Self::Sum(s) => Some(Self::Sum(s.map(|m| m.turned(turn)))),
            Self::Interpolant(i) => (i.isotropic() && !turn.mirror()).then(|| self.clone()),
            // Turned tables do not know their totals without sampling: then it is turned as a whole.
            Self::Filtered(f) => f
                .try_map(|m| Ok(m.turned(turn)))
                .ok()
                .filter(|f| {
                    ![f.base(), f.before(), f.after()]
                        .iter()
                        .any(|m| matches!(***m, Self::Turned(_)))
                })
                .map(Self::Filtered),
            Self::Specular(Specular::Patches { .. }) | Self::Reversed(_) | Self::Separated(_) => None,
        };
        exact.unwrap_or_else(|| Self::Turned(Turned::new(Arc::new(self.clone()), turn)))
    }

    /// The model of the reversed paths: the other side's transmission, or the same side's reflection, of a reciprocal
    /// sample.
    #[must_use]
    pub fn reciprocal(&self) -> Self {
        let view = || Self::Reversed(Reversed::new(Arc::new(self.clone())));
        match self {
            Self::Matrix(m) => m.reversed().map_or_else(view, Self::Matrix),
            Self::Tree(t) => t.reversed().map_or_else(view, Self::Tree),
            Self::Lambertian(_)
            | Self::Specular(Specular::Constant(_) | Specular::Angular(_) | Specular::Cosine(_) | Specular::Pane(..)) => {
                self.clone()
            }
            Self::Specular(Specular::Patches { basis, values }) => (0..basis.len())
                .map(|p| basis.reversed(p).map(|q| values[q]))
                .collect::<Option<Vec<_>>>()
                .map_or_else(
                    || self.turned(Turn::new(std::f64::consts::PI, false)),
                    |values| {
                        Self::Specular(Specular::Patches {
                            basis: basis.clone(),
                            values,
                        })
                    },
                ),
            Self::Beam(b) => b
                .reversed()
                .map_or_else(|| self.turned(Turn::new(std::f64::consts::PI, false)), Self::Beam),
            Self::Sum(s) => Self::Sum(s.map(Self::reciprocal)),
            Self::Turned(t) => Self::Turned(Turned::new(Arc::new(t.base().reciprocal()), t.turn())),
            Self::Reversed(r) => (**r.base()).clone(),
            Self::Separated(s) => Self::Separated(s.reciprocal()),
            Self::Interpolant(i) => convert::as_tree(i).reciprocal(),
            Self::Filtered(f) => Self::Filtered(f.reciprocal()),
        }
    }
}

/// A turn that maps patches onto patches, as a permutation.
fn turn_matrix(matrix: &Matrix, turn: Turn) -> Option<Matrix> {
    const STEPS: usize = 360;
    let degrees = turn.angle().to_degrees().rem_euclid(360.0);
    let steps = degrees.round();
    if (degrees - steps).abs() > 1e-9 {
        return None;
    }
    // The source of a patch: turned back, then mirrored back.
    let back = (STEPS - steps as usize) % STEPS;
    let source = |basis: &crate::basis::Basis, patch| {
        let unturned = basis.turned(patch, back, STEPS)?;
        if turn.mirror() {
            basis.mirrored(unturned)
        } else {
            Some(unturned)
        }
    };
    matrix.permuted(|i| source(matrix.incident(), i), |o| source(matrix.outgoing(), o))
}
