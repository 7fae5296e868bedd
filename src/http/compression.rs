//! Bodies in gzip, both ways (RFC 9110, section 8.4.1.3).

use std::io::{Read, Write};

use axum::http::{Extensions, HeaderMap, HeaderName, StatusCode, Version, header};
use flate2::Compression;
use flate2::read::MultiGzDecoder;
use flate2::write::GzEncoder;
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::{NotForContentType, Predicate, SizeAbove};

use super::error::{ApiError, Code};

/// The digest of an answer's bytes. The bytes of an answer with a digest are final.
pub const REPR_DIGEST: HeaderName = HeaderName::from_static("repr-digest");

pub const GZIP: &str = "gzip";

/// A smaller body fits a packet as it is.
pub const MIN_CODED_BYTES: u64 = 1024;

/// What was done to a request's body before it was sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coding {
    Identity,
    Gzip,
}

impl Coding {
    /// Of the body that comes with `headers`.
    ///
    /// # Errors
    /// `unsupported_coding` for any other, and for several.
    pub fn of(headers: &HeaderMap) -> Result<Self, ApiError> {
        let mut named = headers.get_all(header::CONTENT_ENCODING).iter();
        let coding = named.next().map(|value| value.as_bytes().to_ascii_lowercase());
        match (coding.as_deref(), named.next()) {
            (None | Some(b"identity"), None) => Ok(Self::Identity),
            (Some(b"gzip" | b"x-gzip"), None) => Ok(Self::Gzip),
            _ => {
                let detail = "this content coding is unknown: send the body as it is, or in `gzip` once";
                Err(ApiError::new(Code::UnsupportedCoding, detail))
            }
        }
    }
}

/// Gzip for every answer but those that were computed: they are coded on the pool, before their digest is
/// taken.
pub fn layer() -> CompressionLayer<impl Predicate> {
    let has_no_digest =
        |_: StatusCode, _: Version, headers: &HeaderMap, _: &Extensions| !headers.contains_key(REPR_DIGEST);
    let is_worth_it = SizeAbove::new(MIN_CODED_BYTES).and(NotForContentType::SSE);
    CompressionLayer::new().compress_when(is_worth_it.and(has_no_digest))
}

/// The same bytes for the same body.
pub fn gzip(body: &[u8]) -> std::io::Result<Vec<u8>> {
    // Toolpaths shrink to a third or less at any level, and time on the pool is dearer than bytes.
    let mut encoder = GzEncoder::new(Vec::with_capacity(body.len() / 4), Compression::fast());
    encoder.write_all(body)?;
    encoder.finish()
}

/// What was coded, of which at most `limit` bytes are ever held.
///
/// # Errors
/// `payload_too_large`; `bad_request` for what is no gzip or not the whole of it.
pub fn gunzip(body: &[u8], limit: usize) -> Result<Vec<u8>, ApiError> {
    let mut decoded = Vec::new();
    let read = MultiGzDecoder::new(body).take(limit as u64 + 1).read_to_end(&mut decoded);
    if decoded.len() > limit {
        let detail =
            format!("the body has more than {limit} bytes after gzip is undone: send a smaller body");
        return Err(ApiError::new(Code::PayloadTooLarge, detail));
    }
    match read {
        Ok(_) => Ok(decoded),
        Err(error) => {
            let detail = format!("the body is not gzip, or its end is missing: {error}");
            Err(ApiError::new(Code::BadRequest, detail))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_coded_is_read_within_the_limit() {
        let text = "x".repeat(100_000);
        let coded = gzip(text.as_bytes()).expect("memory");
        assert!(coded.len() < 1000);
        assert_eq!(gunzip(&coded, 100_000).expect("whole"), text.as_bytes());
        assert_eq!(gunzip(&coded, 99_999).expect_err("too large").code(), Code::PayloadTooLarge);
        let twice = [coded.as_slice(), &coded].concat();
        assert_eq!(gunzip(&twice, 200_000).expect("whole").len(), 200_000);
    }

    #[test]
    fn what_is_not_whole_is_refused_wherever_it_ends() {
        let coded = gzip(b"{\"tolerance_mm\": 0.01}").expect("memory");
        for end in 0..coded.len() {
            let error = gunzip(&coded[..end], 1000).expect_err("not whole");
            assert_eq!(error.code(), Code::BadRequest, "{end}");
        }
        let mut broken = coded.clone();
        broken[coded.len() - 6] ^= 1;
        assert_eq!(gunzip(&broken, 1000).expect_err("another sum").code(), Code::BadRequest);
        let trailing = [coded.as_slice(), b"more"].concat();
        assert_eq!(gunzip(&trailing, 1000).expect_err("more").code(), Code::BadRequest);
    }

    #[test]
    fn one_coding_is_known() {
        let of = |lines: &[&str]| {
            let mut headers = HeaderMap::new();
            for line in lines {
                headers.append(header::CONTENT_ENCODING, line.parse().expect("a header"));
            }
            Coding::of(&headers).map_err(|error| error.code())
        };
        for (lines, expected) in [
            (&[][..], Ok(Coding::Identity)),
            (&["identity"], Ok(Coding::Identity)),
            (&["GZIP"], Ok(Coding::Gzip)),
            (&["br"], Err(Code::UnsupportedCoding)),
            (&["gzip, gzip"], Err(Code::UnsupportedCoding)),
            (&["gzip", "gzip"], Err(Code::UnsupportedCoding)),
        ] {
            assert_eq!(of(lines), expected, "{lines:?}");
        }
    }
}
