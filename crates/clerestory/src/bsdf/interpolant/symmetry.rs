//! Symmetries of samples: which measured directions stand for others.

use std::f64::consts::{FRAC_PI_2, PI};

use super::SAME;
use super::distribution::Distribution;
use crate::bsdf::Turn;

/// How a sample looks when it is turned or mirrored in its plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// Alike from all azimuths.
    Isotropic,
    /// Mirrored left and right, and up and down.
    Quadrilateral,
    /// Mirrored left and right: x becomes −x.
    LeftRight,
    /// Mirrored up and down: y becomes −y.
    UpDown,
    /// Turned by half a turn.
    Rotational,
    /// None.
    None,
}

impl Symmetry {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Isotropic,
        Self::Quadrilateral,
        Self::LeftRight,
        Self::UpDown,
        Self::Rotational,
        Self::None,
    ];

    /// Its word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Isotropic => "isotropic",
            Self::Quadrilateral => "quadrilateral",
            Self::LeftRight => "left-right",
            Self::UpDown => "up-down",
            Self::Rotational => "rotational",
            Self::None => "none",
        }
    }

    /// What may be done to a distribution.
    fn turns(self) -> Vec<Turn> {
        let (left_right, up_down, half) = (Turn::new(0.0, true), Turn::new(PI, true), Turn::new(PI, false));
        match self {
            Self::Isotropic | Self::None => vec![],
            Self::Quadrilateral => vec![left_right, up_down, half],
            Self::LeftRight => vec![left_right],
            Self::UpDown => vec![up_down],
            Self::Rotational => vec![half],
        }
    }

    /// Measured distributions and those that follow from them; for an isotropic sample with light that travels toward +x,
    /// rising.
    pub fn complete(self, measured: &[Distribution]) -> Vec<Distribution> {
        if self == Self::Isotropic {
            return chain(measured);
        }
        let mut all = measured.to_vec();
        for turn in self.turns() {
            for distribution in measured {
                let incident = turn.apply(distribution.incident);
                let apart = |d: &Distribution| (d.incident.x - incident.x).hypot(d.incident.y - incident.y) > SAME;
                if all.iter().all(apart) {
                    all.push(distribution.turned(turn));
                }
            }
        }
        all
    }
}

fn chain(measured: &[Distribution]) -> Vec<Distribution> {
    let mut all: Vec<Distribution> = measured
        .iter()
        .map(|d| d.turned(Turn::new(-d.incident.phi(), false)))
        .collect();
    all.sort_by(|a, b| a.incident.x.total_cmp(&b.incident.x));
    all.dedup_by(|b, a| (b.incident.x - a.incident.x).abs() < SAME);
    // Without the normal, the one nearest to it and its own mirror image are neighbours.
    if let Some(first) = all
        .first()
        .filter(|d| d.incident.x > SAME && d.incident.theta() < FRAC_PI_2)
    {
        let opposite = first.turned(Turn::new(PI, false));
        all.insert(0, opposite);
    }
    all
}
