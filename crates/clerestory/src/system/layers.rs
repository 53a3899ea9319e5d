//! Layers put together by the Klems method (Klems 1994, "A new method for predicting the solar heat gain of complex
//! fenestration systems", ASHRAE Transactions 100).
//!
//! Layers are infinite and homogeneous at their scale, gaps have no lateral shift, and light that a layer scatters within a
//! patch is even over it. Light between layers is followed through all reflections by solving linear equations. What
//! travels along specular paths alone is kept apart as a beam: adding it to the diagonal of the matrix, over the
//! projected solid angles, gives the classic result.

use std::sync::Arc;

use ndarray::Array1;
use rayon::prelude::*;

use super::errors::{self, Variances};
use super::flux::{Flux, PatchValue, on_basis};
use crate::basis::Basis;
use crate::bsdf::{Band, Bsdf, Metadata, Model};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};

/// Data that send out more than they receive by less than this pass without a warning.
const GAIN: f64 = 1e-3;

/// A window of layers.
#[derive(Debug, Clone)]
pub struct System {
    /// How it scatters light.
    pub bsdf: Bsdf,
    basis: Arc<Basis>,
    /// By band and side of incidence: a list of incident patches for each layer.
    absorptance: Vec<[Vec<Vec<f64>>; 2]>,
}

impl System {
    /// Patches that the layers are put together on.
    pub fn basis(&self) -> &Arc<Basis> {
        &self.basis
    }

    /// Number of layers.
    pub fn layers(&self) -> usize {
        self.absorptance[0][0].len()
    }

    /// Share of the light from each patch of `side` that each layer absorbs, outermost layer first. Negative where a
    /// layer's data send out more than they receive.
    pub fn absorptance(&self, band: Option<&str>, side: Side) -> Result<&[Vec<f64>]> {
        let name = &self.bsdf.band(band)?.name;
        let index = self
            .bsdf
            .bands()
            .iter()
            .position(|b| b.name == *name)
            .expect("it is one of them");
        Ok(&self.absorptance[index][side as usize])
    }
}

/// One layer in one band, as flux; by side of incidence.
pub(super) struct Layer {
    pub transmission: [Flux; 2],
    pub reflection: [Flux; 2],
    /// Variances of the flux shares, where the data have standard errors.
    pub variances: Variances,
}

impl Layer {
    /// The layer, with notes on what its data did not give as such.
    fn new(bsdf: &Bsdf, band: &str, basis: &Arc<Basis>, specular: PatchValue) -> Result<(Self, Vec<String>)> {
        let (mut notes, mut variances) = (Vec::new(), Variances::default());
        let mut flux = |side: Side, scatter: Scatter| -> Result<Flux> {
            let place = format!("{} for light from the {}", scatter.name(), side.name());
            let outcome = bsdf.component(Some(band), side, scatter)?;
            if outcome.by_reciprocity {
                notes.push(format!("{place} was taken from the other side by reciprocity"));
            }
            let mut converted = Vec::new();
            let model = on_basis(&outcome.component, basis, &mut converted)
                .map_err(|error| error.within(&format!("{place}: ")))?;
            notes.extend(converted.iter().map(|note| format!("{place}: {note}")));
            variances.set(side, scatter, &model, basis);
            Flux::of(&model, basis, specular)
        };
        let transmission = [
            flux(Side::Exterior, Scatter::Transmission)?,
            flux(Side::Interior, Scatter::Transmission)?,
        ];
        let reflection = [
            flux(Side::Exterior, Scatter::Reflection)?,
            flux(Side::Interior, Scatter::Reflection)?,
        ];
        let layer = Self {
            transmission,
            reflection,
            variances,
        };
        for side in Side::BOTH {
            let least = layer.absorptance(side).iter().copied().fold(0.0, f64::min);
            if least < -GAIN {
                notes.push(format!(
                    "up to {:.1} % of the light that comes from the {} leaves",
                    100.0 * (1.0 - least),
                    side.name()
                ));
            }
        }
        Ok((layer, notes))
    }

    /// Share of the light from each patch of a side that the layer absorbs.
    fn absorptance(&self, side: Side) -> Array1<f64> {
        1.0 - self.transmission[side as usize].totals() - self.reflection[side as usize].totals()
    }
}

/// What becomes of light from one side. Everything is by incident patch of that side.
pub(super) struct Response {
    pub transmission: Flux,
    pub reflection: Flux,
    /// By layer in the order of incidence.
    absorptance: Vec<Array1<f64>>,
    /// Light that travels on between layers, per light that arrives: `onward[k]` falls on layer k.
    pub onward: Vec<Flux>,
    /// Reflection of all from layer k on, and none behind the last.
    pub behind: Vec<Flux>,
    /// Light that goes on behind layer k per light that falls on it.
    pub gains: Vec<Flux>,
}

impl Response {
    /// `layers` in the order in which light from `side` meets them.
    fn new(layers: &[&Layer], side: Side, patches: usize) -> Result<Self> {
        let (front, back) = (side as usize, side.opposite() as usize);
        let mut behind = vec![Flux::none(patches)];
        let (mut gains, mut absorbed) = (Vec::new(), Vec::new());
        for layer in layers.iter().rev() {
            let farther = &behind[behind.len() - 1];
            let round = layer.reflection[back].after(farther);
            let gain = round.again_and_again(&layer.transmission[front])?;
            let returned = farther.after(&gain);
            absorbed.push(layer.absorptance(side) + returned.seen_by(&layer.absorptance(side.opposite())));
            let reflection = layer.reflection[front].plus(layer.transmission[back].after(&returned));
            behind.push(reflection);
            gains.push(gain);
        }
        behind.reverse();
        gains.reverse();
        absorbed.reverse();
        let mut onward = vec![Flux::identity(patches)];
        for gain in &gains {
            onward.push(gain.after(&onward[onward.len() - 1]));
        }
        let absorptance = absorbed
            .iter()
            .zip(&onward)
            .map(|(absorbed, onward)| onward.seen_by(absorbed))
            .collect();
        Ok(Self {
            transmission: onward.pop().expect("at least the identity"),
            reflection: behind[0].clone(),
            absorptance,
            onward,
            behind,
            gains,
        })
    }
}

/// One band of a system: its models by side and scatter, and what its layers absorb by side.
struct Solved {
    models: [[Model; 2]; 2],
    absorptance: [Vec<Vec<f64>>; 2],
}

impl Solved {
    fn new(layers: &[Layer], basis: &Arc<Basis>) -> Result<Self> {
        let inward: Vec<&Layer> = layers.iter().collect();
        let outward: Vec<&Layer> = layers.iter().rev().collect();
        let (exterior, interior) = rayon::join(
            || Response::new(&inward, Side::Exterior, basis.len()),
            || Response::new(&outward, Side::Interior, basis.len()),
        );
        let responses = [&exterior?, &interior?];
        let models = |side: Side| -> Result<[Model; 2]> {
            let [transmission, reflection] = errors::standard_errors(layers, responses, side, basis)?;
            let response = responses[side as usize];
            Ok([
                response.transmission.model(basis, transmission)?,
                response.reflection.model(basis, reflection)?,
            ])
        };
        let mut absorptance = responses.map(|response| {
            let lists = response.absorptance.iter().map(|a| a.iter().copied().collect());
            lists.collect::<Vec<Vec<f64>>>()
        });
        // Light from the interior meets the innermost layer first.
        absorptance[Side::Interior as usize].reverse();
        Ok(Self {
            models: [models(Side::Exterior)?, models(Side::Interior)?],
            absorptance,
        })
    }

    fn band(self, like: &Band) -> (Band, [Vec<Vec<f64>>; 2]) {
        let mut band = Band::new(&like.name);
        band.source_spectrum.clone_from(&like.source_spectrum);
        band.detector_spectrum.clone_from(&like.detector_spectrum);
        for (side, models) in Side::BOTH.into_iter().zip(self.models) {
            for (scatter, model) in Scatter::BOTH.into_iter().zip(models) {
                band = band.with(side, scatter, model);
            }
        }
        (band, self.absorptance)
    }
}

/// Names of the bands that all layers have, and of those that only some have.
fn bands(layers: &[Bsdf]) -> Result<(Vec<&str>, Vec<&str>)> {
    let names = |layer: &'_ Bsdf| -> Vec<String> { layer.bands().iter().map(|b| b.name.clone()).collect() };
    let mut all: Vec<&str> = Vec::new();
    for band in layers.iter().flat_map(Bsdf::bands) {
        if !all.contains(&band.name.as_str()) {
            all.push(&band.name);
        }
    }
    let everywhere = |band: &&str| layers.iter().all(|layer| layer.bands().iter().any(|b| b.name == *band));
    let (common, partial): (Vec<&str>, Vec<&str>) = all.into_iter().partition(everywhere);
    if common.is_empty() {
        let lists: Vec<String> = layers
            .iter()
            .enumerate()
            .map(|(k, layer)| format!("layer {}: {}", k + 1, names(layer).join(", ")))
            .collect();
        return Err(Error::Missing(format!(
            "the layers have no band in common ({})",
            lists.join("; ")
        )));
    }
    Ok((common, partial))
}

/// Puts layers together, outermost first, in every band that all of them have.
///
/// Fails where a layer lacks a reflection, or is a table on other patches than `basis`; the text names the layer.
pub fn stack(layers: &[Bsdf], basis: &Arc<Basis>, specular: PatchValue) -> Result<System> {
    let Some(first) = layers.first() else {
        return Err(Error::Argument("a system needs at least one layer".into()));
    };
    let (common, partial) = bands(layers)?;
    let mut warnings = Vec::new();
    if !partial.is_empty() {
        warnings.push(format!(
            "left out, for not all layers have it: band {}",
            partial.join(", ")
        ));
    }
    let mut prepared = Vec::new();
    for band in &common {
        let mut of_band = Vec::new();
        for (k, layer) in layers.iter().enumerate() {
            let place = format!("layer {}, band {band:?}: ", k + 1);
            let (layer, notes) = Layer::new(layer, band, basis, specular).map_err(|e| e.within(&place))?;
            warnings.extend(notes.into_iter().map(|note| place.clone() + &note));
            of_band.push(layer);
        }
        prepared.push(of_band);
    }
    let solved: Vec<Solved> = prepared
        .par_iter()
        .zip(&common)
        .map(|(layers, band)| Solved::new(layers, basis).map_err(|e| e.within(&format!("band {band:?}: "))))
        .collect::<Result<_>>()?;
    let (mut bands, mut absorptance) = (Vec::new(), Vec::new());
    for (name, solved) in common.into_iter().zip(solved) {
        let (band, absorbed) = solved.band(first.band(Some(name))?);
        bands.push(band);
        absorptance.push(absorbed);
    }
    let mut metadata = Metadata {
        element_type: Some("System".into()),
        ..Metadata::default()
    };
    let names: Option<Vec<&str>> = layers.iter().map(|l| l.metadata.material_text("Name")).collect();
    if let Some(names) = names {
        metadata.set_material("Name", &names.join(" + "), None);
    }
    let mut bsdf = Bsdf::new(bands, metadata)?;
    bsdf.warnings = warnings;
    Ok(System {
        bsdf,
        basis: basis.clone(),
        absorptance,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Matrix, Part, Scatterer, Slab, Specular};
    use crate::sequence::uniform;
    use std::f64::consts::PI;

    fn full() -> Arc<Basis> {
        Arc::new(Basis::klems_full())
    }

    /// A layer of the same model from both sides.
    fn even(transmission: &Model, reflection: &Model) -> Bsdf {
        let band = Side::BOTH.into_iter().fold(Band::new("visible"), |band, side| {
            band.with(side, Scatter::Transmission, transmission.clone()).with(
                side,
                Scatter::Reflection,
                reflection.clone(),
            )
        });
        Bsdf::new(vec![band], Metadata::default()).unwrap()
    }

    fn specular(t: f64, r: f64) -> Bsdf {
        even(
            &Model::Specular(Specular::Constant(t)),
            &Model::Specular(Specular::Constant(r)),
        )
    }

    /// A reciprocal layer of random matrices that absorbs some light.
    fn random(basis: &Arc<Basis>, seed: u64) -> Bsdf {
        let n = basis.len();
        let back = |p: usize| basis.reversed(p).unwrap();
        let value = |stream: u64, i: usize, o: usize| uniform(seed * 10 + stream, (i * n + o) as u64) * 0.45 * 2.0 / PI;
        let symmetric = |stream, i: usize, o: usize| 0.5 * (value(stream, i, o) + value(stream, back(o), back(i)));
        let matrix =
            |f: &dyn Fn(usize, usize) -> f64| Model::Matrix(Matrix::from_fn(basis.clone(), basis.clone(), f).unwrap());
        let band = Band::new("visible")
            .with(Side::Exterior, Scatter::Transmission, matrix(&|i, o| value(0, i, o)))
            .with(
                Side::Interior,
                Scatter::Transmission,
                matrix(&|i, o| value(0, back(o), back(i))),
            )
            .with(Side::Exterior, Scatter::Reflection, matrix(&|i, o| symmetric(1, i, o)))
            .with(Side::Interior, Scatter::Reflection, matrix(&|i, o| symmetric(2, i, o)));
        Bsdf::new(vec![band], Metadata::default()).unwrap()
    }

    fn build(layers: &[Bsdf]) -> System {
        stack(layers, &full(), PatchValue::Centre).unwrap()
    }

    fn total(system: &System, side: Side, scatter: Scatter, patch: usize, part: Part) -> f64 {
        let component = system.bsdf.component(None, side, scatter).unwrap().component;
        component.total(system.basis().centre(patch), part).value
    }

    /// Beams and scattered light as one matrix (1/sr).
    fn classic(system: &System, side: Side, scatter: Scatter) -> Vec<f64> {
        let model = system.bsdf.component(None, side, scatter).unwrap().component;
        let flux = Flux::of(&model, system.basis(), PatchValue::Centre).unwrap().matrix();
        let areas = system.basis().projected_solid_angles();
        let n = areas.len();
        (0..n * n).map(|k| flux[[k % n, k / n]] / areas[k % n]).collect()
    }

    fn worst(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn two_equal_panes() {
        let system = build(&[specular(0.8, 0.08), specular(0.8, 0.08)]);
        for side in Side::BOTH {
            for patch in [0, 41, 144] {
                let t = total(&system, side, Scatter::Transmission, patch, Part::Direct);
                let r = total(&system, side, Scatter::Reflection, patch, Part::Direct);
                assert!((t - 0.644_122).abs() < 1e-6 && (r - 0.131_530).abs() < 1e-6, "{t} {r}");
                assert_eq!(total(&system, side, Scatter::Transmission, patch, Part::Scattered), 0.0);
            }
        }
        // A_1 = A + T R A / (1 - R²) and A_2 = T A / (1 - R²).
        let absorbed = system.absorptance(None, Side::Exterior).unwrap();
        assert!((absorbed[0][7] - (0.12 + 0.8 * 0.08 * 0.12 / (1.0 - 0.0064))).abs() < 1e-12);
        assert!((absorbed[1][7] - 0.8 * 0.12 / (1.0 - 0.0064)).abs() < 1e-12);
        let inside = system.absorptance(None, Side::Interior).unwrap();
        assert!((inside[1][7] - absorbed[0][7]).abs() < 1e-12);
    }

    #[test]
    fn unequal_panes_follow_the_closed_form() {
        let ((t1, rf1, rb1), (t2, rf2, rb2)) = ((0.5, 0.1, 0.3), (0.7, 0.2, 0.05));
        let layer = |t: f64, rf: f64, rb: f64| {
            let beam = |v| Model::Specular(Specular::Constant(v));
            let band = Band::new("visible")
                .with(Side::Exterior, Scatter::Transmission, beam(t))
                .with(Side::Exterior, Scatter::Reflection, beam(rf))
                .with(Side::Interior, Scatter::Reflection, beam(rb));
            Bsdf::new(vec![band], Metadata::default()).unwrap()
        };
        let system = build(&[layer(t1, rf1, rb1), layer(t2, rf2, rb2)]);
        let round = 1.0 - rb1 * rf2;
        let expected = [
            [t1 * t2 / round, rf1 + t1 * t1 * rf2 / round],
            [t1 * t2 / round, rb2 + t2 * t2 * rb1 / round],
        ];
        for side in Side::BOTH {
            for scatter in Scatter::BOTH {
                let value = total(&system, side, scatter, 3, Part::All);
                assert!((value - expected[side as usize][scatter as usize]).abs() < 1e-12);
            }
        }
        let absorbed = system.absorptance(None, Side::Exterior).unwrap();
        let (a1, a2) = ((1.0 - t1 - rf1, 1.0 - t1 - rb1), 1.0 - t2 - rf2);
        assert!((absorbed[0][0] - (a1.0 + t1 * rf2 * a1.1 / round)).abs() < 1e-12);
        assert!((absorbed[1][0] - t1 * a2 / round).abs() < 1e-12);
        // Both layers lack the transmission from the interior.
        assert_eq!(system.bsdf.warnings.len(), 2);
        assert!(system.bsdf.warnings[0].contains("reciprocity"));
    }

    #[test]
    fn diffusers_follow_the_closed_form() {
        let diffuse = |v| Model::Lambertian(crate::bsdf::Lambertian::new(v).unwrap());
        let (t1, r1, t2, r2) = (0.4, 0.35, 0.6, 0.3);
        let system = build(&[even(&diffuse(t1), &diffuse(r1)), even(&diffuse(t2), &diffuse(r2))]);
        for patch in [0, 100] {
            let t = total(&system, Side::Exterior, Scatter::Transmission, patch, Part::All);
            let r = total(&system, Side::Exterior, Scatter::Reflection, patch, Part::All);
            assert!((t - t1 * t2 / (1.0 - r1 * r2)).abs() < 1e-12, "{t}");
            assert!((r - (r1 + t1 * t1 * r2 / (1.0 - r1 * r2))).abs() < 1e-12, "{r}");
        }
    }

    #[test]
    fn energy_closes_and_reciprocity_stays() {
        let glass = super::super::pane::pane(Slab::new(1.52, 0.95).unwrap(), "visible").unwrap();
        let basis = full();
        let layers = [
            glass.clone(),
            random(&basis, 1),
            glass,
            random(&basis, 2),
            random(&basis, 3),
        ];
        let system = build(&layers);
        for side in Side::BOTH {
            let absorbed = system.absorptance(None, side).unwrap();
            assert_eq!(absorbed.len(), 5);
            for patch in 0..basis.len() {
                let sum = total(&system, side, Scatter::Transmission, patch, Part::All)
                    + total(&system, side, Scatter::Reflection, patch, Part::All)
                    + absorbed.iter().map(|a| a[patch]).sum::<f64>();
                assert!((sum - 1.0).abs() < 1e-9, "{patch}: {sum}");
            }
        }
        let matrix = |side, scatter| {
            let values = classic(&system, side, scatter);
            Matrix::new(basis.clone(), basis.clone(), values).unwrap()
        };
        let front = matrix(Side::Exterior, Scatter::Transmission);
        let back = matrix(Side::Interior, Scatter::Transmission);
        assert!(worst(front.reversed().unwrap().values(), back.values()) < 1e-12);
        for side in Side::BOTH {
            let reflection = matrix(side, Scatter::Reflection);
            assert!(worst(reflection.reversed().unwrap().values(), reflection.values()) < 1e-12);
        }
    }

    #[test]
    fn keeping_beams_apart_changes_nothing_else() {
        // The same glass as a beam and as a diagonal matrix.
        let basis = full();
        let slab = Slab::new(1.52, 0.95).unwrap();
        let diagonal = |scatter| {
            let value = |i: usize, o: usize| {
                if i == o {
                    slab.value(basis.centre(i), scatter) / basis.projected_solid_angle(i)
                } else {
                    0.0
                }
            };
            Model::Matrix(Matrix::from_fn(basis.clone(), basis.clone(), value).unwrap())
        };
        let table = even(&diagonal(Scatter::Transmission), &diagonal(Scatter::Reflection));
        let glass = super::super::pane::pane(slab, "visible").unwrap();
        let shade = random(&basis, 4);
        let apart = build(&[glass.clone(), shade.clone(), glass]);
        let together = build(&[table.clone(), shade, table]);
        for side in Side::BOTH {
            for scatter in Scatter::BOTH {
                let gap = worst(&classic(&apart, side, scatter), &classic(&together, side, scatter));
                assert!(gap < 1e-12, "{gap}");
            }
            let (a, b) = (
                apart.absorptance(None, side).unwrap(),
                together.absorptance(None, side).unwrap(),
            );
            for k in 0..3 {
                assert!(worst(&a[k], &b[k]) < 1e-12);
            }
        }
        // The mirror image in the outer pane alone is a beam.
        let r = total(&apart, Side::Exterior, Scatter::Reflection, 0, Part::Direct);
        assert!((r - slab.values(0.0)[1]).abs() < 1e-12);
    }

    #[test]
    fn one_layer_is_itself() {
        let basis = full();
        let layer = random(&basis, 5);
        let system = build(std::slice::from_ref(&layer));
        for (side, scatter, model) in layer.bands()[0].components() {
            let Model::Matrix(matrix) = &**model else {
                unreachable!("it is one")
            };
            assert!(worst(matrix.values(), &classic(&system, side, scatter)) < 1e-14);
        }
    }

    #[test]
    fn mean_sampling_takes_the_mean_over_a_patch() {
        // T = 1 - sin²θ: its mean over a ring is 1 less the mean of the limits' sin².
        let basis = full();
        let beam = Model::Specular(Specular::Angular(vec![1.0, 0.0]));
        let black = Model::Specular(Specular::Constant(0.0));
        let system = stack(&[even(&beam, &black)], &basis, PatchValue::Mean).unwrap();
        let (limits, _) = basis.limits(144);
        let expected = 1.0 - 0.5 * (limits[0].sin().powi(2) + 1.0);
        let value = total(&system, Side::Exterior, Scatter::Transmission, 144, Part::All);
        assert!((value - expected).abs() < 1e-9, "{value} {expected}");
    }

    #[test]
    fn standard_errors_are_those_of_small_changes() {
        let basis = Arc::new(Basis::klems_quarter());
        let n = basis.len();
        let plain = [random(&basis, 6), random(&basis, 7), random(&basis, 8)];
        let with_error = |layer: &Bsdf, on: (Side, Scatter), cell: usize, size: f64, shift: bool| {
            layer
                .try_map(|_, side, scatter, model| {
                    let Model::Matrix(matrix) = model else {
                        unreachable!("it is one")
                    };
                    if (side, scatter) != on {
                        return Ok(model.clone());
                    }
                    let mut values = matrix.values().to_vec();
                    let mut errors = vec![0.0; n * n];
                    if shift {
                        values[cell] += size;
                    }
                    errors[cell] = size;
                    let changed = Matrix::new(basis.clone(), basis.clone(), values)?;
                    Ok(Model::Matrix(if shift {
                        changed
                    } else {
                        changed.with_standard_errors(errors)?
                    }))
                })
                .unwrap()
        };
        let cell = 5 * n + 23;
        for k in 0..3 {
            for on_side in Side::BOTH {
                for on_scatter in Scatter::BOTH {
                    let replaced = |shift| {
                        let mut layers = plain.clone();
                        layers[k] = with_error(&plain[k], (on_side, on_scatter), cell, 1e-5, shift);
                        stack(&layers, &basis, PatchValue::Centre).unwrap()
                    };
                    let (exact, shifted) = (replaced(false), replaced(true));
                    for side in Side::BOTH {
                        for scatter in Scatter::BOTH {
                            let change: Vec<f64> = classic(&shifted, side, scatter)
                                .iter()
                                .zip(classic(&exact, side, scatter))
                                .map(|(a, b)| (a - b).abs())
                                .collect();
                            let model = exact.bsdf.component(None, side, scatter).unwrap().component;
                            let Model::Matrix(matrix) = &*model else {
                                unreachable!("no beams")
                            };
                            let errors = matrix.standard_errors().unwrap();
                            let largest = change.iter().copied().fold(0.0, f64::max);
                            assert!(
                                worst(&change, errors) < 1e-3 * largest + 1e-12,
                                "{k} {on_side:?} {on_scatter:?}"
                            );
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn what_is_wrong_names_the_layer() {
        let basis = full();
        let good = random(&basis, 9);
        let mut band = good.bands()[0].clone();
        band.set(Side::Interior, Scatter::Reflection, None);
        let dark = Bsdf::new(vec![band], Metadata::default()).unwrap();
        let coarse = random(&Arc::new(Basis::klems_half()), 9);
        let text = |layers: &[Bsdf]| stack(layers, &basis, PatchValue::Centre).unwrap_err().to_string();
        assert!(text(&[good.clone(), dark]).starts_with("layer 2, band \"visible\": "));
        let message = text(&[good.clone(), coarse]);
        assert!(
            message.contains("layer 2") && message.contains("Half") && message.contains("Full"),
            "{message}"
        );
        assert!(text(&[]).contains("at least one layer"));
        let other = Bsdf::new(vec![Band::new("solar")], Metadata::default()).unwrap();
        assert!(text(&[good, other]).contains("layer 1: visible; layer 2: solar"));
    }

    #[test]
    fn trapped_light_is_an_error() {
        // Light that gets in between two perfect mirrors, through a first one that data say is both.
        let leaky = specular(0.5, 1.0);
        let error = stack(&[leaky, specular(0.0, 1.0)], &full(), PatchValue::Centre).unwrap_err();
        assert!(error.to_string().contains("never leaves"), "{error}");
        // Mirrors that let nothing in trap nothing.
        assert!(stack(&[specular(0.0, 1.0), specular(0.0, 1.0)], &full(), PatchValue::Centre).is_ok());
        // Nor do panes at grazing incidence, where the outermost patches of this basis have their centres.
        let basis = Arc::new(Basis::iea21());
        let rings = basis.rings()[15..]
            .iter()
            .enumerate()
            .map(|(k, ring)| crate::basis::Ring {
                lower_deg: if k == 0 { 0.0 } else { ring.lower_deg },
                ..ring.clone()
            });
        let basis = Arc::new(Basis::from_rings("grazing", rings.collect()).unwrap());
        let glass = super::super::pane::pane(Slab::new(1.52, 0.95).unwrap(), "visible").unwrap();
        let layers = [glass.clone(), random(&basis, 10), glass.clone(), glass];
        let system = stack(&layers, &basis, PatchValue::Centre).unwrap();
        let absorbed = system.absorptance(None, Side::Interior).unwrap();
        assert!(absorbed.iter().flatten().all(|a| (-1e-9..1.0).contains(a)));
    }
}
