//! What an eye sees, as Radiance's `VIEW=` lines and view files say it.

use std::fmt;

use super::projection::Projection;
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// Place, direction and size of a picture. The world's frame has x to the east, y to the north, z up.
///
/// The values are as given; [`super::Camera::new`] checks them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// Kind of picture.
    pub projection: Projection,
    /// Where the eye is (metres).
    pub point: Vec3,
    /// Line of sight, of any length.
    pub direction: Vec3,
    /// What is upright in the picture, of any length.
    pub up: Vec3,
    /// Horizontal size (degrees; metres for a parallel view).
    pub horizontal: f64,
    /// Vertical size (degrees; metres for a parallel view).
    pub vertical: f64,
    /// Shift of the picture to the right, in widths.
    pub shift: f64,
    /// Shift of the picture upward, in heights.
    pub lift: f64,
    /// Distance before which nothing is seen (metres).
    pub fore: f64,
    /// Distance beyond which nothing is seen (metres); 0 for none.
    pub aft: f64,
}

impl Default for View {
    /// Radiance's: a perspective of 45° to the north.
    fn default() -> Self {
        Self {
            projection: Projection::Perspective,
            point: Vec3::default(),
            direction: Vec3::new(0.0, 1.0, 0.0),
            up: Vec3::new(0.0, 0.0, 1.0),
            horizontal: 45.0,
            vertical: 45.0,
            shift: 0.0,
            lift: 0.0,
            fore: 0.0,
            aft: 0.0,
        }
    }
}

impl View {
    /// An angular fisheye of 180°, as glare is evaluated on.
    pub fn fisheye(point: Vec3, direction: Vec3) -> Self {
        Self {
            projection: Projection::Angular,
            point,
            direction,
            horizontal: 180.0,
            vertical: 180.0,
            ..Self::default()
        }
    }

    /// A view from options such as `-vta -vp 0 0 1.2 -vd 0 1 0`; what is not given is the default's.
    pub fn parse(options: &str) -> Result<Self> {
        let mut view = Self::default();
        view.update(options)?;
        Ok(view)
    }

    /// Overrides what a line of options gives. Words that are no options of a view, such as a program's name and its other
    /// options, are passed over. Gives how many options it found.
    pub fn update(&mut self, options: &str) -> Result<usize> {
        let mut words = options.split_ascii_whitespace();
        let mut found = 0;
        while let Some(word) = words.next() {
            let Some(name) = word.strip_prefix("-v") else { continue };
            let mut next = |what: &str| number(words.next(), word, what);
            match name {
                "p" => self.point = Vec3::new(next("x")?, next("y")?, next("z")?),
                "d" => self.direction = Vec3::new(next("x")?, next("y")?, next("z")?),
                "u" => self.up = Vec3::new(next("x")?, next("y")?, next("z")?),
                "h" => self.horizontal = next("a size")?,
                "v" => self.vertical = next("a size")?,
                "s" => self.shift = next("a shift")?,
                "l" => self.lift = next("a lift")?,
                "o" => self.fore = next("a distance")?,
                "a" => self.aft = next("a distance")?,
                "t" => {
                    let letter = words.next().unwrap_or_default();
                    self.projection = Projection::of_letter(only(letter))?;
                }
                _ => match name.strip_prefix('t') {
                    Some(letter) => self.projection = Projection::of_letter(only(letter))?,
                    None => continue,
                },
            }
            found += 1;
        }
        Ok(found)
    }
}

/// The letter that a word consists of, or something that is no view type.
fn only(word: &str) -> char {
    let mut letters = word.chars();
    match (letters.next(), letters.next()) {
        (Some(letter), None) => letter,
        _ => '?',
    }
}

fn number(word: Option<&str>, option: &str, what: &str) -> Result<f64> {
    let word = word.ok_or_else(|| {
        Error::Argument(format!(
            "the view option {option} ends before {what} (give the missing number)"
        ))
    })?;
    word.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| {
        Error::Argument(format!(
            "the view option {option} is followed by {word:?}, which is not {what} (give a finite number)"
        ))
    })
}

impl fmt::Display for View {
    /// As options, in the order of Radiance's own lines; no digit is lost.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Vec3 { x, y, z } = self.point;
        write!(f, "-vt{} -vp {x} {y} {z}", self.projection.letter())?;
        let Vec3 { x, y, z } = self.direction;
        write!(f, " -vd {x} {y} {z}")?;
        let Vec3 { x, y, z } = self.up;
        write!(f, " -vu {x} {y} {z} -vh {} -vv {}", self.horizontal, self.vertical)?;
        write!(
            f,
            " -vo {} -va {} -vs {} -vl {}",
            self.fore, self.aft, self.shift, self.lift
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_options_override_and_others_are_passed_over() {
        let mut view = View::parse("rpict -vta -vp 1 2 3 -vd 0 0 -1 -vu 0 1 0 -vh 180 -vv 170 -ab 3 -x 800").unwrap();
        assert_eq!(view.projection, Projection::Angular);
        assert_eq!(view.point, Vec3::new(1.0, 2.0, 3.0));
        assert_eq!((view.horizontal, view.vertical, view.shift), (180.0, 170.0, 0.0));
        assert_eq!(view.update("-vt h -vs 0.5 -vl -1e-1 -vo 0.1 -va 9").unwrap(), 5);
        assert_eq!(view.projection, Projection::Hemispherical);
        assert_eq!(view.direction, Vec3::new(0.0, 0.0, -1.0));
        assert_eq!((view.shift, view.lift, view.fore, view.aft), (0.5, -0.1, 0.1, 9.0));
        assert_eq!(view.update("rpict -ab 3").unwrap(), 0);
    }

    #[test]
    fn text_keeps_every_digit() {
        let view = View {
            direction: Vec3::new(1.0 / 3.0, -1e-12, 7e5),
            horizontal: 0.1 + 0.2,
            ..View::fisheye(Vec3::new(0.1, 1e9, -3.0), Vec3::default())
        };
        assert_eq!(View::parse(&view.to_string()).unwrap(), view);
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (options, words) in [
            ("-vp 1 2", "-vp ends before z"),
            ("-vh wide", "\"wide\""),
            ("-vh inf", "\"inf\""),
            ("-vtx", "'x' is not known"),
            ("-vt", "'?' is not known"),
            ("-vtah", "'?' is not known"),
        ] {
            let text = View::parse(options).unwrap_err().to_string();
            assert!(text.contains(words) && text.contains("give"), "{text}");
        }
    }
}
