//! Clerestory's core: how a window system (blind, fabric, film, glass) scatters light.
//!
//! * To name a direction or a side: [`direction`].
//! * To divide a hemisphere into patches: [`basis`].
//! * To evaluate, sample, integrate or convert a scattering model: [`bsdf`].
//! * To build a window of layers: [`system`].
//! * To measure a sample that is given by its geometry: [`trace`], of [`geometry`] and [`material`].
//! * To light a scene by sky and sun: [`sky`].
//! * To look into a room: [`room`].
//! * To say what an eye sees: [`picture`], and how it glares: [`glare`].
//! * To read and write the field's files: [`io`].
//!
//! Nothing here knows of Python or of a console.

pub mod basis;
pub mod bsdf;
pub mod compare;
pub mod direction;
pub mod error;
pub mod geometry;
pub mod glare;
pub mod io;
pub mod material;
pub mod picture;
pub mod progress;
pub mod room;
pub mod sequence;
mod simplex;
pub mod sky;
pub mod system;
pub mod trace;

pub use error::{Error, Result};
