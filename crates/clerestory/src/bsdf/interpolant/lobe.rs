//! Lobes: radial basis functions on the sphere of outgoing directions.
//!
//! A lobe is (1 − q)³ of q, the squared chord between a direction and the lobe's centre over the squared radius; beyond the
//! radius there is nothing. It looks like a Gaussian, ends, and can be integrated and drawn exactly: on the sphere even steps
//! of the squared chord are even solid angles. Lobes are mirrored at the horizon, so that what would lie below is added above.

use std::f64::consts::{PI, TAU};

use crate::direction::Disk;

/// Unit vector along outgoing light, z away from the surface.
pub type Vector = [f64; 3];

/// The vector of a point of the disk.
pub fn vector(point: Disk) -> Vector {
    [point.x, point.y, point.cos_theta()]
}

/// Scattered light about a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lobe {
    /// The middle.
    pub centre: Disk,
    /// Square of the radius, as a chord of the unit sphere.
    pub radius2: f64,
    /// Transmittance or reflectance that it carries.
    pub flux: f64,
}

impl Lobe {
    /// BSDF in the middle, less what is mirrored into it (1/sr).
    pub fn amplitude(&self) -> f64 {
        self.flux / unit_flux(self.centre, self.radius2)
    }

    /// A direction, drawn by what it carries over solid angle.
    pub fn draw(&self, u: [f64; 2]) -> Disk {
        draw(vector(self.centre), self.radius2, u)
    }
}

/// Integral of a lobe of amplitude 1 over solid angle.
pub fn solid_angle(radius2: f64) -> f64 {
    0.25 * PI * radius2
}

/// Integral of a lobe of amplitude 1, and of its mirror image, over projected solid angle.
pub fn unit_flux(centre: Disk, radius2: f64) -> f64 {
    solid_angle(radius2) * mean_height(centre, radius2)
}

/// Mean of |z| over a lobe.
fn mean_height(centre: Disk, radius2: f64) -> f64 {
    /// Gauss and Legendre's points and weights on 0 to 1.
    const NODES: [(f64, f64); 8] = [
        (0.019_855_071_751_231_9, 0.050_614_268_145_188_1),
        (0.101_666_761_293_186_6, 0.111_190_517_226_687_2),
        (0.237_233_795_041_835_5, 0.156_853_322_938_943_6),
        (0.408_282_678_752_175_1, 0.181_341_891_689_181),
        (0.591_717_321_247_825, 0.181_341_891_689_181),
        (0.762_766_204_958_164_5, 0.156_853_322_938_943_6),
        (0.898_333_238_706_813_4, 0.111_190_517_226_687_2),
        (0.980_144_928_248_768_1, 0.050_614_268_145_188_1),
    ];
    let height = centre.cos_theta();
    let edge = 1.0 - 0.5 * radius2;
    if height * height + edge * edge >= 1.0 && edge > 0.0 {
        // All of it lies above: the mean direction is the centre's, shortened by the mean of q, which is 1/5.
        return height * (1.0 - 0.1 * radius2);
    }
    let across = centre.sin2_theta().sqrt();
    NODES
        .iter()
        .map(|&(q, weight)| {
            let cos = 1.0 - 0.5 * radius2 * q;
            let sin = (1.0 - cos * cos).max(0.0).sqrt();
            // Mean of |a + b cos φ| over a circle.
            let (a, b) = (cos * height, sin * across);
            let mean = if a >= b {
                a
            } else {
                2.0 / PI * (a * (a / b).asin() + (b * b - a * a).sqrt())
            };
            weight * 4.0 * (1.0 - q).powi(3) * mean
        })
        .sum()
}

/// (1 − q)³ where q is less than 1.
#[inline]
pub fn kernel(q: f64) -> f64 {
    let rest = (1.0 - q).max(0.0);
    rest * rest * rest
}

/// A direction drawn from a lobe, mirrored up if it falls below the horizon.
pub fn draw(centre: Vector, radius2: f64, [u, v]: [f64; 2]) -> Disk {
    let q = 1.0 - (1.0 - u).powf(0.25);
    let [x, y, _] = off(centre, radius2 * q, v);
    Disk::new(x, y)
}

/// The direction at a chord and a share of a turn from another one; None below the horizon.
pub fn around(centre: Vector, chord: f64, turn: f64) -> Option<Disk> {
    let [x, y, z] = off(centre, chord * chord, turn);
    (z > 0.0).then(|| Disk::new(x, y))
}

fn off([x, y, z]: Vector, chord2: f64, turn: f64) -> Vector {
    let cos = 1.0 - 0.5 * chord2;
    let sin = (1.0 - cos * cos).max(0.0).sqrt();
    let (s, c) = (TAU * turn).sin_cos();
    // Two axes across (Duff et al. 2017, "Building an orthonormal basis, revisited"); z is never negative.
    let (a, b) = (-1.0 / (1.0 + z), -x * y / (1.0 + z));
    [
        cos * x + sin * (c * (1.0 + x * x * a) + s * b),
        cos * y + sin * (c * b + s * (1.0 + y * y * a)),
        cos * z - sin * (c * x + s * y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::direction::Side;
    use crate::sequence::r2;

    #[test]
    fn fluxes_are_what_quadrature_finds() {
        for theta in [0.0_f64, 0.5, 1.2, 1.5, PI / 2.0] {
            for radius in [0.02_f64, 0.3, 0.9] {
                let centre = Disk::from_angles(theta, 0.7);
                let [x, y, z] = vector(centre);
                let n = 1 << 20;
                let mut sum = 0.0;
                // Points of the cap and of its mirror image, even in solid angle.
                for k in 0..n {
                    let [u, v] = r2(k, [0.0; 2]);
                    let q = u;
                    let cos = 1.0 - 0.5 * radius * radius * q;
                    let sin = (1.0 - cos * cos).sqrt();
                    let height = cos * z - sin * (TAU * v).cos() * x.hypot(y);
                    sum += kernel(q) * height.abs();
                }
                let found = sum / f64::from(n) * PI * radius * radius;
                let expected = unit_flux(centre, radius * radius);
                assert!(
                    (found / expected - 1.0).abs() < 2e-3,
                    "{theta} {radius}: {found} {expected}"
                );
            }
        }
    }

    #[test]
    fn draws_have_the_lobe_s_mean_direction_and_width() {
        let centre = Disk::from_angles(0.6, 2.0);
        let (mut q_sum, n) = (0.0, 1 << 14);
        let axis = centre.outgoing(Side::Interior);
        for k in 0..n {
            let d = draw(vector(centre), 0.04, r2(k, [0.3; 2])).outgoing(Side::Interior);
            q_sum += 2.0 * (1.0 - d.x * axis.x - d.y * axis.y - d.z * axis.z) / 0.04;
        }
        assert!((q_sum / f64::from(n) - 0.2).abs() < 1e-3);
    }
}
