//! Symmetries of samples: which measured directions stand for others.

use std::f64::consts::{FRAC_PI_2, PI};

use super::SAME;
use super::distribution::Distribution;
use crate::bsdf::Turn;

/// Which measured distribution, and which of the turns, a distribution came from.
#[derive(Debug, Clone, Copy)]
pub struct Origin {
    source: usize,
    /// Number of the turn, 0 for none. Every turn undoes itself, and two of three make the third: as bits do.
    turn: u8,
}

impl Origin {
    /// The pair as its first one sees it: pairs that are alike here are turned into each other.
    pub fn pair(self, other: Self) -> (usize, usize, u8) {
        (self.source, other.source, self.turn ^ other.turn)
    }
}

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
    /// rising. With each its origin; one of a chain is its own.
    pub fn complete(self, measured: &[Distribution]) -> (Vec<Distribution>, Vec<Origin>) {
        if self == Self::Isotropic {
            let all = chain(measured);
            let origins = (0..all.len()).map(|source| Origin { source, turn: 0 }).collect();
            return (all, origins);
        }
        let mut all = measured.to_vec();
        let mut origins: Vec<Origin> = (0..all.len()).map(|source| Origin { source, turn: 0 }).collect();
        for (turn, number) in self.turns().into_iter().zip(1..) {
            for (source, distribution) in measured.iter().enumerate() {
                let incident = turn.apply(distribution.incident);
                let apart = |d: &Distribution| (d.incident.x - incident.x).hypot(d.incident.y - incident.y) > SAME;
                if all.iter().all(apart) {
                    all.push(distribution.turned(turn));
                    origins.push(Origin { source, turn: number });
                }
            }
        }
        (all, origins)
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
