//! Refuses a request for which the service has no room. If the queue of computations is full, the request is
//! refused at once. If the bodies of all requests together fill the memory for bodies, a request is refused
//! while its body arrives.

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

/// The memory for request bodies, shared by all requests.
#[derive(Debug)]
pub struct BodyMemory {
    held: AtomicUsize,
    most: usize,
}

impl BodyMemory {
    pub fn new(most: usize) -> Arc<Self> {
        Arc::new(Self { held: AtomicUsize::new(0), most })
    }

    /// Bytes of request bodies held now.
    pub fn held(&self) -> usize {
        self.held.load(Ordering::Relaxed)
    }

    fn share(self: &Arc<Self>) -> Share {
        Share(Arc::new(Taken { memory: Arc::clone(self), bytes: AtomicUsize::new(0) }))
    }
}

/// The part of the memory that one request holds, until the request is answered or given up.
#[derive(Debug, Clone)]
pub struct Share(Arc<Taken>);

#[derive(Debug)]
struct Taken {
    memory: Arc<BodyMemory>,
    bytes: AtomicUsize,
}

impl Share {
    /// The share of this request.
    ///
    /// # Errors
    /// `internal_error` when [`admit`] did not run for the request, which is a fault of this program.
    pub fn of(request: &Request) -> Result<Self, ApiError> {
        let share = request.extensions().get::<Self>().cloned();
        share.ok_or_else(|| ApiError::new(Code::InternalError, "the request was not given a share of memory"))
    }

    /// Takes memory for `bytes` that have arrived or were decompressed.
    ///
    /// # Errors
    /// `overloaded` when the bodies of all requests together would exceed the limit.
    pub fn take(&self, bytes: usize) -> Result<(), ApiError> {
        let Taken { memory, bytes: mine } = &*self.0;
        let added = |held: usize| held.checked_add(bytes).filter(|sum| *sum <= memory.most);
        match memory.held.fetch_update(Ordering::Relaxed, Ordering::Relaxed, added) {
            Ok(_) => {
                mine.fetch_add(bytes, Ordering::Relaxed);
                Ok(())
            }
            Err(_) => Err(ApiError::new(
                Code::Overloaded,
                format!("the server holds {} bytes of request bodies at most; try again later", memory.most),
            )),
        }
    }
}

impl Drop for Taken {
    fn drop(&mut self) {
        self.memory.held.fetch_sub(*self.bytes.get_mut(), Ordering::Relaxed);
    }
}

/// Middleware that refuses a `POST` while the queue is full, before its body is read. Every other request
/// gets a [`Share`] of the memory for bodies.
pub async fn admit(State(app): State<Arc<App>>, mut request: Request, next: Next) -> Response {
    if request.method() == Method::POST && app.compute.is_full() {
        sleep(REFUSAL_PAUSE).await;
        return ApiError::from(super::compute::Failure::Overloaded).into_response();
    }
    let share = app.body_memory.share();
    request.extensions_mut().insert(share.clone());
    let response = next.run(request).await;
    drop(share);
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn body_memory_is_bounded_over_all_requests_and_given_back() {
        let memory = BodyMemory::new(100);
        let (first, second) = (memory.share(), memory.share());
        assert_eq!(first.take(60), Ok(()));
        assert_eq!(second.take(40), Ok(()));
        assert_eq!(second.take(1).map_err(|error| error.code()), Err(Code::Overloaded));
        assert_eq!(second.take(usize::MAX).map_err(|error| error.code()), Err(Code::Overloaded));
        let copy = first.clone();
        drop(first);
        assert_eq!(memory.held(), 100);
        drop(copy);
        assert_eq!(memory.held(), 40);
        assert_eq!(second.take(60), Ok(()));
        drop(second);
        assert_eq!(memory.held(), 0);
    }
}
