//! The virtual goniophotometer.

use std::sync::Mutex;

use clerestory::geometry::{Geometry, Piece, Profile};
use clerestory::material::{Material, Medium, Surface};
use clerestory::trace::Sample;
use numpy::{PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::{ClerestoryError, raise};
use crate::trace_material::{MaterialSpec, MediumSpec};

/// A shape; the sample that is made with it takes it over.
#[pyclass(name = "Geometry", frozen, module = "clerestory")]
pub struct PyGeometry(Mutex<Option<Box<dyn Geometry>>>);

impl PyGeometry {
    /// Wraps a shape.
    pub fn of(geometry: impl Geometry + 'static) -> Self {
        Self(Mutex::new(Some(Box::new(geometry))))
    }

    fn take(&self) -> PyResult<Box<dyn Geometry>> {
        let mut held = self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        held.take()
            .ok_or_else(|| ClerestoryError::new_err("the geometry belongs to another sample already (make it anew)"))
    }
}

#[pymethods]
impl PyGeometry {
    /// An extruded section: rows (z, y, z, y, turn) of pieces in metres and radians, the number of each one's surface,
    /// and the period along y in metres.
    #[staticmethod]
    fn profile(pieces: PyReadonlyArray2<'_, f64>, surfaces: PyReadonlyArray1<'_, u32>, period: f64) -> PyResult<Self> {
        if pieces.shape()[1] != 5 || pieces.shape()[0] != surfaces.len() {
            return Err(ClerestoryError::new_err(
                "pieces are rows of five numbers, and each has a surface",
            ));
        }
        let pieces: Vec<Piece> = pieces
            .as_array()
            .rows()
            .into_iter()
            .zip(surfaces.as_array())
            .map(|(row, &surface)| Piece {
                from: [row[0], row[1]],
                to: [row[2], row[3]],
                turn: row[4],
                surface,
            })
            .collect();
        Profile::new(pieces, period).map(Self::of).map_err(raise)
    }
}

/// A sample to be measured.
#[pyclass(name = "Sample", frozen, module = "clerestory")]
pub struct PySample(pub Sample);

#[pymethods]
impl PySample {
    /// Bands, layers from the exterior to the interior, surfaces (materials of front and back, media before and behind),
    /// materials, media.
    #[new]
    fn new(
        py: Python<'_>,
        bands: Vec<String>,
        layers: Vec<Bound<'_, PyGeometry>>,
        surfaces: Vec<([u32; 2], [u16; 2])>,
        materials: Vec<MaterialSpec<'_>>,
        media: Vec<MediumSpec>,
    ) -> PyResult<Self> {
        let materials: Vec<Material> = materials
            .into_iter()
            .map(MaterialSpec::into_material)
            .collect::<PyResult<_>>()?;
        let media: Vec<Medium> = media
            .into_iter()
            .map(MediumSpec::into_medium)
            .collect::<PyResult<_>>()?;
        let layers: Vec<_> = layers.iter().map(|l| l.get().take()).collect::<PyResult<_>>()?;
        let borders: Vec<[u16; 2]> = surfaces.iter().map(|(_, media)| *media).collect();
        py.detach(|| layers.iter().try_for_each(|layer| layer.check_media(&borders)))
            .map_err(raise)?;
        Ok(Self(Sample {
            bands,
            layers,
            surfaces: surfaces
                .into_iter()
                .map(|(materials, media)| Surface { materials, media })
                .collect(),
            materials,
            media,
        }))
    }

    /// Least and greatest z (m).
    fn depth(&self) -> [f64; 2] {
        self.0.depth()
    }
}
