//! The id of a request, in its answer and in the log.

use axum::extract::FromRequestParts;
use axum::http::request::Parts;
use axum::http::{HeaderMap, HeaderName, HeaderValue, Request};
use tower_http::request_id::{MakeRequestId, MakeRequestUuid};

use crate::http::error::{ApiError, Code};

pub const HEADER: HeaderName = HeaderName::from_static("x-request-id");

/// Most characters of a caller's id. A longer id is replaced.
const MAX_LENGTH: usize = 128;

#[derive(Debug, Clone)]
pub struct RequestId(String);

impl RequestId {
    /// The caller's own id if it is safe in a log line, else a new id.
    pub fn of(headers: &HeaderMap) -> Self {
        let sent = headers.get(HEADER).and_then(|value| value.to_str().ok());
        match sent {
            Some(id) if is_sane(id) => Self(id.to_owned()),
            _ => Self::generate(),
        }
    }

    pub fn generate() -> Self {
        let made = MakeRequestUuid.make_request_id(&Request::new(()));
        let text = made.as_ref().and_then(|id| id.header_value().to_str().ok());
        Self(text.unwrap_or_default().to_owned())
    }

    pub fn as_str(&self) -> &str {
        &self.0
    }

    pub fn header_value(&self) -> HeaderValue {
        HeaderValue::from_str(&self.0).unwrap_or(HeaderValue::from_static(""))
    }
}

fn is_sane(id: &str) -> bool {
    (1..=MAX_LENGTH).contains(&id.len())
        && id.bytes().all(|byte| byte.is_ascii_alphanumeric() || b"-_.:/+=@~".contains(&byte))
}

/// Takes the id that the outermost layer gave to the request.
impl<S: Sync> FromRequestParts<S> for RequestId {
    type Rejection = ApiError;

    async fn from_request_parts(parts: &mut Parts, _: &S) -> Result<Self, ApiError> {
        parts
            .extensions
            .get::<RequestId>()
            .cloned()
            .ok_or_else(|| ApiError::new(Code::InternalError, "the request was not given an id"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_that_could_forge_a_log_line_are_replaced() {
        let of = |id: &str| {
            let mut headers = HeaderMap::new();
            headers.insert(HEADER, HeaderValue::from_bytes(id.as_bytes()).expect("a header"));
            RequestId::of(&headers).as_str().to_owned()
        };
        assert_eq!(of("job-7:a/b"), "job-7:a/b");
        for bad in ["", "a b", "a\"b", "{}", "\u{e9}", &"x".repeat(129)] {
            assert_ne!(of(bad), bad);
            assert_eq!(of(bad).len(), 36);
        }
        assert_ne!(RequestId::generate().as_str(), RequestId::generate().as_str());
    }
}
