//! Windows as matrices ask them for light: at a point of each of their parts, and without a ray where nothing can be in the way.

use super::polygon::Polygon;
use super::window::Window;
use crate::geometry::{Mesh, Shape, Vec3};

/// Shapes that are looked at one by one; where more could stand before a window, rays find out.
const MOST: usize = 256;
/// What lies so near a plane (relative to the window's size) lies in it.
const IN_PLANE: f64 = 1e-7;

/// Parts are halved so often at most.
const DEEPEST: u32 = 8;

/// A triangle of a window.
#[derive(Debug, Clone, Copy)]
pub(super) struct Piece {
    corners: [Vec3; 3],
    /// (m²)
    pub(super) area: f64,
}

impl Piece {
    fn whole(corners: [Vec3; 3]) -> Self {
        let [a, b, c] = corners;
        let area = (b - a).cross(c - a).length() / 2.0;
        Self { corners, area }
    }

    /// Longest side (m).
    fn reach(&self) -> f64 {
        let [a, b, c] = self.corners;
        (b - a).length().max((c - b).length()).max((a - c).length())
    }

    /// Whether it is too large for one point, as seen from somewhere.
    fn is_coarse(&self, reach: f64, from: Vec3, fineness: f64) -> bool {
        let [a, b, c] = self.corners;
        reach > fineness * ((a + b + c) * (1.0 / 3.0) - from).length()
    }

    /// The part at a corner (0 to 2), or the one between these (3).
    fn part(&self, number: usize) -> Self {
        let [a, b, c] = self.corners;
        let middles = [(b + c) * 0.5, (c + a) * 0.5, (a + b) * 0.5];
        let corners = match number {
            3 => middles,
            k => std::array::from_fn(|j| if j == k { self.corners[k] } else { middles[3 - j - k] }),
        };
        Self {
            corners,
            area: self.area / 4.0,
        }
    }

    fn visit(&self, reach: f64, depth: u32, from: Vec3, fineness: f64, each: &mut impl FnMut(Self)) {
        if depth == DEEPEST || !self.is_coarse(reach, from, fineness) {
            return each(*self);
        }
        for number in 0..4 {
            self.part(number).visit(reach / 2.0, depth + 1, from, fineness, each);
        }
    }

    /// Shares of the corners in a point.
    fn shares(&self, point: Vec3) -> [f64; 3] {
        let [a, b, c] = self.corners;
        let normal = (b - a).cross(c - a);
        let scale = 1.0 / normal.dot(normal);
        let share = |p: Vec3, q: Vec3| (p - point).cross(q - point).dot(normal) * scale;
        [share(b, c), share(c, a), share(a, b)]
    }

    /// A point, even in area.
    pub(super) fn sample(&self, u: [f64; 2]) -> Vec3 {
        let [a, b, c] = self.corners;
        let r = u[0].sqrt();
        a * (1.0 - r) + b * (r * (1.0 - u[1])) + c * (r * u[1])
    }
}

/// Parts of a window of which each is seen from a point at an angle of about `fineness` (rad) at most.
pub(super) fn pieces(polygon: &Polygon, from: Vec3, fineness: f64, each: &mut impl FnMut(Piece)) {
    for triangle in polygon.triangles() {
        let whole = Piece::whole(*triangle);
        whole.visit(whole.reach(), 0, from, fineness, each);
    }
}

/// Area of that of these parts which holds a point of the window (m²).
pub(super) fn area_about(polygon: &Polygon, from: Vec3, fineness: f64, point: Vec3) -> f64 {
    let wholes = polygon.triangles().iter().map(|triangle| {
        let whole = Piece::whole(*triangle);
        (whole, whole.shares(point))
    });
    let least = |shares: &[f64; 3]| shares.iter().copied().fold(f64::INFINITY, f64::min);
    let Some((mut piece, mut shares)) = wholes.max_by(|a, b| least(&a.1).total_cmp(&least(&b.1))) else {
        return 0.0;
    };
    let mut reach = piece.reach();
    for _ in 0..DEEPEST {
        if !piece.is_coarse(reach, from, fineness) {
            break;
        }
        let number = shares.iter().position(|s| *s > 0.5).unwrap_or(3);
        shares = match number {
            3 => shares.map(|s| 1.0 - 2.0 * s),
            k => std::array::from_fn(|j| 2.0 * shares[j] - if j == k { 1.0 } else { 0.0 }),
        };
        piece = piece.part(number);
        reach /= 2.0;
    }
    piece.area
}

/// Density (1/sr) of a point that is even in an area, in a direction in which a plane with this normal is met at a distance (m).
#[inline]
pub(super) fn density(area: f64, normal: Vec3, direction: Vec3, distance: f64) -> f64 {
    distance * distance / (area * -direction.dot(normal)).max(f64::MIN_POSITIVE)
}

/// All windows of a room.
#[derive(Debug, Clone, Default)]
pub(super) struct Openings {
    /// What could stand before each window; None where too much could.
    obstacles: Vec<Option<Vec<Obstacle>>>,
}

/// A shape that is not wholly behind a window.
#[derive(Debug, Clone)]
struct Obstacle {
    /// Points in whose hull it lies.
    hull: Vec<Vec3>,
    /// Plane that it lies in, if the whole window is on one side of it: unit normal to that side, and distance from the origin.
    plane: Option<(Vec3, f64)>,
}

impl Openings {
    pub(super) fn new(windows: &[Window], mesh: &Mesh) -> Self {
        Self {
            obstacles: windows.iter().map(|w| before(w.polygon(), mesh)).collect(),
        }
    }

    /// Whether all of a window is certainly seen from a point: each shape is on the other side of a plane than all ways there.
    pub(super) fn is_clear(&self, windows: &[Window], number: usize, from: Vec3) -> bool {
        let Some(obstacles) = &self.obstacles[number] else {
            return false;
        };
        let polygon = windows[number].polygon();
        let (corners, size) = (polygon.corners(), polygon.area().sqrt());
        let beyond = |hull: &[Vec3], normal: Vec3, through: Vec3, slack: f64| {
            hull.iter().all(|p| (*p - through).dot(normal) >= -slack)
        };
        obstacles.iter().all(|obstacle| {
            // The window and the point on one side of it.
            let aside = obstacle
                .plane
                .is_some_and(|(normal, offset)| from.dot(normal) >= offset - IN_PLANE * size);
            aside
                || beyond(&obstacle.hull, polygon.normal(), from, IN_PLANE * size)
                || (0..corners.len()).any(|k| {
                    let [a, b] = [corners[k] - from, corners[(k + 1) % corners.len()] - from];
                    // Away from the window, whose corners run counter-clockwise as seen from here.
                    let out = a.cross(b);
                    beyond(&obstacle.hull, out, from, IN_PLANE * size * out.length())
                })
        })
    }
}

/// What could stand before a window; None where it is too much, or the window is not convex.
fn before(polygon: &Polygon, mesh: &Mesh) -> Option<Vec<Obstacle>> {
    let (corners, normal) = (polygon.corners(), polygon.normal());
    let size = polygon.area().sqrt();
    let corner = |k: usize| corners[k % corners.len()];
    let convex = (0..corners.len()).all(|k| {
        let turn = (corner(k + 1) - corner(k)).cross(corner(k + 2) - corner(k + 1));
        turn.dot(normal) >= 0.0
    });
    if !convex {
        return None;
    }
    let hulls = mesh.scene().elements.iter().map(|element| match &element.shape {
        Shape::Triangle(corners) => corners.to_vec(),
        other => {
            let [low, high] = other.bounds();
            let pick = |k: u32, bit: u32, low: f64, high: f64| if k >> bit & 1 == 0 { low } else { high };
            let point = |k| {
                Vec3::new(
                    pick(k, 0, low.x, high.x),
                    pick(k, 1, low.y, high.y),
                    pick(k, 2, low.z, high.z),
                )
            };
            (0..8).map(point).collect()
        }
    });
    let reaches_before = |hull: &Vec<Vec3>| hull.iter().any(|p| (*p - corners[0]).dot(normal) > IN_PLANE * size);
    let mut obstacles = Vec::new();
    for hull in hulls.filter(reaches_before) {
        if obstacles.len() == MOST {
            return None;
        }
        let plane = match hull[..] {
            [a, b, c] => {
                let normal = (b - a).cross(c - a).unit();
                [normal, -normal].into_iter().find_map(|normal| {
                    let offset = a.dot(normal);
                    let aside = corners.iter().all(|p| p.dot(normal) >= offset - IN_PLANE * size);
                    aside.then_some((normal, offset))
                })
            }
            _ => None,
        };
        obstacles.push(Obstacle { hull, plane });
    }
    Some(obstacles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::r2;

    #[test]
    fn parts_fill_a_window_and_are_found_again() {
        let v = Vec3::new;
        let corners = vec![v(0.0, 0.0, 0.0), v(3.0, 0.0, 0.0), v(3.5, 0.0, 1.0), v(1.0, 0.0, 2.0)];
        let polygon = Polygon::new("window", corners).expect("a polygon");
        for (from, fineness) in [
            (v(1.0, 0.3, 0.5), 0.5),
            (v(2.0, 3.0, 0.0), 0.4),
            (v(2.0, 0.0, 0.0), 1.0),
        ] {
            let (mut total, mut count) = (0.0, 0);
            pieces(&polygon, from, fineness, &mut |piece| {
                total += piece.area;
                let point = piece.sample(r2(count, [0.5; 2]));
                count += 1;
                let found = area_about(&polygon, from, fineness, point);
                assert!((found / piece.area - 1.0).abs() < 1e-9, "{found} {piece:?}");
            });
            assert!((total / polygon.area() - 1.0).abs() < 1e-12);
            assert!(count > 10);
        }
    }
}
