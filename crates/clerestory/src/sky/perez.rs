//! Perez's all-weather sky: clearness and brightness, coefficients, luminous efficacy.
//!
//! Perez, Seals, Michalsky 1993 (Solar Energy 50, 235–245): sky. Perez, Ineichen, Seals, Michalsky, Stewart 1990 (Solar
//! Energy 44, 271–289): efficacy. Erbs, Klein, Duffie 1982 (Solar Energy 28, 293–302): diffuse fraction.

use std::f64::consts::{FRAC_PI_2, TAU};

use super::Preset;
use super::distribution::Lobed;
use crate::error::{Error, Result};

/// Solar constant (W/m²) of the sky's model.
const SOLAR_CONSTANT: f64 = 1367.0;
/// Extraterrestrial illuminance (lx) from which the search for irradiances starts.
const SOLAR_ILLUMINANCE: f64 = 127_500.0;
/// Lower limits of ε of the eight bins.
const BINS: [f64; 8] = [1.0, 1.065, 1.23, 1.5, 1.95, 2.8, 4.5, 6.2];

/// Steepest gradation b of a sky that gets lighter toward the horizon, that of CIE's types 14 and 15.
const STEEPEST: f64 = -0.15;

/// Least gradation of the zenith of a sky of ours.
const DARKEST: f64 = 0.02;

/// a, b, c, d, e of each bin: x1 + x2 z + Δ (x3 + x4 z).
const COEFFICIENTS: [[[f64; 4]; 5]; 8] = [
    [
        [1.3525, -0.2576, -0.2690, -1.4366],
        [-0.7670, 0.0007, 1.2734, -0.1233],
        [2.8000, 0.6004, 1.2375, 1.0000],
        [1.8734, 0.6297, 0.9738, 0.2809],
        [0.0356, -0.1246, -0.5718, 0.9938],
    ],
    [
        [-1.2219, -0.7730, 1.4148, 1.1016],
        [-0.2054, 0.0367, -3.9128, 0.9156],
        [6.9750, 0.1774, 6.4477, -0.1239],
        [-1.5798, -0.5081, -1.7812, 0.1080],
        [0.2624, 0.0672, -0.2190, -0.4285],
    ],
    [
        [-1.1000, -0.2515, 0.8952, 0.0156],
        [0.2782, -0.1812, -4.5000, 1.1766],
        [24.7219, -13.0812, -37.7000, 34.8438],
        [-5.0000, 1.5218, 3.9229, -2.6204],
        [-0.0156, 0.1597, 0.4199, -0.5562],
    ],
    [
        [-0.5484, -0.6654, -0.2672, 0.7117],
        [0.7234, -0.6219, -5.6812, 2.6297],
        [33.3389, -18.3000, -62.2500, 52.0781],
        [-3.5000, 0.0016, 1.1477, 0.1062],
        [0.4659, -0.3296, -0.0876, -0.0329],
    ],
    [
        [-0.6000, -0.3566, -2.5000, 2.3250],
        [0.2937, 0.0496, -5.6812, 1.8415],
        [21.0000, -4.7656, -21.5906, 7.2492],
        [-3.5000, -0.1554, 1.4062, 0.3988],
        [0.0032, 0.0766, -0.0656, -0.1294],
    ],
    [
        [-1.0156, -0.3670, 1.0078, 1.4051],
        [0.2875, -0.5328, -3.8500, 3.3750],
        [14.0000, -0.9999, -7.1406, 7.5469],
        [-3.4000, -0.1078, -1.0750, 1.5702],
        [-0.0672, 0.4016, 0.3017, -0.4844],
    ],
    [
        [-1.0000, 0.0211, 0.5025, -0.5119],
        [-0.3000, 0.1922, 0.7023, -1.6317],
        [19.0000, -5.0000, 1.2438, -1.9094],
        [-4.0000, 0.0250, 0.3844, 0.2656],
        [1.0468, -0.3788, -2.4517, 1.4656],
    ],
    [
        [-1.0500, 0.0289, 0.4260, 0.3590],
        [-0.3250, 0.1156, 0.7781, 0.0025],
        [31.0625, -14.5000, -46.1148, 55.3750],
        [-7.2312, 0.4050, 13.3500, 0.6234],
        [1.5000, -0.6426, 1.8564, 0.5636],
    ],
];
/// Diffuse luminous efficacy (lm/W): a + b W + c cos z + d ln Δ.
const DIFFUSE_EFFICACY: [[f64; 4]; 8] = [
    [97.24, -0.46, 12.00, -8.91],
    [107.22, 1.15, 0.59, -3.95],
    [104.97, 2.96, -5.53, -8.77],
    [102.39, 5.59, -13.95, -13.90],
    [100.71, 5.94, -22.75, -23.74],
    [106.42, 3.83, -36.15, -28.83],
    [141.88, 1.90, -53.24, -14.03],
    [152.23, 0.35, -45.27, -7.98],
];
/// Direct luminous efficacy (lm/W): a + b W + c exp(5.73 z - 5) + d Δ.
const DIRECT_EFFICACY: [[f64; 4]; 8] = [
    [57.20, -4.55, -2.98, 117.12],
    [98.99, -3.46, -1.21, 12.38],
    [109.83, -4.90, -1.71, -8.81],
    [110.34, -5.84, -1.99, -4.56],
    [106.36, -3.97, -1.75, -6.16],
    [107.19, -1.25, -1.51, -26.73],
    [105.75, 0.77, -1.26, -34.44],
    [101.18, 1.58, -1.10, -8.29],
];

/// What sun and sky give, in one of two kinds of units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Supply {
    /// Irradiances (W/m²).
    Irradiance {
        /// On a plane that faces the sun.
        direct_normal: f64,
        /// Of the sky on a horizontal plane.
        diffuse_horizontal: f64,
    },
    /// Illuminances (lx).
    Illuminance {
        /// On a plane that faces the sun.
        direct_normal: f64,
        /// Of the sky on a horizontal plane.
        diffuse_horizontal: f64,
    },
    /// Global horizontal irradiance (W/m²), divided by Erbs' correlation.
    Global(f64),
}

/// What the sky's model needs beside the supply.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Angle from zenith to sun (radians).
    pub sun_zenith: f64,
    /// Day of the year, for the distance of the sun.
    pub day: u32,
    /// Dew point (°C), for water vapour in the efficacy.
    pub dew_point: f64,
    /// Whose limits.
    pub preset: Preset,
}

/// Irradiances and illuminances of a moment, and what Perez calls them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Daylight {
    /// Direct normal irradiance (W/m²).
    pub direct_irradiance: f64,
    /// Diffuse horizontal irradiance (W/m²).
    pub diffuse_irradiance: f64,
    /// Direct normal illuminance (lx).
    pub direct_illuminance: f64,
    /// Diffuse horizontal illuminance (lx).
    pub diffuse_illuminance: f64,
    /// Clearness ε, 1 (overcast) to about 12.
    pub clearness: f64,
    /// Brightness Δ.
    pub brightness: f64,
}

impl Conditions {
    /// Zenith angle in the formulas: the sun is not below the horizon, and where the matrix program's practice is asked for
    /// not above 87°.
    fn zenith(&self) -> f64 {
        let least = match self.preset {
            Preset::RadianceMatrix => 3.0_f64.to_radians(),
            Preset::Clerestory | Preset::Radiance => 0.0,
        };
        self.sun_zenith.clamp(least, FRAC_PI_2)
    }

    /// Correction of the solar constant for the distance of the sun (Spencer 1971).
    pub fn eccentricity(&self) -> f64 {
        let a = TAU * (f64::from(self.day) - 1.0) / 365.0;
        1.000_11 + 0.034_221 * a.cos() + 0.001_28 * a.sin() + 0.000_719 * (2.0 * a).cos() + 0.000_077 * (2.0 * a).sin()
    }

    /// Relative optical air mass (Kasten 1966).
    pub fn air_mass(&self) -> f64 {
        let z = self.zenith();
        1.0 / (z.cos() + 0.15 * (93.885 - z.to_degrees()).powf(-1.253))
    }

    fn clearness(&self, direct: f64, diffuse: f64) -> f64 {
        let z3 = 1.041 * self.zenith().powi(3);
        let most = match self.preset {
            Preset::RadianceMatrix => 11.9,
            Preset::Radiance | Preset::Clerestory => 12.009,
        };
        (((diffuse + direct) / diffuse + z3) / (1.0 + z3)).clamp(1.0, most)
    }

    fn brightness(&self, diffuse: f64) -> f64 {
        (diffuse * self.air_mass() / (SOLAR_CONSTANT * self.eccentricity())).clamp(0.01, 0.6)
    }

    /// Direct and diffuse luminous efficacy (lm/W).
    pub fn efficacies(&self, clearness: f64, brightness: f64) -> (f64, f64) {
        let water = (0.07 * self.dew_point - 0.075).exp();
        let z = self.zenith();
        let bin = bin(clearness);
        let [a, b, c, d] = DIFFUSE_EFFICACY[bin];
        let diffuse = a + b * water + c * z.cos() + d * brightness.ln();
        let [a, b, c, d] = DIRECT_EFFICACY[bin];
        let direct = a + b * water + c * (5.73 * z - 5.0).exp() + d * brightness;
        (direct.max(0.0), diffuse)
    }

    /// Irradiances, illuminances, clearness and brightness of a supply.
    pub fn daylight(&self, supply: Supply) -> Result<Daylight> {
        let check = |name: &str, value: f64, unit: &str| {
            if value.is_finite() && value >= 0.0 {
                Ok(())
            } else {
                Err(Error::Argument(format!(
                    "{name} of {value} {unit} is not possible (give a number of at least 0)"
                )))
            }
        };
        match supply {
            Supply::Irradiance {
                direct_normal,
                diffuse_horizontal,
            } => {
                check("a direct normal irradiance", direct_normal, "W/m²")?;
                check("a diffuse horizontal irradiance", diffuse_horizontal, "W/m²")?;
                self.of_irradiances(direct_normal, diffuse_horizontal)
            }
            Supply::Illuminance {
                direct_normal,
                diffuse_horizontal,
            } => {
                check("a direct normal illuminance", direct_normal, "lx")?;
                check("a diffuse horizontal illuminance", diffuse_horizontal, "lx")?;
                self.of_illuminances(direct_normal, diffuse_horizontal)
            }
            Supply::Global(global) => {
                check("a global horizontal irradiance", global, "W/m²")?;
                let (direct, diffuse) = self.divided(global)?;
                self.of_irradiances(direct, diffuse)
            }
        }
    }

    fn of_irradiances(&self, direct: f64, diffuse: f64) -> Result<Daylight> {
        if diffuse <= 0.0 {
            return Err(Error::Argument(
                "the sky gives no diffuse light (give a diffuse horizontal irradiance above 0; a sun alone has no sky)"
                    .into(),
            ));
        }
        let clearness = self.clearness(direct, diffuse);
        let brightness = self.brightness(diffuse);
        let (to_direct, to_diffuse) = self.efficacies(clearness, brightness);
        Ok(Daylight {
            direct_irradiance: direct,
            diffuse_irradiance: diffuse,
            direct_illuminance: direct * to_direct,
            diffuse_illuminance: diffuse * to_diffuse,
            clearness,
            brightness,
        })
    }

    /// Irradiances whose efficacies give the illuminances, by iteration.
    fn of_illuminances(&self, direct: f64, diffuse: f64) -> Result<Daylight> {
        let steps = match self.preset {
            Preset::Radiance => 9,
            Preset::RadianceMatrix => 5,
            Preset::Clerestory => 60,
        };
        let guess = SOLAR_CONSTANT / SOLAR_ILLUMINANCE;
        let mut made = self.of_irradiances(direct * guess, diffuse * guess)?;
        for _ in 0..steps {
            let (to_direct, to_diffuse) = self.efficacies(made.clearness, made.brightness);
            if to_direct <= 0.0 && direct > 0.0 {
                return Err(Error::Argument(format!(
                    "a direct normal illuminance of {direct} lx is not possible for a sun so low (give irradiances)"
                )));
            }
            let direct_irradiance = if direct > 0.0 { direct / to_direct } else { 0.0 };
            made = self.of_irradiances(direct_irradiance, diffuse / to_diffuse)?;
        }
        // Efficacies jump from bin to bin, so that the last step may not have arrived; what was given is kept.
        Ok(Daylight {
            direct_illuminance: direct,
            diffuse_illuminance: diffuse,
            ..made
        })
    }

    /// Direct normal and diffuse horizontal irradiance of a global one, by Erbs' correlation.
    fn divided(&self, global: f64) -> Result<(f64, f64)> {
        let sin = self.sun_zenith.cos();
        if sin <= 0.0 {
            return Err(Error::Argument(
                "a global irradiance is divided by the sun's altitude, and the sun is below the horizon (give direct and \
                 diffuse irradiance)"
                    .into(),
            ));
        }
        let kt = global / (SOLAR_CONSTANT * self.eccentricity() * sin);
        if kt > 1.0 {
            return Err(Error::Argument(format!(
                "a global horizontal irradiance of {global} W/m² is more than there is outside of the atmosphere ({:.0} \
                 W/m² for this sun)",
                global / kt
            )));
        }
        let share = if kt <= 0.22 {
            1.0 - 0.09 * kt
        } else if kt <= 0.8 {
            0.9511 - 0.1604 * kt + 4.388 * kt.powi(2) - 16.638 * kt.powi(3) + 12.336 * kt.powi(4)
        } else {
            0.165
        };
        Ok((global * (1.0 - share) / sin, global * share))
    }

    /// The sky's relative luminance for a clearness and brightness.
    pub fn distribution(&self, clearness: f64, brightness: f64) -> Result<Lobed> {
        let z = self.zenith();
        let delta = if clearness > 1.065 && clearness < 2.8 {
            brightness.max(0.2)
        } else {
            brightness
        };
        let bin = bin(clearness);
        let values = coefficients(bin, z, delta);
        let rises = values[1] > 0.0;
        let is_dark = self.preset == Preset::Clerestory && 1.0 + values[0] * values[1].exp() < DARKEST;
        if !rises && !is_dark {
            return Ok(Lobed::new(values));
        }
        // The sky would rise without limit toward the horizon, or be negative: outside of what was fitted.
        match self.preset {
            Preset::Clerestory => {
                let [b1, b2, b3, b4] = COEFFICIENTS[bin][1];
                let nearest = (STEEPEST - b1 - b2 * z) / (b3 + b4 * z);
                Ok(Lobed::new(coefficients(bin, z, nearest.clamp(0.0, 0.6))))
            }
            Preset::Radiance => Err(Error::Unsupported(format!(
                "Perez's sky has no sound gradation for ε = {clearness:.4} and Δ = {brightness:.4}: Radiance's gendaylit \
                 gives a black sky (take the preset clerestory)"
            ))),
            Preset::RadianceMatrix => Ok(Lobed::new(values)),
        }
    }
}

/// a, b, c, d, e of a bin for an angle from zenith to sun (radians) and a brightness.
fn coefficients(bin: usize, z: f64, delta: f64) -> [f64; 5] {
    let mut values = COEFFICIENTS[bin].map(|[x1, x2, x3, x4]| x1 + x2 * z + delta * (x3 + x4 * z));
    if bin == 0 {
        let [c1, c2, c3, c4] = COEFFICIENTS[0][2];
        let [d1, d2, d3, d4] = COEFFICIENTS[0][3];
        values[2] = (delta * (c1 + c2 * z)).powf(c3).exp() - c4;
        values[3] = -(delta * (d1 + d2 * z)).exp() + d3 + delta * d4;
    }
    values
}

/// The bin of a clearness, 0 to 7.
fn bin(clearness: f64) -> usize {
    BINS.partition_point(|&lower| clearness >= lower).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn conditions(altitude_sin: f64, day: u32) -> Conditions {
        Conditions {
            sun_zenith: altitude_sin.acos(),
            day,
            dew_point: 10.973_53,
            preset: Preset::Radiance,
        }
    }

    fn irradiance(direct_normal: f64, diffuse_horizontal: f64) -> Supply {
        Supply::Irradiance {
            direct_normal,
            diffuse_horizontal,
        }
    }

    /// ε, Δ and a to e of formats.md 12.7, all printed digits; the suns of 12.6.
    #[test]
    fn parameters_are_gendaylits() {
        for (sun, day, supply, expected) in [
            (0.585_788, 80, irradiance(700.0, 120.0), [4.1056, 0.1483]),
            (0.873_881, 172, irradiance(850.0, 110.0), [7.8010, 0.0951]),
            (0.564_539, 266, irradiance(300.0, 200.0), [1.7681, 0.2603]),
        ] {
            let found = conditions(sun, day).daylight(supply).unwrap();
            assert!((found.clearness - expected[0]).abs() < 6e-5, "{found:?}");
            assert!((found.brightness - expected[1]).abs() < 6e-5, "{found:?}");
        }
        let c = conditions(0.585_788, 80);
        let light = c.daylight(irradiance(700.0, 120.0)).unwrap();
        let lobed = c.distribution(light.clearness, light.brightness).unwrap();
        let expected = [-1.016_024, -0.313_968, 13.053_786, -3.441_245, 0.289_150];
        for (a, b) in lobed.coefficients().iter().zip(expected) {
            assert!((a - b).abs() < 2e-5 * b.abs().max(1.0), "{a} {b}");
        }
    }

    #[test]
    fn illuminances_give_back_what_irradiances_made() {
        for preset in [Preset::Clerestory, Preset::Radiance] {
            let c = Conditions {
                preset,
                ..conditions(0.5, 100)
            };
            let light = c.daylight(irradiance(600.0, 90.0)).unwrap();
            let back = c
                .daylight(Supply::Illuminance {
                    direct_normal: light.direct_illuminance,
                    diffuse_horizontal: light.diffuse_illuminance,
                })
                .unwrap();
            assert!((back.diffuse_irradiance / 90.0 - 1.0).abs() < 1e-3, "{back:?}");
            assert!((back.direct_irradiance / 600.0 - 1.0).abs() < 1e-3, "{back:?}");
        }
    }

    /// `gendaylit -ang 30 20 -E 500`: 383.129 direct horizontal, 116.871 diffuse (day 0).
    #[test]
    fn global_irradiance_is_divided_as_erbs_does() {
        let light = conditions(0.5, 0).daylight(Supply::Global(500.0)).unwrap();
        assert!((light.direct_irradiance * 0.5 - 383.129).abs() < 2e-3, "{light:?}");
        assert!((light.diffuse_irradiance - 116.871).abs() < 2e-3);
        assert!(conditions(0.5, 0).daylight(Supply::Global(900.0)).is_err());
    }

    /// The whole range of ε, Δ and sun: gradations fall or rise to a limit, and there is light.
    #[test]
    fn every_sky_of_ours_is_sound() {
        for clearness in [1.0, 1.03, 1.1, 1.4, 1.7, 2.3, 3.0, 4.4, 5.5, 7.0, 12.0] {
            for brightness in [0.01, 0.05, 0.1, 0.2, 0.35, 0.5, 0.6] {
                for degrees in 0..=90 {
                    let c = Conditions {
                        preset: Preset::Clerestory,
                        ..conditions(f64::from(degrees).to_radians().cos(), 100)
                    };
                    let lobed = c.distribution(clearness, brightness).unwrap();
                    let place = format!("ε {clearness}, Δ {brightness}, zenith angle {degrees}°: {lobed:?}");
                    assert!(lobed.b <= 0.0, "{place}");
                    let sky = crate::sky::Distribution::Lobed(lobed);
                    let share = sky.horizontal_by_tregenza(c.sun_zenith);
                    assert!(share.is_finite() && share > 0.05, "{share}, {place}");
                    // Brightest within a factor of 300 of the mean, also at the horizon.
                    assert!(sky.value(0.0, 0.0) < 300.0 * share, "{place}");
                }
            }
        }
    }

    #[test]
    fn what_is_impossible_is_refused() {
        let c = conditions(0.5, 100);
        assert!(c.daylight(irradiance(-1.0, 100.0)).is_err());
        assert!(c.daylight(irradiance(100.0, f64::NAN)).is_err());
        assert!(c.daylight(irradiance(100.0, 0.0)).is_err());
    }
}
