//! Adds the id of the request and the version of the engine to every answer, and turns every failure into a
//! problem document (RFC 9457).

use std::any::Any;

use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::{HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::guard;
use crate::http::ENGINE_VERSION;
use crate::http::error::{ApiError, Code, PROBLEM_JSON};
use crate::http::request::coding::GZIP;
use crate::http::request::request_id::{self, RequestId};

pub const ENGINE_VERSION_HEADER: HeaderName = HeaderName::from_static("x-engine-version");

/// What can be found at a path: the detail of a 404 or 405 for this method and path.
pub type Directory = fn(StatusCode, &Method, &str) -> Option<String>;

/// The layer around every handler.
pub async fn wrap(
    State(directory): State<Directory>,
    id: RequestId,
    request: Request,
    next: Next,
) -> Response {
    let (method, path) = (request.method().clone(), request.uri().path().to_owned());
    let mut response = next.run(request).await;
    if response.status().is_client_error() || response.status().is_server_error() {
        let detail = directory(response.status(), &method, &path);
        response = into_problem(response, &id, detail);
    }
    finish(&mut response, &id);
    response
}

/// Adds the headers of every answer.
fn finish(response: &mut Response, id: &RequestId) {
    let headers = response.headers_mut();
    guard::protect(headers);
    headers.insert(request_id::HEADER, id.header_value());
    headers.insert(ENGINE_VERSION_HEADER, HeaderValue::from_static(ENGINE_VERSION));
    // Every answer has `Vary`, problems too: the same request may later get an answer in one of several
    // types.
    headers.insert(header::VARY, HeaderValue::from_static("Accept, Accept-Encoding"));
}

/// The whole answer with `error`, for layers around [`wrap`].
pub fn answer_of(error: ApiError, id: &RequestId) -> Response {
    let mut response = response_of(error, id);
    finish(&mut response, id);
    response
}

/// The response that holds `error` as a problem.
fn response_of(error: ApiError, id: &RequestId) -> Response {
    let (status, code, retry_after) = (error.status(), error.code(), error.retry_after_s());
    let body = serde_json::to_vec(&error.problem(id.as_str())).unwrap_or_default();
    let mut response = (status, Body::from(body)).into_response();
    let headers = response.headers_mut();
    headers.insert(header::CONTENT_TYPE, HeaderValue::from_static(PROBLEM_JSON));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    if status == StatusCode::SERVICE_UNAVAILABLE {
        headers.insert(header::RETRY_AFTER, retry_after.into());
    }
    if code == Code::UnsupportedCoding {
        headers.insert(header::ACCEPT_ENCODING, HeaderValue::from_static(GZIP));
    }
    // The log and the metrics read the code.
    response.extensions_mut().insert(code);
    response
}

/// The answer to a request whose handler panicked.
pub fn panicked(_: Box<dyn Any + Send>) -> Response<Body> {
    ApiError::new(Code::InternalError, "the server failed: report the request id").into_response()
}

/// Replaces a failure by its problem. A handler's failure is in the extensions of the response; a failure of
/// the framework has a status alone, and perhaps `detail`.
fn into_problem(response: Response, id: &RequestId, detail: Option<String>) -> Response {
    let (mut parts, _) = response.into_parts();
    let error = parts.extensions.remove::<ApiError>().unwrap_or_else(|| {
        let error = ApiError::from_status(parts.status);
        detail.map_or(error.clone(), |detail| error.saying(detail))
    });
    if parts.status == StatusCode::INTERNAL_SERVER_ERROR {
        tracing::error!(request_id = id.as_str(), cause = error.detail(), "a fault of the server");
    }
    let mut problem = response_of(error, id);
    for name in [header::ALLOW, header::CONNECTION] {
        if let Some(value) = parts.headers.remove(&name) {
            problem.headers_mut().insert(name, value);
        }
    }
    problem
}
