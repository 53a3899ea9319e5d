//! Plane polygons: their triangles, and points on them.

use crate::error::{Error, Result};
use crate::geometry::{Scene, Shape, Vec3};

/// A plane polygon without holes; its front is where its corners run counter-clockwise.
#[derive(Debug, Clone)]
pub struct Polygon {
    corners: Vec<Vec3>,
    normal: Vec3,
    triangles: Vec<[Vec3; 3]>,
    /// Area of the triangles up to and with each (m²).
    areas: Vec<f64>,
}

/// Corners may lie this far (relative to the greatest length) off the plane.
const FLAT: f64 = 1e-4;

impl Polygon {
    /// From its corners (metres); `name` is for messages.
    pub fn new(name: &str, corners: Vec<Vec3>) -> Result<Self> {
        let wrong = |text: String| Err(Error::Argument(format!("{name}: {text}")));
        if corners.len() < 3 {
            return wrong(format!("{} corners (give three or more)", corners.len()));
        }
        if !corners.iter().flat_map(|c| c.array()).all(f64::is_finite) {
            return wrong("a corner is not finite (give numbers in metres)".into());
        }
        let next = |k: usize| corners[(k + 1) % corners.len()];
        let twice = (0..corners.len()).fold(Vec3::default(), |sum, k| {
            sum + (corners[k] - corners[0]).cross(next(k) - corners[0])
        });
        let size = corners.iter().map(|c| (*c - corners[0]).length()).fold(0.0, f64::max);
        if twice.length() <= 1e-9 * size * size {
            return wrong("it has no area (give corners in order round it)".into());
        }
        let normal = twice.unit();
        for (k, corner) in corners.iter().enumerate() {
            let off = (*corner - corners[0]).dot(normal).abs();
            if off > FLAT * size {
                return wrong(format!(
                    "it is not flat: corner {} lies {:.4} m off the plane of the others (split it into flat parts)",
                    k + 1,
                    off
                ));
            }
        }
        let crossed = || wrong("its outline crosses itself (give corners in order round it)".into());
        if crosses(&corners, normal) {
            return crossed();
        }
        let Some(triangles) = ears(&corners, normal) else {
            return crossed();
        };
        let mut area = 0.0;
        let areas = triangles.iter().map(|[a, b, c]| {
            area += (*b - *a).cross(*c - *a).length() / 2.0;
            area
        });
        Ok(Self {
            areas: areas.collect(),
            corners,
            normal,
            triangles,
        })
    }

    /// Corners, in order (metres).
    pub fn corners(&self) -> &[Vec3] {
        &self.corners
    }

    /// Unit normal of its front.
    pub fn normal(&self) -> Vec3 {
        self.normal
    }

    /// Triangles that it is made of.
    pub fn triangles(&self) -> &[[Vec3; 3]] {
        &self.triangles
    }

    /// Its area (m²).
    pub fn area(&self) -> f64 {
        self.areas.last().copied().unwrap_or_default()
    }

    /// A point, uniform in area.
    pub fn sample(&self, u: [f64; 2]) -> Vec3 {
        let wanted = u[0] * self.area();
        let k = self
            .areas
            .partition_point(|a| *a <= wanted)
            .min(self.triangles.len() - 1);
        let below = if k == 0 { 0.0 } else { self.areas[k - 1] };
        // The rest of the first number is spread evenly again.
        let r = ((wanted - below) / (self.areas[k] - below)).clamp(0.0, 1.0).sqrt();
        let [a, b, c] = self.triangles[k];
        a * (1.0 - r) + b * (r * (1.0 - u[1])) + c * (r * u[1])
    }

    /// Adds its triangles to a scene, as a surface of its own.
    pub fn add_to(&self, scene: &mut Scene, name: &str) {
        let (surface, object) = (scene.surfaces.len() as u32, scene.object(name));
        // A name of its own, so that no other surface is taken for it.
        scene.surfaces.push(name.to_owned());
        for triangle in &self.triangles {
            scene.push(Shape::Triangle(*triangle), surface, object);
        }
    }
}

/// Whether two sides that are no neighbours cross.
fn crosses(corners: &[Vec3], normal: Vec3) -> bool {
    let n = corners.len();
    let turn = |a: Vec3, b: Vec3, c: Vec3| (b - a).cross(c - a).dot(normal);
    let cross =
        |a: Vec3, b: Vec3, c: Vec3, d: Vec3| turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
    (0..n).any(|i| (i + 2..n).any(|j| cross(corners[i], corners[i + 1], corners[j], corners[(j + 1) % n])))
}

/// Cuts ears off until a triangle is left; None where the outline crosses itself.
fn ears(corners: &[Vec3], normal: Vec3) -> Option<Vec<[Vec3; 3]>> {
    let mut left = corners.to_vec();
    let mut triangles = Vec::with_capacity(corners.len() - 2);
    let turn = |a: Vec3, b: Vec3, c: Vec3| (b - a).cross(c - a).dot(normal);
    while left.len() > 3 {
        let n = left.len();
        let at = |k: usize| left[k % n];
        let ear = (0..n).find(|&k| {
            let [a, b, c] = [at(k + n - 1), at(k), at(k + 1)];
            let inside = |p: Vec3| turn(a, b, p) > 0.0 && turn(b, c, p) > 0.0 && turn(c, a, p) > 0.0;
            turn(a, b, c) > 0.0 && !(2..n - 1).any(|other| inside(at(k + other)))
        });
        // Corners on a straight line are no ears, and are not needed.
        let Some(k) = ear else {
            let straight = (0..n).find(|&k| turn(at(k + n - 1), at(k), at(k + 1)).abs() < 1e-12)?;
            left.remove(straight);
            continue;
        };
        triangles.push([at(k + n - 1), at(k), at(k + 1)]);
        left.remove(k);
    }
    triangles.push([left[0], left[1], left[2]]);
    Some(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn corners(points: &[[f64; 2]]) -> Vec<Vec3> {
        points.iter().map(|p| Vec3::new(p[0], 1.0, p[1])).collect()
    }

    #[test]
    fn areas_and_normals_are_those_of_geometry() {
        // An L, seen from the south it runs counter-clockwise.
        let l = corners(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]);
        let polygon = Polygon::new("l", l).expect("a polygon");
        assert!((polygon.area() - 4.0).abs() < 1e-12);
        assert!((polygon.normal() - Vec3::new(0.0, -1.0, 0.0)).length() < 1e-12);
        for k in 0..100 {
            let u = crate::sequence::r2(k, [0.0; 2]);
            let p = polygon.sample(u);
            assert!(p.x <= 1.0 + 1e-12 || p.z <= 1.0 + 1e-12, "{p:?}");
        }
    }

    #[test]
    fn what_is_no_polygon_is_told() {
        let told = |points: Vec<Vec3>| Polygon::new("window \"a\"", points).expect_err("wrong").to_string();
        assert!(told(corners(&[[0.0, 0.0], [1.0, 0.0]])).contains("2 corners"));
        assert!(told(corners(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]])).contains("no area"));
        let mut bent = corners(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        bent[2].y += 0.1;
        assert!(told(bent).contains("not flat"));
        // An eight has no area; a crossed outline with area has no ears.
        let crossed = corners(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [1.0, -1.0], [0.0, 4.0]]);
        assert!(Polygon::new("w", crossed).is_err());
    }
}
