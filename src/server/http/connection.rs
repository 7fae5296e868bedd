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
use std::sync::atomic::{AtomicUsize, Ordering};
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
use hyper_util::server::graceful::GracefulConnection;
use tokio::net::TcpStream;
use tokio::sync::watch;
use tokio::time::{Instant, interval, sleep, timeout};
use tower::ServiceExt;

use super::request::arrival::Arrival;
use super::service::metrics::Metrics;
use crate::config::Settings;
use drained_body::DrainedBody;
use limit::ConnectionLimit;
use reading_speed::{MeasuredBody, ReadingSpeed};
use socket::Socket;

/// How long an idle connection stays open after the signal, because a request may already be on its way.
const IDLE_GRACE: Duration = Duration::from_millis(500);

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
        let times = TimeLimits { header: settings.header_timeout_s, write: settings.write_timeout_s };
        Self { limit: ConnectionLimit::new(settings), times, metrics }
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
    /// For the caller to take the next piece of an answer.
    write: Duration,
}

impl TimeLimits {
    /// How often it is checked whether a connection idles, or an answer waits for its caller for too long.
    fn check_interval(&self) -> Duration {
        (self.header.min(self.write) / 8).clamp(Duration::from_millis(10), Duration::from_secs(2))
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
    let io = socket.for_hyper();
    let service = {
        let (activity, closing, socket) = (Arc::clone(&activity), draining.clone(), socket);
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
    let connection = builder.serve_connection(TokioIo::new(io), service);
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
    C: GracefulConnection<Error = E> + Future<Output = Result<(), E>>,
    E: std::fmt::Display,
{
    let drained = async {
        // The sender lives as long as the service.
        let _ = draining.wait_for(|is_draining| *is_draining).await;
        sleep(IDLE_GRACE).await;
    };
    tokio::pin!(connection, drained);
    // hyper's own timer does not run before the first bytes show whether the connection is HTTP/1 or HTTP/2,
    // nor between the requests of HTTP/2. The timer of this loop always runs.
    let mut check = interval(times.check_interval());
    let mut idle_since = Instant::now();
    let mut seen = activity.begun();
    let mut is_closing = false;
    loop {
        let must_close = tokio::select! {
            biased;
            result = &mut connection => {
                if let Err(error) = result {
                    tracing::debug!(%error, "connection ended");
                }
                return;
            }
            () = &mut drained, if !is_closing => true,
            now = check.tick() => {
                if activity.is_too_slow(times.write) {
                    tracing::debug!("the caller takes its answer too slowly");
                    return;
                }
                if activity.is_busy() || activity.begun() != seen {
                    seen = activity.begun();
                    idle_since = now;
                }
                now >= idle_since + times.header
            }
        };
        if must_close && !is_closing {
            // The connection answers the requests in progress, reads no further request, and closes.
            connection.as_mut().graceful_shutdown();
            is_closing = true;
        }
    }
}

/// The requests of one connection.
#[derive(Debug, Default)]
struct Activity {
    begun: AtomicUsize,
    running: AtomicUsize,
    /// The answers that are being sent.
    speeds: Mutex<Vec<Weak<ReadingSpeed>>>,
}

impl Activity {
    fn begun(&self) -> usize {
        self.begun.load(Ordering::Relaxed)
    }

    /// Whether a request waits for its answer.
    fn is_busy(&self) -> bool {
        self.running.load(Ordering::Relaxed) > 0
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

    /// Counts the request as answered. Of its answer only the head is known; its body tells its reading speed
    /// from now on.
    fn finish(self, mut response: Response) -> Response {
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
