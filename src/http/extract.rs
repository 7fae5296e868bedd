//! Reads the body of a request, and decodes it into a job where it is JSON.

use std::future::poll_fn;
use std::pin::Pin;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes, HttpBody};
use axum::extract::{FromRequest, Request};
use axum::http::{HeaderMap, header};
use tokio::time::timeout;

use super::App;
use super::admission::Share;
use super::compression::{Coding, gunzip};
use super::decode::{self, IntoJob};
use super::error::{ApiError, Code};
use super::output::GCODE;

/// A body with more bytes is decoded on a thread of its own, so that it does not delay other connections. So
/// is every body in gzip, because its decoded size is not known beforehand.
const DECODE_ASIDE_BYTES: usize = 64 * 1024;

/// The job of a body: JSON that was decoded as a `T` and checked.
pub struct JobBody<T: IntoJob> {
    pub job: T::Job,
    /// Time of decoding and converting.
    pub parsing: Duration,
}

/// Reads a body of NC text. A body without a type counts as NC text, and so does the type that `curl --data`
/// sends unless told otherwise.
///
/// # Errors
/// `unsupported_media_type`, `unsupported_coding`, and the failures of reading.
pub async fn program_body(request: Request, app: &App) -> Result<Bytes, ApiError> {
    let media_type = media_type(request.headers());
    let is_text = |name: &str| GCODE.contains(&name) || name == "application/x-www-form-urlencoded";
    if let Some(name) = media_type.filter(|name| !is_text(name)) {
        let detail = format!("`{name}` is not read here; send `{}`", GCODE[0]);
        return Err(ApiError::new(Code::UnsupportedMediaType, detail));
    }
    let coding = Coding::of(request.headers())?;
    let share = Share::of(&request)?;
    let bytes = read(request.into_body(), &share, app).await?;
    let limit = app.limits.body_bytes;
    match coding {
        Coding::Identity => Ok(bytes),
        Coding::Gzip => {
            let bytes = aside(app, move || gunzip(&bytes, limit)).await?;
            share.take(bytes.len())?;
            Ok(bytes.into())
        }
    }
}

impl<T: IntoJob> FromRequest<Arc<App>> for JobBody<T> {
    type Rejection = ApiError;

    async fn from_request(request: Request, app: &Arc<App>) -> Result<Self, ApiError> {
        check_content_type(request.headers())?;
        let coding = Coding::of(request.headers())?;
        let share = Share::of(&request)?;
        let bytes = read(request.into_body(), &share, app).await?;
        let limits = app.limits;
        let is_small = coding == Coding::Identity && bytes.len() <= DECODE_ASIDE_BYTES;
        let convert = move || {
            let begun = Instant::now();
            let bytes = match coding {
                Coding::Identity => bytes,
                Coding::Gzip => {
                    let bytes = gunzip(&bytes, limits.body_bytes)?;
                    share.take(bytes.len())?;
                    bytes.into()
                }
            };
            let job = decode::job::<T>(&bytes, &limits)?;
            Ok(Self { job, parsing: begun.elapsed() })
        };
        if is_small { convert() } else { aside(app, convert).await }
    }
}

/// Runs `work` on a blocking thread, so that it does not delay other connections. At most one `work` for each
/// worker runs at a time. A caller that goes away while it waits gives up its turn.
pub async fn aside<T: Send + 'static>(
    app: &App,
    work: impl FnOnce() -> Result<T, ApiError> + Send + 'static,
) -> Result<T, ApiError> {
    let failed = |_| ApiError::new(Code::InternalError, "decoding the body failed");
    let turn = Arc::clone(&app.decoders).acquire_owned().await.map_err(|_| failed(()))?;
    let work = move || {
        let done = work();
        drop(turn);
        done
    };
    tokio::task::spawn_blocking(work).await.map_err(|_| failed(()))?
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
        let detail = format!("`{essence}` is not read here; send `application/json`");
        return Err(ApiError::new(Code::UnsupportedMediaType, detail));
    }
    Ok(())
}

/// Reads the whole body. Refuses a body that is too large or that stops arriving.
async fn read(mut body: Body, share: &Share, app: &App) -> Result<Bytes, ApiError> {
    let limit = app.limits.body_bytes;
    let too_large = |size: u64| {
        let detail = format!("the body has at least {size} bytes; at most {limit} are allowed");
        ApiError::new(Code::PayloadTooLarge, detail)
    };
    let announced = body.size_hint().lower();
    if announced > limit as u64 {
        return Err(too_large(announced));
    }
    let mut bytes = Vec::with_capacity(usize::try_from(announced).unwrap_or_default());
    while let Some(data) = next_bytes(&mut body, app).await? {
        if bytes.len() + data.len() > limit {
            return Err(too_large((bytes.len() + data.len()) as u64));
        }
        share.take(data.len())?;
        bytes.extend_from_slice(&data);
    }
    Ok(bytes.into())
}

/// The next bytes of the body, at least one. `None` at the end of the body.
///
/// # Errors
/// `request_timeout` when no byte arrives within the body timeout; `bad_request` when the body cannot be
/// read.
pub async fn next_bytes(body: &mut Body, app: &App) -> Result<Option<Bytes>, ApiError> {
    let next = timeout(app.body_timeout, next_data(body)).await.map_err(|_| {
        let seconds = app.body_timeout.as_secs_f64();
        ApiError::new(Code::RequestTimeout, format!("no byte of the body arrived for {seconds} s"))
    })?;
    next.transpose().map_err(|_| ApiError::new(Code::BadRequest, "the body could not be read"))
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
