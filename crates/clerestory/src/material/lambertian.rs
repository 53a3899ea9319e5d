//! Even scattering to both sides.

use std::f64::consts::PI;

use super::{Arrival, Departure, Draws};
use crate::geometry::Vec3;
use crate::sequence::circle;

/// Reflected or transmitted, drawn by what the bands carry.
pub(super) fn scatter<const N: usize>(
    reflectance: &[f64],
    transmittance: &[f64],
    arrival: &Arrival<'_>,
    weight: &mut [f64; N],
    absorbed: &mut [f64; N],
    draws: &mut Draws,
) -> Option<Departure> {
    let (reflectance, transmittance) = (&reflectance[..N], &transmittance[..N]);
    let (mut back, mut on) = (0.0, 0.0);
    for b in 0..N {
        absorbed[b] = weight[b] * (1.0 - reflectance[b] - transmittance[b]);
        back += weight[b] * reflectance[b];
        on += weight[b] * transmittance[b];
    }
    let sum = back + on;
    if sum <= 0.0 {
        return None;
    }
    let u = [draws.next(), draws.next()];
    let passes = on > 0.0 && draws.next() * sum >= back;
    let (share, values) = if passes {
        (on / sum, transmittance)
    } else {
        (back / sum, reflectance)
    };
    for b in 0..N {
        weight[b] *= values[b] / share;
    }
    Some(diffuse(arrival, passes, u))
}

/// A departure to one side, its direction's density in proportion to the cosine.
#[inline]
pub(super) fn diffuse(arrival: &Arrival<'_>, passes: bool, u: [f64; 2]) -> Departure {
    let normal = if passes { -arrival.normal } else { arrival.normal };
    Departure {
        direction: cosine(normal, u),
        passes,
        specular: false,
    }
}

/// Density of directions of even scattering to both sides (1/sr), by the probabilities that light returns and that it passes.
pub(super) fn density([back, on]: [f64; 2], arrival: &Arrival<'_>, outgoing: Vec3) -> f64 {
    let cos = outgoing.dot(arrival.normal);
    if cos > 0.0 { back * cos / PI } else { on * -cos / PI }
}

/// BSDF of even scattering (1/sr).
pub(super) fn evaluate<const N: usize>(
    reflectance: &[f64],
    transmittance: &[f64],
    arrival: &Arrival<'_>,
    outgoing: Vec3,
) -> [f64; N] {
    let values = if outgoing.dot(arrival.normal) > 0.0 {
        reflectance
    } else {
        transmittance
    };
    std::array::from_fn(|b| values[b] / PI)
}

/// A direction about a normal of length 1, its density in proportion to the cosine.
pub fn cosine(normal: Vec3, u: [f64; 2]) -> Vec3 {
    let [t, b] = normal.frame();
    let r = u[0].sqrt();
    let [cos, sin] = circle(u[1]);
    // At least a little above the surface, so that light never runs in it.
    let z = (1.0 - u[0]).max(1e-12).sqrt();
    t * (r * cos) + b * (r * sin) + normal * z
}
