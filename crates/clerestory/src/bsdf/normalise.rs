//! Models scaled to known direct-hemispherical values, for example those of an integrating sphere.

use std::sync::Arc;

use super::{Bsdf, Cells, Matrix, Model, Part, Scatterer, Separated, Specular, Sum};
use crate::basis::Basis;
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};
use crate::sequence::r2;

/// Points of a patch over which the direct-hemispherical value of a model that is not a matrix is averaged.
const POINTS: u32 = 256;
/// Corrections of a tree's factors at most.
const ROUNDS: usize = 6;
/// Relative error at which they are good enough.
const SETTLED: f64 = 1e-4;
/// Incident cells an axis in which factors of a tree are told apart, at least 2^this: fine enough for the narrow outer
/// rings of the Klems bases.
const LEAST_LEVELS: u32 = 6;
/// At most 2^this, for the size of the result.
const MOST_LEVELS: u32 = 7;

/// `model` with the direct-hemispherical value `values[k]` (all light, peaks too) for each patch `k` of `basis`.
///
/// [`Part::All`] scales all light alike; [`Part::Scattered`] keeps the peaks and scales the rest; [`Part::Direct`] keeps the
/// scattered light and scales the peaks.
pub fn normalise(model: &Model, basis: &Arc<Basis>, values: &[f64], part: Part) -> Result<Model> {
    if values.len() != basis.len() {
        return Err(Error::Argument(format!(
            "{} direct-hemispherical values for {} patches of {}",
            values.len(),
            basis.len(),
            basis.name()
        )));
    }
    if let Some(v) = values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        return Err(Error::Argument(format!(
            "{v} is not a direct-hemispherical value (give a number from 0 to 1)"
        )));
    }
    let parts = |model: &Model, patch: usize| {
        let mean = |part| mean_total(model, basis, patch, part);
        match part {
            Part::All => (mean(Part::All), 0.0),
            Part::Scattered => (mean(Part::Scattered), mean(Part::Direct)),
            Part::Direct => (mean(Part::Direct), mean(Part::Scattered)),
        }
    };
    let mut factors = (0..basis.len())
        .map(|patch| {
            let (scaled, kept) = parts(model, patch);
            factor(values[patch], scaled, kept).map_err(|why| {
                Error::Argument(format!(
                    "incident patch {} of {} cannot be scaled to {}: {why}",
                    patch + 1,
                    basis.name(),
                    values[patch]
                ))
            })
        })
        .collect::<Result<Vec<f64>>>()?;
    let mut result = scale(model, basis, &factors, part)?;
    // A tree's cells lie across the borders of the patches: a few rounds settle what that mixes.
    for _ in 0..ROUNDS {
        let mut worst = 0.0_f64;
        for (patch, factor) in factors.iter_mut().enumerate() {
            let (scaled, kept) = parts(&result, patch);
            if *factor > 0.0 && scaled > 0.0 {
                let ratio = (values[patch] - kept) / scaled;
                worst = worst.max((ratio - 1.0).abs());
                *factor *= ratio;
            }
        }
        if worst < SETTLED {
            break;
        }
        result = scale(model, basis, &factors, part)?;
    }
    Ok(result)
}

fn factor(value: f64, scaled: f64, kept: f64) -> std::result::Result<f64, String> {
    let wanted = value - kept;
    if wanted < -1e-9 {
        return Err(format!(
            "the part that is kept has {kept} already (give a larger value)"
        ));
    }
    if wanted <= 0.0 {
        return Ok(0.0);
    }
    if scaled <= 0.0 {
        return Err("it has no light that could be scaled (leave it at 0, or give data for it)".into());
    }
    Ok(wanted / scaled)
}

fn mean_total(model: &Model, basis: &Basis, patch: usize, part: Part) -> f64 {
    if let Model::Matrix(m) = model
        && **m.incident() == *basis
    {
        return if part == Part::Direct {
            0.0
        } else {
            m.direct_hemispherical(patch)
        };
    }
    let total = |k| model.total(basis.sample_cosine(patch, r2(k, [0.5; 2])), part).value;
    (0..POINTS).map(total).sum::<f64>() / f64::from(POINTS)
}

/// All light, or one part of it, multiplied by a factor for each incident patch.
fn scale(model: &Model, basis: &Arc<Basis>, factors: &[f64], part: Part) -> Result<Model> {
    let even = factors.iter().all(|f| (f - factors[0]).abs() <= 1e-12 * factors[0]);
    Ok(match model {
        Model::Sum(sum) => {
            let parts = sum
                .parts()
                .iter()
                .map(|(w, m)| Ok((*w, Arc::new(scale(m, basis, factors, part)?))))
                .collect::<Result<_>>()?;
            Model::Sum(Sum::new(parts)?)
        }
        Model::Specular(_) | Model::Beam(_) if part == Part::Scattered => model.clone(),
        Model::Matrix(_) | Model::Tree(_) | Model::Lambertian(_) if part == Part::Direct => model.clone(),
        Model::Separated(s) if part == Part::All => {
            Model::Separated(Separated::new(Arc::new(scale(s.base(), basis, factors, part)?))?)
        }
        _ if even
            && !matches!(
                model,
                Model::Turned(_) | Model::Reversed(_) | Model::Separated(_) | Model::Interpolant(_)
            ) =>
        {
            model.scaled(factors[0])?
        }
        Model::Matrix(m) if m.incident() == basis => Model::Matrix(m.scaled(|i| factors[i])),
        Model::Beam(b) if *b.cells() == Cells::Patches(basis.clone()) => Model::Beam(b.scaled(|i| factors[i])),
        Model::Specular(_) | Model::Beam(_) => {
            let value = |patch: usize| factors[patch] * mean_total(model, basis, patch, Part::Direct);
            Model::Specular(Specular::patches(basis.clone(), (0..basis.len()).map(value).collect())?)
        }
        // A diffuser of a value for each incident patch is a table of one value a column.
        Model::Lambertian(l) => Model::Matrix(Matrix::from_fn(basis.clone(), basis.clone(), |i, _| {
            l.value() * factors[i] / std::f64::consts::PI
        })?),
        Model::Tree(t) => {
            let levels = (t.depth() + 1).clamp(LEAST_LEVELS, MOST_LEVELS);
            Model::Tree(t.times_incident(levels, |point| factors[basis.patch_of(point)])?)
        }
        Model::Matrix(m) => {
            return Err(Error::Unsupported(format!(
                "a matrix of {} cannot be scaled by patches of {} (convert it to that basis first, or give values for its own)",
                m.incident().name(),
                basis.name()
            )));
        }
        Model::Turned(_) | Model::Reversed(_) | Model::Separated(_) | Model::Filtered(_) | Model::Interpolant(_) => {
            return Err(Error::Unsupported(format!(
                "a {} model cannot be scaled by incident patches (convert it to a matrix first)",
                model.kind()
            )));
        }
    })
}

/// One component of a data set normalised.
pub fn normalise_component(
    bsdf: &Bsdf,
    band: Option<&str>,
    side: Side,
    scatter: Scatter,
    basis: &Arc<Basis>,
    values: &[f64],
    part: Part,
) -> Result<Bsdf> {
    let name = bsdf.band(band)?.name.clone();
    let mut found = false;
    let result = bsdf.try_map(|other, s, c, model| {
        if other == name && (s, c) == (side, scatter) {
            found = true;
            normalise(model, basis, values, part)
        } else {
            Ok(model.clone())
        }
    })?;
    if found {
        return Ok(result);
    }
    Err(Error::Missing(format!(
        "band {name:?} has no {} for light from the {}",
        scatter.name(),
        side.name()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Lambertian;
    use crate::direction::Disk;
    use crate::sequence::uniform;

    fn full() -> Arc<Basis> {
        Arc::new(Basis::klems_full())
    }

    fn values() -> Vec<f64> {
        (0..145).map(|k| 0.2 + 0.5 * uniform(4, k)).collect()
    }

    fn noisy() -> Model {
        Model::Matrix(Matrix::from_fn(full(), full(), |i, o| uniform(1, (i * 145 + o) as u64)).unwrap())
    }

    fn beam_and_haze() -> Model {
        let parts = vec![
            (0.5, Arc::new(Model::Specular(Specular::constant(0.1).unwrap()))),
            (1.0, Arc::new(noisy())),
        ];
        Model::Sum(Sum::new(parts).unwrap())
    }

    fn check(model: &Model, part: Part) {
        let done = normalise(model, &full(), &values(), part).unwrap();
        for (patch, wanted) in values().into_iter().enumerate() {
            let point = full().sample_cosine(patch, [0.3, 0.6]);
            let got = done.total(point, Part::All).value;
            assert!(
                (got - wanted).abs() < 1e-9,
                "{} {part:?} patch {patch}: {got} {wanted}",
                model.kind()
            );
        }
    }

    #[test]
    fn every_patch_gets_its_value() {
        for model in [
            noisy(),
            beam_and_haze(),
            Model::Lambertian(Lambertian::new(0.3).unwrap()),
            Model::Specular(Specular::constant(0.3).unwrap()),
        ] {
            check(&model, Part::All);
        }
        check(&beam_and_haze(), Part::Scattered);
        check(&Model::Specular(Specular::constant(0.3).unwrap()), Part::Direct);
    }

    #[test]
    fn trees_are_scaled_cell_by_cell() {
        let tree = crate::bsdf::convert::testing::bushy(crate::bsdf::Rank::Anisotropic);
        let model = Model::Tree(tree);
        // Smooth in the patches, as spheres measure it.
        let values: Vec<f64> = (0..145).map(|p| 0.2 + 0.4 * full().centre(p).cos_theta()).collect();
        let done = normalise(&model, &full(), &values, Part::All).unwrap();
        assert_eq!(done.kind(), "tensor tree");
        for (patch, wanted) in values.iter().enumerate() {
            let got = mean_total(&done, &full(), patch, Part::All);
            assert!((got - wanted).abs() < 0.02 * wanted, "patch {patch}: {got} {wanted}");
        }
    }

    #[test]
    fn what_is_kept_is_kept() {
        let model = beam_and_haze();
        let done = normalise(&model, &full(), &values(), Part::Scattered).unwrap();
        let point = Disk::new(0.2, 0.4);
        let beam = |m: &Model| m.total(point, Part::Direct).value;
        assert!((beam(&done) - beam(&model)).abs() < 1e-12);
        let shape = |m: &Model| m.evaluate(point, Disk::new(0.1, 0.0)) / m.evaluate(point, Disk::new(0.7, 0.0));
        assert!((shape(&done) - shape(&model)).abs() < 1e-9);
    }

    #[test]
    fn one_value_for_all_scales_a_diffuser_as_a_diffuser() {
        let model = Model::Lambertian(Lambertian::new(0.3).unwrap());
        let done = normalise(&model, &full(), &[0.6; 145], Part::All).unwrap();
        assert_eq!(done.kind(), "Lambertian");
        assert!((done.total(Disk::NORMAL, Part::All).value - 0.6).abs() < 1e-12);
    }

    #[test]
    fn darkness_cannot_be_scaled_and_the_patch_is_named() {
        let dark = Matrix::from_fn(full(), full(), |i, _| if i == 6 { 0.0 } else { 0.1 }).unwrap();
        let error = normalise(&Model::Matrix(dark.clone()), &full(), &values(), Part::All).unwrap_err();
        assert!(
            error.to_string().contains("incident patch 7 of LBNL/Klems Full"),
            "{error}"
        );
        let mut wanted = values();
        wanted[6] = 0.0;
        assert!(normalise(&Model::Matrix(dark), &full(), &wanted, Part::All).is_ok());
    }

    #[test]
    fn unfit_arguments_are_refused() {
        let model = beam_and_haze();
        for values in [vec![0.5; 3], vec![f64::NAN; 145], vec![-0.1; 145]] {
            assert!(normalise(&model, &full(), &values, Part::All).is_err());
        }
        // The beam alone has 0.05.
        let error = normalise(&model, &full(), &[0.01; 145], Part::Scattered).unwrap_err();
        assert!(error.to_string().contains("kept"), "{error}");
        let quarter = Arc::new(Basis::klems_quarter());
        let varied: Vec<f64> = values()[..41].to_vec();
        let error = normalise(&noisy(), &quarter, &varied, Part::All).unwrap_err();
        assert!(matches!(error, Error::Unsupported(_)), "{error}");
    }
}
