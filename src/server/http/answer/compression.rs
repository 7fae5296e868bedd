//! Gzip for bodies of answers (RFC 9110, section 8.4.1.3).

use std::io::Write;

use axum::http::{Extensions, HeaderMap, HeaderName, StatusCode, Version};
use flate2::Compression;
use flate2::write::GzEncoder;
use tower_http::compression::CompressionLayer;
use tower_http::compression::predicate::Predicate;

use super::streamed::Streamed;

/// The digest of an answer's bytes. The bytes of an answer with a digest are final.
pub const REPR_DIGEST: HeaderName = HeaderName::from_static("repr-digest");

/// Smallest body that is compressed. A smaller body fits a packet as it is.
pub const MIN_CODED_BYTES: usize = 1024;

/// Compresses programs that are streamed, while they are sent. Every other answer is compressed as a whole,
/// before its digest is taken, or not at all.
pub fn layer() -> CompressionLayer<impl Predicate> {
    let is_streamed = |_: StatusCode, _: Version, _: &HeaderMap, extensions: &Extensions| {
        extensions.get::<Streamed>().is_some()
    };
    CompressionLayer::new().compress_when(is_streamed)
}

/// Compresses the body of an answer. The same body always gives the same bytes.
pub fn gzip(body: &[u8]) -> std::io::Result<Vec<u8>> {
    // Toolpaths shrink to a third or less at any level, and time on the pool costs more than bytes.
    compressed(body, Compression::fast())
}

/// Compresses, as far as possible, what is compressed once and sent often.
pub fn gzip_once(body: &[u8]) -> std::io::Result<Vec<u8>> {
    compressed(body, Compression::best())
}

fn compressed(body: &[u8], level: Compression) -> std::io::Result<Vec<u8>> {
    let mut encoder = GzEncoder::new(Vec::with_capacity(body.len() / 4), level);
    encoder.write_all(body)?;
    encoder.finish()
}
