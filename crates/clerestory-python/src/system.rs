//! Window systems of layers.

use clerestory::Error;
use clerestory::bsdf::{Bsdf, Slab};
use clerestory::system::{PatchValue, System, pane, stack};
use numpy::PyArray2;
use pyo3::prelude::*;

use crate::arrays::side;
use crate::basis::PyBasis;
use crate::bsdf::PyBsdf;
use crate::errors::{ClerestoryError, raise};

/// A window of layers.
#[pyclass(name = "System", frozen, module = "clerestory")]
pub struct PySystem(System);

#[pymethods]
impl PySystem {
    /// Layers put together, outermost first.
    #[staticmethod]
    fn stack(
        py: Python<'_>,
        layers: Vec<Bound<'_, PyBsdf>>,
        basis: &Bound<'_, PyBasis>,
        specular: &str,
    ) -> PyResult<Self> {
        let specular = match specular {
            "centre" => PatchValue::Centre,
            "mean" => PatchValue::Mean,
            _ => {
                return Err(ClerestoryError::new_err(format!(
                    "specular {specular:?} is not known (give centre or mean)"
                )));
            }
        };
        let layers: Vec<Bsdf> = layers.iter().map(|layer| layer.get().0.clone()).collect();
        let basis = basis.get().0.clone();
        py.detach(|| stack(&layers, &basis, specular)).map(Self).map_err(raise)
    }

    #[getter]
    fn bsdf(&self) -> PyBsdf {
        PyBsdf(self.0.bsdf.clone())
    }

    #[getter]
    fn basis(&self) -> PyBasis {
        PyBasis(self.0.basis().clone())
    }

    fn __len__(&self) -> usize {
        self.0.layers()
    }

    /// Absorptance (layer, incident patch).
    fn absorptance<'py>(
        &self,
        py: Python<'py>,
        band: Option<&str>,
        side_name: &str,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = self.0.absorptance(band, side(side_name)?).map_err(raise)?;
        Ok(PyArray2::from_vec2(py, rows)?)
    }
}

#[pymethods]
impl PyBsdf {
    /// A clear pane by refractive index and internal transmittance along the normal.
    #[staticmethod]
    fn pane(index: f64, internal: f64, band: &str) -> PyResult<Self> {
        made(Slab::new(index, internal), band)
    }

    /// A clear pane by transmittance and reflectance at normal incidence.
    #[staticmethod]
    fn pane_from_normal(transmittance: f64, reflectance: f64, band: &str) -> PyResult<Self> {
        made(Slab::from_normal(transmittance, reflectance), band)
    }

    /// Internal transmittance by extinction coefficient, thickness and wavelength (m).
    #[staticmethod]
    fn internal_by_extinction(extinction: f64, thickness: f64, wavelength: f64) -> PyResult<f64> {
        pane::internal_by_extinction(extinction, thickness, wavelength).map_err(raise)
    }

    /// Internal transmittance by absorption coefficient (1/m) and thickness (m).
    #[staticmethod]
    fn internal_by_absorption(coefficient: f64, thickness: f64) -> PyResult<f64> {
        pane::internal_by_absorption(coefficient, thickness).map_err(raise)
    }
}

fn made(slab: Result<Slab, Error>, band: &str) -> PyResult<PyBsdf> {
    slab.and_then(|slab| pane::pane(slab, band)).map(PyBsdf).map_err(raise)
}
