//! Limits the memory that answers take. If a caller reads slowly or never, its answer waits in memory. The
//! service counts the bytes of each answer of known size until the last byte is written to the connection,
//! and refuses an answer that would bring the sum above the limit. An answer of unknown size is made in
//! parts, which wait in queues of limited size.

use std::sync::Arc;

use axum::body::HttpBody;
use axum::extract::{Request, State};
use axum::middleware::Next;
use axum::response::Response;

use super::envelope;
use crate::http::byte_limit::{ByteLimit, HeldBytes};
use crate::http::request::request_id::RequestId;

/// The layer that counts the bytes of every answer and puts them into the extensions of the response. A
/// computed answer has its bytes there already. The body that the connection sends keeps them until the last
/// byte is written.
pub async fn hold(
    State(memory): State<Arc<ByteLimit>>,
    id: RequestId,
    request: Request,
    next: Next,
) -> Response {
    let mut response = next.run(request).await;
    if response.extensions().get::<HeldBytes>().is_none() {
        let held = memory.hold();
        let size = response.body().size_hint().exact().unwrap_or(0);
        if let Err(refused) = held.take(usize::try_from(size).unwrap_or(usize::MAX)) {
            return envelope::answer_of(refused, &id);
        }
        response.extensions_mut().insert(held);
    }
    response
}
