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
enum GivenArray<'py> {
    Floats(PyReadonlyArray1<'py, f64>),
    Entries(PyReadonlyArray1<'py, u32>),
}

#[derive(IntoPyObject)]
enum TakenArray<'py> {
    Floats(Bound<'py, PyArray1<f64>>),
    Entries(Bound<'py, PyArray1<u32>>),
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
        let arrays = parts.arrays.into_iter().map(|(name, array)| {
            let array = match array {
                Array::Floats(v) => TakenArray::Floats(v.to_pyarray(py)),
                Array::Entries(v) => TakenArray::Entries(v.to_pyarray(py)),
            };
            (name, array)
        });
        (
            parts.kind,
            parts.numbers,
            parts.bases.into_iter().map(PyBasis).collect(),
            arrays.collect(),
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
        let arrays = arrays.into_iter().map(|(name, array)| {
            let array = match array {
                GivenArray::Floats(v) => Array::Floats(v.as_array().to_vec()),
                GivenArray::Entries(v) => Array::Entries(v.as_array().to_vec()),
            };
            (name, array)
        });
        let parts = Parts {
            kind,
            numbers,
            bases: bases.iter().map(|b| Arc::clone(&b.get().0)).collect(),
            arrays: arrays.collect(),
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
