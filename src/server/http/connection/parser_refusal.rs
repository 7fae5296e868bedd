//! Adds a problem document to the answer if the HTTP parser refuses a request.
//!
//! hyper's parser refuses a request whose head it cannot read, or whose head is too large. No other code of
//! the service sees such a request: hyper itself writes a status without a body, and closes the connection.
//! hyper has no hook for this answer. It stays because the contract promises a problem with every failure,
//! and a path or a header that is too long is a likely mistake.

use axum::body::{Bytes, to_bytes};
use axum::http::response::Parts;
use axum::http::{HeaderValue, StatusCode, header};
use futures_util::FutureExt;

use crate::http::error::ApiError;
use crate::http::request::request_id::{self, RequestId};
use crate::http::service::envelope;

/// The answer with a problem that replaces `head`. `None` unless `head` is a refusal by the parser itself.
pub fn explained(head: &[u8]) -> Option<Bytes> {
    let text = std::str::from_utf8(head).ok()?;
    let status = text.strip_prefix("HTTP/1.1 ")?.get(..3)?;
    let status = StatusCode::from_bytes(status.as_bytes()).ok()?;
    // Every answer of a handler or a layer has the header with the request's id.
    let is_bare = text.ends_with("\r\n\r\n") && !text.contains(request_id::HEADER.as_str());
    if !status.is_client_error() || !is_bare {
        return None;
    }
    let refused = envelope::answer_of(ApiError::from_status(status), &RequestId::generate());
    let (Parts { mut headers, .. }, body) = refused.into_parts();
    // The body is whole already.
    let body = to_bytes(body, usize::MAX).now_or_never()?.ok()?;
    headers.insert(header::CONTENT_LENGTH, body.len().into());
    headers.insert(header::CONNECTION, HeaderValue::from_static("close"));
    let mut answer = format!("HTTP/1.1 {status}\r\n").into_bytes();
    for (name, value) in &headers {
        answer.extend([name.as_str().as_bytes(), b": ", value.as_bytes(), b"\r\n"].concat());
    }
    answer.extend(b"\r\n");
    answer.extend(body);
    Some(answer.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bare_refusals_are_rewritten() {
        let bare = "HTTP/1.1 431 Request Header Fields Too Large\r\ncontent-length: 0\r\n\r\n";
        let answer = String::from_utf8(explained(bare.as_bytes()).expect("rewritten").into()).expect("UTF-8");
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        assert!(
            head.starts_with("HTTP/1.1 431 ") && head.contains(&format!("content-length: {}", body.len()))
        );
        let problem: serde_json::Value = serde_json::from_str(body).expect("JSON");
        assert_eq!(problem["code"], "headers_too_large");
        assert!(head.contains(problem["request_id"].as_str().expect("an id")));
        for other in [
            "HTTP/1.1 200 OK\r\n\r\n",
            "HTTP/1.1 404 Not Found\r\nx-request-id: 7\r\n\r\n",
            "HTTP/1.1 400 Bad Request\r\n",
            "HTTP/1.1 4",
            "{}",
        ] {
            assert_eq!(explained(other.as_bytes()), None, "{other}");
        }
    }
}
