//! Connections: how they are accepted, how many there may be, and the limits on the time that a caller may
//! take.
//!
//! Here belongs what lies between the socket and the first layer of the service. A request is hyper's
//! business before, and the business of [`service`](super::service) after.

mod drained_body;
mod limit;
mod parser_refusal;
mod reading_speed;
pub mod serve;
mod socket;

use std::io;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError, Weak};
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderValue, Request, Version, header};
use axum::response::Response;
use hyper::body::Incoming;
use hyper::service::service_fn;
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto;
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::time::{Instant, interval, sleep_until, timeout};
use tokio_io_timeout::TimeoutStream;
use tower::ServiceExt;

use super::answer::allowed_time::AllowedTime;
use super::request::arrival::Arrival;
use super::service::metrics::Metrics;
use crate::config::Settings;
use drained_body::DrainedBody;
use limit::ConnectionLimit;
use parser_refusal::Explained;
use reading_speed::{MeasuredBody, ReadingSpeed};
use socket::Socket;

/// How long an idle connection stays open after the signal, because a request may already be on its way.
const IDLE_GRACE: Duration = Duration::from_millis(500);

/// How long a caller may take, beyond the times for waiting and computing, to read the last answer of a
/// connection that is being closed.
const LAST_ANSWER_LIMIT: Duration = Duration::from_secs(300);

/// Time within which a connection beyond the limit must send the head of a request. It is closed after twice
/// this time.
const BEYOND_LIMIT_TIME: Duration = Duration::from_secs(1);

/// Largest head of a request.
const HEAD_BYTES: u32 = 96 * 1024;

/// Bytes that the service buffers for a stream of HTTP/2, and for a whole connection, while no handler reads
/// them.
const READ_AHEAD_BYTES: u32 = 64 * 1024;

/// Most requests under way on one connection of HTTP/2.
const STREAMS: u32 = 100;

/// Size of the write buffer of one request of HTTP/2.
const WRITE_AHEAD_BYTES: usize = 64 * 1024;

/// What connections need.
pub struct Connections {
    limit: ConnectionLimit,
    times: TimeLimits,
    metrics: Arc<Metrics>,
}

impl Connections {
    pub fn new(settings: &Settings, metrics: Arc<Metrics>) -> Self {
        Self { limit: ConnectionLimit::new(settings), times: TimeLimits::new(settings), metrics }
    }

    /// Number of connections within the limit.
    pub fn open(&self) -> usize {
        self.limit.open()
    }
}

/// Time limits of a connection.
#[derive(Debug, Clone, Copy)]
struct TimeLimits {
    /// For the head of a request to arrive.
    header: Duration,
    /// For the caller to take the next byte of an answer.
    write: Duration,
    /// For the last answer of a connection that is being closed, its computation included.
    last_answer: Duration,
    /// The same for an answer that is streamed while its program arrives.
    last_stream: Duration,
}

impl TimeLimits {
    fn new(settings: &Settings) -> Self {
        Self {
            header: settings.header_timeout_s,
            write: settings.write_timeout_s,
            last_answer: settings.queue_wait_s + settings.deadline_s + LAST_ANSWER_LIMIT,
            last_stream: settings.stream_deadline_s + LAST_ANSWER_LIMIT,
        }
    }

    /// How long the last answer of a connection may take. `None` if it may take any time.
    fn last(&self, activity: &Activity) -> Option<Duration> {
        let longest =
            if activity.streams() { self.last_answer.max(self.last_stream) } else { self.last_answer };
        (!activity.is_endless()).then_some(longest)
    }

    /// How often it is checked whether an answer goes out too slowly.
    fn check_interval(&self) -> Duration {
        (self.write / 8).clamp(Duration::from_millis(10), Duration::from_secs(2))
    }
}

/// Serves one connection until either side ends it.
async fn connection(
    stream: TcpStream,
    router: Router,
    arrival: Arrival,
    times: TimeLimits,
    draining: watch::Receiver<bool>,
) {
    let activity = Arc::new(Activity::default());
    let socket = Socket::new(stream);
    let service = {
        let (activity, closing, socket) = (Arc::clone(&activity), draining.clone(), socket.clone());
        service_fn(move |request: Request<Incoming>| {
            let busy = Busy::new(&activity);
            let must_close = *closing.borrow() || arrival == Arrival::BeyondLimit;
            answer(request, router.clone(), arrival, busy, must_close, socket.clone())
        })
    };
    let header_limit = match arrival {
        Arrival::Regular => times.header,
        Arrival::BeyondLimit => times.header.min(BEYOND_LIMIT_TIME),
    };
    let mut builder = auto::Builder::new(TokioExecutor::new());
    builder
        .http1()
        .timer(TokioTimer::new())
        .header_read_timeout(header_limit)
        // A caller that ends its own direction still gets its answer; `Socket::until_gone` finds those who
        // have gone away.
        .half_close(true)
        .max_buf_size(HEAD_BYTES as usize);
    builder
        .http2()
        .timer(TokioTimer::new())
        .keep_alive_interval(header_limit)
        .initial_stream_window_size(READ_AHEAD_BYTES)
        .initial_connection_window_size(READ_AHEAD_BYTES)
        .max_concurrent_streams(STREAMS)
        .max_send_buf_size(WRITE_AHEAD_BYTES)
        .max_header_list_size(HEAD_BYTES);
    let mut stream = TimeoutStream::new(socket);
    stream.set_write_timeout(Some(times.write));
    let connection = builder.serve_connection(TokioIo::new(Explained::new(Box::pin(stream))), service);
    match arrival {
        Arrival::Regular => supervise(connection, activity, times, draining).await,
        Arrival::BeyondLimit => drop(timeout(2 * BEYOND_LIMIT_TIME, connection).await),
    }
}

/// Answers one request of a connection.
///
/// # Errors
/// When the caller goes away. The connection then ends.
async fn answer(
    request: Request<Incoming>,
    router: Router,
    arrival: Arrival,
    busy: Busy,
    must_close: bool,
    socket: Socket,
) -> io::Result<Response> {
    let version = request.version();
    let (mut parts, body) = request.into_parts();
    parts.extensions.insert(arrival);
    let body = Body::new(DrainedBody::new(&parts.headers, body));
    let answered = router.oneshot(Request::from_parts(parts, body));
    let response = if version <= Version::HTTP_11 {
        tokio::select! {
            biased;
            response = answered => response,
            () = socket.until_gone(version == Version::HTTP_11) => {
                return Err(io::ErrorKind::ConnectionAborted.into());
            }
        }
    } else {
        answered.await
    };
    let mut response = response.unwrap_or_else(|never| match never {});
    if must_close && version <= Version::HTTP_11 {
        response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
    }
    Ok(busy.finish(response))
}

/// Serves a connection until either side ends it, the caller idles or takes an answer too slowly, or the
/// service drains.
async fn supervise<C, E>(
    connection: C,
    activity: Arc<Activity>,
    times: TimeLimits,
    mut draining: watch::Receiver<bool>,
) where
    C: hyper_util::server::graceful::GracefulConnection<Error = E> + Future<Output = Result<(), E>>,
    E: std::fmt::Display,
{
    tokio::pin!(connection);
    // hyper's own timer does not run before the first bytes show whether the connection is HTTP/1 or HTTP/2,
    // nor between the requests of HTTP/2. The timer of this loop always runs.
    let mut idle_limit = times.header;
    let mut is_draining = false;
    let mut idle_since = Instant::now();
    let mut seen = activity.count();
    let mut check = interval(times.check_interval());
    // The latest end of a connection that is being closed.
    let mut end: Option<Instant> = None;
    loop {
        tokio::select! {
            biased;
            result = &mut connection => {
                if let Err(error) = result {
                    tracing::debug!(%error, "connection ended");
                }
                return;
            }
            _ = check.tick() => {
                if activity.is_too_slow(times.write) {
                    tracing::debug!("the caller takes its answer too slowly");
                    return;
                }
                if end.is_some_and(|end| Instant::now() >= end) {
                    return;
                }
            }
            Ok(()) = draining.changed(), if !is_draining => {
                is_draining = true;
                idle_limit = IDLE_GRACE;
                idle_since = Instant::now();
            }
            () = sleep_until(idle_since + idle_limit), if end.is_none() => {
                let now = activity.count();
                let is_idle = now == seen && !activity.is_busy();
                if is_idle || is_draining {
                    // The connection answers the requests in progress, reads no further request, and closes.
                    connection.as_mut().graceful_shutdown();
                    let far = Duration::from_secs(u64::from(u32::MAX));
                    end = Some(Instant::now() + times.last(&activity).unwrap_or(far));
                }
                seen = now;
                idle_since = Instant::now();
            }
        }
    }
}

/// Counts the requests of one connection.
#[derive(Debug, Default)]
struct Activity {
    begun: AtomicUsize,
    running: AtomicUsize,
    streams: AtomicBool,
    endless: AtomicBool,
    /// The answers that are being sent.
    speeds: Mutex<Vec<Weak<ReadingSpeed>>>,
}

impl Activity {
    fn count(&self) -> usize {
        self.begun.load(Ordering::Relaxed)
    }

    fn is_busy(&self) -> bool {
        self.running.load(Ordering::Relaxed) > 0
    }

    /// Whether an answer of the connection was, or is, one that may take any time.
    fn is_endless(&self) -> bool {
        self.endless.load(Ordering::Relaxed)
    }

    /// Whether an answer of the connection was, or is, a stream.
    fn streams(&self) -> bool {
        self.streams.load(Ordering::Relaxed)
    }

    /// Whether the caller takes one of its answers too slowly.
    fn is_too_slow(&self, write_timeout: Duration) -> bool {
        let mut speeds = self.speeds.lock().unwrap_or_else(PoisonError::into_inner);
        speeds.retain(|speed| speed.strong_count() > 0);
        speeds.iter().filter_map(Weak::upgrade).any(|speed| speed.is_too_slow(write_timeout))
    }
}

/// Counts a request as running, until this value is dropped.
struct Busy(Arc<Activity>);

impl Busy {
    fn new(activity: &Arc<Activity>) -> Self {
        activity.begun.fetch_add(1, Ordering::Relaxed);
        activity.running.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(activity))
    }

    /// Counts the request as answered. Of its answer only the head is known; its body tells its speed from
    /// now on.
    fn finish(self, mut response: Response) -> Response {
        match response.extensions().get() {
            Some(AllowedTime::OfStream) => self.0.streams.store(true, Ordering::Relaxed),
            Some(AllowedTime::Any) => self.0.endless.store(true, Ordering::Relaxed),
            None => {}
        }
        let held = response.extensions_mut().remove();
        response.map(|body| {
            let measured = MeasuredBody::new(body, held);
            let mut speeds = self.0.speeds.lock().unwrap_or_else(PoisonError::into_inner);
            if speeds.len() > 2 * STREAMS as usize {
                speeds.retain(|speed| speed.strong_count() > 0);
            }
            speeds.push(Arc::downgrade(measured.speed()));
            Body::new(measured)
        })
    }
}

impl Drop for Busy {
    fn drop(&mut self) {
        self.0.running.fetch_sub(1, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;

    use super::*;
    use crate::config::Cli;

    #[test]
    fn a_connection_that_streams_stays_open_until_the_deadline_of_streams() {
        let settings = Cli::parse_from(["toolpathd", "--deadline-s", "30", "--stream-deadline-s", "3600"]);
        let times = TimeLimits::new(&settings.settings);
        let activity = Arc::new(Activity::default());
        Busy::new(&activity).finish(Response::default());
        assert_eq!(times.last(&activity), Some(Duration::from_secs(340)));

        let mut streamed = Response::default();
        streamed.extensions_mut().insert(AllowedTime::OfStream);
        Busy::new(&activity).finish(streamed);
        assert!(!activity.is_busy());
        assert_eq!(times.last(&activity), Some(Duration::from_secs(3900)));

        let mut endless = Response::default();
        endless.extensions_mut().insert(AllowedTime::Any);
        Busy::new(&activity).finish(endless);
        assert_eq!(times.last(&activity), None);
    }
}
