//! Finished bodies of answers with their headers.

use std::sync::Arc;

use axum::body::Bytes;
use axum::http::{HeaderName, HeaderValue, header};
use axum::response::{IntoResponse, Response};
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use serde::Serialize;
use sha2::{Digest, Sha256};

use super::compression::{self, MIN_CODED_BYTES, REPR_DIGEST};
use crate::http::byte_limit::{ByteLimit, HeldBytes};
use crate::http::error::{ApiError, Code};
use crate::http::request::coding::GZIP;
use crate::http::request::representation::{GCODE, JSON};
use crate::http::request::retry::JOB_ORDER_ID;
use toolpathd_post::Dialect;

/// The header with the codes of all warnings of an answer.
pub const WARNINGS: HeaderName = HeaderName::from_static("toolpathd-warnings");

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
    held: Option<HeldBytes>,
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

    /// A binary file.
    pub fn binary(bytes: Vec<u8>, media_type: &'static str) -> Self {
        Self::plain(HeaderValue::from_static(media_type), bytes.into())
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
            held: None,
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

    /// The body counted in the memory for answers until it is sent.
    ///
    /// # Errors
    /// `overloaded` when too many bytes of answers wait for their callers.
    pub fn held_in(mut self, memory: &Arc<ByteLimit>) -> Result<Self, ApiError> {
        let held = memory.hold();
        held.take(self.body.len())?;
        self.held = Some(held);
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

    /// The bytes of the body, with what they hold of the memory for answers.
    pub fn into_parts(self) -> (Bytes, Option<HeldBytes>) {
        (self.body, self.held)
    }
}

impl IntoResponse for Encoded {
    fn into_response(self) -> Response {
        let mut response = self.body.into_response();
        if let Some(held) = self.held {
            response.extensions_mut().insert(held);
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

/// The name of the program's file: from the program's name, else from its number. A control that knows a
/// program by the name in its text wants that name for the file.
pub fn file_name(name: Option<&str>, number: u32, dialect: &Dialect) -> String {
    /// Most characters that are kept of a name. File systems allow 255 bytes.
    const MAX_LENGTH: usize = 100;
    let extension = dialect.file_extension;
    if dialect.names_files_in_their_text() {
        return format!("{number}.{extension}");
    }
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
    use toolpathd_post::dialect;

    #[test]
    fn a_file_name_holds_no_character_that_ends_a_header() {
        let linuxcnc = dialect("linuxcnc").expect("a dialect");
        assert_eq!(file_name(Some("../die \"7\"\r\n.x"), 3, linuxcnc), "die7.x.ngc");
        assert_eq!(file_name(Some("\u{200b}"), 3, linuxcnc), "program-3.ngc");
        assert_eq!(file_name(Some("M\u{fc}ller"), 3, linuxcnc), "Muller.ngc");
        assert_eq!(file_name(None, 501, dialect("fanuc").expect("a dialect")), "program-501.nc");
    }

    #[test]
    fn a_program_of_klartext_has_the_name_that_stands_in_its_text() {
        assert_eq!(file_name(Some("die"), 501, dialect("heidenhain").expect("a dialect")), "501.h");
    }
}
