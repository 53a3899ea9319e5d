//! Pictures of a room: where each pixel looks, and what comes from there.
//!
//! A [`View`] says where an eye is and what it sees, in the words of Radiance's pictures. A [`Camera`] is a view that was
//! checked, and turns points of the picture into rays and back.

mod camera;
mod projection;
mod solid_angle;
mod view;

pub use camera::Camera;
pub use projection::Projection;
pub use view::View;
