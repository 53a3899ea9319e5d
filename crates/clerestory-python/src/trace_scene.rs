//! Meshes and scene files.

use std::path::{Path, PathBuf};

use clerestory::geometry::{Extent, Mesh, Scene, Shape, Vec3};
use clerestory::io::{obj, ply, radiance, stl};
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::arrays::rows;
use crate::errors::{ClerestoryError, raise};
use crate::trace::PyGeometry;

/// Shapes with the names of their surfaces.
#[pyclass(name = "Scene", frozen, module = "clerestory")]
pub struct PyScene {
    pub(crate) scene: Scene,
    materials: Vec<radiance::Description>,
}

/// Name, kind, text and number arguments, metres a unit of the file, and place of a material.
type MaterialRow = (String, String, Vec<String>, Vec<f64>, f64, String);

/// A round shape: its kind, the number of its surface, and its numbers.
type RoundRow = (&'static str, u32, Vec<f64>);

impl PyScene {
    /// With the materials of its surfaces, as far as the file has them.
    pub fn of(scene: Scene, materials: Vec<radiance::Description>) -> Self {
        Self { scene, materials }
    }

    fn of_file(
        py: Python<'_>,
        read: fn(&Path, f64) -> clerestory::Result<Scene>,
        path: &Path,
        metres_per_unit: f64,
    ) -> PyResult<Self> {
        let scene = py.detach(|| read(path, metres_per_unit)).map_err(raise)?;
        Ok(Self {
            scene,
            materials: Vec::new(),
        })
    }
}

#[pymethods]
impl PyScene {
    /// A Radiance scene; lengths in the file are of so many metres.
    #[staticmethod]
    fn radiance(py: Python<'_>, path: PathBuf, metres_per_unit: f64) -> PyResult<Self> {
        let read = py.detach(|| radiance::read(&path, metres_per_unit)).map_err(raise)?;
        Ok(Self {
            scene: read.scene,
            materials: read.materials,
        })
    }

    /// A Wavefront OBJ file; lengths in it are of so many metres.
    #[staticmethod]
    fn obj(py: Python<'_>, path: PathBuf, metres_per_unit: f64) -> PyResult<Self> {
        Self::of_file(py, obj::read, &path, metres_per_unit)
    }

    /// An STL file; lengths in it are of so many metres.
    #[staticmethod]
    fn stl(py: Python<'_>, path: PathBuf, metres_per_unit: f64) -> PyResult<Self> {
        Self::of_file(py, stl::read, &path, metres_per_unit)
    }

    /// A PLY file; lengths in it are of so many metres.
    #[staticmethod]
    fn ply(py: Python<'_>, path: PathBuf, metres_per_unit: f64) -> PyResult<Self> {
        Self::of_file(py, ply::read, &path, metres_per_unit)
    }

    /// From corners (n, 3) in metres, triangles (m, 3), the surface of each and the surfaces' names.
    #[staticmethod]
    fn of_triangles(
        corners: PyReadonlyArray2<'_, f64>,
        triangles: PyReadonlyArray2<'_, i64>,
        surfaces: PyReadonlyArray1<'_, u32>,
        names: Vec<String>,
    ) -> PyResult<Self> {
        let count = corners.shape()[0];
        let sound = corners.shape()[1] == 3 && triangles.shape() == [surfaces.len(), 3];
        let (corners, triangles, surfaces) = (corners.as_array(), triangles.as_array(), surfaces.as_array());
        let within = triangles.iter().all(|&k| (0..count as i64).contains(&k));
        if !sound || !within || surfaces.iter().any(|&s| s as usize >= names.len()) {
            return Err(ClerestoryError::new_err(
                "corners, triangles and surfaces do not fit together",
            ));
        }
        let mut scene = Scene::default();
        for name in &names {
            scene.surface(name);
            scene.object(name.clone());
        }
        let corner = |k: i64| {
            let p = corners.row(k as usize);
            Vec3::new(p[0], p[1], p[2])
        };
        for (triangle, &surface) in triangles.rows().into_iter().zip(surfaces) {
            let shape = Shape::Triangle([corner(triangle[0]), corner(triangle[1]), corner(triangle[2])]);
            scene.push(shape, surface, surface);
        }
        Ok(Self {
            scene,
            materials: Vec::new(),
        })
    }

    /// Names of the surfaces.
    #[getter]
    fn surfaces(&self) -> Vec<String> {
        self.scene.surfaces.clone()
    }

    /// What was odd but harmless.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.scene.warnings.clone()
    }

    /// The materials that the file has for its surfaces.
    fn materials(&self) -> Vec<MaterialRow> {
        self.materials
            .iter()
            .map(|m| {
                (
                    m.name.clone(),
                    m.kind.clone(),
                    m.words.clone(),
                    m.numbers.clone(),
                    m.metres_per_unit,
                    m.place.clone(),
                )
            })
            .collect()
    }

    /// Least and greatest x, y, z (2, 3) in metres; None of an empty scene.
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let bounds = self.scene.elements.iter().map(|e| e.shape.bounds().map(Vec3::array));
        bounds.reduce(|[a, b], [c, d]| {
            [
                std::array::from_fn(|k| a[k].min(c[k])),
                std::array::from_fn(|k| b[k].max(d[k])),
            ]
        })
    }

    /// Corners of all triangles (3 n, 3) in metres, and their surfaces (n).
    #[allow(clippy::type_complexity, reason = "two arrays")]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<(Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<u32>>)> {
        let (mut corners, mut surfaces) = (Vec::new(), Vec::new());
        for element in &self.scene.elements {
            if let Shape::Triangle(triangle) = element.shape {
                corners.extend(triangle.iter().flat_map(|p| p.array()));
                surfaces.push(element.surface);
            }
        }
        Ok((rows(py, corners, 3)?, PyArray1::from_vec(py, surfaces)))
    }

    /// Everything else: sphere (centre, radius), ring (centre, normal, radii) and cone (ends, radii), in metres.
    fn round(&self) -> Vec<RoundRow> {
        let row = |shape| match shape {
            Shape::Triangle(_) => None,
            Shape::Sphere { centre, radius, .. } => Some(("sphere", [&centre.array()[..], &[radius]].concat())),
            Shape::Ring { centre, normal, radii } => Some((
                "ring",
                [centre.array(), normal.array()]
                    .concat()
                    .into_iter()
                    .chain(radii)
                    .collect(),
            )),
            Shape::Cone { ends, radii, .. } => {
                Some(("cone", ends.into_iter().flat_map(Vec3::array).chain(radii).collect()))
            }
        };
        let elements = self.scene.elements.iter();
        elements
            .filter_map(|e| row(e.shape).map(|(kind, numbers)| (kind, e.surface, numbers)))
            .collect()
    }
}

#[pymethods]
impl PyGeometry {
    /// A scene, its surfaces numbered as in the sample's list. Limits along x and y in metres, and whether it is repeated
    /// with them as its period; all of it is shifted along z.
    #[staticmethod]
    fn mesh(
        py: Python<'_>,
        scene: &PyScene,
        surfaces: Vec<u32>,
        limits: [[f64; 2]; 2],
        repeated: [bool; 2],
        z: f64,
    ) -> PyResult<Self> {
        let mut own = scene.scene.clone();
        for element in &mut own.elements {
            element.surface = *surfaces
                .get(element.surface as usize)
                .ok_or_else(|| ClerestoryError::new_err("a surface of the scene has no number in the sample"))?;
            if z != 0.0 {
                element.shape = element.shape.shifted(Vec3::new(0.0, 0.0, z));
            }
        }
        let [x, y] = [0, 1].map(|axis| Extent {
            limits: limits[axis],
            repeated: repeated[axis],
        });
        py.detach(|| Mesh::new(own, [x, y])).map(Self::of).map_err(raise)
    }
}
