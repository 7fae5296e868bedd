//! Rewrites NC programs while they arrive. A program may be larger than memory. Its answer begins before the
//! whole program has arrived.
//!
//! A *stream* is one such program under way, from its first byte to the end of its answer.
//! * The number of streams is limited; a further stream is refused.
//! * A stream uses a thread only while it has bytes to rewrite.
//! * The rewritten text waits for the caller in a queue of limited size. If the caller reads slowly, the
//!   queue fills up. Then the service reads no more of the program until the queue has room.
//! * A failure before the first byte of the answer gives a problem document. A later failure closes the
//!   connection before the end of the body. So the caller sees that the answer is not complete.

use std::io::Write;
use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use axum::extract::Request;
use axum::response::{IntoResponse, Response};
use flate2::write::MultiGzDecoder;
use futures_util::StreamExt;
use futures_util::stream::unfold;
use tokio::sync::{OwnedSemaphorePermit, Semaphore, mpsc};
use tokio::time::timeout_at;

use super::encoded::Encoded;
use super::streamed::Streamed;
use crate::config::Settings;
use crate::http::compute::{Compute, Step};
use crate::http::error::{ApiError, Code};
use crate::http::request::body::BodyLimits;
use crate::http::request::coding::Coding;
use toolpathd_core::budget::Budget;
use toolpathd_post::rewrite::{Figures, Rewriter};

/// Most bytes of an answer that wait for a caller who does not read. Small programs fit whole, so a caller
/// may send its whole program before it reads the answer.
const BACKLOG_BYTES: u32 = 4 * 1024 * 1024;

/// Most parts in that queue. Each part costs some memory, however small its text is.
const BACKLOG_PARTS: usize = 1024;

/// Bytes of a body that one step takes. A step takes fewer bytes of a gzip body, because they may
/// decode to a thousand times as many.
const STEP_BYTES: usize = 256 * 1024;
const CODED_STEP_BYTES: usize = 4096;

/// Most bytes of rewritten text that are held back until the first block that moves the machine. A shorter
/// text without such a block is refused as no program before any of it is answered.
const HELD_BYTES: usize = 64 * 1024;

/// What streams need, and their limits.
#[derive(Clone)]
pub struct Streams {
    compute: Arc<Compute>,
    body: BodyLimits,
    /// One permit for each stream.
    permits: Arc<Semaphore>,
    /// Most bytes of one program.
    pub bytes: u64,
    pub deadline: Duration,
}

impl Streams {
    pub fn new(settings: &Settings, body: BodyLimits, compute: Arc<Compute>) -> Self {
        Self {
            compute,
            body,
            permits: Arc::new(Semaphore::new(usize::from(settings.streams))),
            bytes: settings.stream_bytes,
            deadline: settings.stream_deadline_s,
        }
    }
}

/// A part of the answer.
enum Part {
    /// Text, with the permit for its bytes in the queue.
    Text(Bytes, #[expect(dead_code, reason = "it is held")] OwnedSemaphorePermit),
    /// The end of the text, with the figures of the whole program.
    End(Figures),
}

fn given_up() -> ApiError {
    ApiError::new(Code::InternalError, "the stream was given up")
}

/// A program on its way through the rewriter.
pub struct ProgramStream {
    parts: mpsc::Receiver<Result<Part, ApiError>>,
}

impl ProgramStream {
    /// Begins to rewrite the body of `request`.
    ///
    /// # Errors
    /// `unsupported_coding`; `overloaded` when there are as many streams as may be.
    pub fn begin(streams: &Streams, request: Request, rewriter: Rewriter) -> Result<Self, ApiError> {
        let coding = Coding::of(request.headers())?;
        let permit = Arc::clone(&streams.permits).try_acquire_owned().map_err(|_| {
            ApiError::new(Code::Overloaded, "every place for streams is taken; try again later")
        })?;
        let (sender, parts) = mpsc::channel(BACKLOG_PARTS);
        let work = Work { rewriter, decoder: Decoder::of(coding), out: Vec::new(), n_bytes: 0 };
        let streams = streams.clone();
        tokio::spawn(async move {
            if let Err(error) = pump(&streams, request.into_body(), work, Arc::new(permit), &sender).await {
                // Sending fails when the caller has gone away; then nobody waits for the error.
                let _ = sender.send(Err(error)).await;
            }
        });
        Ok(Self { parts })
    }

    /// Rewrites the whole program, throws the text away and returns the figures.
    ///
    /// # Errors
    /// The error that ended the stream.
    pub async fn figures(mut self) -> Result<Figures, ApiError> {
        while let Some(part) = self.parts.recv().await {
            if let Part::End(figures) = part? {
                return Ok(figures);
            }
        }
        Err(given_up())
    }

    /// Answers the text as it becomes ready, under `media_type`, to be saved as `file_name`.
    ///
    /// # Errors
    /// The error that ended the stream before its first byte was ready.
    pub async fn text(mut self, media_type: &'static str, file_name: &str) -> Result<Response, ApiError> {
        let first = match self.parts.recv().await {
            Some(Ok(Part::Text(text, _))) => text,
            Some(Ok(Part::End(_))) => Bytes::new(),
            Some(Err(error)) => return Err(error),
            None => return Err(given_up()),
        };
        let body = unfold((Some(first), self.parts), async |(first, mut parts)| {
            let part = match first {
                Some(text) => Ok(text),
                None => match parts.recv().await {
                    Some(Ok(Part::Text(text, _))) => Ok(text),
                    Some(Ok(Part::End(_))) => return None,
                    // The connection ends without the end of the body.
                    Some(Err(error)) => Err(std::io::Error::other(error.detail().to_owned())),
                    None => Err(std::io::Error::other("the stream was given up")),
                },
            };
            Some((part, (None, parts)))
        });
        // `fuse`, because layers may poll the body again after its end.
        let mut response = Encoded::gcode(String::new(), media_type, file_name).into_response();
        *response.body_mut() = Body::from_stream(body.fuse());
        response.extensions_mut().insert(Streamed);
        Ok(response)
    }
}

/// Passes the body through the rewriter, piece by piece, as it arrives. Ends early when the caller has gone
/// away.
async fn pump(
    streams: &Streams,
    mut body: Body,
    mut work: Work,
    permit: Arc<OwnedSemaphorePermit>,
    sender: &mpsc::Sender<Result<Part, ApiError>>,
) -> Result<(), ApiError> {
    let deadline = Instant::now() + streams.deadline;
    let late = |_| {
        let detail = "the program was not received and rewritten within the deadline for streams";
        ApiError::new(Code::DeadlinePassed, detail)
    };
    let queue = Arc::new(Semaphore::new(BACKLOG_BYTES as usize));
    let step_bytes = work.decoder.step_bytes();
    let rewritten = async {
        loop {
            let data = streams.body.next_bytes(&mut body).await?;
            let Some(mut data) = data else { break };
            while !data.is_empty() {
                let piece = data.split_to(data.len().min(step_bytes));
                work = step(streams, work, Some(piece), &permit).await?;
                if work.rewriter.figures().n_motions > 0 || work.out.len() > HELD_BYTES {
                    send(&mut work.out, &queue, sender).await;
                }
            }
        }
        work = step(streams, work, None, &permit).await?;
        send(&mut work.out, &queue, sender).await;
        let _ = sender.send(Ok(Part::End(*work.rewriter.figures()))).await;
        Ok(())
    };
    tokio::select! {
        () = sender.closed() => Ok(()),
        done = timeout_at(deadline.into(), rewritten) => done.map_err(late)?,
    }
}

/// Passes one piece of the body, or its end (`None`), through the rewriter.
async fn step(
    streams: &Streams,
    mut work: Work,
    data: Option<Bytes>,
    permit: &Arc<OwnedSemaphorePermit>,
) -> Result<Work, ApiError> {
    let most = streams.bytes;
    let job = move |budget: &Budget| {
        work.take(data.as_deref(), most, budget)?;
        Ok::<_, ApiError>(work)
    };
    streams.compute.run_step(Step::OfStream, Arc::clone(permit), job).await?
}

/// Puts the rewritten text into the queue, and waits until the queue has room.
async fn send(out: &mut Vec<u8>, queue: &Arc<Semaphore>, sender: &mpsc::Sender<Result<Part, ApiError>>) {
    if out.is_empty() {
        return;
    }
    let text = Bytes::from(std::mem::take(out));
    let room = u32::try_from(text.len()).unwrap_or(BACKLOG_BYTES).min(BACKLOG_BYTES);
    // The semaphore is never closed. Sending fails only when the caller has gone away.
    if let Ok(room) = Arc::clone(queue).acquire_many_owned(room).await {
        let _ = sender.send(Ok(Part::Text(text, room))).await;
    }
}

/// The state of a program between two pieces of its body.
struct Work {
    rewriter: Rewriter,
    decoder: Decoder,
    out: Vec<u8>,
    n_bytes: u64,
}

impl Work {
    /// Rewrites the next bytes of the body, or its end (`None`). `most` is the largest number of decoded
    /// bytes.
    fn take(&mut self, data: Option<&[u8]>, most: u64, budget: &Budget) -> Result<(), ApiError> {
        let Self { rewriter, decoder, out, n_bytes } = self;
        let text = |text: &[u8]| {
            *n_bytes += text.len() as u64;
            if *n_bytes > most {
                let detail = format!("the program has more than {most} bytes: send a smaller program");
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
                rewriter.finish(out, budget)?;
                let figures = rewriter.figures();
                if figures.n_motions == 0 && figures.bytes_out == out.len() as u64 {
                    let detail =
                        "no block of the text moves the machine: send an NC program, or points as JSON";
                    return Err(ApiError::new(Code::NoMotion, detail));
                }
                Ok(())
            }
        }
    }
}

/// Undoes the content coding of a body.
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

    /// Decodes `data` and gives the decoded bytes to `take`.
    fn each(
        &mut self,
        data: &[u8],
        mut take: impl FnMut(&[u8]) -> Result<(), ApiError>,
    ) -> Result<(), ApiError> {
        let Self::Gzip(decoder) = self else { return take(data) };
        decoder.write_all(data).and_then(|()| decoder.flush()).map_err(no_gzip)?;
        take(decoder.get_ref())?;
        decoder.get_mut().clear();
        Ok(())
    }

    /// Bytes of the body that one step takes.
    fn step_bytes(&self) -> usize {
        match self {
            Self::Identity => STEP_BYTES,
            Self::Gzip(_) => CODED_STEP_BYTES,
        }
    }

    /// Ends the decoding. The last decoded bytes go to `take`.
    fn end(&mut self, mut take: impl FnMut(&[u8]) -> Result<(), ApiError>) -> Result<(), ApiError> {
        let Self::Gzip(decoder) = self else { return Ok(()) };
        decoder.try_finish().map_err(no_gzip)?;
        take(decoder.get_ref())
    }
}

fn no_gzip(error: std::io::Error) -> ApiError {
    ApiError::new(Code::BadRequest, format!("the body is not gzip, or its end is missing: {error}"))
}
