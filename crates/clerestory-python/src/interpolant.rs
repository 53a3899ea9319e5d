//! Models of measured distributions.

use clerestory::bsdf::Model;
use clerestory::bsdf::interpolant::{Distribution, Interpolant, Method, Points, State, Symmetry, fit};
use clerestory::direction::Disk;
use numpy::{PyArray1, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{directions, rows, same_length};
use crate::errors::ClerestoryError;
use crate::jobs::watched;
use crate::model::PyModel;

/// Distributions of measured points, one an incident direction.
#[pyclass(name = "Distributions", frozen, module = "clerestory")]
pub struct PyDistributions(Vec<Distribution>);

/// Incident direction, outgoing directions, BSDF and standard errors of the points, beam and its extent.
type Measured<'py> = (
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray2<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    PyReadonlyArray1<'py, f64>,
    f64,
    f64,
);

struct Given {
    incident: Disk,
    outgoing: Vec<Disk>,
    values: Vec<f64>,
    errors: Vec<f64>,
    beam: f64,
    extent: f64,
}

fn method(name: &str) -> PyResult<Method> {
    Method::ALL
        .into_iter()
        .find(|m| m.name() == name)
        .ok_or_else(|| ClerestoryError::new_err(format!("method {name:?} is not known (transport, linear or nearest)")))
}

fn symmetry(name: &str) -> PyResult<Symmetry> {
    Symmetry::ALL.into_iter().find(|s| s.name() == name).ok_or_else(|| {
        let names: Vec<_> = Symmetry::ALL.iter().map(|s| s.name()).collect();
        ClerestoryError::new_err(format!("symmetry {name:?} is not known ({})", names.join(", ")))
    })
}

#[pymethods]
impl PyDistributions {
    /// Lobes of the points of each incident direction.
    #[new]
    fn new(py: Python<'_>, measured: Vec<Measured<'_>>, progress: Option<Py<PyAny>>) -> PyResult<Self> {
        let given = measured
            .iter()
            .map(|(incident, outgoing, values, errors, beam, extent)| {
                let incident = directions(incident, "incident")?;
                let Some(incident) = incident.first() else {
                    return Err(ClerestoryError::new_err("an incident direction is missing"));
                };
                let outgoing: Vec<Disk> = directions(outgoing, "outgoing")?
                    .iter()
                    .map(|d| d.outgoing_disk())
                    .collect();
                let (values, errors) = (values.as_array().to_vec(), errors.as_array().to_vec());
                same_length(outgoing.len(), values.len())?;
                same_length(outgoing.len(), errors.len())?;
                Ok(Given {
                    incident: incident.incident_disk(),
                    outgoing,
                    values,
                    errors,
                    beam: *beam,
                    extent: *extent,
                })
            })
            .collect::<PyResult<Vec<_>>>()?;
        watched(py, progress.as_ref(), |watch| {
            watch.expect(given.len());
            given
                .par_iter()
                .map(|g| {
                    let points = Points {
                        outgoing: &g.outgoing,
                        values: &g.values,
                        errors: &g.errors,
                    };
                    let mut distribution = fit(g.incident, &points)?;
                    distribution.beam = g.beam;
                    distribution.extent = g.extent;
                    watch.step().map(|()| distribution)
                })
                .collect()
        })
        .map(Self)
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// Scattered light of each.
    fn scattered<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_iter(py, self.0.iter().map(Distribution::scattered))
    }

    /// Number of lobes of each.
    fn lobe_counts(&self) -> Vec<usize> {
        self.0.iter().map(|d| d.lobes.len()).collect()
    }

    /// With scattered light and beams multiplied by a factor each.
    fn scaled(&self, scattered: PyReadonlyArray1<'_, f64>, beam: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        same_length(self.0.len(), scattered.as_array().len())?;
        same_length(self.0.len(), beam.as_array().len())?;
        let factors = scattered.as_array().to_vec().into_iter().zip(beam.as_array().to_vec());
        let scale = |(d, (s, b)): (&Distribution, (f64, f64))| {
            let mut scaled = d.clone();
            scaled.floor *= s;
            scaled.beam *= b;
            scaled.lobes.iter_mut().for_each(|l| l.flux *= s);
            scaled
        };
        Ok(Self(self.0.iter().zip(factors).map(scale).collect()))
    }

    /// The model.
    fn model(
        &self,
        py: Python<'_>,
        symmetry_name: &str,
        method_name: &str,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<PyModel> {
        let (symmetry, method) = (symmetry(symmetry_name)?, method(method_name)?);
        watched(py, progress.as_ref(), |watch| {
            Interpolant::new(&self.0, symmetry, method, watch)
        })
        .map(|i| PyModel::of(Model::Interpolant(i)))
    }

    /// Of the measured directions `chosen`, each left out in turn, what the others say there: measured and found total, share of
    /// the light that is in another place, and angle between both maxima (radians); NaN where it lies beyond the others.
    fn held_out<'py>(
        &self,
        py: Python<'py>,
        symmetry_name: &str,
        method_name: &str,
        chosen: Vec<usize>,
    ) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
        let (symmetry, method) = (symmetry(symmetry_name)?, method(method_name)?);
        if let Some(k) = chosen.iter().find(|&&k| k >= self.0.len()) {
            return Err(ClerestoryError::new_err(format!("there is no distribution {k}")));
        }
        let found: Vec<[f64; 4]> = watched(py, None, |watch| {
            watch.expect(chosen.len());
            chosen
                .par_iter()
                .map(|&k| {
                    let state = Interpolant::held_out(&self.0, symmetry, method, k)?;
                    let own = &self.0[k];
                    let row = state.map_or([own.scattered() + own.beam, f64::NAN, f64::NAN, f64::NAN], |s| {
                        compared(own, &s)
                    });
                    watch.step().map(|()| row)
                })
                .collect()
        })?;
        rows(py, found.into_flattened(), 4)
    }
}

fn compared(own: &Distribution, state: &State) -> [f64; 4] {
    let (found, misplaced, angle) = own.compared(state);
    [own.scattered() + own.beam, found, misplaced, angle]
}

#[pymethods]
impl PyModel {
    /// Whether each pair of directions lies beyond what was measured; None for a model of another kind.
    fn extrapolated(
        &self,
        incident: PyReadonlyArray2<'_, f64>,
        outgoing: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<Option<Vec<bool>>> {
        let Model::Interpolant(model) = &*self.0 else {
            return Ok(None);
        };
        let (from, to) = (directions(&incident, "incident")?, directions(&outgoing, "outgoing")?);
        same_length(from.len(), to.len())?;
        let pairs = from.par_iter().zip(&to);
        Ok(Some(
            pairs
                .map(|(i, o)| model.extrapolated(i.incident_disk(), o.outgoing_disk()))
                .collect(),
        ))
    }

    /// Outgoing direction (x, y on the disk of travel) in which the scattered light of each incident direction is brightest.
    fn brightest<'py>(
        &self,
        py: Python<'py>,
        incident: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, numpy::PyArray2<f64>>> {
        let Model::Interpolant(model) = &*self.0 else {
            return Err(ClerestoryError::new_err(
                "only an interpolant knows where it is brightest",
            ));
        };
        let from = directions(&incident, "incident")?;
        let found: Vec<[f64; 2]> = from
            .par_iter()
            .map(|i| {
                let best = model.state(i.incident_disk()).brightest();
                [best.x, best.y]
            })
            .collect();
        rows(py, found.into_flattened(), 2)
    }
}
