//! CIE's standard skies: the fifteen general ones, and the traditional ones of Radiance's `gensky`.

use super::distribution::{Distribution, Lobed};
use crate::error::{Error, Result};

/// Gradation (a, b) of each group, I to VI (CIE S 011/E:2003, ISO 15469:2004, table 1).
const GRADATIONS: [(f64, f64); 6] = [
    (4.0, -0.70),
    (1.1, -0.80),
    (0.0, -1.0),
    (-1.0, -0.55),
    (-1.0, -0.32),
    (-1.0, -0.15),
];
/// Indicatrix (c, d, e) of each group, 1 to 6.
const INDICATRICES: [(f64, f64, f64); 6] = [
    (0.0, -1.0, 0.0),
    (2.0, -1.5, 0.15),
    (5.0, -2.5, 0.30),
    (10.0, -3.0, 0.45),
    (16.0, -3.0, 0.30),
    (24.0, -2.8, 0.15),
];
/// Groups of the types 1 to 15, from 0.
const TYPES: [(usize, usize); 15] = [
    (0, 0),
    (0, 1),
    (1, 0),
    (1, 1),
    (2, 0),
    (2, 1),
    (2, 2),
    (2, 3),
    (3, 1),
    (3, 2),
    (3, 3),
    (4, 3),
    (4, 4),
    (5, 4),
    (5, 5),
];
/// What the standard calls the types 1 to 15.
pub const NAMES: [&str; 15] = [
    "CIE standard overcast, steep gradation towards zenith, azimuthal uniformity",
    "overcast, steep gradation, slight brightening towards the sun",
    "overcast, moderately graded, azimuthal uniformity",
    "overcast, moderately graded, slight brightening towards the sun",
    "uniform luminance",
    "partly cloudy, no gradation towards zenith, slight brightening towards the sun",
    "partly cloudy, no gradation towards zenith, brighter circumsolar region",
    "partly cloudy, no gradation towards zenith, distinct solar corona",
    "partly cloudy, obscured sun",
    "partly cloudy, brighter circumsolar region",
    "white-blue, distinct solar corona",
    "CIE standard clear, low luminance turbidity",
    "CIE standard clear, polluted atmosphere",
    "cloudless turbid, broad solar corona",
    "white-blue turbid, broad solar corona",
];

/// Relative luminance of a general sky, type 1 to 15.
pub fn general(kind: u32) -> Result<Distribution> {
    let Some(&(gradation, indicatrix)) = (kind as usize).checked_sub(1).and_then(|k| TYPES.get(k)) else {
        return Err(Error::Argument(format!(
            "CIE sky {kind} is not one of the general skies (give a type from 1, overcast, to 15)"
        )));
    };
    let (a, b) = GRADATIONS[gradation];
    let (c, d, e) = INDICATRICES[indicatrix];
    Ok(Distribution::Lobed(Lobed {
        a,
        b,
        base: 1.0 - c * (d * std::f64::consts::FRAC_PI_2).exp(),
        c,
        d,
        e,
    }))
}

/// The traditional skies, by the formulas of Radiance's `gensky`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Traditional {
    /// CIE clear sky.
    Clear,
    /// CIE overcast sky.
    Overcast,
    /// Intermediate sky (Matsuura 1987).
    Intermediate,
    /// The same luminance everywhere.
    Uniform,
}

impl Traditional {
    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Clear => "clear",
            Self::Overcast => "overcast",
            Self::Intermediate => "intermediate",
            Self::Uniform => "uniform",
        }
    }

    /// By name.
    pub fn named(name: &str) -> Result<Self> {
        match name {
            "clear" => Ok(Self::Clear),
            "overcast" => Ok(Self::Overcast),
            "intermediate" => Ok(Self::Intermediate),
            "uniform" => Ok(Self::Uniform),
            _ => Err(Error::Argument(format!(
                "a sky {name:?} is not known (known: clear, overcast, intermediate, uniform)"
            ))),
        }
    }

    /// Whether the sun is seen through it.
    pub const fn is_sunny(self) -> bool {
        matches!(self, Self::Clear | Self::Intermediate)
    }

    /// Relative luminance; at the zenith it is [`Self::at_zenith`].
    pub fn distribution(self, sun_zenith: f64) -> Distribution {
        match self {
            Self::Clear => Distribution::Lobed(Lobed {
                a: -1.0,
                b: -0.32,
                base: 0.91,
                c: 10.0,
                d: -3.0,
                e: 0.45,
            }),
            Self::Overcast => Distribution::Overcast,
            Self::Intermediate => Distribution::Intermediate { sun_zenith },
            Self::Uniform => Distribution::UNIFORM,
        }
    }

    /// Normalising factor of the distribution for the position of the sun, with the constants that `gensky` rounds.
    pub fn at_zenith(self, sun_zenith: f64) -> f64 {
        match self {
            Self::Clear => 0.274 * (0.91 + 10.0 * (-3.0 * sun_zenith).exp() + 0.45 * sun_zenith.cos().powi(2)),
            Self::Intermediate => {
                let altitude = std::f64::consts::FRAC_PI_2 - sun_zenith;
                (2.739 + 0.9891 * (0.3119 + 2.6 * altitude).sin()) * (-sun_zenith * (0.4441 + 1.48 * altitude)).exp()
            }
            Self::Overcast | Self::Uniform => 1.0,
        }
    }

    /// Luminance of the zenith (cd/m²) by the sun's altitude (radians) and the turbidity after Linke, which is read by
    /// clear and intermediate skies only.
    pub fn zenith_luminance(self, altitude: f64, turbidity: f64) -> f64 {
        let clear = ((1.376 * turbidity - 1.81) * altitude.tan() + 0.38).max(0.0);
        let overcast = (8.6 * altitude.sin() + 0.123).max(0.0);
        1000.0
            * match self {
                Self::Clear => clear,
                Self::Overcast | Self::Uniform => overcast,
                Self::Intermediate => f64::midpoint(clear, overcast),
            }
    }

    /// Horizontal irradiance over π and the zenith's radiance, by the polynomials of `gensky`.
    pub fn ambient_share(self, sun_zenith: f64) -> f64 {
        let polynomial = match self {
            Self::Uniform => return 1.0,
            Self::Overcast => return 7.0 / 9.0,
            Self::Clear => [2.766_521, 0.547_665, -0.369_832, 0.009_237, 0.059_229],
            Self::Intermediate => [3.5556, -2.7152, -1.3081, 1.0660, 0.60227],
        };
        let quarter = std::f64::consts::FRAC_PI_4;
        let x = (std::f64::consts::FRAC_PI_2 - sun_zenith - quarter) / quarter;
        let value = polynomial.iter().rev().fold(0.0, |sum, c| sum * x + c);
        value / (self.at_zenith(sun_zenith) * std::f64::consts::PI)
    }

    /// Radiance of the sun's disc that `gensky` writes.
    pub fn sun_radiance(self, altitude: f64) -> f64 {
        let clear = 1.5e9 / 208.0 * (1.147 - 0.147 / altitude.sin().max(0.16));
        match self {
            Self::Clear => clear,
            Self::Intermediate => 0.15 * clear,
            Self::Overcast | Self::Uniform => 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published definition: L/L_z = f(χ) φ(ζ) / (f(z_s) φ(0)), written out.
    #[test]
    fn general_skies_are_gradation_times_indicatrix() {
        let Distribution::Lobed(lobed) = general(12).unwrap() else {
            panic!("a general sky is lobed")
        };
        assert_eq!(lobed.coefficients(), [-1.0, -0.32, 10.0, -3.0, 0.45]);
        let phi = |zenith: f64| 1.0 - (-0.32 / zenith.cos()).exp();
        let f = |chi: f64| {
            1.0 + 10.0 * ((-3.0 * chi).exp() - (-3.0 * std::f64::consts::FRAC_PI_2).exp()) + 0.45 * chi.cos().powi(2)
        };
        for (zenith, gamma) in [(0.0_f64, 0.7_f64), (0.5, 1.2), (1.4, 0.1), (1.56, 3.0)] {
            let expected = f(gamma) * phi(zenith);
            assert!((lobed.value(zenith.cos(), gamma) / expected - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn types_1_and_5_do_not_know_the_sun() {
        for kind in [1, 3, 5] {
            let sky = general(kind).unwrap();
            assert!((sky.value(0.4, 0.1) - sky.value(0.4, 2.1)).abs() < 1e-15);
        }
        let sky = general(5).unwrap();
        assert!((sky.value(0.01, 0.1) - sky.value(1.0, 1.0)).abs() < 1e-15);
        // The steep overcast sky: horizon to zenith about 1 to 3.
        let sky = general(1).unwrap();
        let ratio = sky.value(1.0, 1.0) / sky.value(0.0, 1.0);
        assert!((ratio - (1.0 + 4.0 * (-0.7_f64).exp())).abs() < 1e-12);
    }

    #[test]
    fn there_is_no_sixteenth_type() {
        assert!(general(0).is_err());
        assert!(general(16).is_err());
    }

    /// F2 and the zenith's radiance of formats.md 12.6.
    #[test]
    fn zeniths_are_genskys() {
        let zenith = |degrees: f64| (90.0 - degrees).to_radians();
        let altitude = 0.585_788_f64.asin();
        let clear = Traditional::Clear;
        assert!((clear.at_zenith(std::f64::consts::FRAC_PI_2 - altitude) - 0.4526).abs() < 5e-5);
        assert!((clear.zenith_luminance(altitude, 2.45) / 203.0 - 7.431).abs() < 5e-4);
        let altitude = 0.564_539_f64.asin();
        let intermediate = Traditional::Intermediate;
        assert!((intermediate.at_zenith(std::f64::consts::FRAC_PI_2 - altitude) - 1.011).abs() < 5e-4);
        assert!((intermediate.zenith_luminance(altitude, 2.45) / 203.0 - 15.83).abs() < 5e-3);
        assert!((intermediate.sun_radiance(altitude) - 9.591e5).abs() < 50.0);
        assert!((Traditional::Overcast.ambient_share(zenith(30.0)) - 7.0 / 9.0).abs() < 1e-15);
    }
}
