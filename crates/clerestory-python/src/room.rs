//! Rooms with daylight.

use std::fmt::Write;
use std::sync::{Arc, Mutex};

use clerestory::geometry::{Scene, Shape, Vec3};
use clerestory::material::Surface;
use clerestory::picture::{Camera, View};
use clerestory::room::{Accumulated, Parts, Picture, Room, Sensor, System};
use clerestory::sequence::mix;
use numpy::{PyArray1, PyArray2, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;

use crate::arrays::rows;
use crate::bsdf::PyBsdf;
use crate::errors::{ClerestoryError, raise};
use crate::jobs::watched;
use crate::sky::PySky;
use crate::trace_material::{MaterialSpec, MediumSpec};
use crate::trace_scene::PyScene;

/// Materials of front and back, media before and behind.
type SurfaceSpec = ([u32; 2], [u16; 2]);

/// Name, corners, data set, band of each channel, upward direction of the sample.
type WindowSpec<'py> = (String, Vec<[f64; 3]>, Bound<'py, PyBsdf>, [Option<String>; 3], [f64; 3]);

/// Name, corners, radiance.
type LightSpec = (String, Vec<[f64; 3]>, [f64; 3]);

fn vector([x, y, z]: [f64; 3]) -> Vec3 {
    Vec3::new(x, y, z)
}

/// Text as a number, without keeping the text.
struct Mark(u64);

impl std::fmt::Write for Mark {
    fn write_str(&mut self, text: &str) -> std::fmt::Result {
        for part in text.as_bytes().chunks(8) {
            let mut bytes = [0; 8];
            bytes[..part.len()].copy_from_slice(part);
            self.0 = mix(self.0 ^ u64::from_le_bytes(bytes));
        }
        Ok(())
    }
}

/// Sensors at points (n, 3) that face along normals (n, 3).
pub fn sensors(points: &PyReadonlyArray2<'_, f64>, normals: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Sensor>> {
    let (points, normals) = (points.as_array(), normals.as_array());
    if points.ncols() != 3 || normals.dim() != points.dim() {
        return Err(ClerestoryError::new_err("points and normals do not fit together"));
    }
    Ok(points
        .rows()
        .into_iter()
        .zip(normals.rows())
        .map(|(p, n)| Sensor {
            point: Vec3::new(p[0], p[1], p[2]),
            normal: Vec3::new(n[0], n[1], n[2]),
        })
        .collect())
}

/// Shapes of a room, each with its surface.
#[pyclass(name = "RoomShapes", module = "clerestory")]
#[derive(Default)]
pub struct PyRoomShapes(Scene);

#[pymethods]
impl PyRoomShapes {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Number of a surface; it is added if it is new.
    fn surface(&mut self, name: &str) -> u32 {
        self.0.surface(name)
    }

    /// A number that stands for all of the shapes: other ones have another, nearly surely.
    fn mark(&self) -> u64 {
        let mut mark = Mark(0);
        // Writing to a number cannot fail.
        let _ = write!(mark, "{:?} {:?}", self.0.surfaces, self.0.elements);
        mark.0
    }

    /// Adds triangles: corners (n, 3) in metres, triangles (m, 3), under the name of an object.
    fn triangles(
        &mut self,
        name: &str,
        surface: u32,
        corners: PyReadonlyArray2<'_, f64>,
        triangles: PyReadonlyArray2<'_, i64>,
    ) -> PyResult<()> {
        let (corners, triangles) = (corners.as_array(), triangles.as_array());
        let count = corners.nrows() as i64;
        if corners.ncols() != 3 || triangles.ncols() != 3 || triangles.iter().any(|k| !(0..count).contains(k)) {
            return Err(ClerestoryError::new_err("corners and triangles do not fit together"));
        }
        let object = self.0.object(name);
        let corner = |k: i64| {
            let p = corners.row(k as usize);
            Vec3::new(p[0], p[1], p[2])
        };
        for triangle in triangles.rows() {
            let shape = Shape::Triangle([corner(triangle[0]), corner(triangle[1]), corner(triangle[2])]);
            self.0.push(shape, surface, object);
        }
        Ok(())
    }

    /// Adds the shapes of a scene whose surfaces have a number here.
    fn scene(&mut self, scene: &PyScene, surfaces: Vec<Option<u32>>) {
        let objects: Vec<u32> = scene.scene.objects.iter().map(|name| self.0.object(name)).collect();
        for element in &scene.scene.elements {
            if let Some(Some(surface)) = surfaces.get(element.surface as usize) {
                self.0.push(element.shape, *surface, objects[element.object as usize]);
            }
        }
    }

    /// Every shape with its surface, as bytes that are the same for the same shapes.
    fn described<'py>(&self, py: Python<'py>) -> Bound<'py, PyBytes> {
        let mut bytes = Vec::new();
        for element in &self.0.elements {
            bytes.extend(element.surface.to_le_bytes());
            match element.shape {
                Shape::Triangle(corners) => {
                    let numbers = corners.iter().flat_map(|c| c.array());
                    bytes.extend(numbers.flat_map(f64::to_le_bytes));
                }
                other => bytes.extend(format!("{other:?}").into_bytes()),
            }
        }
        PyBytes::new(py, &bytes)
    }

    /// Least and greatest x, y, z (2, 3) in metres; None of an empty scene.
    fn bounds(&self) -> Option<[[f64; 3]; 2]> {
        let bounds = self.0.elements.iter().map(|e| e.shape.bounds().map(Vec3::array));
        bounds.reduce(|[a, b], [c, d]| {
            [
                std::array::from_fn(|k| a[k].min(c[k])),
                std::array::from_fn(|k| b[k].max(d[k])),
            ]
        })
    }
}

/// A room, ready for paths.
#[pyclass(name = "Room", frozen, module = "clerestory")]
pub struct PyRoom(pub Arc<Room>);

/// Irradiance (n, 3) and its standard errors (n, 3), W/m².
type Irradiance<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray2<f64>>);

#[pymethods]
impl PyRoom {
    #[new]
    #[allow(clippy::too_many_arguments, reason = "the parts of a room")]
    fn new(
        py: Python<'_>,
        shapes: &PyRoomShapes,
        surfaces: Vec<SurfaceSpec>,
        materials: Vec<MaterialSpec<'_>>,
        media: Vec<MediumSpec>,
        windows: Vec<WindowSpec<'_>>,
        lights: Vec<LightSpec>,
        sky: &PySky,
    ) -> PyResult<Self> {
        let surface = |(materials, media): SurfaceSpec| Surface { materials, media };
        let corners = |corners: Vec<[f64; 3]>| corners.into_iter().map(vector).collect();
        let windows = windows
            .into_iter()
            .map(|(name, outline, bsdf, bands, up)| {
                let bands = [0, 1, 2].map(|k: usize| bands[k].as_deref());
                let system = System::new(&bsdf.get().0, bands, vector(up))
                    .map_err(|e| ClerestoryError::new_err(format!("window {name:?}: {e}")))?;
                Ok((name, corners(outline), system))
            })
            .collect::<PyResult<_>>()?;
        let parts = Parts {
            scene: shapes.0.clone(),
            surfaces: surfaces.into_iter().map(surface).collect(),
            materials: materials
                .into_iter()
                .map(MaterialSpec::into_material)
                .collect::<PyResult<_>>()?,
            media: media
                .into_iter()
                .map(MediumSpec::into_medium)
                .collect::<PyResult<_>>()?,
            windows,
            lights: lights
                .into_iter()
                .map(|(name, outline, radiance)| (name, corners(outline), radiance))
                .collect(),
            sky: sky.0.clone(),
        };
        watched(py, None, |progress| Room::new(parts, progress)).map(|room| Self(Arc::new(room)))
    }

    /// Names of the windows, whether something other than sky and ground is seen through each, and what its data set lacks.
    fn windows(&self) -> Vec<(String, bool, Vec<String>)> {
        let windows = self.0.windows().iter();
        windows
            .map(|w| (w.name().to_owned(), w.obstructed(), w.system().warnings().to_vec()))
            .collect()
    }

    /// Of each window: the share of directions that see sky or ground from its face to the room, and from that to the
    /// outside, and the surface in whose plane it lies without an opening there.
    fn outlooks(&self, py: Python<'_>) -> Vec<(f64, f64, Option<String>)> {
        let found = py.detach(|| self.0.outlooks());
        found.into_iter().map(|o| (o.inside, o.outside, o.covered)).collect()
    }

    /// All around a point (metres): the share of directions that see sky or ground with nothing before them, the share that
    /// see a window from the room, and the surface whose back is seen everywhere, as from within a body.
    fn around(&self, point: [f64; 3]) -> (f64, f64, Option<String>) {
        let found = self.0.around(vector(point));
        (found.outside, found.windows, found.within)
    }

    /// Radiance (pixels, 3) of a view (Radiance's options) that is known without following light; the sun's disc is not in it.
    fn glance<'py>(
        &self,
        py: Python<'py>,
        view: &str,
        width: usize,
        height: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let camera = Camera::new(View::parse(view).map_err(raise)?).map_err(raise)?;
        let found = py.detach(|| self.0.glance(&camera, [width, height]));
        rows(py, found.into_iter().flatten().collect(), 3)
    }

    /// What lies in the pixels of a view, (pixels, 6): the share of surfaces that have no light of their own, and their mean
    /// normal, distance (metres) and reflectance, each times that share.
    fn features<'py>(
        &self,
        py: Python<'py>,
        view: &str,
        width: usize,
        height: usize,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let camera = Camera::new(View::parse(view).map_err(raise)?).map_err(raise)?;
        let found = py.detach(|| self.0.features(&camera, [width, height]));
        let numbers = found.iter().flat_map(|f| {
            let [x, y, z] = f.normal.array();
            [f.share, x, y, z, f.distance, f.albedo]
        });
        rows(py, numbers.collect(), 6)
    }

    /// The sun from an eye (metres), directly or through beams: direction, radiance and solid angle (sr) of what is seen of it.
    fn sun_seen(&self, eye: [f64; 3]) -> Option<([f64; 3], [f64; 3], f64)> {
        let seen = self.0.sun_seen(vector(eye))?;
        Some((seen.direction.array(), seen.radiance, seen.solid_angle))
    }

    /// Irradiance at points (n, 3) that face along normals (n, 3), by so many paths each.
    #[pyo3(signature = (points, normals, samples, seed, report=None))]
    fn irradiance<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f64>,
        normals: PyReadonlyArray2<'_, f64>,
        samples: u32,
        seed: u64,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Irradiance<'py>> {
        let sensors = sensors(&points, &normals)?;
        let room = self.0.clone();
        let found = watched(py, report.as_ref(), |progress| {
            room.irradiance(&sensors, samples, seed, progress)
        })?;
        let values = found.iter().flat_map(|e| e.value).collect();
        let errors = found.iter().flat_map(|e| e.standard_error).collect();
        Ok((rows(py, values, 3)?, rows(py, errors, 3)?))
    }
}

/// Sums over paths of radiance (pixels, 3) and of squares (pixels).
type Sums<'py> = (Bound<'py, PyArray2<f64>>, Bound<'py, PyArray1<f64>>);

/// A picture that is being made.
#[pyclass(name = "RoomPicture", frozen, module = "clerestory")]
pub struct PyRoomPicture {
    room: Arc<Room>,
    picture: Picture,
    found: Mutex<Accumulated>,
}

#[pymethods]
impl PyRoomPicture {
    /// Of a room, in a view (Radiance's options), of so many pixels.
    #[new]
    fn new(room: &PyRoom, view: &str, width: usize, height: usize, seed: u64) -> PyResult<Self> {
        let camera = Camera::new(View::parse(view).map_err(raise)?).map_err(raise)?;
        Ok(Self {
            room: room.0.clone(),
            picture: Picture {
                camera,
                size: [width, height],
                seed,
            },
            found: Mutex::new(Accumulated::default()),
        })
    }

    /// Adds paths to every pixel.
    #[pyo3(signature = (samples, report=None))]
    fn add(&self, py: Python<'_>, samples: u32, report: Option<Py<PyAny>>) -> PyResult<()> {
        watched(py, report.as_ref(), |progress| {
            let mut found = self.found.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            self.picture.add(&self.room, samples, &mut found, progress)
        })
    }

    /// Paths of every pixel so far.
    fn samples(&self) -> u32 {
        self.found
            .lock()
            .unwrap_or_else(std::sync::PoisonError::into_inner)
            .samples
    }

    /// Sums over paths of the radiance (pixels, 3) and of the squares of the mean of the channels (pixels).
    fn sums<'py>(&self, py: Python<'py>) -> PyResult<Sums<'py>> {
        let found = self.found.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let sums = found.sums.iter().flatten().copied().collect();
        Ok((rows(py, sums, 3)?, PyArray1::from_slice(py, &found.squares)))
    }

    /// Goes on from the `sums` of a number of paths of every pixel.
    fn restore(
        &self,
        sums: PyReadonlyArray2<'_, f64>,
        squares: PyReadonlyArray1<'_, f64>,
        samples: u32,
    ) -> PyResult<()> {
        let (sums, squares) = (sums.as_array(), squares.as_array());
        let [width, height] = self.picture.size;
        let finite = sums.iter().chain(squares).all(|x| x.is_finite());
        if sums.dim() != (width * height, 3) || squares.len() != width * height || !finite {
            return Err(ClerestoryError::new_err(
                "the sums are not of a picture of this size (start anew)",
            ));
        }
        *self.found.lock().unwrap_or_else(std::sync::PoisonError::into_inner) = Accumulated {
            sums: sums.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect(),
            squares: squares.to_vec(),
            samples,
        };
        Ok(())
    }

    /// Radiance of the sun's disc (pixels, 3) as it is seen directly or through the beams of windows.
    fn sun<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let seen = py.detach(|| self.picture.sun(&self.room));
        rows(py, seen.into_iter().flatten().collect(), 3)
    }
}
