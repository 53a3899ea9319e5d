//! Window systems of layers.
//!
//! * To put layers together, and to know what each of them absorbs: [`stack`] (Klems 1994).
//! * To make a clear pane of glass as a layer: [`pane`].

mod errors;
mod flux;
mod layers;
mod linear;
pub mod pane;

pub use flux::PatchValue;
pub use layers::{System, stack};
