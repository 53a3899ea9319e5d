//! What is wrong with a scene, told before any ray is sent.

use super::Extent;
use super::scene::{Element, Scene};
use super::shape::Shape;
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// A triangle is degenerate if its height is less than this share of its longest side.
const FLAT: f64 = 1e-12;

/// The limits that a scene is looked at in.
pub(super) fn extents(extents: &[Extent; 2]) -> Result<()> {
    for (Extent { limits, repeated }, axis) in extents.iter().zip(["x", "y"]) {
        let length = limits[1] - limits[0];
        if !(limits.iter().all(|l| l.is_finite()) && length > 0.0) {
            let what = if *repeated {
                "period"
            } else {
                "length of the sampled area"
            };
            return Err(Error::Argument(format!(
                "a {what} of {length} m along {axis}, from {} to {} (give one above 0)",
                limits[0], limits[1]
            )));
        }
    }
    Ok(())
}

/// Coordinates that are no numbers, triangles without area, radii that are not above 0.
pub(super) fn elements(scene: &Scene) -> Result<()> {
    for (number, Element { shape, .. }) in scene.elements.iter().enumerate() {
        let Some((what, remedy)) = shape.fault() else { continue };
        return Err(Error::Argument(format!("{} {what} ({remedy})", scene.name(number))));
    }
    Ok(())
}

impl Shape {
    /// What is wrong with its numbers, and what to do about it.
    pub(crate) fn fault(&self) -> Option<(String, &'static str)> {
        // Beyond this, products of coordinates overflow.
        let sound = |p: &Vec3| p.array().iter().all(|x| x.abs() < 1e30);
        let points: &[Vec3] = match self {
            Shape::Triangle(corners) => corners,
            Shape::Sphere { centre, .. } | Shape::Ring { centre, .. } => &[*centre],
            Shape::Cone { ends, .. } => ends,
        };
        if let Some(p) = points.iter().find(|p| !sound(p)) {
            return Some((
                format!("has a point at {}, which cannot be", at(*p)),
                "repair the file it comes from",
            ));
        }
        let radii = |radii: &[f64], least: f64| {
            let bad = radii.iter().find(|r| !(**r >= 0.0 && **r < 1e30));
            let bad = bad.or_else(|| {
                radii
                    .iter()
                    .find(|_| radii.iter().copied().fold(0.0, f64::max) <= least)
            });
            bad.map(|r| (format!("has a radius of {r} m"), "give radii above 0"))
        };
        match self {
            Shape::Triangle([a, b, c]) => {
                let sides = [*b - *a, *c - *b, *a - *c];
                let longest = sides.iter().map(|s| s.length()).fold(0.0, f64::max);
                let twice_area = sides[0].cross(sides[1]).length();
                (twice_area <= FLAT * longest * longest).then(|| {
                    (
                        format!("has no area: corners at {}, {} and {}", at(*a), at(*b), at(*c)),
                        "remove it, or merge its corners",
                    )
                })
            }
            Shape::Sphere { radius, .. } => radii(&[*radius], 0.0),
            Shape::Ring { normal, radii: r, .. } => {
                if (normal.length() - 1.0).abs() > 1e-9 {
                    return Some((
                        format!("has a direction of length {}", normal.length()),
                        "give a direction that is not 0 0 0",
                    ));
                }
                radii(r, 0.0).or_else(|| {
                    (r[0] >= r[1]).then(|| {
                        (
                            format!("has an inner radius of {} m and an outer one of {} m", r[0], r[1]),
                            "make the outer one greater",
                        )
                    })
                })
            }
            Shape::Cone { ends, radii: r, .. } => {
                let length = (ends[1] - ends[0]).length();
                if length <= 0.0 {
                    return Some((format!("has both ends at {}", at(ends[0])), "move one of them"));
                }
                radii(r, 0.0)
            }
        }
    }
}

/// A point in words: metres, as few digits as tell it.
pub(super) fn at(p: Vec3) -> String {
    let short = |x: f64| {
        let rounded = format!("{x:.6e}").parse::<f64>().unwrap_or(x);
        format!("{rounded}")
    };
    format!("({}, {}, {}) m", short(p.x), short(p.y), short(p.z))
}
