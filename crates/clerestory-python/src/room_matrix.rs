//! Daylight matrices of rooms, and what points see of windows.

use std::sync::Arc;

use clerestory::direction::Disk;
use clerestory::geometry::Vec3;
use clerestory::room::{Groups, Paths, Room, Rows};
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

use crate::arrays::{pairs, rows};
use crate::basis::PyBasis;
use crate::errors::{ClerestoryError, raise};
use crate::jobs::watched;
use crate::picture::PyView;
use crate::room::{PyRoom, sensors};
use crate::sky::PySkyPatches;

/// All and direct light (rows, columns, 3) and the standard errors of the photopic mean of all (rows, columns).
type Matrix<'py> = (
    Bound<'py, PyArray3<f32>>,
    Bound<'py, PyArray3<f32>>,
    Bound<'py, PyArray2<f32>>,
);

/// First cell of each point and the end (n + 1); number, solid angle, projected solid angle (m) and direction (m, 3) of each cell.
type Apertures<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray1<f32>>,
    Bound<'py, PyArray2<f32>>,
);

/// Pixel, share and window (n); direction (n, 3).
type WindowsSeen<'py> = (
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<i64>>,
    Bound<'py, PyArray2<f64>>,
);

/// Windows and radiances (directions, suns).
type LitBySuns<'py> = (Bound<'py, PyArray2<u16>>, Bound<'py, PyArray2<f32>>);

fn matrix(py: Python<'_>, found: Rows) -> PyResult<Matrix<'_>> {
    let columns = found.columns;
    let count = found.standard_error.len() / columns.max(1);
    let colours = |values: Vec<[f32; 3]>| PyArray1::from_vec(py, values.into_flattened()).reshape([count, columns, 3]);
    Ok((
        colours(found.all)?,
        colours(found.direct)?,
        PyArray1::from_vec(py, found.standard_error).reshape([count, columns])?,
    ))
}

fn vectors(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vec3>> {
    let array = array.as_array();
    if array.ncols() != 3 {
        return Err(ClerestoryError::new_err("points and directions have x, y and z"));
    }
    Ok(array.rows().into_iter().map(|p| Vec3::new(p[0], p[1], p[2])).collect())
}

/// Windows of a room in groups, each divided into patches of a basis.
#[pyclass(name = "WindowGroups", frozen, module = "clerestory")]
pub struct PyWindowGroups {
    room: Arc<Room>,
    groups: Groups,
}

#[pymethods]
impl PyWindowGroups {
    /// Of a room, with the group of each window.
    #[new]
    fn new(room: &PyRoom, of_window: Vec<usize>, basis: &PyBasis) -> Self {
        Self {
            room: room.0.clone(),
            groups: Groups {
                of_window,
                basis: (*basis.0).clone(),
            },
        }
    }

    /// Irradiance at points (n, 3) with normals (n, 3) by the radiance of the windows' patches; direct light meets no surface.
    #[pyo3(signature = (points, normals, samples, seed, report=None))]
    #[allow(clippy::too_many_arguments, reason = "where, what, and how")]
    fn view_matrix<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f64>,
        normals: PyReadonlyArray2<'_, f64>,
        samples: u32,
        seed: u64,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Matrix<'py>> {
        let sensors = sensors(&points, &normals)?;
        let found = watched(py, report.as_ref(), |progress| {
            self.room
                .view_matrix(&sensors, &self.groups, Paths { samples, seed }, progress)
        })?;
        matrix(py, found)
    }

    /// Radiance of the surfaces in the pixels `first` to `last` of a view's picture by the radiance of the windows' patches.
    #[pyo3(signature = (view, width, height, first, last, samples, seed, report=None))]
    #[allow(clippy::too_many_arguments, reason = "a picture, a part of it, and how")]
    fn picture_matrix<'py>(
        &self,
        py: Python<'py>,
        view: &PyView,
        width: usize,
        height: usize,
        first: usize,
        last: usize,
        samples: u32,
        seed: u64,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Matrix<'py>> {
        let found = watched(py, report.as_ref(), |progress| {
            let paths = Paths { samples, seed };
            self.room
                .picture_matrix(&view.0, [width, height], first..last, &self.groups, paths, progress)
        })?;
        matrix(py, found)
    }

    /// What the pixels of a view's picture show of windows, or parts of pixels: number of the pixel, its share, and number of the
    /// window from 0 (n); direction (n, 3).
    fn windows_seen<'py>(
        &self,
        py: Python<'py>,
        view: &PyView,
        width: usize,
        height: usize,
    ) -> PyResult<WindowsSeen<'py>> {
        let seen = py.detach(|| self.room.windows_seen(&view.0, [width, height]));
        Ok((
            PyArray1::from_iter(py, seen.iter().map(|s| s.pixel as i64)),
            PyArray1::from_iter(py, seen.iter().map(|s| s.share)),
            PyArray1::from_iter(py, seen.iter().map(|s| i64::from(s.window))),
            rows(py, seen.iter().flat_map(|s| s.direction.array()).collect(), 3)?,
        ))
    }

    /// Mean radiance from the room at a group's windows by patches of interior light, by the radiance of the windows' patches.
    #[pyo3(signature = (group, samples, seed, report=None))]
    fn return_matrix<'py>(
        &self,
        py: Python<'py>,
        group: usize,
        samples: u32,
        seed: u64,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Matrix<'py>> {
        let found = watched(py, report.as_ref(), |progress| {
            self.room
                .return_matrix(group, &self.groups, Paths { samples, seed }, progress)
        })?;
        matrix(py, found)
    }

    /// Mean radiance from outside at a group's windows by patches of exterior light, by the radiance of the sky's patches.
    #[pyo3(signature = (group, patches, samples, seed, report=None))]
    fn daylight_matrix<'py>(
        &self,
        py: Python<'py>,
        group: usize,
        patches: &PySkyPatches,
        samples: u32,
        seed: u64,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Matrix<'py>> {
        let found = watched(py, report.as_ref(), |progress| {
            self.room
                .daylight_matrix(group, &self.groups, &patches.0, Paths { samples, seed }, progress)
        })?;
        matrix(py, found)
    }

    /// Mean radiance from outside at a group's windows by patches of exterior light, by that of the patches of windows that are met
    /// there.
    #[pyo3(signature = (group, samples, seed, report=None))]
    fn facade_matrix<'py>(
        &self,
        py: Python<'py>,
        group: usize,
        samples: u32,
        seed: u64,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Matrix<'py>> {
        let found = watched(py, report.as_ref(), |progress| {
            self.room
                .facade_matrix(group, &self.groups, Paths { samples, seed }, progress)
        })?;
        matrix(py, found)
    }

    /// What points (n, 3) with normals (n, 3) see of the windows' directions, in cells of `steps` along each axis.
    #[pyo3(signature = (points, normals, steps, parts, report=None))]
    fn apertures<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f64>,
        normals: PyReadonlyArray2<'_, f64>,
        steps: usize,
        parts: usize,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Apertures<'py>> {
        let sensors = sensors(&points, &normals)?;
        let found = watched(py, report.as_ref(), |progress| {
            self.room.apertures(&sensors, &self.groups, steps, parts, progress)
        })?;
        let mut first = vec![0];
        first.extend(found.iter().scan(0, |end, cells| {
            *end += cells.len() as i64;
            Some(*end)
        }));
        let cells = || found.iter().flatten();
        let directions: Vec<f32> = cells().flat_map(|c| c.direction).collect();
        let count = cells().count();
        Ok((
            PyArray1::from_vec(py, first),
            PyArray1::from_iter(py, cells().map(|c| i64::from(c.number))),
            PyArray1::from_iter(py, cells().map(|c| c.solid_angle)),
            PyArray1::from_iter(py, cells().map(|c| c.projected)),
            PyArray1::from_vec(py, directions).reshape([count, 3])?,
        ))
    }

    /// Through which window points (rows) see directions (columns): its number from 1, 0 for none, 65535 where nothing is met.
    #[pyo3(signature = (points, directions, report=None))]
    fn outlooks<'py>(
        &self,
        py: Python<'py>,
        points: PyReadonlyArray2<'_, f64>,
        directions: PyReadonlyArray2<'_, f64>,
        report: Option<Py<PyAny>>,
    ) -> PyResult<Bound<'py, PyArray2<u16>>> {
        let (points, directions) = (vectors(&points)?, vectors(&directions)?);
        let found = watched(py, report.as_ref(), |progress| {
            self.room.windows_towards(&points, &directions, progress)
        })?;
        PyArray1::from_vec(py, found).reshape([points.len(), directions.len()])
    }

    /// What an eye at a point sees along directions (n, 3) of surfaces that suns (m, 3) light through windows: the window's number
    /// from 1, 0 for none, and the radiance by the irradiance of a plane that faces the sun (n, m).
    fn sunlit<'py>(
        &self,
        py: Python<'py>,
        point: [f64; 3],
        directions: PyReadonlyArray2<'_, f64>,
        suns: PyReadonlyArray2<'_, f64>,
    ) -> PyResult<LitBySuns<'py>> {
        let [x, y, z] = point;
        let (directions, suns) = (vectors(&directions)?, vectors(&suns)?);
        let found = watched(py, None, |progress| {
            self.room.lit_by_suns(Vec3::new(x, y, z), &directions, &suns, progress)
        })?;
        let shape = [directions.len(), suns.len()];
        Ok((
            PyArray1::from_iter(py, found.iter().map(|s| s.window)).reshape(shape)?,
            PyArray1::from_iter(py, found.iter().map(|s| s.radiance)).reshape(shape)?,
        ))
    }

    /// Points (count, 3) just before a group's windows outside; none (0, 3) where nothing but sky and ground is before them.
    fn outside_of<'py>(&self, py: Python<'py>, group: usize, count: u32) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let points = self.room.outside_of(group, &self.groups, count).map_err(raise)?;
        rows(py, points.into_iter().flat_map(Vec3::array).collect(), 3)
    }

    /// Axes of a group's samples in the world, a row each: x, y, and z into the room.
    fn frame(&self, group: usize) -> PyResult<[[f64; 3]; 3]> {
        let frame = self.room.frame_of(group, &self.groups).map_err(raise)?;
        Ok(frame.map(Vec3::array))
    }
}

/// Cells (n) of the square, row by row with `steps` along each axis, that points (n, 2) of the disk lie in.
#[pyfunction]
pub fn square_cells<'py>(
    py: Python<'py>,
    points: PyReadonlyArray2<'py, f64>,
    steps: usize,
) -> PyResult<Bound<'py, PyArray1<i64>>> {
    let cell = |p: &[f64; 2]| {
        let [row, column] = Disk::new(p[0], p[1])
            .to_square()
            .map(|u| ((u * steps as f64) as usize).min(steps - 1));
        (row * steps + column) as i64
    };
    Ok(PyArray1::from_iter(py, pairs(&points, "points")?.iter().map(cell)))
}

/// Outgoing directions (steps², 3), in the frame of a sample, of the middles of the square's cells, row by row.
#[pyfunction]
pub fn square_directions(py: Python<'_>, steps: usize) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let middle = |k: usize| (k as f64 + 0.5) / steps as f64;
    let directions = (0..steps * steps).flat_map(|cell| {
        let point = Disk::from_square([middle(cell / steps), middle(cell % steps)]);
        [point.x, point.y, point.cos_theta()]
    });
    rows(py, directions.collect(), 3)
}
