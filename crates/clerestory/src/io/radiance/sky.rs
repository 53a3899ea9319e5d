//! Skies: Radiance's formulas of their brightness with their numbers, and the command lines that make them.

use super::reader::{Definition, turn_of};
use super::words::shown;
use super::xform::{Transform, Xform};
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// A sky of a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Sky {
    /// Name of its pattern.
    pub name: String,
    /// What it is.
    pub model: SkyModel,
    /// It is turned by this about the vertical (degrees), counter-clockwise as seen from above.
    pub turn_deg: f64,
    /// File and line.
    pub place: String,
}

/// What a sky's brightness follows. Directions are in its own frame, x to the east and y to the north, before it is turned.
#[derive(Debug, Clone, PartialEq)]
pub enum SkyModel {
    /// `skybr` of skybright.cal.
    Cie {
        /// Its type.
        sky: CieSky,
        /// Radiance of the zenith [W/(m² sr)].
        zenith: f64,
        /// Radiance of the ground [W/(m² sr)].
        ground: f64,
        /// What the formula is divided by, and the direction of the sun (unit vector); for clear and intermediate skies.
        sun: Option<(f64, Vec3)>,
    },
    /// `skybright` of perezlum.cal.
    Perez {
        /// What the formula is multiplied by [W/(m² sr)].
        factor: f64,
        /// Radiance of the ground [W/(m² sr)].
        ground: f64,
        /// a, b, c, d, e of Perez's formula.
        coefficients: [f64; 5],
        /// Direction of the sun (unit vector).
        sun: Vec3,
    },
    /// A command line of `gensky`.
    Gensky(Gensky),
    /// A command line of `gendaylit`.
    Gendaylit(Gendaylit),
}

/// Types of sky of the CIE.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CieSky {
    /// Clear.
    Clear,
    /// Overcast.
    Overcast,
    /// The same everywhere.
    Uniform,
    /// Between clear and overcast.
    Intermediate,
}

impl CieSky {
    /// `clear`, `overcast`, `uniform` or `intermediate`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Clear => "clear",
            Self::Overcast => "overcast",
            Self::Uniform => "uniform",
            Self::Intermediate => "intermediate",
        }
    }
}

/// When a sky is, or where its sun stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum When {
    /// A time.
    Time {
        /// 1 to 12.
        month: u32,
        /// 1 to 31.
        day: u32,
        /// Hours after midnight.
        hour: f64,
        /// The hour is solar time, and not standard time.
        solar: bool,
    },
    /// The sun's altitude above the horizon and azimuth from the south, positive toward the west (degrees).
    Sun {
        /// Altitude.
        altitude_deg: f64,
        /// Azimuth.
        azimuth_deg: f64,
    },
}

/// Where a sky is (degrees).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Site {
    /// North is positive.
    pub latitude_deg: f64,
    /// West is positive.
    pub longitude_deg: f64,
    /// Meridian of the standard time; west is positive.
    pub meridian_deg: f64,
}

/// What a command line of `gensky` asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Gensky {
    /// When.
    pub when: When,
    /// A year, for which the sun's position is that of the almanac.
    pub year: Option<u32>,
    /// Where.
    pub site: Site,
    /// Type of sky.
    pub sky: CieSky,
    /// With the sun.
    pub sun: bool,
    /// Reflectance of the ground.
    pub ground_reflectance: f64,
    /// Turbidity (Linke's), which says how bright the zenith is.
    pub turbidity: f64,
    /// Radiance of the zenith [W/(m² sr)].
    pub zenith_radiance: Option<f64>,
    /// Horizontal irradiance of the sky [W/m²], instead of it.
    pub sky_irradiance: Option<f64>,
    /// Radiance of the sun [W/(m² sr)].
    pub sun_radiance: Option<f64>,
    /// Horizontal irradiance of the sun [W/m²], instead of it.
    pub sun_irradiance: Option<f64>,
}

/// What a command line of `gendaylit` asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Gendaylit {
    /// When.
    pub when: When,
    /// A year, for which the sun's position is that of the almanac.
    pub year: Option<u32>,
    /// Where.
    pub site: Site,
    /// How much light there is.
    pub supply: Supply,
    /// With the sun.
    pub sun: bool,
    /// Reflectance of the ground.
    pub ground_reflectance: f64,
    /// 0 for visible radiance [W/(m² sr)], 1 for that of the whole solar spectrum, 2 for luminance [cd/m²].
    pub output: u32,
    /// Time over which the values are means (minutes).
    pub interval_minutes: Option<f64>,
}

/// Light of the sun and the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Supply {
    /// Perez's clearness ε and brightness Δ.
    Perez {
        /// ε.
        clearness: f64,
        /// Δ.
        brightness: f64,
    },
    /// Direct normal and diffuse horizontal irradiance [W/m²].
    Irradiance {
        /// Direct normal.
        direct: f64,
        /// Diffuse horizontal.
        diffuse: f64,
    },
    /// Direct normal and diffuse horizontal illuminance [lux].
    Illuminance {
        /// Direct normal.
        direct: f64,
        /// Diffuse horizontal.
        diffuse: f64,
    },
    /// Direct horizontal and diffuse horizontal irradiance [W/m²].
    Horizontal {
        /// Direct horizontal.
        direct: f64,
        /// Diffuse horizontal.
        diffuse: f64,
    },
    /// Global horizontal irradiance [W/m²].
    Global {
        /// Global horizontal.
        global: f64,
    },
}

/// The sky of a pattern; or what is wrong with it.
pub(super) fn of_pattern(definition: &Definition) -> Result<Sky> {
    let (description, moved) = (&definition.description, definition.moved.unwrap_or(Transform::NONE));
    let words: Vec<&str> = description.words.iter().map(String::as_str).collect();
    let model = match words.as_slice() {
        ["skybr", "skybright.cal", ..] => cie(&description.numbers)?,
        ["skybright", "perezlum.cal", ..] => perez(&description.numbers)?,
        _ => {
            return Err(Error::Unsupported(format!(
                "a pattern of {} (there are skybr of skybright.cal and skybright of perezlum.cal, as gensky and gendaylit \
                 write them)",
                shown(&words.join(" "))
            )));
        }
    };
    let options = description.words.get(2..).unwrap_or_default();
    Ok(Sky {
        name: description.name.clone(),
        model,
        turn_deg: turn_of(&only_transform(options)?.then(&moved))?,
        place: description.place.clone(),
    })
}

/// The transform at the end of a pattern's or a data set's texts.
pub(super) fn only_transform(options: &[String]) -> Result<Transform> {
    let mut none = |name: &str| Err(Error::Unsupported(format!("a file of transforms, {}", shown(name))));
    let xform = Xform::parse(options, &mut none)?;
    match xform.copies.as_slice() {
        [(_, transform)] if xform.files.is_empty() => Ok(*transform),
        _ => Err(Error::Argument(format!(
            "{} as a transform (give options of xform, without -a and without files)",
            shown(&options.join(" "))
        ))),
    }
}

fn cie(numbers: &[f64]) -> Result<SkyModel> {
    let sky = match numbers.first() {
        Some(1.0) => CieSky::Clear,
        Some(2.0) => CieSky::Overcast,
        Some(3.0) => CieSky::Uniform,
        Some(4.0) => CieSky::Intermediate,
        other => {
            return Err(Error::Argument(format!(
                "{} as the type of sky (1 is clear, 2 overcast, 3 uniform, 4 intermediate)",
                other.map_or("nothing".into(), ToString::to_string)
            )));
        }
    };
    let sunny = matches!(sky, CieSky::Clear | CieSky::Intermediate);
    match *numbers {
        [_, zenith, ground, divisor, x, y, z] if sunny => Ok(SkyModel::Cie {
            sky,
            zenith,
            ground,
            sun: Some((divisor, unit(Vec3::new(x, y, z))?)),
        }),
        [_, zenith, ground, ..] if !sunny => Ok(SkyModel::Cie {
            sky,
            zenith,
            ground,
            sun: None,
        }),
        _ => Err(Error::Argument(format!(
            "{} real arguments, not {} as a sky that is {} has",
            numbers.len(),
            if sunny { 7 } else { 3 },
            sky.name()
        ))),
    }
}

fn perez(numbers: &[f64]) -> Result<SkyModel> {
    let &[factor, ground, a, b, c, d, e, x, y, z] = numbers else {
        return Err(Error::Argument(format!("{} real arguments, not 10", numbers.len())));
    };
    Ok(SkyModel::Perez {
        factor,
        ground,
        coefficients: [a, b, c, d, e],
        sun: unit(Vec3::new(x, y, z))?,
    })
}

fn unit(v: Vec3) -> Result<Vec3> {
    if v.length() > 0.0 {
        Ok(v.unit())
    } else {
        Err(Error::Argument("a sun in the direction 0 0 0".into()))
    }
}
