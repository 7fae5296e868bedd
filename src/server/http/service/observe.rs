//! The outermost layer of the service. For every request it writes one log line and counts metrics. If the
//! caller sent a trace, the request continues this trace.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

use axum::body::{Body, HttpBody};
use axum::extract::{MatchedPath, Request, State};
use axum::http::{Method, StatusCode};
use axum::middleware::Next;
use axum::response::Response;
use tracing::field::Empty;
use tracing::{Instrument, Span};

use super::counted_body::{CountedBody, Seen};
use super::metrics::{Answered, Metrics};
use crate::http::answer::timing::Timing;
use crate::http::error::Code;
use crate::http::request::request_id::RequestId;
use crate::http::request::trace::{self, Trace};

/// The route in logs and metrics of a request that matches no route.
const NO_ROUTE: &str = "none";

/// Gives the request an id and follows it until the caller has the whole answer or goes away.
pub async fn observe(State(metrics): State<Arc<Metrics>>, mut request: Request, next: Next) -> Response {
    let id = RequestId::of(request.headers());
    let trace = Trace::of(request.headers());
    let mut record = Record::new(metrics, &request, &id, trace.as_ref());
    request.extensions_mut().insert(id);
    let received = Arc::clone(&record.received_bytes);
    let request = request.map(|body| {
        let count = move |seen| {
            if let Seen::Data(bytes) = seen {
                received.fetch_add(bytes as u64, Ordering::Relaxed);
            }
        };
        Body::new(CountedBody { body, tell: count })
    });

    let span = record.span.clone();
    let mut response = next.run(request).instrument(span).await;
    if let Some(trace) = trace {
        response.headers_mut().insert(trace::HEADER, trace.header_value());
    }
    record.answer(&response);
    response.map(|body| Body::new(CountedBody { body, tell: move |seen| record.sent(seen) }))
}

/// What the log and the metrics say about a request. Dropping the record writes both.
struct Record {
    metrics: Arc<Metrics>,
    span: Span,
    route: Option<MatchedPath>,
    method: Method,
    started: Instant,
    received_bytes: Arc<AtomicU64>,
    sent_bytes: u64,
    answer: Option<Answer>,
    is_whole: bool,
}

/// The head of an answer.
#[derive(Clone, Copy)]
struct Answer {
    status: StatusCode,
    code: Option<Code>,
    timing: Option<Timing>,
}

impl Record {
    fn new(metrics: Arc<Metrics>, request: &Request, id: &RequestId, trace: Option<&Trace>) -> Self {
        // The log holds paths and ids only. Bodies and queries may be confidential.
        let span = tracing::info_span!(
            "request",
            request_id = id.as_str(),
            trace_id = Empty,
            method = %request.method(),
            path = shortened(request.uri().path())
        );
        if let Some(trace) = trace {
            span.record("trace_id", trace.id());
        }
        Self {
            metrics,
            span,
            route: request.extensions().get::<MatchedPath>().cloned(),
            method: request.method().clone(),
            started: Instant::now(),
            received_bytes: Arc::default(),
            sent_bytes: 0,
            answer: None,
            is_whole: false,
        }
    }

    fn answer(&mut self, response: &Response) {
        let extensions = response.extensions();
        self.answer = Some(Answer {
            status: response.status(),
            code: extensions.get().copied(),
            timing: extensions.get().copied(),
        });
        self.is_whole = self.method == Method::HEAD || response.body().is_end_stream();
    }

    fn sent(&mut self, seen: Seen) {
        match seen {
            Seen::Data(bytes) => self.sent_bytes += bytes as u64,
            Seen::End => self.is_whole = true,
        }
    }

    fn tell_answered(&self, route: &str, received_bytes: u64, answer: Answer) {
        let Answer { status, code, timing } = answer;
        let (duration, sent_bytes) = (self.started.elapsed(), self.sent_bytes);
        let step_ms =
            |step: fn(&Timing) -> Duration| timing.as_ref().map(|timing| milliseconds(step(timing)));
        tracing::info!(
            route,
            status = status.as_u16(),
            code = code.map(tracing::field::display),
            duration_ms = milliseconds(duration),
            queue_ms = step_ms(|timing| timing.queue),
            parse_ms = step_ms(|timing| timing.parse),
            compute_ms = step_ms(|timing| timing.compute),
            encode_ms = step_ms(|timing| timing.encode),
            received_bytes,
            sent_bytes,
            "answered"
        );
        let method = &self.method;
        self.metrics.answered(Answered {
            route,
            method,
            status,
            code,
            timing,
            duration,
            received_bytes,
            sent_bytes,
        });
    }
}

impl Drop for Record {
    fn drop(&mut self) {
        let _entered = self.span.clone().entered();
        let route = self.route.as_ref().map_or(NO_ROUTE, MatchedPath::as_str);
        let received_bytes = self.received_bytes.load(Ordering::Relaxed);
        match self.answer {
            Some(answer) if self.is_whole => self.tell_answered(route, received_bytes, answer),
            _ => {
                let duration_ms = milliseconds(self.started.elapsed());
                let sent_bytes = self.sent_bytes;
                tracing::info!(route, duration_ms, received_bytes, sent_bytes, "the caller went away");
                self.metrics.cancelled(route);
            }
        }
    }
}

/// The beginning of a path. A caller may send any path.
fn shortened(path: &str) -> &str {
    const MAX_BYTES: usize = 200;
    // A path of a request is ASCII, so each byte is a character.
    path.get(..MAX_BYTES).unwrap_or(path)
}

fn milliseconds(duration: Duration) -> f64 {
    // Rounded to a microsecond: further digits are noise.
    (duration.as_secs_f64() * 1e6).round() / 1e3
}
