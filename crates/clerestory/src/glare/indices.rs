//! What indices say of sources that are known.
//!
//! Formulas: Wienold and Christoffersen (2006, Energy and Buildings 38) for the daylight glare probability, and as the manual
//! page of `evalglare` lists them for the rest; constants were checked against runs of release 3.06.

use std::f64::consts::{PI, SQRT_2};

use super::position::position_index;
use super::settings::{Background, Settings};
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::picture::Camera;

/// Light from a part of the field of view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Light {
    /// Toward it, of any length, in the world.
    pub direction: Vec3,
    /// Mean luminance (cd/m²).
    pub luminance: f64,
    /// Solid angle (steradians).
    pub solid_angle: f64,
}

/// A glare source with its place in the field of view.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Source {
    /// Toward it, of length 1, in the world.
    pub direction: Vec3,
    /// Mean luminance (cd/m²).
    pub luminance: f64,
    /// Largest luminance (cd/m²).
    pub largest: f64,
    /// Solid angle (steradians).
    pub solid_angle: f64,
    /// Its part of the illuminance at the eye (lx).
    pub illuminance: f64,
    /// Angle from the line of sight (radians).
    pub sigma: f64,
    /// Position index.
    pub position_index: f64,
    /// Its number of pixels; 0 without a picture.
    pub pixels: usize,
    /// Whether it was cut out of a larger source as a peak.
    pub peak: bool,
}

impl Source {
    /// L² ω/P², by which sources are ranked.
    pub fn weight(&self) -> f64 {
        self.luminance * self.luminance * self.solid_angle / (self.position_index * self.position_index)
    }
}

/// What an eye sees besides sources. What is not known is not a number, and so are the indices that need it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Field {
    /// Illuminance at the eye, sources included (lx).
    pub vertical_illuminance: f64,
    /// Mean luminance, sources included (cd/m²).
    pub mean_luminance: f64,
    /// Mean luminance without the sources (cd/m²).
    pub mean_background: f64,
}

/// Indices of a scene. Without sources those that rate sources only are 0, and the visual comfort probability 100.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Indices {
    /// Illuminance at the eye (lx).
    pub vertical_illuminance: f64,
    /// Its part from sources (lx).
    pub direct_illuminance: f64,
    /// Luminance of the background (cd/m²).
    pub background_luminance: f64,
    /// Mean luminance (cd/m²).
    pub mean_luminance: f64,
    /// Daylight glare probability.
    pub dgp: f64,
    /// Simplified daylight glare probability, of the illuminance alone; not for direct sun.
    pub dgps: f64,
    /// Daylight glare index.
    pub dgi: f64,
    /// Daylight glare index with a background of (E_v/π)^0.85.
    pub dgi_mod: f64,
    /// Unified glare rating.
    pub ugr: f64,
    /// Experimental unified glare rating (Fisekis et al. 2003).
    pub ugr_exp: f64,
    /// Unified glare probability (Hirning et al. 2014).
    pub ugp: f64,
    /// Unified glare probability, second form (Hirning et al. 2017).
    pub ugp2: f64,
    /// CIE glare index.
    pub cgi: f64,
    /// Visual comfort probability (percent).
    pub vcp: f64,
    /// Discomfort glare rating, from which it follows.
    pub dgr: f64,
    /// Equivalent veiling luminance (cd/m²), Stiles and Holladay.
    pub veiling_luminance: f64,
}

/// Angle (degrees) below which the veiling luminance of a source does not rise further.
const VEIL: f64 = 0.1;

/// Places a source in the field of view.
pub(super) fn place(camera: &Camera, settings: &Settings, direction: [f64; 3]) -> (f64, f64) {
    let [x, y, z] = direction;
    let aside = x.hypot(y);
    // The upward direction as it was given: where it is not at a right angle to the line of sight, evalglare's turn is not
    // the angle of the two planes (seen from runs), and its indices are the ones that people compare with.
    let [_, up, _] = camera.frame();
    let upright = camera.view().up.unit().dot(up);
    let cosine = if aside > 0.0 { y / aside * upright } else { 1.0 };
    let sigma = aside.atan2(z);
    (sigma, position_index(settings.position_index, sigma, cosine))
}

/// Rates sources that are known, for example from a renderer.
///
/// # Errors
/// A number is negative or not finite, or the background asked for is not known.
pub fn rate(lights: &[Light], camera: &Camera, field: &Field, settings: &Settings) -> Result<(Vec<Source>, Indices)> {
    settings.check()?;
    let frame = camera.frame();
    let mut sources = Vec::with_capacity(lights.len());
    for (number, light) in lights.iter().enumerate() {
        let fail = |what: &str| Err(Error::Argument(format!("glare source {}: {what}", number + 1)));
        let length = light.direction.length();
        if !(length.is_finite() && length > 0.0) {
            return fail("its direction is 0 or not finite (give a direction)");
        }
        let positive = |v: f64| v.is_finite() && v > 0.0;
        if !positive(light.luminance) || !positive(light.solid_angle) {
            return fail("its luminance or solid angle is not a positive number (give cd/m² and steradians)");
        }
        let direction = light.direction * (1.0 / length);
        let local = frame.map(|axis| direction.dot(axis));
        if local[2] <= 0.0 {
            continue;
        }
        let (sigma, position_index) = place(camera, settings, local);
        sources.push(Source {
            direction,
            luminance: light.luminance,
            largest: light.luminance,
            solid_angle: light.solid_angle,
            illuminance: light.luminance * light.solid_angle * local[2],
            sigma,
            position_index,
            pixels: 0,
            peak: false,
        });
    }
    let indices = summarise(&sources, field, settings)?;
    Ok((sources, indices))
}

/// Indices of placed sources.
pub(super) fn summarise(sources: &[Source], field: &Field, settings: &Settings) -> Result<Indices> {
    let illuminance = field.vertical_illuminance;
    if !(illuminance.is_finite() && illuminance > 0.0) {
        return Err(Error::Argument(format!(
            "the illuminance at the eye is {illuminance} lx, so there is nothing to rate (give a scene with light)"
        )));
    }
    let sum = |f: &dyn Fn(&Source) -> f64| sources.iter().map(f).sum::<f64>();
    let direct = sum(&|s| s.illuminance);
    let without_sources = (illuminance - direct) / PI;
    let background = match settings.background {
        Background::WithoutSources => without_sources,
        Background::Mean => field.mean_background,
        Background::Illuminance => illuminance / PI,
    };
    if background.is_nan() {
        return Err(Error::Missing(
            "the mean luminance of the background is not known (give it, or take another background)".into(),
        ));
    }
    let square = sum(&|s| s.weight());
    let none = sources.is_empty();
    let rated = |value: f64, dark: f64| {
        if none {
            0.0
        } else if background > 0.0 {
            value
        } else {
            dark
        }
    };
    let dgi = |background: f64| {
        let of = |s: &Source| {
            let omega = s.solid_angle / (s.position_index * s.position_index);
            0.478 * s.luminance.powf(1.6) * omega.powf(0.8) / (background + 0.07 * s.solid_angle.sqrt() * s.luminance)
        };
        if none { 0.0 } else { 10.0 * sum(&of).log10() }
    };
    let at_eye = settings.vertical_illuminance.unwrap_or(illuminance);
    let dgr = if none {
        0.0
    } else {
        discomfort(sources, field.mean_luminance)
    };
    let linear = sum(&|s| s.luminance * s.solid_angle / (s.position_index * s.position_index));
    Ok(Indices {
        vertical_illuminance: illuminance,
        direct_illuminance: direct,
        background_luminance: background,
        mean_luminance: field.mean_luminance,
        dgp: dgp(at_eye, square, settings),
        dgps: 6.22e-5 * at_eye + 0.184,
        dgi: dgi(background.max(0.0)),
        dgi_mod: dgi((illuminance / PI).powf(0.85)),
        ugr: rated(8.0 * (0.25 / background * square).log10(), -99.0),
        ugr_exp: if none || without_sources <= 0.0 {
            0.0
        } else {
            8.0 * (illuminance / PI).log10() + 8.0 * (linear / without_sources).log10()
        },
        ugp: rated(0.26 * (0.25 / background * square).log10(), -99.0),
        ugp2: rated((1.0 + 2.0 / 7.0 * (square / background).powf(-0.2)).powi(-10), -99.0),
        cgi: if none {
            0.0
        } else {
            8.0 * (2.0 * (1.0 + direct / 500.0) / illuminance * square).log10()
        },
        vcp: comfort(dgr),
        dgr,
        veiling_luminance: sum(&|s| 10.0 * s.illuminance / s.sigma.to_degrees().max(VEIL).powi(2)),
    })
}

/// Daylight glare probability for an illuminance at the eye (lx) and Σ L² ω/P².
fn dgp(illuminance: f64, square: f64, settings: &Settings) -> f64 {
    let mut value = 5.87e-5 * illuminance + 0.092 * (1.0 + square / illuminance.powf(1.87)).log10() + 0.159;
    if settings.low_light && illuminance < 1000.0 {
        let x = (0.024 * illuminance - 4.0).exp();
        value *= x / (1.0 + x);
    }
    if let Some(age) = settings.age {
        value /= 1.1 - 0.5 * age / 100.0;
    }
    value.min(1.0)
}

/// Discomfort glare rating.
fn discomfort(sources: &[Source], mean: f64) -> f64 {
    let sum: f64 = sources
        .iter()
        .map(|s| {
            let size = 20.4 * s.solid_angle + 1.52 * s.solid_angle.powf(0.2) - 0.075;
            0.5 * s.luminance * size / (s.position_index * mean.powf(0.44))
        })
        .sum();
    sum.powf((sources.len() as f64).powf(-0.0914))
}

/// Visual comfort probability (percent) of a discomfort glare rating.
fn comfort(dgr: f64) -> f64 {
    if dgr < 20.0 {
        100.0
    } else if dgr > 750.0 {
        0.0
    } else {
        50.0 * erf((6.374 - 1.3227 * dgr.ln()) / SQRT_2) + 50.0
    }
}

/// The error function by its series, which ends soon for the arguments that occur here.
fn erf(x: f64) -> f64 {
    if x.abs() > 5.5 {
        return x.signum();
    }
    let (mut term, mut sum, mut n) = (x, x, 0.0);
    while term.abs() > 1e-17 * sum.abs() {
        n += 1.0;
        term *= 2.0 * x * x / (2.0 * n + 1.0);
        sum += term;
    }
    2.0 / PI.sqrt() * (-x * x).exp() * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::View;

    #[test]
    fn error_function() {
        for (x, expected) in [
            (0.0, 0.0),
            (0.5, 0.520_499_877_813_046_5),
            (-1.5, -0.966_105_146_475_310_8),
            (3.0, 0.999_977_909_503_001_4),
            (9.0, 1.0),
        ] {
            assert!((erf(x) - expected).abs() < 1e-14, "{x}");
        }
        assert!(comfort(f64::NAN).is_nan());
    }

    /// A scene of the reference, whose sources evalglare 3.06 printed: indices follow from them to its digits.
    #[test]
    fn indices_of_printed_sources() {
        let source = |luminance, solid_angle, position_index, illuminance| Source {
            direction: Vec3::default(),
            luminance,
            largest: luminance,
            solid_angle,
            illuminance,
            sigma: 0.3,
            position_index,
            pixels: 1,
            peak: false,
        };
        let sources = [
            source(20_003.25, 0.023_858_2, 2.138_016, 447.594),
            source(10_001.625, 0.015_337_6, 1.593_320, 575.773 - 447.594),
        ];
        let field = Field {
            vertical_illuminance: 2126.620,
            mean_luminance: 596.498,
            mean_background: f64::NAN,
        };
        let found = summarise(&sources, &field, &Settings::default()).unwrap();
        for (name, value, expected, tolerance) in [
            ("dgp", found.dgp, 0.322_197, 2e-6),
            ("L_b", found.background_luminance, 493.650, 2e-3),
            ("dgi", found.dgi, 20.4652, 2e-4),
            ("ugr", found.ugr, 25.0778, 2e-4),
            ("vcp", found.vcp, 9.5205, 2e-3),
            ("cgi", found.cgi, 29.8903, 2e-4),
            ("ugp", found.ugp, 0.815_027, 1e-5),
            ("ugp2", found.ugp2, 0.607_413, 1e-5),
            ("dgr", found.dgr, 333.236, 5e-3),
        ] {
            assert!((value - expected).abs() < tolerance, "{name}: {value} {expected}");
        }
    }

    #[test]
    fn corrections() {
        let settings = Settings {
            low_light: true,
            ..Settings::default()
        };
        let field = Field {
            vertical_illuminance: 254.361,
            mean_luminance: 71.158,
            mean_background: 59.958,
        };
        let source = Source {
            direction: Vec3::default(),
            luminance: 3000.0,
            largest: 3000.0,
            solid_angle: 0.023_858_2,
            illuminance: 67.339,
            sigma: 0.35,
            position_index: 2.138_016,
            pixels: 1,
            peak: false,
        };
        let found = summarise(&[source], &field, &settings).unwrap();
        assert!((found.dgp - 0.187_682).abs() < 2e-4, "{}", found.dgp);
        let plain = summarise(&[source], &field, &Settings::default()).unwrap();
        assert!((plain.dgp - 0.210_558).abs() < 2e-4, "{}", plain.dgp);
        let aged = Settings {
            age: Some(20.0),
            ..Settings::default()
        };
        assert_eq!(summarise(&[source], &field, &aged).unwrap().dgp, plain.dgp);
    }

    #[test]
    fn what_is_not_known_is_said() {
        let camera = Camera::new(View::fisheye(Vec3::default(), Vec3::new(0.0, 1.0, 0.0))).unwrap();
        let field = Field {
            vertical_illuminance: 2000.0,
            mean_luminance: f64::NAN,
            mean_background: f64::NAN,
        };
        let light = |y| Light {
            direction: Vec3::new(0.0, y, 0.5),
            luminance: 1e5,
            solid_angle: 1e-3,
        };
        let (sources, found) = rate(&[light(1.0), light(-1.0)], &camera, &field, &Settings::default()).unwrap();
        assert_eq!(sources.len(), 1);
        assert!(found.dgr.is_nan() && found.vcp.is_nan() && found.ugr.is_finite() && found.dgp > 0.3);
        let settings = Settings {
            background: Background::Mean,
            ..Settings::default()
        };
        assert!(rate(&[], &camera, &field, &settings).is_err());
        assert!(rate(&[light(f64::NAN)], &camera, &field, &Settings::default()).is_err());
    }
}
