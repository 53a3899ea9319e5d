//! Glare: sources in a picture, and what the field's indices say of them.
//!
//! [`evaluate`] finds sources in a picture of luminances as `evalglare` does and rates them; [`rate`] rates sources that are
//! known, for example from a renderer; [`Elements`] are a view whose parts change hour by hour. [`Settings`] stand beside every result, because no two programs have the same.

mod cluster;
mod elements;
mod evaluate;
mod indices;
mod lens;
mod position;
mod settings;
mod smooth;

pub use elements::Elements;
pub use evaluate::{Evaluation, evaluate};
pub use indices::{Field, Indices, Light, Source, rate};
pub use lens::Lens;
pub use position::{PositionIndex, position_index};
pub use settings::{Background, Settings, Task, Threshold};
