//! From any model to a table, by integrating the source over the target's cells.
//!
//! * To a matrix on any pair of bases: [`to_matrix`]; a whole data set: [`all_to_matrix`].

mod dataset;
mod kernel;
mod matrix;
mod overlap;
mod points;
#[cfg(test)]
mod testing;

pub use dataset::{Report, all_to_matrix};
pub use matrix::{Conversion, to_matrix};

use crate::error::{Error, Result};

/// How a source is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Sampling {
    /// Pairs of directions a cell of the target; 256 to 512 are usual.
    pub samples: u32,
    /// Shifts all points; results of different seeds are independent.
    pub seed: u64,
}

impl Default for Sampling {
    fn default() -> Self {
        Self { samples: 256, seed: 0 }
    }
}

impl Sampling {
    /// So many samples, first seed.
    pub fn of(samples: u32) -> Self {
        Self {
            samples,
            ..Self::default()
        }
    }

    fn check(self) -> Result<()> {
        if (2..=1 << 20).contains(&self.samples) {
            return Ok(());
        }
        Err(Error::Argument(format!(
            "{} samples a patch pair cannot be taken (give 2 to {})",
            self.samples,
            1 << 20
        )))
    }
}
