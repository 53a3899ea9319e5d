//! Integrals over the hemisphere of functions that are symmetric about the sun's meridian and peak at the sun.

use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::OnceLock;

use crate::geometry::Vec3;

/// Nodes in (0, 1), their distance from the nearer end, and weights: the double-exponential rule (Takahasi and Mori
/// 1974), which is not disturbed by cusps and essential singularities at the ends.
fn rule() -> &'static [(f64, f64)] {
    static RULE: OnceLock<Vec<(f64, f64)>> = OnceLock::new();
    RULE.get_or_init(|| {
        const STEPS: i32 = 34;
        const REACH: f64 = 3.4;
        let step = REACH / f64::from(STEPS);
        let nodes: Vec<(f64, f64)> = (-STEPS..=STEPS)
            .map(|k| {
                let t = step * f64::from(k);
                let u = FRAC_PI_2 * t.sinh();
                let node = 1.0 / (1.0 + (-2.0 * u).exp());
                (node, step * FRAC_PI_2 * t.cosh() * 0.5 / u.cosh().powi(2))
            })
            .collect();
        let sum: f64 = nodes.iter().map(|n| n.1).sum();
        nodes.into_iter().map(|(x, w)| (x, w / sum)).collect()
    })
}

/// Horizontal irradiance: ∫ L cos ζ dω over the upper hemisphere, for a luminance that depends on cos ζ and the angle γ
/// to the sun (radians) only. Relative error about 1e-9.
///
/// `sun_zenith` may be beyond the horizon.
pub fn horizontal(sun_zenith: f64, luminance: impl Fn(f64, f64) -> f64) -> f64 {
    let split = sun_zenith.clamp(0.0, FRAC_PI_2);
    let mut sum = 0.0;
    for (from, to) in [(0.0, split), (split, FRAC_PI_2)] {
        if to - from < 1e-9 {
            continue;
        }
        for &(x, wx) in rule() {
            let zenith = from + (to - from) * x;
            let (sin, cos) = zenith.sin_cos();
            let row: f64 = rule()
                .iter()
                .map(|&(y, wy)| wy * luminance(cos, angle(zenith, sun_zenith, PI * y)))
                .sum();
            sum += wx * (to - from) * sin * cos * row;
        }
    }
    TAU * sum
}

/// Irradiance on a plane with a unit normal: ∫ L max(0, cos) dω over the sphere, for a radiance that may peak at the sun
/// and jump at the horizon. Relative error below 1e-6.
pub fn on_plane(sun: Vec3, normal: Vec3, radiance: impl Fn(Vec3) -> [f64; 3]) -> [f64; 3] {
    let across = normal.x.hypot(normal.y);
    // The plane itself meets rows between these angles from the zenith; only parts of them are in front of it.
    let first = across.atan2(normal.z.abs());
    let first = (FRAC_PI_2 - first).abs();
    let mut limits = [0.0, sun.z.clamp(-1.0, 1.0).acos(), FRAC_PI_2, first, PI - first, PI];
    limits.sort_by(f64::total_cmp);
    let azimuth = normal.y.atan2(normal.x);
    let of_sun = sun.y.atan2(sun.x);
    let mut sum = [0.0; 3];
    for pair in limits.windows(2) {
        let (from, to) = (pair[0], pair[1]);
        if to - from < 1e-9 {
            continue;
        }
        for &(x, wx) in rule() {
            let (sin, cos) = (from + (to - from) * x).sin_cos();
            let up = cos * normal.z;
            let flat = sin * across;
            let Some(half) = (if up >= flat {
                Some(PI)
            } else if up <= -flat {
                None
            } else {
                Some((-up / flat).acos())
            }) else {
                continue;
            };
            // Azimuths from the sun's, so that its meridian is an end.
            let begin = (azimuth - half - of_sun).rem_euclid(TAU);
            let pieces = if half == PI {
                [(0.0, TAU), (0.0, 0.0)]
            } else if begin + 2.0 * half > TAU {
                [(begin, TAU), (0.0, begin + 2.0 * half - TAU)]
            } else {
                [(begin, begin + 2.0 * half), (0.0, 0.0)]
            };
            for (left, right) in pieces {
                if right - left < 1e-12 {
                    continue;
                }
                for &(y, wy) in rule() {
                    let (sa, ca) = (of_sun + left + (right - left) * y).sin_cos();
                    let direction = Vec3::new(ca * sin, sa * sin, cos);
                    let weight = wx * wy * (to - from) * (right - left) * sin * direction.dot(normal).max(0.0);
                    for (total, value) in sum.iter_mut().zip(radiance(direction)) {
                        *total += weight * value;
                    }
                }
            }
        }
    }
    sum
}

/// Angle between directions at two zenith angles and a difference of azimuths; keeps its digits where it is small.
fn angle(zenith: f64, other: f64, azimuth: f64) -> f64 {
    let half = ((zenith - other) / 2.0).sin().powi(2) + zenith.sin() * other.sin() * (azimuth / 2.0).sin().powi(2);
    2.0 * half.clamp(0.0, 1.0).sqrt().asin()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_and_overcast_skies_have_their_closed_forms() {
        for sun in [0.0, 0.7, 1.5, FRAC_PI_2, 1.7] {
            assert!((horizontal(sun, |_, _| 1.0) - PI).abs() < 1e-10);
            let overcast = horizontal(sun, |cos, _| (1.0 + 2.0 * cos) / 3.0);
            assert!((overcast - 7.0 * PI / 9.0).abs() < 1e-10);
        }
    }

    /// ∫ cos²γ cos ζ dω = π/4 (1 + cos² z), and a cone exp(-kγ) at the zenith by partial integration.
    #[test]
    fn functions_of_the_angle_to_the_sun_have_theirs() {
        for sun in [0.0_f64, 0.4, 1.1, 1.5] {
            let found = horizontal(sun, |_, gamma| gamma.cos().powi(2));
            let expected = PI / 4.0 * (1.0 + sun.cos().powi(2));
            assert!((found - expected).abs() < 1e-9, "{found} {expected}");
        }
        for k in [1.0_f64, 5.0, 30.0] {
            // ∫₀^{π/2} e^{-kγ} sin γ cos γ dγ = (1 + e^{-kπ/2}) / (k² + 4)
            let expected = TAU * (1.0 + (-k * FRAC_PI_2).exp()) / (k * k + 4.0);
            let found = horizontal(0.0, |_, gamma| (-k * gamma).exp());
            assert!((found / expected - 1.0).abs() < 1e-9, "{k}: {found} {expected}");
        }
    }

    /// Against a plain sum over two million cells.
    #[test]
    fn a_peak_beside_the_zenith_is_resolved() {
        let sun = 0.9;
        let luminance =
            |cos: f64, gamma: f64| (1.0 - (-0.3 / cos.max(0.01)).exp()) * (1.0 + 20.0 * (-9.0 * gamma).exp());
        let (rows, columns) = (1000, 2000);
        let mut sum = 0.0;
        for i in 0..rows {
            let zenith = FRAC_PI_2 * (f64::from(i) + 0.5) / f64::from(rows);
            for j in 0..columns {
                let azimuth = PI * (f64::from(j) + 0.5) / f64::from(columns);
                sum += luminance(zenith.cos(), angle(zenith, sun, azimuth)) * zenith.sin() * zenith.cos();
            }
        }
        let plain = sum * (FRAC_PI_2 / f64::from(rows)) * (TAU / f64::from(columns));
        let found = horizontal(sun, luminance);
        assert!((found / plain - 1.0).abs() < 3e-6, "{found} {plain}");
    }

    /// Uniform surroundings give π L on any plane; a uniform sky over a black ground gives π (1 + cos tilt)/2.
    #[test]
    fn planes_have_their_closed_forms() {
        let sun = Vec3::new(0.48, -0.6, 0.64);
        for (tilt, azimuth) in [
            (0.0_f64, 0.0_f64),
            (0.4, 2.0),
            (1.3, -0.7),
            (FRAC_PI_2, 1.0),
            (2.5, 4.0),
            (PI, 0.0),
        ] {
            let normal = Vec3::new(tilt.sin() * azimuth.cos(), tilt.sin() * azimuth.sin(), tilt.cos());
            let all = on_plane(sun, normal, |_| [1.0; 3]);
            assert!((all[0] - PI).abs() < 1e-8, "{tilt}: {all:?}");
            let sky = on_plane(sun, normal, |d| [f64::from(u8::from(d.z > 0.0)); 3]);
            let expected = PI * (1.0 + tilt.cos()) / 2.0;
            assert!((sky[1] - expected).abs() < 1e-8, "{tilt}: {sky:?} {expected}");
            // cos² of the angle to the sun on a plane: π/4 (1 + cos²) over its whole hemisphere.
            let lobe = on_plane(sun, normal, |d| [d.dot(sun).powi(2); 3]);
            let expected = PI / 4.0 * (1.0 + normal.dot(sun).powi(2));
            assert!((lobe[2] - expected).abs() < 1e-8, "{tilt}: {lobe:?} {expected}");
        }
    }
}
