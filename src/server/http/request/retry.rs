//! What callers need to send a request again and to find its answer among others: their own key, and the
//! number of their job order. The service keeps nothing of a request; the same request gives the same answer.

use axum::http::{HeaderName, HeaderValue};
use percent_encoding::{AsciiSet, CONTROLS, utf8_percent_encode};

use crate::http::dto::meta::Meta;
use crate::http::error::{ApiError, Code};

/// The caller's key of a request and its repetitions.
pub const IDEMPOTENCY_KEY: HeaderName = HeaderName::from_static("idempotency-key");

/// The text `job_order_id` of the request's `meta`.
pub const JOB_ORDER_ID: HeaderName = HeaderName::from_static("toolpathd-job-order-id");

/// The entry of `meta` that becomes a header.
const JOB_ORDER: &str = "job_order_id";

/// Most characters of a key.
const MAX_KEY_CHARACTERS: usize = 255;

/// Characters of a job order that are percent-encoded in a header. `%` is among them, so that the text can be
/// told from its code.
const CODED: &AsciiSet = &CONTROLS.add(b'%');

/// Checks the caller's key.
///
/// # Errors
/// `bad_request` for a key that is too long, empty, or not of visible characters.
pub fn check(key: &HeaderValue) -> Result<(), ApiError> {
    let is_visible = key.as_bytes().iter().all(|byte| (b' '..=b'~').contains(byte));
    let is_legal = (1..=MAX_KEY_CHARACTERS).contains(&key.len()) && is_visible;
    let refused = || {
        let detail = format!("`idempotency-key` must be 1 to {MAX_KEY_CHARACTERS} visible ASCII characters");
        ApiError::new(Code::BadRequest, detail)
    };
    is_legal.then_some(()).ok_or_else(refused)
}

/// The header with the job order of `meta`. `None` where `meta` has none.
pub fn job_order(meta: Option<&Meta>) -> Option<HeaderValue> {
    let text = meta?.get(JOB_ORDER)?;
    HeaderValue::from_str(&utf8_percent_encode(text, CODED).to_string()).ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_short_and_visible() {
        assert_eq!(check(&HeaderValue::from_static("\"8e03978e\" 7")), Ok(()));
        let long = HeaderValue::from_str(&"x".repeat(256)).expect("a header");
        for bad in [
            HeaderValue::from_static(""),
            HeaderValue::from_static("a\tb"),
            long,
            HeaderValue::from_bytes(b"\xff").expect("a header"),
        ] {
            assert_eq!(check(&bad).expect_err("refused").code(), Code::BadRequest);
        }
    }

    #[test]
    fn a_job_order_is_readable_in_a_header_and_other_characters_are_coded() {
        let of = |text: &str| job_order(Some(&[(JOB_ORDER.to_owned(), text.to_owned())].into()));
        assert_eq!(of("WO 4711/2"), Some(HeaderValue::from_static("WO 4711/2")));
        assert_eq!(of("100 %\r\n\u{fc}"), Some(HeaderValue::from_static("100 %25%0D%0A%C3%BC")));
        assert_eq!(job_order(Some(&Meta::new())), None);
    }
}
