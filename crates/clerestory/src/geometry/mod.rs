//! Shapes of samples, and where rays meet them.
//!
//! * [`Vec3`], [`Ray`], [`Meeting`]: the words.
//! * [`Geometry`]: what every shape offers.
//! * [`Mesh`]: triangles and exact round shapes, repeated or not, made from a [`Scene`].
//! * [`Profile`]: a section of segments and arcs, infinite in x and periodic in y, met exactly.
//!
//! Lengths are metres. A sample lies in the plane z = 0 or about it; rays enter through the plane at the end of its depth
//! on their side, and leave when nothing can be met any more.

mod mesh;
mod profile;
mod vector;

pub use mesh::{Element, Extent, Mesh, Scene, Shape};
pub use profile::{Piece, Profile};
pub use vector::Vec3;

use crate::error::Result;

/// No piece: the ray starts in free space.
pub const NO_PIECE: u32 = u32::MAX;

/// A ray on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it is (metres).
    pub origin: Vec3,
    /// Unit vector of travel.
    pub direction: Vec3,
    /// The piece of the geometry that it leaves from, or [`NO_PIECE`]: a flat piece is not met again by a ray that starts
    /// on it, a curved one only elsewhere.
    pub piece: u32,
}

/// Where a ray meets a piece.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Way since the ray's origin (metres).
    pub distance: f64,
    /// Unit normal of the piece, out of its front.
    pub normal: Vec3,
    /// Number of the piece's surface in the sample's list.
    pub surface: u32,
}

/// What becomes of a ray that flies on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Meeting {
    /// It meets a piece.
    Hit(Hit),
    /// It leaves.
    Leaves,
    /// It cannot be followed: it runs in the sample's plane, or farther than can be counted.
    Lost,
}

/// The part of the plane over which rays start (metres), lower and upper limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Area {
    /// Along x.
    pub x: [f64; 2],
    /// Along y.
    pub y: [f64; 2],
}

/// A shape that rays can meet.
pub trait Geometry: Send + Sync {
    /// Checks that what it is made of agrees on what lies between: bodies are closed, and no piece is the wrong way round.
    /// `media` lists, for each surface, the medium before its front and the one behind its back; medium 0 is about the
    /// sample. Fails naming the place.
    fn check_media(&self, _media: &[[u16; 2]]) -> Result<()> {
        Ok(())
    }

    /// Least and greatest z that anything of it has (metres).
    fn depth(&self) -> [f64; 2];

    /// Periods along x and y (metres): 0 where it is the same everywhere, infinite where it is not repeated.
    fn period(&self) -> [f64; 2];

    /// Where rays start: one period, or the central part of a shape that is not repeated.
    fn area(&self) -> Area;

    /// Follows a ray. At a hit the ray's origin is moved there (whole periods may be taken off) and its piece is set.
    fn meet(&self, ray: &mut Ray) -> Meeting;

    /// Follows many rays; `meetings` is as long as `rays`.
    fn meet_all(&self, rays: &mut [Ray], meetings: &mut [Meeting]) {
        for (ray, meeting) in rays.iter_mut().zip(meetings) {
            *meeting = self.meet(ray);
        }
    }
}
