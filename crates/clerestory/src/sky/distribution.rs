//! Relative luminance over the sky: a gradation from zenith to horizon times an indicatrix about the sun.

use std::f64::consts::TAU;

use super::integrate::horizontal;
use crate::geometry::Vec3;

/// Published skies rise without limit at the horizon or are singular there; all programs hold cos ζ at this value.
const LOWEST_COSINE: f64 = 0.01;

/// Gradation times indicatrix: (1 + a exp(b / cos ζ)) (base + c exp(d γ) + e cos² γ), the form that CIE's, Perez's and
/// Preetham's skies share.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobed {
    /// Gradation: weight.
    pub a: f64,
    /// Gradation: rate, negative.
    pub b: f64,
    /// Indicatrix: constant.
    pub base: f64,
    /// Indicatrix: weight of the circumsolar region.
    pub c: f64,
    /// Indicatrix: rate (1/rad), negative.
    pub d: f64,
    /// Indicatrix: weight of light that is scattered back.
    pub e: f64,
}

impl Lobed {
    /// From a, b, c, d, e with a constant of 1.
    pub const fn new([a, b, c, d, e]: [f64; 5]) -> Self {
        Self {
            a,
            b,
            base: 1.0,
            c,
            d,
            e,
        }
    }

    /// a, b, c, d, e.
    pub const fn coefficients(&self) -> [f64; 5] {
        [self.a, self.b, self.c, self.d, self.e]
    }

    /// The value at cos ζ and the angle γ to the sun (radians).
    pub fn value(&self, cos_zenith: f64, gamma: f64) -> f64 {
        self.gradation(cos_zenith) * self.indicatrix(gamma, gamma.cos())
    }

    fn gradation(&self, cos_zenith: f64) -> f64 {
        1.0 + self.a * (self.b / cos_zenith.max(LOWEST_COSINE)).exp()
    }

    fn indicatrix(&self, gamma: f64, cos_gamma: f64) -> f64 {
        self.base + self.c * (self.d * gamma).exp() + self.e * cos_gamma * cos_gamma
    }

    /// Sum of the values, none of them negative, in unit directions with the sun `toward`; fast where neighbours have one
    /// altitude.
    pub fn sum(&self, directions: &[Vec3], toward: Vec3, indicatrix: impl Fn(f64) -> f64) -> f64 {
        let (mut height, mut gradation) = (f64::NAN, 0.0);
        let mut sum = 0.0;
        for direction in directions {
            if direction.z != height {
                height = direction.z;
                gradation = self.gradation(height);
            }
            let cos_gamma = direction.dot(toward).clamp(-1.0, 1.0);
            sum += (gradation * indicatrix(cos_gamma)).max(0.0);
        }
        sum
    }

    /// The indicatrix by cos γ.
    pub fn about(&self, cos_gamma: f64) -> f64 {
        self.indicatrix(cos_gamma.acos(), cos_gamma)
    }
}

/// The indicatrix of a sky that is looked up very often, to about 1e-5 of its value.
#[derive(Debug, Clone)]
pub struct Indicatrix {
    lobed: Lobed,
    /// Its values at even steps of sin(γ/2), over which it is smooth at the sun.
    values: Vec<f64>,
}

impl Indicatrix {
    /// Look-ups from which the table pays.
    pub const WORTH: usize = 8 * Self::STEPS;
    const STEPS: usize = 1024;
    /// Beyond it, sin(γ/2) tells directions apart too coarsely.
    const FAR: f64 = -0.9;

    /// Of a sky.
    pub fn new(lobed: Lobed) -> Self {
        let value = |k: usize| {
            let half = (k as f64 / Self::STEPS as f64).min(1.0).asin();
            lobed.indicatrix(2.0 * half, (2.0 * half).cos())
        };
        Self {
            lobed,
            values: (0..Self::STEPS + 2).map(value).collect(),
        }
    }

    /// By cos γ.
    pub fn at(&self, cos_gamma: f64) -> f64 {
        if cos_gamma < Self::FAR {
            return self.lobed.about(cos_gamma);
        }
        let place = (0.5 * (1.0 - cos_gamma)).sqrt() * Self::STEPS as f64;
        let k = place as usize;
        let (low, high) = (self.values[k], self.values[k + 1]);
        low + (high - low) * (place - k as f64)
    }
}

/// Relative luminance of a sky.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Distribution {
    /// A gradation times an indicatrix.
    Lobed(Lobed),
    /// (1 + 2 cos ζ)/3, CIE's traditional overcast sky (Moon and Spencer 1942).
    Overcast,
    /// The intermediate sky (Matsuura 1987), for a zenith angle of the sun (radians).
    Intermediate {
        /// Angle from zenith to sun (radians).
        sun_zenith: f64,
    },
}

impl Distribution {
    /// The same luminance everywhere.
    pub const UNIFORM: Self = Self::Lobed(Lobed::new([0.0, -1.0, 0.0, -1.0, 0.0]));

    /// Relative luminance at cos ζ and the angle γ to the sun (radians); never negative.
    pub fn value(&self, cos_zenith: f64, gamma: f64) -> f64 {
        match self {
            Self::Lobed(lobed) => lobed.value(cos_zenith, gamma),
            Self::Overcast => (1.0 + 2.0 * cos_zenith) / 3.0,
            Self::Intermediate { sun_zenith } => {
                let eta = cos_zenith.clamp(-1.0, 1.0).acos();
                ((1.35 * (5.631 - 3.59 * eta).sin() + 3.12) * (4.396 - 2.6 * sun_zenith).sin() + 6.37 - eta) / 2.326
                    * (-0.563 * gamma * ((2.629 - eta) * (1.562 - sun_zenith) + 0.812)).exp()
            }
        }
        .max(0.0)
    }

    /// ∫ L cos ζ dω over the sky (sr).
    pub fn horizontal(&self, sun_zenith: f64) -> f64 {
        horizontal(sun_zenith, |cos, gamma| self.value(cos, gamma))
    }

    /// The same by Radiance's point-sky program: the centres of Tregenza's 145 patches, turned so that the sun is in the
    /// meridian of their first, with equal solid angles.
    pub fn horizontal_by_tregenza(&self, sun_zenith: f64) -> f64 {
        const COUNTS: [u32; 8] = [30, 30, 24, 24, 18, 12, 6, 1];
        let mut sum = 0.0;
        for (row, &count) in COUNTS.iter().enumerate() {
            let (sin, cos) = (6.0 + 12.0 * row as f64).to_radians().sin_cos();
            for column in 0..count {
                let azimuth = TAU * f64::from(column) / f64::from(count);
                let cos_gamma = sin * sun_zenith.cos() + cos * sun_zenith.sin() * azimuth.cos();
                sum += self.value(sin, cos_gamma.clamp(-1.0, 1.0).acos()) * sin;
            }
        }
        sum * TAU / 145.0
    }
}
