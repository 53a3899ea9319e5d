//! A surface of many small facets whose slopes have the distribution GGX (Trowbridge and Reitz 1975; Walter et al. 2007,
//! "Microfacet models for refraction through rough surfaces", EGSR), with Smith's shadowing of heights that belong together.

use std::f64::consts::{PI, TAU};

use crate::geometry::Vec3;

/// Below this roughness a surface is smooth.
pub(super) const SMOOTH: f64 = 1e-4;
/// Light that leaves nearer to the surface than this cosine counts as shadowed.
pub(super) const LEAST_COS: f64 = 1e-9;

/// Density of facets by the cosine of their normal to the surface's (1/sr); its integral times cosine is 1.
pub(super) fn density(alpha: f64, cos: f64) -> f64 {
    let base = cos * cos * (alpha * alpha - 1.0) + 1.0;
    alpha * alpha / (PI * base * base)
}

/// Area of shadowed facets over area of those that are seen, from a direction.
fn lambda(alpha: f64, cos: f64) -> f64 {
    let tan2 = (1.0 - cos * cos).max(0.0) / (cos * cos).max(1e-30);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Share of facets that are seen from both directions.
pub(super) fn shadowing(alpha: f64, cos: f64, cos_out: f64) -> f64 {
    1.0 / (1.0 + lambda(alpha, cos) + lambda(alpha, cos_out))
}

/// The same over the share that is seen from the first direction: the weight of a sample.
pub(super) fn shadowing_ratio(alpha: f64, cos: f64, cos_out: f64) -> f64 {
    let seen = 1.0 + lambda(alpha, cos);
    seen / (seen + lambda(alpha, cos_out))
}

/// Density of the facets that [`facet`] draws (1/sr), by the cosine of their normal to the surface's and to the light's
/// source, which is above 0, and the cosine of the angle of incidence.
pub(super) fn seen_density(alpha: f64, cos: f64, cos_facet: f64, cos_seen: f64) -> f64 {
    // Share of facets that are seen over the cosine, 1/((1 + Λ) cosθ), without its 0/0 at grazing incidence.
    let tilted = alpha * alpha * (1.0 - cos * cos).max(0.0);
    density(alpha, cos_facet) * cos_seen * 2.0 / (cos + (cos * cos + tilted).sqrt())
}

/// Normal of a facet that light toward whose source `incident` points can see, drawn by the area that it shows (Heitz 2018,
/// "Sampling the GGX distribution of visible normals", JCGT 7(4)).
pub(super) fn facet(alpha: f64, incident: Vec3, normal: Vec3, u: [f64; 2]) -> Vec3 {
    let [s, t] = normal.frame();
    let stretched = Vec3::new(
        alpha * incident.dot(s),
        alpha * incident.dot(t),
        incident.dot(normal).max(1e-12),
    )
    .unit();
    let across = stretched.x.hypot(stretched.y);
    let first = if across > 0.0 {
        Vec3::new(-stretched.y / across, stretched.x / across, 0.0)
    } else {
        Vec3::new(1.0, 0.0, 0.0)
    };
    let second = stretched.cross(first);
    let r = u[0].sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let a = r * cos;
    let share = 0.5 * (1.0 + stretched.z);
    let b = (1.0 - share) * (1.0 - a * a).max(0.0).sqrt() + share * r * sin;
    let h = first * a + second * b + stretched * (1.0 - a * a - b * b).max(0.0).sqrt();
    (s * (alpha * h.x) + t * (alpha * h.y) + normal * h.z.max(0.0)).unit()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn facets_cover_the_surface_once() {
        for alpha in [0.05, 0.3, 1.0] {
            let n = 100_000;
            // In the squared tangent, as the density has it.
            let sum: f64 = (0..n)
                .map(|k| {
                    let u = (f64::from(k) + 0.5) / f64::from(n);
                    let tan2 = alpha * alpha * u / (1.0 - u);
                    let cos2 = 1.0 / (1.0 + tan2);
                    // d(cos²)/du
                    let step = cos2 * cos2 * alpha * alpha / (1.0 - u).powi(2) / f64::from(n);
                    density(alpha, cos2.sqrt()) * PI * step
                })
                .sum();
            assert!((sum - 1.0).abs() < 1e-6, "{alpha}: {sum}");
        }
    }

    #[test]
    fn seen_facets_cover_the_light_once() {
        for (alpha, cos) in [(0.2, 0.9), (0.5, 0.3), (1.0, 0.02)] {
            let incident = Vec3::new((1.0_f64 - cos * cos).sqrt(), 0.0, cos);
            let n = 1500;
            let mut sum = 0.0;
            for a in 0..n {
                for b in 0..n {
                    // By the facets' projected area, denser toward upright ones.
                    let v = (f64::from(a) + 0.5) / f64::from(n);
                    let u = 1.0 - v * v;
                    let tan2 = alpha * alpha * u / (1.0 - u);
                    let z = (1.0 / (1.0 + tan2)).sqrt();
                    let (sin, cos_phi) = ((f64::from(b) + 0.5) / f64::from(n) * TAU).sin_cos();
                    let r = (1.0 - z * z).sqrt();
                    let seen = Vec3::new(r * cos_phi, r * sin, z).dot(incident);
                    if seen > 0.0 {
                        sum += seen_density(alpha, cos, z, seen) / (density(alpha, z) * z) * 2.0 * v;
                    }
                }
            }
            sum /= f64::from(n * n);
            assert!((sum - 1.0).abs() < 2e-3, "{alpha} {cos}: {sum}");
            let one = 1.0 / (1.0 + lambda(alpha, cos)) / cos;
            let same = seen_density(alpha, cos, 0.7, 0.4) / (density(alpha, 0.7) * 0.4);
            assert!((same / one - 1.0).abs() < 1e-9, "{alpha} {cos}: {same} {one}");
        }
    }

    #[test]
    fn shadowing_ratio_is_of_shadowings() {
        let one = 1.0 / (1.0 + lambda(0.4, 0.3));
        assert!((shadowing(0.4, 0.3, 0.8) / one - shadowing_ratio(0.4, 0.3, 0.8)).abs() < 1e-12);
    }
}
