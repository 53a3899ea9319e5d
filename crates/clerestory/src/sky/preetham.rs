//! Preetham's clear sky with its colours ("Utah" sky): Preetham, Shirley, Smits 1999, "A practical analytic model for
//! daylight", SIGGRAPH.

use super::distribution::{Distribution, Lobed};
use crate::error::{Error, Result};
use crate::picture::colour;

/// Rows [T, 1] of A to E for luminance Y and chromaticities x and y.
const LOBES: [[[f64; 2]; 5]; 3] = [
    [
        [0.1787, -1.4630],
        [-0.3554, 0.4275],
        [-0.0227, 5.3251],
        [0.1206, -2.5771],
        [-0.0670, 0.3703],
    ],
    [
        [-0.0193, -0.2592],
        [-0.0665, 0.0008],
        [-0.0004, 0.2125],
        [-0.0641, -0.8989],
        [-0.0033, 0.0452],
    ],
    [
        [-0.0167, -0.2608],
        [-0.0950, 0.0092],
        [-0.0079, 0.2102],
        [-0.0441, -1.6537],
        [-0.0109, 0.0529],
    ],
];
/// Rows [T², T, 1] of the columns [θ³, θ², θ, 1] for the zenith's x and y.
const ZENITH: [[[f64; 4]; 3]; 2] = [
    [
        [0.001_66, -0.003_75, 0.002_09, 0.0],
        [-0.029_03, 0.063_77, -0.032_02, 0.003_94],
        [0.116_93, -0.211_96, 0.060_52, 0.258_86],
    ],
    [
        [0.002_75, -0.006_10, 0.003_17, 0.0],
        [-0.042_14, 0.089_70, -0.041_53, 0.005_16],
        [0.153_46, -0.267_56, 0.066_70, 0.266_88],
    ],
];
/// Luminance and chromaticity over the sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Preetham {
    lobes: [Lobed; 3],
    /// Y (cd/m²), x and y of the zenith over the lobes' values there.
    scales: [f64; 3],
    /// RGB of XYZ.
    rgb: [[f64; 3]; 3],
}

impl Preetham {
    /// For an angle from zenith to sun (radians) and a turbidity of 2 (very clear) to 10 (haze).
    pub fn new(sun_zenith: f64, turbidity: f64) -> Result<Self> {
        if !(2.0..=10.0).contains(&turbidity) {
            return Err(Error::Argument(format!(
                "Preetham's sky has no turbidity {turbidity} (give 2, very clear, to 10, haze)"
            )));
        }
        if !(0.0..std::f64::consts::FRAC_PI_2).contains(&sun_zenith) {
            return Err(Error::Argument(
                "Preetham's sky has the sun above the horizon (choose another time, or another sky)".into(),
            ));
        }
        let lobes = LOBES.map(|rows| Lobed::new(rows.map(|[t, one]| t * turbidity + one)));
        let chi = (4.0 / 9.0 - turbidity / 120.0) * (std::f64::consts::PI - 2.0 * sun_zenith);
        let luminance = 1000.0 * ((4.0453 * turbidity - 4.9710) * chi.tan() - 0.2155 * turbidity + 2.4192);
        if luminance <= 0.0 {
            return Err(Error::Argument(format!(
                "Preetham's sky has no light at the zenith for turbidity {turbidity} and a sun {:.1}° above the horizon \
                 (take a lower turbidity or a higher sun)",
                90.0 - sun_zenith.to_degrees()
            )));
        }
        let [x, y] = ZENITH.map(|rows| {
            let angle = rows.map(|[a, b, c, d]| ((a * sun_zenith + b) * sun_zenith + c) * sun_zenith + d);
            (angle[0] * turbidity + angle[1]) * turbidity + angle[2]
        });
        let mut scales = [luminance, x, y];
        for (scale, lobe) in scales.iter_mut().zip(&lobes) {
            *scale /= lobe.value(1.0, sun_zenith);
        }
        Ok(Self {
            lobes,
            scales,
            rgb: colour::from_xyz(&colour::PRIMARIES)?,
        })
    }

    /// Relative Y, x and y over the sky.
    pub fn lobes(&self) -> [Lobed; 3] {
        self.lobes
    }

    /// Factors of Y (cd/m²), x and y.
    pub fn scales(&self) -> [f64; 3] {
        self.scales
    }

    /// Radiance's R, G and B of X, Y and Z.
    pub fn rgb_of_xyz(&self) -> [[f64; 3]; 3] {
        self.rgb
    }

    /// Luminance (cd/m²).
    pub fn luminance(&self, cos_zenith: f64, gamma: f64) -> f64 {
        (self.scales[0] * self.lobes[0].value(cos_zenith, gamma)).max(0.0)
    }

    /// Relative luminance, and its factor (cd/m²).
    pub fn grey(&self) -> (Distribution, f64) {
        (Distribution::Lobed(self.lobes[0]), self.scales[0])
    }

    /// Luminance (cd/m²) as Radiance's R, G and B; what is outside of its gamut is clipped.
    pub fn rgb(&self, cos_zenith: f64, gamma: f64) -> [f64; 3] {
        let luminance = self.luminance(cos_zenith, gamma);
        let [x, y] = [1, 2].map(|k| self.scales[k] * self.lobes[k].value(cos_zenith, gamma));
        let xyz = [x / y * luminance, luminance, (1.0 - x - y) / y * luminance];
        self.rgb
            .map(|row| (row[0] * xyz[0] + row[1] * xyz[1] + row[2] * xyz[2]).max(0.0))
    }
}

/// Direct normal illuminance (lx) of the sun through an atmosphere of a turbidity, for an extraterrestrial illuminance of
/// 133,334 lx at the mean distance (Darula, Kittler, Gueymard 2005, Solar Energy 79, 559–565) and Clear's and Navvab's
/// extinction.
pub fn direct_illuminance(turbidity: f64, air_mass: f64, eccentricity: f64) -> f64 {
    133_334.0 * eccentricity * (-air_mass * turbidity / (9.9 + 0.043 * air_mass)).exp()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_zenith_is_the_published_one_and_blue() {
        let (z, t) = (0.9, 3.0);
        let sky = Preetham::new(z, t).unwrap();
        let chi = (4.0 / 9.0 - t / 120.0) * (std::f64::consts::PI - 2.0 * z);
        let expected = 1000.0 * ((4.0453 * t - 4.9710) * chi.tan() - 0.2155 * t + 2.4192);
        assert!((sky.luminance(1.0, z) / expected - 1.0).abs() < 1e-12);
        let [r, g, b] = sky.rgb(1.0, z);
        assert!(b > g && g > r, "{r} {g} {b}");
        let luminance = colour::LUMINANCE[0] * r + colour::LUMINANCE[1] * g + colour::LUMINANCE[2] * b;
        assert!((luminance / expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_it_does_not_know_is_refused() {
        assert!(Preetham::new(0.9, 1.0).is_err());
        assert!(Preetham::new(0.9, f64::NAN).is_err());
        assert!(Preetham::new(1.6, 3.0).is_err());
    }
}
