//! Work shared out to threads, with the results in order.
//!
//! The threads of one call are its own: no job waits for the work of another. All calls together have as many as there are
//! processors beside the threads that call; who comes later works alone.

use std::num::NonZero;
use std::panic::resume_unwind;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

/// Threads that help callers now.
static HELPERS: AtomicUsize = AtomicUsize::new(0);

/// What `make` makes of 0..n, in that order, or its first error, whichever thread was first. What comes after an error is not begun.
///
/// # Errors
/// The first error of `make`.
pub fn in_order<T: Send, E: Send>(
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
    let helpers = Helpers::taken(n.saturating_sub(1));
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

/// The right to so many threads.
struct Helpers {
    count: usize,
}

impl Helpers {
    /// As many as are left, at most `most`.
    fn taken(most: usize) -> Self {
        let processors = thread::available_parallelism().map_or(1, NonZero::get);
        let mut count = 0;
        let take = |taken: usize| {
            count = most.min((processors - 1).saturating_sub(taken));
            Some(taken + count)
        };
        let _ = HELPERS.fetch_update(Ordering::Relaxed, Ordering::Relaxed, take);
        Self { count }
    }
}

impl Drop for Helpers {
    fn drop(&mut self) {
        HELPERS.fetch_sub(self.count, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_error_counts_and_what_follows_is_left() {
        let begun = AtomicUsize::new(0);
        let made = in_order(10_000, |k| {
            begun.fetch_add(1, Ordering::Relaxed);
            if k % 1000 == 700 { Err(k) } else { Ok(k) }
        });
        assert_eq!(made, Err(700));
        assert!(begun.into_inner() < 10_000);
    }

    #[test]
    fn results_are_in_order_and_calls_may_be_nested() {
        let rows = in_order(20, |i| in_order(30, |j| Ok::<_, ()>(100 * i + j)));
        let expected: Vec<Vec<usize>> = (0..20).map(|i| (0..30).map(|j| 100 * i + j).collect()).collect();
        assert_eq!(rows, Ok(expected));
        assert_eq!(in_order(0, Ok::<usize, ()>), Ok(vec![]));
    }

    #[test]
    #[should_panic(expected = "seven")]
    fn a_panic_is_the_callers() {
        let _ = in_order(50, |k| if k == 7 { panic!("seven") } else { Ok::<_, ()>(k) });
    }
}
