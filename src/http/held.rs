//! Counts the bytes of answers until they are sent. A caller who reads slowly, or never, makes its answer
//! wait in memory; all answers that wait share a pot of limited size.

use std::pin::Pin;
use std::sync::Arc;
use std::task::{Context, Poll};

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::Response;
use hyper::body::{Frame, SizeHint};

use super::App;
use super::admission::Share;
use super::envelope;
use super::request_id::RequestId;

/// The layer that gives every answer its share of the memory for answers. A computed answer has its share
/// already.
pub async fn hold(State(app): State<Arc<App>>, id: RequestId, request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    let share = match response.extensions_mut().remove::<Share>() {
        Some(share) => share,
        None => {
            let share = app.answer_memory.share();
            // The parts of an answer without a size wait in queues of limited size.
            let size = response.body().size_hint().exact().unwrap_or(0);
            match share.take(usize::try_from(size).unwrap_or(usize::MAX)) {
                Ok(()) => share,
                Err(refused) => return envelope::answer_of(refused, &id),
            }
        }
    };
    response.map(|body| Body::new(Held { body, _share: share }))
}

/// A body with its share of the memory.
struct Held {
    body: Body,
    _share: Share,
}

impl HttpBody for Held {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
