//! Pages of other origins: which ones may call the service, and what their browsers are told.

use std::sync::Arc;
use std::time::Duration;

use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue, Method, header};
use axum::middleware::Next;
use axum::response::Response;
use tower_http::cors::CorsLayer;

use super::envelope;
use crate::http::answer::{compression, encoded, timing};
use crate::http::error::{ApiError, Code};
use crate::http::request::{request_id, retry, trace};

/// How long a browser may remember what a preflight said: it spares the question before each request.
const PREFLIGHT_AGE: Duration = Duration::from_secs(3600);

/// What pages may read of an answer.
const EXPOSED: [HeaderName; 11] = [
    request_id::HEADER,
    envelope::ENGINE_VERSION_HEADER,
    trace::HEADER,
    header::CONTENT_DISPOSITION,
    header::CONTENT_ENCODING,
    header::RETRY_AFTER,
    encoded::WARNINGS,
    compression::REPR_DIGEST,
    timing::SERVER_TIMING,
    retry::IDEMPOTENCY_KEY,
    retry::JOB_ORDER_ID,
];

/// What pages may send. A proxy in front of the service may ask for `authorization`.
const ALLOWED: [HeaderName; 7] = [
    header::ACCEPT,
    header::AUTHORIZATION,
    header::CONTENT_TYPE,
    header::CONTENT_ENCODING,
    request_id::HEADER,
    trace::HEADER,
    retry::IDEMPOTENCY_KEY,
];

/// Lets pages of these origins call the service and read the headers of its answers. `None` without origins.
pub fn layer(origins: &[HeaderValue]) -> Option<CorsLayer> {
    let layer = CorsLayer::new()
        .allow_origin(origins.to_vec())
        .allow_methods([Method::GET, Method::POST, Method::PUT])
        .allow_headers(ALLOWED)
        .expose_headers(EXPOSED)
        .max_age(PREFLIGHT_AGE);
    (!origins.is_empty()).then_some(layer)
}

/// The layer that refuses the preflight of a page whose origin is not listed, and says what lists it. A
/// browser would refuse the page anyway, and say less.
pub async fn refuse_unlisted(
    State(origins): State<Arc<[HeaderValue]>>,
    id: request_id::RequestId,
    request: Request,
    next: Next,
) -> Response {
    match unlisted(&origins, &request) {
        Some(origin) => {
            let is_listable = origin.starts_with("http://") || origin.starts_with("https://");
            let advice = if is_listable {
                format!("start it with `--cors-origin {origin}`, or call it from pages of its own address")
            } else {
                "put the page on a server, and list its origin in `--cors-origin`".to_owned()
            };
            let detail = format!("pages of {origin} may not call this service: {advice}");
            envelope::answer_of(ApiError::new(Code::OriginRefused, detail), &id)
        }
        None => next.run(request).await,
    }
}

/// The origin of a preflight, if it is not listed.
fn unlisted(origins: &[HeaderValue], request: &Request) -> Option<String> {
    let asks = request.headers().contains_key(header::ACCESS_CONTROL_REQUEST_METHOD);
    let origin = request.headers().get(header::ORIGIN)?;
    let is_unlisted = request.method() == Method::OPTIONS && asks && !origins.contains(origin);
    is_unlisted.then(|| String::from_utf8_lossy(origin.as_bytes()).into_owned())
}
