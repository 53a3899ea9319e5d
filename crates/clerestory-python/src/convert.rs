//! Data sets made of other data sets.

use clerestory::bsdf::Rank;
use clerestory::bsdf::convert::{Report, Sampling, all_to_matrix, all_to_tree, anisotropy};
use clerestory::bsdf::normalise::normalise_component;
use clerestory::bsdf::reciprocity::{reciprocal_average, reciprocity_error};
use clerestory::bsdf::tree::Grid;
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::arrays::{scatter, side};
use crate::basis::PyBasis;
use crate::bsdf::{PyBsdf, part};
use crate::errors::raise;
use crate::jobs::watched;
use crate::model::PyModel;

/// Band, side, scatter, kind of the source, samples, RMS error, worst direct-hemispherical difference.
type ReportRow = (String, &'static str, &'static str, &'static str, u32, Option<f64>, f64);

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

    /// All components as tensor trees of rank 3 or 4.
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of the Python API")]
    fn to_tree(
        &self,
        py: Python<'_>,
        isotropic: bool,
        levels: u32,
        samples: u32,
        reduce: Option<f64>,
        seed: u64,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<(Self, Vec<ReportRow>)> {
        let rank = if isotropic { Rank::Isotropic } else { Rank::Anisotropic };
        let grid = Grid { levels, samples, seed };
        let (bsdf, reports) = watched(py, progress.as_ref(), |watch| {
            all_to_tree(&self.0, rank, grid, reduce, watch)
        })?;
        Ok((Self(bsdf), rows(reports)))
    }

    /// Only the bands that are named, in that order.
    fn with_bands(&self, names: Vec<String>) -> PyResult<Self> {
        self.0.with_bands(&names).map(Self).map_err(raise)
    }

    fn scaled(&self, factor: f64) -> PyResult<Self> {
        let scaled = self.0.try_map(|_, _, _, model| model.scaled(factor));
        scaled.map(Self).map_err(raise)
    }

    /// One component with a direct-hemispherical value for each patch.
    #[allow(clippy::too_many_arguments, reason = "keyword arguments of the Python API")]
    fn normalised(
        &self,
        py: Python<'_>,
        band: Option<&str>,
        side_name: &str,
        scatter_name: &str,
        basis: &PyBasis,
        values: PyReadonlyArray1<'_, f64>,
        part_name: &str,
    ) -> PyResult<Self> {
        let (side, scatter, part) = (side(side_name)?, scatter(scatter_name)?, part(part_name)?);
        let values = values.as_array().to_vec();
        py.detach(|| normalise_component(&self.0, band, side, scatter, &basis.0, &values, part))
            .map(Self)
            .map_err(raise)
    }

    fn reciprocal_average(&self, py: Python<'_>) -> PyResult<Self> {
        py.detach(|| reciprocal_average(&self.0)).map(Self).map_err(raise)
    }

    fn separate_peaks(&self, py: Python<'_>) -> PyResult<Self> {
        py.detach(|| self.0.with_separated_peaks()).map(Self).map_err(raise)
    }

    /// With a band that is a weighted sum of others.
    fn with_mixture(&self, py: Python<'_>, name: &str, parts: Vec<(String, f64)>) -> PyResult<Self> {
        let parts: Vec<(&str, f64)> = parts.iter().map(|(band, w)| (band.as_str(), *w)).collect();
        py.detach(|| self.0.with_mixture(name, &parts)).map(Self).map_err(raise)
    }

    /// With the near-infrared band that the solar and the visible one leave.
    fn with_near_infrared(&self, py: Python<'_>, visible_share: f64) -> PyResult<Self> {
        py.detach(|| self.0.with_near_infrared(visible_share))
            .map(Self)
            .map_err(raise)
    }

    fn with_renamed_band(&self, old: &str, new: &str) -> PyResult<Self> {
        self.0.with_renamed_band(old, new).map(Self).map_err(raise)
    }
}

#[pymethods]
impl PyModel {
    /// Weighted sum, of the parts' own kind where they are alike.
    #[staticmethod]
    fn mixture(parts: Vec<(f64, Bound<'_, PyModel>)>) -> PyResult<Self> {
        let parts: Vec<_> = parts.into_iter().map(|(w, m)| (w, m.get().0.clone())).collect();
        clerestory::bsdf::Model::mixture(&parts).map(Self::of).map_err(raise)
    }

    /// Share of the light that a turn in its plane would move.
    fn anisotropy(&self, py: Python<'_>) -> PyResult<f64> {
        watched(py, None, |watch| anisotropy(&self.0, watch))
    }

    /// How far this model and the other side's (or itself, for reflection) are from reciprocity; None if it is dark.
    fn reciprocity_error(&self, py: Python<'_>, back: &Self) -> Option<f64> {
        py.detach(|| reciprocity_error(&self.0, &back.0))
    }
}
