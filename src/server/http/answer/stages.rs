//! The stages of a computation, for callers whose computation did not end: which stage took the time.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use crate::http::error::{ApiError, Code};
use crate::http::messages::too_slow;
use toolpathd_core::budget::ProgressSink;

/// How long each stage of a computation took so far. A stage lasts until another one reports.
#[derive(Default)]
pub struct Stages {
    /// The listener to whom the progress goes on.
    listener: Option<Arc<dyn ProgressSink>>,
    seen: Mutex<Seen>,
}

#[derive(Default)]
struct Seen {
    times: Vec<(&'static str, Duration)>,
    /// The stage that reported last, when it began or reported last, and the share of it that is done.
    current: Option<(&'static str, Instant, f64)>,
}

impl Seen {
    /// Adds the time since the last report to the stage that reported it.
    fn settle(&mut self, now: Instant) {
        let Some((stage, since, _)) = self.current else { return };
        let spent = now - since;
        match self.times.iter_mut().find(|(name, _)| *name == stage) {
            Some((_, time)) => *time += spent,
            None => self.times.push((stage, spent)),
        }
    }
}

impl Stages {
    pub fn telling(listener: Arc<dyn ProgressSink>) -> Self {
        Self { listener: Some(listener), seen: Mutex::default() }
    }

    /// The same error; where the deadline passed, with the stage that took most of the time.
    pub fn explain(&self, error: ApiError) -> ApiError {
        if error.code() != Code::DeadlinePassed {
            return error;
        }
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.settle(Instant::now());
        let Some((last, _, share)) = seen.current else { return error };
        match seen.times.iter().max_by_key(|(_, time)| *time) {
            Some((longest, time)) => error.saying(too_slow(longest, *time, last, share)),
            None => error,
        }
    }
}

impl ProgressSink for Stages {
    fn progress(&self, stage: &'static str, done: usize, total: usize) {
        let now = Instant::now();
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        seen.settle(now);
        let share = if total == 0 { 0.0 } else { (done as f64 / total as f64).min(1.0) };
        seen.current = Some((stage, now, share));
        drop(seen);
        if let Some(listener) = &self.listener {
            listener.progress(stage, done, total);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_passed_deadline_names_the_longest_stage_and_advice() {
        let stages = Stages::default();
        stages.progress("sections", 0, 10);
        std::thread::sleep(Duration::from_millis(5));
        stages.progress("certificate", 3, 12);
        let late = ApiError::new(Code::DeadlinePassed, "late");
        let told = stages.explain(late.clone());
        assert!(
            told.detail().contains("`sections`") && told.detail().contains("stepover"),
            "{}",
            told.detail()
        );
        assert!(told.detail().contains("25 % of `certificate`"), "{}", told.detail());
        assert_eq!(Stages::default().explain(late.clone()), late);
        let other = ApiError::new(Code::NothingToCut, "nothing");
        assert_eq!(stages.explain(other.clone()), other);
    }
}
