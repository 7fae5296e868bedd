//! How fast a caller takes an answer. An answer goes out in pieces, and the next piece is made when the
//! connection has room for it. The time in which the connection had no room counts against the caller. It
//! counts until the last piece is written, and until then the answer keeps its share of memory.

use std::pin::Pin;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::task::{Context, Poll};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::{Frame, SizeHint};

use super::admission::Share;

/// Bytes of one piece. The connection may hold one piece more than its write buffer has room for.
const PIECE_BYTES: usize = 32 * 1024;

/// Bytes of an answer that a caller must take in a second, on average, beyond the write timeout.
const LEAST_BYTES_PER_S: f64 = 16.0 * 1024.0;

/// The pace of one answer. The body and every piece that is not written yet hold it.
#[derive(Debug)]
pub struct Pace {
    taken: Mutex<Taken>,
    /// The memory of the answer.
    _share: Option<Share>,
}

/// A piece of an answer, which holds the pace until it is written.
struct Piece {
    bytes: Bytes,
    _pace: Arc<Pace>,
}

impl AsRef<[u8]> for Piece {
    fn as_ref(&self) -> &[u8] {
        &self.bytes
    }
}

#[derive(Debug)]
struct Taken {
    /// Since when the connection has had no room. `None` while the answer itself is not ready.
    waiting: Option<Instant>,
    waited: Duration,
    bytes: u64,
}

impl Pace {
    fn taken(&self) -> MutexGuard<'_, Taken> {
        self.taken.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Whether the connection has had no room for `write_timeout`, or has had none in all for `write_timeout`
    /// and a second for each 16 KiB of the answer.
    pub fn is_too_slow(&self, write_timeout: Duration) -> bool {
        let taken = self.taken();
        let waits = taken.waiting.map_or(Duration::ZERO, |since| since.elapsed());
        let waited = taken.waited + waits;
        waits > write_timeout
            || waited > write_timeout + Duration::from_secs_f64(taken.bytes as f64 / LEAST_BYTES_PER_S)
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
    /// A body that has `share` of the memory for answers.
    pub fn new(body: Body, share: Option<Share>) -> Self {
        let taken = Mutex::new(Taken { waiting: Some(Instant::now()), waited: Duration::ZERO, bytes: 0 });
        Self { body, rest: Bytes::new(), pace: Arc::new(Pace { taken, _share: share }) }
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
                Poll::Pending => return Poll::Pending,
                ended => {
                    self.pace.taken().waiting = Some(now);
                    return ended;
                }
            }
        }
        let size = self.rest.len().min(PIECE_BYTES);
        let piece = self.rest.split_to(size);
        let mut taken = self.pace.taken();
        taken.waiting = Some(now);
        taken.bytes += size as u64;
        drop(taken);
        let piece = Bytes::from_owner(Piece { bytes: piece, _pace: Arc::clone(&self.pace) });
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
    use crate::http::admission::Pot;

    #[tokio::test]
    async fn pieces_are_the_body() {
        let bytes: Bytes = (0..=255).cycle().take(3 * PIECE_BYTES + 7).collect::<Vec<u8>>().into();
        let mut paced = Paced::new(Body::from(bytes.clone()), None);
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
    async fn an_answer_keeps_its_memory_until_its_last_piece_is_written() {
        let pot = Pot::new(1 << 20, "answers");
        let share = pot.share();
        let size = PIECE_BYTES + 1;
        share.take(size).expect("room");
        let mut paced = Paced::new(Body::from(vec![0; size]), Some(share));
        let pace = Arc::downgrade(paced.pace());
        let mut pieces = Vec::new();
        while let Some(frame) = std::future::poll_fn(|context| Pin::new(&mut paced).poll_frame(context)).await
        {
            pieces.push(frame.expect("no failure").into_data().expect("data"));
        }
        drop(paced);
        assert_eq!((pieces.len(), pot.held()), (2, size));
        pieces.remove(0);
        std::thread::sleep(Duration::from_millis(20));
        assert!(pace.upgrade().is_some_and(|pace| pace.is_too_slow(Duration::from_millis(10))));
        drop(pieces);
        assert_eq!((pace.strong_count(), pot.held()), (0, 0));
    }

    #[tokio::test]
    async fn time_counts_while_a_piece_waits_for_the_caller_only() {
        let short = Duration::from_millis(30);
        let never = futures_util::stream::pending::<Result<Bytes, axum::Error>>();
        let mut paced = Paced::new(Body::from_stream(never), None);
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
