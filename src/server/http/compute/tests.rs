//! Tests of queue, sizes, deadlines and memory.

use toolpathd_core::budget::Stopped;

use super::*;

const LONG_ENOUGH: Duration = Duration::from_secs(20);

fn spin(budget: &Budget) -> Stopped {
    loop {
        if let Err(stopped) = budget.check() {
            return stopped;
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

fn pool(workers: usize, queue: usize, wait: Duration, deadline: Duration) -> Arc<Compute> {
    Arc::new(Compute::new(Capacity { workers, queue, wait, deadline }, Memory::of(None)))
}

/// Runs a job that gives a reason of its end as its error.
async fn run(
    compute: &Compute,
    job: impl FnOnce(&Budget) -> Result<u8, Stopped> + Send + 'static,
) -> Result<Result<u8, Stopped>, Failure> {
    compute.run(compute.admit()?, Size::Large, None, job).await
}

#[tokio::test]
async fn a_full_queue_refuses_at_once_and_is_free_again_afterwards() {
    let compute = pool(1, 1, LONG_ENOUGH, LONG_ENOUGH);
    let (running, waiting) = (Arc::clone(&compute), Arc::clone(&compute));
    let running = tokio::spawn(async move { run(&running, |budget| Err(spin(budget))).await });
    let waiting = tokio::spawn(async move { run(&waiting, |_| Ok(7)).await });
    while compute.tickets.available_permits() > 0 {
        tokio::task::yield_now().await;
    }
    assert!(matches!(run(&compute, |_| Ok(0)).await, Err(Failure::Overloaded { .. })));
    running.abort();
    assert_eq!(waiting.await.expect("no panic"), Ok(Ok(7)));
    assert_eq!(run(&compute, |_| Ok(1)).await, Ok(Ok(1)));
    assert_eq!((compute.running(), compute.waiting()), (0, 0));
}

#[tokio::test]
async fn a_dropped_future_stops_the_job_and_then_frees_the_worker() {
    let compute = pool(1, 0, LONG_ENOUGH, LONG_ENOUGH);
    let (sender, stopped) = oneshot::channel();
    let job =
        run(&compute, move |budget| sender.send(spin(budget)).map_err(|_| Stopped::Cancelled).map(|()| 0));
    assert!(tokio::time::timeout(Duration::from_millis(50), job).await.is_err());
    // A job that is not stopped ends at its deadline, and says so.
    let stopped = tokio::time::timeout(LONG_ENOUGH, stopped).await;
    assert_eq!(stopped.expect("in time"), Ok(Stopped::Cancelled));
    while compute.is_full() {
        tokio::task::yield_now().await;
    }
    assert_eq!(run(&compute, |_| Ok(1)).await, Ok(Ok(1)));
}

#[tokio::test]
async fn a_wait_and_a_computation_have_limits_of_their_own() {
    let (wait, deadline) = (Duration::from_millis(50), Duration::from_millis(300));
    // The wait ends long before the deadline of the computation that it waits for.
    let compute = pool(1, 1, wait, LONG_ENOUGH);
    let busy = Arc::clone(&compute);
    let busy = tokio::spawn(async move { run(&busy, |budget| Err(spin(budget))).await });
    while compute.running() == 0 {
        tokio::task::yield_now().await;
    }
    let begun = Instant::now();
    let waiting = run(&compute, |_| Ok(0)).await;
    assert!(matches!(waiting, Err(Failure::NotStarted { .. })), "{waiting:?}");
    assert!(begun.elapsed() >= wait && !busy.is_finished(), "{:?}", begun.elapsed());
    busy.abort();

    // A computation may take longer than a wait.
    let compute = pool(1, 1, wait, deadline);
    let begun = Instant::now();
    assert_eq!(run(&compute, |budget| Err(spin(budget))).await, Ok(Err(Stopped::DeadlinePassed)));
    assert!(begun.elapsed() >= deadline, "{:?}", begun.elapsed());

    // One that does not look at its budget is answered while it still runs.
    let (release, released) = std::sync::mpsc::channel::<()>();
    let deaf = run(&compute, move |_| {
        let _ = released.recv();
        Ok(0)
    });
    assert_eq!(deaf.await, Err(Failure::DeadlinePassed));
    assert_eq!(compute.running(), 1);
    drop(release);
}

#[tokio::test]
async fn a_small_job_waits_neither_for_large_ones_that_run_nor_for_those_that_wait() {
    let compute = pool(1, 8, LONG_ENOUGH, LONG_ENOUGH);
    let large = || {
        let compute = Arc::clone(&compute);
        tokio::spawn(async move { run(&compute, |budget| Err(spin(budget))).await })
    };
    let large = [large(), large(), large()];
    while compute.waiting() < 2 {
        tokio::task::yield_now().await;
    }
    for k in 0..3 {
        let small = compute.run(compute.admit().expect("room"), Size::Small, None, move |_| Ok::<_, ()>(k));
        assert_eq!(timeout(LONG_ENOUGH / 4, small).await, Ok(Ok(Ok(k))));
    }
    assert!(large.iter().all(|job| !job.is_finished()));
    large.iter().for_each(|job| job.abort());
}

#[tokio::test]
async fn a_large_job_never_takes_the_worker_of_small_ones() {
    let compute = pool(1, 8, Duration::from_millis(50), LONG_ENOUGH);
    let busy = Arc::clone(&compute);
    let busy = tokio::spawn(async move { run(&busy, |budget| Err(spin(budget))).await });
    while compute.running() == 0 {
        tokio::task::yield_now().await;
    }
    assert!(matches!(run(&compute, |_| Ok(0)).await, Err(Failure::NotStarted { .. })));
    busy.abort();
}

#[tokio::test]
async fn a_step_of_a_stream_waits_for_no_job() {
    let compute = pool(1, 0, LONG_ENOUGH, LONG_ENOUGH);
    let busy = Arc::clone(&compute);
    let busy = tokio::spawn(async move { run(&busy, |budget| Err(spin(budget))).await });
    while compute.running() == 0 {
        tokio::task::yield_now().await;
    }
    let step = compute.run_step(Step::OfStream, (), |_| Ok::<_, ()>(3));
    assert_eq!(tokio::time::timeout(LONG_ENOUGH / 4, step).await, Ok(Ok(Ok(3))));
    assert!(!busy.is_finished());
    busy.abort();
}

#[tokio::test]
async fn a_panic_gives_a_failure_and_the_next_job_runs() {
    let compute = pool(1, 0, LONG_ENOUGH, LONG_ENOUGH);
    assert_eq!(run(&compute, |_| panic!("on purpose")).await, Err(Failure::Panicked));
    assert_eq!(run(&compute, |_| Ok(1)).await, Ok(Ok(1)));
}

#[tokio::test]
async fn a_job_beyond_the_memory_of_the_process_is_stopped() {
    let capacity = Capacity { workers: 1, queue: 0, wait: LONG_ENOUGH, deadline: LONG_ENOUGH };
    let compute = Compute::new(capacity, Memory::of(Some(1)));
    assert_eq!(run(&compute, |budget| Err(spin(budget))).await, Ok(Err(Stopped::TooLarge)));
}

#[tokio::test]
async fn a_job_that_runs_when_the_process_ends_is_answered_at_the_end() {
    let compute = pool(1, 0, LONG_ENOUGH, LONG_ENOUGH);
    let running = Arc::clone(&compute);
    let running = tokio::spawn(async move { run(&running, |budget| Err(spin(budget))).await });
    while compute.running() == 0 {
        tokio::task::yield_now().await;
    }
    compute.end_by(Instant::now());
    let ended = tokio::time::timeout(LONG_ENOUGH / 4, running).await.expect("in time");
    assert_eq!(ended.expect("no panic"), Err(Failure::DeadlinePassed));
}
