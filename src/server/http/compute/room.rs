//! The memory that bodies take while they are decoded.
//!
//! A body takes several times its bytes while it is decoded. Many workers that decode large bodies at the
//! same time could fill the memory before the first of them notices. So each takes its share of a room of
//! bytes before it begins, and waits until there is enough.

use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use toolpathd_core::budget::{Budget, Stopped};

/// Time between two checks of the budget while a body waits.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// A number of bytes that all decodings share.
#[derive(Debug)]
pub struct Room {
    free: Mutex<usize>,
    freed: Condvar,
    all: usize,
}

impl Room {
    pub fn new(bytes: usize) -> Arc<Self> {
        Arc::new(Self { free: Mutex::new(bytes), freed: Condvar::new(), all: bytes })
    }

    fn free(&self) -> MutexGuard<'_, usize> {
        self.free.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits until `bytes` are free, and takes them. A decoding that needs more than the whole room takes the
    /// whole room. Blocks the thread, so it belongs on a thread that computes.
    ///
    /// # Errors
    /// The reason when the budget ends before there is enough.
    pub fn take(self: &Arc<Self>, bytes: usize, budget: &Budget) -> Result<Share, Stopped> {
        let bytes = bytes.min(self.all);
        let mut free = self.free();
        while *free < bytes {
            budget.check()?;
            let waited = self.freed.wait_timeout(free, CHECK_INTERVAL);
            free = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
        *free -= bytes;
        Ok(Share { room: Arc::clone(self), bytes })
    }
}

/// The share of one decoding. Dropping it gives the share back.
#[derive(Debug)]
pub struct Share {
    room: Arc<Room>,
    bytes: usize,
}

impl Drop for Share {
    fn drop(&mut self) {
        *self.room.free() += self.bytes;
        self.room.freed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use std::thread;

    use super::*;

    #[test]
    fn a_decoding_waits_until_another_has_given_its_share_back() {
        let room = Room::new(100);
        let first = room.take(60, &Budget::unlimited()).expect("a share");
        let budget = Budget::unlimited();
        let second = thread::spawn({
            let (room, budget) = (Arc::clone(&room), budget.clone());
            move || room.take(60, &budget).map(|share| share.bytes)
        });
        drop(room.take(40, &Budget::unlimited()).expect("the rest of the room"));
        assert!(!second.is_finished());
        drop(first);
        assert_eq!(second.join().expect("no panic"), Ok(60));
        assert_eq!(*room.free(), 100);
    }

    #[test]
    fn the_wait_ends_with_the_budget() {
        let room = Room::new(100);
        let _all = room.take(1_000, &Budget::unlimited()).expect("the whole room");
        let budget = Budget::unlimited();
        budget.cancel();
        assert_eq!(room.take(1, &budget).map(|share| share.bytes), Err(Stopped::Cancelled));
    }
}
