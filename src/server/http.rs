//! The HTTP service: decodes requests into jobs, runs the jobs on a fixed number of threads, and encodes the
//! answers.
//!
//! Only these modules know status codes, media types and JSON. Each part may use the parts that stand before
//! it: `error`; `compute` and `byte_limit`; `decode` and `dto`; `request`; `answer`; `service`; `connection`;
//! [`App`], which holds what they need; `v1` with the handlers; `openapi`. This module puts them together.

mod answer;
mod app;
mod byte_limit;
pub mod compute;
mod connection;
mod decode;
mod dto;
mod error;
mod messages;
mod openapi;
mod page;
mod pointer;
mod request;
mod service;
mod v1;

use std::io;
use std::sync::Arc;
use std::time::Duration;

use axum::Router;
use axum::http::{HeaderName, HeaderValue, Method, header};
use axum::middleware::{from_fn, from_fn_with_state};
use tokio::net::TcpListener;
use tower::util::option_layer;
use tower_http::catch_panic::CatchPanicLayer;
use tower_http::cors::CorsLayer;

use answer::{compression, encoded, timing};
pub use app::App;
pub use dto::verification::{DIGESTED, SCHEMA as RECEIPT_SCHEMA};
pub use openapi::contract;
use request::{request_id, retry, trace};
use service::envelope::Directory;
use service::{admission, answer_memory, docs, envelope, guard, observe, repeated_key};
pub use v1::programs_verify::receipt_of;

/// The version of the service. The same request to the same version gives the same bytes.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

/// How long a browser may remember what pages of another origin may do.
const PREFLIGHT_AGE: Duration = Duration::from_secs(3600);

/// Serves `router` until `stop` resolves, and then drains: see `connection::serve`.
///
/// # Errors
/// When the listener cannot be used.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    app: &App,
    stop: impl Future<Output = ()>,
) -> io::Result<()> {
    connection::serve::serve(listener, router, &app.connections, stop, |end| app.drain(end)).await
}

/// All routes, inside the layers that every request passes. The outermost layer stands last.
pub fn router(app: &Arc<App>) -> Router {
    let (routes, _) = openapi::routes().split_for_parts();
    routes
        .merge(docs::routes())
        .merge(page::routes())
        .route_layer(from_fn_with_state(app.admission.clone(), admission::admit))
        .with_state(Arc::clone(app))
        .layer(compression::layer())
        .layer(CatchPanicLayer::custom(envelope::panicked))
        .layer(from_fn_with_state(Arc::clone(&app.hosts), guard::check_host))
        .layer(from_fn_with_state(openapi::unanswered as Directory, envelope::wrap))
        .layer(from_fn_with_state(Arc::clone(&app.answer_memory), answer_memory::hold))
        .layer(from_fn(repeated_key::repeat_key))
        .layer(option_layer(cors(&app.cors_origins)))
        .layer(from_fn_with_state(Arc::clone(&app.metrics), observe::observe))
}

/// Lets pages of these origins call the service and read the headers of its answers. `None` without origins.
///
/// [`PREFLIGHT_AGE`] spares a browser the question before each request.
fn cors(origins: &[HeaderValue]) -> Option<CorsLayer> {
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
    const ALLOWED: [HeaderName; 6] = [
        header::ACCEPT,
        header::CONTENT_TYPE,
        header::CONTENT_ENCODING,
        request_id::HEADER,
        trace::HEADER,
        retry::IDEMPOTENCY_KEY,
    ];
    let layer = CorsLayer::new()
        .allow_origin(origins.to_vec())
        .allow_methods([Method::GET, Method::POST, Method::PUT])
        .allow_headers(ALLOWED)
        .expose_headers(EXPOSED)
        .max_age(PREFLIGHT_AGE);
    (!origins.is_empty()).then_some(layer)
}
