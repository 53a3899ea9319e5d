//! How an instrument works: how long, how exactly, with which openings.

use std::f64::consts::TAU;

use super::flight::Limits;
use crate::direction::{Disk, Side};
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// When enough paths were traced for an incident patch (or direction, or cell) and side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Stop {
    /// After so many paths, rounded up to a multiple of the replications. Powers of two times the replications are spread
    /// best.
    Paths(u64),
    /// When the standard error of each direct-hemispherical value is at most `error` times the value, or times
    /// [`LEAST_VALUE`] where it is less.
    Error {
        /// Relative standard error.
        error: f64,
        /// No more paths than these; where they do not suffice, the result's warnings say so.
        most: u64,
    },
}

/// Direct-hemispherical values below this need the absolute error of this one only.
pub const LEAST_VALUE: f64 = 0.01;

/// Opening angles of the source and of the detector, as instruments quote them: the *full* angle of the cone (radians). 0 is
/// a perfect instrument.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Cones {
    /// Light comes evenly from a cone about the nominal direction of each incident patch; with 0 from the whole patch.
    pub source: f64,
    /// Each path is seen evenly in a cone about its direction.
    pub detector: f64,
}

/// How a measurement is done.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Sides that light comes from.
    pub sides: Vec<Side>,
    /// How long.
    pub stop: Stop,
    /// Independent repetitions; their scatter gives the standard errors.
    pub replications: u32,
    /// Number from which all random numbers follow.
    pub seed: u64,
    /// When single paths end.
    pub limits: Limits,
    /// Openings of the instrument. With any, beams are part of the tables.
    pub cones: Cones,
    /// Whether light that leaves straight on, unscattered, becomes a beam beside the table.
    pub beams: bool,
    /// Whether each component is averaged with its reverse, as a reciprocal sample allows.
    pub reciprocal: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            sides: Side::BOTH.to_vec(),
            stop: Stop::Paths(16_384),
            replications: 16,
            seed: 0,
            limits: Limits::default(),
            cones: Cones::default(),
            beams: true,
            reciprocal: false,
        }
    }
}

/// Paths of one replication before others are asked whether to go on.
const LONGEST_ROUND: u64 = 1 << 18;
/// Paths of a replication in the first round that is to reach an error.
const FIRST_ROUND: u64 = 64;

impl Settings {
    /// Fails for what cannot be measured.
    pub fn check(&self) -> Result<()> {
        let fail = |what: String| Err(Error::Argument(what));
        if !(2..=4096).contains(&self.replications) {
            return fail(format!(
                "{} replications give no standard errors (give 2 to 4096)",
                self.replications
            ));
        }
        if self.sides.is_empty() || self.sides.len() > 2 || (self.sides.len() == 2 && self.sides[0] == self.sides[1]) {
            return fail("light must come from one side or from both (give exterior, interior or both)".into());
        }
        for (name, angle) in [("source", self.cones.source), ("detector", self.cones.detector)] {
            if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&angle) {
                return fail(format!(
                    "a {name} cone of {:.4}° cannot be (give its full opening angle, 0° to 90°)",
                    angle.to_degrees()
                ));
            }
        }
        match self.stop {
            Stop::Paths(0) => fail("no paths, no measurement (give 1 or more)".into()),
            Stop::Error { error, most } if !(error > 0.0 && error < 1.0) || most == 0 => fail(format!(
                "an error of {error} with at most {most} paths cannot be aimed at (give an error between 0 and 1, such as \
                 0.005)"
            )),
            _ => Ok(()),
        }
    }

    /// Whether beams are kept apart.
    pub fn keeps_beams(&self) -> bool {
        self.beams && self.cones == Cones::default()
    }

    /// Paths a replication of the next round after `paths` in all; none where it is enough. `error` is the present one over
    /// the one that is asked for.
    pub(super) fn next_round(&self, paths: u64, error: impl FnOnce(f64) -> f64) -> Option<u64> {
        let replications = u64::from(self.replications);
        let done = paths / replications;
        match self.stop {
            Stop::Paths(wanted) => {
                let left = wanted.div_ceil(replications).saturating_sub(done);
                (left > 0).then(|| left.min(LONGEST_ROUND))
            }
            Stop::Error { .. } if paths == 0 => Some(FIRST_ROUND),
            Stop::Error { error: aim, most } => (error(aim) > 1.0 && paths < most).then(|| done.min(LONGEST_ROUND)),
        }
    }

    /// Rounds of a unit; 1 where that depends on what comes out.
    pub(super) fn rounds(&self) -> usize {
        match self.stop {
            Stop::Paths(n) => n.div_ceil(u64::from(self.replications)).div_ceil(LONGEST_ROUND) as usize,
            Stop::Error { .. } => 1,
        }
    }
}

/// A direction of travel within a cone of half the opening `angle` about another, evenly by solid angle for uniform `u`. The
/// part below the horizon is mirrored up.
pub(super) fn within_cone(axis: Disk, angle: f64, u: [f64; 2]) -> Disk {
    if angle == 0.0 {
        return axis;
    }
    let w = Vec3::new(axis.x, axis.y, axis.cos_theta());
    let [a, b] = w.frame();
    // 1 - cos of the angle to the axis.
    let down = u[0] * 2.0 * (0.25 * angle).sin().powi(2);
    let across = (down * (2.0 - down)).sqrt();
    let (sin, cos) = (TAU * u[1]).sin_cos();
    let d = a * (across * cos) + b * (across * sin) + w * (1.0 - down);
    Disk::new(d.x, d.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::r2;

    #[test]
    fn cones_are_filled_evenly() {
        let axis = Disk::from_angles(0.6, 2.0);
        let angle = 4_f64.to_radians();
        let n = 20_000;
        let mut inner = 0;
        for k in 0..n {
            let off = axis.angle_to(within_cone(axis, angle, r2(k, [0.0; 2])));
            assert!(off < 0.5 * angle + 1e-9);
            inner += u32::from(off < 0.25 * angle);
        }
        assert!((f64::from(inner) / f64::from(n) - 0.25).abs() < 0.002);
        assert_eq!(within_cone(axis, 0.0, [0.3, 0.3]), axis);
        // At the horizon it stays on its side.
        let grazing = Disk::from_angles(1.56, 0.0);
        for k in 0..1000 {
            let point = within_cone(grazing, 0.2, r2(k, [0.0; 2]));
            assert!(point.sin2_theta() <= 1.0 && grazing.angle_to(point) < 0.11);
        }
    }

    #[test]
    fn rounds_double_until_the_error_is_reached() {
        let settings = Settings {
            stop: Stop::Error {
                error: 0.01,
                most: 16 * 1024,
            },
            ..Settings::default()
        };
        let mut paths = 0;
        while let Some(more) = settings.next_round(paths, |_| 2.0) {
            paths += 16 * more;
        }
        assert_eq!(paths, 16 * 1024);
        assert_eq!(settings.next_round(16 * 64, |aim| 0.005 / aim), None);
        let fixed = Settings {
            stop: Stop::Paths(1000),
            ..Settings::default()
        };
        assert_eq!(fixed.next_round(0, |_| 9.0), Some(63));
        assert_eq!(fixed.next_round(16 * 63, |_| 9.0), None);
    }

    #[test]
    fn what_cannot_be_measured_is_refused() {
        let broken = [
            Settings {
                replications: 1,
                ..Settings::default()
            },
            Settings {
                sides: vec![],
                ..Settings::default()
            },
            Settings {
                sides: vec![Side::Exterior; 2],
                ..Settings::default()
            },
            Settings {
                stop: Stop::Paths(0),
                ..Settings::default()
            },
            Settings {
                stop: Stop::Error { error: 0.0, most: 9 },
                ..Settings::default()
            },
            Settings {
                cones: Cones {
                    source: -0.1,
                    detector: 0.0,
                },
                ..Settings::default()
            },
            Settings {
                cones: Cones {
                    source: 0.0,
                    detector: 9.0,
                },
                ..Settings::default()
            },
        ];
        assert!(Settings::default().check().is_ok());
        assert!(broken.iter().all(|s| s.check().is_err()));
    }
}
