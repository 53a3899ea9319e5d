//! A BSDF of a data set as a surface.

use super::{Arrival, Beam, Departure, Draws};
use crate::bsdf::{Bsdf, Component, Lobes, Part, Scatterer};
use crate::direction::{Direction, Scatter, Side};
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// One side of a data set, with the way that it is mounted.
///
/// The sample's frame lies on the surface with its normal out of the face (interior) or into it (exterior), and its y axis as
/// near as can be to a given direction, up. Where that runs along the normal the azimuth is not determined, and any is
/// taken. What a data set has too little of is absorbed; peaks of its models stay beams.
#[derive(Debug, Clone)]
pub struct Measured {
    pub(super) lobes: Lobes,
    pub(super) components: [Vec<Component>; 2],
    pub(super) side: Side,
    pub(super) up: Vec3,
}

/// Measured data may sum to a little more than 1.
const MOST: f64 = 1.02;

impl Measured {
    pub(super) fn new(bsdf: &Bsdf, bands: &[Option<&str>], side: Side, up: Vec3) -> Result<Self> {
        if bands.is_empty() {
            return Err(Error::Argument(
                "measured: no bands are named (give at least one)".into(),
            ));
        }
        let length = up.length();
        if !(length.is_finite() && length > 0.0) {
            return Err(Error::Argument(format!(
                "measured: up is ({}, {}, {}) (give a finite vector that is not zero)",
                up.x, up.y, up.z
            )));
        }
        let of = |scatter| -> Result<Vec<Component>> {
            bands
                .iter()
                .map(|band| bsdf.component(*band, side, scatter).map(|o| o.component))
                .collect()
        };
        let components = [of(Scatter::Transmission)?, of(Scatter::Reflection)?];
        for (b, (transmission, reflection)) in components[0].iter().zip(&components[1]).enumerate() {
            for k in 0..16_u32 {
                let theta_deg = f64::from(k % 4 * 25);
                let incident =
                    Direction::from_angles(side, theta_deg.to_radians(), f64::from(k / 4) * 1.7).incident_disk();
                let sum = transmission.total(incident, Part::All).value + reflection.total(incident, Part::All).value;
                if sum.is_nan() || sum > MOST {
                    return Err(Error::Argument(format!(
                        "measured: transmission + reflection of band {} ({}) sum to {sum:.4} at {theta_deg}° from the {} \
                         (normalise the data set first)",
                        b + 1,
                        bsdf.band(bands[b])?.name,
                        side.name(),
                    )));
                }
            }
        }
        Ok(Self {
            lobes: Lobes::new(bsdf, bands, side, None)?,
            components,
            side,
            up: up * (1.0 / length),
        })
    }

    /// Number of bands.
    pub(super) fn bands(&self) -> usize {
        self.lobes.bands()
    }

    /// The sample's axes.
    fn frame(&self, normal: Vec3) -> [Vec3; 3] {
        let z = normal * self.side.sign();
        let y = self.up - z * self.up.dot(z);
        if y.length() < 1e-9 {
            let [x, y] = z.frame();
            return [x, y, z];
        }
        let y = y.unit();
        [y.cross(z), y, z]
    }

    pub(super) fn scatter<const N: usize>(
        &self,
        arrival: &Arrival<'_>,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        draws: &mut Draws,
    ) -> Option<Departure> {
        let frame = self.frame(arrival.normal);
        let u = [draws.next(), draws.next()];
        let mut factors = [0.0; N];
        let sample = self.lobes.sample(local(&frame, -arrival.direction), u, &mut factors);
        for b in 0..N {
            let kept = weight[b] * factors[b];
            absorbed[b] = weight[b] - kept;
            weight[b] = kept;
        }
        let sample = sample?;
        Some(Departure {
            direction: world(&frame, sample.outgoing),
            passes: sample.outgoing.side() != self.side,
            specular: sample.peak,
        })
    }

    pub(super) fn evaluate<const N: usize>(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> [f64; N] {
        let frame = self.frame(arrival.normal);
        let mut values = [0.0; N];
        let (incident, outgoing) = (local(&frame, -arrival.direction), local(&frame, outgoing));
        self.lobes.evaluate(incident, outgoing, &mut values);
        values
    }

    /// Density of departures that are not peaks (1/sr), which all bands share.
    pub(super) fn density(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> f64 {
        let frame = self.frame(arrival.normal);
        self.lobes
            .pdf(local(&frame, -arrival.direction), local(&frame, outgoing))
    }

    pub(super) fn beams<const N: usize>(&self, arrival: &Arrival<'_>) -> Vec<Beam<N>> {
        let frame = self.frame(arrival.normal);
        let incident = local(&frame, -arrival.direction).incident_disk();
        let mut beams: Vec<Beam<N>> = Vec::new();
        for scatter in Scatter::BOTH {
            let side = scatter.outgoing_side(self.side);
            let passes = scatter == Scatter::Transmission;
            for (b, model) in self.components[scatter as usize].iter().enumerate() {
                for peak in model.peaks(incident) {
                    let direction = world(&frame, peak.outgoing.outgoing(side));
                    let same = |beam: &Beam<N>| beam.passes == passes && (beam.direction - direction).length() < 1e-9;
                    let k = beams.iter().position(same).unwrap_or(beams.len());
                    if k == beams.len() {
                        beams.push(Beam {
                            direction,
                            passes,
                            value: [0.0; N],
                        });
                    }
                    beams[k].value[b] += peak.value;
                }
            }
        }
        beams
    }
}

fn local([x, y, z]: &[Vec3; 3], v: Vec3) -> Direction {
    Direction {
        x: v.dot(*x),
        y: v.dot(*y),
        z: v.dot(*z),
    }
}

/// At least a little off the surface, so that light never runs in it.
fn world([x, y, z]: &[Vec3; 3], d: Direction) -> Vec3 {
    let height = d.z.abs().max(1e-6).copysign(d.z);
    (*x * d.x + *y * d.y + *z * height).unit()
}
