//! A rough conductor: facets of the distribution GGX that reflect by Schlick's approximation (1994) of Fresnel's equations.
//! Reciprocal and energy-conserving; light that would meet a second facet is absorbed.

use super::microfacet::{LEAST_COS, SMOOTH, density, facet, seen_density, shadowing, shadowing_ratio};
use super::{Arrival, Departure, Draws, check, mirrored};
use crate::error::Result;
use crate::geometry::Vec3;

/// A rough conductor.
#[derive(Debug, Clone, PartialEq)]
pub struct Ggx {
    pub(super) reflectance: Vec<f64>,
    /// 0 for a smooth one.
    pub(super) roughness: f64,
}

impl Ggx {
    pub(super) fn new(reflectance: &[f64], roughness: f64) -> Result<Self> {
        let kind = "ggx";
        check::shares(kind, &[("reflectance", reflectance)])?;
        check::number(kind, "roughness", roughness, 0.0, 1.0)?;
        Ok(Self {
            reflectance: reflectance.to_vec(),
            roughness: if roughness <= SMOOTH { 0.0 } else { roughness },
        })
    }

    /// Number of bands.
    pub(super) fn bands(&self) -> usize {
        self.reflectance.len()
    }

    fn fresnel<const N: usize>(&self, cos: f64) -> [f64; N] {
        let rise = (1.0 - cos).clamp(0.0, 1.0).powi(5);
        std::array::from_fn(|b| self.reflectance[b] + (1.0 - self.reflectance[b]) * rise)
    }

    /// The mirror's reflectance; 0 for a rough surface.
    pub(super) fn beam<const N: usize>(&self, arrival: &Arrival<'_>) -> [f64; N] {
        if self.roughness > 0.0 {
            [0.0; N]
        } else {
            self.fresnel(arrival.cos())
        }
    }

    pub(super) fn evaluate<const N: usize>(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> [f64; N] {
        let (alpha, cos, cos_out) = (self.roughness, arrival.cos(), outgoing.dot(arrival.normal));
        if alpha == 0.0 || cos_out <= LEAST_COS || cos <= 0.0 {
            return [0.0; N];
        }
        let half = (outgoing - arrival.direction).unit();
        let lobe = density(alpha, half.dot(arrival.normal)) * shadowing(alpha, cos, cos_out) / (4.0 * cos * cos_out);
        self.fresnel(half.dot(outgoing)).map(|f: f64| f * lobe)
    }

    /// Density of departures (1/sr), which all bands share.
    pub(super) fn density(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> f64 {
        if self.roughness == 0.0 || outgoing.dot(arrival.normal) <= LEAST_COS {
            return 0.0;
        }
        let half = (outgoing - arrival.direction).unit();
        let seen = half.dot(outgoing);
        seen_density(self.roughness, arrival.cos(), half.dot(arrival.normal), seen) / (4.0 * seen)
    }

    pub(super) fn scatter<const N: usize>(
        &self,
        arrival: &Arrival<'_>,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        draws: &mut Draws,
    ) -> Option<Departure> {
        let rough = self.roughness > 0.0;
        let normal = if rough {
            let u = [draws.next(), draws.next()];
            facet(self.roughness, -arrival.direction, arrival.normal, u)
        } else {
            arrival.normal
        };
        let direction = mirrored(arrival.direction, normal);
        let cos_out = direction.dot(arrival.normal);
        let shown = if !rough {
            1.0
        } else if cos_out <= LEAST_COS {
            0.0
        } else {
            shadowing_ratio(self.roughness, arrival.cos(), cos_out)
        };
        let fresnel = self.fresnel::<N>(-arrival.direction.dot(normal));
        for b in 0..N {
            let kept = weight[b] * fresnel[b] * shown;
            absorbed[b] = weight[b] - kept;
            weight[b] = kept;
        }
        (shown > 0.0).then_some(Departure {
            direction,
            passes: false,
            specular: !rough,
        })
    }
}
