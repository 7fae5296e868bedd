//! A body that reports what goes through it.

use std::pin::Pin;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes, HttpBody};
use hyper::body::{Frame, SizeHint};

/// An event of a body: some bytes, or its end.
pub enum Seen {
    Data(usize),
    End,
}

/// A body that reports every event to `tell`. Whatever `tell` holds is dropped with the body.
pub struct CountedBody<F> {
    pub body: Body,
    pub tell: F,
}

impl<F: FnMut(Seen) + Unpin> HttpBody for CountedBody<F> {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        let frame = Pin::new(&mut self.body).poll_frame(context);
        if let Poll::Ready(Some(Ok(frame))) = &frame
            && let Some(data) = frame.data_ref()
        {
            (self.tell)(Seen::Data(data.len()));
        }
        if matches!(frame, Poll::Ready(None)) || self.body.is_end_stream() {
            (self.tell)(Seen::End);
        }
        frame
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
