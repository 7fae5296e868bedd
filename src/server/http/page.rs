//! The page at `/`, on which people fill in requests and look at answers, with the files that it loads.
//! The binary contains all of them.

mod contract;
mod script;

use std::collections::BTreeMap;
use std::sync::LazyLock;

use axum::Router;
use axum::body::Bytes;
use axum::extract::Path;
use axum::http::{HeaderMap, HeaderValue, StatusCode, header};
use axum::response::{IntoResponse, Response};
use axum::routing::get;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;
use rust_embed::Embed;
use sha2::{Digest, Sha256};

use crate::http::answer::compression;
use crate::http::error::{ApiError, Code};
use crate::http::openapi;
use crate::http::request::accept::takes_gzip;
use crate::http::request::representation::JSON;

/// The page loads files from this origin only, and shows pictures that its scripts make.
const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; \
    connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

const INDEX: &str = "index.html";
const ICON: &str = "icon.svg";
/// The contract as the page needs it.
const CONTRACT: &str = "contract.json";

#[derive(Embed)]
#[folder = "page"]
#[exclude = "tests/*"]
struct Files;

/// A file of the page.
struct File {
    media_type: &'static str,
    tag: HeaderValue,
    plain: Bytes,
    coded: Bytes,
}

/// All files by their paths. Browsers ask each time whether a file has changed, so that a page never mixes
/// files of two versions of the service.
static FILES: LazyLock<BTreeMap<String, File>> = LazyLock::new(|| {
    let embedded = Files::iter().filter_map(|name| Some((name.to_string(), File::named(&name)?)));
    let contract = openapi::document();
    let contract = File::new(JSON, contract::reduced(&contract).to_string().into_bytes());
    embedded.chain(contract.map(|file| (CONTRACT.to_owned(), file))).collect()
});

impl File {
    fn named(name: &str) -> Option<Self> {
        let data = Files::get(name)?.data;
        let (media_type, data) = match name.rsplit_once('.').map(|(_, ending)| ending) {
            Some("html") => ("text/html; charset=utf-8", data.into_owned()),
            Some("js") => (
                "text/javascript; charset=utf-8",
                script::uncommented(str::from_utf8(&data).ok()?).into_bytes(),
            ),
            Some("css") => ("text/css; charset=utf-8", data.into_owned()),
            Some("svg") => ("image/svg+xml", data.into_owned()),
            _ => ("application/octet-stream", data.into_owned()),
        };
        Self::new(media_type, data)
    }

    fn new(media_type: &'static str, data: Vec<u8>) -> Option<Self> {
        let digest = BASE64_STANDARD.encode(&Sha256::digest(&data)[..12]);
        Some(Self {
            media_type,
            tag: HeaderValue::from_str(&format!("W/\"{digest}\"")).ok()?,
            coded: compression::gzip_once(&data).ok()?.into(),
            plain: data.into(),
        })
    }

    fn answer(&self, headers: &HeaderMap) -> Response {
        let fixed = [
            (header::ETAG, self.tag.clone()),
            (header::CACHE_CONTROL, HeaderValue::from_static("no-cache")),
            (header::VARY, HeaderValue::from_static("Accept-Encoding")),
            (header::CONTENT_SECURITY_POLICY, HeaderValue::from_static(CONTENT_SECURITY_POLICY)),
        ];
        if self.is_known(headers) {
            return (StatusCode::NOT_MODIFIED, fixed).into_response();
        }
        let typed = [(header::CONTENT_TYPE, HeaderValue::from_static(self.media_type))];
        if takes_gzip(headers) {
            let coding = [(header::CONTENT_ENCODING, HeaderValue::from_static("gzip"))];
            return (fixed, typed, coding, self.coded.clone()).into_response();
        }
        (fixed, typed, self.plain.clone()).into_response()
    }

    /// Whether the caller has this version of the file (RFC 9110, section 13.1.2). The tag is weak: it is the
    /// same with and without gzip.
    fn is_known(&self, headers: &HeaderMap) -> bool {
        let known = headers.get_all(header::IF_NONE_MATCH).iter().filter_map(|value| value.to_str().ok());
        let mut tags =
            known.flat_map(|value| value.split(',')).map(|tag| tag.trim().trim_start_matches("W/"));
        let own = self.tag.to_str().unwrap_or_default().trim_start_matches("W/");
        tags.any(|tag| tag == "*" || tag == own)
    }
}

/// The routes of the page and of the files that it loads.
pub fn routes<S: Clone + Send + Sync + 'static>() -> Router<S> {
    Router::new()
        .route("/", get(async |headers: HeaderMap| file(INDEX, &headers)))
        .route("/favicon.ico", get(async |headers: HeaderMap| file(ICON, &headers)))
        .route("/page/examples/{folder}/{name}", get(example))
        .route(
            "/page/{*path}",
            get(async |Path(path): Path<String>, headers: HeaderMap| file(&path, &headers)),
        )
}

fn file(name: &str, headers: &HeaderMap) -> Response {
    match FILES.get(name) {
        Some(file) => file.answer(headers),
        None => ApiError::new(Code::NotFound, format!("the page has no file {name:?}")).into_response(),
    }
}

/// The body of an example.
async fn example(Path((folder, name)): Path<(String, String)>) -> Response {
    match openapi::example(&folder, &name) {
        Some(text) => ([(header::CONTENT_TYPE, JSON)], text).into_response(),
        None => {
            ApiError::new(Code::NotFound, format!("there is no example {folder:?} {name:?}")).into_response()
        }
    }
}
