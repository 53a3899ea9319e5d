//! A sum of materials, each with its share.

use super::choice::index;
use super::{Arrival, Beam, Departure, Draws, Material, Polarisation, check};
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// Materials and their shares, which sum to 1 at most; the rest is black.
#[derive(Debug, Clone)]
pub struct Mixture {
    pub(super) shares: Vec<f64>,
    pub(super) sum: f64,
    pub(super) parts: Vec<Material>,
}

impl Mixture {
    pub(super) fn new(parts: Vec<(f64, Material)>) -> Result<Self> {
        let (shares, parts): (Vec<f64>, Vec<Material>) = parts.into_iter().unzip();
        for (k, share) in shares.iter().enumerate() {
            check::number("mixture", &format!("share {}", k + 1), *share, 0.0, 1.0)?;
        }
        let sum: f64 = shares.iter().sum();
        check::number("mixture", "sum of shares", sum, 0.0, 1.0 + 1e-9)?;
        let mut bands = parts.iter().filter_map(Material::bands);
        if let Some(first) = bands.next()
            && let Some(other) = bands.find(|n| *n != first)
        {
            return Err(Error::Argument(format!(
                "mixture: its materials have {first} and {other} bands (give all of them the same)"
            )));
        }
        Ok(Self { shares, sum, parts })
    }

    /// Number of bands.
    pub(super) fn bands(&self) -> Option<usize> {
        self.parts.iter().find_map(Material::bands)
    }

    pub(super) fn scatter<const N: usize>(
        &self,
        arrival: &Arrival<'_>,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        draws: &mut Draws,
    ) -> Option<Departure> {
        *absorbed = weight.map(|w| w * (1.0 - self.sum));
        for w in weight.iter_mut() {
            *w *= self.sum;
        }
        let part = &self.parts[index(&self.shares, self.sum, draws)?];
        let mut stays = [0.0; N];
        let mut polarisation = Polarisation::NONE;
        let departure = part.scatter(arrival, weight, &mut stays, &mut polarisation, draws);
        for (a, s) in absorbed.iter_mut().zip(&stays) {
            *a += s;
        }
        departure
    }

    pub(super) fn evaluate<const N: usize>(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> [f64; N] {
        let mut values = [0.0; N];
        for (share, part) in self.shares.iter().zip(&self.parts) {
            for (v, p) in values.iter_mut().zip(part.evaluate::<N>(arrival, outgoing)) {
                *v += share * p;
            }
        }
        values
    }

    /// Density of departures that are not beams (1/sr).
    pub(super) fn density<const N: usize>(&self, arrival: &Arrival<'_>, weight: &[f64; N], outgoing: Vec3) -> f64 {
        let parts = self.shares.iter().zip(&self.parts).filter(|(share, _)| **share > 0.0);
        // None of them where the sum is 0.
        parts
            .map(|(share, part)| share / self.sum * part.density(arrival, weight, outgoing))
            .sum()
    }

    pub(super) fn beams<const N: usize>(&self, arrival: &Arrival<'_>) -> Vec<Beam<N>> {
        let mut beams: Vec<Beam<N>> = Vec::new();
        for (share, part) in self.shares.iter().zip(&self.parts) {
            for mut beam in part.beams::<N>(arrival) {
                beam.value = beam.value.map(|v| v * share);
                match beams
                    .iter_mut()
                    .find(|b| b.passes == beam.passes && b.direction == beam.direction)
                {
                    Some(same) => same.value = std::array::from_fn(|b| same.value[b] + beam.value[b]),
                    None => beams.push(beam),
                }
            }
        }
        beams
    }
}
