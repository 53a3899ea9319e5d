//! What a piece is made of for the intersection: arcs of a quarter turn at most, and straight parts.

use std::f64::consts::FRAC_PI_2;

use super::Piece;

/// A straight part, or an arc of a quarter turn at most. With p the way from its middle, n the unit vector to the left of
/// its chord and κ its curvature, its points are those of κ p²/2 = n·p near the middle; a straight part has κ = 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Part {
    /// Its ends, (z, y) in metres.
    pub ends: [[f64; 2]; 2],
    /// Its middle: where an arc is farthest from its chord.
    pub middle: [f64; 2],
    /// Unit vector to the left of the chord's way: out of the front.
    pub normal: [f64; 2],
    /// Half of the chord (metres).
    pub half: f64,
    /// Signed curvature (1/m), positive where the way turns to the left.
    pub curvature: f64,
    /// Least and greatest z.
    pub z: [f64; 2],
    /// Least and greatest y.
    pub y: [f64; 2],
    /// Number of the surface in the sample's list.
    pub surface: u32,
    /// The piece that it is part of.
    pub piece: u32,
}

/// Arcs that turn less are straight for all that can be computed.
const STRAIGHT: f64 = 1e-9;

impl Part {
    /// Parts of a piece, which must be sound.
    pub fn of(number: usize, piece: &Piece) -> Vec<Self> {
        if piece.turn.abs() < STRAIGHT {
            return vec![Self::new(number, piece, [piece.from, piece.to], 0.0)];
        }
        let whole = Self::new(number, piece, [piece.from, piece.to], piece.turn);
        let count = (piece.turn.abs() / (FRAC_PI_2 * 1.000_001)).ceil().max(1.0);
        if count <= 1.0 {
            return vec![whole];
        }
        let centre = whole.centre();
        let at = |k: f64| {
            let (sin, cos) = (piece.turn * k / count).sin_cos();
            let [z, y] = [piece.from[0] - centre[0], piece.from[1] - centre[1]];
            [centre[0] + cos * z - sin * y, centre[1] + sin * z + cos * y]
        };
        let mut parts = Vec::with_capacity(count as usize);
        let mut from = piece.from;
        for k in 1..=count as u32 {
            let to = if f64::from(k) < count {
                at(f64::from(k))
            } else {
                piece.to
            };
            parts.push(Self::new(number, piece, [from, to], piece.turn / count));
            from = to;
        }
        parts
    }

    fn new(number: usize, piece: &Piece, ends: [[f64; 2]; 2], turn: f64) -> Self {
        let [a, b] = ends;
        let chord = [b[0] - a[0], b[1] - a[1]];
        let length = chord[0].hypot(chord[1]);
        let normal = [-chord[1] / length, chord[0] / length];
        let rise = 0.5 * length * (0.25 * turn).tan();
        let middle = [
            a[0] + 0.5 * chord[0] - normal[0] * rise,
            a[1] + 0.5 * chord[1] - normal[1] * rise,
        ];
        let mut part = Self {
            ends,
            middle,
            normal,
            half: 0.5 * length,
            curvature: 2.0 * (0.5 * turn).sin() / length,
            z: [a[0].min(b[0]), a[0].max(b[0])],
            y: [a[1].min(b[1]), a[1].max(b[1])],
            surface: piece.surface,
            piece: number as u32,
        };
        if turn != 0.0 {
            part.bulge(turn);
        }
        part
    }

    /// Widens the limits to the points of an arc that are farthest along each axis.
    fn bulge(&mut self, turn: f64) {
        let centre = self.centre();
        let radius = 1.0 / self.curvature.abs();
        if turn.abs() > 3.0 {
            // Only for the centre of a piece that is cut: its limits are not used.
            return;
        }
        for (axis, direction) in [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)] {
            let mut tip = [0.0; 2];
            tip[axis] = direction * radius;
            let p = [centre[0] + tip[0] - self.middle[0], centre[1] + tip[1] - self.middle[1]];
            if self.covers(p, 0.0) {
                let limits = if axis == 0 { &mut self.z } else { &mut self.y };
                let at = centre[axis] + tip[axis];
                *limits = [limits[0].min(at), limits[1].max(at)];
            }
        }
    }

    /// Centre of an arc's circle.
    pub fn centre(&self) -> [f64; 2] {
        [
            self.middle[0] + self.normal[0] / self.curvature,
            self.middle[1] + self.normal[1] / self.curvature,
        ]
    }

    /// Unit vector along the chord.
    pub fn along(&self) -> [f64; 2] {
        [self.normal[1], -self.normal[0]]
    }

    /// Whether a point of its line or circle, at `p` from its middle, is one of its own, or is beyond its ends by not more
    /// than a length.
    pub fn covers(&self, p: [f64; 2], beyond: f64) -> bool {
        let [z, y] = self.along();
        let (u, v) = (z * p[0] + y * p[1], self.normal[0] * p[0] + self.normal[1] * p[1]);
        u.abs() <= self.half + beyond && self.curvature * v < 1.0
    }

    /// Unit normal out of the front at `p` from its middle.
    pub fn normal_at(&self, p: [f64; 2]) -> [f64; 2] {
        [
            self.normal[0] - self.curvature * p[0],
            self.normal[1] - self.curvature * p[1],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn piece(turn: f64) -> Piece {
        Piece {
            from: [1.0, 0.0],
            to: [-1.0, 0.0],
            turn,
            surface: 3,
        }
    }

    #[test]
    fn a_half_circle_is_cut_in_quarters_that_join() {
        let parts = Part::of(7, &piece(std::f64::consts::PI));
        assert_eq!(parts.len(), 2);
        assert_eq!(parts[0].ends[1], parts[1].ends[0]);
        assert_eq!((parts[0].ends[0], parts[1].ends[1]), ([1.0, 0.0], [-1.0, 0.0]));
        // Counter-clockwise from (1, 0): over the top.
        assert!((parts[0].ends[1][1] - 1.0).abs() < 1e-15 && parts[0].ends[1][0].abs() < 1e-15);
        for part in &parts {
            assert!((part.curvature - 1.0).abs() < 1e-15);
            assert!(part.centre()[0].abs() < 1e-15 && part.centre()[1].abs() < 1e-15);
            assert!((part.y[0].abs() < 1e-15) && (part.y[1] - 1.0).abs() < 1e-15);
        }
        let other = Part::of(7, &piece(-std::f64::consts::PI));
        assert!((other[0].ends[1][1] + 1.0).abs() < 1e-15);
    }

    #[test]
    fn shallow_arcs_reach_to_their_middle() {
        let parts = Part::of(0, &piece(1.0));
        assert_eq!(parts.len(), 1);
        let rise = 0.25_f64.tan();
        assert!((parts[0].y[1] - rise).abs() < 1e-15 && parts[0].y[0] == 0.0);
        // The front is on the left of the way: below, towards the centre.
        assert!((parts[0].normal_at([0.0; 2])[1] + 1.0).abs() < 1e-15);
    }

    #[test]
    fn three_quarters_of_a_circle() {
        let parts = Part::of(0, &piece(1.5 * std::f64::consts::PI));
        assert_eq!(parts.len(), 3);
        let highest = parts.iter().map(|p| p.y[1]).fold(0.0, f64::max);
        assert!((highest - (1.0 + 2.0_f64.sqrt())).abs() < 1e-14, "{highest}");
    }
}
