//! The files that a request brings beside its job, and the places of the job that refer to them.
//!
//! A job refers to a file by its name, or holds the file itself in base64. [`FileReading`] finds the bytes
//! for each such place, before the rules of the request judge what the file holds.

use axum::body::Bytes;
use base64::Engine;
use base64::prelude::BASE64_STANDARD;

use super::check::Violations;
use crate::config::Limits;
use crate::http::error::{ApiError, FieldCode};
use crate::http::messages::{Warning, WarningCode};
use crate::http::pointer::Pointer;
use toolpathd_core::budget::{Budget, Stopped};

/// The most references to files in a request.
const MOST_REFERENCES: usize = 64;

/// What was sent at one place and is judged at another, because files were put in the place of references.
#[derive(Debug, Clone)]
struct Moved {
    judged: Pointer,
    sent: Pointer,
    /// The name of the file, where the part is from a file.
    file: Option<String>,
}

/// Where the parts of a request that are judged were sent.
#[derive(Debug, Clone, Default)]
pub struct Places(Vec<Moved>);

impl Places {
    /// The pointer in the request as it was sent, and the name of the file, for a pointer in the request as
    /// it is judged. `None` where the two are the same.
    fn sent(&self, judged: &str) -> Option<(String, Option<&str>)> {
        self.0.iter().find_map(|Moved { judged: from, sent, file }| {
            let rest = judged.strip_prefix(from.as_str())?;
            if !(rest.is_empty() || rest.starts_with('/')) {
                return None;
            }
            Some(match file {
                Some(name) => (sent.field("name").as_str().to_owned(), Some(name.as_str())),
                None => (format!("{}{rest}", sent.as_str()), None),
            })
        })
    }

    /// The same error, with the places in the request as it was sent.
    pub fn in_error(&self, error: ApiError) -> ApiError {
        if self.0.is_empty() { error } else { error.moved(|judged| self.sent(judged)) }
    }

    /// Puts the places of the request as it was sent into warnings.
    pub fn in_warnings(&self, warnings: &mut [Warning]) {
        for warning in warnings {
            let sent = warning.pointer.as_deref().and_then(|judged| self.sent(judged));
            if let Some((sent, file)) = sent {
                if let Some(name) = file {
                    warning.detail = format!("`{name}`: {}", warning.detail);
                }
                warning.pointer = Some(sent);
            }
        }
    }
}

/// A file of a request.
#[derive(Debug, Clone)]
pub struct SentFile {
    /// The name of the part of the body.
    pub part: String,
    /// The name that the part gives its file.
    pub file_name: Option<String>,
    pub bytes: Bytes,
}

impl SentFile {
    /// The name by which people know the file.
    pub fn name(&self) -> &str {
        self.file_name.as_deref().unwrap_or(&self.part)
    }
}

/// The files of a request. A body of JSON has none.
#[derive(Debug, Clone, Default)]
pub struct SentFiles(Vec<SentFile>);

impl SentFiles {
    pub fn new(files: Vec<SentFile>) -> Self {
        Self(files)
    }

    pub fn all(&self) -> &[SentFile] {
        &self.0
    }

    /// The place of a file by the name of the file, or else by the name of its part.
    pub fn position(&self, name: &str) -> Option<usize> {
        let by_file = self.0.iter().position(|file| file.file_name.as_deref() == Some(name));
        by_file.or_else(|| self.0.iter().position(|file| file.part == name))
    }
}

/// Reads the files to which a request refers, and collects what is to be told of them.
pub struct FileReading<'a> {
    files: &'a SentFiles,
    is_used: Vec<bool>,
    pub limits: &'a Limits,
    pub budget: &'a Budget,
    pub violations: Violations,
    warnings: Vec<Warning>,
    n_references: usize,
    places: Places,
    stopped: Option<Stopped>,
}

impl<'a> FileReading<'a> {
    pub fn new(files: &'a SentFiles, limits: &'a Limits, budget: &'a Budget) -> Self {
        let is_used = vec![false; files.all().len()];
        Self {
            files,
            is_used,
            limits,
            budget,
            violations: Violations::default(),
            warnings: Vec::new(),
            n_references: 0,
            places: Places::default(),
            stopped: None,
        }
    }

    /// The name and the bytes of the file to which the object at `at` refers: by name, or with the file in
    /// base64. `None` with a violation where there is no such file.
    pub fn file(&mut self, at: &Pointer, name: &str, base64: Option<&str>) -> Option<Bytes> {
        self.n_references += 1;
        if self.n_references > MOST_REFERENCES {
            let detail = format!(
                "this is reference {}; a request refers to files at most {MOST_REFERENCES} times",
                self.n_references
            );
            self.violations.add(at, FieldCode::LimitExceeded, detail);
            return None;
        }
        let position = self.files.position(name);
        if let Some(position) = position {
            self.is_used[position] = true;
        }
        match (base64, position) {
            (None, Some(position)) => Some(self.files.all()[position].bytes.clone()),
            (None, None) => {
                self.violations.add(&at.field("name"), FieldCode::UnknownFile, self.unknown(name));
                None
            }
            (Some(_), Some(_)) => {
                let detail = format!("the body has a part `{name}` already: leave `base64` out");
                self.violations.add(&at.field("base64"), FieldCode::Conflict, detail);
                None
            }
            (Some(text), None) => match BASE64_STANDARD.decode(text) {
                Ok(bytes) => Some(bytes.into()),
                Err(error) => {
                    let detail = format!("this is not base64 (RFC 4648, with padding): {error}");
                    self.violations.add(&at.field("base64"), FieldCode::Syntax, detail);
                    None
                }
            },
        }
    }

    /// The only file beside the job, for requests that need not name it.
    pub fn only_file(&mut self) -> Option<(String, Bytes)> {
        let [file] = self.files.all() else { return None };
        self.is_used[0] = true;
        Some((file.name().to_owned(), file.bytes.clone()))
    }

    fn unknown(&self, name: &str) -> String {
        let names: Vec<String> = self.files.all().iter().map(|file| format!("`{}`", file.name())).collect();
        if names.is_empty() {
            let how = format!("send `multipart/form-data`, as `curl -F job=@job.json -F \"part=@{name}\"`");
            return format!("the request has no file `{name}`: {how}, or the file in `base64`");
        }
        format!("the request has no file `{name}`; there is {}", names.join(", "))
    }

    /// Tells that what was sent at `sent` is judged at `judged`; `file` is its name where it is from a file.
    pub fn moved(&mut self, judged: Pointer, sent: Pointer, file: Option<&str>) {
        self.places.0.push(Moved { judged, sent, file: file.map(str::to_owned) });
    }

    /// Ends the reading, because the budget has ended.
    pub fn stop(&mut self, stopped: Stopped) {
        self.stopped.get_or_insert(stopped);
    }

    /// Something to tell of the file to which the object at `at` refers.
    pub fn warn(&mut self, at: &Pointer, code: WarningCode, detail: String) {
        self.warnings.push(Warning::new(code, detail).about(at));
    }

    /// What is to be told, and where what is judged was sent.
    ///
    /// # Errors
    /// `invalid_request` with every violation, among them each file to which nothing refers; the reason when
    /// the budget has ended.
    pub fn result(mut self) -> Result<(Vec<Warning>, Places), ApiError> {
        if let Some(stopped) = self.stopped {
            return Err(stopped.into());
        }
        for (file, _) in self.files.all().iter().zip(&self.is_used).filter(|(_, is_used)| !**is_used) {
            let detail = format!("nothing in `job` refers to the file `{}`: leave the file out", file.name());
            self.violations.add(&Pointer::root(), FieldCode::UnknownFile, detail);
        }
        self.violations.result()?;
        Ok((self.warnings, self.places))
    }
}
