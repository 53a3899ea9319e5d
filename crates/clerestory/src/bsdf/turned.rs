//! A sample turned in its plane or mirrored: exact for every model, since only the directions change.

use std::sync::Arc;

use super::{Estimate, Model, Part, Peak, Region, Sample, Scatterer};
use crate::direction::Disk;

/// A mirror image (left to right, x to −x) if asked for, then a turn counter-clockwise as seen from the room.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Turn {
    angle: f64,
    sin: f64,
    cos: f64,
    mirror: bool,
}

impl Turn {
    /// Leaves all as it is.
    pub const NONE: Self = Self {
        angle: 0.0,
        sin: 0.0,
        cos: 1.0,
        mirror: false,
    };

    /// Mirror (or not), then turn by `angle` (radians).
    pub fn new(angle: f64, mirror: bool) -> Self {
        let (sin, cos) = angle.sin_cos();
        Self {
            angle,
            sin,
            cos,
            mirror,
        }
    }

    /// Angle (radians).
    pub fn angle(self) -> f64 {
        self.angle
    }

    /// Whether it mirrors first.
    pub fn mirror(self) -> bool {
        self.mirror
    }

    /// The turned point.
    pub fn apply(self, point: Disk) -> Disk {
        let x = if self.mirror { -point.x } else { point.x };
        Disk { x, y: point.y }.turned(self.sin, self.cos)
    }

    /// What undoes it. A mirrored turn undoes itself.
    #[must_use]
    pub fn inverse(self) -> Self {
        if self.mirror {
            self
        } else {
            Self::new(-self.angle, false)
        }
    }

    /// This turn after `first`.
    #[must_use]
    pub fn after(self, first: Self) -> Self {
        let angle = if self.mirror { -first.angle } else { first.angle };
        Self::new(self.angle + angle, self.mirror != first.mirror)
    }
}

/// Another model, turned.
#[derive(Debug, Clone)]
pub struct Turned {
    base: Arc<Model>,
    turn: Turn,
}

impl Turned {
    /// `base` turned by `turn`.
    pub fn new(base: Arc<Model>, turn: Turn) -> Self {
        Self { base, turn }
    }

    /// The model before it is turned.
    pub fn base(&self) -> &Arc<Model> {
        &self.base
    }

    /// How it is turned.
    pub fn turn(&self) -> Turn {
        self.turn
    }

    fn back(&self, point: Disk) -> Disk {
        self.turn.inverse().apply(point)
    }
}

impl Scatterer for Turned {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.base.evaluate(self.back(incident), self.back(outgoing))
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        let mut peaks = self.base.peaks(self.back(incident));
        for peak in &mut peaks {
            peak.outgoing = self.turn.apply(peak.outgoing);
        }
        peaks
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        let mut sample = self.base.sample(self.back(incident), u)?;
        sample.outgoing = self.turn.apply(sample.outgoing);
        Some(sample)
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        self.base.pdf(self.back(incident), self.back(outgoing))
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        self.base.total(self.back(incident), part)
    }

    fn weight(&self, incident: Disk) -> f64 {
        self.base.weight(self.back(incident))
    }

    fn integrate(&self, incident: Disk, region: &Region, part: Part) -> Estimate {
        let region = match region {
            Region::Hemisphere => Region::Hemisphere,
            &Region::Cone { axis, half_angle } => Region::Cone {
                axis: self.back(axis),
                half_angle,
            },
            &Region::Ring { axis, inner, outer } => Region::Ring {
                axis: self.back(axis),
                inner,
                outer,
            },
            Region::Patches { basis, patches, turn } => Region::Patches {
                basis: basis.clone(),
                patches: patches.clone(),
                turn: self.turn.inverse().after(*turn),
            },
        };
        self.base.integrate(self.back(incident), &region, part)
    }

    fn resolution(&self, incident: Disk) -> f64 {
        self.base.resolution(self.back(incident))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_compose_and_invert() {
        let p = Disk::new(0.3, -0.5);
        for a in [Turn::new(0.4, false), Turn::new(1.1, true)] {
            let back = a.inverse().apply(a.apply(p));
            assert!((back.x - p.x).abs() < 1e-14 && (back.y - p.y).abs() < 1e-14);
            for b in [Turn::new(-0.7, false), Turn::new(2.0, true)] {
                let (one, two) = (b.after(a).apply(p), b.apply(a.apply(p)));
                assert!((one.x - two.x).abs() < 1e-14 && (one.y - two.y).abs() < 1e-14);
            }
        }
    }
}
