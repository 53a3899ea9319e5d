//! Linear polarisation of light between smooth borders.
//!
//! Two borders in a row pass more light than unpolarised ones would, as the first has polarised it: by 1.5 % for a pane at
//! 60°. Stokes' Q and U are followed from border to border; circular polarisation, which total reflection makes of U, is
//! dropped. Every other surface gives unpolarised light.

use crate::geometry::Vec3;

/// Degree of linear polarisation of a path's light, a band each: Q and U as shares of its power. Q is positive along
/// `axis`, U between `axis` and the direction of travel × `axis`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Polarisation<const N: usize> {
    axis: Vec3,
    q: [f64; N],
    u: [f64; N],
}

impl<const N: usize> Polarisation<N> {
    /// None.
    pub const NONE: Self = Self {
        axis: Vec3::new(0.0, 0.0, 0.0),
        q: [0.0; N],
        u: [0.0; N],
    };

    /// Q of a band along the axis.
    pub(super) fn q(&self, band: usize) -> f64 {
        self.q[band]
    }

    /// Seen about the normal of the plane of incidence, for light along `direction` that meets a surface of a `normal`.
    pub(super) fn turn_to(&mut self, direction: Vec3, normal: Vec3) {
        let across = direction.cross(normal);
        let length = across.length();
        if length < 1e-12 {
            // At normal incidence both polarisations are alike.
            return;
        }
        let across = across * (1.0 / length);
        let (cos, sin) = (self.axis.dot(across), direction.cross(self.axis).dot(across));
        let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * sin * cos);
        for (q, u) in self.q.iter_mut().zip(&mut self.u) {
            (*q, *u) = (cos2 * *q + sin2 * *u, cos2 * *u - sin2 * *q);
        }
        self.axis = across;
    }

    /// After a border that takes shares `s` and `p` of the power of both polarisations, and whose amplitudes have the
    /// product `both`.
    pub(super) fn pass(&mut self, band: usize, s: f64, p: f64, both: f64) {
        let (mean, half) = (0.5 * (s + p), 0.5 * (s - p));
        let power = mean + half * self.q[band];
        if power > 0.0 {
            self.u[band] *= both / power;
            self.q[band] = (half + mean * self.q[band]) / power;
        }
    }
}
