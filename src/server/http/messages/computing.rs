//! Computations that are not begun or do not end.

use std::time::Duration;

use crate::http::compute::Failure;
use crate::http::error::{ApiError, Code};
use toolpathd_core::budget::Stopped;

/// The sentence of a computation that did not end: the stage `longest` took most of the time, and the share
/// `share` of the stage `last` was done.
pub fn too_slow(longest: &str, time: Duration, last: &str, share: f64) -> String {
    let advice = match longest {
        "sections" => {
            "send a larger stepover or scallop height, a coarser `tolerance_mm`, fewer points, or a ball cutter, which is quicker than other cutters"
        }
        "certificate" => "send a coarser `tolerance_mm`, or a larger stepover",
        "wires" => "send a larger pitch, or a larger chord height",
        "fit" => "send fewer points, a coarser `tolerance_mm`, or `method: greedy`",
        "interpolating" => "send a wider band, a shorter domain, or `method: bisection`",
        "patterns" | "regions" => {
            "send fewer `patterns` or regions, a larger stepover or stepdown, or a larger tool"
        }
        "lowering" => "send fewer moves, or another `program.dialect`",
        _ => "send a smaller job, or a coarser tolerance",
    };
    let percent = (100.0 * share).floor();
    let seconds = time.as_secs_f64();
    format!(
        "the computation did not end within the deadline: the stage `{longest}` took {seconds:.1} s, and {percent} % of `{last}` was done; {advice}"
    )
}

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
