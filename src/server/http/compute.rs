//! Runs computations on threads of their own. Other threads serve the connections.
//!
//! # Method
//! 1. A request takes a *ticket*. There is one ticket for each worker and one for each request that may wait.
//!    If no ticket is free, the request is refused at once.
//! 2. The request waits for a *place*; there is one for each worker. A request that finds none in time is
//!    refused. The refusal says when to try again.
//! 3. The computation runs on a thread until it ends or its deadline passes. The deadline starts when the
//!    computation starts. Then place and ticket are free again.
//! 4. If every place is held by a job that has run for `LONG`, the first waiting job that was not tried yet
//!    is *tried*: it runs on a place beside the others, for `TRIAL` at most. A small job ends in that time,
//!    and need not wait for large ones. A larger job is stopped and waits again, in its old position; it is
//!    tried a single time. Nothing is kept of the stopped work, so a trial takes memory only while it runs,
//!    and time only while all places are held for long.
//! 5. A step of an NC program that is rewritten while it arrives has a place of its own, which no job can
//!    take.
//!
//! If a caller goes away, the [`Budget`] of the computation is cancelled. The computation then ends at its
//! next check of the budget. If the process is short of memory, the oldest computation is stopped in the same
//! way.

mod jobs;
pub mod memory;
#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::pin::pin;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Duration, Instant};

use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};
use tokio::time::{sleep, sleep_until, timeout_at};

use jobs::{Jobs, Kind};
use memory::Memory;
use toolpathd_core::budget::{Budget, ProgressSink, Stopped};
use toolpathd_core::parallel::Helpers;

/// How long after the deadline an answer is still accepted. A computation checks its budget at intervals, so
/// it may notice the deadline this much later.
const DEADLINE_SLACK: Duration = Duration::from_millis(500);

/// Time after which a computation counts as long. It is longer than most jobs take, so that there are no
/// trials while places become free often enough.
const LONG: Duration = Duration::from_millis(600);

/// Longest time of a trial.
const TRIAL: Duration = Duration::from_millis(500);

/// Time between two looks at the memory of the process while a computation runs. A fast computation takes
/// some ten MiB in this time.
const MEMORY_INTERVAL: Duration = Duration::from_millis(10);

/// Why a computation gave no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Every worker is busy and the queue is full. There should be room after `retry_after`.
    Overloaded {
        retry_after: Duration,
    },
    /// No place became free in time. There should be one after `retry_after`.
    NotStarted {
        retry_after: Duration,
    },
    DeadlinePassed,
    Panicked,
}

/// The right to wait for a place. Dropping the ticket gives it back.
pub struct Ticket(#[expect(dead_code, reason = "it is held")] OwnedSemaphorePermit);

/// How many computations may run and wait, and for how long.
#[derive(Debug, Clone, Copy)]
pub struct Capacity {
    /// Jobs that run at the same time; 0 counts as 1. A trial and a step of a stream may run beside them.
    pub workers: usize,
    /// Requests that wait for a place.
    pub queue: usize,
    /// Longest wait for a place.
    pub wait: Duration,
    /// Longest computation.
    pub deadline: Duration,
}

/// Runs computations, and limits how many run and wait.
pub struct Compute {
    tickets: Arc<Semaphore>,
    places: Arc<Semaphore>,
    /// The place for the job that is tried.
    trials: Arc<Semaphore>,
    /// The place for the steps of streams.
    steps: Arc<Semaphore>,
    jobs: Arc<Jobs>,
    memory: Memory,
    capacity: Capacity,
    /// The time at which every computation must have ended, because the process ends.
    end: OnceLock<Instant>,
    /// Helping threads, shared by all computations.
    helpers: Helpers,
}

impl Compute {
    pub fn new(capacity: Capacity, memory: Memory) -> Self {
        let workers = capacity.workers.max(1);
        Self {
            tickets: Arc::new(Semaphore::new(workers + capacity.queue)),
            places: Arc::new(Semaphore::new(workers)),
            trials: Arc::new(Semaphore::new(1)),
            steps: Arc::new(Semaphore::new(1)),
            jobs: Arc::default(),
            memory,
            capacity: Capacity { workers, ..capacity },
            end: OnceLock::new(),
            helpers: Helpers::default(),
        }
    }

    /// Number of jobs that run now.
    pub fn running(&self) -> usize {
        self.jobs.running()
    }

    /// Number of requests that have a ticket and wait for a place.
    pub fn waiting(&self) -> usize {
        let Capacity { workers, queue, .. } = self.capacity;
        (workers + queue - self.tickets.available_permits()).saturating_sub(self.running())
    }

    /// Whether a request would be refused now.
    pub fn is_full(&self) -> bool {
        self.tickets.available_permits() == 0
    }

    /// The failure of a request that is refused now.
    pub fn overloaded(&self) -> Failure {
        Failure::Overloaded { retry_after: self.retry_after() }
    }

    /// The time in which half of the jobs that wait and run now should be done. By then there is room, and
    /// there is still work, so that no worker idles until the refused callers return.
    fn retry_after(&self) -> Duration {
        let ahead = (self.waiting() + self.running()) as f64 / self.capacity.workers as f64;
        self.jobs.usual_time().mul_f64(ahead / 2.0)
    }

    /// Lets no computation go on after `end`.
    pub fn end_by(&self, end: Instant) {
        let _ = self.end.set(end);
    }

    /// `deadline`, or the end if it comes first.
    fn by_end(&self, deadline: Instant) -> Instant {
        self.end.get().map_or(deadline, |end| deadline.min(*end))
    }

    /// Takes a ticket.
    ///
    /// # Errors
    /// `Overloaded` when no ticket is free.
    pub fn admit(&self) -> Result<Ticket, Failure> {
        Arc::clone(&self.tickets).try_acquire_owned().map(Ticket).map_err(|_| self.overloaded())
    }

    /// Runs `job` when a place is free. A job may run twice: see the trials of this module. Dropping the
    /// future stops the job. The job reports its progress to `listener`.
    ///
    /// # Errors
    /// When there is no place in time, the deadline passes before the job ends, or the job panics.
    pub async fn run<T, E, F>(
        &self,
        ticket: Ticket,
        listener: Option<Arc<dyn ProgressSink>>,
        job: F,
    ) -> Result<Result<T, E>, Failure>
    where
        T: Send + 'static,
        E: Send + 'static,
        F: Fn(&Budget) -> Result<T, E> + Send + Sync + 'static,
    {
        let job = Arc::new(job);
        let ticket = Arc::new(ticket);
        let sink: Arc<dyn ProgressSink> = Arc::new(Log::and(listener));
        let start = |seat| {
            let job = Arc::clone(&job);
            let ticket = Arc::clone(&ticket);
            self.start(seat, Kind::Job, Arc::clone(&sink), move |budget| {
                let result = job(budget);
                drop(ticket);
                result
            })
        };
        let latest = sleep_until((Instant::now() + self.capacity.wait).into());
        let (mut place, mut latest) = (pin!(Arc::clone(&self.places).acquire_owned()), pin!(latest));
        let not_started = || Failure::NotStarted { retry_after: self.retry_after() };
        let placed = tokio::select! {
            biased;
            placed = &mut place => Some(placed),
            trial = self.turn_of_trial() => {
                let mut tried = start(trial);
                tokio::select! {
                    biased;
                    outcome = self.outcome(&mut tried) => return outcome,
                    // A place is free: the trial becomes the computation.
                    placed = &mut place => {
                        if let Ok(placed) = placed {
                            tried.seat(placed);
                        }
                        return self.outcome(&mut tried).await;
                    }
                    () = sleep(TRIAL) => {}
                }
                tried.budget.stop(Stopped::PutBack);
                match self.outcome(&mut tried).await {
                    Ok(Err(_)) => None,
                    ended => return ended,
                }
            }
            () = &mut latest => return Err(not_started()),
        };
        let placed = match placed {
            Some(placed) => placed,
            None => tokio::select! {
                biased;
                placed = &mut place => placed,
                () = &mut latest => return Err(not_started()),
            },
        };
        let placed = placed.map_err(|_| not_started())?;
        let mut started = start(placed);
        drop(ticket);
        self.outcome(&mut started).await
    }

    /// Runs one step of a stream, which waits for other steps only, without a limit. `held` is dropped when
    /// the step ends. Dropping the future stops the step.
    ///
    /// # Errors
    /// When the deadline passes before the step ends, or the step panics.
    pub async fn run_step<H, T, E, F>(&self, held: H, step: F) -> Result<Result<T, E>, Failure>
    where
        H: Send + 'static,
        T: Send + 'static,
        E: Send + 'static,
        F: FnOnce(&Budget) -> Result<T, E> + Send + 'static,
    {
        let place = Arc::clone(&self.steps).acquire_owned().await.map_err(|_| Failure::Panicked)?;
        let mut started = self.start(place, Kind::Step, Arc::new(Log::and(None)), move |budget| {
            let result = step(budget);
            drop(held);
            result
        });
        self.outcome(&mut started).await
    }

    /// Waits until a job may be tried: every place is held by a computation that is long.
    async fn turn_of_trial(&self) -> OwnedSemaphorePermit {
        let Ok(turn) = Arc::clone(&self.trials).acquire_owned().await else {
            return std::future::pending().await;
        };
        loop {
            let now = Instant::now();
            let opens = self.jobs.youngest().map_or(now + LONG, |begun| begun + LONG);
            if now >= opens && self.places.available_permits() == 0 {
                return turn;
            }
            sleep_until(opens.max(now + LONG / 10).into()).await;
        }
    }

    /// Starts `job` on a thread. The permit of the place is free again when the job ends, before its result
    /// is known, so that the caller finds the place free.
    fn start<T, E, F>(
        &self,
        place: OwnedSemaphorePermit,
        kind: Kind,
        sink: Arc<dyn ProgressSink>,
        job: F,
    ) -> Started<T, E>
    where
        T: Send + 'static,
        E: Send + 'static,
        F: FnOnce(&Budget) -> Result<T, E> + Send + 'static,
    {
        let deadline = self.by_end(Instant::now() + self.capacity.deadline);
        let budget = Budget::unlimited()
            .with_deadline(deadline)
            .with_progress(sink)
            .with_helpers(self.helpers.clone());
        let seat = Arc::new(Mutex::new(Some(place)));
        let (answer, result) = oneshot::channel();
        let entry = self.jobs.enter(&budget, kind);
        let (running, sat) = (budget.clone(), Arc::clone(&seat));
        tokio::task::spawn_blocking(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| job(&running)));
            drop(entry);
            drop(sat.lock().unwrap_or_else(PoisonError::into_inner).take());
            let _ = answer.send(outcome.map_err(|_| Failure::Panicked));
        });
        Started { budget, deadline, seat, result }
    }

    /// Waits for the end of a computation, and meanwhile stops computations if the process is short of
    /// memory.
    async fn outcome<T, E>(&self, started: &mut Started<T, E>) -> Result<Result<T, E>, Failure> {
        loop {
            // The end may come into force meanwhile.
            let latest = self.by_end(started.deadline) + DEADLINE_SLACK;
            let waited = timeout_at(latest.into(), &mut started.result);
            tokio::select! {
                biased;
                ended = waited => return match ended {
                    Ok(ended) => ended.unwrap_or(Err(Failure::Panicked)),
                    Err(_) => Err(Failure::DeadlinePassed),
                },
                () = sleep(MEMORY_INTERVAL) => {
                    if self.memory.is_short() {
                        self.jobs.stop_oldest();
                    }
                }
            }
        }
    }
}

/// A computation that runs. Dropping it stops the computation.
struct Started<T, E> {
    budget: Budget,
    deadline: Instant,
    seat: Arc<Mutex<Option<OwnedSemaphorePermit>>>,
    result: oneshot::Receiver<Result<Result<T, E>, Failure>>,
}

impl<T, E> Started<T, E> {
    /// Moves the computation to another place, and frees the place that it had.
    fn seat(&self, place: OwnedSemaphorePermit) {
        let mut seat = self.seat.lock().unwrap_or_else(PoisonError::into_inner);
        // The computation may have ended just now; then both places are free.
        if seat.is_some() {
            *seat = Some(place);
        }
    }
}

impl<T, E> Drop for Started<T, E> {
    fn drop(&mut self) {
        self.budget.cancel();
    }
}

/// Writes progress to the log, in the span of the request, and passes it to the listener if there is one.
struct Log {
    span: tracing::Span,
    listener: Option<Arc<dyn ProgressSink>>,
}

impl Log {
    fn and(listener: Option<Arc<dyn ProgressSink>>) -> Self {
        Self { span: tracing::Span::current(), listener }
    }
}

impl ProgressSink for Log {
    fn progress(&self, stage: &'static str, done: usize, total: usize) {
        self.span.in_scope(|| tracing::trace!(stage, done, total, "progress"));
        if let Some(listener) = &self.listener {
            listener.progress(stage, done, total);
        }
    }
}
