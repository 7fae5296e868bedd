//! Reads the rest of a request body after the answer has been sent.
//!
//! The service can refuse a body before the caller has sent all of it. If the service closed the connection
//! at once, the caller would see a connection reset, and might never read the answer. So the service reads
//! the rest of the body and throws it away, until the body ends, [`MAX_TIME`] has passed, or [`MAX_BYTES`]
//! are read. Then it closes the connection. hyper reads only what has arrived already, and a proxy in front
//! sees the same reset as a caller.

use std::pin::Pin;
use std::task::{Context, Poll};
use std::time::Duration;

use axum::body::{Bytes, HttpBody};
use axum::http::{HeaderMap, header};
use hyper::body::{Frame, Incoming, SizeHint};
use tokio::time::timeout;

/// Longest time for which the rest of a body is read. Then the connection is closed.
const MAX_TIME: Duration = Duration::from_secs(5);
/// Most bytes of the rest that are read. Then the connection is closed.
const MAX_BYTES: usize = 256 * 1024 * 1024;

/// A body. When it is dropped before its end, a task reads the rest and throws it away.
pub struct DrainedBody {
    body: Option<Incoming>,
    /// Whether the caller waits for permission to send the body (`Expect: 100-continue`).
    is_held_back: bool,
}

impl DrainedBody {
    pub fn new(headers: &HeaderMap, body: Incoming) -> Self {
        Self { body: Some(body), is_held_back: headers.contains_key(header::EXPECT) }
    }
}

impl HttpBody for DrainedBody {
    type Data = Bytes;
    type Error = hyper::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, hyper::Error>>> {
        // Reading the first part makes hyper send the permission.
        self.is_held_back = false;
        let Some(body) = &mut self.body else { return Poll::Ready(None) };
        let frame = Pin::new(body).poll_frame(context);
        if let Poll::Ready(None | Some(Err(_))) = frame {
            self.body = None;
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.body.as_ref().is_none_or(HttpBody::is_end_stream)
    }

    fn size_hint(&self) -> SizeHint {
        self.body.as_ref().map_or_else(|| SizeHint::with_exact(0), HttpBody::size_hint)
    }
}

impl Drop for DrainedBody {
    fn drop(&mut self) {
        let rest = self.body.take().filter(|body| !self.is_held_back && !body.is_end_stream());
        if let Some(body) = rest {
            tokio::spawn(timeout(MAX_TIME, drain(body)));
        }
    }
}

async fn drain(mut body: Incoming) {
    let mut total = 0;
    while let Some(Ok(frame)) = std::future::poll_fn(|context| Pin::new(&mut body).poll_frame(context)).await
    {
        total += frame.data_ref().map_or(0, Bytes::len);
        if total > MAX_BYTES {
            return;
        }
    }
}
