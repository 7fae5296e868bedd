//! The limits of one computation: a deadline, a reason to stop, a receiver of progress, and helping threads.
//!
//! A computation below `http` learns only from its budget that it has to stop. Every long loop checks the
//! budget at short intervals. The check returns `Err(Stopped)` if the budget was stopped from outside, for
//! one of the reasons of [`Stopped`], or if the deadline has passed. The computation then ends without a
//! result.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Instant;

use crate::parallel::{self, Helpers};

/// Why a computation was stopped from outside.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Stopped {
    #[error("the computation was cancelled")]
    Cancelled,
    #[error("the deadline passed")]
    DeadlinePassed,
    /// The process needs the memory for other work, and the computation may succeed at another time.
    #[error("the process is short of memory")]
    ShortOfMemory,
    /// The computation alone needs more memory than the process may use.
    #[error("the computation needs more memory than there is")]
    TooLarge,
}

/// Receives progress: the name of a stage and how much of it is done.
pub trait ProgressSink: Send + Sync {
    fn progress(&self, stage: &'static str, done: usize, total: usize);
}

/// The limits of one computation. Cheap to clone; clones are stopped together and share the helpers.
///
/// # Example
/// ```
/// use std::time::{Duration, Instant};
/// use toolpathd_core::budget::{Budget, Stopped};
///
/// let budget = Budget::unlimited().with_deadline(Instant::now() + Duration::from_secs(3600));
/// assert_eq!(budget.check(), Ok(()));
///
/// // Another thread stops the computation at its next check.
/// let clone = budget.clone();
/// std::thread::spawn(move || clone.cancel()).join().unwrap();
/// assert_eq!(budget.check(), Err(Stopped::Cancelled));
/// ```
#[derive(Clone, Default)]
pub struct Budget {
    stopped: Arc<OnceLock<Stopped>>,
    deadline: Option<Instant>,
    sink: Option<Arc<dyn ProgressSink>>,
    helpers: Helpers,
}

impl Budget {
    /// A budget without a deadline and without a receiver of progress. It can still be cancelled.
    pub fn unlimited() -> Self {
        Self::default()
    }

    pub fn with_deadline(mut self, deadline: Instant) -> Self {
        self.deadline = Some(deadline);
        self
    }

    pub fn with_progress(mut self, sink: Arc<dyn ProgressSink>) -> Self {
        self.sink = Some(sink);
        self
    }

    /// Uses `helpers`, whose threads other computations may share. The default is one thread for each
    /// processor of the machine but one.
    pub fn with_helpers(mut self, helpers: Helpers) -> Self {
        self.helpers = helpers;
        self
    }

    /// As [`parallel::in_order`], with the helpers of this budget.
    ///
    /// # Errors
    /// The first error of `make`.
    pub fn in_order<T: Send, E: Send>(
        &self,
        n: usize,
        make: impl Fn(usize) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E> {
        parallel::in_order(&self.helpers, n, make)
    }

    /// Stops the computation at its next check, because the caller has gone away. May be called from any
    /// thread.
    pub fn cancel(&self) {
        self.stop(Stopped::Cancelled);
    }

    /// Stops the computation at its next check. The first reason counts. May be called from any thread.
    pub fn stop(&self, reason: Stopped) {
        let _ = self.stopped.set(reason);
    }

    /// # Errors
    /// `Stopped` when the computation must end now.
    pub fn check(&self) -> Result<(), Stopped> {
        if let Some(reason) = self.stopped.get() {
            return Err(*reason);
        }
        match self.deadline {
            Some(deadline) if Instant::now() >= deadline => Err(Stopped::DeadlinePassed),
            _ => Ok(()),
        }
    }

    /// Reports that `done` of `total` units of `stage` are finished.
    pub fn progress(&self, stage: &'static str, done: usize, total: usize) {
        if let Some(sink) = &self.sink {
            sink.progress(stage, done, total);
        }
    }
}

/// Counts the units of a stage that several threads finish, and tells the count, which only rises.
#[derive(Debug)]
pub struct Progress {
    stage: &'static str,
    total: usize,
    done: Mutex<usize>,
}

impl Progress {
    /// A stage of `total` units. Without units nothing is told.
    pub fn new(stage: &'static str, total: usize) -> Self {
        Self { stage, total, done: Mutex::new(0) }
    }

    /// Counts one unit, and tells the count.
    pub fn tell_one(&self, budget: &Budget) {
        let mut done = self.done.lock().unwrap_or_else(PoisonError::into_inner);
        *done += 1;
        if self.total > 0 {
            // Told under the lock, so that no smaller count is told after a larger one.
            budget.progress(self.stage, *done, self.total);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_clone_is_cancelled_with_its_original() {
        let budget = Budget::unlimited();
        let clone = budget.clone();
        assert_eq!(clone.check(), Ok(()));
        budget.cancel();
        assert_eq!(clone.check(), Err(Stopped::Cancelled));
        clone.stop(Stopped::ShortOfMemory);
        assert_eq!(budget.check(), Err(Stopped::Cancelled));
    }

    #[test]
    fn a_passed_deadline_stops() {
        let budget = Budget::unlimited().with_deadline(Instant::now());
        assert_eq!(budget.check(), Err(Stopped::DeadlinePassed));
    }
}
