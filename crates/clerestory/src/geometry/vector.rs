//! Vectors in the sample's frame.

use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// A point (metres) or a direction in the sample's frame: x to the right as seen from the room, y up, z into the room.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vec3 {
    /// To the right.
    pub x: f64,
    /// Up.
    pub y: f64,
    /// Into the room.
    pub z: f64,
}

impl Vec3 {
    /// From its coordinates.
    pub const fn new(x: f64, y: f64, z: f64) -> Self {
        Self { x, y, z }
    }

    /// Its coordinates.
    pub const fn array(self) -> [f64; 3] {
        [self.x, self.y, self.z]
    }

    /// Scalar product.
    pub fn dot(self, other: Self) -> f64 {
        self.x * other.x + self.y * other.y + self.z * other.z
    }

    /// Vector product.
    #[must_use]
    pub fn cross(self, other: Self) -> Self {
        Self::new(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }

    /// Length.
    pub fn length(self) -> f64 {
        self.dot(self).sqrt()
    }

    /// Of length 1; not a number for the zero vector.
    #[must_use]
    pub fn unit(self) -> Self {
        self * (1.0 / self.length())
    }

    /// Two unit vectors that with this one (of length 1) make a right-handed frame (Duff et al. 2017, JCGT 6(1)).
    pub fn frame(self) -> [Self; 2] {
        let sign = 1.0_f64.copysign(self.z);
        let a = -1.0 / (sign + self.z);
        let b = self.x * self.y * a;
        [
            Self::new(1.0 + sign * self.x * self.x * a, sign * b, -sign * self.x),
            Self::new(b, sign + self.y * self.y * a, -self.y),
        ]
    }
}

impl Add for Vec3 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl AddAssign for Vec3 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Sub for Vec3 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl Mul<f64> for Vec3 {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self::new(self.x * factor, self.y * factor, self.z * factor)
    }
}

impl Neg for Vec3 {
    type Output = Self;
    fn neg(self) -> Self {
        Self::new(-self.x, -self.y, -self.z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_right_handed_and_of_length_1() {
        for n in [
            Vec3::new(0.0, 0.0, 1.0),
            Vec3::new(0.0, 0.0, -1.0),
            Vec3::new(0.6, -0.64, 0.48),
            Vec3::new(-0.8, 0.0, -0.6),
        ] {
            let [u, v] = n.frame();
            assert!(
                (u.cross(v) - n).length() < 1e-15 && (u.length() - 1.0).abs() < 1e-15,
                "{n:?}"
            );
            assert!(u.dot(n).abs() < 1e-15 && v.dot(n).abs() < 1e-15);
        }
    }
}
