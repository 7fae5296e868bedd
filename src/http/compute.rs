//! The pool of threads on which computations run. Other threads serve the connections.
//!
//! # Method
//! 1. A request takes a ticket. There are as many tickets as threads and places in the queue together. If no
//!    ticket is free, the request is refused at once.
//! 2. The request waits for a free thread. Its deadline includes this time.
//! 3. The thread runs the computation. When the computation ends, thread and ticket are free again.
//!
//! An NC program that is rewritten while it arrives uses the same threads, but takes no ticket;
//! `program_stream` limits the number of such programs.
//!
//! If a caller goes away, the [`Budget`] of the computation is cancelled. The computation then ends at its
//! next check of the budget.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tokio::sync::{OwnedSemaphorePermit, Semaphore, oneshot};
use tokio::time::timeout_at;

use crate::budget::{Budget, ProgressSink};
use crate::parallel::Helpers;

/// How long after the deadline an answer is still accepted. A computation checks its budget at intervals, so
/// it may notice the deadline this much later.
const DEADLINE_SLACK: Duration = Duration::from_millis(500);

/// Why a computation gave no result.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Failure {
    /// Every worker is busy and the queue is full.
    Overloaded,
    DeadlinePassed,
    Panicked,
}

/// The right to wait for a place. Dropping the ticket gives it back.
pub struct Ticket(#[expect(dead_code, reason = "it is held")] OwnedSemaphorePermit);

/// The pool with its tickets and places.
pub struct Compute {
    pool: rayon::ThreadPool,
    tickets: Arc<Semaphore>,
    places: Arc<Semaphore>,
    workers: usize,
    queue: usize,
    deadline: Duration,
    /// Helping threads, shared by all computations.
    helpers: Helpers,
}

impl Compute {
    /// Makes a pool of `workers` threads, at least one. At most `queue` requests wait for the pool.
    ///
    /// # Errors
    /// When the threads cannot be started.
    pub fn new(
        workers: usize,
        queue: usize,
        deadline: Duration,
    ) -> Result<Self, rayon::ThreadPoolBuildError> {
        let workers = workers.max(1);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(workers)
            .thread_name(|k| format!("compute-{k}"))
            .build()?;
        Ok(Self {
            pool,
            tickets: Arc::new(Semaphore::new(workers + queue)),
            places: Arc::new(Semaphore::new(workers)),
            workers,
            queue,
            deadline,
            helpers: Helpers::default(),
        })
    }

    /// Number of computations that run now.
    pub fn running(&self) -> usize {
        self.workers - self.places.available_permits()
    }

    /// Number of requests that have a ticket and wait for a place.
    pub fn waiting(&self) -> usize {
        (self.workers + self.queue - self.tickets.available_permits()).saturating_sub(self.running())
    }

    /// Whether a request would be refused now.
    pub fn is_full(&self) -> bool {
        self.tickets.available_permits() == 0
    }

    /// Takes a ticket.
    ///
    /// # Errors
    /// `Overloaded` when no ticket is free.
    pub fn admit(&self) -> Result<Ticket, Failure> {
        Arc::clone(&self.tickets).try_acquire_owned().map(Ticket).map_err(|_| Failure::Overloaded)
    }

    /// Runs `job` on the pool. Dropping the future cancels the job's budget.
    ///
    /// # Errors
    /// When no ticket is free, the deadline passes before the job ends, or the job panics.
    pub async fn run<T, F>(&self, job: F) -> Result<T, Failure>
    where
        T: Send + 'static,
        F: FnOnce(&Budget) -> T + Send + 'static,
    {
        self.run_admitted(self.admit()?, None, job).await
    }

    /// As [`Self::run`], for a job that is admitted already. `held` is dropped when the job ends: a ticket,
    /// or the permit of a stream. The job reports its progress to `listener`.
    ///
    /// # Errors
    /// When the deadline passes before the job ends, or the job panics.
    pub async fn run_admitted<H, T, F>(
        &self,
        held: H,
        listener: Option<Arc<dyn ProgressSink>>,
        job: F,
    ) -> Result<T, Failure>
    where
        H: Send + 'static,
        T: Send + 'static,
        F: FnOnce(&Budget) -> T + Send + 'static,
    {
        let deadline = Instant::now() + self.deadline;
        let place = timeout_at(deadline.into(), Arc::clone(&self.places).acquire_owned())
            .await
            .map_err(|_| Failure::DeadlinePassed)?
            .map_err(|_| Failure::Overloaded)?;

        let budget = Budget::unlimited()
            .with_deadline(deadline)
            .with_progress(Arc::new(Log::and(listener)))
            .with_helpers(self.helpers.clone());
        let _cancel = CancelOnDrop(budget.clone());
        let (answer, result) = oneshot::channel();
        self.pool.spawn(move || {
            let outcome = catch_unwind(AssertUnwindSafe(|| job(&budget)));
            // The place is freed before the answer is sent, so that the caller finds the place free.
            drop((place, held));
            let _ = answer.send(outcome);
        });
        match timeout_at((deadline + DEADLINE_SLACK).into(), result).await {
            Ok(Ok(Ok(value))) => Ok(value),
            Ok(_) => Err(Failure::Panicked),
            Err(_) => Err(Failure::DeadlinePassed),
        }
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

/// Cancels the budget when the future of the request is dropped.
struct CancelOnDrop(Budget);

impl Drop for CancelOnDrop {
    fn drop(&mut self) {
        self.0.cancel();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::budget::Stopped;

    fn spin(budget: &Budget) -> Stopped {
        loop {
            if let Err(stopped) = budget.check() {
                return stopped;
            }
            std::thread::sleep(Duration::from_millis(1));
        }
    }

    fn pool(workers: usize, queue: usize, deadline: Duration) -> Arc<Compute> {
        Arc::new(Compute::new(workers, queue, deadline).expect("threads"))
    }

    #[tokio::test]
    async fn a_full_queue_refuses_at_once_and_is_free_again_afterwards() {
        let compute = pool(1, 1, Duration::from_secs(20));
        let (running, waiting) = (Arc::clone(&compute), Arc::clone(&compute));
        let running = tokio::spawn(async move { running.run(spin).await });
        let waiting = tokio::spawn(async move { waiting.run(|_| 7).await });
        while compute.tickets.available_permits() > 0 {
            tokio::task::yield_now().await;
        }
        assert_eq!(compute.run(|_| 0).await, Err(Failure::Overloaded));
        running.abort();
        assert_eq!(waiting.await.expect("no panic"), Ok(7));
        assert_eq!(compute.run(|_| 1).await, Ok(1));
    }

    #[tokio::test]
    async fn a_dropped_future_stops_the_job_and_then_frees_the_place() {
        let compute = pool(1, 0, Duration::from_secs(20));
        let (sender, stopped) = oneshot::channel();
        let job = compute.run(move |budget| sender.send(spin(budget)));
        assert!(tokio::time::timeout(Duration::from_millis(50), job).await.is_err());
        let stopped = tokio::time::timeout(Duration::from_millis(100), stopped).await;
        assert_eq!(stopped.expect("in time"), Ok(Stopped::Cancelled));
    }

    #[tokio::test]
    async fn the_deadline_ends_jobs_that_ignore_their_budget_and_requests_that_wait() {
        let compute = pool(1, 1, Duration::from_millis(50));
        assert_eq!(compute.run(spin).await, Ok(Stopped::DeadlinePassed));
        let deaf = compute.run(|_| std::thread::sleep(Duration::from_secs(1)));
        let waiting = async {
            tokio::time::sleep(Duration::from_millis(10)).await;
            compute.run(|_| ()).await
        };
        let (deaf, waiting) = tokio::join!(deaf, waiting);
        assert_eq!((deaf, waiting), (Err(Failure::DeadlinePassed), Err(Failure::DeadlinePassed)));
    }

    #[tokio::test]
    async fn a_panic_gives_a_failure_and_the_pool_goes_on() {
        let compute = pool(1, 0, Duration::from_secs(20));
        assert_eq!(compute.run(|_| -> u8 { panic!("on purpose") }).await, Err(Failure::Panicked));
        assert_eq!(compute.run(|_| 1).await, Ok(1));
    }
}
