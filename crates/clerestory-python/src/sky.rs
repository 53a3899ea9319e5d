//! Skies and their patches.

use clerestory::geometry::Vec3;
use clerestory::sky::patches::{Part, SkyPatches, SunPatches, Value};
use clerestory::sky::perez::Supply;
use clerestory::sky::{
    Distribution, Level, Moment, Place, Preset, Quantity, Settings, Sky, Step, SunPosition, Traditional, cie,
    day_of_year,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, ToPyArray};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::arrays::{rows, table};
use crate::errors::{ClerestoryError, raise};
use crate::jobs::watched;

/// Altitude and azimuth (degrees), day of the year, dew point (°C).
type MomentArguments = (f64, f64, u32, f64);
/// Name of the quantity and its one or two values.
type LevelArguments = (String, f64, f64);
/// Preset, quantity, colour, ground reflectance.
type SettingArguments = (String, String, [f64; 3], f64);
/// Direction, radiance, half angle (radians).
type SunValues = ([f64; 3], [f64; 3], f64);

/// A sky with its sun and ground.
#[pyclass(name = "Sky", frozen, module = "clerestory")]
pub struct PySky(pub Sky);

fn moment((altitude, azimuth, day, dew_point): MomentArguments) -> PyResult<Moment> {
    if !dew_point.is_finite() {
        return Err(ClerestoryError::new_err(format!(
            "a dew point of {dew_point} °C is not possible"
        )));
    }
    Ok(Moment {
        sun: SunPosition::from_degrees(altitude, azimuth).map_err(raise)?,
        day,
        dew_point,
    })
}

fn level((name, first, second): LevelArguments) -> PyResult<Level> {
    Ok(match name.as_str() {
        "irradiance" => Level::Supply(Supply::Irradiance {
            direct_normal: first,
            diffuse_horizontal: second,
        }),
        "illuminance" => Level::Supply(Supply::Illuminance {
            direct_normal: first,
            diffuse_horizontal: second,
        }),
        "global" => Level::Supply(Supply::Global(first)),
        "zenith" => Level::Zenith(first),
        "turbidity" => Level::Turbidity(first),
        _ => return Err(ClerestoryError::new_err(format!("a level {name:?} is not known"))),
    })
}

fn supply(arguments: LevelArguments) -> PyResult<Supply> {
    match level(arguments)? {
        Level::Supply(supply) => Ok(supply),
        Level::Zenith(_) | Level::Turbidity(_) => Err(ClerestoryError::new_err(
            "this sky is made from irradiances or illuminances",
        )),
    }
}

fn settings((preset, quantity, colour, ground_reflectance): SettingArguments) -> PyResult<Settings> {
    Ok(Settings {
        preset: match preset.as_str() {
            "clerestory" => Preset::Clerestory,
            "radiance" => Preset::Radiance,
            "radiance-matrix" => Preset::RadianceMatrix,
            _ => {
                return Err(ClerestoryError::new_err(format!(
                    "a preset {preset:?} is not known (known: clerestory, radiance, radiance-matrix)"
                )));
            }
        },
        quantity: match quantity.as_str() {
            "visible" => Quantity::Visible,
            "solar" => Quantity::Solar,
            _ => {
                return Err(ClerestoryError::new_err(format!(
                    "a quantity {quantity:?} is not known (known: visible, solar)"
                )));
            }
        },
        colour,
        ground_reflectance,
    })
}

#[pymethods]
impl PySky {
    #[staticmethod]
    fn perez(at: MomentArguments, light: LevelArguments, choices: SettingArguments) -> PyResult<Self> {
        Sky::perez(&moment(at)?, supply(light)?, &settings(choices)?)
            .map(Self)
            .map_err(raise)
    }

    #[staticmethod]
    fn cie(kind: u32, at: MomentArguments, light: LevelArguments, choices: SettingArguments) -> PyResult<Self> {
        Sky::cie(kind, &moment(at)?, level(light)?, &settings(choices)?)
            .map(Self)
            .map_err(raise)
    }

    #[staticmethod]
    fn traditional(
        kind: &str,
        sunny: bool,
        at: MomentArguments,
        light: LevelArguments,
        choices: SettingArguments,
    ) -> PyResult<Self> {
        let kind = Traditional::named(kind).map_err(raise)?;
        Sky::traditional(kind, sunny, &moment(at)?, level(light)?, &settings(choices)?)
            .map(Self)
            .map_err(raise)
    }

    #[staticmethod]
    fn preetham(
        turbidity: f64,
        grey: bool,
        at: MomentArguments,
        light: Option<LevelArguments>,
        choices: SettingArguments,
    ) -> PyResult<Self> {
        let light = light.map(supply).transpose()?;
        Sky::preetham(&moment(at)?, turbidity, light, grey, &settings(choices)?)
            .map(Self)
            .map_err(raise)
    }

    /// Radiance (n, 3) from unit directions (n, 3).
    fn radiance<'py>(
        &self,
        py: Python<'py>,
        directions: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let directions = vectors(&directions)?;
        let values: Vec<[f64; 3]> = py.detach(|| directions.par_iter().map(|&d| self.0.radiance(d)).collect());
        triples(py, &values)
    }

    #[getter]
    fn sun(&self) -> Option<SunValues> {
        self.0.sun().map(|s| (s.direction.array(), s.radiance, s.half_angle))
    }

    /// Altitude and azimuth (degrees) of the sun that the sky is built about.
    #[getter]
    fn position(&self) -> (f64, f64) {
        degrees(self.0.position())
    }

    #[getter]
    fn ground(&self) -> [f64; 3] {
        self.0.ground()
    }

    /// Direct and diffuse irradiance, direct and diffuse illuminance, ε, Δ.
    #[getter]
    fn daylight(&self) -> Option<[f64; 6]> {
        self.0.daylight().map(|d| {
            [
                d.direct_irradiance,
                d.diffuse_irradiance,
                d.direct_illuminance,
                d.diffuse_illuminance,
                d.clearness,
                d.brightness,
            ]
        })
    }

    /// Scale (W/(m² sr)) and a, b, base, c, d, e; without coefficients for the overcast and the intermediate sky.
    #[getter]
    fn distribution(&self) -> Option<(f64, Option<[f64; 6]>)> {
        self.0.distribution().map(|(distribution, scale)| match distribution {
            Distribution::Lobed(l) => (scale, Some([l.a, l.b, l.base, l.c, l.d, l.e])),
            Distribution::Overcast | Distribution::Intermediate { .. } => (scale, None),
        })
    }

    /// Factor (W/lm), lobes (a, b, base, c, d, e) of Y, x and y and their scales, RGB of XYZ; of a coloured sky.
    #[getter]
    #[allow(clippy::type_complexity, reason = "plain numbers for a function file")]
    fn coloured(&self) -> Option<(f64, [[f64; 6]; 3], [f64; 3], [[f64; 3]; 3])> {
        self.0.coloured().map(|(factor, sky)| {
            let lobes = sky.lobes().map(|l| [l.a, l.b, l.base, l.c, l.d, l.e]);
            (factor, lobes, sky.scales(), sky.rgb_of_xyz())
        })
    }

    fn diffuse_horizontal(&self) -> [f64; 3] {
        self.0.diffuse_horizontal()
    }

    fn direct_normal(&self) -> [f64; 3] {
        self.0.direct_normal()
    }

    /// Irradiance (n, 3) of sky and ground on planes with unit normals (n, 3).
    fn diffuse_on<'py>(
        &self,
        py: Python<'py>,
        normals: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let normals = vectors(&normals)?;
        let values: Vec<[f64; 3]> = py.detach(|| normals.par_iter().map(|&n| self.0.diffuse_on(n)).collect());
        triples(py, &values)
    }

    /// Irradiance (n, 3) of the sun on planes with unit normals (n, 3).
    fn direct_on<'py>(
        &self,
        py: Python<'py>,
        normals: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values: Vec<[f64; 3]> = vectors(&normals)?.into_iter().map(|n| self.0.direct_on(n)).collect();
        triples(py, &values)
    }

    /// Radiance (patches, 3) with the ground first.
    fn patches<'py>(
        &self,
        py: Python<'py>,
        patches: &PySkyPatches,
        part: &str,
        disc_deg: Option<f64>,
        mean: bool,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let part = named_part(part)?;
        let (sun, value) = (sun_patches(disc_deg), patch_value(mean));
        let values = py
            .detach(|| patches.0.radiances(&self.0, part, sun, value))
            .map_err(raise)?;
        triples(py, &values)
    }
}

fn named_part(name: &str) -> PyResult<Part> {
    Ok(match name {
        "all" => Part::All,
        "sky" => Part::Sky,
        "sun" => Part::Sun,
        _ => {
            return Err(ClerestoryError::new_err(format!(
                "a part {name:?} is not known (known: all, sky, sun)"
            )));
        }
    })
}

fn sun_patches(disc_deg: Option<f64>) -> SunPatches {
    disc_deg.map_or(SunPatches::Spread, SunPatches::Disc)
}

fn patch_value(mean: bool) -> Value {
    if mean { Value::Mean } else { Value::Centre }
}

/// A division of the sky.
#[pyclass(name = "SkyPatches", frozen, module = "clerestory")]
pub struct PySkyPatches(pub SkyPatches);

#[pymethods]
impl PySkyPatches {
    #[staticmethod]
    fn named(name: &str) -> PyResult<Self> {
        SkyPatches::named(name).map(Self).map_err(raise)
    }

    #[getter]
    fn subdivision(&self) -> usize {
        self.0.subdivision()
    }

    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn centres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let centres: Vec<[f64; 3]> = (0..self.0.len()).map(|p| self.0.centre(p).array()).collect();
        triples(py, &centres)
    }

    fn solid_angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let values: Vec<f64> = (0..self.0.len()).map(|p| self.0.solid_angle(p)).collect();
        values.to_pyarray(py)
    }

    fn projected_solid_angles<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let values: Vec<f64> = (0..self.0.len()).map(|p| self.0.projected_solid_angle(p)).collect();
        values.to_pyarray(py)
    }

    fn patch_of<'py>(
        &self,
        py: Python<'py>,
        directions: PyReadonlyArray2<'py, f64>,
    ) -> PyResult<Bound<'py, PyArray1<i64>>> {
        let found: Vec<i64> = vectors(&directions)?
            .into_iter()
            .map(|d| self.0.patch_of(d) as i64)
            .collect();
        Ok(found.to_pyarray(py))
    }

    /// Perez's skies (n, patches) of moments (n, 4), each with two values of light (n, 2).
    #[allow(clippy::too_many_arguments, reason = "plain numbers from Python")]
    fn columns<'py>(
        &self,
        py: Python<'py>,
        moments: PyReadonlyArray2<'py, f64>,
        light_name: &str,
        light: PyReadonlyArray2<'py, f64>,
        choices: SettingArguments,
        part: &str,
        disc_deg: Option<f64>,
        mean: bool,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let steps = table::<4>(&moments, "moments", "altitude, azimuth, day, dew point")?
            .iter()
            .zip(table::<2>(&light, "light", "direct and diffuse")?)
            .map(|(&[altitude, azimuth, day, dew_point], &[direct, diffuse])| {
                Ok(Step {
                    moment: moment((altitude, azimuth, day as u32, dew_point))?,
                    supply: supply((light_name.into(), direct, diffuse))?,
                })
            })
            .collect::<PyResult<Vec<_>>>()?;
        let (settings, part) = (settings(choices)?, named_part(part)?);
        let (sun, value) = (sun_patches(disc_deg), patch_value(mean));
        let count = steps.len();
        let values = watched(py, None, |progress| {
            self.0.columns(&steps, &settings, part, sun, value, progress)
        })?;
        PyArray1::from_vec(py, values).reshape([count, self.0.len()])
    }
}

/// Altitude and azimuth (degrees) of the sun by one of Radiance's formulas: the almanac's with a year, else the low-order one.
#[pyfunction]
pub fn sun_by_radiance(
    place: (f64, f64, f64),
    month: u32,
    day: u32,
    hour: f64,
    year: Option<i32>,
) -> PyResult<(f64, f64)> {
    let place = Place {
        latitude_deg: place.0,
        longitude_deg: place.1,
        time_zone: place.2,
    };
    let in_year = day_of_year(month, day).map_err(raise)?;
    Ok(degrees(match year {
        Some(year) => {
            let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
            SunPosition::almanac(&place, year, in_year + u32::from(leap && month > 2), hour)
        }
        None => SunPosition::low_order(&place, in_year, hour),
    }))
}

/// Normalising factor at the zenith of a traditional sky by `gensky`, for an altitude of the sun (degrees).
#[pyfunction]
pub fn gensky_factor(kind: &str, altitude: f64) -> PyResult<f64> {
    let kind = Traditional::named(kind).map_err(raise)?;
    Ok(kind.at_zenith((90.0 - altitude).to_radians()))
}

/// What CIE calls its general skies 1 to 15.
#[pyfunction]
pub fn cie_names() -> Vec<&'static str> {
    cie::NAMES.to_vec()
}

fn degrees(sun: SunPosition) -> (f64, f64) {
    (sun.altitude().to_degrees(), sun.azimuth().to_degrees())
}

fn triples<'py>(py: Python<'py>, values: &[[f64; 3]]) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let flat: Vec<f64> = values.iter().flatten().copied().collect();
    rows(py, flat, 3)
}

/// Rows of an (n, 3) array as unit vectors.
fn vectors(array: &PyReadonlyArray2<'_, f64>) -> PyResult<Vec<Vec3>> {
    array
        .as_array()
        .rows()
        .into_iter()
        .map(|row| {
            let vector = (row.len() == 3).then(|| Vec3::new(row[0], row[1], row[2]));
            vector
                .filter(|v| v.length().is_finite() && v.length() > 0.0)
                .map(Vec3::unit)
                .ok_or_else(|| {
                    ClerestoryError::new_err("directions are triples of finite numbers x, y, z that are not all 0")
                })
        })
        .collect()
}
