//! Bodies of `multipart/form-data` (RFC 7578): a job in JSON, and files.

use std::convert::Infallible;
use std::future::Future;
use std::pin::pin;
use std::task::{Context, Poll, Waker};

use axum::body::Bytes;
use axum::http::{HeaderMap, header};
use multer::{Constraints, Multipart};

use crate::http::decode::files::{SentFile, SentFiles};
use crate::http::error::{ApiError, Code};

/// The media type.
pub const FORM_DATA: &str = "multipart/form-data";

/// The name of the part with the job.
const JOB: &str = "job";

/// The most files of a request.
const MOST_FILES: usize = 16;

/// The most bytes of a name.
const LONGEST_NAME: usize = 200;

/// The parts of a body.
pub struct Parts {
    /// The job in JSON. Absent where no part has the name `job`.
    pub job: Option<Bytes>,
    pub files: SentFiles,
}

/// The text between the parts of a body.
///
/// # Errors
/// `bad_request` where the header names none.
pub fn boundary(headers: &HeaderMap) -> Result<String, ApiError> {
    let value = headers.get(header::CONTENT_TYPE).and_then(|value| value.to_str().ok()).unwrap_or_default();
    multer::parse_boundary(value).map_err(|_| {
        bad(format!("`Content-Type: {FORM_DATA}` has no boundary: let the client write the header itself"))
    })
}

/// Divides a body at its boundary. The parts are copies.
///
/// # Errors
/// `bad_request` where the body is not of this form, has too many parts, or two of one name.
pub fn parts(body: Bytes, boundary: &str) -> Result<Parts, ApiError> {
    ready(read(body, boundary)).unwrap_or_else(|| Err(bad("the body ends before its last boundary")))
}

async fn read(body: Bytes, boundary: &str) -> Result<Parts, ApiError> {
    let stream = futures_util::stream::once(std::future::ready(Ok::<_, Infallible>(body)));
    let mut sent = Multipart::with_constraints(stream, boundary, Constraints::new());
    let (mut job, mut files) = (None, Vec::<SentFile>::new());
    while let Some(field) = sent.next_field().await.map_err(|error| unreadable(&error))? {
        let part = field.name().unwrap_or_default().to_owned();
        let file_name = field.file_name().map(str::to_owned);
        if part.is_empty() {
            return Err(bad("a part of the body has no name"));
        }
        if [&part, file_name.as_ref().unwrap_or(&part)].iter().any(|name| name.len() > LONGEST_NAME) {
            return Err(bad(format!("a part of the body has a name of over {LONGEST_NAME} bytes")));
        }
        let bytes = field.bytes().await.map_err(|error| unreadable(&error))?;
        if part == JOB {
            if job.replace(bytes).is_some() {
                return Err(bad("two parts of the body have the name `job`"));
            }
            continue;
        }
        let file = SentFile { part, file_name, bytes };
        if files.iter().any(|other| other.name() == file.name()) {
            return Err(bad(format!("two files have the name `{}`", file.name())));
        }
        files.push(file);
        if files.len() > MOST_FILES {
            return Err(bad(format!("there are more than {MOST_FILES} files")));
        }
    }
    Ok(Parts { job, files: SentFiles::new(files) })
}

/// The result of a future that waits for nothing; `None` where it would wait.
fn ready<T>(future: impl Future<Output = T>) -> Option<T> {
    match pin!(future).poll(&mut Context::from_waker(Waker::noop())) {
        Poll::Ready(result) => Some(result),
        Poll::Pending => None,
    }
}

fn unreadable(error: &multer::Error) -> ApiError {
    bad(format!("the body is not `{FORM_DATA}`: {error}"))
}

fn bad(detail: impl Into<String>) -> ApiError {
    ApiError::new(Code::BadRequest, detail)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(text: &str) -> Result<Parts, ApiError> {
        parts(text.replace('\n', "\r\n").into(), "X")
    }

    const TWO: &str = "--X\nContent-Disposition: form-data; name=\"job\"\n\n{}\n--X\n\
        Content-Disposition: form-data; name=\"part\"; filename=\"a.dxf\"\n\n0\nEOF\n--X--\n";

    #[test]
    fn job_and_files_are_told_apart_by_name() {
        let Parts { job, files } = body(TWO).unwrap_or_else(|_| panic!("legal"));
        assert_eq!(job.as_deref(), Some(b"{}".as_slice()));
        assert_eq!(&files.all()[0].bytes[..], b"0\r\nEOF");
        assert_eq!(files.position("a.dxf"), Some(0));
        assert_eq!(files.position("part"), Some(0));
        assert_eq!(files.position("b.dxf"), None);
    }

    #[test]
    fn a_body_that_is_cut_is_refused_wherever_it_is_cut() {
        let whole = TWO.replace('\n', "\r\n");
        // Behind the last boundary, line feeds may be absent.
        for end in 0..whole.len() - 4 {
            assert!(parts(whole[..end].to_owned().into(), "X").is_err(), "{end}");
        }
    }

    #[test]
    fn two_jobs_and_two_files_of_one_name_are_refused() {
        for name in ["job", "part"] {
            let part = format!("--X\nContent-Disposition: form-data; name=\"{name}\"\n\n{{}}\n");
            assert!(body(&format!("{part}{part}--X--\n")).is_err(), "{name}");
        }
    }
}
