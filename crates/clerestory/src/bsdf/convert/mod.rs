//! From any model to a table, by integrating the source over the target's cells.
//!
//! * To a matrix on any pair of bases: [`to_matrix`]; a whole data set: [`all_to_matrix`].
//! * To a tensor tree: [`to_tree`]; a whole data set: [`all_to_tree`].

mod cover;
mod dataset;
mod isotropy;
mod kernel;
mod leaves;
mod lobes;
mod matrix;
mod overlap;
mod points;
#[cfg(test)]
pub(super) mod testing;
mod tree;

pub use dataset::{Report, all_to_matrix, all_to_tree};
pub use isotropy::anisotropy;
pub(super) use lobes::as_tree;
pub use matrix::{Conversion, to_matrix};
pub(super) use overlap::shares;
pub use tree::{MAX_ANISOTROPY, TreeConversion, to_tree};

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

    fn check(self, patches: usize) -> Result<()> {
        // 1 GB of points.
        let most = ((1_usize << 26) / patches).max(2);
        if (2..=most).contains(&(self.samples as usize)) {
            return Ok(());
        }
        Err(Error::Argument(format!(
            "{} samples a patch pair cannot be taken (give 2 to {most})",
            self.samples
        )))
    }
}
