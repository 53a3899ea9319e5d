//! Scattering models.
//!
//! * What every model can do: [`Scatterer`]. All of it is written on disks of travel directions
//!   ([`Disk`](crate::direction::Disk)), for one component: light from one side, transmitted or reflected.
//! * The models: [`Matrix`] on any pair of angle bases, tensor [`Tree`], [`analytic`] ones, measured [`Beam`]s, [`Sum`]s, the
//!   [`Interpolant`] of a goniophotometer's points; and views of another model: [`Turned`], [`Reversed`], [`Separated`],
//!   [`Filtered`].
//! * A whole data set with its bands, sides and metadata: [`Bsdf`].
//! * From any model to a table: [`convert`]; to known totals: [`normalise`]; to a reciprocal one: [`reciprocity`];
//!   of many lights at once: [`gather`].

pub mod analytic;
mod beam;
pub mod convert;
mod data;
mod filtered;
pub mod gather;
pub mod interpolant;
mod lobes;
mod matrix;
mod metadata;
mod mixture;
mod model;
pub mod normalise;
pub mod parts;
mod peaks;
pub mod reciprocity;
mod reversed;
mod scatterer;
mod separated;
mod slab;
mod sum;
pub mod tree;
mod turned;

pub use analytic::{Lambertian, Specular};
pub use beam::{Beam, Cells};
pub use data::{Band, Bsdf, Component, Outcome};
pub use filtered::Filtered;
pub use interpolant::Interpolant;
pub use lobes::{LobeSample, Lobes};
pub use matrix::Matrix;
pub use metadata::{Element, Metadata};
pub use model::Model;
pub use reversed::Reversed;
pub use scatterer::{Estimate, Part, Peak, Region, Sample, Scatterer};
pub use separated::{Cell, Separated, Tabular};
pub use slab::Slab;
pub use sum::Sum;
pub use tree::{Rank, Tree};
pub use turned::{Turn, Turned};
