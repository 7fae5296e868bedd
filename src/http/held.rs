//! Counts the bytes of every answer until they are sent. The answer of a caller who reads slowly, or never,
//! waits in memory. All waiting answers share a pot of limited size.

use std::sync::Arc;

use axum::body::{Body, HttpBody};
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::Response;

use super::App;
use super::admission::Share;
use super::envelope;
use super::request_id::RequestId;
use super::watched::{Seen, Watched};

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
    let hold = move |_: Seen| {
        let _held = &share;
    };
    response.map(|body| Body::new(Watched { body, tell: hold }))
}
