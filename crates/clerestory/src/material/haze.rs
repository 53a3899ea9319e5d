//! Light that passes through a rough `trans` of Radiance: a lobe about the way straight on.
//!
//! BSDF: exp(-2(1 - cosδ)/α²) / (πα² √(cosθ_i cosθ_o)) with the angle δ to the way straight on and the roughness α. Reciprocal.
//! Its integral would grow beyond 1 very near to grazing incidence; there it is held at 1, and reciprocity is lost.

use std::f64::consts::{PI, TAU};

use super::Arrival;
use crate::geometry::Vec3;

/// The lobe and its integrals.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Haze {
    /// 2/α².
    sharpness: f64,
    /// What the lobe is multiplied with so that it never sums to more than 1, at equal steps of the incident cosine.
    held: Vec<f64>,
}

/// Steps of the incident cosine.
const STEPS: usize = 512;
/// Points along the lobe and about its axis.
const ALONG: u32 = 48;
const ABOUT: u32 = 48;

impl Haze {
    pub(super) fn new(roughness: f64) -> Self {
        let sharpness = 2.0 / (roughness * roughness);
        let mut haze = Self {
            sharpness,
            held: vec![1.0],
        };
        haze.held = (0..=STEPS)
            .map(|k| {
                // At the very edge the integral has no bound; the first step stands for it.
                let cos = k.max(1) as f64 / STEPS as f64;
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let mut sum = 0.0;
                for i in 0..ALONG {
                    let along = haze.cos_along((f64::from(i) + 0.5) / f64::from(ALONG));
                    let across = (1.0 - along * along).max(0.0).sqrt();
                    for j in 0..ABOUT {
                        let phi = (f64::from(j) + 0.5) * PI / f64::from(ABOUT);
                        sum += (cos * along + sin * across * phi.cos()).max(0.0).sqrt();
                    }
                }
                let integral = sum / f64::from(ALONG * ABOUT) * haze.whole() / cos.sqrt();
                (1.0 / integral).min(1.0)
            })
            .collect();
        haze
    }

    /// Integral of exp(-2(1 - cosδ)/α²)/(πα²) over the sphere.
    fn whole(&self) -> f64 {
        1.0 - (-2.0 * self.sharpness).exp()
    }

    /// cosδ, drawn in proportion to the exponential over the sphere (Fisher 1953).
    fn cos_along(&self, u: f64) -> f64 {
        1.0 + (1.0 - u * self.whole()).ln() / self.sharpness
    }

    fn held(&self, cos: f64) -> f64 {
        let x = cos.clamp(0.0, 1.0) * STEPS as f64;
        let k = (x as usize).min(STEPS - 1);
        let t = x - k as f64;
        // The integral of the lobe falls with the root of the cosine within the first step.
        let edge = if k == 0 { (x.max(1e-12)).sqrt() } else { 1.0 };
        edge * (self.held[k] * (1.0 - t) + self.held[k + 1] * t)
    }

    /// BSDF (1/sr) by the cosines of the incident angle, of the angle to the way straight on, and of the outgoing angle.
    pub(super) fn evaluate(&self, cos: f64, along: f64, cos_out: f64) -> f64 {
        let lobe = self.sharpness / TAU * (self.sharpness * (along - 1.0)).exp();
        self.held(cos) * lobe / (cos * cos_out).max(1e-18).sqrt()
    }

    /// Density of [`Haze::sample`] (1/sr) by the cosine of the angle to the way straight on.
    pub(super) fn density(&self, along: f64) -> f64 {
        self.sharpness / (TAU * self.whole()) * (self.sharpness * (along - 1.0)).exp()
    }

    /// A direction and BSDF times cosine over density; none where it does not pass.
    pub(super) fn sample(&self, arrival: &Arrival<'_>, cos: f64, u: [f64; 2]) -> Option<(Vec3, f64)> {
        let along = self.cos_along(u[0]);
        let across = (1.0 - along * along).max(0.0).sqrt();
        let (sin_phi, cos_phi) = (TAU * u[1] - PI).sin_cos();
        let [s, t] = arrival.direction.frame();
        let direction = (arrival.direction * along + s * (across * cos_phi) + t * (across * sin_phi)).unit();
        let cos_out = -direction.dot(arrival.normal);
        (cos_out > 0.0).then(|| {
            let factor = self.held(cos) * self.whole() * (cos_out / cos.max(1e-18)).sqrt();
            (direction, factor)
        })
    }
}
