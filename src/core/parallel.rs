//! Shares out the items of a computation to threads, and returns the results in the order of the items.
//!
//! A computation starts its own helping threads, and never waits for the work of another computation.
//! [`Helpers`] counts how many helping threads may still be started; several computations can share one
//! count. The calling thread works too, and is not counted. If no helping thread is free, the calling thread
//! does all the work.

use std::num::NonZero;
use std::panic::resume_unwind;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// How many threads may still be started to help. Clones count together.
#[derive(Debug, Clone)]
pub struct Helpers {
    free: Arc<AtomicUsize>,
}

impl Default for Helpers {
    /// One helper for each processor but one: the caller's own thread works too.
    fn default() -> Self {
        let processors = thread::available_parallelism().map_or(1, NonZero::get);
        Self { free: Arc::new(AtomicUsize::new(processors - 1)) }
    }
}

/// The results of `make` for 0..n in that order, or its first error in that order. Work after an error is not
/// begun.
///
/// # Errors
/// The first error of `make`.
pub fn in_order<T: Send, E: Send>(
    helpers: &Helpers,
    n: usize,
    make: impl Fn(usize) -> Result<T, E> + Sync,
) -> Result<Vec<T>, E> {
    let (next, first_error) = (AtomicUsize::new(0), AtomicUsize::new(usize::MAX));
    let work = || {
        let mut made = Vec::new();
        loop {
            let k = next.fetch_add(1, Ordering::Relaxed);
            if k >= n || k > first_error.load(Ordering::Relaxed) {
                return made;
            }
            let result = make(k);
            if result.is_err() {
                first_error.fetch_min(k, Ordering::Relaxed);
            }
            made.push((k, result));
        }
    };
    let helpers = helpers.take(n.saturating_sub(1));
    let mut made = thread::scope(|scope| {
        let help = |_| thread::Builder::new().name("helper".into()).spawn_scoped(scope, work).ok();
        let helping: Vec<_> = (0..helpers.count).filter_map(help).collect();
        let mut made = work();
        for helper in helping {
            made.extend(helper.join().unwrap_or_else(|panic| resume_unwind(panic)));
        }
        made
    });
    made.sort_by_key(|(k, _)| *k);
    made.into_iter().map(|(_, result)| result).collect()
}

/// The right to start `count` threads. Dropping it gives the threads back.
struct Taken<'a> {
    count: usize,
    from: &'a Helpers,
}

impl Helpers {
    /// Takes as many helpers as are free, at most `most`.
    fn take(&self, most: usize) -> Taken<'_> {
        let mut count = 0;
        let taken = |free: usize| {
            count = most.min(free);
            Some(free - count)
        };
        let _ = self.free.fetch_update(Ordering::Relaxed, Ordering::Relaxed, taken);
        Taken { count, from: self }
    }
}

impl Drop for Taken<'_> {
    fn drop(&mut self) {
        self.from.free.fetch_add(self.count, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_is_returned_and_later_work_is_not_begun() {
        let begun = AtomicUsize::new(0);
        let made = in_order(&Helpers::default(), 10_000, |k| {
            begun.fetch_add(1, Ordering::Relaxed);
            if k % 1000 == 700 { Err(k) } else { Ok(k) }
        });
        assert_eq!(made, Err(700));
        assert!(begun.into_inner() < 10_000);
    }

    #[test]
    fn results_are_in_order_and_calls_may_be_nested() {
        let helpers = &Helpers { free: Arc::new(AtomicUsize::new(5)) };
        let rows = in_order(helpers, 20, |i| in_order(helpers, 30, |j| Ok::<_, ()>(100 * i + j)));
        let expected: Vec<Vec<usize>> = (0..20).map(|i| (0..30).map(|j| 100 * i + j).collect()).collect();
        assert_eq!(rows, Ok(expected));
        assert_eq!(in_order(helpers, 0, Ok::<usize, ()>), Ok(vec![]));
        assert_eq!(helpers.free.load(Ordering::Relaxed), 5);
    }

    #[test]
    #[should_panic(expected = "seven")]
    fn a_panic_reaches_the_caller() {
        let _ = in_order(&Helpers::default(), 50, |k| if k == 7 { panic!("seven") } else { Ok::<_, ()>(k) });
    }
}
