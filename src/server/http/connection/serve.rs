//! Accepts connections. A shutdown waits for the requests under way, but not longer than a limit.

use std::io;
use std::net::SocketAddr;
use std::time::Duration;

use axum::Router;
use tokio::net::{TcpListener, TcpStream};
use tokio::sync::watch;
use tokio::task::JoinSet;
use tokio::time::{Instant, sleep, timeout};

use super::Connections;
use super::connection;
use super::limit::BeyondLimit;
use crate::http::request::arrival::Arrival;

/// How long the service still accepts connections after the signal. A load balancer may still send callers
/// here, and probes must be able to read the 503 of `/readyz`.
const LAST_CALL: Duration = Duration::from_millis(500);

/// Longest time from the signal to the end of the program. Supervisors commonly kill a program after 30 s.
const DRAIN_LIMIT: Duration = Duration::from_secs(28);

/// The part of that time in which the last answers are written.
const LAST_WRITES: Duration = Duration::from_secs(2);

/// Pause after a failed accept. The usual reason is that no file descriptor is free, and that does not change
/// at once.
const ACCEPT_PAUSE: Duration = Duration::from_millis(50);

/// Serves `router` until `stop` resolves. Then the service drains: it answers every request that has reached
/// this process, within 28 s. `drain` begins the shutdown of everything else, which must be over at the given
/// time.
///
/// # Errors
/// When the listener cannot be used.
pub async fn serve(
    listener: TcpListener,
    router: Router,
    connections: &Connections,
    stop: impl Future<Output = ()>,
    drain: impl FnOnce(std::time::Instant),
) -> io::Result<()> {
    let (announce, draining) = watch::channel(false);
    let open = JoinSet::new();
    let mut acceptor = Acceptor { router, connections, draining, open, beyond: BeyondLimit::default() };
    tokio::pin!(stop);
    loop {
        tokio::select! {
            biased;
            () = &mut stop => break,
            accepted = listener.accept() => acceptor.accept(accepted).await,
            Some(_) = acceptor.open.join_next() => {}
        }
    }

    let limit = Instant::now() + DRAIN_LIMIT;
    tracing::info!("draining");
    drain((limit - LAST_WRITES).into());
    let _ = announce.send(true);
    let last_call = sleep(LAST_CALL);
    tokio::pin!(last_call);
    loop {
        tokio::select! {
            accepted = listener.accept() => acceptor.accept(accepted).await,
            () = &mut last_call => break,
        }
    }
    // The kernel may have completed connections that the runtime has not heard of yet.
    let listener = listener.into_std()?;
    while let Ok((stream, address)) = listener.accept() {
        if stream.set_nonblocking(true).is_ok() {
            acceptor.accept(TcpStream::from_std(stream).map(|stream| (stream, address))).await;
        }
    }
    drop(listener);

    let mut open = acceptor.open;
    let all_closed = async { while open.join_next().await.is_some() {} };
    if timeout(limit - Instant::now(), all_closed).await.is_err() {
        tracing::warn!(connections = open.len(), "connections were still open at the end");
    }
    tracing::info!("stopped");
    Ok(())
}

/// Opens connections, and holds those that are open.
struct Acceptor<'a> {
    router: Router,
    connections: &'a Connections,
    draining: watch::Receiver<bool>,
    open: JoinSet<()>,
    beyond: BeyondLimit,
}

impl Acceptor<'_> {
    async fn accept(&mut self, accepted: io::Result<(TcpStream, SocketAddr)>) {
        let (stream, address) = match accepted {
            Ok(accepted) => accepted,
            Err(error) => {
                tracing::warn!(%error, "accept failed");
                sleep(ACCEPT_PAUSE).await;
                return;
            }
        };
        // The service writes whole answers, so waiting to fill a packet would only delay them.
        let _ = stream.set_nodelay(true);
        let admitted = self.connections.limit.take(address.ip());
        let arrival = if admitted.is_some() { Arrival::Regular } else { Arrival::BeyondLimit };
        let connection =
            connection(stream, self.router.clone(), arrival, self.connections.times, self.draining.clone());
        let task = self.open.spawn(async move {
            connection.await;
            drop(admitted);
        });
        if arrival == Arrival::BeyondLimit {
            self.connections.metrics.connection_refused();
            tracing::debug!("a connection too many");
            self.beyond.add(task);
        }
    }
}
