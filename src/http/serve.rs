//! Accepts and serves connections with time limits. A shutdown waits for the requests under way, but not
//! longer than a limit.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

use axum::Router;
use axum::body::Body;
use axum::http::{HeaderValue, Request, Version, header};
use axum::response::Response;
use hyper::service::service_fn;
use hyper_util::rt::{TokioExecutor, TokioIo, TokioTimer};
use hyper_util::server::conn::auto;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::{Semaphore, watch};
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep, sleep_until, timeout};
use tokio_io_timeout::TimeoutStream;
use tower::ServiceExt;

use super::App;
use super::linger::Lingering;
use super::program_stream::Streamed;
use super::refusal::Explained;
use crate::config::Settings;

/// How long the service still accepts connections after the signal. A load balancer may still send callers
/// here, and probes must be able to read the 503 of `/readyz`.
const LAST_CALL: Duration = Duration::from_millis(500);

/// How long an idle connection stays open after the signal, because a request may already be on its way.
const IDLE_GRACE: Duration = Duration::from_millis(500);

/// Longest time from the signal to the end of the program. Supervisors commonly kill a program after 30 s.
const DRAIN_LIMIT: Duration = Duration::from_secs(28);

/// Pause after a failed accept. The usual reason is that no file descriptor is free, and that does not change
/// at once.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// How long a caller may take, beyond the deadline of the computation, to read the last answer of a
/// connection that is being closed.
const LAST_ANSWER_LIMIT: Duration = Duration::from_secs(300);

/// Bytes that the service buffers for a connection while no handler reads them. The head of a request may
/// not be longer.
const READ_AHEAD_BYTES: u32 = 128 * 1024;

/// Serves `router` until `stop` resolves. Then the service drains: it answers every request that has reached
/// this process, within 28 s.
///
/// # Errors
/// When the listener cannot be used.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    app: &App,
    stop: impl Future<Output = ()>,
) -> io::Result<()> {
    let (announce, draining) = watch::channel(false);
    let connections = Acceptor { router, app, draining };
    let mut open = JoinSet::new();
    tokio::pin!(stop);
    loop {
        tokio::select! {
            biased;
            () = &mut stop => break,
            accepted = listener.accept() => connections.open(accepted, &mut open).await,
            Some(_) = open.join_next() => {}
        }
    }

    let limit = Instant::now() + DRAIN_LIMIT;
    tracing::info!("draining");
    app.drain();
    let _ = announce.send(true);
    let last_call = sleep(LAST_CALL);
    tokio::pin!(last_call);
    loop {
        tokio::select! {
            accepted = listener.accept() => connections.open(accepted, &mut open).await,
            () = &mut last_call => break,
        }
    }
    // The kernel may have completed connections that the runtime has not heard of yet.
    let listener = listener.into_std()?;
    while let Ok((stream, _)) = listener.accept() {
        if stream.set_nonblocking(true).is_ok() {
            let stream = TcpStream::from_std(stream).map(|stream| (stream, ()));
            connections.open(stream, &mut open).await;
        }
    }
    drop(listener);

    let all_closed = async { while open.join_next().await.is_some() {} };
    if timeout(limit - Instant::now(), all_closed).await.is_err() {
        tracing::warn!(connections = open.len(), "connections were still open at the end");
    }
    tracing::info!("stopped");
    Ok(())
}

/// Marks an answer that may take any time: a program goes out to a control meanwhile.
#[derive(Debug, Clone, Copy)]
pub struct Endless;

/// The limits of connections: how many may be open, and the time limits of each.
#[derive(Debug)]
pub struct Connections {
    places: Arc<Semaphore>,
    most: usize,
    patience: Patience,
}

/// Time limits of a connection.
#[derive(Debug, Clone, Copy)]
struct Patience {
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
    /// How long the last answer of a connection may take. `None` if it may take any time.
    fn last(&self, activity: &Activity) -> Option<Duration> {
        let longest =
            if activity.streams() { self.last_answer.max(self.last_stream) } else { self.last_answer };
        (!activity.is_endless()).then_some(longest)
    }
}

impl Connections {
    pub fn new(settings: &Settings) -> Self {
        let most = settings.connections as usize;
        let patience = Patience {
            header: settings.header_timeout_s,
            write: settings.write_timeout_s,
            last_answer: settings.deadline_s + LAST_ANSWER_LIMIT,
            last_stream: settings.stream_deadline_s + LAST_ANSWER_LIMIT,
        };
        Self { places: Arc::new(Semaphore::new(most)), most, patience }
    }

    /// Number of connections that are open now.
    pub fn open(&self) -> usize {
        self.most - self.places.available_permits()
    }
}

/// Opens connections. Holds the parts that all connections share.
struct Acceptor<'a> {
    router: Router,
    app: &'a App,
    draining: watch::Receiver<bool>,
}

impl Acceptor<'_> {
    async fn open<A>(&self, accepted: io::Result<(TcpStream, A)>, open: &mut JoinSet<()>) {
        let Connections { places, patience, .. } = &self.app.connections;
        match (accepted, Arc::clone(places).try_acquire_owned()) {
            (Ok((stream, _)), Ok(place)) => {
                // The service writes whole answers, so waiting to fill a packet would only delay them.
                let _ = stream.set_nodelay(true);
                let connection = connection(stream, self.router.clone(), *patience, self.draining.clone());
                open.spawn(async move {
                    connection.await;
                    drop(place);
                });
            }
            (Ok(_), Err(_)) => {
                self.app.metrics.connection_refused();
                tracing::debug!("a connection too many");
            }
            (Err(error), _) => {
                tracing::warn!(%error, "accept failed");
                sleep(ACCEPT_PAUSE).await;
            }
        }
    }
}

/// Serves one connection until either side ends it.
async fn connection(
    stream: TcpStream,
    router: Router,
    patience: Patience,
    mut draining: watch::Receiver<bool>,
) {
    let activity = Arc::new(Activity::default());
    let closing = draining.clone();
    let service = service_fn(|request: Request<hyper::body::Incoming>| {
        let busy = Busy::new(&activity);
        let router = router.clone();
        let closing = closing.clone();
        async move {
            let version = request.version();
            let (parts, body) = request.into_parts();
            let body = Body::new(Lingering::new(&parts.headers, body));
            let response = router.oneshot(Request::from_parts(parts, body)).await;
            response.map(|mut response| {
                busy.finish(&response);
                if *closing.borrow() && version <= Version::HTTP_11 {
                    response.headers_mut().insert(header::CONNECTION, HeaderValue::from_static("close"));
                }
                response
            })
        }
    });
    let mut builder = auto::Builder::new(TokioExecutor::new());
    builder
        .http1()
        .timer(TokioTimer::new())
        .header_read_timeout(patience.header)
        .max_buf_size(READ_AHEAD_BYTES as usize);
    builder
        .http2()
        .timer(TokioTimer::new())
        .keep_alive_interval(patience.header)
        .initial_stream_window_size(READ_AHEAD_BYTES)
        .initial_connection_window_size(4 * READ_AHEAD_BYTES)
        .max_header_list_size(READ_AHEAD_BYTES);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(patience.write));
    let connection = builder.serve_connection(TokioIo::new(Explained::new(Box::pin(stream))), service);
    tokio::pin!(connection);

    // hyper's own timer does not run before the first bytes show whether the connection is HTTP/1 or HTTP/2,
    // nor between the requests of HTTP/2. The timer of this loop always runs.
    let mut idle_limit = patience.header;
    let mut is_draining = false;
    let mut idle_since = Instant::now();
    let mut seen = activity.count();
    loop {
        tokio::select! {
            biased;
            result = &mut connection => {
                if let Err(error) = result {
                    tracing::debug!(%error, "connection ended");
                }
                return;
            }
            Ok(()) = draining.changed(), if !is_draining => {
                is_draining = true;
                idle_limit = IDLE_GRACE;
                idle_since = Instant::now();
            }
            () = sleep_until(idle_since + idle_limit) => {
                let now = activity.count();
                let is_idle = now == seen && !activity.is_busy();
                if is_idle || is_draining {
                    // The connection answers the requests in progress, reads no further request, and closes.
                    connection.as_mut().graceful_shutdown();
                    match patience.last(&activity) {
                        Some(longest) => drop(timeout(longest, &mut connection).await),
                        None => drop(connection.await),
                    }
                    return;
                }
                seen = now;
                idle_since = Instant::now();
            }
        }
    }
}

/// Counts the requests of one connection.
#[derive(Default)]
struct Activity {
    begun: AtomicUsize,
    running: AtomicUsize,
    streams: AtomicBool,
    endless: AtomicBool,
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
}

/// Counts a request as running, until this value is dropped.
struct Busy(Arc<Activity>);

impl Busy {
    fn new(activity: &Arc<Activity>) -> Self {
        activity.begun.fetch_add(1, Ordering::Relaxed);
        activity.running.fetch_add(1, Ordering::Relaxed);
        Self(Arc::clone(activity))
    }

    /// Counts the request as answered. Of its answer only the head is known.
    fn finish(self, response: &Response) {
        if response.extensions().get::<Streamed>().is_some() {
            self.0.streams.store(true, Ordering::Relaxed);
        }
        if response.extensions().get::<Endless>().is_some() {
            self.0.endless.store(true, Ordering::Relaxed);
        }
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
        let patience = Connections::new(&settings.settings).patience;
        let activity = Arc::new(Activity::default());
        Busy::new(&activity).finish(&Response::default());
        assert_eq!(patience.last(&activity), Some(Duration::from_secs(330)));

        let mut streamed = Response::default();
        streamed.extensions_mut().insert(Streamed);
        Busy::new(&activity).finish(&streamed);
        assert!(!activity.is_busy());
        assert_eq!(patience.last(&activity), Some(Duration::from_secs(3900)));

        let mut endless = Response::default();
        endless.extensions_mut().insert(Endless);
        Busy::new(&activity).finish(&endless);
        assert_eq!(patience.last(&activity), None);
    }
}
