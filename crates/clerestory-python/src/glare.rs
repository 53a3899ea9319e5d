//! Glare of pictures and of known sources.

use clerestory::geometry::Vec3;
use clerestory::glare::{
    Background, Elements, Evaluation, Field, Indices, Lens, Light, PositionIndex, Settings, Source, Task, Threshold,
    evaluate, rate,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::rows;
use crate::errors::{ClerestoryError, raise};
use crate::picture::{PyPicture, PyView};

/// Choices as Python's settings have them.
#[derive(FromPyObject, IntoPyObject)]
pub struct SettingsParts {
    threshold: f64,
    threshold_of: String,
    task: Option<(f64, f64, f64)>,
    search_radius: f64,
    smoothing: bool,
    peaks: Option<f64>,
    background: String,
    position_index: String,
    low_light: bool,
    age: Option<f64>,
    vertical_illuminance: Option<f64>,
    luminance_weights: [f64; 3],
}

const BACKGROUNDS: [(&str, Background); 3] = [
    ("without-sources", Background::WithoutSources),
    ("mean", Background::Mean),
    ("illuminance", Background::Illuminance),
];
const POSITIONS: [(&str, PositionIndex); 2] = [("guth-iwata", PositionIndex::GuthIwata), ("kim", PositionIndex::Kim)];

/// What a name stands for.
fn named<T: Copy>(table: &[(&str, T)], name: &str, what: &str) -> PyResult<T> {
    let found = table.iter().find(|(n, _)| *n == name);
    found.map(|(_, value)| *value).ok_or_else(|| {
        let names: Vec<&str> = table.iter().map(|(n, _)| *n).collect();
        ClerestoryError::new_err(format!("{what} {name:?} is not known (give {})", names.join(" or ")))
    })
}

fn name<T: PartialEq>(table: &[(&'static str, T)], value: &T) -> String {
    table.iter().find(|(_, v)| v == value).map_or("", |(n, _)| n).to_owned()
}

impl SettingsParts {
    fn settings(self) -> PyResult<Settings> {
        let kind: fn(f64) -> Threshold = named(
            &[
                ("absolute", Threshold::Absolute as fn(f64) -> Threshold),
                ("mean", Threshold::TimesMean),
                ("task", Threshold::TimesTask),
            ],
            &self.threshold_of,
            "threshold of",
        )?;
        Ok(Settings {
            threshold: kind(self.threshold),
            task: self.task.map(|(x, y, angle)| Task { x, y, angle }),
            search_radius: self.search_radius,
            smoothing: self.smoothing,
            peaks: self.peaks,
            background: named(&BACKGROUNDS, &self.background, "background")?,
            position_index: named(&POSITIONS, &self.position_index, "position index")?,
            low_light: self.low_light,
            age: self.age,
            vertical_illuminance: self.vertical_illuminance,
            luminance_weights: self.luminance_weights,
        })
    }

    fn of(settings: &Settings) -> Self {
        let (threshold_of, threshold) = match settings.threshold {
            Threshold::Absolute(v) => ("absolute", v),
            Threshold::TimesMean(v) => ("mean", v),
            Threshold::TimesTask(v) => ("task", v),
        };
        Self {
            threshold,
            threshold_of: threshold_of.into(),
            task: settings.task.map(|t| (t.x, t.y, t.angle)),
            search_radius: settings.search_radius,
            smoothing: settings.smoothing,
            peaks: settings.peaks,
            background: name(&BACKGROUNDS, &settings.background),
            position_index: name(&POSITIONS, &settings.position_index),
            low_light: settings.low_light,
            age: settings.age,
            vertical_illuminance: settings.vertical_illuminance,
            luminance_weights: settings.luminance_weights,
        }
    }
}

/// The choices of a program's release, by name.
#[pyfunction]
pub fn glare_preset(name: &str) -> PyResult<SettingsParts> {
    Settings::preset(name).map(|s| SettingsParts::of(&s)).map_err(raise)
}

/// Index names with their values.
fn indices(i: &Indices) -> Vec<(&'static str, f64)> {
    vec![
        ("dgp", i.dgp),
        ("dgps", i.dgps),
        ("dgi", i.dgi),
        ("dgi_mod", i.dgi_mod),
        ("ugr", i.ugr),
        ("ugr_exp", i.ugr_exp),
        ("ugp", i.ugp),
        ("ugp2", i.ugp2),
        ("cgi", i.cgi),
        ("vcp", i.vcp),
        ("dgr", i.dgr),
        ("veiling_luminance", i.veiling_luminance),
        ("vertical_illuminance", i.vertical_illuminance),
        ("direct_illuminance", i.direct_illuminance),
        ("background_luminance", i.background_luminance),
        ("mean_luminance", i.mean_luminance),
    ]
}

/// Columns of a source.
const COLUMNS: usize = 11;

fn table<'py>(py: Python<'py>, sources: &[Source]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let values = sources
        .iter()
        .flat_map(|s| -> [f64; COLUMNS] {
            let [x, y, z] = s.direction.array();
            [
                x,
                y,
                z,
                s.luminance,
                s.largest,
                s.solid_angle,
                s.illuminance,
                s.sigma,
                s.position_index,
                s.pixels as f64,
                f64::from(u8::from(s.peak)),
            ]
        })
        .collect();
    rows(py, values, COLUMNS)
}

/// Sources, indices, threshold, task luminance, solid angle, labels, warnings.
type Evaluated<'py> = (
    Bound<'py, PyArray2<f64>>,
    Vec<(&'static str, f64)>,
    f64,
    Option<f64>,
    f64,
    Bound<'py, PyArray2<u32>>,
    Vec<String>,
);

/// Geometry of pictures of one view and size.
#[pyclass(name = "GlareLens", frozen, module = "clerestory")]
pub struct PyLens(Lens);

#[pymethods]
impl PyLens {
    #[new]
    fn new(py: Python<'_>, view: &PyView, width: usize, height: usize) -> PyResult<Self> {
        py.detach(|| Lens::new(view.0, width, height)).map(Self).map_err(raise)
    }

    /// Rates a picture.
    fn evaluate<'py>(&self, py: Python<'py>, picture: &PyPicture, settings: SettingsParts) -> PyResult<Evaluated<'py>> {
        let settings = settings.settings()?;
        let found = py
            .detach(|| {
                let luminance = if picture.0.has_other_primaries() {
                    picture.0.luminance()?
                } else {
                    picture.0.weighted(settings.luminance_weights)
                };
                evaluate(&luminance, &self.0, &settings)
            })
            .map_err(raise)?;
        let Evaluation {
            sources,
            indices: i,
            threshold,
            task_luminance,
            solid_angle,
            labels,
            warnings,
        } = found;
        let [width, height] = self.0.size();
        Ok((
            table(py, &sources)?,
            indices(&i),
            threshold,
            task_luminance,
            solid_angle,
            PyArray1::from_vec(py, labels).reshape([height, width])?,
            warnings,
        ))
    }
}

/// Sources and indices.
type Rated<'py> = (Bound<'py, PyArray2<f64>>, Vec<(&'static str, f64)>);

/// Rates known sources: rows of direction, luminance and solid angle (n, 5).
#[pyfunction]
pub fn rate_glare<'py>(
    py: Python<'py>,
    lights: PyReadonlyArray2<'py, f64>,
    view: &PyView,
    vertical_illuminance: f64,
    mean_luminance: f64,
    mean_background: f64,
    settings: SettingsParts,
) -> PyResult<Rated<'py>> {
    if lights.shape()[1] != 5 {
        return Err(ClerestoryError::new_err(
            "glare sources: give x, y, z, luminance and solid angle a row",
        ));
    }
    let lights: Vec<Light> = lights
        .as_array()
        .rows()
        .into_iter()
        .map(|l| Light {
            direction: Vec3::new(l[0], l[1], l[2]),
            luminance: l[3],
            solid_angle: l[4],
        })
        .collect();
    let field = Field {
        vertical_illuminance,
        mean_luminance,
        mean_background,
    };
    let (sources, found) = rate(&lights, &view.0, &field, &settings.settings()?).map_err(raise)?;
    Ok((table(py, &sources)?, indices(&found)))
}

/// Columns of indices by name.
type Columns<'py> = Vec<(&'static str, Bound<'py, PyArray1<f64>>)>;

/// Rates a field of view at many hours: directions (n, 3) and solid angles (n) of its parts, their luminances (hours, n), one light an
/// hour (hours, 5: x, y, z, cd/m², sr; none where its luminance is 0), and the illuminance at the eye (hours). Dark hours
/// are not a number.
#[pyfunction]
#[allow(clippy::too_many_arguments, reason = "a view, its parts, and their light")]
pub fn rate_glare_hours<'py>(
    py: Python<'py>,
    view: &PyView,
    directions: PyReadonlyArray2<'py, f64>,
    solid_angles: PyReadonlyArray1<'py, f64>,
    luminances: PyReadonlyArray2<'py, f32>,
    lights: PyReadonlyArray2<'py, f64>,
    illuminances: PyReadonlyArray1<'py, f64>,
    settings: SettingsParts,
) -> PyResult<Columns<'py>> {
    let settings = settings.settings()?;
    let directions: Vec<Vec3> = directions
        .as_array()
        .rows()
        .into_iter()
        .map(|d| Vec3::new(d[0], d[1], d[2]))
        .collect();
    let elements = Elements::new(view.0, &directions, solid_angles.as_slice()?, &settings).map_err(raise)?;
    let (lights, illuminances) = (lights.as_array(), illuminances.as_slice()?);
    let hours = illuminances.len();
    if luminances.shape() != [hours, directions.len()] || lights.dim() != (hours, 5) {
        return Err(ClerestoryError::new_err(
            "luminances, lights and illuminances do not fit together (give a row an hour)",
        ));
    }
    let luminances = luminances.as_slice()?;
    let count = directions.len();
    let found: Vec<Vec<(&'static str, f64)>> = py
        .detach(|| {
            (0..hours)
                .into_par_iter()
                .map(|hour| {
                    let l = lights.row(hour);
                    let light = Light {
                        direction: Vec3::new(l[0], l[1], l[2]),
                        luminance: l[3],
                        solid_angle: l[4],
                    };
                    if illuminances[hour] <= 0.0 {
                        return Ok(Vec::new());
                    }
                    let lights = if light.luminance > 0.0 { &[light][..] } else { &[] };
                    let here = &luminances[hour * count..(hour + 1) * count];
                    let (_, rated) = elements.rate(here, lights, illuminances[hour])?;
                    Ok(indices(&rated))
                })
                .collect::<clerestory::Result<_>>()
        })
        .map_err(raise)?;
    let Some(names) = found.iter().find(|row| !row.is_empty()) else {
        return Ok(Vec::new());
    };
    let column = |k: usize| {
        found
            .iter()
            .map(move |row| row.get(k).map_or(f64::NAN, |(_, value)| *value))
    };
    Ok(names
        .iter()
        .enumerate()
        .map(|(k, (name, _))| (*name, PyArray1::from_iter(py, column(k))))
        .collect())
}
