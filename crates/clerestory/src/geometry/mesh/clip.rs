//! What of a shape lies in a cell.

use super::shape::Shape;
use crate::geometry::Vec3;

/// Bounds of the part of a shape that lies within limits along x and y; none where it has no such part. Curved shapes are
/// taken by their own bounds.
pub(super) fn bounds(shape: &Shape, limits: [[f64; 2]; 2]) -> Option<[Vec3; 2]> {
    let [mut low, mut high] = shape.bounds();
    let [[x0, x1], [y0, y1]] = limits;
    if low.x > x1 || high.x < x0 || low.y > y1 || high.y < y0 {
        return None;
    }
    let inside = low.x >= x0 && high.x <= x1 && low.y >= y0 && high.y <= y1;
    if let (Shape::Triangle(corners), false) = (shape, inside) {
        let mut polygon = corners.to_vec();
        for (axis, [from, to]) in limits.into_iter().enumerate() {
            let at = |p: Vec3| if axis == 0 { p.x } else { p.y };
            polygon = halved(&polygon, |p| at(p) - from);
            polygon = halved(&polygon, |p| to - at(p));
        }
        let first = *polygon.first()?;
        (low, high) = (first, first);
        for p in polygon {
            low = Vec3::new(low.x.min(p.x), low.y.min(p.y), low.z.min(p.z));
            high = Vec3::new(high.x.max(p.x), high.y.max(p.y), high.z.max(p.z));
        }
    }
    Some([
        Vec3::new(low.x.max(x0), low.y.max(y0), low.z),
        Vec3::new(high.x.min(x1), high.y.min(y1), high.z),
    ])
}

/// The part of a convex polygon where a linear function is not below 0 (Sutherland, Hodgman 1974).
fn halved(polygon: &[Vec3], value: impl Fn(Vec3) -> f64) -> Vec<Vec3> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, &p) in polygon.iter().enumerate() {
        let next = polygon[(k + 1) % polygon.len()];
        let (v, w) = (value(p), value(next));
        if v >= 0.0 {
            kept.push(p);
        }
        if (v < 0.0) != (w < 0.0) {
            kept.push(p + (next - p) * (v / (v - w)));
        }
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_long_triangle_is_cut_to_its_part() {
        let triangle = Shape::Triangle([
            Vec3::new(-1.0, 0.0, 0.0),
            Vec3::new(3.0, 0.0, 4.0),
            Vec3::new(-1.0, 0.5, 0.0),
        ]);
        let [low, high] = bounds(&triangle, [[0.0, 1.0], [-1.0, 1.0]]).expect("there is a part");
        assert_eq!((low, high), (Vec3::new(0.0, 0.0, 1.0), Vec3::new(1.0, 0.375, 2.0)));
        assert!(bounds(&triangle, [[0.0, 1.0], [0.4, 1.0]]).is_none());
        assert!(bounds(&triangle, [[4.0, 5.0], [0.0, 1.0]]).is_none());
    }
}
