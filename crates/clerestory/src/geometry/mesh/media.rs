//! Bodies are closed, and their faces agree on where inside is.

use std::collections::HashMap;
use std::f64::consts::PI;

use super::Extent;
use super::check::at;
use super::scene::Scene;
use super::shape::Shape;
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// Corners closer than this share of the greatest length are one.
const SAME: f64 = 1e-8;
/// With more open sides than these none is searched for corners of others that lie on it.
const MOST_CUT: usize = 4000;

/// Whether the border of every medium but the first is closed and says consistently where the medium is.
///
/// Seen so that the medium is always behind, every side of an element must be run along as often in one sense as in the
/// other: then the border has no border itself.
pub(super) fn check(scene: &Scene, extents: &[Extent; 2], media: &[[u16; 2]]) -> Result<()> {
    if let Some(e) = scene.elements.iter().find(|e| e.surface as usize >= media.len()) {
        return Err(Error::Argument(format!(
            "surface {} has no media; there are {} (give every surface the media on its sides)",
            e.surface,
            media.len()
        )));
    }
    let most = media.iter().flatten().copied().max().unwrap_or(0);
    for medium in 1..=most {
        let mut rims = Rims::new(scene, extents);
        let mut volume = 0.0;
        let mut first = None;
        for (number, e) in scene.elements.iter().enumerate() {
            let [before, behind] = media[e.surface as usize];
            if before != behind && (before == medium || behind == medium) {
                rims.add(number, &e.shape, before == medium);
                volume += volume_below(&e.shape) * if behind == medium { 1.0 } else { -1.0 };
                first.get_or_insert(number);
            }
        }
        rims.closed(scene, medium)?;
        if let (true, Some(first)) = (volume < 0.0, first) {
            return Err(Error::Argument(format!(
                "the border of medium {medium} is inside out: its faces, {} first, have their fronts inside, so that it holds \
                 {volume:.3e} m³ (reverse the order of the corners of every face)",
                scene.name(first)
            )));
        }
    }
    Ok(())
}

/// Volume [m³] between a surface's front and the plane z = 0, below the surface where its front looks up and negative
/// where it looks down: over a closed border the volume that it encloses (divergence theorem), over a period as well.
fn volume_below(shape: &Shape) -> f64 {
    let disc = |centre: Vec3, normal: Vec3, radius: f64| centre.z * normal.z * PI * radius * radius;
    match *shape {
        Shape::Triangle([a, b, c]) => (b - a).cross(c - a).z / 2.0 * (a.z + b.z + c.z) / 3.0,
        Shape::Sphere { radius, inward, .. } => {
            let whole = 4.0 / 3.0 * PI * radius * radius * radius;
            if inward { -whole } else { whole }
        }
        Shape::Ring { centre, normal, radii } => disc(centre, normal, radii[1]) - disc(centre, normal, radii[0]),
        Shape::Cone { ends, radii, inward } => {
            let along = ends[1] - ends[0];
            let axis = along.unit();
            let [r, s] = radii;
            let whole = PI / 3.0 * along.length() * (r * r + r * s + s * s);
            // What a frustum's two discs do not give, its side does.
            let side = whole + disc(ends[0], axis, r) - disc(ends[1], axis, s);
            if inward { -side } else { side }
        }
    }
}

/// Numbers points; those that agree but for rounding, or but for whole periods, get the same number.
struct Points {
    period: [Option<f64>; 3],
    grid: f64,
    numbers: HashMap<[i64; 3], u32>,
}

impl Points {
    fn number(&mut self, p: Vec3) -> u32 {
        let p = p.array();
        let key: [i64; 3] = std::array::from_fn(|k| {
            let x = match self.period[k] {
                // Just below the next period is the same as just above this one.
                Some(period) => p[k] - ((p[k] + self.grid) / period).floor() * period,
                None => p[k],
            };
            (x / self.grid).round() as i64
        });
        // Rounding may have brought it into a neighbour of the grid.
        for around in [0, 1, -1].map(|dx| [0, 1, -1].map(|dy| [0, 1, -1].map(|dz| [dx, dy, dz]))) {
            for d in around.into_iter().flatten() {
                let near: [i64; 3] = std::array::from_fn(|k| key[k].saturating_add(d[k]));
                if let Some(&known) = self.numbers.get(&near) {
                    return known;
                }
            }
        }
        let number = self.numbers.len() as u32;
        self.numbers.insert(key, number);
        number
    }
}

/// A stretch of the border of elements: from a point along a vector, or a circle about a point, its axis as long as its
/// radius.
#[derive(Debug, Clone, PartialEq)]
struct Rim {
    circle: bool,
    point: Vec3,
    vector: Vec3,
    /// Times that it is run along in its own sense, less those in the other.
    net: i64,
    /// The elements that do so, with their sense.
    by: Vec<(usize, bool)>,
}

/// The stretches of the border of a medium.
struct Rims {
    points: Points,
    vectors: Points,
    known: HashMap<(bool, u32, u32), usize>,
    all: Vec<Rim>,
}

impl Rims {
    fn new(scene: &Scene, extents: &[Extent; 2]) -> Self {
        let bounds = scene.elements.iter().flat_map(|e| e.shape.bounds());
        let greatest = bounds
            .flat_map(Vec3::array)
            .map(f64::abs)
            .fold(f64::MIN_POSITIVE, f64::max);
        let [x, y] = extents.map(|e| e.repeated.then(|| e.limits[1] - e.limits[0]));
        let points = |period: [Option<f64>; 3]| Points {
            period,
            // No coarser than a short period allows.
            grid: period
                .iter()
                .flatten()
                .map(|p| p * 1e-5)
                .fold(greatest * SAME, f64::min),
            numbers: HashMap::new(),
        };
        Self {
            points: points([x, y, None]),
            vectors: points([None; 3]),
            known: HashMap::new(),
            all: Vec::new(),
        }
    }

    /// Adds the rims of an element, as seen with the medium behind.
    fn add(&mut self, element: usize, shape: &Shape, reversed: bool) {
        let mut circle = |centre: Vec3, axis: Vec3, radius: f64, counter_clockwise: bool| {
            if radius > 0.0 {
                self.run(true, centre, axis * radius, counter_clockwise != reversed, element);
            }
        };
        match *shape {
            Shape::Triangle(corners) => {
                for (from, to) in [(0, 1), (1, 2), (2, 0)] {
                    let vector = corners[to] - corners[from];
                    self.run(false, corners[from], vector, !reversed, element);
                }
            }
            Shape::Sphere { .. } => {}
            Shape::Ring { centre, normal, radii } => {
                circle(centre, normal, radii[1], true);
                circle(centre, normal, radii[0], false);
            }
            Shape::Cone { ends, radii, inward } => {
                let axis = (ends[1] - ends[0]).unit();
                circle(ends[0], axis, radii[0], !inward);
                circle(ends[1], axis, radii[1], inward);
            }
        }
    }

    /// Counts one run along a rim; of a vector and its opposite, one gives the rim's sense.
    fn run(&mut self, circle: bool, point: Vec3, vector: Vec3, forward: bool, element: usize) {
        let positive = vector
            .array()
            .into_iter()
            .find(|x| x.abs() > 2.0 * self.vectors.grid)
            .is_none_or(|x| x > 0.0);
        let (point, vector) = match (positive, circle) {
            (true, _) => (point, vector),
            (false, true) => (point, -vector),
            (false, false) => (point + vector, -vector),
        };
        let forward = forward == positive;
        let key = (circle, self.points.number(point), self.vectors.number(vector));
        let next = self.all.len();
        let index = *self.known.entry(key).or_insert(next);
        if index == next {
            self.all.push(Rim {
                circle,
                point,
                vector,
                net: 0,
                by: Vec::new(),
            });
        }
        let rim = &mut self.all[index];
        rim.net += if forward { 1 } else { -1 };
        rim.by.push((element, forward));
    }

    /// The rims that are not run along equally often in both senses, cut where corners of others lie on them.
    fn open(self) -> Vec<Rim> {
        let grid = self.points.grid;
        let period = self.points.period;
        let mut open: Vec<Rim> = self.all.into_iter().filter(|r| r.net != 0).collect();
        if open.is_empty() || open.len() > MOST_CUT {
            return open;
        }
        let ends: Vec<Vec3> = open
            .iter()
            .filter(|r| !r.circle)
            .flat_map(|r| [r.point, r.point + r.vector])
            .collect();
        let mut again = Self {
            points: Points {
                period,
                grid,
                numbers: HashMap::new(),
            },
            vectors: Points {
                period: [None; 3],
                grid: self.vectors.grid,
                numbers: HashMap::new(),
            },
            known: HashMap::new(),
            all: Vec::new(),
        };
        for rim in &open {
            let mut cuts = vec![0.0, 1.0];
            if !rim.circle {
                cuts.extend(ends.iter().filter_map(|e| share_along(rim, *e, period, grid)));
                cuts.sort_by(f64::total_cmp);
                let length = rim.vector.length();
                cuts.dedup_by(|b, a| (*b - *a) * length < 4.0 * grid);
            }
            let part = |s: f64| rim.point + rim.vector * s;
            for &(element, forward) in &rim.by {
                if rim.circle {
                    again.run(true, rim.point, rim.vector, forward, element);
                    continue;
                }
                for pair in cuts.windows(2) {
                    again.run(false, part(pair[0]), part(pair[1]) - part(pair[0]), forward, element);
                }
            }
        }
        open = again.all;
        open.retain(|r| r.net != 0);
        open
    }

    fn closed(self, scene: &Scene, medium: u16) -> Result<()> {
        let open = self.open();
        let Some(first) = open.first() else { return Ok(()) };
        let place = |rim: &Rim| {
            if rim.circle {
                format!(
                    "along the circle of radius {} m about {}",
                    rim.vector.length(),
                    at(rim.point)
                )
            } else {
                format!("between {} and {}", at(rim.point), at(rim.point + rim.vector))
            }
        };
        // Two neighbours that run along a side in the same sense disagree; anything else is a hole.
        if let Some(rim) = open.iter().find(|r| matches!(r.by[..], [a, b] if a.1 == b.1)) {
            return Err(Error::Argument(format!(
                "{} and {} meet {} with their fronts on different sides (turn one of them: reverse the order of its corners)",
                scene.name(rim.by[0].0),
                scene.name(rim.by[1].0),
                place(rim),
            )));
        }
        Err(Error::Argument(format!(
            "the border of medium {medium} has a hole: {} has no neighbour {}, one of {} such sides (close the body, or give \
             its surface the same medium on both sides)",
            scene.name(first.by[0].0),
            place(first),
            open.len()
        )))
    }
}

/// Where on a line, as a share of it, a point lies, if it does, but for whole periods.
fn share_along(rim: &Rim, point: Vec3, period: [Option<f64>; 3], grid: f64) -> Option<f64> {
    let vector = rim.vector;
    let squared = vector.dot(vector);
    // Along the axis in which the line is longest the share is known up to whole periods; one that fits all axes is sought.
    let from = (point - rim.point).array();
    let along = vector.array();
    let steps = |k: usize| -> Vec<f64> {
        let Some(period) = period[k] else { return vec![from[k]] };
        let (low, high) = (along[k].min(0.0) - grid, along[k].max(0.0) + grid);
        let first = ((low - from[k]) / period).ceil();
        let last = ((high - from[k]) / period).floor();
        let count = (last - first + 1.0).clamp(0.0, 64.0) as usize;
        (0..count).map(|i| from[k] + (first + i as f64) * period).collect()
    };
    for x in steps(0) {
        for y in steps(1) {
            let at = Vec3::new(x, y, from[2]);
            let share = at.dot(vector) / squared;
            if share > 0.0 && share < 1.0 && (at - vector * share).length() < 4.0 * grid {
                return Some(share);
            }
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::testing::{cube, prisms, quad};
    use super::super::{Element, Extent, Mesh, Scene, Shape};
    use crate::geometry::{Geometry, Vec3};

    const GLASS: [[u16; 2]; 1] = [[0, 1]];

    fn repeated(length: f64) -> Extent {
        Extent {
            limits: [0.0, length],
            repeated: true,
        }
    }

    fn free() -> Extent {
        Extent {
            limits: [-1.0, 1.0],
            repeated: false,
        }
    }

    fn told(scene: Scene, extents: [Extent; 2]) -> Option<String> {
        let mesh = Mesh::new(scene, extents).expect("sound shapes");
        mesh.check_media(&GLASS).err().map(|e| e.to_string())
    }

    #[test]
    fn closed_bodies_pass_at_every_scale() {
        for size in [5e-5, 0.07, 2.0] {
            assert_eq!(told(cube(size), [free(), free()]), None);
            assert_eq!(told(prisms(size), [repeated(2.0 * size), repeated(size)]), None);
        }
    }

    #[test]
    fn a_hole_and_a_turned_triangle_are_told_with_their_place() {
        let mut holed = prisms(1.0);
        holed.elements.remove(2);
        let text = told(holed, [repeated(2.0), repeated(1.0)]).expect("a hole");
        let part = "the border of medium 1 has a hole: \"quad\" (triangle) has no neighbour between (0, 0, 0.5) m";
        assert!(text.starts_with(part) && text.contains("one of 3 such sides"), "{text}");
        let mut turned = cube(1.0);
        if let Shape::Triangle(corners) = &mut turned.elements[3].shape {
            corners.swap(0, 1);
        }
        let text = told(turned, [free(), free()]).expect("a turned one");
        assert!(text.contains("with their fronts on different sides"), "{text}");
        // The prisms without their period are open at both ends.
        assert!(told(prisms(1.0), [free(), free()]).is_some());
    }

    #[test]
    fn bodies_that_are_inside_out_are_told() {
        for (scene, extents) in [
            (cube(0.3), [free(), free()]),
            (prisms(1e-4), [repeated(2e-4), repeated(1e-4)]),
        ] {
            let mut turned = scene;
            for e in &mut turned.elements {
                if let Shape::Triangle(corners) = &mut e.shape {
                    corners.swap(0, 1);
                }
            }
            let text = told(turned, extents).expect("inside out");
            assert!(text.starts_with("the border of medium 1 is inside out"), "{text}");
        }
    }

    #[test]
    fn volumes_of_closed_bodies_are_those_of_geometry() {
        let v = Vec3::new;
        let sum = |shapes: &[Shape]| shapes.iter().map(super::volume_below).sum::<f64>();
        let cube: Vec<Shape> = cube(0.3).elements.iter().map(|e| e.shape).collect();
        assert!((sum(&cube) - 0.027).abs() < 1e-12);
        let axis = v(0.6, 0.0, 0.8);
        let (low, high) = (v(0.1, 0.2, 0.3), v(0.1, 0.2, 0.3) + axis);
        let pin = [
            Shape::Cone {
                ends: [low, high],
                radii: [0.5, 0.25],
                inward: false,
            },
            Shape::Ring {
                centre: low,
                normal: -axis,
                radii: [0.0, 0.5],
            },
            Shape::Ring {
                centre: high,
                normal: axis,
                radii: [0.0, 0.25],
            },
        ];
        let exact = std::f64::consts::PI / 3.0 * (0.25 + 0.125 + 0.0625);
        assert!((sum(&pin) - exact).abs() < 1e-12);
    }

    #[test]
    fn long_sides_may_meet_several_short_ones() {
        let mut scene = Scene::default();
        let v = Vec3::new;
        // The bottom in one, the other faces of a box of 2 by 1 by 1 in halves.
        let p = |x: f64, y: f64, z: f64| v(x, y, z);
        let mut face = |a, b, c, d| quad(&mut scene, [a, b, c, d], 0);
        face(p(0.0, 0.0, 0.0), p(0.0, 1.0, 0.0), p(2.0, 1.0, 0.0), p(2.0, 0.0, 0.0));
        for x in [0.0, 1.0] {
            face(
                p(x, 0.0, 1.0),
                p(x + 1.0, 0.0, 1.0),
                p(x + 1.0, 1.0, 1.0),
                p(x, 1.0, 1.0),
            );
            face(
                p(x, 0.0, 0.0),
                p(x + 1.0, 0.0, 0.0),
                p(x + 1.0, 0.0, 1.0),
                p(x, 0.0, 1.0),
            );
            face(
                p(x, 1.0, 0.0),
                p(x, 1.0, 1.0),
                p(x + 1.0, 1.0, 1.0),
                p(x + 1.0, 1.0, 0.0),
            );
        }
        face(p(0.0, 0.0, 0.0), p(0.0, 0.0, 1.0), p(0.0, 1.0, 1.0), p(0.0, 1.0, 0.0));
        face(p(2.0, 0.0, 0.0), p(2.0, 1.0, 0.0), p(2.0, 1.0, 1.0), p(2.0, 0.0, 1.0));
        assert_eq!(told(scene, [free(), free()]), None);
    }

    #[test]
    fn round_bodies_are_closed_by_rings() {
        let v = Vec3::new;
        let axis = v(0.6, 0.0, 0.8);
        let side = Shape::Cone {
            ends: [v(0.1, 0.2, 0.3), v(0.1, 0.2, 0.3) + axis],
            radii: [0.5, 0.25],
            inward: false,
        };
        let cap = |centre: Vec3, normal: Vec3, radius: f64| Shape::Ring {
            centre,
            normal,
            radii: [0.0, radius],
        };
        let bottom = cap(v(0.1, 0.2, 0.3), -axis, 0.5);
        let top = cap(v(0.1, 0.2, 0.3) + axis, axis, 0.25);
        let scene = |shapes: &[Shape]| {
            let mut scene = Scene::default();
            for &shape in shapes {
                scene.elements.push(Element {
                    shape,
                    surface: 0,
                    object: 0,
                });
            }
            scene.objects.push("pin".into());
            scene
        };
        assert_eq!(told(scene(&[side, bottom, top]), [free(), free()]), None);
        let open = told(scene(&[side, bottom]), [free(), free()]).expect("a hole");
        assert!(open.contains("along the circle of radius 0.25"), "{open}");
        let turned = cap(v(0.1, 0.2, 0.3) + axis, -axis, 0.25);
        let inverted = told(scene(&[side, bottom, turned]), [free(), free()]).expect("a turned one");
        assert!(inverted.contains("fronts on different sides"), "{inverted}");
        let ball = Shape::Sphere {
            centre: axis,
            radius: 0.1,
            inward: false,
        };
        assert_eq!(told(scene(&[ball]), [free(), free()]), None);
    }
}
