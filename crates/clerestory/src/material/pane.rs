//! A thin pane: what Radiance calls `glass`. Light that passes goes straight on; all reflections between the faces are in
//! its transmittance and reflectance ([`Slab`]).

use super::choice::choose;
use super::{Arrival, Departure, Draws, check, mirrored};
use crate::bsdf::Slab;
use crate::error::Result;

/// From the transmissivity (transmittance of one pass along the normal, without the faces) and the refractive index.
pub(super) fn slabs(transmissivity: &[f64], index: f64) -> Result<Vec<Slab>> {
    let kind = "glass";
    check::bands(kind, &[("transmissivity", transmissivity)])?;
    check::within(kind, ("transmissivity", transmissivity), 0.0, 1.0)?;
    check::number(kind, "index", index, 1.0, 10.0)?;
    transmissivity.iter().map(|t| Slab::new(index, *t)).collect()
}

/// Reflectance and transmittance, a band each.
pub(super) fn values<const N: usize>(slabs: &[Slab], arrival: &Arrival<'_>) -> [[f64; N]; 2] {
    let cos = arrival.cos();
    let mut ways = [[0.0; N]; 2];
    for b in 0..N {
        [ways[1][b], ways[0][b]] = if b > 0 && slabs[b] == slabs[0] {
            [ways[1][0], ways[0][0]]
        } else {
            slabs[b].values(1.0 - cos * cos)
        };
    }
    ways
}

pub(super) fn scatter<const N: usize>(
    slabs: &[Slab],
    arrival: &Arrival<'_>,
    weight: &mut [f64; N],
    absorbed: &mut [f64; N],
    draws: &mut Draws,
) -> Option<Departure> {
    let ways = values(slabs, arrival);
    for b in 0..N {
        absorbed[b] = weight[b] * (1.0 - ways[0][b] - ways[1][b]);
    }
    let passes = choose(weight, &ways, draws)? == 1;
    Some(Departure {
        direction: if passes {
            arrival.direction
        } else {
            mirrored(arrival.direction, arrival.normal)
        },
        passes,
        specular: true,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_panes_are_refused() {
        assert!(slabs(&[0.9, 1.1], 1.52).is_err() && slabs(&[0.9], 0.9).is_err() && slabs(&[], 1.52).is_err());
    }

    #[test]
    fn transmissivity_of_96_percent_is_88_percent_of_transmittance() {
        // Radiance's manual: common glass of 88 % transmittance has a transmissivity of 0.96.
        let [t, _] = slabs(&[0.96], 1.52).expect("it is a pane")[0].values(0.0);
        assert!((t - 0.88).abs() < 0.003, "{t}");
    }
}
