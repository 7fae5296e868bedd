//! Adds a problem document to the answer if the HTTP parser refuses a request.
//!
//! hyper's parser refuses a request whose head it cannot read, or whose head is too large. No other code of
//! the service sees such a request: hyper itself writes a status without a body, and closes the connection.
//! [`Explained`] watches the bytes that go to the caller, and replaces such an answer by an answer with a
//! problem document.

use std::io::{self, IoSlice};
use std::pin::Pin;
use std::task::{Context, Poll, ready};

use axum::http::StatusCode;
use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};

use crate::http::ENGINE_VERSION;
use crate::http::error::{ApiError, PROBLEM_JSON};
use crate::http::request::request_id::{self, RequestId};
use crate::http::service::guard::POLICY;

/// A connection on which every refusal of the parser gets a problem as its body.
pub struct Explained<S> {
    stream: S,
    /// The bytes of a refusal that are still to be written.
    refusal: Vec<u8>,
}

impl<S> Explained<S> {
    pub fn new(stream: S) -> Self {
        Self { stream, refusal: Vec::new() }
    }
}

/// The answer with a problem that replaces `head`. `None` unless `head` is a refusal by the parser itself.
fn explained(head: &[u8]) -> Option<Vec<u8>> {
    let text = std::str::from_utf8(head).ok()?;
    let status = text.strip_prefix("HTTP/1.1 ")?.get(..3)?;
    let status = StatusCode::from_bytes(status.as_bytes()).ok()?;
    // Every answer of a handler or a layer has the header with the request's id.
    let is_bare = text.ends_with("\r\n\r\n") && !text.contains(request_id::HEADER.as_str());
    if !status.is_client_error() || !is_bare {
        return None;
    }
    let id = RequestId::generate();
    let problem = ApiError::from_status(status).problem(id.as_str());
    let body = serde_json::to_string(&problem).ok()?;
    let id_header = request_id::HEADER;
    Some(
        format!(
            "HTTP/1.1 {status}\r\ncontent-type: {PROBLEM_JSON}\r\ncontent-length: {}\r\nconnection: close\r\n\
             cache-control: no-store\r\nx-content-type-options: nosniff\r\n\
             content-security-policy: {POLICY}\r\nreferrer-policy: no-referrer\r\n{id_header}: {}\r\nx-engine-version: {ENGINE_VERSION}\r\n\r\n{body}",
            body.len(),
            id.as_str(),
        )
        .into_bytes(),
    )
}

impl<S: AsyncWrite + Unpin> Explained<S> {
    fn write_refusal(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        while !self.refusal.is_empty() {
            let written = ready!(Pin::new(&mut self.stream).poll_write(context, &self.refusal))?;
            if written == 0 {
                return Poll::Ready(Err(io::ErrorKind::WriteZero.into()));
            }
            self.refusal.drain(..written);
        }
        Poll::Ready(Ok(()))
    }
}

impl<S: AsyncWrite + Unpin> AsyncWrite for Explained<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        bytes: &[u8],
    ) -> Poll<io::Result<usize>> {
        ready!(self.write_refusal(context))?;
        if let Some(refusal) = explained(bytes) {
            // The next flush sends it.
            self.refusal = refusal;
            return Poll::Ready(Ok(bytes.len()));
        }
        Pin::new(&mut self.stream).poll_write(context, bytes)
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        parts: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        // A refusal of the parser has no body, so it comes in one part.
        if let [only] = parts {
            return self.poll_write(context, only);
        }
        ready!(self.write_refusal(context))?;
        Pin::new(&mut self.stream).poll_write_vectored(context, parts)
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.write_refusal(context))?;
        Pin::new(&mut self.stream).poll_flush(context)
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.write_refusal(context))?;
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for Explained<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_bare_refusals_are_rewritten() {
        let bare = "HTTP/1.1 431 Request Header Fields Too Large\r\ncontent-length: 0\r\n\r\n";
        let answer = String::from_utf8(explained(bare.as_bytes()).expect("rewritten")).expect("UTF-8");
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head");
        assert!(
            head.starts_with("HTTP/1.1 431 ") && head.contains(&format!("content-length: {}", body.len()))
        );
        let problem: serde_json::Value = serde_json::from_str(body).expect("JSON");
        assert_eq!(problem["code"], "headers_too_large");
        assert!(head.contains(problem["request_id"].as_str().expect("an id")));
        for other in [
            "HTTP/1.1 200 OK\r\n\r\n",
            "HTTP/1.1 404 Not Found\r\nx-request-id: 7\r\n\r\n",
            "HTTP/1.1 400 Bad Request\r\n",
            "HTTP/1.1 4",
            "{}",
        ] {
            assert_eq!(explained(other.as_bytes()), None, "{other}");
        }
    }
}
