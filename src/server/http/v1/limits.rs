//! `GET /v1/limits`: the limits of this server.

use std::sync::Arc;

use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use crate::config::Limits;
use crate::http::answer::encoded::Encoded;
use crate::http::app::App;
use crate::http::dto::meta;
use crate::http::dto::modelling::MAX_CONTROL_POINTS;
use crate::http::error::ApiError;
use toolpathd_core::geometry::surface::any_surface::PATCH_LIMIT;
use toolpathd_core::operations::{pocketing, surface_milling};
use toolpathd_post::MAX_BLOCKS;

/// How large a request may be, and how long a request may take.
#[derive(Debug, Serialize, ToSchema)]
pub struct ServerLimits {
    /// Largest body of a request, in bytes. For a body in gzip the limit holds for the bytes as sent and for
    /// the decompressed bytes.
    body_bytes: usize,
    /// Largest number of points of one surface.
    surface_points: usize,
    /// Largest number of points of one curve.
    curve_points: usize,
    /// Largest number of elements of one interpolated curve.
    elements: usize,
    /// Largest number of points at which one request drops a cutter.
    drop_points: usize,
    /// Largest number of section planes of one milling job.
    sections: usize,
    /// Largest number of moves of one toolpath, sent or computed.
    moves: usize,
    /// Largest number of CL points of one milling job. Where the cutter is lowered onto the surface, a
    /// twenty-fifth of it.
    cl_points: usize,
    /// Largest number of points of all wires of one model.
    wire_points: usize,
    /// Largest number of samples of one motion of five axes.
    samples: usize,
    /// Largest number of steps of the interpolation of one curve. A value of the curve takes one step for
    /// each of its operations, and some more.
    #[schema(maximum = 9_007_199_254_740_991_u64)]
    curve_steps: u64,
    /// Largest number of comparisons of the cutter with earlier cuts, for one pattern of a pocket. It grows
    /// with the inverse square of the stepover.
    #[schema(maximum = 9_007_199_254_740_991_u64)]
    cut_comparisons: u64,
    /// Largest number of patches of one surface: of the surface that the data make.
    patches: usize,
    /// Largest number of control points of all patches in one answer.
    control_points: usize,
    /// Largest number of stretches of wires that all passes of `wire_union` compare.
    wire_comparisons: usize,
    /// Largest number of levels of one pocket.
    levels: usize,
    /// Largest number of cutter radii that the path on one level of a pocket is long.
    level_radii: usize,
    /// Largest number of cells with `islands_by: labelling`.
    cells: usize,
    /// Largest number of blocks of one NC program that is written.
    blocks: usize,
    /// Largest number of entries of `meta`.
    meta_entries: usize,
    /// Longest text of `meta` and longest name of a program, in characters.
    text_characters: usize,
    /// Number of computations that run at the same time.
    workers: usize,
    /// Number of requests that may wait for a worker. Any further request is refused with status 503.
    queue: usize,
    /// Longest time for which a request waits for a worker, in s. Then the request is refused with status
    /// 503.
    queue_wait_s: f64,
    /// Longest computation, in s, without the wait for a worker. A longer computation ends with status 504.
    deadline_s: f64,
    /// Largest program that `/v1/arcs/fit` rewrites as a stream, in bytes.
    #[schema(maximum = 9_007_199_254_740_991_u64)]
    stream_bytes: u64,
    /// Longest time in which one stream is received and rewritten, in s.
    stream_deadline_s: f64,
    /// Longest time without a new byte of a body, in s. A slower body ends with status 408.
    body_timeout_s: f64,
    /// Longest time in which a whole body arrives, in s. A slower body ends with status 408.
    body_deadline_s: f64,
}

impl From<&App> for ServerLimits {
    fn from(app: &App) -> Self {
        let Limits {
            body_bytes,
            surface_points,
            curve_points,
            elements,
            drop_points,
            sections,
            moves,
            cl_points,
            wire_points,
            samples,
            curve_steps,
            cut_comparisons,
        } = app.computing.limits;
        Self {
            body_bytes,
            surface_points,
            curve_points,
            elements,
            drop_points,
            sections,
            moves,
            cl_points,
            wire_points,
            samples,
            curve_steps,
            cut_comparisons,
            patches: PATCH_LIMIT,
            control_points: MAX_CONTROL_POINTS,
            wire_comparisons: surface_milling::MOST_COMPARED,
            levels: pocketing::MOST_LEVELS,
            level_radii: pocketing::MOST_RADII,
            cells: pocketing::MOST_CELLS,
            blocks: MAX_BLOCKS,
            meta_entries: meta::MAX_ENTRIES,
            text_characters: meta::MAX_TEXT_CHARACTERS,
            workers: app.capacity.workers,
            queue: app.capacity.queue,
            queue_wait_s: app.capacity.wait.as_secs_f64(),
            deadline_s: app.capacity.deadline.as_secs_f64(),
            stream_bytes: app.streams.bytes,
            stream_deadline_s: app.streams.deadline.as_secs_f64(),
            body_timeout_s: app.body_limits.timeout.as_secs_f64(),
            body_deadline_s: app.body_limits.deadline.as_secs_f64(),
        }
    }
}

/// Tell the limits of this server.
///
/// Limits are settings of the server. A request beyond a limit is refused with the code `limit_exceeded`,
/// `payload_too_large`, `too_long`, `overloaded` or `deadline_passed`.
#[utoipa::path(get, path = "/v1/limits", operation_id = "getLimits", tag = "service",
    responses((status = 200, description = "All limits.", body = ServerLimits)))]
pub async fn get_limits(State(app): State<Arc<App>>) -> Result<Encoded, ApiError> {
    Encoded::json(&ServerLimits::from(&*app))
}
