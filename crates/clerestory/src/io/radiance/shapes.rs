//! Shapes from the real arguments of surfaces.

use super::xform::Transform;
use crate::error::{Error, Result};
use crate::geometry::{Shape, Vec3};

/// A surface's shape.
pub(super) enum Piece {
    /// Corners as they stand in the file.
    Polygon(Vec<Vec3>),
    /// Moved to where it belongs.
    Round(Shape),
}

/// Of a surface of a type, moved, its front inside out if it is inverted.
pub(super) fn piece(kind: &str, numbers: &[f64], transform: &Transform, inverted: bool) -> Result<Piece> {
    let count = |wanted: usize| {
        if numbers.len() == wanted {
            Ok(())
        } else {
            Err(Error::Argument(format!(
                "{} real arguments, not {wanted}",
                numbers.len()
            )))
        }
    };
    let point = |k: usize| Vec3::new(numbers[k], numbers[k + 1], numbers[k + 2]);
    let scale = transform.scale;
    let moved = |k: usize| transform.point(point(k));
    let radius = |r: f64| {
        if r >= 0.0 {
            Ok(r * scale)
        } else {
            Err(Error::Argument(format!("a radius of {r}")))
        }
    };
    let shape = match kind {
        "polygon" => {
            if !numbers.len().is_multiple_of(3) {
                return Err(Error::Argument(format!(
                    "{} real arguments, not three a corner",
                    numbers.len()
                )));
            }
            let corners: Vec<Vec3> = (0..numbers.len()).step_by(3).map(point).collect();
            return Ok(Piece::Polygon(corners));
        }
        "sphere" | "bubble" => {
            count(4)?;
            Shape::Sphere {
                centre: moved(0),
                radius: radius(numbers[3])?,
                inward: (kind == "bubble") != inverted,
            }
        }
        "ring" => {
            count(8)?;
            let direction = transform.vector(point(3));
            let mut radii = [radius(numbers[6])?, radius(numbers[7])?];
            radii.sort_by(f64::total_cmp);
            let normal = direction.unit();
            if !normal.x.is_finite() {
                return Err(Error::Argument("a direction of 0 0 0".into()));
            }
            Shape::Ring {
                centre: moved(0),
                normal: if inverted { -normal } else { normal },
                radii,
            }
        }
        _ => {
            let radii = if matches!(kind, "cylinder" | "tube") {
                count(7)?;
                [radius(numbers[6])?; 2]
            } else {
                count(8)?;
                [radius(numbers[6])?, radius(numbers[7])?]
            };
            Shape::Cone {
                ends: [moved(0), moved(3)],
                radii,
                inward: matches!(kind, "tube" | "cup") != inverted,
            }
        }
    };
    if let Some((what, _)) = shape.fault() {
        return Err(Error::Argument(what));
    }
    Ok(Piece::Round(shape))
}
