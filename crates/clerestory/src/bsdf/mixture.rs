//! Weighted sums of models and of whole bands, for example a solar band from visible and near-infrared measurements.

use std::borrow::Cow;
use std::sync::Arc;

use super::{Band, Beam, Bsdf, Component, Lambertian, Matrix, Model, Specular, Sum, Tree};
use crate::direction::{HEMISPHERE, Scatter, Side};
use crate::error::{Error, Result};

impl Model {
    /// Σ wⱼ fⱼ: a model of the parts' own kind where they are all alike, otherwise a [`Sum`] that keeps each part's resolution.
    ///
    /// A weight may be negative where all parts are matrices on the same bases. Standard errors add as those of independent
    /// values.
    pub fn mixture(parts: &[(f64, Component)]) -> Result<Self> {
        if let Some((w, _)) = parts.iter().find(|(w, _)| !w.is_finite()) {
            return Err(Error::Argument(format!(
                "weight {w} of a mixture is not a finite number"
            )));
        }
        if let Some(matrix) = of_matrices(parts)? {
            return Ok(Self::Matrix(matrix));
        }
        if let Some((w, model)) = parts.iter().find(|(w, _)| *w < 0.0) {
            return Err(Error::Unsupported(format!(
                "a {} model cannot be mixed with the negative weight {w} (convert all parts to matrices on one basis first)",
                model.kind()
            )));
        }
        if let Some(tree) = of_trees(parts)? {
            return Ok(Self::Tree(tree));
        }
        if let Some(beam) = of_beams(parts) {
            return Ok(Self::Beam(beam));
        }
        if let Some(sum) = of_measured(parts)? {
            return Ok(sum);
        }
        of_numbers(parts)?.map_or_else(|| Sum::new(parts.to_vec()).map(Self::Sum), Ok)
    }
}

/// Matrices on equal bases.
fn of_matrices(parts: &[(f64, Component)]) -> Result<Option<Matrix>> {
    let matrices: Option<Vec<(f64, &Matrix)>> = parts
        .iter()
        .map(|(w, model)| match &**model {
            Model::Matrix(m) => Some((*w, m)),
            _ => None,
        })
        .collect();
    let Some(matrices) = matrices else { return Ok(None) };
    let Some((_, first)) = matrices.first() else {
        return Ok(None);
    };
    if matrices
        .iter()
        .any(|(_, m)| m.incident() != first.incident() || m.outgoing() != first.outgoing())
    {
        return Ok(None);
    }
    let mut values = vec![0.0; first.values().len()];
    let mut variance: Option<Vec<f64>> = None;
    for (w, matrix) in &matrices {
        for (sum, v) in values.iter_mut().zip(matrix.values()) {
            *sum += w * v;
        }
        if let Some(errors) = matrix.standard_errors() {
            let sums = variance.get_or_insert_with(|| vec![0.0; errors.len()]);
            for (sum, e) in sums.iter_mut().zip(errors) {
                *sum += (w * e).powi(2);
            }
        }
    }
    let mixed = Matrix::new(first.incident().clone(), first.outgoing().clone(), values)?;
    let Some(variance) = variance else {
        return Ok(Some(mixed));
    };
    let mixed = mixed.with_standard_errors(variance.into_iter().map(f64::sqrt).collect())?;
    let totals: Option<Vec<(f64, &[f64])>> = matrices
        .iter()
        .map(|(w, m)| m.total_standard_errors().map(|e| (*w, e)))
        .collect();
    match totals {
        Some(totals) => {
            let error = |i: usize| totals.iter().map(|(w, e)| (w * e[i]).powi(2)).sum::<f64>().sqrt();
            let errors = (0..first.incident().len()).map(error).collect();
            mixed.with_total_standard_errors(errors).map(Some)
        }
        None => Ok(Some(mixed)),
    }
}

/// Beams on the same cells.
fn of_beams(parts: &[(f64, Component)]) -> Option<Beam> {
    let beams: Option<Vec<(f64, &Beam)>> = parts
        .iter()
        .map(|(w, model)| match &**model {
            Model::Beam(b) => Some((*w, b)),
            _ => None,
        })
        .collect();
    Beam::mixture(&beams?)
}

/// Measured light, a matrix or tree and a beam each: scattered light with scattered light, beams with beams.
fn of_measured(parts: &[(f64, Component)]) -> Result<Option<Model>> {
    let (mut scattered, mut beams) = (Vec::new(), Vec::new());
    for (w, model) in parts {
        let inner = match &**model {
            Model::Sum(sum) => sum.parts().to_vec(),
            _ => vec![(1.0, model.clone())],
        };
        for (v, part) in inner {
            match &*part {
                Model::Matrix(_) | Model::Tree(_) => scattered.push((w * v, part)),
                Model::Beam(_) => beams.push((w * v, part)),
                _ => return Ok(None),
            }
        }
    }
    if scattered.is_empty() || beams.is_empty() {
        return Ok(None);
    }
    let (scattered, beams) = (Model::mixture(&scattered)?, Model::mixture(&beams)?);
    Sum::new(vec![(1.0, Arc::new(scattered)), (1.0, Arc::new(beams))]).map(|sum| Some(Model::Sum(sum)))
}

/// Tensor trees of one rank, with or without diffusers.
fn of_trees(parts: &[(f64, Component)]) -> Result<Option<Tree>> {
    let rank = parts.iter().find_map(|(_, model)| match &**model {
        Model::Tree(tree) => Some(tree.rank()),
        _ => None,
    });
    let Some(rank) = rank else { return Ok(None) };
    let mut trees = Vec::with_capacity(parts.len());
    for (w, model) in parts {
        let tree = match &**model {
            Model::Tree(tree) if tree.rank() == rank => Cow::Borrowed(tree),
            Model::Lambertian(diffuse) => Cow::Owned(Tree::constant(rank, (diffuse.value() / HEMISPHERE) as f32)?),
            _ => return Ok(None),
        };
        trees.push((*w, tree));
    }
    let parts: Vec<(f64, &Tree)> = trees.iter().map(|(w, tree)| (*w, &**tree)).collect();
    Tree::mixture(&parts).map(Some)
}

/// Diffusers, or ideal beams of one value.
fn of_numbers(parts: &[(f64, Component)]) -> Result<Option<Model>> {
    let sum = |value: fn(&Model) -> Option<f64>| -> Option<f64> {
        let values: Option<Vec<f64>> = parts.iter().map(|(w, m)| value(m).map(|v| w * v)).collect();
        values.filter(|v| !v.is_empty()).map(|v| v.iter().sum())
    };
    let diffuse = sum(|m| match m {
        Model::Lambertian(l) => Some(l.value()),
        _ => None,
    });
    if let Some(value) = diffuse {
        return Lambertian::new(value).map(|l| Some(Model::Lambertian(l)));
    }
    let beam = sum(|m| match m {
        Model::Specular(Specular::Constant(v)) => Some(*v),
        _ => None,
    });
    beam.map(|v| Specular::constant(v).map(Model::Specular)).transpose()
}

impl Bsdf {
    /// With a band that is a weighted sum of others; it replaces one of the same name. A component that only some of the
    /// bands have is an error; transmission may come from the other side by reciprocity.
    ///
    /// Negative values, which negative weights can lead to, are kept and named in the warnings.
    pub fn with_mixture(&self, name: &str, parts: &[(&str, f64)]) -> Result<Self> {
        if parts.is_empty() {
            return Err(Error::Argument(format!(
                "band {name:?} needs one band or more to be mixed of"
            )));
        }
        let mut band = Band::new(name.to_ascii_lowercase());
        let mut warnings = Vec::new();
        for side in Side::BOTH {
            for scatter in Scatter::BOTH {
                let mut held = false;
                for (source, _) in parts {
                    held |= self.band(Some(source))?.get(side, scatter).is_some();
                }
                if !held {
                    continue;
                }
                let components = parts
                    .iter()
                    .map(|(source, w)| Ok((*w, self.component(Some(source), side, scatter)?.component)))
                    .collect::<Result<Vec<_>>>()?;
                let model = Model::mixture(&components)?;
                warnings.extend(negatives(&model).map(|what| {
                    format!(
                        "band {name:?}, {} for light from the {}: {what}",
                        scatter.name(),
                        side.name()
                    )
                }));
                band.set(side, scatter, Some(Arc::new(model)));
            }
        }
        let mut result = self.with_band(band)?;
        result.warnings.extend(warnings);
        Ok(result)
    }

    /// With a near-infrared band from the solar and the visible one: (solar − r·visible) / (1 − r), where r is the visible
    /// share of the solar spectrum (0.499 in Windows-CalcEngine).
    pub fn with_near_infrared(&self, visible_share: f64) -> Result<Self> {
        if !(0.0..1.0).contains(&visible_share) {
            return Err(Error::Argument(format!(
                "{visible_share} is not a visible share of the solar spectrum (give a number from 0 to less than 1)"
            )));
        }
        let rest = 1.0 - visible_share;
        self.with_mixture("nir", &[("solar", 1.0 / rest), ("visible", -visible_share / rest)])
    }
}

/// Negative values of a matrix, in words.
fn negatives(model: &Model) -> Option<String> {
    let Model::Matrix(matrix) = model else { return None };
    let below: Vec<f64> = matrix.values().iter().copied().filter(|v| *v < 0.0).collect();
    let least = below.iter().copied().fold(0.0, f64::min);
    (!below.is_empty()).then(|| {
        format!(
            "{} of {} values are negative, the least {least:.3e}/sr; they count as zero in every result",
            below.len(),
            matrix.values().len()
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::{Metadata, Part, Rank, Scatterer};
    use crate::direction::Disk;

    fn quarter() -> Arc<Basis> {
        Arc::new(Basis::klems_quarter())
    }

    fn table(value: f64, error: f64) -> Component {
        let matrix = Matrix::from_fn(quarter(), quarter(), |i, o| value * (1 + (i + o) % 3) as f64).unwrap();
        Arc::new(Model::Matrix(
            matrix.with_standard_errors(vec![error; 41 * 41]).unwrap(),
        ))
    }

    fn diffuse(value: f64) -> Component {
        Arc::new(Model::Lambertian(Lambertian::new(value).unwrap()))
    }

    #[test]
    fn like_kinds_stay_what_they_are() {
        let Model::Matrix(m) = Model::mixture(&[(0.5, table(0.1, 0.03)), (2.0, table(0.2, 0.01))]).unwrap() else {
            panic!("a matrix")
        };
        assert!((m.values()[0] - 0.45).abs() < 1e-12);
        assert!((m.standard_errors().unwrap()[7] - 0.025).abs() < 1e-12);
        let mixed = Model::mixture(&[(0.5, diffuse(0.2)), (0.5, diffuse(0.4))]).unwrap();
        assert!(matches!(mixed, Model::Lambertian(l) if (l.value() - 0.3).abs() < 1e-12));
        let beam = Arc::new(Model::Specular(Specular::constant(0.4).unwrap()));
        let mixed = Model::mixture(&[(0.5, beam.clone()), (0.25, beam.clone())]).unwrap();
        assert!((mixed.total(Disk::NORMAL, Part::Direct).value - 0.3).abs() < 1e-12);
        let mixed = Model::mixture(&[(0.5, beam), (0.5, table(0.1, 0.0))]).unwrap();
        assert_eq!(mixed.kind(), "sum");
    }

    #[test]
    fn trees_and_diffusers_make_a_tree() {
        let tree = |rank, value| Arc::new(Model::Tree(Tree::constant(rank, value).unwrap()));
        let (iso, aniso) = (tree(Rank::Isotropic, 0.1), tree(Rank::Anisotropic, 0.3));
        let mixed = Model::mixture(&[(0.5, aniso.clone()), (0.5, diffuse(0.2))]).unwrap();
        assert_eq!(mixed.kind(), "tensor tree");
        let exact = 0.15 + 0.1 / std::f64::consts::PI;
        assert!((mixed.evaluate(Disk::NORMAL, Disk::NORMAL) - exact).abs() < 1e-7);
        assert_eq!(Model::mixture(&[(0.5, aniso), (0.5, iso)]).unwrap().kind(), "sum");
    }

    #[test]
    fn negative_weights_need_matrices() {
        assert!(Model::mixture(&[(1.0, table(0.3, 0.0)), (-0.5, table(0.1, 0.0))]).is_ok());
        let error = Model::mixture(&[(1.0, diffuse(0.3)), (-0.5, diffuse(0.1))]).unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)), "{error}");
        assert!(Model::mixture(&[(f64::NAN, diffuse(0.3))]).is_err());
        assert!(Model::mixture(&[]).is_err());
    }

    fn bands(solar: f64) -> Bsdf {
        let band = |name: &str, value: f64| {
            let mut band = Band::new(name);
            band.set(Side::Exterior, Scatter::Transmission, Some(table(value, 0.0)));
            band
        };
        Bsdf::new(vec![band("visible", 0.1), band("solar", solar)], Metadata::default()).unwrap()
    }

    #[test]
    fn near_infrared_undoes_the_solar_mixture() {
        let with_nir = bands(0.08).with_near_infrared(0.499).unwrap();
        assert!(with_nir.warnings.is_empty());
        let again = with_nir
            .with_mixture("solar", &[("visible", 0.499), ("nir", 0.501)])
            .unwrap();
        let value = |b: &Bsdf| {
            let band = b.band(Some("solar")).unwrap();
            let model = band.get(Side::Exterior, Scatter::Transmission).unwrap();
            model.evaluate(Disk::NORMAL, Disk::NORMAL)
        };
        assert!((value(&again) - 0.08).abs() < 1e-12);
        assert_eq!(again.bands().len(), 3);
    }

    #[test]
    fn negative_results_are_kept_and_named() {
        let result = bands(0.02).with_near_infrared(0.499).unwrap();
        assert_eq!(result.warnings.len(), 1);
        assert!(
            result.warnings[0].contains("1681 of 1681 values are negative"),
            "{}",
            result.warnings[0]
        );
    }

    #[test]
    fn a_component_that_one_band_lacks_is_an_error() {
        let mut band = Band::new("nir");
        band.set(Side::Interior, Scatter::Reflection, Some(diffuse(0.3)));
        let set = bands(0.1).with_band(band).unwrap();
        let error = set.with_mixture("all", &[("visible", 0.5), ("nir", 0.5)]).unwrap_err();
        assert!(matches!(error, Error::Missing(_)), "{error}");
        assert!(set.with_mixture("all", &[("infra", 0.5)]).is_err());
    }
}
