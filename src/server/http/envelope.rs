//! Adds the id of the request and the version of the engine to every answer, and turns every failure into a
//! problem document (RFC 9457).

use std::any::Any;

use axum::body::Body;
use axum::extract::Request;
use axum::http::response::Parts;
use axum::http::{HeaderName, HeaderValue, Method, StatusCode, header};
use axum::middleware::Next;
use axum::response::{IntoResponse, Response};

use super::ENGINE_VERSION;
use super::compression::GZIP;
use super::error::{ApiError, Code, PROBLEM_JSON};
use super::guard;
use super::openapi;
use super::request_id::{self, RequestId};

pub const ENGINE_VERSION_HEADER: HeaderName = HeaderName::from_static("x-engine-version");

/// The layer around every handler.
pub async fn wrap(id: RequestId, request: Request, next: Next) -> Response {
    let asked = (request.method().clone(), request.uri().path().to_owned());
    let mut response = next.run(request).await;
    if response.status().is_client_error() || response.status().is_server_error() {
        response = into_problem(response, &id, &asked);
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

/// The failure for a refusal by the framework. Without a handler the detail lists the paths or methods there
/// are.
fn unanswered(parts: &Parts, (method, path): &(Method, String)) -> ApiError {
    let detail = match parts.status {
        StatusCode::NOT_FOUND => {
            format!("there is nothing at this path; there are {}", openapi::paths().join(", "))
        }
        StatusCode::METHOD_NOT_ALLOWED => {
            let allowed = match openapi::methods(path) {
                none if none.is_empty() => "another method".to_owned(),
                methods => methods.join(" and "),
            };
            format!("`{path}` does not answer {method}, but {allowed}")
        }
        _ => return ApiError::from_status(parts.status),
    };
    ApiError::from_status(parts.status).saying(detail)
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
/// the framework has a status alone.
fn into_problem(response: Response, id: &RequestId, asked: &(Method, String)) -> Response {
    let (mut parts, _) = response.into_parts();
    let error = parts.extensions.remove::<ApiError>().unwrap_or_else(|| unanswered(&parts, asked));
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
