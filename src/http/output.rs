//! What an answer is represented as, and how it is sent.

mod accept;
#[allow(dead_code)]
pub mod page;

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::error::{ApiError, Code};

pub const JSON: &str = "application/json";

/// The media types by which NC text is asked for, the preferred one first.
pub const GCODE: [&str; 4] = ["text/x-gcode", "text/x.gcode", "application/x-gcode", "text/plain"];

/// A representation asked for in the query, for links and for callers that cannot set headers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Format {
    Json,
    Gcode,
}

/// What a toolpath is sent as.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Representation {
    Json,
    /// NC text, under the media type by which it was asked for.
    Gcode(&'static str),
}

impl Representation {
    /// Chooses by `format`, else by `Accept` (RFC 9110, section 12.5.1); JSON where the caller does not care.
    ///
    /// # Errors
    /// `not_acceptable` with the types on offer.
    pub fn choose(headers: &HeaderMap, format: Option<Format>) -> Result<Self, ApiError> {
        match format {
            Some(Format::Json) => return Ok(Self::Json),
            Some(Format::Gcode) => return Ok(Self::Gcode(GCODE[0])),
            None => {}
        }
        let offers: Vec<&'static str> = std::iter::once(JSON).chain(GCODE).collect();
        match accept::best(headers, &offers) {
            Some(JSON) => Ok(Self::Json),
            Some(gcode) => Ok(Self::Gcode(gcode)),
            None => {
                let detail = format!("on offer are {}", offers.join(", "));
                Err(ApiError::new(Code::NotAcceptable, detail).offering(offers))
            }
        }
    }
}

/// A finished body, ready to be sent.
#[derive(Debug, Clone)]
pub struct Encoded {
    content_type: HeaderValue,
    disposition: Option<HeaderValue>,
    body: Bytes,
}

impl Encoded {
    /// # Errors
    /// When the value cannot be written as JSON, which is a fault of this program.
    pub fn json(value: &impl Serialize) -> Result<Self, ApiError> {
        let body = serde_json::to_vec(value)
            .map_err(|error| ApiError::new(Code::InternalError, format!("writing JSON: {error}")))?;
        Ok(Self { content_type: HeaderValue::from_static(JSON), disposition: None, body: body.into() })
    }

    /// NC text under `media_type`, to be saved as `file_name`.
    pub fn gcode(text: String, media_type: &'static str, file_name: &str) -> Self {
        let content_type = HeaderValue::from_str(&format!("{media_type}; charset=us-ascii"));
        let disposition = HeaderValue::from_str(&format!("attachment; filename=\"{file_name}\""));
        Self {
            content_type: content_type.unwrap_or(HeaderValue::from_static(GCODE[0])),
            disposition: disposition.ok(),
            body: text.into(),
        }
    }
}

impl IntoResponse for Encoded {
    fn into_response(self) -> Response {
        let mut response = self.body.into_response();
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, self.content_type);
        if let Some(disposition) = self.disposition {
            headers.insert(header::CONTENT_DISPOSITION, disposition);
        }
        response
    }
}

/// A file name made of the program's own name or else its number.
pub fn file_name(name: Option<&str>, number: u32, extension: &str) -> String {
    /// A name longer than this is cut: file systems allow 255 bytes.
    const MAX_LENGTH: usize = 100;
    let is_plain = |c: &char| c.is_ascii_alphanumeric() || "._-".contains(*c);
    let cleaned: String = name.unwrap_or_default().chars().filter(is_plain).take(MAX_LENGTH).collect();
    // A leading dot would hide the file.
    match cleaned.trim_start_matches('.') {
        "" => format!("program-{number}.{extension}"),
        stem => format!("{stem}.{extension}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_query_overrides_the_header() {
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, HeaderValue::from_static("image/png"));
        assert_eq!(Representation::choose(&headers, Some(Format::Json)), Ok(Representation::Json));
        let error = Representation::choose(&headers, None).expect_err("not on offer");
        assert_eq!(error.code(), Code::NotAcceptable);
        headers.insert(header::ACCEPT, HeaderValue::from_static("text/plain, */*;q=0.1"));
        assert_eq!(Representation::choose(&headers, None), Ok(Representation::Gcode("text/plain")));
    }

    #[test]
    fn file_names_hold_nothing_that_ends_a_header() {
        assert_eq!(file_name(Some("../die \"7\"\r\n.x"), 3, "ngc"), "die7.x.ngc");
        assert_eq!(file_name(Some("\u{fc}"), 3, "ngc"), "program-3.ngc");
        assert_eq!(file_name(None, 501, "nc"), "program-501.nc");
    }
}
