//! How fast a caller reads an answer. An answer goes out in pieces, and the next piece is made when the
//! connection has room for it. So a caller that does not read is one for whom a piece waits too long. An
//! answer keeps its memory until its last piece is written.
//!
//! hyper bounds neither: over HTTP/2 a caller can keep an answer waiting on a healthy connection. Answers
//! that nobody reads would fill the memory for answers, and all other callers would get 503.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::{Frame, SizeHint};

use crate::http::byte_limit::HeldBytes;

/// Bytes of one piece. The connection may hold one piece more than its write buffer has room for.
const PIECE_BYTES: usize = 32 * 1024;

/// The speed at which one answer is read. The body and every piece that is not written yet hold it.
#[derive(Debug)]
pub struct ReadingSpeed {
    /// Since when the connection has had no room. `None` while the answer itself is not ready.
    waiting: Mutex<Option<Instant>>,
    /// The memory of the answer.
    _held: Option<HeldBytes>,
}

/// A piece of an answer, which holds the speed until it is written.
struct AnswerPart {
    bytes: Bytes,
    _speed: Arc<ReadingSpeed>,
}

impl AsRef<[u8]> for AnswerPart {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

impl ReadingSpeed {
    fn waiting(&self) -> MutexGuard<'_, Option<Instant>> {
        self.waiting.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the connection has had no room for longer than `write_timeout`.
    pub fn is_too_slow(&self, write_timeout: Duration) -> bool {
        self.waiting().is_some_and(|since| since.elapsed() > write_timeout)
    }
}

/// A body in pieces, which tells its reading speed.
pub struct MeasuredBody {
    body: Body,
    /// The bytes that `body` has given and that are not sent yet.
    rest: Bytes,
    speed: Arc<ReadingSpeed>,
}

impl MeasuredBody {
    /// A body that keeps what it has `held` of the memory for answers.
    pub fn new(body: Body, held: Option<HeldBytes>) -> Self {
        let waiting = Mutex::new(Some(Instant::now()));
        Self { body, rest: Bytes::new(), speed: Arc::new(ReadingSpeed { waiting, _held: held }) }
    }

    pub fn speed(&self) -> &Arc<ReadingSpeed> {
        &self.speed
    }
}

impl HttpBody for MeasuredBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        *self.speed.waiting() = None;
        if self.rest.is_empty() {
            match Pin::new(&mut self.body).poll_frame(context) {
                Poll::Ready(Some(Ok(frame))) => match frame.into_data() {
                    Ok(data) => self.rest = data,
                    Err(trailers) => return Poll::Ready(Some(Ok(trailers))),
                },
                Poll::Pending => return Poll::Pending,
                ended => {
                    *self.speed.waiting() = Some(Instant::now());
                    return ended;
                }
            }
        }
        let size = self.rest.len().min(PIECE_BYTES);
        let piece = self.rest.split_to(size);
        *self.speed.waiting() = Some(Instant::now());
        let piece = Bytes::from_owner(AnswerPart { bytes: piece, _speed: Arc::clone(&self.speed) });
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
    use crate::http::byte_limit::ByteLimit;

    #[tokio::test]
    async fn pieces_are_the_body() {
        let bytes: Bytes = (0..=255).cycle().take(3 * PIECE_BYTES + 7).collect::<Vec<u8>>().into();
        let mut measured = MeasuredBody::new(Body::from(bytes.clone()), None);
        let size = bytes.len() as u64;
        assert_eq!(measured.size_hint().exact(), Some(size));
        let first = std::future::poll_fn(|context| Pin::new(&mut measured).poll_frame(context)).await;
        let first = first.expect("a piece").expect("no failure").into_data().expect("data");
        assert_eq!(first, bytes[..PIECE_BYTES]);
        assert_eq!(measured.size_hint().exact(), Some(size - PIECE_BYTES as u64));
        let rest = to_bytes(Body::new(measured), usize::MAX).await.expect("the rest");
        assert_eq!(rest, bytes[PIECE_BYTES..]);
    }

    #[tokio::test]
    async fn an_answer_keeps_its_memory_until_its_last_piece_is_written() {
        let limit = ByteLimit::new(1 << 20, "answers");
        let held = limit.hold();
        let size = PIECE_BYTES + 1;
        held.take(size).expect("room");
        let mut measured = MeasuredBody::new(Body::from(vec![0; size]), Some(held));
        let speed = Arc::downgrade(measured.speed());
        let mut pieces = Vec::new();
        while let Some(frame) =
            std::future::poll_fn(|context| Pin::new(&mut measured).poll_frame(context)).await
        {
            pieces.push(frame.expect("no failure").into_data().expect("data"));
        }
        drop(measured);
        assert_eq!((pieces.len(), limit.held()), (2, size));
        pieces.remove(0);
        std::thread::sleep(Duration::from_millis(20));
        assert!(speed.upgrade().is_some_and(|speed| speed.is_too_slow(Duration::from_millis(10))));
        drop(pieces);
        assert_eq!((speed.strong_count(), limit.held()), (0, 0));
    }

    #[tokio::test]
    async fn time_counts_while_a_piece_waits_for_the_caller_only() {
        let short = Duration::from_millis(30);
        let never = futures_util::stream::pending::<Result<Bytes, axum::Error>>();
        let mut measured = MeasuredBody::new(Body::from_stream(never), None);
        let speed = Arc::clone(measured.speed());
        std::thread::sleep(short);
        assert!(speed.is_too_slow(short / 2) && !speed.is_too_slow(1000 * short));
        let polled =
            std::future::poll_fn(|context| Poll::Ready(Pin::new(&mut measured).poll_frame(context))).await;
        assert!(polled.is_pending());
        std::thread::sleep(short);
        assert!(!speed.is_too_slow(short / 2));
    }
}
