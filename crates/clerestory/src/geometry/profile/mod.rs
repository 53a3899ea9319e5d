//! Extruded sections: infinite in x, repeated in y, made of straight segments and exact circular arcs in the (z, y) plane.

mod closed;
mod few;
mod lanes;
mod many;
mod part;
mod soundness;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;

use pulp::Arch;

use self::few::{BLOCK, Block, FARTHEST, Few, Target};
use self::many::{Many, Tree};
use self::part::Part;
use super::{Area, Geometry, Hit, Meeting, NO_PIECE, Ray, Vec3};
use crate::error::Result;

/// A stretch of a section, from one end to the other. Its front is on the left of the way from `from` to `to`, seen with z
/// to the right and y up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Piece {
    /// First end, (z, y) in metres.
    pub from: [f64; 2],
    /// Last end, (z, y) in metres.
    pub to: [f64; 2],
    /// Angle that the way turns through (radians), counter-clockwise positive, less than 2π; 0 for a straight segment.
    pub turn: f64,
    /// Number of its surface in the sample's list.
    pub surface: u32,
}

/// A periodic section.
#[derive(Debug, Clone)]
pub struct Profile {
    parts: Vec<Part>,
    /// The first parts, which every ray is tried against.
    targets: Vec<Target>,
    /// The others.
    tree: Option<Tree>,
    period: f64,
    depth: [f64; 2],
    arch: Arch,
}

/// Parts up to which a hierarchy does not pay.
const FEW: usize = 12;
/// Of more parts, these many are kept out of the hierarchy at most: those that would widen its boxes.
const LONG: usize = 4;

/// Sorts parts so that those come first that every ray is to be tried against, and counts these.
fn put_first(parts: &mut [Part], period: f64) -> usize {
    let count = if parts.len() <= FEW {
        parts.len()
    } else {
        parts.sort_by(|a, b| b.half.total_cmp(&a.half));
        parts[..LONG].iter().take_while(|p| p.half > 0.2 * period).count()
    };
    // Straight parts are the quicker ones, and what they stop need not be looked for among arcs.
    parts[..count].sort_by_key(|p| p.curvature != 0.0);
    count
}

impl Profile {
    /// From the pieces of one period and its height (metres). Pieces may reach beyond it. Fails, naming the place, where
    /// the period is not above 0, a piece has no length or turns too far, or pieces cross or touch other than end to end.
    pub fn new(pieces: impl AsRef<[Piece]>, period: f64) -> Result<Self> {
        let pieces = pieces.as_ref();
        soundness::pieces(pieces, period)?;
        let mut parts: Vec<Part> = pieces
            .iter()
            .enumerate()
            .flat_map(|(number, piece)| Part::of(number, piece))
            .collect();
        soundness::crossings(&parts, period)?;
        let few = put_first(&mut parts, period);
        let low = parts.iter().map(|p| p.z[0]).fold(f64::INFINITY, f64::min);
        let high = parts.iter().map(|p| p.z[1]).fold(f64::NEG_INFINITY, f64::max);
        Ok(Self {
            tree: Tree::new(&parts, few, period),
            targets: parts[..few].iter().map(|p| Target::new(p, period)).collect(),
            parts,
            period,
            depth: [low, high],
            arch: Arch::new(),
        })
    }

    /// A block of rays and what they meet.
    fn meet_block<const B: usize>(&self, rays: &mut [Ray], meetings: &mut [Meeting]) {
        let mut block = Block::<B>::new();
        for (k, ray) in rays.iter().enumerate() {
            block.z[k] = ray.origin.z;
            block.y[k] = ray.origin.y;
            block.dz[k] = ray.direction.z;
            block.dy[k] = ray.direction.y;
            block.own[k] = if ray.piece == NO_PIECE {
                -1.0
            } else {
                f64::from(ray.piece)
            };
        }
        self.arch.dispatch(Few {
            targets: &self.targets,
            period: self.period,
            block: &mut block,
            count: rays.len(),
        });
        if let Some(tree) = &self.tree {
            self.arch.dispatch(Many {
                tree,
                block: &mut block,
                count: rays.len(),
            });
        }
        for (k, (ray, meeting)) in rays.iter_mut().zip(meetings).enumerate() {
            *meeting = if block.part[k] < 0.0 {
                self.unmet(ray)
            } else {
                let part = block.part[k] as u32;
                self.met(ray, part, block.distance[k], [block.along[k], block.across[k]])
            };
        }
    }

    /// A ray that meets nothing.
    fn unmet(&self, ray: &Ray) -> Meeting {
        let way = self.period * f64::from(FARTHEST) * ray.direction.z.abs();
        if way > (self.depth[1] - self.depth[0]) * ray.direction.y.abs() {
            Meeting::Leaves
        } else {
            Meeting::Lost
        }
    }

    /// Moves a ray to a place on a part, in the period where that is defined.
    fn met(&self, ray: &mut Ray, number: u32, distance: f64, [along, across]: [f64; 2]) -> Meeting {
        let part = &self.parts[number as usize];
        let (n, t) = (part.normal, part.along());
        let p = [t[0] * along + n[0] * across, t[1] * along + n[1] * across];
        ray.origin = Vec3::new(
            ray.origin.x + ray.direction.x * distance,
            part.middle[1] + p[1],
            part.middle[0] + p[0],
        );
        ray.piece = number;
        let normal = part.normal_at(p);
        Meeting::Hit(Hit {
            distance,
            normal: Vec3::new(0.0, normal[1], normal[0]),
            surface: part.surface,
        })
    }
}

impl Geometry for Profile {
    fn check_media(&self, media: &[[u16; 2]]) -> Result<()> {
        closed::check(self, media)
    }

    fn depth(&self) -> [f64; 2] {
        self.depth
    }

    fn period(&self) -> [f64; 2] {
        [0.0, self.period]
    }

    fn area(&self) -> Area {
        Area {
            x: [0.0, 0.0],
            y: [0.0, self.period],
        }
    }

    fn meet(&self, ray: &mut Ray) -> Meeting {
        let mut meeting = [Meeting::Lost];
        self.meet_block::<8>(std::slice::from_mut(ray), &mut meeting);
        meeting[0]
    }

    fn meet_all(&self, rays: &mut [Ray], meetings: &mut [Meeting]) {
        for (rays, meetings) in rays.chunks_mut(BLOCK).zip(meetings.chunks_mut(BLOCK)) {
            self.meet_block::<BLOCK>(rays, meetings);
        }
    }
}
