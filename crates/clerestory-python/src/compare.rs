//! Distances between models.

use clerestory::compare::{Distance, pairwise};
use numpy::{PyArray2, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::directions;
use crate::jobs::watched;
use crate::model::PyModel;

/// Relative L1 and transport distance (radians, NaN where one model is dark) between the first `own` models and all
/// others, in the order (0, 1), (0, 2) … (1, 2) …, for each incident direction: two arrays (pairs, incident).
#[pyfunction]
#[pyo3(signature = (models, own, incident, progress=None))]
#[allow(clippy::type_complexity, reason = "two arrays")]
pub fn distances<'py>(
    py: Python<'py>,
    models: Vec<Bound<'py, PyModel>>,
    own: usize,
    incident: PyReadonlyArray2<'py, f64>,
    progress: Option<Py<PyAny>>,
) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>)> {
    let models: Vec<_> = models.iter().map(|m| m.get().0.clone()).collect();
    let incident: Vec<_> = directions(&incident, "incident")?
        .iter()
        .map(|d| d.incident_disk())
        .collect();
    let pairs = watched(py, progress.as_ref(), |watch| pairwise(&models, own, &incident, watch))?;
    let array = |of: fn(&Distance) -> f64| {
        let rows: Vec<Vec<f64>> = pairs.iter().map(|pair| pair.iter().map(of).collect()).collect();
        if rows.is_empty() {
            return Ok(PyArray2::zeros(py, [0, incident.len()], false));
        }
        PyArray2::from_vec2(py, &rows).map_err(PyErr::from)
    };
    Ok((array(|d| d.relative_l1)?, array(|d| d.transport.unwrap_or(f64::NAN))?))
}
