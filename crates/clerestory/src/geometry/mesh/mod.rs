//! Triangles and exact round shapes, repeated or not.
//!
//! * [`Scene`]: what is there, as a file or a program says.
//! * [`Mesh`]: the same, checked and made ready for rays.
//! * [`Extent`]: over which part of it rays start, and whether it is repeated.

mod check;
mod clip;
mod lanes;
mod media;
mod scene;
mod shape;
#[cfg(test)]
mod testing;
mod tree;
mod triangle;

pub use scene::{Element, Scene};
pub use shape::Shape;

use self::lanes::{Lanes, Plain};
use self::tree::{Stack, Start, Tree};
use pulp::NullaryFnOnce;

use super::{Area, Geometry, Hit, Meeting, NO_PIECE, Ray, Vec3};
use crate::error::{Error, Result};

/// Along one axis: where rays start, and whether the scene is repeated with this length as its period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Lower and upper limit (metres).
    pub limits: [f64; 2],
    /// It is repeated without end; otherwise these are limits of a central part, and rays leave the scene freely.
    pub repeated: bool,
}

/// A scene that rays can meet.
#[derive(Debug, Clone)]
pub struct Mesh {
    scene: Scene,
    extents: [Extent; 2],
    depth: [f64; 2],
    /// Rounding of positions (metres).
    tolerance: f64,
    normals: Vec<Vec3>,
    copies: Vec<Copy>,
    /// First copy of each element, and the count of copies.
    first: Vec<u32>,
    tree: Tree,
}

/// An element as it reaches into the cell.
#[derive(Debug, Clone, Copy)]
struct Copy {
    element: u32,
    /// Whole periods that it is moved by.
    shift: [i32; 2],
}

/// Relative to the greatest length: beyond this a ray has left its cell for sure.
const ROUNDING: f64 = 1e-13;
/// Rays start and end this far (relative to the greatest length) outside of the outermost element.
const MARGIN: f64 = 1e-6;
/// Copies that are made at most: so many, and so many for each element.
const MOST_COPIES: [f64; 2] = [1e4, 4.0];
/// A ray is lost after so many cells.
const MOST_CELLS: u32 = 1_000_000;

impl Mesh {
    /// Checks a scene and prepares it.
    pub fn new(scene: Scene, extents: [Extent; 2]) -> Result<Self> {
        check::extents(&extents)?;
        check::elements(&scene)?;
        let bounds = || scene.elements.iter().map(|e| e.shape.bounds());
        let least = |axis: fn(Vec3) -> f64| bounds().map(|b| axis(b[0])).fold(f64::INFINITY, f64::min);
        let most = |axis: fn(Vec3) -> f64| bounds().map(|b| axis(b[1])).fold(f64::NEG_INFINITY, f64::max);
        let depth = [least(|p| p.z), most(|p| p.z)];
        let sides = [[least(|p| p.x), most(|p| p.x)], [least(|p| p.y), most(|p| p.y)]];
        let cell = [0, 1].map(|axis| {
            if extents[axis].repeated {
                extents[axis].limits
            } else {
                sides[axis]
            }
        });
        let greatest = [cell[0], cell[1], depth].into_iter();
        let greatest = greatest.map(|[low, high]| (high - low).max(high.abs()).max(low.abs()));
        let greatest = greatest.fold(0.0, f64::max);
        let tolerance = greatest * ROUNDING;
        let cell = cell.map(|[low, high]| [low - 10.0 * tolerance, high + 10.0 * tolerance]);
        let Copies {
            all: copies,
            first,
            shapes,
            boxes,
        } = copies(&scene, &extents, cell, sides)?;
        if copies.is_empty() {
            return Err(Error::Missing(
                "the scene has nothing within the limits that it is looked at in (check limits and unit)".into(),
            ));
        }
        let limits = [
            Vec3::new(cell[0][0], cell[1][0], depth[0]),
            Vec3::new(cell[0][1], cell[1][1], depth[1]),
        ];
        let normals = scene.elements.iter().map(|e| match e.shape {
            Shape::Triangle(_) | Shape::Ring { .. } => e.shape.normal(Vec3::default()),
            _ => Vec3::default(),
        });
        Ok(Self {
            depth: [depth[0] - MARGIN * greatest, depth[1] + MARGIN * greatest],
            extents,
            tolerance,
            normals: normals.collect(),
            tree: Tree::new(&shapes, &boxes, limits),
            copies,
            first,
            scene,
        })
    }

    /// What it was made of.
    pub fn scene(&self) -> &Scene {
        &self.scene
    }

    /// What a ray's piece is called in messages.
    pub fn name(&self, piece: u32) -> String {
        self.copies
            .get(piece as usize)
            .map_or_else(|| "free space".into(), |c| self.scene.name(c.element as usize))
    }

    /// The copy that stands where another one does once the ray has gone on by whole periods.
    fn moved(&self, copy: u32, by: [i32; 2]) -> u32 {
        let Some(&Copy { element, shift }) = self.copies.get(copy as usize) else {
            return NO_PIECE;
        };
        let wanted = [shift[0] - by[0], shift[1] - by[1]];
        let range = self.first[element as usize]..self.first[element as usize + 1];
        range
            .into_iter()
            .find(|&c| self.copies[c as usize].shift == wanted)
            .unwrap_or(NO_PIECE)
    }

    /// Brings a point into the cell where it is not by whole periods.
    fn bring_into_cell(&self, origin: &mut Vec3, start: &mut u32) {
        let whole = |axis: usize, x: f64| -> f64 {
            let Extent { limits, repeated } = self.extents[axis];
            let inside = x >= limits[0] - self.tolerance && x <= limits[1] + self.tolerance;
            if inside || !repeated {
                0.0
            } else {
                ((x - limits[0]) / (limits[1] - limits[0])).floor()
            }
        };
        let (i, j) = (whole(0, origin.x), whole(1, origin.y));
        if i != 0.0 || j != 0.0 {
            let period = self.period();
            if i != 0.0 {
                origin.x -= i * period[0];
            }
            if j != 0.0 {
                origin.y -= j * period[1];
            }
            *start = self.moved(*start, [i as i32, j as i32]);
        }
    }

    fn hit(&self, ray: &mut Ray, origin: Vec3, distance: f64, copy: u32) -> Meeting {
        let Copy { element, shift } = self.copies[copy as usize];
        let Element { shape, surface, .. } = self.scene.elements[element as usize];
        let normal = match shape {
            Shape::Triangle(_) | Shape::Ring { .. } => self.normals[element as usize],
            _ => shape.normal(origin - self.offset(shift)),
        };
        ray.origin = origin;
        ray.piece = copy;
        Meeting::Hit(Hit {
            distance,
            normal,
            surface,
        })
    }

    #[allow(
        clippy::inline_always,
        reason = "what runs on vector instructions must be made with them"
    )]
    #[inline(always)]
    fn follow<L: Lanes>(&self, lanes: L, ray: &mut Ray, stack: &mut Stack) -> Meeting {
        let direction = ray.direction;
        let mut origin = ray.origin;
        let mut travelled = 0.0;
        let [bottom, top] = self.depth;
        // Up to where there is anything.
        if origin.z < bottom || origin.z > top {
            let border = if origin.z < bottom { bottom } else { top };
            let t = (border - origin.z) / direction.z;
            if t < 0.0 {
                return Meeting::Leaves;
            }
            if !t.is_finite() {
                return Meeting::Lost;
            }
            origin += direction * t;
            origin.z = border;
            travelled = t;
        }
        let mut start = ray.piece;
        self.bring_into_cell(&mut origin, &mut start);
        let end = if direction.z > 0.0 { top } else { bottom };
        let [side_x, side_y] = [
            Side::new(&self.extents[0], direction.x),
            Side::new(&self.extents[1], direction.y),
        ];
        for _ in 0..MOST_CELLS {
            let to_x = side_x.distance(origin.x, direction.x);
            let to_y = side_y.distance(origin.y, direction.y);
            let to_side = to_x.min(to_y);
            let begin = Start {
                copy: start,
                ago: travelled,
            };
            if let Some((t, copy)) = self
                .tree
                .meet(lanes, origin, direction, to_side + self.tolerance, begin, stack)
            {
                return self.hit(ray, origin + direction * t, travelled + t, copy);
            }
            let to_end = if direction.z == 0.0 {
                f64::INFINITY
            } else {
                (end - origin.z) / direction.z
            };
            if to_side >= to_end {
                return if to_end == f64::INFINITY {
                    Meeting::Lost
                } else {
                    Meeting::Leaves
                };
            }
            origin += direction * to_side;
            travelled += to_side;
            if to_x <= to_y {
                origin.x = side_x.other;
                start = self.moved(start, [side_x.way, 0]);
            }
            if to_y <= to_x {
                origin.y = side_y.other;
                start = self.moved(start, [0, side_y.way]);
            }
        }
        Meeting::Lost
    }

    fn offset(&self, shift: [i32; 2]) -> Vec3 {
        offset(&self.extents, shift)
    }
}

impl Geometry for Mesh {
    fn check_media(&self, media: &[[u16; 2]]) -> Result<()> {
        media::check(&self.scene, &self.extents, media)
    }

    fn depth(&self) -> [f64; 2] {
        self.depth
    }

    fn period(&self) -> [f64; 2] {
        self.extents.map(|e| {
            if e.repeated {
                e.limits[1] - e.limits[0]
            } else {
                f64::INFINITY
            }
        })
    }

    fn area(&self) -> Area {
        Area {
            x: self.extents[0].limits,
            y: self.extents[1].limits,
        }
    }

    fn meet(&self, ray: &mut Ray) -> Meeting {
        let mut meeting = Meeting::Lost;
        self.meet_all(std::slice::from_mut(ray), std::slice::from_mut(&mut meeting));
        meeting
    }

    fn meet_all(&self, rays: &mut [Ray], meetings: &mut [Meeting]) {
        #[cfg(target_arch = "x86_64")]
        if let Some(lanes) = pulp::x86::V3::try_new() {
            lanes.vectorize(Many {
                mesh: self,
                lanes,
                rays,
                meetings,
            });
            return;
        }
        let mesh = self;
        let lanes = Plain;
        NullaryFnOnce::call(Many {
            mesh,
            lanes,
            rays,
            meetings,
        });
    }
}

/// Many rays, followed by the same instructions.
struct Many<'a, L> {
    mesh: &'a Mesh,
    lanes: L,
    rays: &'a mut [Ray],
    meetings: &'a mut [Meeting],
}

impl<L: Lanes> NullaryFnOnce for Many<'_, L> {
    type Output = ();

    #[allow(
        clippy::inline_always,
        reason = "what runs on vector instructions must be made with them"
    )]
    #[inline(always)]
    fn call(self) {
        let mut stack = Stack::with_capacity(64);
        for (ray, meeting) in self.rays.iter_mut().zip(self.meetings) {
            *meeting = self.mesh.follow(self.lanes, ray, &mut stack);
        }
    }
}

/// The side of the cell that a ray goes to.
#[derive(Debug, Clone, Copy)]
struct Side {
    /// Coordinate of it, infinite where nothing is repeated.
    at: f64,
    /// Coordinate of the opposite one, where the ray comes in again.
    other: f64,
    way: i32,
}

impl Side {
    fn new(extent: &Extent, direction: f64) -> Self {
        let [low, high] = extent.limits;
        let (at, other, way) = if direction > 0.0 {
            (high, low, 1)
        } else {
            (low, high, -1)
        };
        Self {
            at: if extent.repeated && direction != 0.0 {
                at
            } else {
                f64::INFINITY
            },
            other,
            way,
        }
    }

    fn distance(&self, from: f64, direction: f64) -> f64 {
        if self.at == f64::INFINITY {
            return f64::INFINITY;
        }
        ((self.at - from) / direction).max(0.0)
    }
}

fn offset(extents: &[Extent; 2], shift: [i32; 2]) -> Vec3 {
    let [x, y] = [0, 1].map(|axis| {
        let Extent { limits, repeated } = extents[axis];
        if repeated && shift[axis] != 0 {
            f64::from(shift[axis]) * (limits[1] - limits[0])
        } else {
            0.0
        }
    });
    Vec3::new(x, y, 0.0)
}

/// Everything that reaches into the cell.
struct Copies {
    all: Vec<Copy>,
    first: Vec<u32>,
    shapes: Vec<Shape>,
    boxes: Vec<[Vec3; 2]>,
}

fn copies(scene: &Scene, extents: &[Extent; 2], cell: [[f64; 2]; 2], sides: [[f64; 2]; 2]) -> Result<Copies> {
    let mut made = Copies {
        all: Vec::with_capacity(scene.elements.len()),
        first: Vec::with_capacity(scene.elements.len() + 1),
        shapes: Vec::with_capacity(scene.elements.len()),
        boxes: Vec::with_capacity(scene.elements.len()),
    };
    // Shifts that can bring bounds into the cell.
    let range = |axis: usize, low: f64, high: f64| -> [f64; 2] {
        let Extent { limits, repeated } = extents[axis];
        if !repeated {
            return [0.0, 0.0];
        }
        let period = limits[1] - limits[0];
        [
            ((cell[axis][0] - high) / period).ceil(),
            ((cell[axis][1] - low) / period).floor(),
        ]
    };
    let mut count = 0.0;
    let most = MOST_COPIES[0] + MOST_COPIES[1] * scene.elements.len() as f64;
    for (number, element) in scene.elements.iter().enumerate() {
        made.first.push(made.all.len() as u32);
        let [low, high] = element.shape.bounds();
        let [x, y] = [range(0, low.x, high.x), range(1, low.y, high.y)];
        count += (x[1] - x[0] + 1.0).max(0.0) * (y[1] - y[0] + 1.0).max(0.0);
        if !(count <= most && [x, y].iter().flatten().all(|s| s.abs() < 1e9)) {
            return Err(Error::Argument(format!(
                "{} reaches over too many periods: the scene is {:.3e} m by {:.3e} m, its periods are {:.3e} m by {:.3e} m \
                 (check unit and period)",
                scene.name(number),
                sides[0][1] - sides[0][0],
                sides[1][1] - sides[1][0],
                extents[0].limits[1] - extents[0].limits[0],
                extents[1].limits[1] - extents[1].limits[0],
            )));
        }
        for i in x[0] as i32..=x[1] as i32 {
            for j in y[0] as i32..=y[1] as i32 {
                let shift = [i, j];
                let shape = element.shape.shifted(offset(extents, shift));
                if let Some(bounds) = clip::bounds(&shape, cell) {
                    made.all.push(Copy {
                        element: number as u32,
                        shift,
                    });
                    made.shapes.push(shape);
                    made.boxes.push(bounds);
                }
            }
        }
    }
    made.first.push(made.all.len() as u32);
    Ok(made)
}

#[cfg(test)]
mod tests {
    use super::testing::{cube, prisms, quad};
    use super::*;
    use crate::sequence::uniform;

    fn repeated(limits: [f64; 2]) -> Extent {
        Extent { limits, repeated: true }
    }

    fn free(limits: [f64; 2]) -> Extent {
        Extent {
            limits,
            repeated: false,
        }
    }

    fn v(x: f64, y: f64, z: f64) -> Vec3 {
        Vec3::new(x, y, z)
    }

    fn direction(k: u64, seed: u64) -> Vec3 {
        let z = 2.0 * uniform(seed, 2 * k) - 1.0;
        let phi = std::f64::consts::TAU * uniform(seed, 2 * k + 1);
        let r = (1.0 - z * z).sqrt();
        v(r * phi.cos(), r * phi.sin(), z)
    }

    #[test]
    fn no_ray_gets_out_of_a_closed_cube() {
        for size in [5e-5, 0.07, 2.0] {
            let limits = [-size, size];
            let mesh = Mesh::new(cube(size), [free(limits), free(limits)]).expect("a sound scene");
            let mut ray = Ray {
                origin: Vec3::default(),
                direction: v(0.0, 0.0, 1.0),
                piece: NO_PIECE,
            };
            for k in 0..300_000 {
                ray.direction = direction(k, 3);
                if ray.piece != NO_PIECE {
                    // Away from the wall, to the inside.
                    let normal = mesh.normals[mesh.copies[ray.piece as usize].element as usize];
                    if ray.direction.dot(normal) > 0.0 {
                        ray.direction = -ray.direction;
                    }
                }
                let Meeting::Hit(hit) = mesh.meet(&mut ray) else {
                    panic!("{size}: ray {k} got out: {ray:?}")
                };
                assert!(
                    hit.normal.dot(ray.direction) > 0.0 && hit.distance > 0.0,
                    "{size}: {ray:?}"
                );
                assert!(ray.origin.length() < size);
            }
        }
    }

    #[test]
    fn no_ray_gets_lost_in_a_film_of_prisms() {
        for size in [5e-5, 0.07, 2.0] {
            let scene = prisms(size);
            let extents = [repeated([0.0, 2.0 * size]), repeated([0.0, size])];
            let mesh = Mesh::new(scene, extents).expect("a sound scene");
            let mut inside = false;
            let start = Ray {
                origin: v(0.3 * size, 0.2 * size, -1e-3 * size),
                direction: v(0.0, 0.0, 1.0),
                piece: NO_PIECE,
            };
            let mut ray = start;
            for k in 0..300_000_u64 {
                ray.direction = direction(k, 5);
                if ray.piece == NO_PIECE {
                    ray.direction.z = ray.direction.z.abs();
                } else if uniform(9, k) < 0.5 {
                    // Through the border, or back from it.
                    inside = !inside;
                }
                if ray.piece != NO_PIECE {
                    let normal = mesh.normals[mesh.copies[ray.piece as usize].element as usize];
                    if (ray.direction.dot(normal) > 0.0) == inside {
                        ray.direction = -ray.direction;
                    }
                }
                match mesh.meet(&mut ray) {
                    Meeting::Hit(hit) => {
                        assert_eq!(hit.normal.dot(ray.direction) > 0.0, inside, "{size}: ray {k} {ray:?}");
                        let cell = mesh.area();
                        let near = |x: f64, [low, high]: [f64; 2]| x > low - 1e-12 * size && x < high + 1e-12 * size;
                        assert!(near(ray.origin.x, cell.x) && near(ray.origin.y, cell.y));
                    }
                    Meeting::Leaves => {
                        assert!(!inside, "{size}: ray {k} left from inside");
                        ray = start;
                    }
                    Meeting::Lost => panic!("{size}: ray {k} was lost"),
                }
            }
        }
    }

    #[test]
    fn repeated_spheres_are_met_in_other_cells_and_from_themselves() {
        let mut scene = Scene::default();
        let object = scene.object("ball");
        // It reaches over two sides of the cell.
        let ball = Shape::Sphere {
            centre: v(0.9, 0.1, 0.0),
            radius: 0.25,
            inward: false,
        };
        scene.push(ball, 0, object);
        let mesh = Mesh::new(scene, [repeated([0.0, 1.0]), repeated([0.0, 1.0])]).expect("a sound scene");
        assert_eq!(mesh.copies.len(), 4);
        // Along x through the middles, from ball to ball.
        let mut ray = Ray {
            origin: v(0.5, 0.1, 0.0),
            direction: v(1.0, 0.0, 0.0),
            piece: NO_PIECE,
        };
        let mut told = Vec::new();
        for _ in 0..4 {
            let Meeting::Hit(hit) = mesh.meet(&mut ray) else {
                panic!("nothing met")
            };
            told.push(hit.distance);
        }
        for (told, expected) in told.iter().zip([0.15, 0.5, 0.5, 0.5]) {
            assert!((told - expected).abs() < 1e-12, "{told}");
        }
        // One that rises slowly meets the ball that geometry says, many cells on.
        let slope = Vec3::new(1.0, 0.0, 0.02).unit();
        let mut ray = Ray {
            origin: v(0.5, 0.1, -0.6),
            direction: slope,
            piece: NO_PIECE,
        };
        let Meeting::Hit(hit) = mesh.meet(&mut ray) else {
            panic!("nothing met")
        };
        let expected = (0..40)
            .map(|k| {
                let ball = ball.shifted(v(f64::from(k), 0.0, 0.0));
                ball.meet(v(0.5, 0.1, -0.6), slope, false)
            })
            .fold(f64::INFINITY, f64::min);
        assert!((hit.distance - expected).abs() < 1e-12, "{} {expected}", hit.distance);
    }

    #[test]
    fn what_is_not_repeated_is_missed_by_rays_beside_it() {
        let wire = Shape::Cone {
            ends: [v(-1.0, 0.5, 0.0), v(2.0, 0.5, 0.0)],
            radii: [0.1; 2],
            inward: false,
        };
        let mut scene = Scene::default();
        let object = scene.object("wire");
        scene.push(wire, 0, object);
        let part = Extent {
            limits: [0.0, 1.0],
            repeated: false,
        };
        let mesh = Mesh::new(scene, [part, part]).expect("a sound scene");
        for (y, meets) in [(0.2, false), (0.45, true), (0.55, true), (0.9, false)] {
            let mut ray = Ray {
                origin: v(0.5, y, -0.3),
                direction: v(0.0, 0.0, 1.0),
                piece: NO_PIECE,
            };
            assert_eq!(matches!(mesh.meet(&mut ray), Meeting::Hit(_)), meets, "{y}");
        }
    }

    #[test]
    fn a_flat_sheet_is_met_by_rays_from_both_ends() {
        let mut scene = Scene::default();
        quad(
            &mut scene,
            [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.0), v(0.0, 1.0, 0.0)],
            7,
        );
        let mesh = Mesh::new(scene, [repeated([0.0, 1.0]), repeated([0.0, 1.0])]).expect("a sound scene");
        for k in 0..100_000 {
            let mut d = direction(k, 21);
            d.z = d.z.abs() + 1e-4;
            let [bottom, top] = mesh.depth();
            for (z, direction) in [(bottom, d), (top, -d), (-3.0, d)] {
                let mut ray = Ray {
                    origin: v(uniform(4, 2 * k), uniform(4, 2 * k + 1), z),
                    direction: direction.unit(),
                    piece: NO_PIECE,
                };
                let Meeting::Hit(hit) = mesh.meet(&mut ray) else {
                    panic!("{k}: {ray:?}")
                };
                assert_eq!((hit.surface, hit.normal), (7, v(0.0, 0.0, 1.0)));
                assert!(ray.origin.z.abs() < 1e-15);
                ray.direction = direction.unit();
                assert_eq!(mesh.meet(&mut ray), Meeting::Leaves);
            }
        }
    }

    #[test]
    fn a_piece_longer_than_its_period_is_there_as_often_as_it_overlaps() {
        // A slope that climbs by 3 periods: every vertical ray meets it three times.
        let mut scene = Scene::default();
        quad(
            &mut scene,
            [v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 3.0, 0.3), v(0.0, 3.0, 0.3)],
            0,
        );
        let mesh = Mesh::new(scene, [repeated([0.0, 1.0]), repeated([0.0, 1.0])]).expect("a sound scene");
        for k in 0..10_000 {
            let mut ray = Ray {
                origin: v(uniform(1, 2 * k), uniform(1, 2 * k + 1), -1.0),
                direction: v(0.0, 0.0, 1.0),
                piece: NO_PIECE,
            };
            let mut count = 0;
            while let Meeting::Hit(_) = mesh.meet(&mut ray) {
                count += 1;
            }
            assert_eq!(count, 3);
        }
    }

    #[test]
    fn an_extruded_mesh_is_its_profile() {
        // A tilted slat and a folded one, 72 mm apart; the mesh is 50 mm wide and repeated.
        let (pitch, wide) = (0.072, 0.05);
        let points = [[-0.03, 0.01], [0.04, 0.03], [0.0, 0.055], [-0.035, 0.05]];
        let mut scene = Scene::default();
        let mut pieces = Vec::new();
        for (from, to) in [(0, 1), (2, 1), (3, 2)] {
            let ([z0, y0], [z1, y1]) = (points[from], points[to]);
            pieces.push(crate::geometry::Piece {
                from: [z0, y0],
                to: [z1, y1],
                turn: 0.0,
                surface: from as u32,
            });
            let corners = [v(0.0, y1, z1), v(wide, y1, z1), v(wide, y0, z0), v(0.0, y0, z0)];
            quad(&mut scene, corners, from as u32);
        }
        let profile = crate::geometry::Profile::new(pieces, pitch).expect("a sound section");
        let mesh = Mesh::new(scene, [repeated([0.0, wide]), repeated([0.0, pitch])]).expect("a sound scene");
        let (mut hits, mut bounces) = (0, 0);
        for k in 0..50_000 {
            let mut direction = direction(k, 31);
            direction.z = direction.z.abs().max(1e-3);
            let origin = v(wide * uniform(2, 2 * k), pitch * uniform(2, 2 * k + 1), -0.05);
            let mut ours = Ray {
                origin,
                direction: direction.unit(),
                piece: NO_PIECE,
            };
            let mut theirs = ours;
            // In step, mirrored at each hit, until both leave.
            for _ in 0..20 {
                match (mesh.meet(&mut ours), profile.meet(&mut theirs)) {
                    (Meeting::Hit(a), Meeting::Hit(b)) => {
                        let same = (a.distance - b.distance).abs() < 1e-9 * b.distance.max(1e-3);
                        let turned = a.normal.dot(b.normal);
                        assert!(same && (turned - 1.0).abs() < 1e-12, "{k}: {a:?} {b:?}");
                        assert_eq!(a.surface, b.surface);
                        let d = ours.direction;
                        ours.direction = (d - a.normal * (2.0 * d.dot(a.normal))).unit();
                        theirs.direction = ours.direction;
                        hits += 1;
                    }
                    (Meeting::Leaves, Meeting::Leaves) => break,
                    (a, b) => panic!("{k}: {a:?} {b:?}"),
                }
                bounces += 1;
            }
        }
        assert!(hits > 50_000 && bounces == hits, "{hits} {bounces}");
    }

    #[test]
    fn scenes_that_cannot_be_are_told_with_their_place() {
        let tell = |shape: Shape, extents: [Extent; 2]| {
            let mut scene = Scene::default();
            let object = scene.object("slat.3");
            scene.push(shape, 0, object);
            Mesh::new(scene, extents).expect_err("a fault").to_string()
        };
        let cell = [repeated([0.0, 1.0]), repeated([0.0, 1.0])];
        let sound = Shape::Triangle([v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0)]);
        assert_eq!(
            tell(
                Shape::Triangle([v(0.0, 0.0, 0.0), v(1.0, 1.0, 0.0), v(0.25, 0.25, 0.0)]),
                cell
            ),
            "\"slat.3\" (triangle) has no area: corners at (0, 0, 0) m, (1, 1, 0) m and (0.25, 0.25, 0) m (remove it, or \
             merge its corners)"
        );
        assert!(
            tell(
                Shape::Triangle([v(0.0, f64::NAN, 0.0), v(1.0, 1.0, 0.0), v(0.25, 0.25, 0.0)]),
                cell
            )
            .contains("a point at (0, NaN, 0) m")
        );
        assert!(tell(sound, [cell[0], repeated([1.0, 1.0])]).contains("a period of 0 m along y"));
        assert!(tell(sound, [free([1.0, 0.0]), cell[1]]).contains("a length of the sampled area of -1 m along x"));
        assert!(tell(sound, [cell[0], repeated([0.0, 1e-9])]).contains("reaches over too many periods"));
        let sphere = Shape::Sphere {
            centre: v(0.0, 0.0, 0.0),
            radius: 0.0,
            inward: false,
        };
        assert!(tell(sphere, cell).contains("(sphere) has a radius of 0 m"));
        assert!(Mesh::new(Scene::default(), cell).is_err());
    }
}
