//! Long work that can be watched and stopped from another thread.

use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};

use crate::error::{Error, Result};

/// How far a piece of work is, and whether it should stop.
#[derive(Debug, Default)]
pub struct Progress {
    stop: AtomicBool,
    done: AtomicUsize,
    total: AtomicUsize,
    /// Bits of the largest error so far; those of numbers of 0 or more sort as they do.
    error: AtomicU64,
}

impl Progress {
    /// Asks the work to stop; it ends with [`Error::Interrupted`].
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Announces further steps.
    pub fn expect(&self, steps: usize) {
        self.total.fetch_add(steps, Ordering::Relaxed);
    }

    /// One step is done; fails if the work should stop.
    pub fn step(&self) -> Result<()> {
        self.done.fetch_add(1, Ordering::Relaxed);
        self.check()
    }

    /// Fails if the work should stop.
    pub fn check(&self) -> Result<()> {
        if self.stop.load(Ordering::Relaxed) {
            return Err(Error::Interrupted);
        }
        Ok(())
    }

    /// Tells the error of a part of the result (relative; 0 or more).
    pub fn tell_error(&self, error: f64) {
        if error >= 0.0 {
            self.error.fetch_max(error.to_bits(), Ordering::Relaxed);
        }
    }

    /// The largest error of any part of the result so far; none before the first is known.
    pub fn error(&self) -> Option<f64> {
        match f64::from_bits(self.error.load(Ordering::Relaxed)) {
            0.0 => None,
            error => Some(error),
        }
    }

    /// Share of the announced steps that is done, 0 to 1.
    pub fn fraction(&self) -> f64 {
        let total = self.total.load(Ordering::Relaxed);
        if total == 0 {
            return 0.0;
        }
        (self.done.load(Ordering::Relaxed) as f64 / total as f64).min(1.0)
    }
}
