//! The socket of one connection, for two users: hyper reads and writes it, and [`Socket::until_gone`] watches
//! whether the caller is still there. A caller that has gone must not keep a worker busy; hyper alone stops
//! the handler of such a caller only when no byte follows its request, and then also stops the handler of a
//! caller that has only ended its own direction.
//!
//! # Method
//! hyper notices the end of a connection only when it has read all bytes before the end, and it reads no
//! bytes that follow a request whose answer is being computed. The system tells of the end earlier, as a
//! state of the socket. That state is the same for a caller who has closed the connection and for one who has
//! only ended its own direction and waits for the answer. Only a caller who has closed refuses further bytes.
//! So the watch sends the interim answer `100 Continue`, which HTTP/1.1 permits before any answer (RFC 9110,
//! section 15.2), and looks whether the connection is reset. Without an end of the caller's direction no
//! interim answer is sent.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::task::{Context, Poll, ready};
use std::time::Duration;

use axum::body::Bytes;
use futures_util::FutureExt;
use hyper::body::Buf;
use rustix::net::Shutdown;
use tokio::io::{AsyncRead, AsyncWrite, Interest, ReadBuf};
use tokio::net::TcpStream;
use tokio::time::{Instant, sleep};

use super::parser_refusal::explained;

/// Time after which a request is watched. Most requests are answered earlier.
const WATCHED_AFTER: Duration = Duration::from_millis(40);

/// Time between two checks of the state of a socket.
const CHECK_INTERVAL: Duration = Duration::from_millis(20);

/// Time between two interim answers. A caller that has ended its own direction may close the connection
/// later.
const PROBE_INTERVAL: Duration = Duration::from_secs(5);

const PROBE: &[u8] = b"HTTP/1.1 100 Continue\r\n\r\n";

/// A socket. Clones are the same socket.
#[derive(Debug, Clone)]
pub struct Socket(Arc<Inner>);

/// The side of a socket that hyper reads and writes. A refusal of hyper's parser goes out as [`explained`].
#[derive(Debug)]
pub struct HyperIo {
    socket: Socket,
    /// The bytes of a refusal that are still to be written.
    refusal: Bytes,
}

#[derive(Debug)]
struct Inner {
    stream: TcpStream,
    /// Whether the last write left bytes behind. Then hyper holds a part of an answer.
    is_blocked: AtomicBool,
}

impl Socket {
    pub fn new(stream: TcpStream) -> Self {
        Self(Arc::new(Inner { stream, is_blocked: AtomicBool::new(false) }))
    }

    /// The side for hyper.
    pub fn for_hyper(&self) -> HyperIo {
        HyperIo { socket: self.clone(), refusal: Bytes::new() }
    }

    /// Waits until the caller has closed the connection. Ends never while the caller is there.
    ///
    /// `may_probe` permits interim answers. The caller of this function must have an answer under way of
    /// which no byte is written yet.
    pub async fn until_gone(&self, may_probe: bool) {
        let mut next_probe = Instant::now();
        sleep(WATCHED_AFTER).await;
        loop {
            let interest = Interest::READABLE | Interest::WRITABLE;
            if let Some(state) = self.0.stream.ready(interest).now_or_never() {
                let Ok(state) = state else { return };
                if state.is_write_closed() {
                    return;
                }
                let now = Instant::now();
                if state.is_read_closed() && may_probe && now >= next_probe && self.probe().is_err() {
                    return;
                }
                if state.is_read_closed() && now >= next_probe {
                    next_probe = now + PROBE_INTERVAL;
                }
            }
            sleep(CHECK_INTERVAL).await;
        }
    }

    /// Sends an interim answer, unless an earlier answer is still being written.
    fn probe(&self) -> io::Result<()> {
        if self.0.is_blocked.load(Ordering::Relaxed) {
            return Ok(());
        }
        match self.0.stream.try_write(PROBE) {
            Ok(written) if written < PROBE.len() => Err(io::ErrorKind::WriteZero.into()),
            Err(error) if error.kind() == io::ErrorKind::WouldBlock => Ok(()),
            other => other.map(|_| ()),
        }
    }

    /// Writes by `write` once the socket takes bytes. `asked` is the number of bytes that `write` offers.
    fn poll_write_by(
        &self,
        context: &mut Context<'_>,
        asked: usize,
        write: impl Fn(&TcpStream) -> io::Result<usize>,
    ) -> Poll<io::Result<usize>> {
        let Inner { stream, is_blocked } = &*self.0;
        is_blocked.store(true, Ordering::Relaxed);
        loop {
            ready!(stream.poll_write_ready(context))?;
            match write(stream) {
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                written => {
                    is_blocked.store(!matches!(written, Ok(bytes) if bytes == asked), Ordering::Relaxed);
                    return Poll::Ready(written);
                }
            }
        }
    }
}

impl HyperIo {
    fn write_refusal(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        while !self.refusal.is_empty() {
            let Self { socket, refusal } = self;
            let written = socket.poll_write_by(context, refusal.len(), |stream| stream.try_write(refusal));
            self.refusal.advance(ready!(written)?);
        }
        Poll::Ready(Ok(()))
    }
}

impl AsyncRead for HyperIo {
    fn poll_read(
        self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        let stream = &self.socket.0.stream;
        loop {
            ready!(stream.poll_read_ready(context))?;
            match stream.try_read(buffer.initialize_unfilled()) {
                Ok(bytes) => {
                    buffer.advance(bytes);
                    return Poll::Ready(Ok(()));
                }
                Err(error) if error.kind() == io::ErrorKind::WouldBlock => {}
                Err(error) => return Poll::Ready(Err(error)),
            }
        }
    }
}

impl AsyncWrite for HyperIo {
    fn poll_write(self: Pin<&mut Self>, context: &mut Context<'_>, bytes: &[u8]) -> Poll<io::Result<usize>> {
        self.poll_write_vectored(context, &[IoSlice::new(bytes)])
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        ready!(self.write_refusal(context))?;
        let asked = parts.iter().map(|part| part.len()).sum();
        // A refusal of the parser has no body, so it comes in one part.
        if let [only] = parts
            && let Some(refusal) = explained(only)
        {
            // The next flush sends it.
            self.refusal = refusal;
            return Poll::Ready(Ok(asked));
        }
        self.socket.poll_write_by(context, asked, |stream| stream.try_write_vectored(parts))
    }

    fn is_write_vectored(&self) -> bool {
        true
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        self.write_refusal(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.write_refusal(context))?;
        match rustix::net::shutdown(&self.socket.0.stream, Shutdown::Write) {
            Err(error) if error != rustix::io::Errno::NOTCONN => Poll::Ready(Err(error.into())),
            _ => Poll::Ready(Ok(())),
        }
    }
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};
    use tokio::net::TcpListener;
    use tokio::time::timeout;

    use super::*;

    async fn pair() -> (Socket, TcpStream) {
        let listener = TcpListener::bind("127.0.0.1:0").await.expect("a port");
        let caller = TcpStream::connect(listener.local_addr().expect("an address")).await.expect("connected");
        (Socket::new(listener.accept().await.expect("a connection").0), caller)
    }

    const SOON: Duration = Duration::from_millis(100);

    /// Longer than any wait on a busy machine.
    const NEVER: Duration = Duration::from_secs(20);

    /// Most tries. A busy machine delays some of them, and a watch that is slow of itself is slow in all.
    const TRIES: usize = 30;

    const _: () = assert!(
        WATCHED_AFTER.as_millis() + CHECK_INTERVAL.as_millis() < SOON.as_millis(),
        "a closed connection is found at the second check at the latest"
    );

    #[tokio::test]
    async fn a_closed_connection_is_noticed_behind_unread_bytes() {
        for _ in 0..TRIES {
            let (socket, mut caller) = pair().await;
            caller.write_all(&[b'x'; 5000]).await.expect("written");
            assert!(timeout(SOON, socket.until_gone(true)).await.is_err());
            drop(caller);
            let closed = Instant::now();
            assert_eq!(timeout(NEVER, socket.until_gone(true)).await, Ok(()));
            if closed.elapsed() <= SOON {
                return;
            }
        }
        panic!("a closed connection was never noticed within {SOON:?}");
    }

    #[tokio::test]
    async fn a_caller_that_ends_its_own_direction_is_still_there() {
        let (socket, mut caller) = pair().await;
        caller.shutdown().await.expect("ended");
        // The probe is sent at the first check, which a busy machine may delay.
        let mut interim = [0; PROBE.len()];
        tokio::select! {
            () = socket.until_gone(true) => panic!("the caller is there"),
            read = timeout(NEVER, caller.read_exact(&mut interim)) => {
                read.expect("an interim answer in time").expect("an interim answer");
            }
        }
        assert!(timeout(2 * SOON, socket.until_gone(true)).await.is_err());
        assert_eq!(interim, PROBE);
        assert!(timeout(SOON, socket.until_gone(false)).await.is_err());
    }
}
