//! Limits the memory that answers take. If a caller reads slowly or never, its answer waits in memory. The
//! service counts the bytes of each answer of known size until the last byte is written to the connection,
//! and refuses an answer that would bring the sum above the limit. An answer of unknown size is made in
//! parts, which wait in queues of limited size.

use std::sync::Arc;

use axum::body::HttpBody;
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::Response;

use super::App;
use super::admission::Share;
use super::envelope;
use super::request_id::RequestId;

/// The layer that gives every answer its share of the memory for answers, as an extension of the response. A
/// computed answer has its share already. The [`Paced`](super::pace::Paced) body of the connection keeps the
/// share.
pub async fn hold(State(app): State<Arc<App>>, id: RequestId, request: Request, next: Next) -> Response {
    let mut response = next.run(request).await;
    if response.extensions().get::<Share>().is_none() {
        let share = app.answer_memory.share();
        let size = response.body().size_hint().exact().unwrap_or(0);
        if let Err(refused) = share.take(usize::try_from(size).unwrap_or(usize::MAX)) {
            return envelope::answer_of(refused, &id);
        }
        response.extensions_mut().insert(share);
    }
    response
}
