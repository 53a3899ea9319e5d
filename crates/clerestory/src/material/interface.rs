//! The smooth border of two media.

use super::choice::index;
use super::{Arrival, Beam, Departure, Draws, Polarisation, mirrored};
use crate::geometry::Vec3;

/// Mean of both polarisations' reflectance at a border, from index `here` to `beyond`, and the cosine beyond; total
/// reflection gives (1, 0).
pub fn fresnel(here: f64, beyond: f64, cos: f64) -> (f64, f64) {
    let ratio = here / beyond;
    let sin2 = ratio * ratio * (1.0 - cos * cos);
    if sin2 >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_beyond = (1.0 - sin2).sqrt();
    let s = (here * cos - beyond * cos_beyond) / (here * cos + beyond * cos_beyond);
    let p = (beyond * cos - here * cos_beyond) / (beyond * cos + here * cos_beyond);
    (0.5 * (s * s + p * p), cos_beyond)
}

/// Direction of travel beyond a border.
pub(super) fn refracted(direction: Vec3, normal: Vec3, ratio: f64, cos: f64, cos_beyond: f64) -> Vec3 {
    (direction * ratio + normal * (ratio * cos - cos_beyond)).unit()
}

/// What a border does with both polarisations of one band.
#[derive(Clone, Copy)]
struct Border {
    /// Reflectance across and along the plane of incidence.
    s: f64,
    p: f64,
    /// Product of the reflected amplitudes: its sign tells whether they are in phase.
    both: f64,
    cos_beyond: f64,
}

impl Border {
    fn new(here: f64, beyond: f64, cos: f64) -> Self {
        let ratio = here / beyond;
        let sin2 = 1.0 - cos * cos;
        let sin2_beyond = ratio * ratio * sin2;
        if sin2_beyond >= 1.0 {
            // Both are reflected, one behind the other (Born and Wolf, Principles of Optics, 1.5.4).
            let tan = cos * (sin2 - 1.0 / (ratio * ratio)).sqrt() / sin2;
            return Self {
                s: 1.0,
                p: 1.0,
                both: (1.0 - tan * tan) / (1.0 + tan * tan),
                cos_beyond: 0.0,
            };
        }
        let cos_beyond = (1.0 - sin2_beyond).sqrt();
        let s = (here * cos - beyond * cos_beyond) / (here * cos + beyond * cos_beyond);
        let p = (beyond * cos - here * cos_beyond) / (beyond * cos + here * cos_beyond);
        Self {
            s: s * s,
            p: p * p,
            both: s * p,
            cos_beyond,
        }
    }

    /// Reflectance for light of a degree of polarisation.
    fn reflectance(self, q: f64) -> f64 {
        0.5 * (self.s + self.p) + 0.5 * (self.s - self.p) * q
    }
}

/// Reflected or refracted, drawn by the mean of the bands. Where the index differs between bands, refracted light is of one
/// band alone, drawn at random.
pub fn scatter<const N: usize>(
    arrival: &Arrival<'_>,
    weight: &mut [f64; N],
    polarisation: &mut Polarisation<N>,
    draws: &mut Draws,
) -> Option<Departure> {
    let cos = arrival.cos();
    let ratio = |b: usize| arrival.here.index[b] / arrival.beyond.index[b];
    let mut borders = [Border::new(arrival.here.index[0], arrival.beyond.index[0], cos); N];
    for (b, border) in borders.iter_mut().enumerate().skip(1) {
        if ratio(b) != ratio(0) {
            *border = Border::new(arrival.here.index[b], arrival.beyond.index[b], cos);
        }
    }
    polarisation.turn_to(arrival.direction, arrival.normal);
    let reflectance: [f64; N] = std::array::from_fn(|b| borders[b].reflectance(polarisation.q(b)));
    let (mut sum, mut back) = (0.0, 0.0);
    for b in 0..N {
        sum += weight[b];
        back += weight[b] * reflectance[b];
    }
    if sum <= 0.0 {
        return None;
    }
    let u = draws.next();
    let share = back / sum;
    if u < share {
        for (b, border) in borders.iter().enumerate() {
            weight[b] *= reflectance[b] / share;
            polarisation.pass(b, border.s, border.p, border.both);
        }
        return Some(Departure {
            direction: mirrored(arrival.direction, arrival.normal),
            passes: false,
            specular: true,
        });
    }
    for (b, border) in borders.iter().enumerate() {
        weight[b] *= (1.0 - reflectance[b]) / (1.0 - share);
        let (s, p) = (1.0 - border.s, 1.0 - border.p);
        polarisation.pass(b, s, p, (s * p).sqrt());
    }
    let first = (0..N).find(|&b| weight[b] > 0.0)?;
    let mut band = first;
    if (first + 1..N).any(|b| weight[b] > 0.0 && ratio(b) != ratio(first)) {
        // Each band bends its own way.
        let total: f64 = weight.iter().sum();
        band = index(weight, total, draws)?;
        *weight = [0.0; N];
        weight[band] = total;
    }
    Some(Departure {
        direction: refracted(
            arrival.direction,
            arrival.normal,
            ratio(band),
            cos,
            borders[band].cos_beyond,
        ),
        passes: true,
        specular: true,
    })
}

/// The reflected beam, and a refracted one for each index.
pub(super) fn beams<const N: usize>(arrival: &Arrival<'_>) -> Vec<Beam<N>> {
    let cos = arrival.cos();
    let mut beams = vec![Beam {
        direction: mirrored(arrival.direction, arrival.normal),
        passes: false,
        value: [0.0; N],
    }];
    for b in 0..N {
        let (here, beyond) = (arrival.here.index[b], arrival.beyond.index[b]);
        let (reflectance, cos_beyond) = fresnel(here, beyond, cos);
        beams[0].value[b] = reflectance;
        if reflectance < 1.0 {
            let direction = refracted(arrival.direction, arrival.normal, here / beyond, cos, cos_beyond);
            let k = beams[1..].iter().position(|beam| beam.direction == direction);
            let k = k.map_or(beams.len(), |k| k + 1);
            if k == beams.len() {
                beams.push(Beam {
                    direction,
                    passes: true,
                    value: [0.0; N],
                });
            }
            beams[k].value[b] = 1.0 - reflectance;
        }
    }
    beams
}
