//! Decodes the JSON bodies of requests. Each error has a pointer to the member at fault.
//!
//! # Method
//! 1. `contract` reads the whole body and finds all violations. A body that is not JSON is always reported as
//!    such, whatever else is wrong.
//! 2. A body without a violation that the decoder refuses is decoded as the type of the request. Where the
//!    decoder still refuses it, because a member is `null` or a whole number has a decimal point, `contract`
//!    writes the body anew and the decoder reads that.
//! 3. The rules of the request judge what was decoded.
//!
//! # Cost
//! The time is linear in the size of the body. A body that breaks the contract takes no memory beyond its
//! text, because no tree of its values is made and it is not decoded. A legal body takes the memory of its
//! request. Step 1 ends within a millisecond when the budget ends; step 2 ends when the decoder has ended.

pub mod check;
mod contract;
pub mod files;
mod foreign;
mod json;
pub mod object;
mod path;
mod patience;
pub mod query;
pub mod tagged;
pub mod words;

use serde::de::DeserializeOwned;
use utoipa::ToSchema;

use super::error::{ApiError, FieldCode};
use super::messages::Warning;
use super::pointer::Pointer;
use crate::config::Limits;
use contract::{Checked, Contract};
use files::{FileReading, Places, SentFiles};
use json::{Unread, text_of};
use object::Object;
use toolpathd_core::budget::Budget;

/// A wire type of requests that can be converted to a job.
pub trait IntoJob: DeserializeOwned + ToSchema + Send + 'static {
    type Job: Send + 'static;

    /// The job of a body that has files and no part `job`. `None` where the body needs the part.
    const JOB_OF_FILES: Option<&'static str> = None;

    /// Puts what files hold in the place of the references to them.
    fn read_files(&mut self, _: &mut FileReading) {}

    /// Puts right in the request what is unambiguous, and tells what.
    fn put_right(&mut self, _: &Limits) -> Vec<Warning> {
        Vec::new()
    }

    /// Checks the request and converts it.
    ///
    /// # Errors
    /// `invalid_request` with every violation.
    fn into_job(self, limits: &Limits) -> Result<Self::Job, ApiError>;
}

/// A job, and what was put right in its request.
pub struct SentJob<J> {
    pub job: J,
    pub remarks: Vec<Warning>,
    /// Where the parts of the request were sent, as far as files have moved them.
    pub places: Places,
}

impl<J> SentJob<J> {
    fn of<T: IntoJob<Job = J>>(mut request: T, mut reading: FileReading) -> Result<Self, ApiError> {
        let limits = reading.limits;
        request.read_files(&mut reading);
        let (mut remarks, places) = reading.result()?;
        let mut put_right = request.put_right(limits);
        places.in_warnings(&mut put_right);
        remarks.extend(put_right);
        let job = request.into_job(limits).map_err(|error| places.in_error(error))?;
        Ok(Self { job, remarks, places })
    }
}

/// Decodes a body and converts it to a job.
///
/// # Errors
/// `malformed_json`, or `invalid_request` with every violation; the reason when `budget` ends.
pub fn job<T: IntoJob>(body: &[u8], limits: &Limits, budget: &Budget) -> Result<SentJob<T::Job>, ApiError> {
    job_with_files::<T>(body, &SentFiles::default(), limits, budget)
}

/// As [`job`], for a body with files beside it.
///
/// # Errors
/// As [`job`].
pub fn job_with_files<T: IntoJob>(
    body: &[u8],
    files: &SentFiles,
    limits: &Limits,
    budget: &Budget,
) -> Result<SentJob<T::Job>, ApiError> {
    let reading = || FileReading::new(files, limits, budget);
    let text = text_of(body)?;
    let unread = |unread| match unread {
        Unread::NotJson => json::fault(text, budget),
        Unread::Stopped(stopped) => stopped.into(),
    };
    let contract = Contract::of::<T>();
    let Checked { mut violations, is_refused } = contract.check(text, budget).map_err(unread)?;
    if !is_refused {
        if let Ok(Object(request)) = serde_json::from_str::<Object<T>>(text) {
            return SentJob::of(request, reading());
        }
        let written = contract.written(text, budget).map_err(unread)?;
        if let Ok(Object(request)) = serde_json::from_str::<Object<T>>(&written) {
            return SentJob::of(request, reading());
        }
    }
    if violations.total() == 0 {
        let detail = "the body does not fit the contract";
        violations.add(&Pointer::root(), FieldCode::WrongType, detail);
    }
    Err(violations.into_error())
}

#[cfg(test)]
mod tests;
