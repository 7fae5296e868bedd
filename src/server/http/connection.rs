//! Serves one connection, with limits on the time that the caller may take.

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

use super::linger::Lingering;
use super::marks::{Arrival, Endless, Streamed};
use super::pace::{Pace, Paced};
use super::refusal::Explained;
use super::socket::Socket;
use crate::config::Settings;

/// How long an idle connection stays open after the signal, because a request may already be on its way.
const IDLE_GRACE: Duration = Duration::from_millis(500);

/// How long a caller may take, beyond the times for waiting and computing, to read the last answer of a
/// connection that is being closed.
const LAST_ANSWER_LIMIT: Duration = Duration::from_secs(300);

/// Time within which a connection on a spare place must send the head of a request. It is closed after twice
/// this time.
const SPARE_LIMIT: Duration = Duration::from_secs(1);

/// Largest head of a request.
const HEAD_BYTES: u32 = 96 * 1024;

/// Bytes that the service buffers for a stream of HTTP/2, and for a whole connection, while no handler reads
/// them.
const READ_AHEAD_BYTES: u32 = 64 * 1024;

/// Most requests under way on one connection of HTTP/2.
const STREAMS: u32 = 100;

/// Size of the write buffer of one request of HTTP/2.
const WRITE_AHEAD_BYTES: usize = 64 * 1024;

/// Time limits of a connection.
#[derive(Debug, Clone, Copy)]
pub struct Patience {
    /// For the head of a request to arrive.
    header: Duration,
    /// For the caller to take the next byte of an answer.
    write: Duration,
    /// For the last answer of a connection that is being closed, its computation included.
    last_answer: Duration,
    /// The same for an answer that is streamed while its program arrives.
    last_stream: Duration,
}

impl Patience {
    pub fn new(settings: &Settings) -> Self {
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

    /// How often it is looked whether an answer goes out too slowly.
    fn look_interval(&self) -> Duration {
        (self.write / 8).clamp(Duration::from_millis(10), Duration::from_secs(2))
    }
}

/// Serves one connection until either side ends it.
pub async fn connection(
    stream: TcpStream,
    router: Router,
    arrival: Arrival,
    patience: Patience,
    draining: watch::Receiver<bool>,
) {
    let activity = Arc::new(Activity::default());
    let socket = Socket::new(stream);
    let service = {
        let (activity, closing, socket) = (Arc::clone(&activity), draining.clone(), socket.clone());
        service_fn(move |request: Request<Incoming>| {
            let busy = Busy::new(&activity);
            let must_close = *closing.borrow() || arrival == Arrival::Spare;
            answer(request, router.clone(), arrival, busy, must_close, socket.clone())
        })
    };
    let header_limit = match arrival {
        Arrival::Regular => patience.header,
        Arrival::Spare => patience.header.min(SPARE_LIMIT),
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
    stream.set_write_timeout(Some(patience.write));
    let connection = builder.serve_connection(TokioIo::new(Explained::new(Box::pin(stream))), service);
    match arrival {
        Arrival::Regular => supervise(connection, activity, patience, draining).await,
        Arrival::Spare => drop(timeout(2 * SPARE_LIMIT, connection).await),
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
    let body = Body::new(Lingering::new(&parts.headers, body));
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
    patience: Patience,
    mut draining: watch::Receiver<bool>,
) where
    C: hyper_util::server::graceful::GracefulConnection<Error = E> + Future<Output = Result<(), E>>,
    E: std::fmt::Display,
{
    tokio::pin!(connection);
    // hyper's own timer does not run before the first bytes show whether the connection is HTTP/1 or HTTP/2,
    // nor between the requests of HTTP/2. The timer of this loop always runs.
    let mut idle_limit = patience.header;
    let mut is_draining = false;
    let mut idle_since = Instant::now();
    let mut seen = activity.count();
    let mut look = interval(patience.look_interval());
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
            _ = look.tick() => {
                if activity.is_too_slow(patience.write) {
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
                    end = Some(Instant::now() + patience.last(&activity).unwrap_or(far));
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
    paces: Mutex<Vec<Weak<Pace>>>,
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
        let mut paces = self.paces.lock().unwrap_or_else(PoisonError::into_inner);
        paces.retain(|pace| pace.strong_count() > 0);
        paces.iter().filter_map(Weak::upgrade).any(|pace| pace.is_too_slow(write_timeout))
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

    /// Counts the request as answered. Of its answer only the head is known; its body tells its pace from now
    /// on.
    fn finish(self, mut response: Response) -> Response {
        if response.extensions().get::<Streamed>().is_some() {
            self.0.streams.store(true, Ordering::Relaxed);
        }
        if response.extensions().get::<Endless>().is_some() {
            self.0.endless.store(true, Ordering::Relaxed);
        }
        let share = response.extensions_mut().remove();
        response.map(|body| {
            let paced = Paced::new(body, share);
            let mut paces = self.0.paces.lock().unwrap_or_else(PoisonError::into_inner);
            if paces.len() > 2 * STREAMS as usize {
                paces.retain(|pace| pace.strong_count() > 0);
            }
            paces.push(Arc::downgrade(paced.pace()));
            Body::new(paced)
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
        let patience = Patience::new(&settings.settings);
        let activity = Arc::new(Activity::default());
        Busy::new(&activity).finish(Response::default());
        assert_eq!(patience.last(&activity), Some(Duration::from_secs(340)));

        let mut streamed = Response::default();
        streamed.extensions_mut().insert(Streamed);
        Busy::new(&activity).finish(streamed);
        assert!(!activity.is_busy());
        assert_eq!(patience.last(&activity), Some(Duration::from_secs(3900)));

        let mut endless = Response::default();
        endless.extensions_mut().insert(Endless);
        Busy::new(&activity).finish(endless);
        assert_eq!(patience.last(&activity), None);
    }
}
