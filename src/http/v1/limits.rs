//! What this server accepts.

use std::sync::Arc;

use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::App;
use crate::http::dto::meta;
use crate::http::error::ApiError;
use crate::http::output::Encoded;

/// How large a request may be, and how long it may take.
#[derive(Debug, Serialize, ToSchema)]
pub struct ServerLimits {
    body_bytes: usize,
    surface_points: usize,
    curve_points: usize,
    /// Elements of one interpolated curve.
    elements: usize,
    /// Points at which one cutter is dropped.
    drop_points: usize,
    /// Section planes of one milling job.
    sections: usize,
    /// Moves of one toolpath that is sent.
    moves: usize,
    meta_entries: usize,
    text_characters: usize,
    /// Computations at a time.
    workers: usize,
    /// Requests that may wait for a worker; one more is refused with 503.
    queue: usize,
    /// Waiting and computing end with 504 after this.
    deadline_s: f64,
    /// Bytes of a program that is rewritten as a stream.
    #[schema(maximum = 9_007_199_254_740_991_u64)]
    stream_bytes: u64,
    /// A stream ends after this.
    stream_deadline_s: f64,
    /// A body without progress for this long is answered with 408.
    body_timeout_s: f64,
}

impl From<&App> for ServerLimits {
    fn from(app: &App) -> Self {
        let Limits { body_bytes, surface_points, curve_points, elements, drop_points, sections, moves } =
            app.limits;
        Self {
            body_bytes,
            surface_points,
            curve_points,
            elements,
            drop_points,
            sections,
            moves,
            meta_entries: meta::MAX_ENTRIES,
            text_characters: meta::MAX_TEXT_CHARACTERS,
            workers: app.workers,
            queue: app.queue,
            deadline_s: app.deadline.as_secs_f64(),
            stream_bytes: app.streams.bytes,
            stream_deadline_s: app.streams.deadline.as_secs_f64(),
            body_timeout_s: app.body_timeout.as_secs_f64(),
        }
    }
}

/// The limits of this server, which are settings.
#[utoipa::path(get, path = "/v1/limits", operation_id = "getLimits", tag = "service",
    responses((status = 200, description = "All of them.", body = ServerLimits)))]
pub async fn get_limits(State(app): State<Arc<App>>) -> Result<Encoded, ApiError> {
    Encoded::json(&ServerLimits::from(&*app))
}
