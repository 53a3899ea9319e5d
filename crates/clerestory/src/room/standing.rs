//! Where eyes, sensors and windows stand: what a person may have put in the wrong place.

use super::{Role, Room, Window};
use crate::geometry::{Geometry, Hit, Meeting, NO_PIECE, Ray, Shape, Vec3};
use crate::sequence::{circle, r2, r4};

/// What is seen all around from a point, as shares of all directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Around {
    /// Sky or ground, with nothing before them.
    pub outside: f64,
    /// Windows, from the room.
    pub windows: f64,
    /// The surface whose back is seen nearly all around, as from within a body.
    pub within: Option<String>,
}

/// What is seen from a window, as shares of directions.
#[derive(Debug, Clone, PartialEq)]
pub struct Outlook {
    /// Sky or ground from its face to the room.
    pub inside: f64,
    /// The same from its face to the outside.
    pub outside: f64,
    /// The surface in whose plane it lies without an opening there.
    pub covered: Option<String>,
}

/// Directions that are looked into.
const LOOKS: u32 = 1024;
/// Points of a window at which walls in its plane are looked for.
const PROBES: u32 = 32;
/// Share of all directions in which the back of a body's surface is seen from within it; it may stand on a floor.
const WITHIN: f64 = 0.7;
/// A wall nearer to a window than this is in its plane (metres).
const NEAR: f64 = 1e-3;

impl Room {
    /// What is seen all around from a point (metres).
    pub fn around(&self, point: Vec3) -> Around {
        let (mut outside, mut windows) = (0, 0);
        let mut backs = vec![0_u32; self.roles.len()];
        for k in 0..LOOKS {
            let [u, v] = r2(k, [0.5; 2]);
            let z = 1.0 - 2.0 * u;
            let [x, y] = circle(v).map(|c| c * (1.0 - z * z).max(0.0).sqrt());
            let direction = Vec3::new(x, y, z);
            let Some(hit) = self.met(point, direction) else {
                outside += 1;
                continue;
            };
            let from_front = direction.dot(hit.normal) < 0.0;
            let surface = hit.surface as usize;
            windows += u32::from(from_front && matches!(self.roles[surface], Role::Window(_)));
            backs[surface] += u32::from(!from_front);
        }
        let share = |count: u32| f64::from(count) / f64::from(LOOKS);
        let within = (0..backs.len()).find(|surface| share(backs[*surface]) > WITHIN);
        Around {
            outside: share(outside),
            windows: share(windows),
            within: within.map(|surface| self.surface_name(surface as u32)),
        }
    }

    /// What is seen from each of the windows.
    pub fn outlooks(&self) -> Vec<Outlook> {
        self.windows.iter().map(|window| self.outlook(window)).collect()
    }

    fn outlook(&self, window: &Window) -> Outlook {
        let normal = window.polygon().normal();
        let mut free = [0_u32; 2];
        let mut covers = Vec::new();
        for k in 0..LOOKS {
            let [u, v, s, t] = r4(k, [0.5; 4]);
            let at = window.polygon().sample([s, t]);
            let into = window.travel(crate::direction::Disk::from_square([u, v]));
            for (side, direction) in [into, -into].into_iter().enumerate() {
                let away = normal * if side == 0 { NEAR } else { -NEAR };
                free[side] += u32::from(self.met(at + away, direction).is_none());
            }
            if k < PROBES {
                covers.extend(self.in_its_plane(at, normal));
            }
        }
        let share = |count: u32| f64::from(count) / f64::from(LOOKS);
        Outlook {
            inside: share(free[0]),
            outside: share(free[1]),
            covered: (covers.len() as u32 > PROBES / 2).then(|| self.surface_name(covers[0])),
        }
    }

    /// The solid surface that lies in the plane of a window at one of its points.
    fn in_its_plane(&self, at: Vec3, normal: Vec3) -> Option<u32> {
        let elements = &self.mesh.scene().elements;
        let found = elements.iter().find(|element| {
            let Shape::Triangle([a, b, c]) = element.shape else {
                return false;
            };
            let solid = matches!(self.roles[element.surface as usize], Role::Solid(_));
            let flush = [a, b, c].iter().all(|corner| (*corner - at).dot(normal).abs() < NEAR);
            let turn = |from: Vec3, to: Vec3| (to - from).cross(at - from).dot(normal);
            let turns = [turn(a, b), turn(b, c), turn(c, a)];
            solid && flush && (turns.iter().all(|t| *t > 0.0) || turns.iter().all(|t| *t < 0.0))
        });
        found.map(|element| element.surface)
    }

    fn met(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let mut ray = Ray {
            origin,
            direction,
            piece: NO_PIECE,
        };
        match self.mesh.meet(&mut ray) {
            Meeting::Hit(hit) => Some(hit),
            Meeting::Leaves | Meeting::Lost => None,
        }
    }

    fn surface_name(&self, surface: u32) -> String {
        self.mesh.scene().surfaces[surface as usize].clone()
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{cube, open, quad, room, uniform, v};
    use crate::geometry::Scene;

    #[test]
    fn points_know_where_they_are() {
        let room = cube(0.5, open(), uniform());
        let inside = room.around(v(0.0, 0.0, 0.0));
        assert_eq!(inside.outside, 0.0);
        // One of six faces.
        assert!((inside.windows - 1.0 / 6.0).abs() < 0.01, "{inside:?}");
        let outside = room.around(v(0.0, -5.0, 0.0));
        assert!(outside.outside > 0.9 && outside.windows == 0.0, "{outside:?}");
    }

    #[test]
    fn a_window_knows_its_sides() {
        let room = cube(0.5, open(), uniform());
        let [outlook] = &room.outlooks()[..] else { panic!() };
        assert_eq!((outlook.inside, outlook.outside), (0.0, 1.0));
        assert_eq!(outlook.covered, None);
    }

    #[test]
    fn walls_without_an_opening_and_bodies_are_found() {
        let mut scene = Scene::default();
        let wall = scene.surface("wall");
        // A scene has an extent along x and y.
        quad(
            &mut scene,
            [
                v(-1.0, 1.0, -1.0),
                v(1.0, 1.0, -1.0),
                v(1.0, 2.0, -1.0),
                v(-1.0, 2.0, -1.0),
            ],
            wall,
        );
        let flat = |x: f64, y: f64, z: f64| v(2.0 * x - 1.0, y, 2.0 * z - 1.0);
        quad(
            &mut scene,
            [
                flat(0.0, 0.0, 0.0),
                flat(0.0, 0.0, 1.0),
                flat(1.0, 0.0, 1.0),
                flat(1.0, 0.0, 0.0),
            ],
            wall,
        );
        let small = [
            v(-0.2, 0.0, -0.2),
            v(-0.2, 0.0, 0.2),
            v(0.2, 0.0, 0.2),
            v(0.2, 0.0, -0.2),
        ];
        let covered = room(scene, &[0.5], vec![("w".into(), small.to_vec(), open())], uniform());
        assert_eq!(covered.outlooks()[0].covered.as_deref(), Some("wall"));
        // Fronts outside, on a floor that closes it below.
        let mut scene = Scene::default();
        let (body, floor) = (scene.surface("body"), scene.surface("floor"));
        let p = |k: u32| v(f64::from(k & 1), f64::from(k >> 1 & 1), f64::from(k >> 2 & 1));
        for [a, b, c, d] in [[2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [4, 5, 7, 6]] {
            quad(&mut scene, [p(a), p(b), p(c), p(d)], body);
        }
        quad(&mut scene, [p(0), p(1), p(3), p(2)], floor);
        let room = room(scene, &[0.5, 0.5], Vec::new(), uniform());
        assert_eq!(room.around(v(0.5, 0.5, 0.5)).within.as_deref(), Some("body"));
        assert_eq!(room.around(v(0.5, 0.5, 1.5)).within, None);
    }
}
