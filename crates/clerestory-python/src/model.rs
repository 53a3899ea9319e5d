//! Models of one component.

use std::sync::Arc;

use clerestory::bsdf::{Beam, Cells, Filtered, Lambertian, Matrix, Model, Specular, Sum};
use numpy::{PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::basis::PyBasis;
use crate::errors::{ClerestoryError, UnsupportedError, raise};

/// A model of light from one side, transmitted or reflected.
#[pyclass(name = "Model", frozen, module = "clerestory")]
#[derive(Clone)]
pub struct PyModel(pub Arc<Model>);

impl PyModel {
    /// Wraps a model.
    pub fn of(model: Model) -> Self {
        Self(Arc::new(model))
    }
}

/// Incident and outgoing basis, values and standard errors, both (outgoing, incident).
type MatrixParts<'py> = (
    PyBasis,
    PyBasis,
    Bound<'py, PyArray2<f64>>,
    Option<Bound<'py, PyArray2<f64>>>,
);

#[pymethods]
impl PyModel {
    /// Table with rows of outgoing and columns of incident patches (1/sr).
    #[staticmethod]
    #[pyo3(signature = (incident, outgoing, values, standard_errors=None))]
    fn matrix(
        incident: &PyBasis,
        outgoing: &PyBasis,
        values: PyReadonlyArray2<'_, f64>,
        standard_errors: Option<PyReadonlyArray2<'_, f64>>,
    ) -> PyResult<Self> {
        if values.shape() != [outgoing.0.len(), incident.0.len()] {
            return Err(ClerestoryError::new_err(format!(
                "an array of shape {:?} does not go with {} outgoing and {} incident patches",
                values.shape(),
                outgoing.0.len(),
                incident.0.len()
            )));
        }
        let by_incident = |a: &PyReadonlyArray2<'_, f64>| a.as_array().t().iter().copied().collect::<Vec<f64>>();
        let mut matrix = Matrix::new(incident.0.clone(), outgoing.0.clone(), by_incident(&values)).map_err(raise)?;
        if let Some(errors) = standard_errors {
            matrix = matrix.with_standard_errors(by_incident(&errors)).map_err(raise)?;
        }
        Ok(Self::of(Model::Matrix(matrix)))
    }

    #[staticmethod]
    fn lambertian(value: f64) -> PyResult<Self> {
        Lambertian::new(value)
            .map(|l| Self::of(Model::Lambertian(l)))
            .map_err(raise)
    }

    /// The same value for all directions.
    #[staticmethod]
    fn specular(value: f64) -> PyResult<Self> {
        Specular::constant(value)
            .map(|s| Self::of(Model::Specular(s)))
            .map_err(raise)
    }

    /// Values at equal steps of sin²θ from 0 to 1.
    #[staticmethod]
    fn specular_angular(values: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        Specular::angular(values.as_array().to_vec())
            .map(|s| Self::of(Model::Specular(s)))
            .map_err(raise)
    }

    /// Values at equal steps of cosθ from 0 to 1.
    #[staticmethod]
    fn specular_cosine(values: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        Specular::cosine(values.as_array().to_vec())
            .map(|s| Self::of(Model::Specular(s)))
            .map_err(raise)
    }

    /// One value a patch.
    #[staticmethod]
    fn specular_patches(basis: &PyBasis, values: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        Specular::patches(basis.0.clone(), values.as_array().to_vec())
            .map(|s| Self::of(Model::Specular(s)))
            .map_err(raise)
    }

    /// Measured beam: one value and one standard error a patch.
    #[staticmethod]
    fn beam(basis: &PyBasis, values: PyReadonlyArray1<'_, f64>, errors: PyReadonlyArray1<'_, f64>) -> PyResult<Self> {
        Beam::new(Cells::Patches(basis.0.clone()), values.as_array().to_vec())
            .and_then(|beam| beam.with_standard_errors(errors.as_array().to_vec()))
            .map(|beam| Self::of(Model::Beam(beam)))
            .map_err(raise)
    }

    #[staticmethod]
    fn sum(parts: Vec<(f64, Bound<'_, PyModel>)>) -> PyResult<Self> {
        let parts = parts.into_iter().map(|(w, m)| (w, m.get().0.clone())).collect();
        Sum::new(parts).map(|s| Self::of(Model::Sum(s))).map_err(raise)
    }

    /// Scattered light with beams before and behind it.
    fn filtered(&self, before: &Self, after: &Self) -> PyResult<Self> {
        Filtered::new(self.0.clone(), before.0.clone(), after.0.clone())
            .map(|f| Self::of(Model::Filtered(f)))
            .map_err(raise)
    }

    #[getter]
    fn kind(&self) -> &'static str {
        self.0.kind()
    }

    /// Bases, values (outgoing, incident) and standard errors of a matrix.
    fn matrix_parts<'py>(&self, py: Python<'py>) -> PyResult<MatrixParts<'py>> {
        let Model::Matrix(matrix) = &*self.0 else {
            return Err(UnsupportedError::new_err(format!(
                "a {} model is not a matrix (convert it to a basis first)",
                self.0.kind()
            )));
        };
        let shape = [matrix.incident().len(), matrix.outgoing().len()];
        let by_outgoing = |values: &[f64]| -> PyResult<Bound<'py, PyArray2<f64>>> {
            let rows: Vec<Vec<f64>> = (0..shape[1])
                .map(|o| (0..shape[0]).map(|i| values[i * shape[1] + o]).collect())
                .collect();
            Ok(PyArray2::from_vec2(py, &rows)?)
        };
        Ok((
            PyBasis(matrix.incident().clone()),
            PyBasis(matrix.outgoing().clone()),
            by_outgoing(matrix.values())?,
            matrix.standard_errors().map(by_outgoing).transpose()?,
        ))
    }

    fn scaled(&self, factor: f64) -> PyResult<Self> {
        self.0.scaled(factor).map(Self::of).map_err(raise)
    }

    fn reciprocal(&self) -> Self {
        Self::of(self.0.reciprocal())
    }
}
