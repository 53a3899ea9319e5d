//! The virtual goniophotometer: rays through a sample, collected by direction.
//!
//! * [`Sample`]: layers of geometry, their surfaces, materials and media.
//! * [`Goniophotometer`]: incident directions in, tables with standard errors out; its [`Settings`].
//! * [`TreeTarget`]: tensor trees instead of tables, cell by cell.
//! * [`Scan`]: listed incident directions; [`Rays`]: what leaves, path by path.
//! * [`State`]: what is finished of a measurement, so that it can be interrupted and go on.
//! * [`Measured`]: the models, and where the traced flux went.

mod balance;
mod flight;
mod goniophotometer;
mod growth;
mod rays;
mod sample;
mod scan;
mod scene;
mod settings;
mod state;
#[cfg(test)]
mod testing;
mod trees;
mod unit;

pub use balance::{Balance, Tallies};
pub use flight::Limits;
pub use goniophotometer::{Goniophotometer, Measured, Place, Totals};
pub use growth::Merging;
pub use rays::{RaySource, Rays};
pub use sample::Sample;
pub use scan::{Distribution, Scan};
pub use scene::MAX_BANDS;
pub use settings::{Cones, LEAST_VALUE, Settings, Stop};
pub use state::State;
pub use trees::TreeTarget;
