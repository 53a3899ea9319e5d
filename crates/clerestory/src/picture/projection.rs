//! How directions become points of a picture: Radiance's six projections (manual page of `rpict`, option `-vt`).
//!
//! Points are counted from the middle of the picture in units of its whole width and height. Directions are in the frame of
//! the eye: x to the right, y up, z along the line of sight.

use std::f64::consts::PI;

use crate::error::{Error, Result};

/// The kind of a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Projection {
    /// `v`: straight lines stay straight.
    Perspective,
    /// `l`: all rays are parallel; sizes are lengths in metres.
    Parallel,
    /// `h`: a fisheye in which equal areas are equal projected solid angles.
    Hemispherical,
    /// `a`: a fisheye in which the distance from the middle is the angle (equidistant).
    Angular,
    /// `s`: a stereographic fisheye, in which circles stay circles.
    Planispheric,
    /// `c`: angles to the left and right, straight verticals.
    Cylindrical,
}

impl Projection {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Perspective,
        Self::Parallel,
        Self::Hemispherical,
        Self::Angular,
        Self::Planispheric,
        Self::Cylindrical,
    ];

    /// The letter after `-vt`.
    pub const fn letter(self) -> char {
        match self {
            Self::Perspective => 'v',
            Self::Parallel => 'l',
            Self::Hemispherical => 'h',
            Self::Angular => 'a',
            Self::Planispheric => 's',
            Self::Cylindrical => 'c',
        }
    }

    /// Its name in words.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Perspective => "perspective",
            Self::Parallel => "parallel",
            Self::Hemispherical => "hemispherical fisheye",
            Self::Angular => "angular fisheye",
            Self::Planispheric => "planispheric fisheye",
            Self::Cylindrical => "cylindrical",
        }
    }

    /// The projection of a letter.
    pub fn of_letter(letter: char) -> Result<Self> {
        Self::ALL.into_iter().find(|p| p.letter() == letter).ok_or_else(|| {
            Error::Argument(format!(
                "the view type {letter:?} is not known (give v perspective, l parallel, h hemispherical, a angular, s \
                 planispheric or c cylindrical)"
            ))
        })
    }

    /// Largest horizontal and vertical size that it can show, and whether that itself is allowed; none for lengths.
    pub(super) const fn limits(self) -> Option<[(f64, bool); 2]> {
        match self {
            Self::Perspective => Some([(180.0, false); 2]),
            Self::Parallel => None,
            Self::Hemispherical => Some([(180.0, true); 2]),
            Self::Angular => Some([(360.0, true); 2]),
            Self::Planispheric => Some([(360.0, false); 2]),
            Self::Cylindrical => Some([(360.0, true), (180.0, false)]),
        }
    }

    /// Width and height of the whole picture on the surface that it is projected to, for its two sizes (degrees, or metres).
    pub(super) fn extent(self, horizontal: f64, vertical: f64) -> [f64; 2] {
        let both = |f: fn(f64) -> f64| [f(horizontal.to_radians()), f(vertical.to_radians())];
        match self {
            Self::Perspective => both(|a| 2.0 * (0.5 * a).tan()),
            Self::Parallel => [horizontal, vertical],
            Self::Hemispherical => both(|a| 2.0 * (0.5 * a).sin()),
            Self::Angular => both(|a| a),
            Self::Planispheric => both(|a| 2.0 * (0.25 * a).tan()),
            Self::Cylindrical => [horizontal.to_radians(), 2.0 * (0.5 * vertical.to_radians()).tan()],
        }
    }

    /// Direction for a point of the surface (units of [`Projection::extent`]), of any length; None where there is none.
    pub(super) fn direction(self, [x, y]: [f64; 2]) -> Option<[f64; 3]> {
        match self {
            Self::Perspective => Some([x, y, 1.0]),
            Self::Parallel => Some([0.0, 0.0, 1.0]),
            Self::Hemispherical => {
                let z2 = 1.0 - x * x - y * y;
                (z2 >= 0.0).then(|| [x, y, z2.sqrt()])
            }
            Self::Angular => {
                let angle = x.hypot(y);
                if angle > PI {
                    return None;
                }
                let (sine, cosine) = angle.sin_cos();
                let scale = if angle > 0.0 { sine / angle } else { 1.0 };
                Some([x * scale, y * scale, cosine])
            }
            Self::Planispheric => {
                let d = x * x + y * y;
                Some([2.0 * x, 2.0 * y, 1.0 - d])
            }
            Self::Cylindrical => (x.abs() <= PI * (1.0 + 1e-12)).then(|| [x.sin(), y, x.cos()]),
        }
    }

    /// Point of the surface for a direction of length 1; None where it has none, or no single one.
    pub(super) fn point(self, [x, y, z]: [f64; 3]) -> Option<[f64; 2]> {
        match self {
            Self::Perspective => (z > 0.0).then(|| [x / z, y / z]),
            Self::Parallel => None,
            Self::Hemispherical => (z >= 0.0).then_some([x, y]),
            Self::Angular => {
                let sine = x.hypot(y);
                let scale = if sine > 0.0 { sine.atan2(z) / sine } else { 1.0 };
                (sine > 0.0 || z > 0.0).then_some([x * scale, y * scale])
            }
            Self::Planispheric => (z > -1.0).then(|| [x / (1.0 + z), y / (1.0 + z)]),
            Self::Cylindrical => {
                let flat = x.hypot(z);
                (flat > 0.0).then(|| [x.atan2(z), y / flat])
            }
        }
    }

    /// Solid angle for an area of the surface at a point; 0 where there is no direction.
    pub(super) fn density(self, [x, y]: [f64; 2]) -> f64 {
        let d = x * x + y * y;
        match self {
            Self::Perspective => (1.0 + d).powf(-1.5),
            Self::Parallel => 0.0,
            Self::Hemispherical => {
                if d < 1.0 {
                    1.0 / (1.0 - d).sqrt()
                } else {
                    0.0
                }
            }
            Self::Angular => {
                let angle = d.sqrt();
                if angle > PI {
                    0.0
                } else if angle > 0.0 {
                    angle.sin() / angle
                } else {
                    1.0
                }
            }
            Self::Planispheric => 4.0 / ((1.0 + d) * (1.0 + d)),
            Self::Cylindrical => (1.0 + y * y).powf(-1.5),
        }
    }
}
