//! Sky and sun: radiance from every direction of the world (x east, y north, z up).
//!
//! * Weather to a sky: [`Sky::perez`], from irradiances or illuminances of sun and sky.
//! * Standard skies: [`Sky::cie`] (the fifteen general ones), [`Sky::traditional`] (clear, overcast, intermediate, uniform).
//! * A clear sky with its colours: [`Sky::preetham`].
//! * Patches of the sky (Tregenza, Reinhart): [`patches`].
//!
//! Two practices exist for everything that the models leave open, and [`Preset`] chooses between them.

pub mod cie;
mod distribution;
mod integrate;
pub mod patches;
pub mod perez;
mod preetham;
mod sun;
mod year;

use std::f64::consts::PI;

pub use cie::Traditional;
use distribution::Indicatrix;
pub use distribution::{Distribution, Lobed};
use perez::{Conditions, Daylight, Supply};
pub use preetham::Preetham;
pub use sun::{HALF_ANGLE, Place, Sun, SunPosition, day_of_year, disc_solid_angle};
pub use year::Step;

use crate::error::{Error, Result};
use crate::geometry::Vec3;
pub use crate::picture::colour::{EFFICACY, LUMINANCE};

/// Colour of the sky of Radiance's matrix program.
pub const RADIANCE_COLOUR: [f64; 3] = [0.960, 1.004, 1.118];
/// Water vapour of 2 cm, as a dew point (°C): the default of Radiance's point-sky program.
pub const DEW_POINT: f64 = 10.973_53;
/// The sun's lowest altitude (degrees) at which a sky that knows the sun has light: civil twilight.
const TWILIGHT: f64 = -6.0;
/// Highest sun (degrees) of Radiance's point-sky programs.
const HIGHEST: f64 = 87.0;

/// Whose choices a sky follows where its model leaves some.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Preset {
    /// Diffuse horizontal irradiance is conserved, the ground's radiance is its reflectance × E/π, the horizon is sharp,
    /// 179 lm/W everywhere.
    #[default]
    Clerestory,
    /// As Radiance's `gendaylit` and `gensky`: normalised over Tregenza's 145 centres, sun no higher than 87°, horizon
    /// blended into the ground, 203 lm/W in the skies of `gensky`.
    Radiance,
    /// As Radiance's `gendaymtx`: normalised over its own patches (see [`patches`]); Perez's sky only.
    RadianceMatrix,
}

/// What the watts of radiances are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Quantity {
    /// Visible watts, 179 lm each.
    #[default]
    Visible,
    /// All of the sun's spectrum.
    Solar,
}

/// Choices that all skies share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Whose practice.
    pub preset: Preset,
    /// Visible or solar watts.
    pub quantity: Quantity,
    /// Factors of R, G and B of the sky.
    pub colour: [f64; 3],
    /// Reflectance of the ground, 0 to 1.
    pub ground_reflectance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            preset: Preset::default(),
            quantity: Quantity::default(),
            colour: [1.0; 3],
            ground_reflectance: 0.2,
        }
    }
}

impl Settings {
    /// The settings if they make sense.
    fn checked(&self) -> Result<Self> {
        if !(0.0..=1.0).contains(&self.ground_reflectance) {
            return Err(Error::Argument(format!(
                "a ground reflectance of {} is not possible (give 0 to 1)",
                self.ground_reflectance
            )));
        }
        if self.colour.iter().any(|c| !c.is_finite() || *c < 0.0) || photometric(self.colour) <= 0.0 {
            return Err(Error::Argument(format!(
                "a sky colour of {:?} is not possible (give three numbers of at least 0)",
                self.colour
            )));
        }
        // Radiance's programs multiply by the colour as it is; here it does not change the luminance.
        let luminance = match self.preset {
            Preset::Clerestory => photometric(self.colour),
            Preset::Radiance | Preset::RadianceMatrix => 1.0,
        };
        Ok(Self {
            colour: self.colour.map(|c| c / luminance),
            ..*self
        })
    }
}

/// When: the sun, the day for its distance, and the dew point for water vapour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moment {
    /// Position of the sun, in the world of the sky.
    pub sun: SunPosition,
    /// Day of the year.
    pub day: u32,
    /// Dew point (°C).
    pub dew_point: f64,
}

/// How bright a standard sky is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Level {
    /// What sun and sky give.
    Supply(Supply),
    /// Luminance of the zenith (cd/m²).
    Zenith(f64),
    /// By the sun's altitude and this turbidity after Linke, with the formulas of Radiance's `gensky`.
    Turbidity(f64),
}

/// A sky with its sun and ground. It does not change.
#[derive(Debug, Clone)]
pub struct Sky {
    shape: Shape,
    /// Sun that the distribution is built about: not always where its disc is.
    about: SunPosition,
    toward: Vec3,
    sun: Option<Sun>,
    ground: [f64; 3],
    settings: Settings,
    daylight: Option<Daylight>,
    /// Irradiance of the sky on a horizontal plane, in the units of the radiances, where it is known.
    diffuse: Option<[f64; 3]>,
}

#[derive(Debug, Clone)]
enum Shape {
    /// A distribution times a scale (W/(m² sr)).
    Grey { distribution: Distribution, scale: f64 },
    /// Preetham's, times a factor (W/lm).
    Coloured { preetham: Preetham, factor: f64 },
}

impl Sky {
    /// Perez's all-weather sky.
    pub fn perez(moment: &Moment, supply: Supply, settings: &Settings) -> Result<Self> {
        Self::perez_with(moment, supply, settings, |distribution, zenith_angle| {
            distribution.horizontal(zenith_angle)
        })
    }

    /// The same, roughly scaled: for patches, which are scaled anew.
    fn perez_for_patches(moment: &Moment, supply: Supply, settings: &Settings) -> Result<Self> {
        Self::perez_with(moment, supply, settings, |distribution, zenith_angle| {
            distribution.horizontal_by_tregenza(zenith_angle)
        })
    }

    /// With a way to find ∫ L cos ζ dω over the sky where the preset has none of its own.
    fn perez_with(
        moment: &Moment,
        supply: Supply,
        settings: &Settings,
        horizontal: impl Fn(&Distribution, f64) -> f64,
    ) -> Result<Self> {
        let settings = settings.checked()?;
        let about = match settings.preset {
            Preset::Radiance => moment.sun.no_higher_than(HIGHEST.to_radians()),
            Preset::RadianceMatrix => moment.sun.no_lower_than(0.0).no_higher_than(HIGHEST.to_radians()),
            Preset::Clerestory => moment.sun,
        };
        by_day(moment.sun)?;
        let conditions = conditions(moment, about, &settings);
        let daylight = conditions.daylight(supply)?;
        let lobed = conditions.distribution(daylight.clearness, daylight.brightness)?;
        let mut distribution = Distribution::Lobed(lobed);
        let mut share = match settings.preset {
            Preset::Radiance => distribution.horizontal_by_tregenza(about.zenith_angle()),
            Preset::Clerestory | Preset::RadianceMatrix => horizontal(&distribution, about.zenith_angle()),
        };
        if share <= 0.0 {
            // Only outside of what was fitted: the matrix program makes it uniform.
            distribution = Distribution::UNIFORM;
            share = PI;
        }
        let (direct, diffuse) = watts(&daylight, settings.quantity);
        let scale = diffuse / share;
        let sun = disc(moment.sun, about, direct, &settings);
        let mut sky = Self::unlit(
            Shape::Grey { distribution, scale },
            about,
            sun,
            settings,
            Some(daylight),
        );
        match settings.preset {
            Preset::Radiance => {
                let ambient = if daylight.clearness <= 1.0 {
                    Traditional::Overcast
                } else if daylight.clearness >= 6.0 {
                    Traditional::Clear
                } else {
                    Traditional::Intermediate
                }
                .ambient_share(about.zenith_angle());
                let zenith = scale * lobed.value(1.0, about.zenith_angle());
                let by_sun = sun
                    .filter(|_| daylight.clearness > 1.0)
                    .map_or(0.0, |s| 6.8e-5 / PI * s.radiance[0] * about.altitude().sin());
                sky.ground = [settings.ground_reflectance * (zenith * ambient + by_sun); 3];
            }
            Preset::Clerestory | Preset::RadianceMatrix => sky.light_ground([diffuse; 3], direct, moment.sun),
        }
        Ok(sky)
    }

    /// A general sky of CIE, type 1 to 15.
    pub fn cie(kind: u32, moment: &Moment, level: Level, settings: &Settings) -> Result<Self> {
        let settings = settings.checked()?;
        settings.not_matrix()?;
        let distribution = cie::general(kind)?;
        if let Level::Turbidity(_) = level {
            return Err(Error::Argument(format!(
                "CIE sky {kind} says how light is distributed, not how much there is (give a diffuse illuminance or \
                 irradiance, or the luminance of the zenith)"
            )));
        }
        // Types without an indicatrix do not know the sun.
        if !matches!(kind, 1 | 3 | 5) {
            by_day(moment.sun)?;
        }
        Self::standard(distribution, None, moment, level, settings)
    }

    /// A traditional sky of CIE, or a uniform one; `sunny` says whether the sun is seen in a clear or intermediate one.
    pub fn traditional(
        kind: Traditional,
        sunny: bool,
        moment: &Moment,
        level: Level,
        settings: &Settings,
    ) -> Result<Self> {
        let settings = settings.checked()?;
        settings.not_matrix()?;
        let about = match settings.preset {
            Preset::Radiance => moment.sun.no_higher_than(HIGHEST.to_radians()),
            Preset::Clerestory | Preset::RadianceMatrix => moment.sun,
        };
        if kind.is_sunny() {
            by_day(about)?;
        }
        let moment = Moment { sun: about, ..*moment };
        let distribution = kind.distribution(about.zenith_angle());
        Self::standard(distribution, Some((kind, sunny)), &moment, level, settings)
    }

    /// A standard sky at a level.
    fn standard(
        distribution: Distribution,
        traditional: Option<(Traditional, bool)>,
        moment: &Moment,
        level: Level,
        settings: Settings,
    ) -> Result<Self> {
        let about = moment.sun;
        let zenith_angle = about.zenith_angle();
        let share = distribution.horizontal(zenith_angle);
        let genskys = settings.preset == Preset::Radiance;
        // At the zenith, with the constants of gensky where its practice is asked for.
        let at_zenith = match traditional {
            Some((kind, _)) if genskys => kind.at_zenith(zenith_angle),
            _ => distribution.value(1.0, zenith_angle),
        };
        let ambient = |kind: Traditional| kind.ambient_share(zenith_angle);
        let sunny = traditional.is_some_and(|(kind, sunny)| sunny && kind.is_sunny()) && about.altitude() > 0.0;
        let mut daylight = None;
        let (scale, direct) = match level {
            Level::Supply(supply) => {
                let found = conditions(moment, about, &settings).daylight(supply)?;
                daylight = Some(found);
                let (direct, diffuse) = watts(&found, settings.quantity);
                let hidden = traditional.is_some_and(|(kind, sunny)| kind.is_sunny() && !sunny);
                let direct = if hidden { 0.0 } else { direct };
                let scale = match traditional {
                    // Radiance: gensky -B, the zenith from the irradiance by its polynomials.
                    Some((kind, _)) if genskys => diffuse / (PI * ambient(kind) * kind.at_zenith(zenith_angle)),
                    _ => diffuse / share,
                };
                (scale, direct)
            }
            Level::Zenith(_) | Level::Turbidity(_) if settings.quantity == Quantity::Solar => {
                return Err(Error::Argument(
                    "solar watts of a sky of which only the luminance is known are unknown (give irradiances)".into(),
                ));
            }
            Level::Zenith(luminance) => {
                if !(luminance.is_finite() && luminance > 0.0) {
                    return Err(Error::Argument(format!(
                        "a zenith of {luminance} cd/m² is not possible (give a number above 0)"
                    )));
                }
                let direct = traditional
                    .filter(|_| sunny)
                    .map_or(0.0, |(kind, _)| sunshine(kind, about));
                let efficacy = if genskys { 203.0 } else { EFFICACY };
                (luminance / efficacy / at_zenith, direct)
            }
            Level::Turbidity(turbidity) => {
                let Some((kind, _)) = traditional else {
                    return Err(Error::Argument("this sky has no turbidity (give its level)".into()));
                };
                let needs = matches!(kind, Traditional::Clear | Traditional::Intermediate);
                if needs && !(turbidity.is_finite() && (1.5..=20.0).contains(&turbidity)) {
                    return Err(Error::Argument(format!(
                        "a turbidity of {turbidity} is not possible (give 1.5, pure air, to 20; 2.45 is usual)"
                    )));
                }
                // The tangent in the formula has no sense for a sun in the zenith.
                let altitude = about.altitude().min(HIGHEST.to_radians());
                let luminance = kind.zenith_luminance(altitude, turbidity);
                if luminance <= 0.0 {
                    return Err(Error::Argument(format!(
                        "there is no light with the sun {:.1}° above the horizon (choose another time, or give the sky's \
                         illuminance)",
                        altitude.to_degrees()
                    )));
                }
                let efficacy = if genskys { 203.0 } else { EFFICACY };
                let direct = if sunny { sunshine(kind, about) } else { 0.0 };
                (luminance / efficacy / at_zenith, direct)
            }
        };
        let mut sun = disc(about, about, direct, &settings);
        if genskys && sunny && daylight.is_none() {
            let radiance = traditional.map_or(0.0, |(kind, _)| kind.sun_radiance(about.altitude()));
            sun = sun.map(|s| Sun {
                radiance: [radiance; 3],
                half_angle: 0.25_f64.to_radians(),
                ..s
            });
        }
        let mut sky = Self::unlit(Shape::Grey { distribution, scale }, about, sun, settings, daylight);
        match traditional {
            Some((kind, _)) if genskys => {
                let by_sky = scale * at_zenith * ambient(kind);
                // Its ground is lit by the sun of a clear sky also where the disc is left out (option -s).
                let radiance = match level {
                    Level::Supply(_) => sun.map_or(0.0, |s| s.radiance[0]),
                    Level::Zenith(_) | Level::Turbidity(_) => kind.sun_radiance(about.altitude()),
                };
                let by_sun = 6e-5 / PI * radiance * about.altitude().sin().max(0.0);
                sky.ground = [settings.ground_reflectance * (by_sky + by_sun); 3];
            }
            _ => sky.light_ground([scale * share; 3], direct, about),
        }
        Ok(sky)
    }

    /// Preetham's clear sky; with its own colours, or `grey` with the settings' colour.
    ///
    /// Without a supply its level is the model's own, and the sun's comes from the turbidity.
    pub fn preetham(
        moment: &Moment,
        turbidity: f64,
        supply: Option<Supply>,
        grey: bool,
        settings: &Settings,
    ) -> Result<Self> {
        let settings = settings.checked()?;
        if settings.preset != Preset::Clerestory {
            return Err(Error::Argument(
                "Preetham's sky has no counterpart among Radiance's programs (take the preset clerestory)".into(),
            ));
        }
        let about = moment.sun;
        let preetham = Preetham::new(about.zenith_angle(), turbidity)?;
        let conditions = conditions(moment, about, &settings);
        let share = integrate::horizontal(about.zenith_angle(), |cos, gamma| preetham.luminance(cos, gamma));
        let daylight = supply.map(|s| conditions.daylight(s)).transpose()?;
        let (factor, direct) = match (daylight, settings.quantity) {
            (Some(found), quantity) => {
                let (direct, diffuse) = watts(&found, quantity);
                (diffuse / share, direct)
            }
            (None, Quantity::Visible) => (
                1.0 / EFFICACY,
                preetham::direct_illuminance(turbidity, conditions.air_mass(), conditions.eccentricity()) / EFFICACY,
            ),
            (None, Quantity::Solar) => {
                return Err(Error::Argument(
                    "solar watts of a sky of which only the luminance is known are unknown (give irradiances)".into(),
                ));
            }
        };
        let sun = disc(about, about, direct, &settings);
        let shape = Shape::Coloured { preetham, factor };
        let mut sky = Self::unlit(shape, about, sun, settings, daylight);
        let mut diffuse = [factor * share; 3];
        if grey {
            let (distribution, luminance) = preetham.grey();
            sky.shape = Shape::Grey {
                distribution,
                scale: factor * luminance,
            };
        } else {
            for (k, channel) in diffuse.iter_mut().enumerate() {
                *channel =
                    factor * integrate::horizontal(about.zenith_angle(), |cos, gamma| preetham.rgb(cos, gamma)[k]);
            }
        }
        sky.light_ground(diffuse, direct, about);
        Ok(sky)
    }

    /// Its ground still without light.
    fn unlit(
        shape: Shape,
        about: SunPosition,
        sun: Option<Sun>,
        settings: Settings,
        daylight: Option<Daylight>,
    ) -> Self {
        Self {
            shape,
            about,
            toward: about.direction(),
            sun,
            ground: [0.0; 3],
            settings,
            daylight,
            diffuse: None,
        }
    }

    /// Sets the ground's radiance, reflectance × E/π, and remembers the sky's horizontal irradiance.
    fn light_ground(&mut self, diffuse: [f64; 3], direct: f64, sun: SunPosition) {
        let by_sun = direct * sun.altitude().sin().max(0.0);
        let tint = match self.shape {
            Shape::Grey { .. } => self.settings.colour,
            Shape::Coloured { .. } => [1.0; 3],
        };
        let lit = |k: usize| match self.settings.preset {
            // The matrix program's ground is grey under a coloured sky.
            Preset::RadianceMatrix => diffuse[k],
            Preset::Clerestory | Preset::Radiance => diffuse[k] * tint[k],
        };
        self.ground = std::array::from_fn(|k| self.settings.ground_reflectance * (lit(k) + by_sun) / PI);
        self.diffuse = Some(std::array::from_fn(|k| diffuse[k] * tint[k]));
    }

    /// Radiance (W/(m² sr), Radiance's R, G, B) from a unit direction, without the sun's disc; below the horizon the
    /// ground's.
    pub fn radiance(&self, direction: Vec3) -> [f64; 3] {
        if direction.z < 0.0 && !self.blends() {
            return self.ground;
        }
        let gamma = direction.dot(self.toward).clamp(-1.0, 1.0).acos();
        self.value(direction.z, gamma)
    }

    /// A table of its indicatrix, if it has one and so many look-ups are worth it.
    fn indicatrix(&self, lookups: usize) -> Option<Indicatrix> {
        match &self.shape {
            Shape::Grey {
                distribution: Distribution::Lobed(lobed),
                ..
            } => (lookups >= Indicatrix::WORTH).then(|| Indicatrix::new(*lobed)),
            _ => None,
        }
    }

    /// Mean radiance of directions above the horizon.
    fn mean_radiance(&self, directions: &[Vec3], indicatrix: Option<&Indicatrix>) -> [f64; 3] {
        let count = directions.len() as f64;
        if let Shape::Grey {
            distribution: Distribution::Lobed(lobed),
            scale,
        } = &self.shape
            && !self.blends()
        {
            let sum = match indicatrix {
                Some(table) => lobed.sum(directions, self.toward, |cos| table.at(cos)),
                None => lobed.sum(directions, self.toward, |cos| lobed.about(cos)),
            };
            return self.settings.colour.map(|c| c * scale * sum / count);
        }
        let mut mean = [0.0; 3];
        for &direction in directions {
            for (total, l) in mean.iter_mut().zip(self.radiance(direction)) {
                *total += l / count;
            }
        }
        mean
    }

    /// Radiance by the cosine of the angle to the zenith and the angle to the sun (radians).
    fn value(&self, cos_zenith: f64, gamma: f64) -> [f64; 3] {
        let sky = match &self.shape {
            Shape::Grey { distribution, scale } => {
                let value = scale * distribution.value(cos_zenith, gamma);
                self.settings.colour.map(|c| c * value)
            }
            Shape::Coloured { preetham, factor } => preetham.rgb(cos_zenith, gamma).map(|c| c * factor),
        };
        if !self.blends() {
            return sky;
        }
        // Radiance's function files: the mean of sky and ground with these weights.
        let weight = (cos_zenith + 1.01).powi(10);
        std::array::from_fn(|k| (weight * sky[k] + self.ground[k] / weight) / (weight + 1.0 / weight))
    }

    fn blends(&self) -> bool {
        self.settings.preset == Preset::Radiance
    }

    /// Disc of the sun, if it is above the horizon and shines; in the matrix program's practice a sun just below it shines,
    /// too.
    pub fn sun(&self) -> Option<Sun> {
        self.sun
    }

    /// Position of the sun that the sky is built about.
    pub fn position(&self) -> SunPosition {
        self.about
    }

    /// Radiance of the ground.
    pub fn ground(&self) -> [f64; 3] {
        self.ground
    }

    /// Choices that it was made with.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Irradiances, illuminances, clearness and brightness, if it was made from some.
    pub fn daylight(&self) -> Option<&Daylight> {
        self.daylight.as_ref()
    }

    /// Relative distribution and its scale (W/(m² sr)), of a grey sky.
    pub fn distribution(&self) -> Option<(Distribution, f64)> {
        match self.shape {
            Shape::Grey { distribution, scale } => Some((distribution, scale)),
            Shape::Coloured { .. } => None,
        }
    }

    /// Preetham's sky and its factor (W/lm), of a coloured sky.
    pub fn coloured(&self) -> Option<(f64, &Preetham)> {
        match &self.shape {
            Shape::Coloured { preetham, factor } => Some((*factor, preetham)),
            Shape::Grey { .. } => None,
        }
    }

    /// Irradiance (W/m²) of the sky without the sun's disc on a horizontal plane that looks up.
    pub fn diffuse_horizontal(&self) -> [f64; 3] {
        self.diffuse.unwrap_or_else(|| {
            std::array::from_fn(|k| {
                integrate::horizontal(self.about.zenith_angle(), |cos, gamma| self.value(cos, gamma)[k])
            })
        })
    }

    /// Irradiance (W/m²) of the sun's disc on a plane that faces it.
    pub fn direct_normal(&self) -> [f64; 3] {
        self.sun.map_or([0.0; 3], |sun| {
            let solid_angle = disc_solid_angle(sun.half_angle);
            sun.radiance.map(|l| l * solid_angle)
        })
    }

    /// Irradiance (W/m²) of sky and ground, without the sun's disc, on a plane with a unit normal.
    pub fn diffuse_on(&self, normal: Vec3) -> [f64; 3] {
        integrate::on_plane(self.toward, normal, |direction| self.radiance(direction))
    }

    /// Irradiance (W/m²) of the sun's disc on a plane with a unit normal.
    pub fn direct_on(&self, normal: Vec3) -> [f64; 3] {
        let cos = self.sun.map_or(0.0, |sun| sun.direction.dot(normal).max(0.0));
        self.direct_normal().map(|e| e * cos)
    }
}

impl Settings {
    fn not_matrix(&self) -> Result<()> {
        if self.preset == Preset::RadianceMatrix {
            return Err(Error::Argument(
                "Radiance's matrix program makes Perez's sky only (take the preset radiance, or a perez sky)".into(),
            ));
        }
        Ok(())
    }
}

/// Luminance of a colour, as a share.
fn photometric(colour: [f64; 3]) -> f64 {
    colour.iter().zip(LUMINANCE).map(|(c, share)| c * share).sum()
}

fn by_day(sun: SunPosition) -> Result<()> {
    let altitude = sun.altitude().to_degrees();
    if altitude < TWILIGHT {
        return Err(Error::Argument(format!(
            "it is night: the sun is {:.1}° below the horizon (choose another time)",
            -altitude
        )));
    }
    Ok(())
}

fn conditions(moment: &Moment, about: SunPosition, settings: &Settings) -> Conditions {
    Conditions {
        sun_zenith: about.zenith_angle(),
        day: moment.day,
        dew_point: moment.dew_point,
        preset: settings.preset,
    }
}

/// Direct normal and diffuse horizontal irradiance in the units of the radiances.
fn watts(daylight: &Daylight, quantity: Quantity) -> (f64, f64) {
    match quantity {
        Quantity::Visible => (
            daylight.direct_illuminance / EFFICACY,
            daylight.diffuse_illuminance / EFFICACY,
        ),
        Quantity::Solar => (daylight.direct_irradiance, daylight.diffuse_irradiance),
    }
}

/// Direct normal irradiance (visible W/m²) of the sun in `gensky`'s clear and intermediate skies.
fn sunshine(kind: Traditional, sun: SunPosition) -> f64 {
    // Luminance at 208 lm/W in a disc of 6e-5 sr.
    kind.sun_radiance(sun.altitude()) * 208.0 * 6e-5 / EFFICACY
}

/// The disc of a direct normal irradiance, if it shines.
fn disc(sun: SunPosition, about: SunPosition, direct: f64, settings: &Settings) -> Option<Sun> {
    let position = match settings.preset {
        Preset::Radiance => about,
        Preset::Clerestory | Preset::RadianceMatrix => sun,
    };
    // The matrix program puts light of a sun below the horizon, which hours of sunset have, into the nearest patches.
    let up = position.altitude() > 0.0 || settings.preset == Preset::RadianceMatrix;
    (up && direct > 0.0).then(|| Sun {
        direction: position.direction(),
        radiance: [direct / disc_solid_angle(HALF_ANGLE); 3],
        half_angle: HALF_ANGLE,
    })
}

#[cfg(test)]
mod tests;
