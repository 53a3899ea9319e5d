//! Views and pictures.

use clerestory::geometry::Vec3;
use clerestory::picture::{Camera, Picture, View, hdr, openexr};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2, PyReadonlyArray3, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use crate::arrays::{pairs, rows};
use crate::errors::{ClerestoryError, raise};

/// A checked view.
#[pyclass(name = "View", frozen, module = "clerestory")]
pub struct PyView(pub Camera);

#[pymethods]
impl PyView {
    /// From options such as `-vta -vp 0 0 1.2`.
    #[new]
    fn new(options: &str) -> PyResult<Self> {
        View::parse(options).and_then(Camera::new).map(Self).map_err(raise)
    }

    /// The view with some options overridden.
    fn updated(&self, options: &str) -> PyResult<Self> {
        let mut view = *self.0.view();
        view.update(options).map_err(raise)?;
        Camera::new(view).map(Self).map_err(raise)
    }

    #[getter]
    fn options(&self) -> String {
        self.0.view().to_string()
    }

    #[getter]
    fn projection(&self) -> char {
        self.0.view().projection.letter()
    }

    #[getter]
    fn projection_name(&self) -> &'static str {
        self.0.view().projection.name()
    }

    /// Horizontal and vertical size.
    #[getter]
    fn size(&self) -> (f64, f64) {
        (self.0.view().horizontal, self.0.view().vertical)
    }

    /// To the right, up and forward (3, 3).
    fn frame<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        rows(py, self.0.frame().iter().flat_map(|v| v.array()).collect(), 3)
    }

    fn size_within(&self, width: usize, height: usize) -> (usize, usize) {
        self.0.size_within(width, height).into()
    }

    /// Origins and directions (n, 6) through points (n, 2); not a number outside of the projection.
    fn rays<'py>(&self, py: Python<'py>, points: PyReadonlyArray2<'py, f64>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let made = pairs(&points, "points")?
            .iter()
            .flat_map(|&[x, y]| {
                self.0.ray(x, y).map_or([f64::NAN; 6], |[from, to]| {
                    let ([a, b, c], [d, e, f]) = (from.array(), to.array());
                    [a, b, c, d, e, f]
                })
            })
            .collect();
        rows(py, made, 6)
    }

    /// Points (n, 2) of directions (n, 3); not a number where there is none.
    fn locate<'py>(
        &self,
        py: Python<'py>,
        directions: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        if directions.shape()[1] != 3 {
            return Err(ClerestoryError::new_err("directions: give x, y, z a row"));
        }
        let made = directions
            .as_array()
            .rows()
            .into_iter()
            .flat_map(|d| self.0.locate(Vec3::new(d[0], d[1], d[2])).unwrap_or([f64::NAN; 2]))
            .collect();
        rows(py, made, 2)
    }

    /// Solid angle of each pixel (height, width).
    fn solid_angles<'py>(
        &self,
        py: Python<'py>,
        width: usize,
        height: usize,
        exact: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let made = py.detach(|| {
            if exact {
                self.0.exact_solid_angles(width, height)
            } else {
                self.0.solid_angles(width, height)
            }
        });
        PyArray1::from_vec(py, made).reshape([height, width])
    }
}

/// Radiances with what a file says of them.
#[pyclass(name = "Picture", frozen, module = "clerestory")]
pub struct PyPicture(pub Picture);

#[pymethods]
impl PyPicture {
    /// From an array (height, width, 3).
    #[new]
    #[pyo3(signature = (pixels, view=None, header=vec![], primaries=None))]
    fn new(
        pixels: PyReadonlyArray3<'_, f32>,
        view: Option<&PyView>,
        header: Vec<String>,
        primaries: Option<[f64; 8]>,
    ) -> PyResult<Self> {
        let &[height, width, 3] = pixels.shape() else {
            return Err(ClerestoryError::new_err("a picture is an array (height, width, 3)"));
        };
        let values = pixels
            .as_array()
            .rows()
            .into_iter()
            .map(|p| [p[0], p[1], p[2]])
            .collect();
        let mut picture = Picture::new(width, height, values).map_err(raise)?;
        picture.view = view.map(|v| *v.0.view());
        picture.header = header;
        picture.primaries = primaries;
        Ok(Self(picture))
    }

    /// From the bytes of a file, HDR or OpenEXR.
    #[staticmethod]
    fn from_bytes(py: Python<'_>, data: PyBackedBytes) -> PyResult<Self> {
        py.detach(|| {
            if data.starts_with(&openexr::MAGIC) {
                openexr::read(&data)
            } else {
                hdr::read(&data)
            }
        })
        .map(Self)
        .map_err(raise)
    }

    /// The bytes of a file: `rgbe`, `xyze` or `exr`.
    fn to_bytes<'py>(&self, py: Python<'py>, format: &str) -> PyResult<Bound<'py, PyBytes>> {
        let bytes = py
            .detach(|| match format {
                "xyze" => hdr::write_xyze(&self.0),
                "exr" => openexr::write(&self.0),
                _ => Ok(hdr::write(&self.0)),
            })
            .map_err(raise)?;
        Ok(PyBytes::new(py, &bytes))
    }

    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.0.height, self.0.width)
    }

    #[getter]
    fn header(&self) -> Vec<String> {
        self.0.header.clone()
    }

    /// The options of its view; the view may not make sense.
    #[getter]
    fn view_options(&self) -> Option<String> {
        self.0.view.map(|v| v.to_string())
    }

    #[getter]
    fn exposure(&self) -> f64 {
        self.0.exposure
    }

    #[getter]
    fn primaries(&self) -> Option<[f64; 8]> {
        self.0.primaries
    }

    #[getter]
    fn pixel_aspect(&self) -> f64 {
        self.0.pixel_aspect
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.0.warnings.clone()
    }

    /// A copy of the pixels (height, width, 3).
    fn pixels<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f32>>> {
        let values = self.0.pixels.as_flattened().to_vec();
        PyArray1::from_vec(py, values).reshape([self.0.height, self.0.width, 3])
    }

    /// Luminance (height, width), by the picture's primaries or by shares of the channels.
    #[pyo3(signature = (weights=None))]
    fn luminance<'py>(&self, py: Python<'py>, weights: Option<[f64; 3]>) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let values = py
            .detach(|| match weights {
                Some(weights) => Ok(self.0.weighted(weights)),
                None => self.0.luminance(),
            })
            .map_err(raise)?;
        PyArray1::from_vec(py, values).reshape([self.0.height, self.0.width])
    }
}
