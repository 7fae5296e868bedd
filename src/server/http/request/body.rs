//! Reads the body of a request. A body of JSON is decoded into a job later, on the thread that computes.

use std::future::poll_fn;
use std::pin::Pin;
use std::sync::Arc;
use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{FromRef, FromRequest, Request};
use axum::http::{HeaderMap, header};
use tokio::time::timeout;

use super::coding::{Coding, gunzip};
use super::multipart::{self, FORM_DATA, Parts};
use super::representation::GCODE;
use crate::config::{Limits, Settings};
use crate::http::byte_limit::HeldBytes;
use crate::http::compute::room::Room;
use crate::http::decode::files::Places;
use crate::http::decode::{self, IntoJob, SentJob};
use crate::http::error::{ApiError, Code};
use toolpathd_core::budget::Budget;

/// First size of the buffer of a body. A full buffer doubles. So the buffer follows the bytes that arrive,
/// not the `Content-Length` that the caller announces.
const FIRST_BYTES: usize = 16 * 1024;

/// Most bytes of a body that is decoded before its job has a worker, to see whether the job is small.
/// Decoding as many bytes takes some milliseconds. A job that needs more data is seldom small.
const SHORT_BYTES: usize = 256 * 1024;

/// Bytes that the decoding of a body takes at most for each byte of the body: the request itself, the room
/// into which its lists grow, and, where members are `null`, the body written again. The dearest bodies are
/// grids of rows of one point.
const BYTES_FOR_EACH: usize = 8;

/// Bytes that the body as a tree of values takes at most besides, for each of its bytes. The dearest bodies
/// are lists of lists of one digit: four bytes of text take 32 bytes for the list, 128 for its first room,
/// and while the outer list grows another 64. The text that is written of the tree is no longer than the
/// body.
const BYTES_OF_TREE: usize = 64;

/// Most bytes that come out of one byte of gzip (RFC 1951: 258 bytes for two bits).
const GZIP_EXPANSION: usize = 1032;

/// A body that was read, with its content coding.
pub struct SentBody {
    bytes: Bytes,
    coding: Coding,
    held: HeldBytes,
    limit: usize,
}

impl SentBody {
    async fn read(request: Request, limits: BodyLimits) -> Result<Self, ApiError> {
        let coding = Coding::of(request.headers())?;
        let held = HeldBytes::of(&request)?;
        let bytes = limits.read(request.into_body(), &held).await?;
        Ok(Self { bytes, coding, held, limit: limits.bytes })
    }

    /// The most bytes that the body may have without its content coding.
    fn most_bytes(&self) -> usize {
        match self.coding {
            Coding::Identity => self.bytes.len(),
            Coding::Gzip => self.bytes.len().saturating_mul(GZIP_EXPANSION).min(self.limit),
        }
    }

    /// The body without its content coding. Belongs on a thread that computes, because it takes time.
    ///
    /// # Errors
    /// `bad_request` and `payload_too_large` from [`gunzip`]; `overloaded` when there is no memory for it.
    pub fn decoded(&self) -> Result<Decoded, ApiError> {
        let (bytes, held) = match self.coding {
            Coding::Identity => (self.bytes.clone(), None),
            Coding::Gzip => {
                let bytes = gunzip(&self.bytes, self.limit)?;
                let held = self.held.sibling();
                held.take(bytes.len())?;
                (bytes.into(), Some(held))
            }
        };
        Ok(Decoded { bytes, _held: held })
    }
}

/// A body without a content coding.
pub struct Decoded {
    pub bytes: Bytes,
    /// The memory of bytes that came out of gzip.
    _held: Option<HeldBytes>,
}

/// The body of a job in JSON, not decoded yet.
pub struct JobBody<T: IntoJob> {
    body: SentBody,
    bytes_for_each: usize,
    has_parts: bool,
    make: Arc<Make<T>>,
}

/// Makes a job from the bytes of a body.
type Make<T> =
    dyn Fn(&Bytes, &Limits, &Budget) -> Result<SentJob<<T as IntoJob>::Job>, ApiError> + Send + Sync;

impl<T: IntoJob> JobBody<T> {
    /// Whether the body has at most [`SHORT_BYTES`] as it was sent, and no files: reading a file may take
    /// long.
    pub fn may_be_short(&self) -> bool {
        self.body.bytes.len() <= SHORT_BYTES && !self.has_parts
    }

    /// As [`Self::job`], where the body has at most [`SHORT_BYTES`] without its content coding; `None` for a
    /// longer body, and for one that may hold a file.
    pub fn short_job(&self, limits: &Limits, budget: &Budget) -> Option<Result<SentJob<T::Job>, ApiError>> {
        let text = match self.body.coding {
            Coding::Identity => self.body.bytes.clone(),
            // A body beyond the limit of bodies is refused by [`Self::job`].
            Coding::Gzip => gunzip(&self.body.bytes, SHORT_BYTES.min(self.body.limit)).ok()?.into(),
        };
        let is_short = text.len() <= SHORT_BYTES && !may_hold_file(&text);
        is_short.then(|| (self.make)(&text, limits, budget))
    }

    /// Decodes the body as a `T` and checks it, when there is enough of `room`. Belongs on a thread that
    /// computes, because it takes time.
    ///
    /// # Errors
    /// `malformed_json` or `invalid_request`; for a body in gzip also `bad_request`, `payload_too_large` and
    /// `overloaded`; the reason when `budget` ends.
    pub fn job(
        &self,
        limits: &Limits,
        room: &Arc<Room>,
        budget: &Budget,
    ) -> Result<SentJob<T::Job>, ApiError> {
        let _share = room.take(self.body.most_bytes().saturating_mul(self.bytes_for_each), budget)?;
        (self.make)(&self.body.decoded()?.bytes, limits, budget)
    }

    /// A body of NC text, from which `make` makes the job.
    ///
    /// # Errors
    /// `unsupported_coding`, and the failures of reading.
    pub async fn of_text(
        request: Request,
        limits: BodyLimits,
        make: impl Fn(&[u8], &Limits) -> Result<T::Job, ApiError> + Send + Sync + 'static,
    ) -> Result<Self, ApiError> {
        let make = move |text: &Bytes, limits: &_, _: &_| {
            Ok(SentJob { job: make(text, limits)?, remarks: Vec::new(), places: Places::default() })
        };
        let body = SentBody::read(request, limits).await?;
        Ok(Self { body, bytes_for_each: BYTES_FOR_EACH, has_parts: false, make: Arc::new(make) })
    }

    /// Whether the body has parts: a job and files.
    pub fn has_parts(&self) -> bool {
        self.has_parts
    }

    /// The same body, whose job goes through `change`.
    pub fn then(self, change: impl Fn(T::Job) -> T::Job + Send + Sync + 'static) -> Self {
        let Self { body, bytes_for_each, has_parts, make } = self;
        let make = move |bytes: &Bytes, limits: &_, budget: &_| {
            let SentJob { job, remarks, places } = make(bytes, limits, budget)?;
            Ok(SentJob { job: change(job), remarks, places })
        };
        Self { body, bytes_for_each, has_parts, make: Arc::new(make) }
    }

    /// The same body, whose job goes through `change` together with the body. `change` may hold the body as
    /// a tree of values.
    pub fn with_body(
        self,
        change: impl Fn(T::Job, &[u8]) -> Result<T::Job, ApiError> + Send + Sync + 'static,
    ) -> Self {
        let Self { body, bytes_for_each, has_parts, make } = self;
        let make = move |bytes: &Bytes, limits: &_, budget: &_| {
            let SentJob { job, remarks, places } = make(bytes, limits, budget)?;
            Ok(SentJob { job: change(job, bytes)?, remarks, places })
        };
        Self { body, bytes_for_each: bytes_for_each + BYTES_OF_TREE, has_parts, make: Arc::new(make) }
    }
}

/// Reads a body of NC text. A body without a type counts as NC text, and so does the type that `curl --data`
/// sends unless told otherwise.
///
/// # Errors
/// `unsupported_media_type`, `unsupported_coding`, and the failures of reading.
pub async fn program_body(request: Request, limits: BodyLimits) -> Result<SentBody, ApiError> {
    let media_type = media_type(request.headers());
    let is_text = |name: &str| GCODE.contains(&name) || name == "application/x-www-form-urlencoded";
    if let Some(name) = media_type.filter(|name| !is_text(name)) {
        let detail = format!("`{name}` is not read here; send `{}`", GCODE[0]);
        return Err(ApiError::new(Code::UnsupportedMediaType, detail));
    }
    SentBody::read(request, limits).await
}

impl<T: IntoJob, S: Sync> FromRequest<S> for JobBody<T>
where
    BodyLimits: FromRef<S>,
{
    type Rejection = ApiError;

    async fn from_request(request: Request, state: &S) -> Result<Self, ApiError> {
        let has_parts = is_multipart(request.headers());
        let make = maker::<T>(request.headers())?;
        let body = SentBody::read(request, BodyLimits::from_ref(state)).await?;
        Ok(Self { body, bytes_for_each: BYTES_FOR_EACH, has_parts, make })
    }
}

/// Whether a body of JSON may hold a file in base64: it has the member's name, or an escape with which a name
/// may be written.
fn may_hold_file(text: &[u8]) -> bool {
    let text = std::str::from_utf8(text).unwrap_or_default();
    text.contains("base64") || text.contains("\\u")
}

/// What makes a job from a body with these headers.
///
/// # Errors
/// `unsupported_media_type`; `bad_request` where the parts of a body have no boundary.
fn maker<T: IntoJob>(headers: &HeaderMap) -> Result<Arc<Make<T>>, ApiError> {
    if !is_multipart(headers) {
        check_content_type(headers)?;
        return Ok(Arc::new(|text: &Bytes, limits: &_, budget: &_| decode::job::<T>(text, limits, budget)));
    }
    let boundary = multipart::boundary(headers)?;
    Ok(Arc::new(move |body: &Bytes, limits: &_, budget: &_| {
        let Parts { job, files } = multipart::parts(body.clone(), &boundary)?;
        let job =
            job.or(T::JOB_OF_FILES.map(|text| Bytes::from_static(text.as_bytes()))).ok_or_else(|| {
                let detail = "the body has no part `job`: send the job in JSON, as `-F job=@job.json`";
                ApiError::new(Code::BadRequest, detail)
            })?;
        decode::job_with_files::<T>(&job, &files, limits, budget)
    }))
}

/// Whether a body with these headers has parts.
fn is_multipart(headers: &HeaderMap) -> bool {
    media_type(headers).is_some_and(|name| name == FORM_DATA)
}

/// The media type of the body, without parameters, in lower case.
pub fn media_type(headers: &HeaderMap) -> Option<String> {
    let value = headers.get(header::CONTENT_TYPE)?;
    let essence = value.to_str().unwrap_or_default().split(';').next().unwrap_or_default().trim();
    Some(essence.to_ascii_lowercase())
}

/// Checks that the body is JSON by its media type: `application/json`, any `application/...+json`, or no
/// type. `application/x-www-form-urlencoded` counts as JSON too, because `curl -d` sends it unless told
/// otherwise.
fn check_content_type(headers: &HeaderMap) -> Result<(), ApiError> {
    let Some(essence) = media_type(headers) else { return Ok(()) };
    let is_json = essence == "application/json"
        || (essence.starts_with("application/") && essence.ends_with("+json"))
        || essence == "application/x-www-form-urlencoded";
    if !is_json {
        let detail =
            format!("`{essence}` is not read here; send `application/json`, or `{FORM_DATA}` for files");
        return Err(ApiError::new(Code::UnsupportedMediaType, detail));
    }
    Ok(())
}

/// The limits of a body that is read.
#[derive(Debug, Clone, Copy)]
pub struct BodyLimits {
    /// Most bytes.
    pub bytes: usize,
    /// Longest pause within the body.
    pub timeout: Duration,
    /// Longest time in which the whole body arrives.
    pub deadline: Duration,
}

impl BodyLimits {
    pub fn new(settings: &Settings) -> Self {
        Self {
            bytes: settings.body_limit,
            timeout: settings.body_timeout_s,
            deadline: settings.body_deadline_s,
        }
    }

    /// Reads the whole body. Refuses a body that is too large, that stops arriving, or that takes too long in
    /// all.
    async fn read(self, body: Body, held: &HeldBytes) -> Result<Bytes, ApiError> {
        timeout(self.deadline, self.read_all(body, held)).await.map_err(|_| {
            let seconds = self.deadline.as_secs_f64();
            ApiError::new(Code::RequestTimeout, format!("the body did not arrive within {seconds} s"))
        })?
    }

    async fn read_all(self, mut body: Body, held: &HeldBytes) -> Result<Bytes, ApiError> {
        let limit = self.bytes;
        let too_large = |size: u64| {
            let detail = format!("the body has at least {size} bytes; at most {limit} are allowed");
            ApiError::new(Code::PayloadTooLarge, detail)
        };
        let announced = body.size_hint().lower();
        if announced > limit as u64 {
            return Err(too_large(announced));
        }
        // More than the announced bytes never arrive.
        let most = body.size_hint().upper().and_then(|bytes| usize::try_from(bytes).ok()).unwrap_or(limit);
        let mut bytes = Vec::new();
        while let Some(data) = self.next_bytes(&mut body).await? {
            let needed = bytes.len() + data.len();
            if needed > limit {
                return Err(too_large(needed as u64));
            }
            if needed > bytes.capacity() {
                let capacity = (2 * bytes.capacity()).max(FIRST_BYTES).min(most).max(needed);
                held.take(capacity - bytes.capacity())?;
                bytes.reserve_exact(capacity - bytes.len());
            }
            bytes.extend_from_slice(&data);
        }
        Ok(bytes.into())
    }

    /// The next bytes of the body, at least one. `None` at the end of the body.
    ///
    /// # Errors
    /// `request_timeout` when no byte arrives within the body timeout; `bad_request` when the body cannot be
    /// read.
    pub async fn next_bytes(self, body: &mut Body) -> Result<Option<Bytes>, ApiError> {
        let next = timeout(self.timeout, next_data(body)).await.map_err(|_| {
            let seconds = self.timeout.as_secs_f64();
            ApiError::new(Code::RequestTimeout, format!("no byte of the body arrived for {seconds} s"))
        })?;
        next.transpose().map_err(|_| ApiError::new(Code::BadRequest, "the body could not be read"))
    }
}

async fn next_data(body: &mut Body) -> Option<Result<Bytes, axum::Error>> {
    loop {
        match poll_fn(|context| Pin::new(&mut *body).poll_frame(context)).await? {
            Ok(frame) => match frame.into_data() {
                Ok(data) if !data.is_empty() => return Some(Ok(data)),
                // Trailers and the empty frames of HTTP/2 bring no bytes, so the time limit still runs.
                _ => {}
            },
            Err(error) => return Some(Err(error)),
        }
    }
}
