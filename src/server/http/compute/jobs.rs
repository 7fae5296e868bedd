//! The computations that run now, and how long computations usually take.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use toolpathd_core::budget::{Budget, Stopped};

/// The usual time before any computation has ended.
const FIRST_GUESS: Duration = Duration::from_secs(1);

/// The weight of the newest computation in the usual time.
const NEWEST: f64 = 0.1;

/// Shortest time between two stops for want of memory. A computation takes some time to end and to free its
/// memory.
const STOP_INTERVAL: Duration = Duration::from_millis(60);

/// What a computation belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Job,
    /// A step counts neither as a running job nor in the usual time.
    Step,
}

struct Running {
    begun: Instant,
    budget: Budget,
    kind: Kind,
}

/// The computations that run now.
#[derive(Default)]
pub struct Jobs(Mutex<Registry>);

#[derive(Default)]
struct Registry {
    /// All of them, in the order of their starts.
    running: BTreeMap<u64, Running>,
    next: u64,
    usual_time: Option<Duration>,
    last_stop: Option<Instant>,
}

impl Jobs {
    fn registry(&self) -> MutexGuard<'_, Registry> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Notes a computation that starts now. Dropping the entry notes its end.
    pub fn enter(self: &Arc<Self>, budget: &Budget, kind: Kind) -> Entry {
        let mut registry = self.registry();
        let number = registry.next;
        registry.next += 1;
        let running = Running { begun: Instant::now(), budget: budget.clone(), kind };
        registry.running.insert(number, running);
        drop(registry);
        Entry { jobs: Arc::clone(self), number }
    }

    /// The number of jobs that run.
    pub fn running(&self) -> usize {
        self.registry().running.values().filter(|running| running.kind == Kind::Job).count()
    }

    /// The time that jobs took lately, the newest ones counting most.
    pub fn usual_time(&self) -> Duration {
        self.registry().usual_time.unwrap_or(FIRST_GUESS)
    }

    /// Stops the computation that has run for the longest time and is not stopped yet, because the process is
    /// short of memory.
    pub fn stop_oldest(&self) {
        self.stop_oldest_at(Instant::now());
    }

    fn stop_oldest_at(&self, now: Instant) {
        let mut registry = self.registry();
        if registry.last_stop.is_some_and(|last| now - last < STOP_INTERVAL) {
            return;
        }
        let is_alone = registry.running.len() == 1;
        let oldest = registry.running.values().find(|running| running.budget.check().is_ok());
        if let Some(running) = oldest {
            running.budget.stop(if is_alone { Stopped::TooLarge } else { Stopped::ShortOfMemory });
            registry.last_stop = Some(now);
        }
    }
}

/// One computation in the list of those that run.
pub struct Entry {
    jobs: Arc<Jobs>,
    number: u64,
}

impl Drop for Entry {
    fn drop(&mut self) {
        let mut registry = self.jobs.registry();
        let Some(Running { begun, kind, .. }) = registry.running.remove(&self.number) else { return };
        if kind == Kind::Step {
            return;
        }
        let took = begun.elapsed();
        registry.usual_time = Some(
            registry.usual_time.map_or(took, |usual| usual.mul_f64(1.0 - NEWEST) + took.mul_f64(NEWEST)),
        );
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_oldest_is_stopped_first_and_a_lonely_one_is_too_large() {
        let jobs = Arc::new(Jobs::default());
        let budgets = [(); 2].map(|()| Budget::unlimited());
        let [older, younger] = budgets.each_ref().map(|budget| jobs.enter(budget, Kind::Job));
        let first = Instant::now();
        jobs.stop_oldest_at(first);
        jobs.stop_oldest_at(first + STOP_INTERVAL / 2);
        assert_eq!(budgets.each_ref().map(Budget::check), [Err(Stopped::ShortOfMemory), Ok(())]);
        drop(older);
        jobs.stop_oldest_at(first + STOP_INTERVAL);
        assert_eq!(budgets[1].check(), Err(Stopped::TooLarge));
        drop(younger);
        assert_eq!(jobs.running(), 0);
        assert!(jobs.usual_time() < FIRST_GUESS);
    }

    #[test]
    fn steps_tell_nothing_of_jobs() {
        let jobs = Arc::new(Jobs::default());
        let step = jobs.enter(&Budget::unlimited(), Kind::Step);
        assert_eq!(jobs.running(), 0);
        drop(step);
        assert_eq!(jobs.usual_time(), FIRST_GUESS);
    }
}
