//! Extruded sections: infinite in x, repeated in y, made of straight segments and exact circular arcs in the (z, y) plane.

use super::{Area, Geometry, Hit, Meeting, NO_PIECE, Ray, Vec3};
use crate::error::{Error, Result};

/// A stretch of a section, from one end to the other. Its front is on the left of the way from `from` to `to`, seen with z
/// to the right and y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// First end, (z, y) in metres.
    pub from: [f64; 2],
    /// Last end, (z, y) in metres.
    pub to: [f64; 2],
    /// Angle that the way turns through (radians), counter-clockwise positive, less than 2π; 0 for a straight segment.
    pub turn: f64,
    /// Number of its surface in the sample's list.
    pub surface: u32,
}

/// A periodic section.
#[derive(Debug, Clone)]
pub struct Profile {
    pieces: Vec<Piece>,
    period: f64,
    depth: [f64; 2],
}

impl Profile {
    /// From pieces within one period and its height (metres). Pieces may reach beyond it.
    pub fn new(pieces: Vec<Piece>, period: f64) -> Result<Self> {
        if !(period.is_finite() && period > 0.0) {
            return Err(Error::Argument(format!("a period of {period} m (give one above 0)")));
        }
        if let Some(piece) = pieces.iter().find(|p| p.turn != 0.0) {
            return Err(Error::Unsupported(format!("arcs, as from {:?}", piece.from)));
        }
        let zs = || pieces.iter().flat_map(|p| [p.from[0], p.to[0]]);
        let depth = [zs().fold(0.0, f64::min), zs().fold(0.0, f64::max)];
        Ok(Self { pieces, period, depth })
    }
}

impl Geometry for Profile {
    fn depth(&self) -> [f64; 2] {
        self.depth
    }

    fn period(&self) -> [f64; 2] {
        [0.0, self.period]
    }

    fn area(&self) -> Area {
        Area {
            x: [0.0, 0.0],
            y: [0.0, self.period],
        }
    }

    fn meet(&self, ray: &mut Ray) -> Meeting {
        // The ray in the section: way per unit of length along z and y.
        let (dz, dy) = (ray.direction.z, ray.direction.y);
        let mut best: Option<(f64, usize)> = None;
        let (low, high) = (self.depth[0], self.depth[1]);
        let far = if dz > 0.0 {
            (high - ray.origin.z) / dz
        } else {
            (low - ray.origin.z) / dz
        };
        if !far.is_finite() {
            return Meeting::Lost;
        }
        let y_end = ray.origin.y + dy * far.max(0.0);
        let reach = |y: f64| (y / self.period).floor();
        let (first, last) = (
            reach(ray.origin.y.min(y_end)) - 2.0,
            reach(ray.origin.y.max(y_end)) + 2.0,
        );
        if last - first > 1e6 {
            return Meeting::Lost;
        }
        let mut cell = first;
        while cell <= last {
            for (k, p) in self.pieces.iter().enumerate() {
                let own = ray.piece == k as u32 && cell == 0.0;
                let (ez, ey) = (p.to[0] - p.from[0], p.to[1] - p.from[1]);
                let (oz, oy) = (p.from[0] - ray.origin.z, p.from[1] + cell * self.period - ray.origin.y);
                let det = dz * ey - dy * ez;
                let t = (oz * ey - oy * ez) / det;
                let s = (oz * dy - oy * dz) / det;
                if !own && t > 0.0 && (0.0..=1.0).contains(&s) && best.is_none_or(|(b, _)| t < b) {
                    best = Some((t, k));
                }
            }
            cell += 1.0;
        }
        let Some((t, k)) = best else { return Meeting::Leaves };
        let p = self.pieces[k];
        let (ez, ey) = (p.to[0] - p.from[0], p.to[1] - p.from[1]);
        ray.origin += ray.direction * t;
        // The piece is met in the cell where it lies by definition.
        let share = if ez.abs() > ey.abs() {
            (ray.origin.z - p.from[0]) / ez
        } else {
            0.5
        };
        let y = p.from[1] + share * ey;
        ray.origin.y -= ((ray.origin.y - y) / self.period).round() * self.period;
        ray.piece = k as u32;
        Meeting::Hit(Hit {
            distance: t,
            normal: Vec3::new(0.0, ez, -ey).unit(),
            surface: p.surface,
        })
    }
}

const _: u32 = NO_PIECE;
