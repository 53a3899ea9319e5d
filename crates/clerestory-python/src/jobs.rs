//! Long work: it runs on a thread of its own, so that Ctrl-C stops it and progress can be shown.

use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use clerestory::progress::Progress;
use pyo3::prelude::*;

use crate::errors::raise;

/// How often Python is asked for signals.
const POLL: Duration = Duration::from_millis(100);

/// What is told of work that goes on.
pub enum Report<'a> {
    /// Called with the share that is done.
    Share(&'a Py<PyAny>),
    /// Called with that and with the largest error so far, or None.
    WithError(&'a Py<PyAny>),
}

impl Report<'_> {
    fn tell(&self, py: Python<'_>, progress: &Progress) -> PyResult<()> {
        let share = progress.fraction();
        match self {
            Self::Share(call) => call.call1(py, (share,)),
            Self::WithError(call) => call.call1(py, (share, progress.error())),
        }
        .map(|_| ())
    }
}

/// Runs `work` without the interpreter lock. Ctrl-C, or an exception from `report`, which is called with the share that is
/// done, stops it.
pub fn watched<T: Send>(
    py: Python<'_>,
    report: Option<&Py<PyAny>>,
    work: impl FnOnce(&Progress) -> clerestory::Result<T> + Send,
) -> PyResult<T> {
    watched_by(py, report.map(Report::Share), work)
}

/// As [`watched`], told as one likes.
pub fn watched_by<T: Send>(
    py: Python<'_>,
    report: Option<Report<'_>>,
    work: impl FnOnce(&Progress) -> clerestory::Result<T> + Send,
) -> PyResult<T> {
    let progress = Progress::default();
    std::thread::scope(|scope| {
        let (done, wait) = channel();
        let watch = &progress;
        let worker = scope.spawn(move || {
            let outcome = work(watch);
            // The other end waits until this thread has ended.
            let _ = done.send(());
            outcome
        });
        let mut stopped = None;
        // A panic drops the sender, which ends the wait as well.
        let mut done = Some(wait);
        while let Some(wait) = done.take() {
            let (outcome, wait) = py.detach(move || (wait.recv_timeout(POLL), wait));
            if outcome == Err(RecvTimeoutError::Timeout) {
                done = Some(wait);
                if stopped.is_none() {
                    let told = report.as_ref().map_or(Ok(()), |r| r.tell(py, &progress));
                    if let Err(error) = py.check_signals().and(told) {
                        progress.stop();
                        stopped = Some(error);
                    }
                }
            }
        }
        let outcome = worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic));
        match stopped {
            Some(error) => Err(error),
            None => outcome.map_err(raise),
        }
    })
}
