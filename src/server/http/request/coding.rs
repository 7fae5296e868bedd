//! The content coding of a request's body: none, or gzip (RFC 9110, section 8.4.1.3).

use std::io::Read;

use axum::http::{HeaderMap, header};
use flate2::read::MultiGzDecoder;

use crate::http::error::{ApiError, Code};

pub const GZIP: &str = "gzip";

/// The content coding of a request's body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coding {
    Identity,
    Gzip,
}

impl Coding {
    /// The coding that `headers` name.
    ///
    /// # Errors
    /// `unsupported_coding` for any other coding, and for several codings.
    pub fn of(headers: &HeaderMap) -> Result<Self, ApiError> {
        let mut named = headers.get_all(header::CONTENT_ENCODING).iter();
        let coding = named.next().map(|value| value.as_bytes().to_ascii_lowercase());
        match (coding.as_deref(), named.next()) {
            (None | Some(b"identity"), None) => Ok(Self::Identity),
            (Some(b"gzip" | b"x-gzip"), None) => Ok(Self::Gzip),
            _ => {
                let detail = "this `content-encoding` is unknown: send the body uncompressed, or compressed a single time with `gzip`";
                Err(ApiError::new(Code::UnsupportedCoding, detail))
            }
        }
    }
}

/// Decompresses `body`. Never holds more than `limit` + 1 decoded bytes.
///
/// # Errors
/// `payload_too_large` when more than `limit` bytes come out; `bad_request` when `body` is not gzip or its
/// end is missing.
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
    use std::io::Write;

    use flate2::Compression;
    use flate2::write::GzEncoder;

    use super::*;

    fn gzip(body: &[u8]) -> std::io::Result<Vec<u8>> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
        encoder.write_all(body)?;
        encoder.finish()
    }

    #[test]
    fn gzip_round_trips_up_to_the_limit() {
        let text = "x".repeat(100_000);
        let coded = gzip(text.as_bytes()).expect("memory");
        assert!(coded.len() < 1000);
        assert_eq!(gunzip(&coded, 100_000).expect("whole"), text.as_bytes());
        assert_eq!(gunzip(&coded, 99_999).expect_err("too large").code(), Code::PayloadTooLarge);
        let twice = [coded.as_slice(), &coded].concat();
        assert_eq!(gunzip(&twice, 200_000).expect("whole").len(), 200_000);
    }

    #[test]
    fn an_incomplete_or_corrupt_gzip_body_is_refused() {
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
    fn gzip_is_the_only_coding_that_is_read() {
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
