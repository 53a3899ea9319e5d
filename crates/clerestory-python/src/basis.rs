//! Angle bases.

use std::sync::Arc;

use clerestory::basis::{Basis, Ring};
use clerestory::direction::Disk;
use numpy::{PyArray1, PyArray2, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;

use crate::errors::{ClerestoryError, raise};

/// A division of a hemisphere into patches.
#[pyclass(name = "Basis", frozen, module = "clerestory")]
pub struct PyBasis(pub Arc<Basis>);

#[pymethods]
impl PyBasis {
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        Basis::named(name).map(|b| Self(Arc::new(b))).map_err(raise)
    }

    /// From (lower, upper, nominal polar angle in degrees, number of patches).
    #[staticmethod]
    fn from_rings(name: &str, rings: Vec<(f64, f64, f64, usize)>) -> PyResult<Self> {
        let rings = rings
            .into_iter()
            .map(|(lower_deg, upper_deg, nominal_deg, count)| Ring {
                lower_deg,
                upper_deg,
                nominal_deg,
                count,
            })
            .collect();
        Basis::from_rings(name, rings).map(|b| Self(Arc::new(b))).map_err(raise)
    }

    #[getter]
    fn name(&self) -> &str {
        self.0.name()
    }

    #[getter]
    fn rings(&self) -> Vec<(f64, f64, f64, usize)> {
        self.0
            .rings()
            .iter()
            .map(|r| (r.lower_deg, r.upper_deg, r.nominal_deg, r.count))
            .collect()
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.0 == other.0
    }

    /// 0-based patch of each point (n, 2) of the disk of travel.
    fn patch_of<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let points = disk_points(&points)?;
        let patches: Vec<i64> = py.detach(|| points.iter().map(|&p| self.0.patch_of(p) as i64).collect());
        Ok(patches.to_pyarray(py))
    }

    /// Nominal centres (n, 2) on the disk of travel.
    fn centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> = (0..self.0.len())
            .map(|p| {
                let c = self.0.centre(p);
                vec![c.x, c.y]
            })
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Lower and upper polar angle, lower and upper azimuth of each patch (n, 4), radians.
    fn limits<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows: Vec<Vec<f64>> = (0..self.0.len())
            .map(|p| {
                let ([a, b], [c, d]) = self.0.limits(p);
                vec![a, b, c, d]
            })
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    fn solid_angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let angles: Vec<f64> = (0..self.0.len()).map(|p| self.0.solid_angle(p)).collect();
        angles.to_pyarray(py)
    }

    fn projected_solid_angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        self.0.projected_solid_angles().to_pyarray(py)
    }

    /// Points (n, 2) of a patch for numbers (n, 2) in [0, 1), uniform in solid angle or cosine-weighted.
    fn sample<'py>(
        &self,
        py: Python<'py>,
        patch: usize,
        u: PyReadonlyArray2<'py, f64>,
        cosine_weighted: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if patch >= self.0.len() {
            return Err(ClerestoryError::new_err(format!(
                "patch index {patch} is not one of the {} of {}",
                self.0.len(),
                self.0.name()
            )));
        }
        let rows: Vec<Vec<f64>> = u
            .as_array()
            .rows()
            .into_iter()
            .map(|row| {
                let u = [row[0], row[1]];
                let d = if cosine_weighted {
                    self.0.sample_cosine(patch, u)
                } else {
                    self.0.sample_uniform(patch, u)
                };
                vec![d.x, d.y]
            })
            .collect();
        Ok(PyArray2::from_vec2(py, &rows)?)
    }

    /// Patch of the reversed path (azimuth + 180°) for every patch; -1 where there is none.
    fn reversed<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        let map: Vec<i64> = (0..self.0.len())
            .map(|p| self.0.reversed(p).map_or(-1, |q| q as i64))
            .collect();
        map.to_pyarray(py)
    }
}

/// Rows of an (n, 2) array as points of the disk.
pub fn disk_points(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Disk>> {
    array
        .as_array()
        .rows()
        .into_iter()
        .map(|row| {
            if row.len() == 2 && row[0].is_finite() && row[1].is_finite() {
                Ok(Disk::new(row[0], row[1]))
            } else {
                Err(ClerestoryError::new_err(
                    "points of the disk are pairs of finite numbers x, y",
                ))
            }
        })
        .collect()
}
