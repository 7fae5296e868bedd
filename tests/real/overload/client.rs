//! An HTTP client that needs little processor time, because it runs on the same processors as the service.

use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_secs(30);

/// A client with one connection, which stays open between requests.
pub struct Client {
    stream: BufReader<TcpStream>,
}

impl Client {
    pub fn new(address: SocketAddr) -> Self {
        Self { stream: BufReader::new(connect(address)) }
    }

    /// Sends a `GET` and returns the status of the answer.
    pub fn get(&mut self, path: &str) -> u16 {
        self.send(&format!("GET {path} HTTP/1.1\r\nHost: here\r\n\r\n"))
    }

    /// Sends a `POST` and returns the status of the answer. Panics when a 503 has no `Retry-After`.
    pub fn post(&mut self, path: &str, body: &str) -> u16 {
        self.send(&format!(
            "POST {path} HTTP/1.1\r\nHost: here\r\nContent-Length: {}\r\n\r\n{body}",
            body.len()
        ))
    }

    fn send(&mut self, request: &str) -> u16 {
        self.stream.get_mut().write_all(request.as_bytes()).expect("sent");
        let mut head = String::new();
        while !head.ends_with("\r\n\r\n") {
            let read = self.stream.read_line(&mut head).expect("a line");
            assert!(read > 0, "the connection closed within the head {head:?}");
        }
        let head = head.to_ascii_lowercase();
        let header = |name: &str| {
            let value = head.split(name).nth(1)?.split("\r\n").next()?;
            value.trim().parse::<u64>().ok()
        };
        let length = header("content-length:").expect("a length");
        std::io::copy(&mut self.stream.by_ref().take(length), &mut std::io::sink()).expect("a body");
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        assert!(status != 503 || header("retry-after:").is_some(), "{head}");
        status
    }
}

/// A connection that has sent only a part of the head of a request.
pub fn partial_head(address: SocketAddr) -> TcpStream {
    let mut stream = connect(address);
    stream.write_all(b"POST /v1/surfaces/mill HTTP/1.1\r\nHost: here\r\nContent-").expect("sent");
    stream
}

/// Whether the service has closed the connection, perhaps after an answer.
pub fn is_closed(mut stream: &TcpStream) -> bool {
    stream.set_nonblocking(true).expect("set");
    let mut buffer = [0; 1024];
    loop {
        match stream.read(&mut buffer) {
            Ok(0) => return true,
            Ok(_) => {}
            Err(error) => return error.kind() != ErrorKind::WouldBlock,
        }
    }
}

fn connect(address: SocketAddr) -> TcpStream {
    let stream = TcpStream::connect(address).expect("a connection");
    stream.set_read_timeout(Some(PATIENCE)).expect("set");
    stream.set_nodelay(true).expect("set");
    stream
}
