//! Models taken apart into numbers, bases, arrays and other models, and put together again: what Clerestory's own file holds.

use std::sync::Arc;

use super::interpolant::{Method, Stored};
use super::{
    Beam, Cells, Component, Filtered, Interpolant, Lambertian, Matrix, Model, Rank, Reversed, Separated, Slab,
    Specular, Sum, Tree, Turn, Turned,
};
use crate::basis::Basis;
use crate::direction::Scatter;
use crate::error::{Error, Result};

/// Values of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum Array {
    /// 64-bit numbers.
    Floats(Vec<f64>),
    /// Entries of a tensor tree's storage.
    Entries(Vec<u32>),
}

/// A model in parts.
#[derive(Debug, Clone)]
pub struct Parts {
    /// One of [`Parts::KINDS`].
    pub kind: String,
    /// Single numbers by name. All are exact in 64 bits.
    pub numbers: Vec<(String, f64)>,
    /// Angle bases: incident, then outgoing.
    pub bases: Vec<Arc<Basis>>,
    /// Arrays by name.
    pub arrays: Vec<(String, Array)>,
    /// Models that it is made of.
    pub models: Vec<Component>,
}

impl Parts {
    /// Kinds of models.
    pub const KINDS: [&'static str; 16] = [
        "matrix",
        "tree",
        "lambertian",
        "specular",
        "specular-angular",
        "specular-cosine",
        "specular-patches",
        "pane",
        "beam",
        "beam-cells",
        "sum",
        "turned",
        "reversed",
        "separated",
        "filtered",
        "interpolant",
    ];

    fn of(kind: &str) -> Self {
        Self {
            kind: kind.into(),
            numbers: Vec::new(),
            bases: Vec::new(),
            arrays: Vec::new(),
            models: Vec::new(),
        }
    }

    fn number(mut self, name: &str, value: f64) -> Self {
        self.numbers.push((name.into(), value));
        self
    }

    fn floats(mut self, name: &str, values: &[f64]) -> Self {
        self.arrays.push((name.into(), Array::Floats(values.to_vec())));
        self
    }

    fn entries(mut self, name: &str, values: Vec<u32>) -> Self {
        self.arrays.push((name.into(), Array::Entries(values)));
        self
    }

    fn with_bases(mut self, bases: &[&Arc<Basis>]) -> Self {
        self.bases = bases.iter().map(|&b| b.clone()).collect();
        self
    }

    fn with_models(mut self, models: impl IntoIterator<Item = Component>) -> Self {
        self.models = models.into_iter().collect();
        self
    }

    fn get_number(&self, name: &str) -> Result<f64> {
        let number = self.numbers.iter().find(|(n, _)| n == name);
        number
            .map(|(_, v)| *v)
            .ok_or_else(|| self.broken(&format!("the number {name:?} is missing")))
    }

    fn get_flag(&self, name: &str) -> Result<bool> {
        match self.get_number(name)? {
            0.0 => Ok(false),
            1.0 => Ok(true),
            other => Err(self.broken(&format!("{name:?} is {other}, not 0 or 1"))),
        }
    }

    fn get_floats(&self, name: &str) -> Result<Option<Vec<f64>>> {
        match self.arrays.iter().find(|(n, _)| n == name) {
            None => Ok(None),
            Some((_, Array::Floats(v))) => Ok(Some(v.clone())),
            Some(_) => Err(self.broken(&format!("the array {name:?} is not one of 64-bit floats"))),
        }
    }

    fn floats_there(&self, name: &str) -> Result<Vec<f64>> {
        self.get_floats(name)?
            .ok_or_else(|| self.broken(&format!("the array {name:?} is missing")))
    }

    fn entries_there(&self, name: &str) -> Result<Vec<u32>> {
        match self.arrays.iter().find(|(n, _)| n == name) {
            Some((_, Array::Entries(v))) => Ok(v.clone()),
            Some(_) => Err(self.broken(&format!("the array {name:?} is not one of 32-bit entries"))),
            None => Err(self.broken(&format!("the array {name:?} is missing"))),
        }
    }

    fn get_basis(&self, index: usize) -> Result<Arc<Basis>> {
        let basis = self.bases.get(index).cloned();
        basis.ok_or_else(|| self.broken(&format!("{} angle bases are too few", self.bases.len())))
    }

    fn get_rank(&self) -> Result<Rank> {
        match self.get_number("rank")? {
            3.0 => Ok(Rank::Isotropic),
            4.0 => Ok(Rank::Anisotropic),
            other => Err(self.broken(&format!("its rank is {other}, not 3 or 4"))),
        }
    }

    fn matrix(&self) -> Result<Matrix> {
        let values = self.floats_there("values")?;
        let matrix = Matrix::new(self.get_basis(0)?, self.get_basis(1)?, values)?;
        let matrix = match self.get_floats("standard_errors")? {
            Some(errors) => matrix.with_standard_errors(errors)?,
            None => matrix,
        };
        match self.get_floats("total_standard_errors")? {
            Some(errors) => matrix.with_total_standard_errors(errors),
            None => Ok(matrix),
        }
    }

    fn interpolant(&self) -> Result<Interpolant> {
        let number = self.get_number("method")?;
        let method = Method::ALL.into_iter().find(|&m| number == f64::from(m as u8));
        Interpolant::from_stored(&Stored {
            method: method.ok_or_else(|| self.broken(&format!("its method is {number}")))?,
            isotropic: self.get_flag("isotropic")?,
            distributions: self.floats_there("distributions")?,
            lobes: self.floats_there("lobes")?,
            covered: self.entries_there("covered")?,
            edges: self.entries_there("edges")?,
            fluxes: self.floats_there("fluxes")?,
        })
    }

    fn beam(&self, cells: Cells) -> Result<Beam> {
        let beam = Beam::new(cells, self.floats_there("values")?)?;
        match self.get_floats("standard_errors")? {
            Some(errors) => beam.with_standard_errors(errors),
            None => Ok(beam),
        }
    }

    fn one_model(&self) -> Result<Component> {
        match self.models.as_slice() {
            [model] => Ok(model.clone()),
            other => Err(self.broken(&format!("it is made of {} models, not of one", other.len()))),
        }
    }

    fn broken(&self, what: &str) -> Error {
        Error::Argument(format!("a {:?} model cannot be put together: {what}", self.kind))
    }
}

impl Model {
    /// Taken apart.
    pub fn to_parts(&self) -> Parts {
        match self {
            Self::Matrix(m) => {
                let parts = Parts::of("matrix")
                    .with_bases(&[m.incident(), m.outgoing()])
                    .floats("values", m.values());
                let parts = match m.standard_errors() {
                    Some(errors) => parts.floats("standard_errors", errors),
                    None => parts,
                };
                match m.total_standard_errors() {
                    Some(errors) => parts.floats("total_standard_errors", errors),
                    None => parts,
                }
            }
            Self::Tree(t) => {
                let mut parts = Parts::of("tree")
                    .number("rank", f64::from(t.rank().axes()))
                    .number("root", f64::from(t.root()));
                parts
                    .arrays
                    .push(("entries".into(), Array::Entries(t.entries().to_vec())));
                if let Some((root, errors)) = t.standard_errors() {
                    let all = std::iter::once(&root).chain(errors).map(|e| e.to_bits()).collect();
                    parts.arrays.push(("standard_error_bits".into(), Array::Entries(all)));
                }
                parts
            }
            Self::Lambertian(l) => Parts::of("lambertian").number("value", l.value()),
            Self::Specular(Specular::Constant(value)) => Parts::of("specular").number("value", *value),
            Self::Specular(Specular::Angular(values)) => Parts::of("specular-angular").floats("values", values),
            Self::Specular(Specular::Cosine(values)) => Parts::of("specular-cosine").floats("values", values),
            Self::Specular(Specular::Patches { basis, values }) => Parts::of("specular-patches")
                .with_bases(&[basis])
                .floats("values", values),
            Self::Specular(Specular::Pane(slab, scatter)) => Parts::of("pane")
                .number("refractive_index", slab.index())
                .number("internal_transmittance", slab.internal())
                .number("reflected", f64::from(u8::from(*scatter == Scatter::Reflection))),
            Self::Beam(b) => {
                let parts = match b.cells() {
                    Cells::Patches(basis) => Parts::of("beam").with_bases(&[basis]),
                    Cells::Tree(rank, levels) => Parts::of("beam-cells")
                        .number("rank", f64::from(rank.axes()))
                        .number("levels", f64::from(*levels)),
                };
                let parts = parts.floats("values", b.values());
                match b.standard_errors() {
                    Some(errors) => parts.floats("standard_errors", errors),
                    None => parts,
                }
            }
            Self::Sum(s) => {
                let weights: Vec<f64> = s.parts().iter().map(|(w, _)| *w).collect();
                Parts::of("sum")
                    .floats("weights", &weights)
                    .with_models(s.parts().iter().map(|(_, m)| m.clone()))
            }
            Self::Turned(t) => Parts::of("turned")
                .number("angle", t.turn().angle())
                .number("mirrored", f64::from(u8::from(t.turn().mirror())))
                .with_models([t.base().clone()]),
            Self::Reversed(r) => Parts::of("reversed").with_models([r.base().clone()]),
            Self::Separated(s) => Parts::of("separated").with_models([s.base().clone()]),
            Self::Interpolant(i) => {
                let stored = i.stored();
                Parts::of("interpolant")
                    .number("method", f64::from(stored.method as u8))
                    .number("isotropic", f64::from(u8::from(stored.isotropic)))
                    .floats("distributions", &stored.distributions)
                    .floats("lobes", &stored.lobes)
                    .entries("covered", stored.covered)
                    .entries("edges", stored.edges)
                    .floats("fluxes", &stored.fluxes)
            }
            Self::Filtered(f) => {
                Parts::of("filtered").with_models([f.base().clone(), f.before().clone(), f.after().clone()])
            }
        }
    }

    /// Put together; fails where a part is missing or does not fit.
    pub fn from_parts(parts: &Parts) -> Result<Self> {
        Ok(match parts.kind.as_str() {
            "matrix" => Self::Matrix(parts.matrix()?),
            "tree" => {
                let rank = parts.get_rank()?;
                let root = parts.get_number("root")?;
                if !(root.fract() == 0.0 && (0.0..=f64::from(u32::MAX)).contains(&root)) {
                    return Err(parts.broken("its root is not an entry"));
                }
                let Some((_, Array::Entries(entries))) = parts.arrays.iter().find(|(n, _)| n == "entries") else {
                    return Err(parts.broken("the array \"entries\" is missing or not one of 32-bit entries"));
                };
                let tree = Tree::from_entries(rank, root as u32, entries.clone())?;
                let errors = parts.arrays.iter().find(|(n, _)| n == "standard_error_bits");
                Self::Tree(match errors {
                    None => tree,
                    Some((_, Array::Entries(bits))) if !bits.is_empty() => {
                        let errors = bits[1..].iter().map(|&e| f32::from_bits(e)).collect();
                        tree.with_standard_errors(f32::from_bits(bits[0]), errors)?
                    }
                    Some(_) => {
                        return Err(parts.broken("the array \"standard_error_bits\" is not one of 32-bit entries"));
                    }
                })
            }
            "lambertian" => Self::Lambertian(Lambertian::new(parts.get_number("value")?)?),
            "specular" => Self::Specular(Specular::constant(parts.get_number("value")?)?),
            "specular-angular" => Self::Specular(Specular::angular(parts.floats_there("values")?)?),
            "specular-cosine" => Self::Specular(Specular::cosine(parts.floats_there("values")?)?),
            "specular-patches" => {
                Self::Specular(Specular::patches(parts.get_basis(0)?, parts.floats_there("values")?)?)
            }
            "pane" => {
                let slab = Slab::new(
                    parts.get_number("refractive_index")?,
                    parts.get_number("internal_transmittance")?,
                )?;
                let scatter = if parts.get_flag("reflected")? {
                    Scatter::Reflection
                } else {
                    Scatter::Transmission
                };
                Self::Specular(Specular::Pane(slab, scatter))
            }
            "beam" => Self::Beam(parts.beam(Cells::Patches(parts.get_basis(0)?))?),
            "beam-cells" => {
                let levels = parts.get_number("levels")?;
                if !(levels.fract() == 0.0 && (0.0..=10.0).contains(&levels)) {
                    return Err(parts.broken(&format!("its levels are {levels}, not a whole number up to 10")));
                }
                Self::Beam(parts.beam(Cells::Tree(parts.get_rank()?, levels as u32))?)
            }
            "sum" => {
                let weights = parts.floats_there("weights")?;
                if weights.len() != parts.models.len() {
                    return Err(parts.broken(&format!("{} weights for {} models", weights.len(), parts.models.len())));
                }
                Self::Sum(Sum::new(
                    weights.into_iter().zip(parts.models.iter().cloned()).collect(),
                )?)
            }
            "turned" => {
                let angle = parts.get_number("angle")?;
                if !angle.is_finite() {
                    return Err(parts.broken(&format!("its angle is {angle}")));
                }
                let turn = Turn::new(angle, parts.get_flag("mirrored")?);
                Self::Turned(Turned::new(parts.one_model()?, turn))
            }
            "reversed" => Self::Reversed(Reversed::new(parts.one_model()?)),
            "separated" => Self::Separated(Separated::new(parts.one_model()?)?),
            "interpolant" => Self::Interpolant(parts.interpolant()?),
            "filtered" => match parts.models.as_slice() {
                [base, before, after] => Self::Filtered(Filtered::new(base.clone(), before.clone(), after.clone())?),
                other => return Err(parts.broken(&format!("it is made of {} models, not of three", other.len()))),
            },
            other => {
                return Err(Error::Argument(format!(
                    "{other:?} is not a kind of model (known: {})",
                    Parts::KINDS.join(", ")
                )));
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Scatterer, Turn};
    use crate::direction::Disk;
    use crate::sequence::uniform;

    fn all_kinds() -> Vec<Model> {
        let basis = Arc::new(Basis::klems_quarter());
        let matrix = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| uniform(1, (i * 41 + o) as u64)).unwrap();
        let errors = (0..41 * 41).map(|k| uniform(2, k)).collect();
        let matrix = matrix.with_standard_errors(errors).unwrap();
        let totals = (0..41).map(|k| uniform(4, k)).collect();
        let matrix = Model::Matrix(matrix.with_total_standard_errors(totals).unwrap());
        let tree = Tree::constant(Rank::Isotropic, 0.25).unwrap();
        let shared = Arc::new(matrix.clone());
        let beam = Beam::new(Cells::Patches(basis.clone()), vec![0.25; 41]).unwrap();
        let pass = Arc::new(Model::Specular(Specular::cosine(vec![0.0, 0.8, 0.9]).unwrap()));
        vec![
            matrix,
            Model::Tree(tree),
            Model::Lambertian(Lambertian::new(0.1).unwrap()),
            Model::Specular(Specular::constant(0.7).unwrap()),
            Model::Specular(Specular::angular(vec![0.9, 0.8, 0.0]).unwrap()),
            Model::Specular(Specular::cosine(vec![0.0, 0.7, 0.9]).unwrap()),
            Model::Specular(Specular::patches(basis, (0..41).map(|k| uniform(3, k)).collect()).unwrap()),
            Model::Specular(Specular::Pane(Slab::new(1.52, 0.98).unwrap(), Scatter::Reflection)),
            Model::Beam(beam.clone().with_standard_errors(vec![0.1; 41]).unwrap()),
            Model::Beam(Beam::new(Cells::Tree(Rank::Anisotropic, 1), vec![0.1, 0.2, 0.3, 0.4]).unwrap()),
            Model::Sum(Sum::new(vec![(0.3, shared.clone()), (0.2, shared.clone())]).unwrap()),
            Model::Turned(Turned::new(shared.clone(), Turn::new(0.123_456_789, true))),
            Model::Reversed(Reversed::new(shared.clone())),
            Model::Separated(Separated::new(shared.clone()).unwrap()),
            Model::Filtered(Filtered::new(shared, pass.clone(), pass).unwrap()),
            interpolant(),
        ]
    }

    fn interpolant() -> Model {
        use crate::bsdf::interpolant::{Method, Points, Symmetry, fit};
        use crate::progress::Progress;
        let measured = [0.2, 0.7].map(|theta| {
            let outgoing: Vec<Disk> = (0..200)
                .map(|k| Disk::uniform(crate::sequence::r2(k, [0.0; 2])))
                .collect();
            let values: Vec<f64> = outgoing.iter().map(|o| 0.1 + 0.2 * o.x.max(0.0)).collect();
            let points = Points {
                outgoing: &outgoing,
                values: &values,
                errors: &[1e-3; 200],
            };
            fit(Disk::from_angles(theta, 0.0), &points).unwrap()
        });
        let model = Interpolant::new(&measured, Symmetry::Isotropic, Method::Transport, &Progress::default());
        Model::Interpolant(model.unwrap())
    }

    #[test]
    fn every_kind_is_put_together_as_it_was() {
        let kinds: Vec<String> = all_kinds().iter().map(|m| m.to_parts().kind).collect();
        assert_eq!(kinds, Parts::KINDS);
        for model in all_kinds() {
            let again = Model::from_parts(&model.to_parts()).unwrap();
            assert_eq!(format!("{model:?}"), format!("{again:?}"));
            let (i, o) = (Disk::new(0.3, -0.2), Disk::new(-0.5, 0.4));
            assert_eq!(model.evaluate(i, o), again.evaluate(i, o));
        }
    }

    #[test]
    fn what_is_missing_or_does_not_fit_is_refused() {
        for model in all_kinds() {
            let parts = model.to_parts();
            let mut broken = Vec::new();
            if !parts.numbers.is_empty() {
                broken.push(Parts {
                    numbers: Vec::new(),
                    ..parts.clone()
                });
                let numbers = parts.numbers.iter().map(|(n, _)| (n.clone(), f64::NAN)).collect();
                broken.push(Parts {
                    numbers,
                    ..parts.clone()
                });
            }
            if !parts.bases.is_empty() {
                broken.push(Parts {
                    bases: Vec::new(),
                    ..parts.clone()
                });
            }
            if !parts.arrays.is_empty() {
                broken.push(Parts {
                    arrays: Vec::new(),
                    ..parts.clone()
                });
                let swap = |(n, a): &(String, Array)| {
                    let other = match a {
                        Array::Floats(_) => Array::Entries(vec![0]),
                        Array::Entries(_) => Array::Floats(vec![0.0]),
                    };
                    (n.clone(), other)
                };
                broken.push(Parts {
                    arrays: parts.arrays.iter().map(swap).collect(),
                    ..parts.clone()
                });
            }
            if !parts.models.is_empty() {
                broken.push(Parts {
                    models: Vec::new(),
                    ..parts.clone()
                });
            }
            broken.push(Parts {
                kind: "fabric".into(),
                ..parts.clone()
            });
            for parts in broken {
                assert!(Model::from_parts(&parts).is_err(), "{parts:?}");
            }
        }
    }
}
