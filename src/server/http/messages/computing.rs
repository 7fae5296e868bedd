//! Computations that are not begun or do not end.

use crate::http::compute::Failure;
use crate::http::error::{ApiError, Code};
use toolpathd_core::budget::Stopped;

impl From<Failure> for ApiError {
    fn from(failure: Failure) -> Self {
        match failure {
            Failure::Overloaded { retry_after } => {
                Self::new(Code::Overloaded, "every worker is busy and the queue is full; try again later")
                    .retrying(retry_after)
            }
            Failure::NotStarted { retry_after } => Self::new(
                Code::Overloaded,
                "every worker was busy for as long as a request may wait, and the job was not begun; try again later",
            )
            .retrying(retry_after),
            Failure::DeadlinePassed => Stopped::DeadlinePassed.into(),
            Failure::Panicked => {
                Self::new(Code::InternalError, "the server failed while computing: report the request id")
            }
        }
    }
}

impl From<Stopped> for ApiError {
    fn from(stopped: Stopped) -> Self {
        match stopped {
            // Nobody is left to read the answer to a cancelled request.
            Stopped::Cancelled | Stopped::DeadlinePassed => Self::new(
                Code::DeadlinePassed,
                "the computation did not end within the deadline: send a smaller job, or a coarser tolerance",
            ),
            Stopped::ShortOfMemory => Self::new(
                Code::Overloaded,
                "the server needed the memory for other requests and stopped the computation; try again later",
            ),
            Stopped::TooLarge => Self::new(
                Code::LimitExceeded,
                "the computation needs more memory than the server has: send a smaller job, or a coarser tolerance",
            ),
        }
    }
}
