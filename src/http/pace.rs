//! How fast a caller takes an answer. An answer goes out in pieces, and the next piece is made when the
//! connection has room for it. The time in which the connection had no room counts against the caller.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::{Frame, SizeHint};

/// Bytes of one piece. The connection holds a piece beside the bytes for which it has room.
const PIECE_BYTES: usize = 32 * 1024;

/// Bytes of an answer that a caller must take in each second, beyond the write timeout.
const LEAST_BYTES_PER_S: f64 = 16.0 * 1024.0;

/// The pace of one answer.
#[derive(Debug)]
pub struct Pace(Mutex<Taken>);

#[derive(Debug)]
struct Taken {
    /// Since when the connection has had no room. `None` while the answer itself is not ready.
    waiting: Option<Instant>,
    waited: Duration,
    bytes: u64,
}

impl Pace {
    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the caller has taken no byte for `write_timeout`, or takes the answer too slowly in all.
    pub fn is_too_slow(&self, write_timeout: Duration) -> bool {
        let taken = self.taken();
        let waited = taken.waited + taken.waiting.map_or(Duration::ZERO, |since| since.elapsed());
        waited > write_timeout + Duration::from_secs_f64(taken.bytes as f64 / LEAST_BYTES_PER_S)
    }
}

/// A body in pieces, which tells its pace.
pub struct Paced {
    body: Body,
    /// The bytes that `body` has given and that are not sent yet.
    rest: Bytes,
    pace: Arc<Pace>,
}

impl Paced {
    pub fn new(body: Body) -> Self {
        let taken = Taken { waiting: Some(Instant::now()), waited: Duration::ZERO, bytes: 0 };
        Self { body, rest: Bytes::new(), pace: Arc::new(Pace(Mutex::new(taken))) }
    }

    pub fn pace(&self) -> &Arc<Pace> {
        &self.pace
    }
}

impl HttpBody for Paced {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let now = Instant::now();
        {
            let mut taken = self.pace.taken();
            if let Some(since) = taken.waiting.take() {
                taken.waited += now - since;
            }
        }
        if self.rest.is_empty() {
            match Pin::new(&mut self.body).poll_frame(context) {
                Poll::Ready(Some(Ok(frame))) => match frame.into_data() {
                    Ok(data) => self.rest = data,
                    Err(trailers) => return Poll::Ready(Some(Ok(trailers))),
                },
                other => return other,
            }
        }
        let size = self.rest.len().min(PIECE_BYTES);
        let piece = self.rest.split_to(size);
        let mut taken = self.pace.taken();
        taken.waiting = Some(now);
        taken.bytes += size as u64;
        drop(taken);
        Poll::Ready(Some(Ok(Frame::data(piece))))
    }

    fn is_end_stream(&self) -> bool {
        self.rest.is_empty() && self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        let (rest, hint) = (self.rest.len() as u64, self.body.size_hint());
        let mut whole = SizeHint::new();
        whole.set_lower(hint.lower() + rest);
        if let Some(upper) = hint.upper() {
            whole.set_upper(upper + rest);
        }
        whole
    }
}

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;

    use super::*;

    #[tokio::test]
    async fn pieces_are_the_body() {
        let bytes: Bytes = (0..=255).cycle().take(3 * PIECE_BYTES + 7).collect::<Vec<u8>>().into();
        let mut paced = Paced::new(Body::from(bytes.clone()));
        let size = bytes.len() as u64;
        assert_eq!(paced.size_hint().exact(), Some(size));
        let first = std::future::poll_fn(|context| Pin::new(&mut paced).poll_frame(context)).await;
        let first = first.expect("a piece").expect("no failure").into_data().expect("data");
        assert_eq!(first, bytes[..PIECE_BYTES]);
        assert_eq!(paced.size_hint().exact(), Some(size - PIECE_BYTES as u64));
        let rest = to_bytes(Body::new(paced), usize::MAX).await.expect("the rest");
        assert_eq!(rest, bytes[PIECE_BYTES..]);
    }

    #[tokio::test]
    async fn time_counts_while_a_piece_waits_for_the_caller_only() {
        let short = Duration::from_millis(30);
        let mut paced =
            Paced::new(Body::from_stream(futures_util::stream::pending::<Result<Bytes, axum::Error>>()));
        let pace = Arc::clone(paced.pace());
        std::thread::sleep(short);
        assert!(pace.is_too_slow(short / 2) && !pace.is_too_slow(100 * short));
        let polled =
            std::future::poll_fn(|context| Poll::Ready(Pin::new(&mut paced).poll_frame(context))).await;
        assert!(polled.is_pending());
        let waited = pace.taken().waited;
        std::thread::sleep(short);
        assert_eq!(pace.taken().waited, waited);
        assert!(!pace.is_too_slow(waited));
    }
}
