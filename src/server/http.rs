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

use axum::Router;
use axum::middleware::{from_fn, from_fn_with_state};
use tokio::net::TcpListener;
use tower::util::option_layer;
use tower_http::catch_panic::CatchPanicLayer;

use answer::compression;
pub use app::App;
pub use dto::verification::{DIGESTED, SCHEMA as RECEIPT_SCHEMA};
pub use openapi::contract;
use service::envelope::Directory;
use service::{admission, answer_memory, cors, docs, envelope, guard, observe, repeated_key};
pub use v1::programs_verify::receipt_of;

/// The version of the service. The same request to the same version gives the same bytes.
pub const ENGINE_VERSION: &str = env!("CARGO_PKG_VERSION");

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
        .layer(option_layer(cors::layer(&app.cors_origins)))
        .layer(from_fn_with_state(Arc::clone(&app.cors_origins), cors::refuse_unlisted))
        .layer(from_fn_with_state(Arc::clone(&app.metrics), observe::observe))
}
