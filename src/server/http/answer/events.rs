//! The answer of a computation as server-sent events: progress while the computation runs, then the result or
//! a problem document.

use std::convert::Infallible;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::body::{Body, Bytes};
use axum::http::header;
use axum::response::{IntoResponse, Response};
use futures_util::StreamExt;
use futures_util::stream::unfold;
use serde::Serialize;
use tokio::sync::{Notify, mpsc};
use tokio::task::JoinHandle;
use tokio::time::timeout;
use tracing::Instrument;
use utoipa::ToSchema;

use super::encoded::Encoded;
use crate::http::byte_limit::HeldBytes;
use crate::http::compute::Failure;
use crate::http::error::ApiError;
use crate::http::request::representation::EVENTS;
use crate::http::request::request_id::RequestId;
use toolpathd_core::budget::ProgressSink;

/// Shortest time between two progress events of the same stage.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// Time without an event after which a comment is sent. Proxies then do not take the connection for dead, and
/// the service notices a caller that has gone away.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_secs(1);

/// A comment, which callers ignore.
const KEEP_ALIVE: &[u8] = b":\n\n";

/// Most progress events that wait for a caller who does not read. Further progress events are dropped.
const BACKLOG: usize = 64;

/// How far a computation has come: the data of an event `progress`.
#[derive(Debug, Clone, PartialEq, Serialize, ToSchema)]
pub struct Progress {
    /// Name of the stage, such as `sections`.
    stage: &'static str,
    /// The part of the stage that is done: a ratio from 0 to 1.
    #[schema(minimum = 0, maximum = 1)]
    fraction: f64,
    /// Number of steps of the stage that are done.
    done: usize,
    /// Number of steps of the stage.
    total: usize,
}

impl Progress {
    fn of(stage: &'static str, done: usize, total: usize) -> Self {
        let fraction = if total == 0 { 1.0 } else { (done as f64 / total as f64).min(1.0) };
        Self { stage, fraction, done, total }
    }
}

/// Passes progress to the stream: the first report of every stage, and later reports of the stage at most
/// once in [`PROGRESS_INTERVAL`].
struct Listener {
    sender: mpsc::Sender<Progress>,
    last: Mutex<Option<(&'static str, Instant)>>,
}

impl Listener {
    /// Passes on what a computation reports at the time `now`.
    fn tell(&self, now: Instant, stage: &'static str, done: usize, total: usize) {
        let mut last = self.last.lock().unwrap_or_else(PoisonError::into_inner);
        if last.is_some_and(|(told, when)| told == stage && now - when < PROGRESS_INTERVAL) {
            return;
        }
        *last = Some((stage, now));
        // The queue is full when the caller does not read, and closed when the caller has gone away. In both
        // cases the event is dropped.
        let _ = self.sender.try_send(Progress::of(stage, done, total));
    }
}

impl ProgressSink for Listener {
    fn progress(&self, stage: &'static str, done: usize, total: usize) {
        self.tell(Instant::now(), stage, done, total);
    }
}

/// Tells that a computation has begun its work: from then on, failures are events.
#[derive(Debug, Clone, Default)]
pub struct Begun(Arc<Notify>);

impl Begun {
    /// Work that has begun already.
    pub fn told() -> Self {
        let begun = Self::default();
        begun.tell();
        begun
    }

    pub fn tell(&self) {
        self.0.notify_one();
    }
}

/// Answers with the progress of a computation as events; the last event is `result` or `problem`. `start`
/// makes the computation from the listener for its progress. The computation goes on while nobody reads the
/// events. Dropping the response drops the computation.
///
/// # Errors
/// The failure of a computation that ended before it told `begun`.
pub async fn stream<F>(
    request_id: RequestId,
    begun: Begun,
    start: impl FnOnce(Arc<dyn ProgressSink>) -> F,
) -> Result<Response, ApiError>
where
    F: Future<Output = Result<Encoded, ApiError>> + Send + 'static,
{
    let (sender, progress) = mpsc::channel(BACKLOG);
    // The computation outlives the handler and the handler's span.
    let computation = start(Arc::new(Listener { sender, last: Mutex::new(None) })).in_current_span();
    let mut computation = Computation(tokio::spawn(computation));
    let stage = tokio::select! {
        biased;
        () = begun.0.notified() => Stage::Computing(computation),
        outcome = computation.outcome() => Stage::Ending(Event::last(Ok(outcome?), &request_id)),
    };
    let running = Running { progress, stage, request_id };
    let events = unfold((running, None), async |(mut running, rest)| {
        // The pieces of one event follow each other without a pause.
        let (piece, rest) = match rest {
            Some(event) => Event::piece(event),
            None => match timeout(KEEP_ALIVE_INTERVAL, running.next()).await {
                Ok(event) => Event::piece(event?),
                Err(_) => (Bytes::from_static(KEEP_ALIVE), None),
            },
        };
        Some((Ok::<_, Infallible>(piece), (running, rest)))
    });
    // `fuse`, because layers may poll the body again after its end.
    let headers = [(header::CONTENT_TYPE, EVENTS), (header::CACHE_CONTROL, "no-cache")];
    Ok((headers, Body::from_stream(events.fuse())).into_response())
}

/// A computation on a task of its own. Dropping the value ends the task.
struct Computation(JoinHandle<Result<Encoded, ApiError>>);

impl Computation {
    async fn outcome(&mut self) -> Result<Encoded, ApiError> {
        (&mut self.0).await.unwrap_or_else(|_| Err(Failure::Panicked.into()))
    }
}

impl Drop for Computation {
    fn drop(&mut self) {
        self.0.abort();
    }
}

struct Running {
    progress: mpsc::Receiver<Progress>,
    stage: Stage,
    request_id: RequestId,
}

enum Stage {
    Computing(Computation),
    /// The computation has ended and made the last event. Progress events that still wait are sent first.
    Ending(Event),
    /// The last event was given out. Its bytes count until the answer is sent.
    Ended(#[expect(dead_code, reason = "it is held")] Option<HeldBytes>),
}

impl Running {
    /// The next event; `None` after the last one. Dropping the future loses nothing.
    async fn next(&mut self) -> Option<Event> {
        if let Stage::Computing(computation) = &mut self.stage {
            tokio::select! {
                biased;
                Some(progress) = self.progress.recv() => return Some(Event::of(&progress)),
                outcome = computation.outcome() => {
                    self.stage = Stage::Ending(Event::last(outcome, &self.request_id));
                }
            }
        }
        if let Ok(progress) = self.progress.try_recv() {
            return Some(Event::of(&progress));
        }
        match std::mem::replace(&mut self.stage, Stage::Ended(None)) {
            Stage::Ending(mut event) => {
                self.stage = Stage::Ended(event.held.take());
                Some(event)
            }
            Stage::Computing(_) | Stage::Ended(_) => None,
        }
    }
}

/// An event in three pieces: name, data and end. So a large result is not copied.
struct Event {
    pieces: [Bytes; 3],
    held: Option<HeldBytes>,
}

impl Event {
    /// `data` has no line breaks: compact JSON has none between its tokens, and texts escape them.
    fn new(name: &'static str, data: Bytes, held: Option<HeldBytes>) -> Self {
        let pieces = [format!("event: {name}\ndata: ").into(), data, Bytes::from_static(b"\n\n")];
        Self { pieces, held }
    }

    fn of(progress: &Progress) -> Self {
        Self::new("progress", serde_json::to_vec(progress).unwrap_or_default().into(), None)
    }

    fn last(outcome: Result<Encoded, ApiError>, request_id: &RequestId) -> Self {
        match outcome {
            Ok(encoded) => {
                let (data, held) = encoded.into_parts();
                Self::new("result", data, held)
            }
            Err(error) => {
                let problem = error.problem(request_id.as_str());
                Self::new("problem", serde_json::to_vec(&problem).unwrap_or_default().into(), None)
            }
        }
    }

    /// The first piece that is left, and the event if there are more.
    fn piece(mut self) -> (Bytes, Option<Self>) {
        let [name, data, end] = &mut self.pieces;
        let next = if !name.is_empty() { name } else { data };
        if next.is_empty() {
            return (std::mem::take(end), None);
        }
        (std::mem::take(next), Some(self))
    }
}

#[cfg(test)]
mod tests {
    use axum::body::to_bytes;
    use serde_json::{Value, json};

    use super::*;
    use crate::http::error::Code;

    /// Name and data of each event.
    async fn events(response: Response) -> Vec<(String, Value)> {
        let body = to_bytes(response.into_body(), usize::MAX).await.expect("a body");
        let text = String::from_utf8(body.into()).expect("UTF-8");
        let blocks = text.split_terminator("\n\n").map(|block| {
            let (name, data) = block.split_once('\n').expect("two lines");
            let data = data.strip_prefix("data: ").expect("data");
            (name.to_owned(), serde_json::from_str(data).expect("JSON on one line"))
        });
        blocks.collect()
    }

    fn request_id() -> RequestId {
        RequestId::of(&Default::default())
    }

    /// The answer of a computation that has begun its work.
    async fn answered<F>(start: impl FnOnce(Arc<dyn ProgressSink>) -> F) -> Response
    where
        F: Future<Output = Result<Encoded, ApiError>> + Send + 'static,
    {
        stream(request_id(), Begun::told(), start).await.expect("events")
    }

    #[tokio::test]
    async fn stages_are_told_at_once_and_the_end_comes_last() {
        let response = answered(|listener| async move {
            listener.progress("sections", 0, 1000);
            listener.progress("certificate", 0, 0);
            Encoded::json(&json!({ "text": "a\nb\r" }))
        })
        .await;
        assert_eq!(
            events(response).await,
            [
                (
                    "event: progress".to_owned(),
                    json!({ "stage": "sections", "fraction": 0.0, "done": 0, "total": 1000 })
                ),
                (
                    "event: progress".to_owned(),
                    json!({ "stage": "certificate", "fraction": 1.0, "done": 0, "total": 0 })
                ),
                ("event: result".to_owned(), json!({ "text": "a\nb\r" })),
            ]
        );
    }

    #[test]
    fn a_stage_is_told_at_once_and_again_after_a_while_only() {
        let (sender, mut progress) = mpsc::channel(BACKLOG);
        let listener = Listener { sender, last: Mutex::new(None) };
        let begun = Instant::now();
        for k in 0..1000 {
            listener.tell(begun, "sections", k, 1000);
        }
        for k in 0..15_u32 {
            listener.tell(begun + k * PROGRESS_INTERVAL / 5, "arcs", k as usize, 15);
        }
        let told = std::iter::from_fn(|| progress.try_recv().ok());
        let told: Vec<_> = told.map(|told| (told.stage, told.done)).collect();
        assert_eq!(told, [("sections", 0), ("arcs", 0), ("arcs", 5), ("arcs", 10)]);
    }

    #[tokio::test]
    async fn a_caller_who_does_not_read_costs_no_more_than_the_backlog() {
        let response = answered(|listener| async move {
            for k in 0..10_000 {
                listener.progress(if k % 2 == 0 { "sections" } else { "arcs" }, k, 10_000);
            }
            Encoded::json(&())
        })
        .await;
        assert_eq!(events(response).await.len(), BACKLOG + 1);
    }

    #[tokio::test]
    async fn a_failure_before_the_work_has_begun_is_no_event() {
        let failure = async { Err(ApiError::new(Code::MalformedJson, "no JSON")) };
        let answer = stream(request_id(), Begun::default(), |_| failure).await;
        assert_eq!(answer.expect_err("a failure").code(), Code::MalformedJson);
    }

    #[tokio::test]
    async fn a_failure_is_a_problem_with_the_requests_id() {
        let id = request_id();
        let failure = async { Err(ApiError::new(Code::NothingToCut, "nothing")) };
        let response = stream(id.clone(), Begun::told(), |_| failure).await.expect("events");
        let events = events(response).await;
        let [(name, problem)] = events.as_slice() else { panic!("{events:?}") };
        assert_eq!(name, "event: problem");
        assert_eq!((&problem["code"], &problem["status"]), (&json!("nothing_to_cut"), &json!(422)));
        assert_eq!(problem["request_id"], id.as_str());
    }
}
