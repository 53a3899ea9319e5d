//! Sections for tests, and a slow way to meet them.

use std::f64::consts::TAU;

use super::Piece;
use crate::geometry::{Ray, Vec3};
use crate::sequence::uniform;

/// A segment.
pub fn segment(from: [f64; 2], to: [f64; 2], surface: u32) -> Piece {
    arc(from, to, 0.0, surface)
}

/// An arc.
pub fn arc(from: [f64; 2], to: [f64; 2], turn: f64, surface: u32) -> Piece {
    Piece {
        from,
        to,
        turn,
        surface,
    }
}

/// A flat or curved slat of a width about the origin, tilted.
pub fn slat(width: f64, turn: f64, tilt: f64) -> Vec<Piece> {
    let (sin, cos) = tilt.sin_cos();
    let h = 0.5 * width;
    vec![arc([-h * cos, -h * sin], [h * cos, h * sin], turn, 0)]
}

/// Numbers one after the other.
pub struct Numbers(pub u64, pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.1 += 1;
        uniform(self.0, self.1)
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A direction, even over the sphere.
    pub fn direction(&mut self) -> Vec3 {
        let z = self.between(-1.0, 1.0);
        let (sin, cos) = (TAU * self.next()).sin_cos();
        let r = (1.0 - z * z).sqrt();
        Vec3::new(r * cos, r * sin, z)
    }
}

/// The nearest hit by trying every copy within reach, written in the textbook's way: distance, piece and y within 1e9
/// periods. `leaving` is the piece that the ray starts on.
pub fn slow(pieces: &[Piece], period: f64, ray: &Ray, leaving: Option<usize>) -> Option<(f64, usize)> {
    let mut best: Option<(f64, usize)> = None;
    let (o, d) = ([ray.origin.z, ray.origin.y], [ray.direction.z, ray.direction.y]);
    let mut keep = |t: f64, k: usize| {
        if t > 0.0 && best.is_none_or(|(b, _)| t < b) {
            best = Some((t, k));
        }
    };
    for (k, p) in pieces.iter().enumerate() {
        for copy in -60..=60 {
            let own = leaving == Some(k) && copy == 0;
            let up = f64::from(copy) * period;
            let (a, b) = ([p.from[0], p.from[1] + up], [p.to[0], p.to[1] + up]);
            let e = [b[0] - a[0], b[1] - a[1]];
            let w = [o[0] - a[0], o[1] - a[1]];
            if p.turn == 0.0 {
                let det = d[0] * e[1] - d[1] * e[0];
                let t = (e[0] * w[1] - e[1] * w[0]) / det;
                let s = (d[0] * w[1] - d[1] * w[0]) / det;
                if !own && (0.0..=1.0).contains(&s) {
                    keep(t, k);
                }
                continue;
            }
            let length = e[0].hypot(e[1]);
            let radius = length / (2.0 * (0.5 * p.turn.abs()).sin());
            // From the chord's middle to the centre, on the left for a turn to the left of less than half a circle.
            let rise = 0.5 * length / (0.5 * p.turn).tan();
            let c = [
                0.5 * (a[0] + b[0]) - e[1] / length * rise,
                0.5 * (a[1] + b[1]) + e[0] / length * rise,
            ];
            let v = [o[0] - c[0], o[1] - c[1]];
            let dd = d[0] * d[0] + d[1] * d[1];
            let half = v[0] * d[0] + v[1] * d[1];
            let rest = if own {
                0.0
            } else {
                v[0] * v[0] + v[1] * v[1] - radius * radius
            };
            let root = (half * half - dd * rest).sqrt();
            for t in [(-half - root) / dd, (-half + root) / dd] {
                if own && t.abs() < 1e-9 * radius {
                    continue;
                }
                let h = [o[0] + d[0] * t, o[1] + d[1] * t];
                // An arc to the left lies on the right of its chord.
                let side = e[0] * (h[1] - a[1]) - e[1] * (h[0] - a[0]);
                if side * p.turn <= 0.0 {
                    keep(t, k);
                }
            }
        }
    }
    best
}
