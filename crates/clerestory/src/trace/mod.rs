//! The virtual goniophotometer: rays through a sample, collected by direction.
//!
//! * [`Sample`]: layers of geometry, their surfaces, materials and media.
//! * [`Goniophotometer`]: incident directions in, matrices with standard errors out.
//! * [`Balance`]: where the traced flux went.

mod balance;
mod flight;
mod goniophotometer;
mod sample;

pub use balance::Balance;
pub use flight::{Collector, Limits};
pub use goniophotometer::{Goniophotometer, Measured};
pub use sample::Sample;
