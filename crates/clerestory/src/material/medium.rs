//! What fills the space between surfaces: clear, absorbing, or a homogeneous scattering volume.

use std::f64::consts::TAU;

use super::choice::index;
use super::{Draws, check};
use crate::error::Result;
use crate::geometry::Vec3;

/// Beyond this, scattering is a beam.
const MOST_ASYMMETRY: f64 = 0.9999;

/// What fills the space between surfaces. One value a band each.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Refractive index.
    pub index: Vec<f64>,
    /// Absorption coefficient (1/m).
    pub absorption: Vec<f64>,
    /// Scattering coefficient (1/m).
    pub scattering: Vec<f64>,
    /// Mean cosine of the angle of a scattering event: g of the phase function of Henyey and Greenstein (1941).
    pub asymmetry: Vec<f64>,
}

impl Medium {
    /// Air: index 1, clear.
    pub fn air(bands: usize) -> Self {
        Self {
            index: vec![1.0; bands],
            absorption: vec![0.0; bands],
            scattering: vec![0.0; bands],
            asymmetry: vec![0.0; bands],
        }
    }

    /// Transparent, of a refractive index and an absorption coefficient (1/m).
    pub fn clear(index: &[f64], absorption: &[f64]) -> Result<Self> {
        let none = vec![0.0; index.len()];
        Self::scattering(index, absorption, &none, &none)
    }

    /// A homogeneous scattering volume: refractive index, absorption and scattering coefficients (1/m), and asymmetry.
    pub fn scattering(index: &[f64], absorption: &[f64], scattering: &[f64], asymmetry: &[f64]) -> Result<Self> {
        let kind = "medium";
        let parameters = [
            ("index", index),
            ("absorption", absorption),
            ("scattering", scattering),
            ("asymmetry", asymmetry),
        ];
        check::bands(kind, &parameters)?;
        check::within(kind, parameters[0], 1.0, 10.0)?;
        check::within(kind, parameters[1], 0.0, f64::INFINITY)?;
        check::within(kind, parameters[2], 0.0, f64::INFINITY)?;
        check::within(kind, parameters[3], -MOST_ASYMMETRY, MOST_ASYMMETRY)?;
        Ok(Self {
            index: index.to_vec(),
            absorption: absorption.to_vec(),
            scattering: scattering.to_vec(),
            asymmetry: asymmetry.to_vec(),
        })
    }

    /// The body of Radiance's `dielectric`: transmittance of one unit of the scene's length, one a band, the length of that
    /// unit (m), and the refractive index. Its Hartmann constant has no part in it: where the index depends on the
    /// wavelength, give it by band to [`Medium::clear`].
    pub fn radiance_dielectric(transmittance: &[f64], unit: f64, index: f64) -> Result<Self> {
        let kind = "dielectric";
        check::bands(kind, &[("transmittance", transmittance)])?;
        check::within(kind, ("transmittance", transmittance), 0.0, 1.0)?;
        check::number(kind, "index", index, 1.0, 10.0)?;
        check::positive(kind, "unit", unit)?;
        // Radiance takes the logarithm of nothing as -100, too.
        let absorption: Vec<f64> = transmittance.iter().map(|t| (-t.ln()).min(100.0) / unit).collect();
        Self::clear(&vec![index; transmittance.len()], &absorption)
    }

    /// Number of bands.
    pub fn bands(&self) -> usize {
        self.index.len()
    }

    /// Whether light goes through it unchanged.
    #[inline]
    pub fn is_clear(&self) -> bool {
        self.absorption
            .iter()
            .zip(&self.scattering)
            .all(|(a, s)| *a == 0.0 && *s == 0.0)
    }

    /// Takes light over a distance (m), or to where it is scattered before that: then the way up to there is returned.
    /// `weight` is multiplied so that its mean is what goes on, `absorbed` is set to what stays.
    ///
    /// Where light is scattered is drawn by one band, chosen by what the bands carry, and weighed by the density of all of
    /// them together: no weight grows beyond the sum of all. Absorption is taken along the way.
    pub fn fly<const N: usize>(
        &self,
        distance: f64,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        draws: &mut Draws,
    ) -> Option<f64> {
        let scattering = &self.scattering[..N];
        let mut flown = distance;
        let mut scattered = None;
        if scattering.iter().any(|s| *s > 0.0) {
            let sum: f64 = weight.iter().sum();
            if let Some(band) = index(weight, sum, draws) {
                let free = -(1.0 - draws.next()).ln() / scattering[band];
                let event = free < distance;
                flown = if event { free } else { distance };
                let values: [f64; N] = std::array::from_fn(|b| {
                    let s = scattering[b];
                    (-s * flown).exp() * if event { s } else { 1.0 }
                });
                let density: f64 = weight.iter().zip(&values).map(|(w, v)| w / sum * v).sum();
                for (w, v) in weight.iter_mut().zip(&values) {
                    *w *= v / density;
                }
                scattered = event.then_some(free);
            }
        }
        for b in 0..N {
            absorbed[b] = 0.0;
            if self.absorption[b] > 0.0 {
                let kept = weight[b] * (-self.absorption[b] * flown).exp();
                absorbed[b] = weight[b] - kept;
                weight[b] = kept;
            }
        }
        scattered
    }

    /// A direction after a scattering event; weights as in [`Medium::fly`].
    pub fn scatter<const N: usize>(&self, direction: Vec3, weight: &mut [f64; N], draws: &mut Draws) -> Vec3 {
        let g = &self.asymmetry[..N];
        let sum: f64 = weight.iter().sum();
        let band = index(weight, sum, draws).unwrap_or(0);
        let cos = sample(g[band], draws.next());
        if g.iter().any(|other| *other != g[band]) {
            let values: [f64; N] = std::array::from_fn(|b| henyey_greenstein(g[b], cos));
            let density: f64 = weight.iter().zip(&values).map(|(w, v)| w / sum * v).sum();
            for (w, v) in weight.iter_mut().zip(&values) {
                *w *= if density.is_finite() && density > 0.0 {
                    v / density
                } else {
                    1.0
                };
            }
        }
        let (sin_phi, cos_phi) = (TAU * draws.next()).sin_cos();
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let [u, v] = direction.frame();
        (u * (sin * cos_phi) + v * (sin * sin_phi) + direction * cos).unit()
    }
}

/// Phase function of Henyey and Greenstein (1/sr).
pub fn henyey_greenstein(g: f64, cos: f64) -> f64 {
    let base = 1.0 + g * g - 2.0 * g * cos;
    (1.0 - g * g) / (2.0 * TAU * base * base.sqrt())
}

/// Cosine of the angle, drawn in proportion to the phase function.
fn sample(g: f64, u: f64) -> f64 {
    if g.abs() < 1e-4 {
        // To first order in g; the exact inverse loses its digits here.
        let x = 2.0 * u - 1.0;
        return x + 1.5 * g * (1.0 - x * x);
    }
    let s = (1.0 - g * g) / (1.0 - g + 2.0 * g * u);
    ((1.0 + g * g - s * s) / (2.0 * g)).clamp(-1.0, 1.0)
}
