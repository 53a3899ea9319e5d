//! Sample points in the patches of a basis.

use std::sync::Arc;

use rayon::prelude::*;

use super::Sampling;
use crate::basis::Basis;
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;
use crate::sequence::{r4, uniform};

/// Which half of the four dimensions the points take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Dimensions 0 and 1.
    Incident,
    /// Dimensions 2 and 3.
    Outgoing,
}

/// Cosine-weighted points in every patch.
///
/// Point k of an incident patch goes with point k of an outgoing one: together they are a four-dimensional additive
/// recurrence, shifted differently for every pair of patches.
pub struct Points {
    /// The basis.
    pub basis: Arc<Basis>,
    /// Points a patch.
    pub count: usize,
    disks: Vec<Disk>,
}

impl Points {
    /// `sampling.samples` points in every patch.
    pub fn new(basis: &Arc<Basis>, role: Role, sampling: Sampling, progress: &Progress) -> Result<Self> {
        let first = if role == Role::Incident { 0 } else { 2 };
        let seed = sampling
            .seed
            .wrapping_mul(2)
            .wrapping_add(u64::from(role == Role::Outgoing));
        let count = sampling.samples as usize;
        let mut disks = vec![Disk::NORMAL; basis.len() * count];
        disks
            .par_chunks_mut(count)
            .enumerate()
            .try_for_each(|(patch, points)| {
                let shift = std::array::from_fn(|d| uniform(seed, 4 * patch as u64 + d as u64));
                for (k, point) in (0..).zip(points) {
                    let u = r4(k, shift);
                    *point = basis.sample_cosine(patch, [u[first], u[first + 1]]);
                }
                progress.check()
            })?;
        Ok(Self {
            basis: basis.clone(),
            count,
            disks,
        })
    }

    /// All points, patch by patch.
    pub fn all(&self) -> &[Disk] {
        &self.disks
    }

    /// Points of a patch.
    pub fn of(&self, patch: usize) -> &[Disk] {
        &self.disks[patch * self.count..(patch + 1) * self.count]
    }
}
