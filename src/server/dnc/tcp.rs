//! A TCP connection to a device server, which passes the characters on to a serial line.
//!
//! A write that returns is no delivery: the characters may wait in the system, in the network or in the
//! device server. After the last character the connection is closed for writing. A peer that closes its
//! side too has received everything.

use std::io::{self, Read, Write};
use std::net::{Shutdown, TcpStream, ToSocketAddrs};
use std::time::{Duration, Instant};

use super::line::{Line, more, wait_for, without_blocking};
use super::sender::Delivery;
use super::settings::Settings;

/// Longest time to connect to one address.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(10);

/// How long the peer may take to close its side, where the patience with it does not end before. Most device
/// servers keep the connection open, so a longer wait would only delay the report.
const CLOSE_TIMEOUT: Duration = Duration::from_secs(5);

/// An open connection.
#[derive(Debug)]
pub struct Tcp {
    stream: TcpStream,
    close_timeout: Duration,
}

impl Tcp {
    /// # Errors
    /// When the name is unknown, or no address of it takes the connection.
    pub fn open(address: &str, settings: &Settings) -> io::Result<Self> {
        let mut last = io::Error::new(io::ErrorKind::NotFound, "the name has no address");
        for address in address.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
                Ok(stream) => {
                    // Short writes are meant: each waits for the control.
                    stream.set_nodelay(true)?;
                    stream.set_nonblocking(true)?;
                    return Ok(Self { stream, close_timeout: CLOSE_TIMEOUT.min(settings.patience) });
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }
}

impl Line for Tcp {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        more(self.stream.read(buffer))
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        without_blocking(self.stream.write(bytes))
    }

    fn queued(&self) -> io::Result<usize> {
        Ok(0)
    }

    fn wait(&self, for_room: bool, time: Duration) -> io::Result<()> {
        wait_for(&self.stream, for_room, time)
    }

    fn discard(&mut self) -> io::Result<()> {
        Ok(())
    }

    fn finish(&mut self) -> io::Result<Delivery> {
        self.stream.shutdown(Shutdown::Write)?;
        let limit = Instant::now() + self.close_timeout;
        let mut answer = [0; 256];
        loop {
            match self.stream.read(&mut answer) {
                Ok(0) => return Ok(Delivery::PeerClosed),
                outcome => without_blocking(outcome)?,
            };
            let left = limit.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return Ok(Delivery::HandedOver);
            }
            wait_for(&self.stream, false, left)?;
        }
    }
}
