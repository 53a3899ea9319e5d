//! Data sets made of other data sets.

use clerestory::bsdf::convert::{Report, Sampling, all_to_matrix};
use pyo3::prelude::*;

use crate::basis::PyBasis;
use crate::bsdf::PyBsdf;
use crate::errors::raise;
use crate::jobs::watched;

/// Band, side, scatter, kind of the source, samples, RMS error, worst direct-hemispherical difference.
type ReportRow = (String, &'static str, &'static str, &'static str, u32, f64, Option<f64>);

fn rows(reports: Vec<Report>) -> Vec<ReportRow> {
    reports
        .into_iter()
        .map(|r| {
            (
                r.band,
                r.side.name(),
                r.scatter.name(),
                r.source,
                r.samples,
                r.rms_error,
                r.worst_direct_hemispherical,
            )
        })
        .collect()
}

#[pymethods]
impl PyBsdf {
    /// All components as matrices.
    fn to_matrix(
        &self,
        py: Python<'_>,
        incident: &PyBasis,
        outgoing: &PyBasis,
        samples: u32,
        seed: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Self, Vec<ReportRow>)> {
        let sampling = Sampling { samples, seed };
        let (bsdf, reports) = watched(py, progress.as_ref(), |watch| {
            all_to_matrix(&self.0, &incident.0, &outgoing.0, sampling, watch)
        })?;
        Ok((Self(bsdf), rows(reports)))
    }

    /// Only the bands that are named, in that order.
    fn with_bands(&self, names: Vec<String>) -> PyResult<Self> {
        self.0.with_bands(&names).map(Self).map_err(raise)
    }
}
