//! Models in parts, for Clerestory's own file.

use std::sync::Arc;

use clerestory::bsdf::Model;
use clerestory::bsdf::parts::{Array, Parts};
use numpy::{PyArray1, PyReadonlyArray1, ToPyArray};
use pyo3::prelude::*;

use crate::basis::PyBasis;
use crate::bsdf::PyBsdf;
use crate::errors::raise;
use crate::model::PyModel;

/// An array of a model.
#[derive(FromPyObject)]
pub enum GivenArray<'py> {
    /// 64-bit numbers.
    Floats(PyReadonlyArray1<'py, f64>),
    /// 32-bit entries.
    Entries(PyReadonlyArray1<'py, u32>),
}

/// An array that Python gets.
#[derive(IntoPyObject)]
pub enum TakenArray<'py> {
    /// 64-bit numbers.
    Floats(Bound<'py, PyArray1<f64>>),
    /// 32-bit entries.
    Entries(Bound<'py, PyArray1<u32>>),
}

/// Arrays of the core for Python.
pub fn taken(py: Python<'_>, arrays: Vec<(String, Array)>) -> Vec<(String, TakenArray<'_>)> {
    let take = |array| match array {
        Array::Floats(v) => TakenArray::Floats(v.to_pyarray(py)),
        Array::Entries(v) => TakenArray::Entries(v.to_pyarray(py)),
    };
    arrays.into_iter().map(|(name, array)| (name, take(array))).collect()
}

/// Arrays of Python for the core.
pub fn given(arrays: Vec<(String, GivenArray<'_>)>) -> Vec<(String, Array)> {
    let give = |array| match array {
        GivenArray::Floats(v) => Array::Floats(v.as_array().to_vec()),
        GivenArray::Entries(v) => Array::Entries(v.as_array().to_vec()),
    };
    arrays.into_iter().map(|(name, array)| (name, give(array))).collect()
}

/// Kind, numbers, bases, arrays and models.
type TakenParts<'py> = (
    String,
    Vec<(String, f64)>,
    Vec<PyBasis>,
    Vec<(String, TakenArray<'py>)>,
    Vec<PyModel>,
);

#[pymethods]
impl PyModel {
    fn to_parts<'py>(&self, py: Python<'py>) -> TakenParts<'py> {
        let parts = self.0.to_parts();
        let arrays = taken(py, parts.arrays);
        (
            parts.kind,
            parts.numbers,
            parts.bases.into_iter().map(PyBasis).collect(),
            arrays,
            parts.models.into_iter().map(PyModel).collect(),
        )
    }

    #[staticmethod]
    fn from_parts(
        kind: String,
        numbers: Vec<(String, f64)>,
        bases: Vec<Bound<'_, PyBasis>>,
        arrays: Vec<(String, GivenArray<'_>)>,
        models: Vec<Bound<'_, PyModel>>,
    ) -> PyResult<Self> {
        let parts = Parts {
            kind,
            numbers,
            bases: bases.iter().map(|b| Arc::clone(&b.get().0)).collect(),
            arrays: given(arrays),
            models: models.iter().map(|m| Arc::clone(&m.get().0)).collect(),
        };
        Model::from_parts(&parts).map(Self::of).map_err(raise)
    }
}

#[pymethods]
impl PyBsdf {
    /// The same data set with other warnings.
    fn with_warnings(&self, warnings: Vec<String>) -> Self {
        let mut bsdf = self.0.clone();
        bsdf.warnings = warnings;
        Self(bsdf)
    }
}
