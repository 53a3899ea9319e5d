//! Directions, sides and the two planes on which all scattering models are written.
//!
//! The frame of a sample is right-handed: +z points out of the interior face into the room, +y up, +x to the
//! right as seen from the room. A [`Direction`] is a unit vector pointing away from the surface: toward the source
//! for incident light, along the light for outgoing.
//!
//! A [`Disk`] point is a direction of *travel* projected onto the sample's plane. Light that goes straight through
//! or is mirrored keeps its disk point, and equal areas of the disk are equal projected solid angles, so a model
//! that is written on disks needs neither sides nor cosines.

use std::f64::consts::{FRAC_PI_4, PI, TAU};

use crate::error::{Error, Result};

/// The side of a sample that light comes from or goes to.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Side {
    /// Outdoors, z < 0.
    Exterior,
    /// The room, z > 0.
    Interior,
}

impl Side {
    /// Both sides, exterior first.
    pub const BOTH: [Self; 2] = [Self::Exterior, Self::Interior];

    /// The other side.
    #[must_use]
    pub fn opposite(self) -> Self {
        match self {
            Self::Exterior => Self::Interior,
            Self::Interior => Self::Exterior,
        }
    }

    /// Sign of z on this side.
    pub fn sign(self) -> f64 {
        match self {
            Self::Exterior => -1.0,
            Self::Interior => 1.0,
        }
    }

    /// `exterior` or `interior`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Exterior => "exterior",
            Self::Interior => "interior",
        }
    }
}

/// What happens to scattered light: it passes or it returns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Scatter {
    /// To the other side.
    Transmission,
    /// Back to the side it came from.
    Reflection,
}

impl Scatter {
    /// Transmission first.
    pub const BOTH: [Self; 2] = [Self::Transmission, Self::Reflection];

    /// The side that light from `incident` leaves to.
    pub fn outgoing_side(self, incident: Side) -> Side {
        match self {
            Self::Transmission => incident.opposite(),
            Self::Reflection => incident,
        }
    }

    /// `transmission` or `reflection`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Transmission => "transmission",
            Self::Reflection => "reflection",
        }
    }
}

/// Unit vector pointing away from the surface, in the sample's frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Direction {
    /// To the right as seen from the room.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// Into the room.
    pub z: f64,
}

impl Direction {
    /// Normalises a vector; fails on a zero or non-finite one.
    pub fn new(x: f64, y: f64, z: f64) -> Result<Self> {
        let length = (x * x + y * y + z * z).sqrt();
        if !(length.is_finite() && length > 0.0) {
            return Err(Error::Argument(format!(
                "({x}, {y}, {z}) is not a direction (give a finite vector that is not zero)"
            )));
        }
        Ok(Self {
            x: x / length,
            y: y / length,
            z: z / length,
        })
    }

    /// From the polar angle to the normal of `side` and the azimuth counter-clockwise from +x as seen from the
    /// room (radians): one fixed frame, so a sun above has azimuth π/2 on either side.
    pub fn from_angles(side: Side, theta: f64, phi: f64) -> Self {
        let (sin_theta, cos_theta) = theta.sin_cos();
        let (sin_phi, cos_phi) = phi.sin_cos();
        Self {
            x: sin_theta * cos_phi,
            y: sin_theta * sin_phi,
            z: side.sign() * cos_theta,
        }
    }

    /// Polar angle to the normal of its own side, 0 to π/2 (radians).
    pub fn theta(self) -> f64 {
        self.x.hypot(self.y).atan2(self.z.abs())
    }

    /// Azimuth in the fixed frame, 0 to 2π (radians); 0 along the normal.
    pub fn phi(self) -> f64 {
        azimuth(self.x, self.y)
    }

    /// The side that it points to; a direction in the plane counts as interior.
    pub fn side(self) -> Side {
        if self.z < 0.0 { Side::Exterior } else { Side::Interior }
    }

    /// Disk point of incident light from this direction (it travels the other way).
    pub fn incident_disk(self) -> Disk {
        Disk::new(-self.x, -self.y)
    }

    /// Disk point of light leaving along this direction.
    pub fn outgoing_disk(self) -> Disk {
        Disk::new(self.x, self.y)
    }

    /// Angle to another direction (radians), accurate for small angles too.
    pub fn angle_to(self, other: Self) -> f64 {
        let (cx, cy, cz) = (
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        );
        let dot = self.x * other.x + self.y * other.y + self.z * other.z;
        (cx * cx + cy * cy + cz * cz).sqrt().atan2(dot)
    }
}

fn azimuth(x: f64, y: f64) -> f64 {
    let phi = y.atan2(x);
    // + 0.0 turns the -0.0 of atan2(-0.0, x) into 0.
    if phi < 0.0 { phi + TAU } else { phi + 0.0 }
}

/// A direction of travel projected onto the sample's plane: a point of the unit disk.
///
/// Area on the disk is projected solid angle: the whole disk is π sr.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disk {
    /// To the right as seen from the room.
    pub x: f64,
    /// Up.
    pub y: f64,
}

impl Disk {
    /// Straight along the normal.
    pub const NORMAL: Self = Self { x: 0.0, y: 0.0 };

    /// A point; one that rounding put outside of the unit disk is moved to its edge.
    pub fn new(x: f64, y: f64) -> Self {
        let r2 = x * x + y * y;
        if r2 > 1.0 {
            let r = r2.sqrt();
            Self { x: x / r, y: y / r }
        } else {
            Self { x, y }
        }
    }

    /// From the polar angle to the normal and the azimuth of travel (radians).
    pub fn from_angles(theta: f64, phi: f64) -> Self {
        let (s, c) = phi.sin_cos();
        let r = theta.sin();
        Self { x: r * c, y: r * s }
    }

    /// Squared sine of the polar angle.
    pub fn sin2_theta(self) -> f64 {
        self.x * self.x + self.y * self.y
    }

    /// Cosine of the polar angle.
    pub fn cos_theta(self) -> f64 {
        (1.0 - self.sin2_theta()).max(0.0).sqrt()
    }

    /// Polar angle (radians).
    pub fn theta(self) -> f64 {
        self.x.hypot(self.y).atan2(self.cos_theta())
    }

    /// Azimuth of travel, 0 to 2π (radians).
    pub fn phi(self) -> f64 {
        azimuth(self.x, self.y)
    }

    /// The direction toward the source of incident light that travels so, from `side`.
    pub fn incident(self, side: Side) -> Direction {
        Direction {
            x: -self.x,
            y: -self.y,
            z: side.sign() * self.cos_theta(),
        }
    }

    /// The direction of light that leaves to `side`.
    pub fn outgoing(self, side: Side) -> Direction {
        Direction {
            x: self.x,
            y: self.y,
            z: side.sign() * self.cos_theta(),
        }
    }

    /// Turned counter-clockwise by an angle whose sine and cosine are given.
    #[must_use]
    pub fn turned(self, sin: f64, cos: f64) -> Self {
        Self {
            x: self.x * cos - self.y * sin,
            y: self.x * sin + self.y * cos,
        }
    }

    /// The opposite point: the same path travelled backwards.
    #[must_use]
    pub fn reversed(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }

    /// Angle between two directions of travel on one side (radians).
    pub fn angle_to(self, other: Self) -> f64 {
        self.outgoing(Side::Interior).angle_to(other.outgoing(Side::Interior))
    }

    /// Point of the unit square by the concentric map (Shirley and Chiu 1997, "A low distortion map between disk
    /// and square"); both coordinates lie in [0, 1).
    pub fn to_square(self) -> [f64; 2] {
        // A hair inside of the unit circle, so that the edge stays below 1 (as Radiance does).
        let r = self.sin2_theta().sqrt() * (1.0 - 1e-13);
        if r == 0.0 {
            return [0.5, 0.5];
        }
        let (ax, ay) = (self.x.abs(), self.y.abs());
        let (small, large) = if ay <= ax { (ay, ax) } else { (ax, ay) };
        let s = r * share_of_octant(small, large);
        let (a, b) = if ay <= ax { (r, s) } else { (s, r) };
        [
            clamp_unit((a.copysign(self.x) + 1.0) * 0.5),
            clamp_unit((b.copysign(self.y) + 1.0) * 0.5),
        ]
    }

    /// Inverse of [`Disk::to_square`].
    pub fn from_square(square: [f64; 2]) -> Self {
        let (a, b) = (2.0 * square[0] - 1.0, 2.0 * square[1] - 1.0);
        if a == 0.0 && b == 0.0 {
            return Self::NORMAL;
        }
        if a.abs() >= b.abs() {
            let (s, c) = (FRAC_PI_4 * b / a).sin_cos();
            Self { x: a * c, y: a * s }
        } else {
            let (s, c) = (FRAC_PI_4 * a / b).sin_cos();
            Self { x: b * s, y: b * c }
        }
    }

    /// Uniform point of the disk from two numbers in [0, 1): cosine-weighted directions.
    pub fn uniform(u: [f64; 2]) -> Self {
        Self::from_square(u)
    }
}

/// atan(small / large) · 4/π for 0 ≤ small ≤ large, to 2e-16. This is most of the time of a look-up, so it has no
/// branches: the angle is taken from the octant's middle, where a polynomial of 11 terms is enough.
fn share_of_octant(small: f64, large: f64) -> f64 {
    /// tan(π/8)
    const MIDDLE: f64 = std::f64::consts::SQRT_2 - 1.0;
    /// atan(z)/z in powers of z², interpolated at the Chebyshev points of 0 ≤ |z| ≤ tan(π/8).
    const P: [f64; 11] = [
        1.0,
        -0.333_333_333_333_284_4,
        0.199_999_999_988_551_1,
        -0.142_857_141_809_764_67,
        0.111_111_061_804_559_46,
        -0.090_907_730_748_084_14,
        0.076_899_534_963_068_57,
        -0.066_402_339_304_294_08,
        0.056_883_492_268_090_106,
        -0.043_480_522_157_164_62,
        0.021_135_373_157_693_246,
    ];
    if small == 0.0 {
        return 0.0;
    }
    let z = (small - MIDDLE * large) / (large + MIDDLE * small);
    let w = z * z;
    // Estrin's scheme: short chains of dependent operations.
    let w2 = w * w;
    let w4 = w2 * w2;
    let low = (P[0] + P[1] * w) + (P[2] + P[3] * w) * w2;
    let middle = (P[4] + P[5] * w) + (P[6] + P[7] * w) * w2;
    let high = (P[8] + P[9] * w) + P[10] * w2;
    0.5 + z * (low + (middle + high * w4) * w4) / FRAC_PI_4
}

fn clamp_unit(v: f64) -> f64 {
    v.clamp(0.0, 1.0 - f64::EPSILON / 2.0)
}

/// Projected solid angle of a hemisphere (sr).
pub const HEMISPHERE: f64 = PI;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn square_map_matches_published_points() {
        for (disk, square) in [
            ((0.3, 0.4), (0.704_833, 0.75)),
            ((-0.6, 0.1), (0.195_862, 0.563_952)),
            ((0.05, -0.8), (0.531_852, 0.099_220)),
            ((-0.2, -0.3), (0.365_032, 0.319_722)),
        ] {
            let s = Disk::new(disk.0, disk.1).to_square();
            assert!(
                (s[0] - square.0).abs() < 1e-6 && (s[1] - square.1).abs() < 1e-6,
                "{disk:?} {s:?}"
            );
            let back = Disk::from_square(s);
            assert!((back.x - disk.0).abs() < 1e-12 && (back.y - disk.1).abs() < 1e-12);
        }
    }

    #[test]
    fn square_map_agrees_with_its_formula_to_the_last_digits() {
        let formula = |d: Disk| {
            let r = d.x.hypot(d.y) * (1.0 - 1e-13);
            let (a, b) = if d.y.abs() <= d.x.abs() {
                (r.copysign(d.x), r.copysign(d.x) * (d.y / d.x).atan() / FRAC_PI_4)
            } else {
                (r.copysign(d.y) * (d.x / d.y).atan() / FRAC_PI_4, r.copysign(d.y))
            };
            [(a + 1.0) * 0.5, (b + 1.0) * 0.5]
        };
        let check = |d: Disk| {
            let (s, f) = (d.to_square(), formula(d));
            assert!(
                (s[0] - f[0]).abs() < 5e-16 && (s[1] - f[1]).abs() < 5e-16,
                "{d:?} {s:?} {f:?}"
            );
            assert!(s[0] < 1.0 && s[1] < 1.0);
        };
        for k in 1..100_000 {
            check(Disk::from_angles(f64::from(k) * 1.57e-5, f64::from(k) * 2.4));
        }
        for (x, y) in [
            (1.0, 0.0),
            (0.0, -1.0),
            (0.5, 0.5),
            (1e-300, 1e-9),
            (0.3, -1e-20),
            (-0.7, 0.7),
        ] {
            check(Disk::new(x, y));
        }
        assert_eq!(Disk::new(0.3, 0.0).to_square()[1], 0.5);
        assert_eq!(Disk::new(1e-300, 0.0).to_square(), [0.5, 0.5]);
    }

    #[test]
    fn reversing_a_path_turns_the_square_point_symmetrically() {
        for k in 0..200 {
            let d = Disk::from_angles(f64::from(k) * 0.007, f64::from(k) * 1.7);
            let (s, r) = (d.to_square(), d.reversed().to_square());
            assert!((s[0] + r[0] - 1.0).abs() < 1e-12 && (s[1] + r[1] - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_sun_above_has_azimuth_90_on_either_side_and_travels_down() {
        for side in Side::BOTH {
            let sun = Direction::from_angles(side, 0.7, std::f64::consts::FRAC_PI_2);
            assert_eq!(sun.side(), side);
            assert!((sun.phi() - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
            assert!((sun.theta() - 0.7).abs() < 1e-12);
            assert!(sun.incident_disk().y < 0.0);
        }
    }

    #[test]
    fn angles_keep_their_digits_near_zero() {
        let a = Disk::from_angles(0.5, 1.0);
        let b = Disk::from_angles(0.5 + 1e-7, 1.0);
        assert!((a.angle_to(b) - 1e-7).abs() < 1e-13);
    }
}
