//! The rough border of two media: facets of the distribution GGX that reflect and refract by Fresnel's equations (Walter et
//! al. 2007). Energy-conserving; light that would meet a second facet is absorbed.

use super::interface::{self, fresnel};
use super::microfacet::{LEAST_COS, SMOOTH, density as facets, facet, seen_density, shadowing, shadowing_ratio};
use super::{Arrival, Departure, Draws, Polarisation};
use crate::geometry::Vec3;

/// Whether light sees no more than a smooth border, or none at all.
pub(super) fn is_smooth<const N: usize>(alpha: f64, arrival: &Arrival<'_>) -> bool {
    alpha <= SMOOTH || (0..N).all(|b| arrival.here.index[b] == arrival.beyond.index[b])
}

pub(super) fn scatter<const N: usize>(
    alpha: f64,
    arrival: &Arrival<'_>,
    weight: &mut [f64; N],
    absorbed: &mut [f64; N],
    draws: &mut Draws,
) -> Option<Departure> {
    *absorbed = [0.0; N];
    // Facets turn polarisation this way and that.
    let mut polarisation = Polarisation::NONE;
    if is_smooth::<N>(alpha, arrival) {
        return interface::scatter(arrival, weight, &mut polarisation, draws);
    }
    let u = [draws.next(), draws.next()];
    let half = facet(alpha, -arrival.direction, arrival.normal, u);
    // As on a smooth border that lies like the facet …
    let on_facet = Arrival {
        normal: half,
        ..*arrival
    };
    let departure = interface::scatter(&on_facet, weight, &mut polarisation, draws)?;
    // … but the facet may be seen from there, or not.
    let cos_out = departure.direction.dot(arrival.normal) * if departure.passes { -1.0 } else { 1.0 };
    let shown = if cos_out > LEAST_COS {
        shadowing_ratio(alpha, arrival.cos(), cos_out)
    } else {
        0.0
    };
    for b in 0..N {
        let kept = weight[b] * shown;
        absorbed[b] += weight[b] - kept;
        weight[b] = kept;
    }
    (shown > 0.0).then_some(Departure {
        specular: false,
        ..departure
    })
}

/// Normal of the facet that refracts light from `incident` to `outgoing`, and its cosines to both; none where there is no
/// such facet.
fn refracting(incident: Vec3, outgoing: Vec3, normal: Vec3, here: f64, beyond: f64) -> Option<(Vec3, f64, f64)> {
    let half = incident * here + outgoing * beyond;
    if half.length() == 0.0 {
        return None;
    }
    let half = half.unit();
    let half = if half.dot(normal) < 0.0 { -half } else { half };
    let (ih, oh) = (incident.dot(half), outgoing.dot(half));
    (ih > 0.0 && oh < 0.0).then_some((half, ih, oh))
}

pub(super) fn evaluate<const N: usize>(alpha: f64, arrival: &Arrival<'_>, outgoing: Vec3) -> [f64; N] {
    let cos = arrival.cos();
    let cos_out = outgoing.dot(arrival.normal);
    if is_smooth::<N>(alpha, arrival) || cos <= 0.0 || cos_out.abs() <= LEAST_COS {
        return [0.0; N];
    }
    let incident = -arrival.direction;
    std::array::from_fn(|b| {
        let (here, beyond) = (arrival.here.index[b], arrival.beyond.index[b]);
        if cos_out > 0.0 {
            let half = (incident + outgoing).unit();
            let (reflectance, _) = fresnel(here, beyond, incident.dot(half));
            let facets = facets(alpha, half.dot(arrival.normal));
            return reflectance * facets * shadowing(alpha, cos, cos_out) / (4.0 * cos * cos_out);
        }
        refracting(incident, outgoing, arrival.normal, here, beyond).map_or(0.0, |(half, ih, oh)| {
            let (reflectance, _) = fresnel(here, beyond, ih);
            let facets = facets(alpha, half.dot(arrival.normal)) * shadowing(alpha, cos, -cos_out);
            let bend = beyond / (here * ih + beyond * oh);
            (1.0 - reflectance) * facets * ih * -oh * bend * bend / (cos * -cos_out)
        })
    })
}

/// Density of departures (1/sr). A facet is drawn for all bands; light returns from it with the mean reflectance of what
/// the bands carry, and otherwise goes the way of one band.
pub(super) fn density<const N: usize>(alpha: f64, arrival: &Arrival<'_>, weight: &[f64; N], outgoing: Vec3) -> f64 {
    let (cos, cos_out) = (arrival.cos(), outgoing.dot(arrival.normal));
    let sum: f64 = weight.iter().sum();
    if is_smooth::<N>(alpha, arrival) || sum <= 0.0 || cos_out.abs() <= LEAST_COS {
        return 0.0;
    }
    let incident = -arrival.direction;
    let mut density = 0.0;
    for (b, share) in weight
        .iter()
        .map(|w| w / sum)
        .enumerate()
        .filter(|(_, share)| *share > 0.0)
    {
        let (here, beyond) = (arrival.here.index[b], arrival.beyond.index[b]);
        if cos_out > 0.0 {
            let half = (incident + outgoing).unit();
            let seen = half.dot(outgoing);
            let (reflectance, _) = fresnel(here, beyond, seen);
            density += share * reflectance * seen_density(alpha, cos, half.dot(arrival.normal), seen) / (4.0 * seen);
        } else if let Some((half, ih, oh)) = refracting(incident, outgoing, arrival.normal, here, beyond) {
            let (reflectance, _) = fresnel(here, beyond, ih);
            let bend = beyond / (here * ih + beyond * oh);
            let facets = seen_density(alpha, cos, half.dot(arrival.normal), ih);
            density += share * (1.0 - reflectance) * facets * -oh * bend * bend;
        }
    }
    density
}
