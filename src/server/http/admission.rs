//! Refuses a request for which the service has no room. If the queue of computations is full, the request is
//! refused at once. If the bodies of all requests together fill the memory for bodies, a request is refused
//! while its body arrives. Answers that wait for their callers have a memory of their own.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::Method;
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};
use tokio::time::sleep;

use super::App;
use super::error::{ApiError, Code};

/// How long a refusal is held back. Without the pause, callers that try again at once would take processor
/// time from the running computations.
const REFUSAL_PAUSE: Duration = Duration::from_millis(10);

/// A body or an answer of at most this size may fill the last part of a pot. So large ones do not shut out
/// small ones.
const SMALL_BYTES: usize = 64 * 1024;

/// Larger ones leave one part in `PARTS` of a pot to the small ones.
const PARTS: usize = 8;

/// A limited number of bytes that all requests share.
#[derive(Debug)]
pub struct Pot {
    held: AtomicUsize,
    most: usize,
    /// What the bytes are, for messages.
    what: &'static str,
}

impl Pot {
    pub fn new(most: usize, what: &'static str) -> Arc<Self> {
        Arc::new(Self { held: AtomicUsize::new(0), most, what })
    }

    /// Bytes held now.
    pub fn held(&self) -> usize {
        self.held.load(Ordering::Relaxed)
    }

    /// A share that holds nothing yet.
    pub fn share(self: &Arc<Self>) -> Share {
        Share(Arc::new(Taken { pot: Arc::clone(self), bytes: AtomicUsize::new(0) }))
    }
}

/// The bytes of a pot that one request or one answer holds. They are free again when the last clone of the
/// share is dropped.
#[derive(Debug, Clone)]
pub struct Share(Arc<Taken>);

#[derive(Debug)]
struct Taken {
    pot: Arc<Pot>,
    bytes: AtomicUsize,
}

impl Share {
    /// The share of this request in the memory for bodies.
    ///
    /// # Errors
    /// `internal_error` when [`admit`] did not run for the request, which is a fault of this program.
    pub fn of(request: &Request) -> Result<Self, ApiError> {
        let share = request.extensions().get::<Self>().cloned();
        share.ok_or_else(|| ApiError::new(Code::InternalError, "the request was not given a share of memory"))
    }

    /// A share of the same pot that holds nothing yet.
    pub fn sibling(&self) -> Self {
        self.0.pot.share()
    }

    /// Takes further `bytes` of the pot.
    ///
    /// # Errors
    /// `overloaded` when the pot has no room for them.
    pub fn take(&self, bytes: usize) -> Result<(), ApiError> {
        let Taken { pot, bytes: mine } = &*self.0;
        let whole = mine.load(Ordering::Relaxed).saturating_add(bytes);
        // A single share may be as large as the pot.
        let most = if whole <= SMALL_BYTES || pot.held().saturating_add(bytes) == whole {
            pot.most
        } else {
            pot.most - pot.most / PARTS
        };
        let added = |held: usize| held.checked_add(bytes).filter(|sum| *sum <= most);
        match pot.held.fetch_update(Ordering::Relaxed, Ordering::Relaxed, added) {
            Ok(_) => {
                mine.fetch_add(bytes, Ordering::Relaxed);
                Ok(())
            }
            Err(_) => Err(ApiError::new(
                Code::Overloaded,
                format!("the server holds {} bytes of {} at most; try again later", pot.most, pot.what),
            )),
        }
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        self.pot.held.fetch_sub(*self.bytes.get_mut(), Ordering::Relaxed);
    }
}

/// Middleware that refuses a `POST` while the queue is full, before its body is read. Every other request
/// gets a [`Share`] of the memory for bodies, and its head counts until the head of the answer is ready.
pub async fn admit(State(app): State<Arc<App>>, mut request: Request, next: Next) -> Response {
    if request.method() == Method::POST && app.compute.is_full() {
        sleep(REFUSAL_PAUSE).await;
        return ApiError::from(app.compute.overloaded()).into_response();
    }
    let (head, share) = (app.head_memory.share(), app.body_memory.share());
    if let Err(refused) = head.take(bytes_of_head(&request)) {
        return refused.into_response();
    }
    request.extensions_mut().insert(share.clone());
    let response = next.run(request).await;
    drop((head, share));
    response
}

/// Estimates the bytes of a request's head: path, query and headers.
fn bytes_of_head(request: &Request) -> usize {
    let path = request.uri().path_and_query().map_or(0, |path| path.as_str().len());
    path + request.headers().iter().map(|(name, value)| name.as_str().len() + value.len()).sum::<usize>()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pot_is_bounded_over_all_shares_and_bytes_are_given_back() {
        let pot = Pot::new(100, "bodies");
        let (first, second) = (pot.share(), pot.share());
        assert_eq!(first.take(60), Ok(()));
        assert_eq!(second.take(40), Ok(()));
        assert_eq!(second.take(1).map_err(|error| error.code()), Err(Code::Overloaded));
        assert_eq!(second.take(usize::MAX).map_err(|error| error.code()), Err(Code::Overloaded));
        let copy = first.clone();
        drop(first);
        assert_eq!(pot.held(), 100);
        drop(copy);
        assert_eq!(pot.held(), 40);
        assert_eq!(second.take(60), Ok(()));
        drop(second);
        assert_eq!(pot.held(), 0);
    }

    #[test]
    fn large_shares_leave_room_for_small_ones_unless_one_is_alone() {
        let pot = Pot::new(100 * SMALL_BYTES, "answers");
        let alone = pot.share();
        assert_eq!(alone.take(100 * SMALL_BYTES), Ok(()));
        drop(alone);
        let (large, other, small) = (pot.share(), pot.share(), pot.share());
        assert_eq!(large.take(50 * SMALL_BYTES), Ok(()));
        assert_eq!(other.take(40 * SMALL_BYTES).map_err(|error| error.code()), Err(Code::Overloaded));
        assert_eq!(other.take(37 * SMALL_BYTES), Ok(()));
        assert_eq!(small.take(SMALL_BYTES), Ok(()));
    }
}
