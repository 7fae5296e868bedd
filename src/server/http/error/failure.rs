//! Problem documents for failures that can occur in all computing endpoints.

use super::{ApiError, Code, FieldCode, FieldError};
use crate::http::compute::Failure;
use crate::http::pointer::Pointer;
use toolpathd_core::budget::Stopped;
use toolpathd_core::machine::FollowError;
use toolpathd_core::toolpath::cutting::HeightError;
use toolpathd_core::toolpath::quantize::QuantizeError;
use toolpathd_post::{Missing, WriteError};

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

impl From<QuantizeError> for ApiError {
    fn from(error: QuantizeError) -> Self {
        let decimals = Pointer::root().field("program").field("decimals");
        let detail = error.to_string();
        match error {
            QuantizeError::OutOfRange { value_mm: _ } => {
                Self::invalid(vec![FieldError::new(&decimals, FieldCode::OutOfRange, detail)])
            }
            QuantizeError::TooManyPieces { limit: _ } => {
                Self::new(Code::LimitExceeded, detail).blaming(&decimals, FieldCode::LimitExceeded)
            }
        }
    }
}

impl From<WriteError> for ApiError {
    fn from(error: WriteError) -> Self {
        let program = Pointer::root().field("program");
        let cutting = Pointer::root().field("cutting");
        let detail = error.to_string();
        let out_of_range = |at: Pointer, detail: String| {
            Self::invalid(vec![FieldError::new(&at, FieldCode::OutOfRange, detail)])
        };
        match error {
            WriteError::Stopped(stopped) => stopped.into(),
            WriteError::Quantize(quantize) => quantize.into(),
            WriteError::Decimals { decimals: _, max: _ } => out_of_range(program.field("decimals"), detail),
            WriteError::ProgramNumber { number: _, max: _ } => out_of_range(program.field("number"), detail),
            // Fewer decimals leave more digits before the point.
            WriteError::TooManyDigits { limit: _ } => out_of_range(program.field("decimals"), detail),
            WriteError::TooManyWholeDigits { limit: _ } => out_of_range(program.field("dialect"), detail),
            WriteError::Missing(missing) => {
                Self::invalid(vec![FieldError::new(&place_of(&missing), FieldCode::Unsupported, detail)])
            }
            WriteError::Custom(_) => {
                Self::invalid(vec![FieldError::new(&program.field("custom"), FieldCode::Unsupported, detail)])
            }
            WriteError::NoDwells => Self::invalid(vec![FieldError::new(
                &program.field("dialect"),
                FieldCode::Unsupported,
                detail,
            )]),
            // Block numbers and decimals make lines long.
            WriteError::LineTooLong { limit: _ } => out_of_range(program.field("decimals"), detail),
            WriteError::SpindleSpeed { rpm: _ } => out_of_range(cutting.field("spindle_rpm"), detail),
            WriteError::FeedMissing => Self::new(Code::FeedRequired, detail),
            // Any feed of `cutting` may be at fault, also a plunge feed that is half of `feed_mm_per_min`.
            WriteError::Feed { mm_per_min: _ } => out_of_range(cutting, detail),
            WriteError::MachineMissing => {
                let at = Pointer::root().field("machine");
                Self::invalid(vec![FieldError::new(&at, FieldCode::MissingField, detail)])
            }
            WriteError::AxisOutput | WriteError::SecondPointTooNear => {
                let at = Pointer::root().field("axis_output");
                Self::invalid(vec![FieldError::new(&at, FieldCode::Unsupported, detail)])
            }
            WriteError::NotFollowed { error, at } => Self::new(not_followed(&error), detail).at(at.into()),
            WriteError::NearPole { at } => Self::new(Code::AxisOnPole, detail).at(at.into()),
            WriteError::InverseTime { seconds: _ } => Self::new(Code::LimitExceeded, detail),
            WriteError::TooManyBlocks { limit: _ } => Self::new(Code::LimitExceeded, detail),
            WriteError::Dwell { seconds: _, most_s: _ } => out_of_range(program.field("dialect"), detail),
            // These are faults of the service.
            WriteError::Unreadable(_) | WriteError::Differs { line: _, what: _ } => {
                Self::new(Code::InternalError, detail)
            }
        }
    }
}

/// The member of a request that asks for what a dialect cannot write.
pub fn place_of(missing: &Missing) -> Pointer {
    let root = Pointer::root();
    match missing {
        Missing::Units { .. } => root.field("program").field("units"),
        Missing::WorkOffset { .. } => root.field("program").field("work_offset"),
        Missing::SafeHome { .. } => root.field("program").field("safe_home"),
        Missing::Coolant { .. } => root.field("cutting").field("coolant"),
        Missing::Tool { .. } => root.field("tool"),
        Missing::ToolNumber { .. } => root.field("tool").field("number"),
        Missing::LengthOffset { .. } | Missing::LengthOffsetNumber { .. } => {
            root.field("tool").field("length_offset")
        }
    }
}

/// The code of a path that a machine cannot follow.
pub fn not_followed(error: &FollowError) -> Code {
    match error {
        FollowError::Unreachable { .. } => Code::AxisUnreachable,
        _ => Code::OutOfTravel,
    }
}

impl From<HeightError> for ApiError {
    fn from(error: HeightError) -> Self {
        let detail = error.to_string();
        let cutting = Pointer::root().field("cutting");
        match error {
            HeightError::BelowTop { field, value_mm: _, top_mm: _ } => {
                Self::new(Code::HeightBelowTop, detail)
                    .blaming(&cutting.field(field), FieldCode::HeightBelowTop)
            }
            HeightError::ClearanceBelowRetract { clearance_mm: _, retract_mm: _ } => {
                let at = cutting.field("clearance_z_mm");
                Self::invalid(vec![FieldError::new(&at, FieldCode::OutOfRange, detail)])
            }
        }
    }
}
