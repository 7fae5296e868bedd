//! The forms of answers, such as JSON, NC text and pictures, and finished bodies with their headers.

pub mod accept;
pub mod page;

use std::sync::Arc;

use axum::body::Bytes;
use axum::http::{HeaderMap, HeaderName, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::admission::{Pot, Share};
use super::compression::{self, GZIP, MIN_CODED_BYTES, REPR_DIGEST};
use super::error::{ApiError, Code};
use super::retry::JOB_ORDER_ID;

pub const JSON: &str = "application/json";
const SVG: &str = "image/svg+xml";
const HTML: &str = "text/html";
pub const EVENTS: &str = "text/event-stream";

/// The media types that stand for NC text, the preferred type first.
pub const GCODE: [&str; 4] = ["text/x-gcode", "text/x.gcode", "application/x-gcode", "text/plain"];

/// The header with the codes of all warnings of an answer.
pub const WARNINGS: HeaderName = HeaderName::from_static("toolpathd-warnings");

/// The form of an answer. The query parameter `format` takes these names.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Representation {
    Json,
    /// NC text.
    Gcode,
    /// A picture.
    Svg,
    /// The picture with the figures of the answer.
    Html,
    /// Progress while the computation runs, and then the JSON answer. `format` has no name for events,
    /// because a browser cannot show them behind a link.
    Events,
}

impl Representation {
    pub const ALL: [Self; 5] = [Self::Json, Self::Gcode, Self::Svg, Self::Html, Self::Events];

    /// The form that `format` calls `name`.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|form| form.name() == Some(name))
    }

    /// The value of `format`. `None` for events.
    pub fn name(self) -> Option<&'static str> {
        match self {
            Self::Json => Some("json"),
            Self::Gcode => Some("gcode"),
            Self::Svg => Some("svg"),
            Self::Html => Some("html"),
            Self::Events => None,
        }
    }

    /// The media types that stand for the form, the preferred type first.
    pub fn media_types(self) -> &'static [&'static str] {
        match self {
            Self::Json => &[JSON],
            Self::Gcode => &GCODE,
            Self::Svg => &[SVG],
            Self::Html => &[HTML],
            Self::Events => &[EVENTS],
        }
    }
}

/// Chooses one of `offers` by `format`, else by `Accept` (RFC 9110, section 12.5.1), else the first offer.
/// Returns the form and the media type that the caller asked for.
///
/// # Errors
/// `not_acceptable` with the media types on offer.
pub fn choose(
    offers: &[Representation],
    headers: &HeaderMap,
    format: Option<Representation>,
) -> Result<(Representation, &'static str), ApiError> {
    let typed = offers.iter().flat_map(|offer| offer.media_types().iter().map(|name| (*offer, *name)));
    let typed: Vec<_> = typed.collect();
    let names: Vec<_> = typed.iter().map(|(_, name)| *name).collect();
    let chosen = match format {
        Some(format) => typed.iter().find(|(offer, _)| *offer == format),
        None => {
            let best = accept::best(headers, &names);
            typed.iter().find(|(_, name)| Some(*name) == best)
        }
    };
    chosen.copied().ok_or_else(|| {
        ApiError::new(Code::NotAcceptable, format!("accept one of {}", names.join(", "))).offering(names)
    })
}

/// A finished body, ready to be sent.
#[derive(Debug, Clone)]
pub struct Encoded {
    content_type: HeaderValue,
    disposition: Option<HeaderValue>,
    is_gzip: bool,
    digest: Option<HeaderValue>,
    warnings: Option<HeaderValue>,
    job_order: Option<HeaderValue>,
    body: Bytes,
    /// The memory that the body takes until it is sent, where it is counted already.
    share: Option<Share>,
}

impl Encoded {
    /// `value` as JSON.
    ///
    /// # Errors
    /// When the value cannot be written as JSON, which is a fault of this program.
    pub fn json(value: &impl Serialize) -> Result<Self, ApiError> {
        let body = serde_json::to_vec(value)
            .map_err(|error| ApiError::new(Code::InternalError, format!("writing JSON: {error}")))?;
        Ok(Self::plain(HeaderValue::from_static(JSON), body.into()))
    }

    /// Text in UTF-8.
    pub fn text(text: String, media_type: &'static str) -> Self {
        let content_type = HeaderValue::from_str(&format!("{media_type}; charset=utf-8"));
        Self::plain(content_type.unwrap_or(HeaderValue::from_static(media_type)), text.into())
    }

    /// NC text under `media_type`, to be saved as `file_name`.
    pub fn gcode(text: String, media_type: &'static str, file_name: &str) -> Self {
        let content_type = HeaderValue::from_str(&format!("{media_type}; charset=us-ascii"));
        let disposition = HeaderValue::from_str(&format!("attachment; filename=\"{file_name}\""));
        let content_type = content_type.unwrap_or(HeaderValue::from_static(GCODE[0]));
        Self { disposition: disposition.ok(), ..Self::plain(content_type, text.into()) }
    }

    /// Bytes that are an answer already.
    pub fn plain(content_type: HeaderValue, body: Bytes) -> Self {
        Self {
            content_type,
            disposition: None,
            is_gzip: false,
            digest: None,
            warnings: None,
            job_order: None,
            body,
            share: None,
        }
    }

    /// The body as it will be sent: in gzip where `with_gzip` holds and the body is large enough, and with
    /// the digest of the sent bytes (RFC 9530).
    ///
    /// # Errors
    /// When gzip fails, which is a fault of this program.
    pub fn sealed(mut self, with_gzip: bool) -> Result<Self, ApiError> {
        if with_gzip && self.body.len() >= MIN_CODED_BYTES {
            let coded = compression::gzip(&self.body)
                .map_err(|error| ApiError::new(Code::InternalError, format!("writing gzip: {error}")))?;
            self.body = coded.into();
            self.is_gzip = true;
        }
        let digest = BASE64_STANDARD.encode(Sha256::digest(&self.body));
        self.digest = HeaderValue::from_str(&format!("sha-256=:{digest}:")).ok();
        Ok(self)
    }

    /// The body with its share of the memory for answers, which it holds until it is sent.
    ///
    /// # Errors
    /// `overloaded` when too many bytes of answers wait for their callers.
    pub fn held_in(mut self, memory: &Arc<Pot>) -> Result<Self, ApiError> {
        let share = memory.share();
        share.take(self.body.len())?;
        self.share = Some(share);
        Ok(self)
    }

    /// Adds a header with the codes of warnings, for callers that read NC text or a picture. Without codes
    /// there is no header.
    pub fn warning_of(mut self, codes: &str) -> Self {
        self.warnings = HeaderValue::from_str(codes).ok().filter(|codes| !codes.is_empty());
        self
    }

    /// Adds a header with the job order of the caller, if there is one.
    pub fn for_job_order(mut self, job_order: Option<HeaderValue>) -> Self {
        self.job_order = job_order;
        self
    }

    /// The bytes of the body, with their share of the memory for answers.
    pub fn into_parts(self) -> (Bytes, Option<Share>) {
        (self.body, self.share)
    }
}

impl IntoResponse for Encoded {
    fn into_response(self) -> Response {
        let mut response = self.body.into_response();
        if let Some(share) = self.share {
            response.extensions_mut().insert(share);
        }
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, self.content_type);
        if let Some(disposition) = self.disposition {
            headers.insert(header::CONTENT_DISPOSITION, disposition);
        }
        if self.is_gzip {
            headers.insert(header::CONTENT_ENCODING, HeaderValue::from_static(GZIP));
        }
        if let Some(warnings) = self.warnings {
            headers.insert(WARNINGS, warnings);
        }
        if let Some(job_order) = self.job_order {
            headers.insert(JOB_ORDER_ID, job_order);
        }
        if let Some(digest) = self.digest {
            headers.insert(REPR_DIGEST, digest);
        }
        response
    }
}

/// The name of the program's file: from the program's name, else from its number.
pub fn file_name(name: Option<&str>, number: u32, extension: &str) -> String {
    /// Most characters that are kept of a name. File systems allow 255 bytes.
    const MAX_LENGTH: usize = 100;
    let is_plain = |c: &char| c.is_ascii_alphanumeric() || "._-".contains(*c);
    let name = deunicode::deunicode_with_tofu(name.unwrap_or_default(), "");
    let cleaned: String = name.chars().filter(is_plain).take(MAX_LENGTH).collect();
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
        let offers = [Representation::Json, Representation::Gcode];
        let mut headers = HeaderMap::new();
        headers.insert(header::ACCEPT, HeaderValue::from_static("image/svg+xml"));
        let json = (Representation::Json, JSON);
        assert_eq!(choose(&offers, &headers, Some(Representation::Json)), Ok(json));
        for format in [None, Some(Representation::Svg)] {
            let error = choose(&offers, &headers, format).expect_err("not on offer");
            assert_eq!(error.code(), Code::NotAcceptable);
        }
        headers.insert(header::ACCEPT, HeaderValue::from_static("text/plain, */*;q=0.1"));
        assert_eq!(choose(&offers, &headers, None), Ok((Representation::Gcode, "text/plain")));
    }

    #[test]
    fn the_query_names_every_representation_but_events() {
        for (name, form) in [
            ("json", Some(Representation::Json)),
            ("gcode", Some(Representation::Gcode)),
            ("svg", Some(Representation::Svg)),
            ("html", Some(Representation::Html)),
            ("events", None),
        ] {
            assert_eq!(Representation::named(name), form);
        }
    }

    #[test]
    fn a_file_name_holds_no_character_that_ends_a_header() {
        assert_eq!(file_name(Some("../die \"7\"\r\n.x"), 3, "ngc"), "die7.x.ngc");
        assert_eq!(file_name(Some("\u{200b}"), 3, "ngc"), "program-3.ngc");
        assert_eq!(file_name(Some("M\u{fc}ller"), 3, "ngc"), "Muller.ngc");
        assert_eq!(file_name(None, 501, "nc"), "program-501.nc");
    }
}
