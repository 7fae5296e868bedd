//! NC programs that are rewritten while they arrive: larger than memory, and answered before they end.
//!
//! A stream holds one of the places for streams, and a place on the pool only while it has bytes to work on. What is ready is
//! sent through a short queue: a caller that reads slowly slows down its own stream, and nothing is held beyond the queue.
//! As long as nothing has been answered, a failure is a problem; later it ends the connection without the end of the body.

use std::io::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::http::{HeaderValue, header};
use axum::response::{IntoResponse, Response};
use flate2::write::MultiGzDecoder;
use futures_util::stream::unfold;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};
use tokio::time::timeout_at;

use super::App;
use super::coding::Coding;
use super::error::{ApiError, Code};
use super::extract::next_bytes;
use crate::budget::Budget;
use crate::config::Settings;
use crate::post::rewrite::{Figures, RewriteError, Rewriter};

/// Parts of an answer that wait for a caller who does not read: enough for small programs of callers that send all of
/// theirs before they read.
const BACKLOG: usize = 256;

/// Coded bytes that are decoded at a time: what they decode to is at most a thousand times as much.
const DECODED_AT_A_TIME: usize = 4096;

/// What streams may take.
#[derive(Debug)]
pub struct Streams {
    places: Arc<Semaphore>,
    /// Bytes of one program.
    pub bytes: u64,
    pub deadline: Duration,
}

impl Streams {
    pub fn new(settings: &Settings) -> Self {
        Self {
            places: Arc::new(Semaphore::new(usize::from(settings.streams))),
            bytes: settings.stream_bytes,
            deadline: settings.stream_deadline_s,
        }
    }
}

/// A part of the answer.
enum Part {
    Text(Bytes),
    End(Figures),
}

/// A program on its way through the rewriter.
pub struct ProgramStream {
    parts: mpsc::Receiver<Result<Part, ApiError>>,
}

impl ProgramStream {
    /// Begins to rewrite the body of `request`.
    ///
    /// # Errors
    /// `unsupported_coding`; `overloaded` when all places for streams are taken.
    pub fn begin(app: &Arc<App>, request: Request, rewriter: Rewriter) -> Result<Self, ApiError> {
        let coding = Coding::of(request.headers())?;
        let place = Arc::clone(&app.streams.places).try_acquire_owned().map_err(|_| {
            ApiError::new(Code::Overloaded, "every place for streams is taken; try again later")
        })?;
        let (sender, parts) = mpsc::channel(BACKLOG);
        let work = Work { rewriter, decoder: Decoder::of(coding), out: Vec::new(), n_bytes: 0 };
        let app = Arc::clone(app);
        tokio::spawn(async move {
            if let Err(error) = pump(&app, request.into_body(), work, Arc::new(place), &sender).await {
                // Whoever has gone away misses nothing.
                let _ = sender.send(Err(error)).await;
            }
        });
        Ok(Self { parts })
    }

    /// The figures, when all is done; the text is thrown away.
    ///
    /// # Errors
    /// Whatever ended the stream.
    pub async fn figures(mut self) -> Result<Figures, ApiError> {
        while let Some(part) = self.parts.recv().await {
            if let Part::End(figures) = part? {
                return Ok(figures);
            }
        }
        Err(ApiError::new(Code::InternalError, "the stream was given up"))
    }

    /// The text as it becomes ready, under `media_type`, to be saved as `file_name`.
    ///
    /// # Errors
    /// What fails before the first byte is ready.
    pub async fn text(mut self, media_type: &'static str, file_name: &str) -> Result<Response, ApiError> {
        let first = match self.parts.recv().await {
            Some(Ok(Part::Text(text))) => Some(text),
            Some(Ok(Part::End(_))) | None => None,
            Some(Err(error)) => return Err(error),
        };
        let body = unfold((first, self.parts), async |(first, mut parts)| {
            let part = match first {
                Some(text) => Ok(text),
                None => match parts.recv().await? {
                    Ok(Part::Text(text)) => Ok(text),
                    Ok(Part::End(_)) => return None,
                    // The connection ends without the end of the body.
                    Err(error) => Err(std::io::Error::other(error.detail().to_owned())),
                },
            };
            Some((part, (None, parts)))
        });
        let mut response = Body::from_stream(body).into_response();
        let headers = response.headers_mut();
        let content_type = HeaderValue::from_str(&format!("{media_type}; charset=us-ascii"));
        headers.insert(header::CONTENT_TYPE, content_type.unwrap_or(HeaderValue::from_static(media_type)));
        if let Ok(disposition) = HeaderValue::from_str(&format!("attachment; filename=\"{file_name}\"")) {
            headers.insert(header::CONTENT_DISPOSITION, disposition);
        }
        Ok(response)
    }
}

/// Passes the body through the rewriter, piece by piece, as it comes.
async fn pump(
    app: &App,
    mut body: Body,
    mut work: Work,
    place: Arc<OwnedSemaphorePermit>,
    sender: &mpsc::Sender<Result<Part, ApiError>>,
) -> Result<(), ApiError> {
    let deadline = Instant::now() + app.streams.deadline;
    let late =
        |_| ApiError::new(Code::DeadlinePassed, "the program did not end within the deadline for streams");
    let most = app.streams.bytes;
    loop {
        let data = timeout_at(deadline.into(), next_bytes(&mut body, app)).await.map_err(late)??;
        let is_last = data.is_none();
        let step = move |budget: &Budget| {
            work.take(data.as_deref(), most, budget)?;
            Ok::<_, ApiError>(work)
        };
        work = app.compute.run_admitted(Arc::clone(&place), None, step).await??;
        if !work.out.is_empty() {
            let text = Bytes::from(std::mem::take(&mut work.out));
            let sent = timeout_at(deadline.into(), sender.send(Ok(Part::Text(text)))).await.map_err(late)?;
            if sent.is_err() {
                // Nobody reads any more.
                return Ok(());
            }
        }
        if is_last {
            let _ = sender.send(Ok(Part::End(*work.rewriter.figures()))).await;
            return Ok(());
        }
    }
}

/// A program between two pieces of its body.
struct Work {
    rewriter: Rewriter,
    decoder: Decoder,
    out: Vec<u8>,
    n_bytes: u64,
}

impl Work {
    /// Takes the next bytes of the body, or its end.
    fn take(&mut self, data: Option<&[u8]>, most: u64, budget: &Budget) -> Result<(), ApiError> {
        let Self { rewriter, decoder, out, n_bytes } = self;
        let text = |text: &[u8]| {
            *n_bytes += text.len() as u64;
            if *n_bytes > most {
                let detail = format!("the program has more than {most} bytes; more are not allowed");
                return Err(ApiError::new(Code::PayloadTooLarge, detail));
            }
            Ok(rewriter.push(text, out, budget)?)
        };
        match data {
            Some(data) => decoder.each(data, text),
            None => {
                decoder.end(text)?;
                if *n_bytes == 0 {
                    return Err(ApiError::new(Code::BadRequest, "the body is empty"));
                }
                Ok(rewriter.finish(out, budget)?)
            }
        }
    }
}

/// A body on its way out of its coding.
enum Decoder {
    Identity,
    Gzip(Box<MultiGzDecoder<Vec<u8>>>),
}

impl Decoder {
    fn of(coding: Coding) -> Self {
        match coding {
            Coding::Identity => Self::Identity,
            Coding::Gzip => Self::Gzip(Box::new(MultiGzDecoder::new(Vec::new()))),
        }
    }

    /// Gives the decoded bytes to `take`, a part at a time.
    fn each(
        &mut self,
        data: &[u8],
        mut take: impl FnMut(&[u8]) -> Result<(), ApiError>,
    ) -> Result<(), ApiError> {
        let Self::Gzip(decoder) = self else { return take(data) };
        for part in data.chunks(DECODED_AT_A_TIME) {
            decoder.write_all(part).and_then(|()| decoder.flush()).map_err(no_gzip)?;
            take(decoder.get_ref())?;
            decoder.get_mut().clear();
        }
        Ok(())
    }

    /// Says that no more will come; what is left goes to `take`.
    fn end(&mut self, mut take: impl FnMut(&[u8]) -> Result<(), ApiError>) -> Result<(), ApiError> {
        let Self::Gzip(decoder) = self else { return Ok(()) };
        decoder.try_finish().map_err(no_gzip)?;
        take(decoder.get_ref())
    }
}

fn no_gzip(error: std::io::Error) -> ApiError {
    ApiError::new(Code::BadRequest, format!("the body is no gzip, or not the whole of it: {error}"))
}

impl From<RewriteError> for ApiError {
    fn from(error: RewriteError) -> Self {
        let detail = error.to_string();
        match error {
            RewriteError::Stopped(stopped) => stopped.into(),
            RewriteError::LineTooLong { line: _, limit: _ } => Self::new(Code::LimitExceeded, detail),
        }
    }
}
