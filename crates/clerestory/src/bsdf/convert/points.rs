//! Sample points in the patches of a basis.

use std::sync::{Arc, OnceLock};

use rayon::prelude::*;

use super::Sampling;
use crate::basis::Basis;
use crate::direction::Disk;
use crate::sequence::{r4, uniform};

/// Which half of the four dimensions the points take.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Role {
    /// Dimensions 0 and 1.
    Incident,
    /// Dimensions 2 and 3.
    Outgoing,
}

/// Cosine-weighted points in every patch, made when they are first asked for.
///
/// Point k of an incident patch goes with point k of an outgoing one: together they are a four-dimensional additive
/// recurrence, shifted differently for every pair of patches.
pub struct Points {
    /// The basis.
    pub basis: Arc<Basis>,
    /// Points a patch.
    pub count: usize,
    role: Role,
    seed: u64,
    disks: OnceLock<Vec<Disk>>,
}

impl Points {
    /// `sampling.samples` points in every patch.
    pub fn new(basis: &Arc<Basis>, role: Role, sampling: Sampling) -> Self {
        Self {
            basis: basis.clone(),
            count: sampling.samples as usize,
            role,
            seed: sampling.seed,
            disks: OnceLock::new(),
        }
    }

    /// The first ones of each patch, so many times fewer: an even number.
    pub fn thinned(&self, times: usize) -> Self {
        let samples = (self.count / times / 2 * 2).max(2) as u32;
        let seed = self.seed;
        Self::new(&self.basis, self.role, Sampling { samples, seed })
    }

    /// All points, patch by patch.
    pub fn all(&self) -> &[Disk] {
        self.disks.get_or_init(|| {
            let first = if self.role == Role::Incident { 0 } else { 2 };
            let stream = self
                .seed
                .wrapping_mul(2)
                .wrapping_add(u64::from(self.role == Role::Outgoing));
            let mut disks = vec![Disk::NORMAL; self.basis.len() * self.count];
            disks
                .par_chunks_mut(self.count)
                .enumerate()
                .for_each(|(patch, points)| {
                    let shift = std::array::from_fn(|d| uniform(stream, 4 * patch as u64 + d as u64));
                    for (k, point) in (0..).zip(points) {
                        let u = r4(k, shift);
                        *point = self.basis.sample_cosine(patch, [u[first], u[first + 1]]);
                    }
                });
            disks
        })
    }

    /// Points of a patch.
    pub fn of(&self, patch: usize) -> &[Disk] {
        &self.all()[patch * self.count..(patch + 1) * self.count]
    }
}
