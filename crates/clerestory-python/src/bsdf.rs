//! Data sets: the operations on arrays of directions.

use clerestory::bsdf::gather::{Light, gather};
use clerestory::bsdf::{Band, Bsdf, LobeSample, Lobes, Metadata, Part, Region, Scatterer, Turn};
use clerestory::direction::{Direction, Scatter, Side};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{directions, pairs, rows, same_length, scatter, side};
use crate::basis::PyBasis;
use crate::errors::{ClerestoryError, raise};
use crate::model::PyModel;

/// A data set of one sample.
#[pyclass(name = "Bsdf", frozen, module = "clerestory")]
#[derive(Clone)]
pub struct PyBsdf(pub Bsdf);

/// Name, source and detector spectrum, and models by side and scatter.
type BandParts<'py> = (
    String,
    Option<String>,
    Option<String>,
    Vec<(String, String, Bound<'py, PyModel>)>,
);

/// Models for the sides that an array of incident directions needs.
struct BySide([Option<Lobes>; 2]);

impl BySide {
    fn new(bsdf: &Bsdf, bands: &[Option<String>], incident: &[Direction], scatter: Option<Scatter>) -> PyResult<Self> {
        if bands.is_empty() {
            return Err(ClerestoryError::new_err("no bands were asked for (name one or more)"));
        }
        let bands: Vec<Option<&str>> = bands.iter().map(Option::as_deref).collect();
        let mut lobes = [None, None];
        for side in Side::BOTH {
            if incident.iter().any(|d| d.side() == side) {
                lobes[side as usize] = Some(Lobes::new(bsdf, &bands, side, scatter).map_err(raise)?);
            }
        }
        Ok(Self(lobes))
    }

    fn of(&self, incident: Direction) -> &Lobes {
        self.0[incident.side() as usize]
            .as_ref()
            .expect("made for every side that occurs")
    }
}

/// Which component answers each pair of directions, if it is the same for all of them.
fn one_scatter(incident: &[Direction], outgoing: &[Direction]) -> Option<Scatter> {
    let of = |i: &Direction, o: &Direction| {
        if i.side() == o.side() {
            Scatter::Reflection
        } else {
            Scatter::Transmission
        }
    };
    let first = of(incident.first()?, outgoing.first()?);
    incident
        .iter()
        .zip(outgoing)
        .all(|(i, o)| of(i, o) == first)
        .then_some(first)
}

/// A region from the words of the API.
#[derive(FromPyObject)]
pub enum RegionSpec<'py> {
    /// `("hemisphere",)` is None in Python; a cone or ring: axis (x, y on the disk), inner and outer angle (radians).
    Ring((f64, f64), f64, f64),
    /// Basis and 0-based patches.
    Patches(Bound<'py, PyBasis>, Vec<usize>),
}

fn region(spec: Option<&RegionSpec<'_>>) -> PyResult<Region> {
    Ok(match spec {
        None => Region::Hemisphere,
        Some(RegionSpec::Ring((x, y), inner, outer)) => {
            let axis = clerestory::direction::Disk::new(*x, *y);
            if *inner <= 0.0 {
                Region::Cone {
                    axis,
                    half_angle: *outer,
                }
            } else {
                Region::Ring {
                    axis,
                    inner: *inner,
                    outer: *outer,
                }
            }
        }
        Some(RegionSpec::Patches(basis, patches)) => {
            let basis = basis.get().0.clone();
            if let Some(p) = patches.iter().find(|&&p| p >= basis.len()) {
                return Err(ClerestoryError::new_err(format!(
                    "patch index {p} is not one of the {} of {}",
                    basis.len(),
                    basis.name()
                )));
            }
            Region::patches(basis, patches.clone())
        }
    })
}

/// `all`, `scattered` or `direct`.
pub fn part(name: &str) -> PyResult<Part> {
    match name {
        "all" => Ok(Part::All),
        "scattered" => Ok(Part::Scattered),
        "direct" => Ok(Part::Direct),
        _ => Err(ClerestoryError::new_err(format!(
            "part {name:?} is not known (give all, scattered or direct)"
        ))),
    }
}

#[pymethods]
impl PyBsdf {
    #[new]
    fn new(bands: Vec<BandParts<'_>>) -> PyResult<Self> {
        let bands = bands
            .into_iter()
            .map(|(name, source, detector, models)| {
                let mut band = Band::new(name);
                band.source_spectrum = source;
                band.detector_spectrum = detector;
                for (side_name, scatter_name, model) in models {
                    band.set(side(&side_name)?, scatter(&scatter_name)?, Some(model.get().0.clone()));
                }
                Ok(band)
            })
            .collect::<PyResult<_>>()?;
        Bsdf::new(bands, Metadata::default()).map(Self).map_err(raise)
    }

    /// Name, source and detector spectrum, and models by side and scatter, of every band.
    #[allow(clippy::type_complexity, reason = "a list of plain rows")]
    fn bands(
        &self,
    ) -> Vec<(
        String,
        Option<String>,
        Option<String>,
        Vec<(&'static str, &'static str, PyModel)>,
    )> {
        self.0
            .bands()
            .iter()
            .map(|band| {
                let models = band
                    .components()
                    .map(|(s, c, m)| (s.name(), c.name(), PyModel(m.clone())))
                    .collect();
                (
                    band.name.clone(),
                    band.source_spectrum.clone(),
                    band.detector_spectrum.clone(),
                    models,
                )
            })
            .collect()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    /// The model of a component and whether reciprocity gave it.
    fn component(&self, band: Option<&str>, side_name: &str, scatter_name: &str) -> PyResult<(PyModel, bool)> {
        let outcome = self
            .0
            .component(band, side(side_name)?, scatter(scatter_name)?)
            .map_err(raise)?;
        Ok((PyModel(outcome.component), outcome.by_reciprocity))
    }

    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
        outgoing: PyReadonlyArray2<'py, f64>,
        bands: Vec<Option<String>>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let (incident, outgoing) = (directions(&incident, "incident")?, directions(&outgoing, "outgoing")?);
        same_length(incident.len(), outgoing.len())?;
        let lobes = BySide::new(&self.0, &bands, &incident, one_scatter(&incident, &outgoing))?;
        let mut values = vec![0.0; incident.len() * bands.len()];
        py.detach(|| {
            values
                .par_chunks_exact_mut(bands.len())
                .zip(&incident)
                .zip(&outgoing)
                .with_min_len(4096)
                .for_each(|((values, i), o)| lobes.of(*i).evaluate(*i, *o, values));
        });
        rows(py, values, bands.len())
    }

    fn pdf<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
        outgoing: PyReadonlyArray2<'py, f64>,
        bands: Vec<Option<String>>,
        scatter_name: Option<&str>,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let (incident, outgoing) = (directions(&incident, "incident")?, directions(&outgoing, "outgoing")?);
        same_length(incident.len(), outgoing.len())?;
        let lobes = BySide::new(&self.0, &bands, &incident, scatter_name.map(scatter).transpose()?)?;
        let values: Vec<f64> = py.detach(|| {
            incident
                .par_iter()
                .zip(&outgoing)
                .with_min_len(4096)
                .map(|(i, o)| lobes.of(*i).pdf(*i, *o))
                .collect()
        });
        Ok(PyArray1::from_vec(py, values))
    }

    /// Outgoing directions (n, 3), weights (n, bands), whether a peak (n). Where nothing leaves the weights are 0.
    #[allow(clippy::type_complexity, reason = "three arrays")]
    fn sample<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
        u: PyReadonlyArray2<'py, f64>,
        bands: Vec<Option<String>>,
        scatter_name: Option<&str>,
    ) -> PyResult<(
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray2<f64>>,
        Bound<'py, PyArray1<bool>>,
    )> {
        let incident = directions(&incident, "incident")?;
        let u = pairs(&u, "u")?;
        same_length(incident.len(), u.len())?;
        let lobes = BySide::new(&self.0, &bands, &incident, scatter_name.map(scatter).transpose()?)?;
        let mut outgoing = vec![0.0; 3 * incident.len()];
        let mut weights = vec![0.0; incident.len() * bands.len()];
        let mut peak = vec![false; incident.len()];
        py.detach(|| {
            outgoing
                .par_chunks_exact_mut(3)
                .zip(weights.par_chunks_exact_mut(bands.len()))
                .zip(&mut peak)
                .zip(&incident)
                .zip(&u)
                .with_min_len(4096)
                .for_each(|((((to, weights), peak), i), u)| {
                    let sample = lobes.of(*i).sample(*i, *u, weights);
                    *peak = sample.is_some_and(|s| s.peak);
                    to.copy_from_slice(
                        &sample.map_or([0.0, 0.0, 1.0], |LobeSample { outgoing: o, .. }| [o.x, o.y, o.z]),
                    );
                });
        });
        Ok((
            rows(py, outgoing, 3)?,
            rows(py, weights, bands.len())?,
            PyArray1::from_vec(py, peak),
        ))
    }

    /// Flux into a region per unit of incident flux (n), and its standard error (NaN where none is known).
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of the Python API")]
    #[allow(clippy::type_complexity, reason = "two arrays")]
    fn integrate<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
        band: Option<&str>,
        scatter_name: &str,
        region_spec: Option<RegionSpec<'py>>,
        part_name: &str,
    ) -> PyResult<(Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<f64>>)> {
        let incident = directions(&incident, "incident")?;
        let (region, part, scatter) = (region(region_spec.as_ref())?, part(part_name)?, scatter(scatter_name)?);
        let models = self.models(band, &incident, scatter)?;
        let estimates: Vec<_> = py.detach(|| {
            incident
                .par_iter()
                .map(|i| {
                    let model = models[i.side() as usize]
                        .as_ref()
                        .expect("made for every side that occurs");
                    model.integrate(i.incident_disk(), &region, part)
                })
                .collect()
        });
        let values: Vec<f64> = estimates.iter().map(|e| e.value).collect();
        let errors: Vec<f64> = estimates.iter().map(|e| e.standard_error.unwrap_or(f64::NAN)).collect();
        Ok((values.to_pyarray(py), errors.to_pyarray(py)))
    }

    /// Peaks of all incident directions: row of the direction, outgoing direction, value, extent (radians).
    #[allow(clippy::type_complexity, reason = "a list of plain rows")]
    fn peaks(
        &self,
        incident: PyReadonlyArray2<'_, f64>,
        band: Option<&str>,
        scatter_name: &str,
    ) -> PyResult<Vec<(usize, (f64, f64, f64), f64, f64)>> {
        let incident = directions(&incident, "incident")?;
        let scatter = scatter(scatter_name)?;
        let models = self.models(band, &incident, scatter)?;
        let mut rows = Vec::new();
        for (row, i) in incident.iter().enumerate() {
            let model = models[i.side() as usize]
                .as_ref()
                .expect("made for every side that occurs");
            for peak in model.peaks(i.incident_disk()) {
                let d = peak.outgoing.outgoing(scatter.outgoing_side(i.side()));
                rows.push((row, (d.x, d.y, d.z), peak.value, peak.extent));
            }
        }
        Ok(rows)
    }

    /// Scattered radiance (m, groups) of outgoing directions (m) by lights that give `irradiance` (n) to the sample's
    /// plane from incident directions (n) of one side, summed in their `group` (n).
    #[allow(clippy::too_many_arguments)]
    fn gather<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
        irradiance: Vec<f64>,
        group: Vec<usize>,
        groups: usize,
        outgoing: PyReadonlyArray2<'py, f64>,
        band: Option<&str>,
        scatter_name: &str,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let (incident, outgoing) = (directions(&incident, "incident")?, directions(&outgoing, "outgoing")?);
        same_length(incident.len(), irradiance.len())?;
        same_length(incident.len(), group.len())?;
        if let Some(wrong) = group.iter().find(|&&g| g >= groups) {
            return Err(ClerestoryError::new_err(format!(
                "group {wrong} is not one of {groups} (count them from 0)"
            )));
        }
        let rows = outgoing.len();
        let mut values = vec![0.0; rows * groups];
        if let Some(side) = incident.first().map(|d| d.side()) {
            if incident.iter().any(|d| d.side() != side) {
                return Err(ClerestoryError::new_err(
                    "incident directions of both sides (give those of one)",
                ));
            }
            let model = self
                .0
                .component(band, side, scatter(scatter_name)?)
                .map_err(raise)?
                .component;
            let lights: Vec<Light> = incident
                .iter()
                .zip(irradiance)
                .zip(group)
                .map(|((d, irradiance), group)| Light {
                    incident: d.incident_disk(),
                    irradiance,
                    group,
                })
                .collect();
            let outgoing: Vec<_> = outgoing.iter().map(|d| d.outgoing_disk()).collect();
            values = py.detach(|| gather(&*model, &lights, groups, &outgoing));
        }
        PyArray1::from_vec(py, values).reshape([rows, groups])
    }

    /// Full angle below which detail is not resolved (n), radians.
    fn resolution<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
        band: Option<&str>,
        scatter_name: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let incident = directions(&incident, "incident")?;
        let models = self.models(band, &incident, scatter(scatter_name)?)?;
        let values: Vec<f64> = incident
            .iter()
            .map(|i| {
                let model = models[i.side() as usize]
                    .as_ref()
                    .expect("made for every side that occurs");
                model.resolution(i.incident_disk())
            })
            .collect();
        Ok(values.to_pyarray(py))
    }

    /// With components that it has (band, side, scatter) replaced by others.
    fn with_components(&self, parts: Vec<(String, String, String, Bound<'_, PyModel>)>) -> PyResult<Self> {
        self.0
            .try_map(|band, side, scatter, model| {
                let part = parts
                    .iter()
                    .find(|(b, s, c, _)| b == band && s == side.name() && c == scatter.name());
                Ok(part.map_or_else(|| model.clone(), |(_, _, _, m)| (*m.get().0).clone()))
            })
            .map(Self)
            .map_err(raise)
    }

    fn flipped(&self) -> Self {
        Self(self.0.flipped())
    }

    /// Mirrored (left to right) if asked for, then turned counter-clockwise as seen from the room (radians).
    fn turned(&self, angle: f64, mirror: bool) -> PyResult<Self> {
        self.0.turned(Turn::new(angle, mirror)).map(Self).map_err(raise)
    }

    #[staticmethod]
    fn merged(sets: Vec<Bound<'_, PyBsdf>>) -> PyResult<Self> {
        let sets: Vec<Bsdf> = sets.iter().map(|s| s.get().0.clone()).collect();
        Bsdf::merged(&sets).map(Self).map_err(raise)
    }
}

impl PyBsdf {
    fn models(
        &self,
        band: Option<&str>,
        incident: &[Direction],
        scatter: Scatter,
    ) -> PyResult<[Option<clerestory::bsdf::Component>; 2]> {
        let mut models = [None, None];
        for side in Side::BOTH {
            if incident.iter().any(|d| d.side() == side) {
                models[side as usize] = Some(self.0.component(band, side, scatter).map_err(raise)?.component);
            }
        }
        Ok(models)
    }
}
