//! Reciprocity, f(vᵢ, vₒ) = f(vₒ, vᵢ) with paths travelled backwards: how far a data set is from it, and how to force it.

use std::f64::consts::PI;
use std::sync::Arc;

use super::{Bsdf, Component, Model, Part, Scatterer};
use crate::direction::{Disk, Scatter, Side};
use crate::error::{Error, Result};
use crate::sequence::{r4, uniform};

/// A data set with every component averaged with its own reverse: transmission of the two sides with each other, reflection
/// with itself. Bands and components that are missing stay missing.
pub fn reciprocal_average(bsdf: &Bsdf) -> Result<Bsdf> {
    let mut result = bsdf.clone();
    for band in bsdf.bands() {
        let mut new = band.clone();
        let fail = |error: Error, side: Side, scatter: Scatter| match error {
            Error::Unsupported(what) => Error::Unsupported(format!(
                "band {:?}, {} for light from the {}: {what}",
                band.name,
                scatter.name(),
                side.name()
            )),
            other => other,
        };
        for side in Side::BOTH {
            if let Some(model) = band.get(side, Scatter::Reflection) {
                let averaged = average(model, model).map_err(|e| fail(e, side, Scatter::Reflection))?;
                new.set(side, Scatter::Reflection, Some(Arc::new(averaged)));
            }
        }
        let through = Side::BOTH.map(|side| band.get(side, Scatter::Transmission));
        if let [Some(front), Some(back)] = through {
            let averaged = average(front, back).map_err(|e| fail(e, Side::Exterior, Scatter::Transmission))?;
            let reversed = reverse(&averaged)?;
            new.set(Side::Exterior, Scatter::Transmission, Some(Arc::new(averaged)));
            new.set(Side::Interior, Scatter::Transmission, Some(Arc::new(reversed)));
        }
        result = result.with_band(new)?;
    }
    Ok(result)
}

/// Mean of a model and the reverse of another.
fn average(model: &Component, other: &Component) -> Result<Model> {
    let reversed = reverse(other)?;
    if let (Model::Matrix(a), Model::Matrix(b)) = (&**model, &reversed)
        && (a.incident() != b.incident() || a.outgoing() != b.outgoing())
    {
        return Err(Error::Unsupported(
            "the reverse of a matrix lies on other bases (convert both sides to one basis for incident and outgoing \
             directions first)"
                .into(),
        ));
    }
    Model::mixture(&[(0.5, model.clone()), (0.5, Arc::new(reversed))])
}

/// The reverse, where it is exact and as fast as the model itself.
fn reverse(model: &Model) -> Result<Model> {
    let reversed = model.reciprocal();
    if has_view(&reversed) {
        return Err(Error::Unsupported(format!(
            "a {} model has no table of its reversed paths (convert it to a matrix of even rings, such as klems-full, or to a \
             tensor tree of rank 4 first)",
            model.kind()
        )));
    }
    Ok(reversed)
}

fn has_view(model: &Model) -> bool {
    match model {
        Model::Reversed(_) | Model::Interpolant(_) => true,
        Model::Turned(t) => has_view(t.base()),
        Model::Sum(s) => s.parts().iter().any(|(_, m)| has_view(m)),
        Model::Separated(s) => has_view(s.base()),
        Model::Filtered(f) => has_view(f.base()),
        Model::Matrix(_) | Model::Tree(_) | Model::Lambertian(_) | Model::Specular(_) | Model::Beam(_) => false,
    }
}

/// Points of each of the three ways to draw a pair of directions.
const POINTS: u32 = 1 << 15;

/// ∫∫ |f − reverse of b| over ∫∫ f, over projected solid angles of incident and outgoing directions: 0 for a reciprocal
/// pair. `back` is the other side's transmission, or the model itself for reflection. None where `model` is dark.
///
/// Matrices are summed exactly. All else is sampled in three ways at once (evenly, by each model's own density), so that
/// narrow peaks of either one are found; peaks are compared by their values.
pub fn reciprocity_error(model: &Model, back: &Model) -> Option<f64> {
    if let (Model::Matrix(a), Model::Matrix(b)) = (model, back)
        && let Some(b) = b.reversed()
        && a.incident() == b.incident()
        && a.outgoing() == b.outgoing()
    {
        let (mut difference, mut sum) = (0.0, 0.0);
        let areas = a.outgoing().projected_solid_angles();
        for i in 0..a.incident().len() {
            let area_in = a.incident().projected_solid_angle(i);
            for (o, area_out) in areas.iter().enumerate() {
                difference += (a.value(i, o) - b.value(i, o)).abs() * area_in * area_out;
                sum += a.value(i, o) * area_in * area_out;
            }
        }
        return (sum > 0.0).then(|| difference / sum);
    }
    let (mut difference, mut sum) = (0.0, 0.0);
    for k in 0..POINTS {
        let u = r4(k, [0.5; 4]);
        let incident = Disk::uniform([u[0], u[1]]);
        // Peaks: what goes one way must come back the same way.
        let beam = |m: &Model, d: Disk| m.total(d, Part::Direct).value;
        let (forth, home) = (beam(model, incident), beam(back, incident.reversed()));
        difference += (forth - home).abs() / f64::from(POINTS);
        sum += model.total(incident, Part::All).value / f64::from(POINTS);
        let pairs = [
            Some((incident, Disk::uniform([u[2], u[3]]))),
            scattered(model, incident, k).map(|outgoing| (incident, outgoing)),
            scattered(back, incident, k).map(|outgoing| (outgoing.reversed(), incident.reversed())),
        ];
        for (i, o) in pairs.into_iter().flatten() {
            let density = (1.0 / PI + density(model, i, o) + density(back, o.reversed(), i.reversed())) / PI;
            let gap = (model.evaluate(i, o) - back.evaluate(o.reversed(), i.reversed())).abs();
            difference += gap / density / PI / f64::from(POINTS);
        }
    }
    (sum > 0.0).then(|| difference / sum)
}

fn scattered(model: &Model, incident: Disk, k: u32) -> Option<Disk> {
    let u = [uniform(1, u64::from(k)), uniform(2, u64::from(k))];
    model.sample(incident, u).filter(|s| !s.peak).map(|s| s.outgoing)
}

/// Density of scattered samples per projected solid angle.
fn density(model: &Model, incident: Disk, outgoing: Disk) -> f64 {
    let cos = outgoing.cos_theta();
    if cos > 0.0 {
        model.pdf(incident, outgoing) / cos
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::convert::testing::bushy;
    use crate::bsdf::convert::{Sampling, to_matrix};
    use crate::bsdf::{Band, Lambertian, Matrix, Metadata, Rank, Specular, Sum};
    use crate::progress::Progress;

    fn noisy(basis: Basis, seed: u64) -> Component {
        let basis = Arc::new(basis);
        let n = basis.len();
        let matrix = Matrix::from_fn(basis.clone(), basis, |i, o| uniform(seed, (i * n + o) as u64)).unwrap();
        Arc::new(Model::Matrix(matrix))
    }

    fn set(front: Component, back: Component, reflection: Component) -> Bsdf {
        let mut band = Band::new("visible");
        band.set(Side::Exterior, Scatter::Transmission, Some(front));
        band.set(Side::Interior, Scatter::Transmission, Some(back));
        band.set(Side::Interior, Scatter::Reflection, Some(reflection));
        Bsdf::new(vec![band], Metadata::default()).unwrap()
    }

    #[test]
    fn the_average_is_reciprocal_and_keeps_the_hemispherical_value() {
        let table = || noisy(Basis::klems_half(), 1);
        let forced = reciprocal_average(&set(
            table(),
            noisy(Basis::klems_half(), 2),
            noisy(Basis::klems_half(), 3),
        ))
        .unwrap();
        let band = forced.band(None).unwrap();
        let get = |side, scatter| band.get(side, scatter).unwrap();
        let (front, back) = (
            get(Side::Exterior, Scatter::Transmission),
            get(Side::Interior, Scatter::Transmission),
        );
        assert!(reciprocity_error(front, back).unwrap() < 1e-12);
        let reflection = get(Side::Interior, Scatter::Reflection);
        assert!(reciprocity_error(reflection, reflection).unwrap() < 1e-12);
        let hemispherical = |m: &Model| -> f64 {
            let Model::Matrix(m) = m else { panic!("a matrix") };
            (0..77)
                .map(|i| m.direct_hemispherical(i) * m.incident().projected_solid_angle(i))
                .sum()
        };
        let before = noisy(Basis::klems_half(), 3);
        assert!((hemispherical(reflection) - hemispherical(&before)).abs() < 1e-9);
        assert!(reciprocity_error(&before, &before).unwrap() > 0.3);
    }

    #[test]
    fn numbers_average_and_what_cannot_be_reversed_is_refused() {
        let diffuse = |v| Arc::new(Model::Lambertian(Lambertian::new(v).unwrap()));
        let forced = reciprocal_average(&set(diffuse(0.4), diffuse(0.2), diffuse(0.1))).unwrap();
        let total = forced
            .band(None)
            .unwrap()
            .get(Side::Exterior, Scatter::Transmission)
            .unwrap();
        assert!((total.total(Disk::NORMAL, Part::All).value - 0.3).abs() < 1e-12);
        let odd = Basis::from_rings(
            "odd",
            vec![
                crate::basis::Ring {
                    lower_deg: 0.0,
                    upper_deg: 30.0,
                    nominal_deg: 0.0,
                    count: 1,
                },
                crate::basis::Ring {
                    lower_deg: 30.0,
                    upper_deg: 90.0,
                    nominal_deg: 60.0,
                    count: 5,
                },
            ],
        )
        .unwrap();
        let error = reciprocal_average(&set(diffuse(0.4), diffuse(0.2), noisy(odd, 4))).unwrap_err();
        assert!(
            error.to_string().contains("reflection for light from the interior"),
            "{error}"
        );
    }

    #[test]
    fn trees_are_averaged_exactly() {
        let tree = Arc::new(Model::Tree(bushy(Rank::Anisotropic)));
        assert!(reciprocity_error(&tree, &tree).unwrap() > 0.1);
        let forced = reciprocal_average(&set(tree.clone(), tree.clone(), tree)).unwrap();
        let band = forced.band(None).unwrap();
        let reflection = band.get(Side::Interior, Scatter::Reflection).unwrap();
        assert_eq!(reflection.kind(), "tensor tree");
        assert!(reciprocity_error(reflection, reflection).unwrap() < 1e-6);
        let through = Side::BOTH.map(|side| band.get(side, Scatter::Transmission).unwrap());
        assert!(reciprocity_error(through[0], through[1]).unwrap() < 1e-6);
    }

    #[test]
    fn sampled_and_summed_errors_agree() {
        let (a, b) = (noisy(Basis::klems_full(), 5), noisy(Basis::klems_full(), 6));
        let exact = reciprocity_error(&a, &b).unwrap();
        // The same, but no longer a matrix.
        let sum = Model::Sum(Sum::new(vec![(1.0, a.clone())]).unwrap());
        let sampled = reciprocity_error(&sum, &b).unwrap();
        assert!((sampled - exact).abs() < 0.01 * exact, "{sampled} {exact}");
        let same = Model::Sum(Sum::new(vec![(1.0, Arc::new(b.reciprocal()))]).unwrap());
        assert!(reciprocity_error(&same, &b).unwrap() < 1e-9);
        let dark = Model::Lambertian(Lambertian::new(0.0).unwrap());
        assert!(reciprocity_error(&dark, &dark).is_none());
    }

    #[test]
    fn peaks_are_compared_by_value() {
        let beam = |v| Model::Specular(Specular::constant(v).unwrap());
        assert!((reciprocity_error(&beam(0.5), &beam(0.4)).unwrap() - 0.2).abs() < 1e-9);
        // A beam spread over its own patch of a matrix is reciprocal.
        let basis = Arc::new(Basis::klems_quarter());
        let spread = to_matrix(&beam(0.5), &basis, &basis, Sampling::default(), &Progress::default()).unwrap();
        let spread = Model::Matrix(spread.matrix);
        assert!(reciprocity_error(&spread, &spread).unwrap() < 1e-12);
    }
}
