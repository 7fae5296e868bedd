//! Limits on the bytes that all requests together hold: heads, bodies, and answers that wait for their
//! callers.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use axum::extract::Request;

use super::error::{ApiError, Code};

/// A body or an answer of at most this size may fill the last part of a limit. So large ones do not shut out
/// small ones.
const SMALL_BYTES: usize = 64 * 1024;

/// Larger ones leave one part in `PARTS` of a limit to the small ones.
const PARTS: usize = 8;

/// A limited number of bytes that all requests share.
#[derive(Debug)]
pub struct ByteLimit {
    held: AtomicUsize,
    most: usize,
    /// What the bytes are, for messages.
    what: &'static str,
}

impl ByteLimit {
    pub fn new(most: usize, what: &'static str) -> Arc<Self> {
        Arc::new(Self { held: AtomicUsize::new(0), most, what })
    }

    /// Bytes held now.
    pub fn held(&self) -> usize {
        self.held.load(Ordering::Relaxed)
    }

    /// The bytes of one holder, none at first.
    pub fn hold(self: &Arc<Self>) -> HeldBytes {
        HeldBytes(Arc::new(Taken { limit: Arc::clone(self), bytes: AtomicUsize::new(0) }))
    }
}

/// The bytes that one request or one answer holds. They are free again when the last clone is dropped.
#[derive(Debug, Clone)]
pub struct HeldBytes(Arc<Taken>);

#[derive(Debug)]
struct Taken {
    limit: Arc<ByteLimit>,
    bytes: AtomicUsize,
}

impl HeldBytes {
    /// The bytes of this request in the memory for bodies.
    ///
    /// # Errors
    /// `internal_error` when no layer has put the value into the request, which is a fault of this program.
    pub fn of(request: &Request) -> Result<Self, ApiError> {
        let held = request.extensions().get::<Self>().cloned();
        held.ok_or_else(|| ApiError::new(Code::InternalError, "the request was not given a share of memory"))
    }

    /// Another holder under the same limit, with no bytes at first.
    pub fn sibling(&self) -> Self {
        self.0.limit.hold()
    }

    /// Takes `bytes` more.
    ///
    /// # Errors
    /// `overloaded` when the limit has no room for them.
    pub fn take(&self, bytes: usize) -> Result<(), ApiError> {
        let Taken { limit, bytes: mine } = &*self.0;
        let whole = mine.load(Ordering::Relaxed).saturating_add(bytes);
        // A single holder may hold as much as the limit.
        let most = if whole <= SMALL_BYTES || limit.held().saturating_add(bytes) == whole {
            limit.most
        } else {
            limit.most - limit.most / PARTS
        };
        let added = |held: usize| held.checked_add(bytes).filter(|sum| *sum <= most);
        match limit.held.fetch_update(Ordering::Relaxed, Ordering::Relaxed, added) {
            Ok(_) => {
                mine.fetch_add(bytes, Ordering::Relaxed);
                Ok(())
            }
            Err(_) => Err(ApiError::new(
                Code::Overloaded,
                format!("the server holds {} bytes of {} at most; try again later", limit.most, limit.what),
            )),
        }
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        self.limit.held.fetch_sub(*self.bytes.get_mut(), Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_limit_holds_over_all_holders_and_bytes_are_given_back() {
        let limit = ByteLimit::new(100, "bodies");
        let (first, second) = (limit.hold(), limit.hold());
        assert_eq!(first.take(60), Ok(()));
        assert_eq!(second.take(40), Ok(()));
        assert_eq!(second.take(1).map_err(|error| error.code()), Err(Code::Overloaded));
        assert_eq!(second.take(usize::MAX).map_err(|error| error.code()), Err(Code::Overloaded));
        let copy = first.clone();
        drop(first);
        assert_eq!(limit.held(), 100);
        drop(copy);
        assert_eq!(limit.held(), 40);
        assert_eq!(second.take(60), Ok(()));
        drop(second);
        assert_eq!(limit.held(), 0);
    }

    #[test]
    fn large_holders_leave_room_for_small_ones_unless_one_is_alone() {
        let limit = ByteLimit::new(100 * SMALL_BYTES, "answers");
        let alone = limit.hold();
        assert_eq!(alone.take(100 * SMALL_BYTES), Ok(()));
        drop(alone);
        let (large, other, small) = (limit.hold(), limit.hold(), limit.hold());
        assert_eq!(large.take(50 * SMALL_BYTES), Ok(()));
        assert_eq!(other.take(40 * SMALL_BYTES).map_err(|error| error.code()), Err(Code::Overloaded));
        assert_eq!(other.take(37 * SMALL_BYTES), Ok(()));
        assert_eq!(small.take(SMALL_BYTES), Ok(()));
    }
}
