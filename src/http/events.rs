//! The answer of a computation as server-sent events: progress while the computation runs, then the result or
//! a problem document.

use std::convert::Infallible;
use std::pin::Pin;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use futures_util::stream::unfold;
use serde::Serialize;
use tokio::sync::mpsc;
use utoipa::ToSchema;

use super::error::ApiError;
use super::output::Encoded;
use super::request_id::RequestId;
use crate::budget::ProgressSink;

/// Shortest time between two progress events of the same stage.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// Time without an event after which a comment is sent, so that proxies do not take the connection for dead.
const KEEP_ALIVE_INTERVAL: Duration = Duration::from_secs(5);

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

impl ProgressSink for Listener {
    fn progress(&self, stage: &'static str, done: usize, total: usize) {
        let now = Instant::now();
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

/// Answers with the progress of a computation as events; the last event is `result` or `problem`. `start`
/// makes the computation from the listener for its progress. Dropping the response drops the computation.
pub fn stream<F>(request_id: RequestId, start: impl FnOnce(Arc<dyn ProgressSink>) -> F) -> Response
where
    F: Future<Output = Result<Encoded, ApiError>> + Send + 'static,
{
    let (sender, progress) = mpsc::channel(BACKLOG);
    let computation = start(Arc::new(Listener { sender, last: Mutex::new(None) }));
    let running = Running { progress, stage: Stage::Computing(Box::pin(computation)), request_id };
    let events = unfold(running, async |running| {
        running.next().await.map(|(event, running)| (Ok::<_, Infallible>(event), running))
    });
    let keep_alive = KeepAlive::new().interval(KEEP_ALIVE_INTERVAL);
    Sse::new(events).keep_alive(keep_alive).into_response()
}

type Computation = Pin<Box<dyn Future<Output = Result<Encoded, ApiError>> + Send>>;

struct Running {
    progress: mpsc::Receiver<Progress>,
    stage: Stage,
    request_id: RequestId,
}

enum Stage {
    Computing(Computation),
    /// The computation has ended and made the last event. Progress events that still wait are sent first.
    Ending(Event),
    Ended,
}

impl Running {
    async fn next(mut self) -> Option<(Event, Self)> {
        if let Stage::Computing(computation) = &mut self.stage {
            tokio::select! {
                biased;
                Some(progress) = self.progress.recv() => return Some((event_of(&progress), self)),
                outcome = computation => self.stage = Stage::Ending(last_event(outcome, &self.request_id)),
            }
        }
        if let Ok(progress) = self.progress.try_recv() {
            return Some((event_of(&progress), self));
        }
        match std::mem::replace(&mut self.stage, Stage::Ended) {
            Stage::Ending(event) => Some((event, self)),
            Stage::Computing(_) | Stage::Ended => None,
        }
    }
}

fn event_of(progress: &Progress) -> Event {
    let data = serde_json::to_string(progress).unwrap_or_default();
    Event::default().event("progress").data(data)
}

fn last_event(outcome: Result<Encoded, ApiError>, request_id: &RequestId) -> Event {
    match outcome {
        // Compact JSON holds no line breaks: there are none between its tokens, and texts escape them.
        Ok(encoded) => Event::default().event("result").data(encoded.into_text()),
        Err(error) => {
            let problem = error.problem(request_id.as_str());
            let data = serde_json::to_string(&problem).unwrap_or_default();
            Event::default().event("problem").data(data)
        }
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

    #[tokio::test]
    async fn stages_are_told_at_once_and_repeated_seldom_and_the_end_comes_last() {
        let response = stream(request_id(), |listener| async move {
            for k in 0..1000 {
                listener.progress("sections", k, 1000);
            }
            listener.progress("certificate", 0, 0);
            Encoded::json(&json!({ "text": "a\nb\r" }))
        });
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

    #[tokio::test]
    async fn a_long_stage_is_told_again_after_a_while() {
        let response = stream(request_id(), |listener| async move {
            for k in 0..15 {
                listener.progress("sections", k, 15);
                tokio::time::sleep(PROGRESS_INTERVAL / 5).await;
            }
            Encoded::json(&())
        });
        let told = events(response).await.len() - 1;
        assert!((2..=4).contains(&told), "{told}");
    }

    #[tokio::test]
    async fn a_caller_who_does_not_read_costs_no_more_than_the_backlog() {
        let response = stream(request_id(), |listener| async move {
            for k in 0..10_000 {
                listener.progress(if k % 2 == 0 { "sections" } else { "arcs" }, k, 10_000);
            }
            Encoded::json(&())
        });
        assert_eq!(events(response).await.len(), BACKLOG + 1);
    }

    #[tokio::test]
    async fn a_failure_is_a_problem_with_the_requests_id() {
        let id = request_id();
        let failure = async { Err(ApiError::new(Code::NothingToCut, "nothing")) };
        let events = events(stream(id.clone(), |_| failure)).await;
        let [(name, problem)] = events.as_slice() else { panic!("{events:?}") };
        assert_eq!(name, "event: problem");
        assert_eq!((&problem["code"], &problem["status"]), (&json!("nothing_to_cut"), &json!(422)));
        assert_eq!(problem["request_id"], id.as_str());
    }
}
