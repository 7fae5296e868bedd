//! Runs computations on threads of their own. Other threads serve the connections.
//!
//! # Method
//! 1. A request takes a *ticket*. There is one ticket for each worker and one for each request that may wait.
//!    If no ticket is free, the request is refused at once.
//! 2. The request waits for a *worker*. A request that gets none in time is refused. The refusal says when to
//!    try again. A job that its [`Size`] calls small may also take the worker that is kept for small jobs, so
//!    that it does not wait for large ones.
//! 3. The computation runs on a thread until it ends or its deadline passes. The deadline starts when the
//!    computation starts. Then worker and ticket are free again.
//! 4. A [`Step`] is a short piece of work before or between jobs. It has a thread of its own, which no job
//!    can take.
//!
//! If a caller goes away, the [`Budget`] of the computation is cancelled. The computation then ends at its
//! next check of the budget. If the process is short of memory, the oldest computation is stopped in the same
//! way.

mod jobs;
pub mod memory;
pub mod room;
#[cfg(test)]
mod tests;

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, OnceLock};
use std::time::{Duration, Instant};

use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};
use tokio::time::{sleep, timeout, timeout_at};

use jobs::{Jobs, Kind};
use memory::Memory;
use room::Room;
use toolpathd_core::budget::{Budget, ProgressSink};
use toolpathd_core::parallel::Helpers;

/// How long after the deadline an answer is still accepted. A computation checks its budget at intervals, so
/// it may notice the deadline this much later.
const DEADLINE_SLACK: Duration = Duration::from_millis(500);

/// Time between two measurements of the memory of the process while a computation runs. A fast computation
/// takes some ten MiB in this time.
const MEMORY_INTERVAL: Duration = Duration::from_millis(10);

/// Why a computation gave no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Every worker is busy and the queue is full. There should be room after `retry_after`.
    Overloaded {
        retry_after: Duration,
    },
    /// No worker became free in time. There should be one after `retry_after`.
    NotStarted {
        retry_after: Duration,
    },
    DeadlinePassed,
    Panicked,
}

/// The right to wait for a worker. Dropping the ticket gives it back.
pub struct Ticket(#[expect(dead_code, reason = "it is held")] OwnedSemaphorePermit);

/// How much work a job is, by an estimate before it starts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Size {
    /// Some half a second at most.
    Small,
    /// More than that, or not known.
    Large,
}

/// A short piece of work that is no job.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// The decoding of a short body.
    Decoding,
    /// One piece of an NC program that is rewritten while it arrives.
    OfStream,
}

/// How many computations may run and wait, and for how long.
#[derive(Debug, Clone, Copy)]
pub struct Capacity {
    /// Jobs that run at the same time; 0 counts as 1. One small job and the steps run beside them.
    pub workers: usize,
    /// Requests that wait for a worker.
    pub queue: usize,
    /// Longest wait for a worker.
    pub wait: Duration,
    /// Longest computation.
    pub deadline: Duration,
}

/// Runs computations, and limits how many run and wait.
pub struct Compute {
    tickets: Arc<Semaphore>,
    workers: Arc<Semaphore>,
    /// The worker that is kept for small jobs.
    small: Arc<Semaphore>,
    decoding: Arc<Semaphore>,
    streams: Arc<Semaphore>,
    jobs: Arc<Jobs>,
    memory: Memory,
    /// The memory for bodies while they are decoded.
    decoding_room: Arc<Room>,
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
            workers: Arc::new(Semaphore::new(workers)),
            small: Arc::new(Semaphore::new(1)),
            decoding: Arc::new(Semaphore::new(workers)),
            streams: Arc::new(Semaphore::new(1)),
            jobs: Arc::default(),
            memory,
            decoding_room: Room::new(memory.for_decoding()),
            capacity: Capacity { workers, ..capacity },
            end: OnceLock::new(),
            helpers: Helpers::default(),
        }
    }

    /// The memory for bodies while they are decoded.
    pub fn decoding_room(&self) -> Arc<Room> {
        Arc::clone(&self.decoding_room)
    }

    /// Number of jobs that run now.
    pub fn running(&self) -> usize {
        self.jobs.running()
    }

    /// Number of requests that have a ticket and wait for a worker.
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

    /// Runs `job` when a worker is free. Dropping the future stops the job. The job reports its progress to
    /// `listener`.
    ///
    /// # Errors
    /// When there is no worker in time, the deadline passes before the job ends, or the job panics.
    pub async fn run<T, E, F>(
        &self,
        ticket: Ticket,
        size: Size,
        listener: Option<Arc<dyn ProgressSink>>,
        job: F,
    ) -> Result<Result<T, E>, Failure>
    where
        T: Send + 'static,
        E: Send + 'static,
        F: FnOnce(&Budget) -> Result<T, E> + Send + 'static,
    {
        let worker = timeout(self.capacity.wait, self.worker(size)).await;
        let worker = worker.map_err(|_| Failure::NotStarted { retry_after: self.retry_after() })??;
        self.compute(worker, Kind::Job, listener, ticket, job).await
    }

    /// Runs a step, which waits for steps of its kind only, without a limit. `held` is dropped when the step
    /// ends. Dropping the future stops the step.
    ///
    /// # Errors
    /// When the deadline passes before the step ends, or the step panics.
    pub async fn run_step<H, T, E, F>(&self, kind: Step, held: H, step: F) -> Result<Result<T, E>, Failure>
    where
        H: Send + 'static,
        T: Send + 'static,
        E: Send + 'static,
        F: FnOnce(&Budget) -> Result<T, E> + Send + 'static,
    {
        let threads = match kind {
            Step::Decoding => &self.decoding,
            Step::OfStream => &self.streams,
        };
        self.compute(acquired(threads).await?, Kind::Step, None, held, step).await
    }

    /// Waits for a worker that a job of this size may take.
    async fn worker(&self, size: Size) -> Result<OwnedSemaphorePermit, Failure> {
        tokio::select! {
            biased;
            worker = acquired(&self.workers) => worker,
            worker = acquired(&self.small), if size == Size::Small => worker,
        }
    }

    /// Runs `job` on a thread. `worker` and `held` are free again when the job ends, before its result is
    /// known, so that the caller finds them free.
    async fn compute<H, T, E, F>(
        &self,
        worker: OwnedSemaphorePermit,
        kind: Kind,
        listener: Option<Arc<dyn ProgressSink>>,
        held: H,
        job: F,
    ) -> Result<Result<T, E>, Failure>
    where
        H: Send + 'static,
        T: Send + 'static,
        E: Send + 'static,
        F: FnOnce(&Budget) -> Result<T, E> + Send + 'static,
    {
        let deadline = self.by_end(Instant::now() + self.capacity.deadline);
        let budget = Budget::unlimited()
            .with_deadline(deadline)
            .with_progress(Arc::new(Log::and(listener)))
            .with_helpers(self.helpers.clone());
        let (answer, result) = oneshot::channel();
        let entry = self.jobs.enter(&budget, kind);
        let running = budget.clone();
        let _stop = StopOnDrop(budget);
        tokio::task::spawn_blocking(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| job(&running)));
            drop((entry, worker, held));
            let _ = answer.send(outcome.map_err(|_| Failure::Panicked));
        });
        self.outcome(deadline, result).await
    }

    /// Waits for the end of a computation, and meanwhile stops computations if the process is short of
    /// memory.
    async fn outcome<T>(
        &self,
        deadline: Instant,
        mut result: oneshot::Receiver<Result<T, Failure>>,
    ) -> Result<T, Failure> {
        loop {
            // The end may come into force meanwhile.
            let latest = self.by_end(deadline) + DEADLINE_SLACK;
            let waited = timeout_at(latest.into(), &mut result);
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

/// A permit, once there is one. The semaphores are never closed.
async fn acquired(semaphore: &Arc<Semaphore>) -> Result<OwnedSemaphorePermit, Failure> {
    Arc::clone(semaphore).acquire_owned().await.map_err(|_| Failure::Panicked)
}

/// Stops a computation when nobody waits for it any more.
struct StopOnDrop(Budget);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
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
