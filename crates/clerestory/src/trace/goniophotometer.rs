//! Incident directions in, tables with standard errors out.

use std::sync::Arc;

use super::balance::Tallies;
use super::sample::Sample;
use super::scene::{Scene, with_bands};
use super::settings::{Settings, Stop};
use super::state::{State, Unit};
use super::unit::{Bench, Layout, Source};
use crate::basis::Basis;
use crate::bsdf::reciprocity::reciprocal_average;
use crate::bsdf::{Band, Beam, Bsdf, Cells, Estimate, Matrix, Metadata, Model, Sum};
use crate::direction::{Scatter, Side};
use crate::error::Result;
use crate::progress::Progress;

/// An instrument that looks at a sample from every direction.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Goniophotometer {
    /// How it works.
    pub settings: Settings,
}

/// What became of the light of one incident patch, cell or direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Place {
    /// Side that it came from.
    pub side: Side,
    /// Number of the incident patch, cell or direction.
    pub number: usize,
    /// Paths traced.
    pub paths: u64,
    /// Largest relative standard error of its direct-hemispherical values; values below
    /// [`LEAST_VALUE`](super::LEAST_VALUE) count as that.
    pub error: f64,
    /// Tallies, one a band.
    pub balance: Vec<Tallies>,
}

/// Direct-hemispherical values of one component, all light.
#[derive(Debug, Clone, PartialEq)]
pub struct Totals {
    /// Name of the band.
    pub band: String,
    /// Side that light came from.
    pub side: Side,
    /// Transmitted or reflected.
    pub scatter: Scatter,
    /// One an incident patch, cell or direction, each with its standard error from whole replications.
    pub values: Vec<Estimate>,
    /// Of evenly diffuse light; None for listed directions.
    pub hemispherical: Option<Estimate>,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct Measured {
    /// The models: scattered light as tables, light straight on as beams beside them. Its warnings tell of errors that were
    /// not reached and of lost light.
    pub bsdf: Bsdf,
    /// Tallies of all paths, one a band.
    pub balance: Vec<Tallies>,
    /// The same by incident patch or cell.
    pub places: Vec<Place>,
    /// Direct-hemispherical values, band by band.
    pub totals: Vec<Totals>,
    /// Largest relative standard error of direct-hemispherical values.
    pub error: f64,
    /// Paths traced.
    pub paths: u64,
}

impl Goniophotometer {
    /// Matrices on a pair of bases, with a standard error a value. What the state holds is not measured again; after an
    /// interruption it holds what was finished.
    pub fn matrices(
        &self,
        sample: &Sample,
        incident: &Arc<Basis>,
        outgoing: &Arc<Basis>,
        state: &mut State,
        progress: &Progress,
    ) -> Result<Measured> {
        self.settings.check()?;
        with_bands!(sample, self.matrices_of(incident, outgoing, state, progress))
    }

    fn matrices_of<const N: usize>(
        &self,
        scene: &Scene<'_>,
        incident: &Arc<Basis>,
        outgoing: &Arc<Basis>,
        state: &mut State,
        progress: &Progress,
    ) -> Result<Measured> {
        let bench = Bench {
            scene,
            settings: &self.settings,
            area: scene.sample.area()?,
            incident,
            outgoing,
        };
        let patches = incident.len();
        let sides = &self.settings.sides;
        let work: Vec<(Side, Source)> = sides
            .iter()
            .flat_map(|&side| (0..patches).map(move |p| (side, Source::Patch(p))))
            .collect();
        bench.measure::<N>(&work, state, progress)?;
        let units: Vec<&Unit> = state.units().collect();
        let layout = bench.layout();
        let mut bands: Vec<Band> = scene.sample.bands.iter().map(Band::new).collect();
        let mut totals = Vec::new();
        for (b, band) in bands.iter_mut().enumerate() {
            for (of_side, &side) in units.chunks(patches).zip(sides) {
                for scatter in Scatter::BOTH {
                    let model = component(layout, of_side, scatter, b, incident, outgoing)?;
                    band.set(side, scatter, Some(Arc::new(model)));
                    let values = of_side
                        .iter()
                        .map(|unit| estimate(layout.total(unit, scatter, b)))
                        .collect();
                    totals.push(Totals {
                        band: band.name.clone(),
                        side,
                        scatter,
                        hemispherical: Some(hemispherical(&values, |p| incident.projected_solid_angle(p))),
                        values,
                    });
                }
            }
        }
        let bsdf = Bsdf::new(bands, Metadata::default())?;
        let places = places(&units, sides, layout.bands, |unit| layout.worst(unit));
        self.finished(bsdf, places, totals)
    }

    /// Reciprocity, sums over all places, and what people must know.
    pub(super) fn finished(&self, mut bsdf: Bsdf, places: Vec<Place>, totals: Vec<Totals>) -> Result<Measured> {
        if self.settings.reciprocal {
            bsdf = reciprocal_average(&bsdf)?;
        }
        bsdf.warnings.extend(self.warnings(&places));
        Ok(Measured {
            bsdf,
            balance: summed(&places),
            error: places.iter().map(|p| p.error).fold(0.0, f64::max),
            paths: places.iter().map(|p| p.paths).sum(),
            places,
            totals,
        })
    }

    pub(super) fn warnings(&self, places: &[Place]) -> Vec<String> {
        let mut warnings = Vec::new();
        if let Stop::Error { error, most } = self.settings.stop {
            let missed: Vec<&Place> = places.iter().filter(|p| p.error > error).collect();
            if let Some(worst) = missed.iter().max_by(|a, b| a.error.total_cmp(&b.error)) {
                warnings.push(format!(
                    "a relative standard error of {error} was not reached with {most} paths in {} of {} incident patches and \
                     sides; the largest is {:.2e}, patch {} from the {}",
                    missed.len(),
                    places.len(),
                    worst.error,
                    worst.number + 1,
                    worst.side.name()
                ));
            }
        }
        let share = |k: usize| {
            let shares = summed(places).into_iter().map(|tallies| tallies[k] / tallies[0]);
            shares.fold(0.0, f64::max)
        };
        for (k, what) in [
            (5, "was cut off after the greatest number of events"),
            (
                6,
                "was lost: the geometry has holes, overlaps, or directions that cannot be followed",
            ),
        ] {
            if share(k) > 1e-6 {
                warnings.push(format!("{:.2e} of the light {what}", share(k)));
            }
        }
        warnings
    }
}

pub(super) fn summed(places: &[Place]) -> Vec<Tallies> {
    let mut sums = vec![[0.0; 7]; places.first().map_or(0, |p| p.balance.len())];
    for place in places {
        for (sum, tallies) in sums.iter_mut().zip(&place.balance) {
            sum.iter_mut().zip(tallies).for_each(|(s, t)| *s += t);
        }
    }
    sums
}

/// Places of units listed side by side.
pub(super) fn places(units: &[&Unit], sides: &[Side], bands: usize, error: impl Fn(&Unit) -> f64) -> Vec<Place> {
    let each = units.len() / sides.len();
    units
        .iter()
        .enumerate()
        .map(|(k, unit)| Place {
            side: sides[k / each],
            number: k % each,
            paths: unit.paths,
            error: error(unit),
            balance: (0..bands)
                .map(|b| std::array::from_fn(|k| unit.balance[7 * b + k]))
                .collect(),
        })
        .collect()
}

pub(super) fn estimate([value, error]: [f64; 2]) -> Estimate {
    Estimate {
        value,
        standard_error: Some(error),
    }
}

/// Mean of independent values by weights.
#[allow(clippy::ptr_arg)] // As the callers hold it.
pub(super) fn hemispherical(values: &Vec<Estimate>, weight: impl Fn(usize) -> f64) -> Estimate {
    let (mut sum, mut mean, mut variance) = (0.0, 0.0, 0.0);
    for (k, value) in values.iter().enumerate() {
        let w = weight(k);
        sum += w;
        mean += w * value.value;
        variance += (w * value.standard_error.unwrap_or(0.0)).powi(2);
    }
    estimate([mean / sum, variance.sqrt() / sum])
}

/// Scattered light as a matrix, with a beam where there is one.
fn component(
    layout: Layout,
    units: &[&Unit],
    scatter: Scatter,
    band: usize,
    incident: &Arc<Basis>,
    outgoing: &Arc<Basis>,
) -> Result<Model> {
    let areas = outgoing.projected_solid_angles();
    let mut values = Vec::with_capacity(units.len() * areas.len());
    let mut errors = Vec::with_capacity(values.capacity());
    for unit in units {
        for (o, area) in areas.iter().enumerate() {
            let [mean, error] = layout.get(unit, scatter, band, o);
            values.push(mean / area);
            errors.push(error / area);
        }
    }
    let beside = |k: usize| {
        units
            .iter()
            .map(move |unit| layout.get(unit, scatter, band, layout.patches + k))
    };
    let matrix = Matrix::new(incident.clone(), outgoing.clone(), values)?
        .with_standard_errors(errors)?
        .with_total_standard_errors(beside(1).map(|[_, error]| error).collect())?;
    let matrix = Model::Matrix(matrix);
    if beside(0).all(|[value, _]| value == 0.0) {
        return Ok(matrix);
    }
    let beam = Beam::new(Cells::Patches(incident.clone()), beside(0).map(|[v, _]| v).collect())?
        .with_standard_errors(beside(0).map(|[_, e]| e).collect())?;
    let parts = [matrix, Model::Beam(beam)].map(|m| (1.0, Arc::new(m)));
    Ok(Model::Sum(Sum::new(parts.to_vec())?))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::bsdf::{Part, Scatterer};
    use crate::direction::Disk;
    use crate::error::Error;
    use crate::material::Material;
    use crate::sequence::uniform;
    use crate::trace::Cones;
    use crate::trace::testing::{blind, empty, fused, lambertian, sheet, stretches};

    fn quarter() -> Arc<Basis> {
        Arc::new(Basis::klems_quarter())
    }

    fn instrument(paths: u64, sides: &[Side]) -> Goniophotometer {
        Goniophotometer {
            settings: Settings {
                sides: sides.to_vec(),
                stop: Stop::Paths(paths),
                seed: 1,
                ..Settings::default()
            },
        }
    }

    fn measure(instrument: &Goniophotometer, sample: &Sample, basis: &Arc<Basis>) -> Measured {
        instrument
            .matrices(sample, basis, basis, &mut State::new(""), &Progress::default())
            .expect("it runs")
    }

    fn model(measured: &Measured, side: Side, scatter: Scatter) -> Arc<Model> {
        measured
            .bsdf
            .component(None, side, scatter)
            .expect("is there")
            .component
    }

    fn same(a: &Measured, b: &Measured) {
        assert_eq!(format!("{a:?}"), format!("{b:?}"));
    }

    #[test]
    fn flat_slats_of_the_round_robin_pass_what_radiosity_says() {
        for (reflectance, expected) in [(0.0, 0.383_74), (0.5, 0.480_36), (0.7, 0.538_47)] {
            let full = Arc::new(Basis::klems_full());
            let measured = measure(&instrument(4096, &[Side::Exterior]), &blind(reflectance), &full);
            let totals = &measured.totals[0];
            assert_eq!((totals.side, totals.scatter), (Side::Exterior, Scatter::Transmission));
            let Estimate { value, standard_error } = totals.hemispherical.expect("a basis");
            // Radiosity of 400 strips a face.
            let error = standard_error.expect("is known");
            assert!(
                error > 0.0 && error < 0.001 && (value - expected).abs() < 0.001,
                "{reflectance}: {value} {error}"
            );
            let [traced, rest @ ..] = measured.balance[0];
            assert!((rest.iter().sum::<f64>() / traced - 1.0).abs() < 1e-9);
            for place in &measured.places {
                let [traced, rest @ ..] = place.balance[0];
                assert!(traced == 4096.0 && (rest.iter().sum::<f64>() / traced - 1.0).abs() < 1e-9);
            }
            assert!(measured.bsdf.warnings.is_empty(), "{:?}", measured.bsdf.warnings);
        }
    }

    #[test]
    fn nothing_lets_all_light_through_as_a_beam() {
        let measured = measure(&instrument(64, &Side::BOTH), &empty(), &quarter());
        for side in Side::BOTH {
            let through = model(&measured, side, Scatter::Transmission);
            for k in 0..41 {
                let i = quarter().centre(k);
                let Estimate { value, standard_error } = through.total(i, Part::Direct);
                assert!(value == 1.0 && standard_error == Some(0.0));
                assert_eq!(through.total(i, Part::Scattered).value, 0.0);
            }
            let Model::Matrix(table) = through.unseparated() else {
                panic!("a table")
            };
            assert!((table.direct_hemispherical(7) - 1.0).abs() < 1e-12);
            assert_eq!(model(&measured, side, Scatter::Reflection).kind(), "matrix");
        }
    }

    #[test]
    fn a_diffusing_sheet_scatters_evenly() {
        let sample = sheet(lambertian(0.5, 0.3, 1), 1);
        let measured = measure(&instrument(1 << 14, &[Side::Interior]), &sample, &quarter());
        for (scatter, value) in [(Scatter::Transmission, 0.3), (Scatter::Reflection, 0.5)] {
            let model = model(&measured, Side::Interior, scatter);
            let Model::Matrix(table) = &*model else {
                panic!("no beam")
            };
            let errors = table.standard_errors().expect("are known");
            let far = table
                .values()
                .iter()
                .zip(errors)
                .filter(|(v, e)| (*v - value / PI).abs() > 3.0 * **e)
                .count();
            assert!(far < table.values().len() / 50, "{far} of {}", table.values().len());
            for k in 0..41 {
                let total = model.total(quarter().centre(k), Part::All);
                let error = total.standard_error.expect("is known");
                assert!(
                    error < 2e-4 && (total.value - value).abs() < 5.0 * error.max(1e-5),
                    "{k} {total:?}"
                );
            }
        }
        // Each path leaves once.
        assert!((measured.balance[0][3] / measured.balance[0][0] - 0.2).abs() < 1e-12);
    }

    #[test]
    fn mirror_slats_pass_or_mirror_beams_exactly() {
        // Flat mirrors across the plane: each path stays in its patch's mirror image, without loss.
        let mirrors = || Material::Mirror { reflectance: vec![0.9] };
        let sample = stretches(&[[[-0.04, 0.0], [0.04, 0.0]]], 0.072, mirrors(), 1);
        let measured = measure(&instrument(4096, &[Side::Exterior]), &sample, &quarter());
        let through = model(&measured, Side::Exterior, Scatter::Transmission);
        let straight = through.total(Disk::from_angles(0.5, 0.0), Part::Direct).value;
        assert!(straight > 0.5, "{straight}");
        assert_eq!(measured.balance[0][2], 0.0, "flat horizontal mirrors send nothing back");
        let [traced, transmitted, _, absorbed, roulette, ..] = measured.balance[0];
        assert!((transmitted + absorbed + roulette - traced).abs() < 1e-9 * traced);
        assert!(roulette.abs() < 0.01 * traced);
    }

    #[test]
    fn a_mirror_in_the_plane_gives_a_reflected_beam() {
        let sample = sheet(Material::Mirror { reflectance: vec![0.8] }, 1);
        let measured = measure(&instrument(64, &[Side::Exterior]), &sample, &quarter());
        let back = model(&measured, Side::Exterior, Scatter::Reflection);
        for k in 0..41 {
            assert!((back.total(quarter().centre(k), Part::Direct).value - 0.8).abs() < 1e-12);
        }
    }

    #[test]
    fn many_bands_travel_in_one_path() {
        for bands in [5, 17, 64] {
            let mut material = lambertian(0.0, 0.0, bands);
            let Material::Lambertian { reflectance, .. } = &mut material else {
                unreachable!()
            };
            for (b, r) in reflectance.iter_mut().enumerate() {
                *r = (b + 1) as f64 / 100.0;
            }
            let measured = measure(&instrument(256, &[Side::Exterior]), &sheet(material, bands), &quarter());
            assert_eq!((measured.bsdf.bands().len(), measured.balance.len()), (bands, bands));
            for (b, tallies) in measured.balance.iter().enumerate() {
                let share = (b + 1) as f64 / 100.0;
                assert!((tallies[2] / tallies[0] - share).abs() < 1e-9 && tallies[0] == 256.0 * 41.0);
            }
        }
        let sample = sheet(lambertian(0.5, 0.0, 65), 65);
        let state = &mut State::new("");
        let basis = quarter();
        let outcome = instrument(64, &Side::BOTH).matrices(&sample, &basis, &basis, state, &Progress::default());
        assert!(outcome.unwrap_err().to_string().contains("64"));
    }

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let with = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| measure(&instrument(512, &Side::BOTH), &blind(0.6), &quarter()))
        };
        same(&with(1), &with(2));
        // Few units are cut up otherwise.
        let basis = Arc::new(
            Basis::from_rings(
                "one",
                vec![crate::basis::Ring {
                    lower_deg: 0.0,
                    upper_deg: 90.0,
                    nominal_deg: 0.0,
                    count: 1,
                }],
            )
            .expect("a cap"),
        );
        let one = |threads| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .expect("a pool");
            pool.install(|| measure(&instrument(512, &[Side::Exterior]), &blind(0.6), &basis))
        };
        same(&one(1), &one(2));
    }

    #[test]
    fn an_interrupted_measurement_goes_on_as_if_nothing_had_been() {
        let instruments = [
            instrument(1 << 12, &Side::BOTH),
            Goniophotometer {
                settings: Settings {
                    stop: Stop::Error {
                        error: 0.01,
                        most: 1 << 16,
                    },
                    ..Settings::default()
                },
            },
        ];
        for instrument in instruments {
            let basis = quarter();
            let whole = measure(&instrument, &blind(0.6), &basis);
            let mut state = State::new("blind");
            let (sample, progress) = fused(blind(0.6), 300_000);
            let outcome = instrument.matrices(&sample, &basis, &basis, &mut state, &progress);
            assert_eq!(outcome.unwrap_err(), Error::Interrupted);
            let (done, all) = state.done();
            assert!(done > 0 && done < all && all == 82, "{done} {all}");
            let mut state = State::from_arrays("blind", "blind", &state.to_arrays()).expect("is sound");
            let progress = Progress::default();
            let again = instrument
                .matrices(&blind(0.6), &basis, &basis, &mut state, &progress)
                .expect("it goes on");
            same(&whole, &again);
            assert_eq!((state.done(), progress.fraction()), ((82, 82), 1.0));
            // Nothing is left to do.
            let (sample, progress) = fused(blind(0.6), 0);
            same(
                &whole,
                &instrument
                    .matrices(&sample, &basis, &basis, &mut state, &progress)
                    .expect("all is there"),
            );
            let other = instrument.matrices(
                &sheet(lambertian(0.5, 0.0, 2), 2),
                &basis,
                &basis,
                &mut state,
                &progress,
            );
            assert!(other.is_err());
        }
    }

    #[test]
    fn an_error_is_reached_or_the_result_says_that_it_was_not() {
        let mut instrument = instrument(1, &[Side::Exterior]);
        let aim = |error, most| Stop::Error { error, most };
        instrument.settings.stop = aim(0.005, 1 << 20);
        let measured = measure(&instrument, &blind(0.5), &quarter());
        assert!(
            measured.error <= 0.005 && measured.bsdf.warnings.is_empty(),
            "{:?}",
            measured.bsdf.warnings
        );
        assert!(measured.paths < 41 << 18, "{}", measured.paths);
        let counts: Vec<u64> = measured.places.iter().map(|p| p.paths).collect();
        assert!(
            counts.iter().max() > counts.iter().min(),
            "each patch gets what it needs: {counts:?}"
        );
        instrument.settings.stop = aim(0.0005, 2048);
        let measured = measure(&instrument, &blind(0.5), &quarter());
        assert!(measured.error > 0.0005 && measured.bsdf.warnings[0].contains("was not reached"));
    }

    #[test]
    fn standard_errors_are_honest() {
        let basis = quarter();
        let runs: Vec<Measured> = (0..24)
            .map(|seed| {
                let mut instrument = instrument(2048, &[Side::Exterior]);
                instrument.settings.seed = seed;
                measure(&instrument, &blind(0.6), &basis)
            })
            .collect();
        let z = |values: &[(f64, f64)]| {
            let n = values.len() as f64;
            let mean = values.iter().map(|v| v.0).sum::<f64>() / n;
            let variance = values.iter().map(|v| (v.0 - mean).powi(2)).sum::<f64>() / (n - 1.0);
            let claimed = values.iter().map(|v| v.1 * v.1).sum::<f64>() / n;
            (claimed > 1e-16).then(|| variance / claimed)
        };
        // Totals of the component and cells, over all incident patches.
        let model = |run: &Measured| model(run, Side::Exterior, Scatter::Transmission);
        let mut ratios = [Vec::new(), Vec::new(), Vec::new()];
        for k in 0..41 {
            let i = basis.centre(k);
            for (part, ratios) in [Part::Scattered, Part::Direct].into_iter().zip(&mut ratios) {
                let values: Vec<(f64, f64)> = runs
                    .iter()
                    .map(|run| {
                        let total = model(run).total(i, part);
                        (total.value, total.standard_error.expect("is known"))
                    })
                    .collect();
                ratios.extend(z(&values));
            }
            let values: Vec<(f64, f64)> = runs
                .iter()
                .map(|run| {
                    let patches = crate::bsdf::Region::patches(basis.clone(), vec![(k + 7) % 41]);
                    let Model::Sum(sum) = &*model(run) else {
                        panic!("with a beam")
                    };
                    let flux = sum.parts()[0].1.integrate(i, &patches, Part::All);
                    (flux.value, flux.standard_error.expect("is known"))
                })
                .collect();
            ratios[2].extend(z(&values));
        }
        for of in ratios {
            let mean = of.iter().sum::<f64>() / of.len() as f64;
            assert!(of.len() > 20 && (0.8..1.25).contains(&mean), "{mean} of {}", of.len());
        }
    }

    #[test]
    fn the_lattice_is_better_than_random_numbers() {
        // The standard error of random numbers is that of a share of hits.
        let measured = measure(&instrument(4096, &[Side::Exterior]), &blind(0.0), &quarter());
        let (mut lattice, mut random) = (0.0, 0.0);
        for total in &measured.totals[0].values {
            lattice += total.standard_error.expect("is known").powi(2);
            random += total.value * (1.0 - total.value) / 4096.0;
        }
        assert!(lattice < 0.25 * random, "{}", lattice / random);
    }

    #[test]
    fn cones_smear_beams_and_keep_the_light() {
        let mut instrument = instrument(4096, &[Side::Exterior]);
        instrument.settings.cones = Cones {
            source: 0.0,
            detector: 30_f64.to_radians(),
        };
        let measured = measure(&instrument, &empty(), &quarter());
        let through = model(&measured, Side::Exterior, Scatter::Transmission);
        let Model::Matrix(table) = &*through else {
            panic!("no beam is left")
        };
        for k in 0..41 {
            assert!((table.direct_hemispherical(k) - 1.0).abs() < 1e-12);
        }
        let outside = 1.0 - table.value(0, 0) * quarter().projected_solid_angle(0);
        assert!(outside > 0.3, "{outside}");
        // A source cone alone stays in the patch that it is in the middle of.
        instrument.settings.cones = Cones {
            source: 0.01,
            detector: 0.0,
        };
        let measured = measure(&instrument, &empty(), &quarter());
        let through = model(&measured, Side::Exterior, Scatter::Transmission);
        let Model::Matrix(table) = &*through else {
            panic!("no beam is left")
        };
        assert!((0..41).all(|k| (table.value(k, k) * quarter().projected_solid_angle(k) - 1.0).abs() < 1e-12));
    }

    #[test]
    fn reciprocity_halves_the_difference() {
        let mut instrument = instrument(1024, &Side::BOTH);
        instrument.settings.reciprocal = true;
        let measured = measure(&instrument, &blind(0.6), &quarter());
        let models = Side::BOTH.map(|side| model(&measured, side, Scatter::Transmission));
        let error = crate::bsdf::reciprocity::reciprocity_error(&models[0].unseparated(), &models[1].unseparated());
        assert!(error.expect("it is not dark") < 1e-12, "{error:?}");
        assert_eq!(models[0].kind(), "sum");
        let sum: f64 = (0..100)
            .map(|k| {
                models[0]
                    .total(Disk::uniform([uniform(1, k), uniform(2, k)]), Part::All)
                    .value
            })
            .sum();
        assert!((sum / 100.0 - 0.51).abs() < 0.05, "{sum}");
    }
}
