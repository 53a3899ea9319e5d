//! Pictures of a room: where each pixel looks, and what comes from there.
//!
//! A [`View`] says where an eye is and what it sees, in the words of Radiance's pictures. A [`Camera`] is a view that was
//! checked, and turns points of the picture into rays and back. A [`Picture`] holds radiances, and is read and written as
//! Radiance's HDR ([`hdr`]) or OpenEXR ([`openexr`]).

mod camera;
pub mod colour;
pub mod hdr;
mod header;
mod image;
pub mod openexr;
mod projection;
mod scanline;
mod solid_angle;
mod view;

pub use camera::Camera;
pub use image::Picture;
pub use projection::Projection;
pub(crate) use solid_angle::mirrored;
pub use view::View;
