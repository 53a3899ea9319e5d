//! Scene files of rooms.

use std::path::PathBuf;

use clerestory::geometry::Vec3;
use clerestory::io::radiance::{Gendaylit, Gensky, Site, Sky, SkyModel, Supply, When};
use clerestory::io::room::{DataSet, Distant, Light, Polygon, RoomScene};
use clerestory::io::{mtl, radiance};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};

use crate::arrays::rows;
use crate::errors::{ClerestoryError, raise};
use crate::trace_scene::PyScene;

/// What the files of a room hold, by name: `scene` and its `objects` and `elements` (object of each shape), `polygons`, `lights`,
/// `data_sets`, `sources`, `skies`. Radiance files are read one after the other as one scene; an OBJ file stands alone.
#[pyfunction]
pub fn read_room_scene(
    py: Python<'_>,
    paths: Vec<PathBuf>,
    metres_per_unit: f64,
    search: Vec<PathBuf>,
) -> PyResult<Bound<'_, PyDict>> {
    let is_obj = |path: &PathBuf| path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
    let room = match paths.as_slice() {
        [] => Err(ClerestoryError::new_err("no scene file is named (give one or more)")),
        [path] if is_obj(path) => py
            .detach(|| mtl::read_room(path, metres_per_unit, &search))
            .map_err(raise),
        _ => match paths.iter().find(|path| is_obj(path)) {
            Some(path) => Err(ClerestoryError::new_err(format!(
                "{}: an OBJ file is read alone (give it without other files)",
                path.display()
            ))),
            None => py
                .detach(|| radiance::read_room(&paths, metres_per_unit, &search))
                .map_err(raise),
        },
    }?;
    of_room(py, room)
}

fn of_room(py: Python<'_>, room: RoomScene) -> PyResult<Bound<'_, PyDict>> {
    let parts = PyDict::new(py);
    parts.set_item("polygons", list(py, &room.polygons, of_polygon)?)?;
    parts.set_item("lights", list(py, &room.lights, of_light)?)?;
    parts.set_item("data_sets", list(py, &room.data_sets, of_data_set)?)?;
    parts.set_item("sources", list(py, &room.sources, of_source)?)?;
    parts.set_item("skies", list(py, &room.skies, of_sky)?)?;
    parts.set_item("objects", &room.scene.objects)?;
    let elements = room.scene.elements.iter().map(|e| e.object).collect();
    parts.set_item("elements", PyArray1::from_vec(py, elements))?;
    parts.set_item("scene", PyScene::of(room.scene, room.materials))?;
    Ok(parts)
}

fn list<'py, T>(
    py: Python<'py>,
    all: &[T],
    of: fn(Python<'py>, &T) -> PyResult<Bound<'py, PyDict>>,
) -> PyResult<Bound<'py, PyList>> {
    PyList::new(py, all.iter().map(|one| of(py, one)).collect::<PyResult<Vec<_>>>()?)
}

fn of_polygon<'py>(py: Python<'py>, polygon: &Polygon) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("object", polygon.object)?;
    dict.set_item("surface", polygon.surface)?;
    let corners: Vec<f64> = polygon.corners.iter().flat_map(|c| c.array()).collect();
    dict.set_item("corners", rows(py, corners, 3)?)?;
    Ok(dict)
}

fn of_light<'py>(py: Python<'py>, light: &Light) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("surface", light.surface)?;
    dict.set_item("kind", &light.kind)?;
    dict.set_item("radiance", tuple(light.radiance))?;
    dict.set_item("reach", light.reach)?;
    dict.set_item("cone_deg", light.cone.map(|(angle, _)| angle))?;
    dict.set_item("axis", light.cone.map(|(_, axis)| vector(axis)))?;
    Ok(dict)
}

fn of_data_set<'py>(py: Python<'py>, set: &DataSet) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("surface", set.surface)?;
    dict.set_item("file", &set.file)?;
    dict.set_item("path", set.path.as_ref())?;
    dict.set_item("thickness", set.thickness)?;
    dict.set_item("up", vector(set.up))?;
    dict.set_item("peaks", set.peaks)?;
    let [front, back, transmission] = set.added.map(tuple);
    dict.set_item("added", (front, back, transmission))?;
    Ok(dict)
}

fn of_source<'py>(py: Python<'py>, source: &Distant) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &source.name)?;
    dict.set_item("direction", vector(source.direction))?;
    dict.set_item("angle_deg", source.angle_deg)?;
    dict.set_item("kind", &source.kind)?;
    dict.set_item("material", &source.material)?;
    dict.set_item("radiance", tuple(source.radiance))?;
    dict.set_item("sky", source.sky)?;
    dict.set_item("place", &source.place)?;
    Ok(dict)
}

fn of_sky<'py>(py: Python<'py>, sky: &Sky) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    dict.set_item("name", &sky.name)?;
    dict.set_item("place", &sky.place)?;
    dict.set_item("turn_deg", sky.turn_deg)?;
    let numbers = PyDict::new(py);
    let kind = match &sky.model {
        SkyModel::Cie {
            sky,
            zenith,
            ground,
            sun,
        } => {
            numbers.set_item("sky", sky.name())?;
            numbers.set_item("zenith", zenith)?;
            numbers.set_item("ground", ground)?;
            numbers.set_item("divisor", sun.map(|(divisor, _)| divisor))?;
            numbers.set_item("sun", sun.map(|(_, sun)| vector(sun)))?;
            "cie"
        }
        SkyModel::Perez {
            factor,
            ground,
            coefficients,
            sun,
        } => {
            numbers.set_item("factor", factor)?;
            numbers.set_item("ground", ground)?;
            numbers.set_item("coefficients", coefficients.to_vec())?;
            numbers.set_item("sun", vector(*sun))?;
            "perez"
        }
        SkyModel::Gensky(sky) => {
            of_gensky(&numbers, sky)?;
            "gensky"
        }
        SkyModel::Gendaylit(sky) => {
            of_gendaylit(&numbers, sky)?;
            "gendaylit"
        }
    };
    dict.set_item("kind", kind)?;
    dict.set_item("values", numbers)?;
    Ok(dict)
}

fn of_gensky(dict: &Bound<'_, PyDict>, sky: &Gensky) -> PyResult<()> {
    when_and_where(dict, sky.when, sky.year, sky.site)?;
    dict.set_item("sky", sky.sky.name())?;
    dict.set_item("sun", sky.sun)?;
    dict.set_item("ground_reflectance", sky.ground_reflectance)?;
    dict.set_item("turbidity", sky.turbidity)?;
    dict.set_item("zenith_radiance", sky.zenith_radiance)?;
    dict.set_item("sky_irradiance", sky.sky_irradiance)?;
    dict.set_item("sun_radiance", sky.sun_radiance)?;
    dict.set_item("sun_irradiance", sky.sun_irradiance)
}

fn of_gendaylit(dict: &Bound<'_, PyDict>, sky: &Gendaylit) -> PyResult<()> {
    when_and_where(dict, sky.when, sky.year, sky.site)?;
    let (supply, values) = match sky.supply {
        Supply::Perez { clearness, brightness } => ("perez", vec![clearness, brightness]),
        Supply::Irradiance { direct, diffuse } => ("irradiance", vec![direct, diffuse]),
        Supply::Illuminance { direct, diffuse } => ("illuminance", vec![direct, diffuse]),
        Supply::Horizontal { direct, diffuse } => ("horizontal", vec![direct, diffuse]),
        Supply::Global { global } => ("global", vec![global]),
    };
    dict.set_item("supply", supply)?;
    dict.set_item("supplied", values)?;
    dict.set_item("sun", sky.sun)?;
    dict.set_item("ground_reflectance", sky.ground_reflectance)?;
    dict.set_item("output", sky.output)?;
    dict.set_item("interval_minutes", sky.interval_minutes)
}

fn when_and_where(dict: &Bound<'_, PyDict>, when: When, year: Option<u32>, site: Site) -> PyResult<()> {
    match when {
        When::Time {
            month,
            day,
            hour,
            solar,
        } => {
            dict.set_item("month", month)?;
            dict.set_item("day", day)?;
            dict.set_item("hour", hour)?;
            dict.set_item("solar_time", solar)?;
        }
        When::Sun {
            altitude_deg,
            azimuth_deg,
        } => {
            dict.set_item("altitude_deg", altitude_deg)?;
            dict.set_item("azimuth_deg", azimuth_deg)?;
        }
    }
    dict.set_item("year", year)?;
    dict.set_item("latitude_deg", site.latitude_deg)?;
    dict.set_item("longitude_deg", site.longitude_deg)?;
    dict.set_item("meridian_deg", site.meridian_deg)
}

fn tuple([a, b, c]: [f64; 3]) -> (f64, f64, f64) {
    (a, b, c)
}

fn vector(v: Vec3) -> (f64, f64, f64) {
    (v.x, v.y, v.z)
}
