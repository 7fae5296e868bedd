//! NC programs that are read: what is refused, and what the reader has assumed.

use super::{Warning, WarningCode};
use crate::http::error::{ApiError, Code, FieldCode, FieldError};
use crate::http::pointer::Pointer;
use toolpathd_nc::ReadError;
use toolpathd_nc::fault::{Fault, Refusal};
use toolpathd_nc::notes::Note;

/// The failure of a program that stands at `at` in the body.
pub fn not_read(error: ReadError, at: &Pointer) -> ApiError {
    match error {
        ReadError::Stopped(stopped) => stopped.into(),
        ReadError::NoMotion => {
            let advice = "send `start` if the tool stands at a known place before the first block";
            ApiError::new(Code::NoMotion, format!("{error}; {advice}"))
        }
        ReadError::Refused(refusals) => {
            ApiError::invalid(refusals.iter().map(|refusal| violation(refusal, at)).collect())
        }
    }
}

fn violation(refusal: &Refusal, at: &Pointer) -> FieldError {
    let Refusal { line, column, word, fault } = refusal;
    let detail = match advice(fault) {
        Some(advice) => format!("{refusal}; {advice}"),
        None => refusal.to_string(),
    };
    FieldError::new(at, code(fault), detail).in_program(*line, *column, word)
}

fn code(fault: &Fault) -> FieldCode {
    use Fault::*;
    match fault {
        NotRead | OtherAxis | Compensation | UnknownRadius | AtMachine | NoPoint | TiltedArc
        | TiltedCycle | UnsureParameter(_) | CornerBetweenSides | ChangesTool(_) | UnsureFeed
        | IncrementOfNewZero => FieldCode::Unsupported,
        NoWord | NoNumber | OpenComment | BadExpression | TooDeep => FieldCode::Syntax,
        NoFeed | NoInverseTime | NoSpindleSpeed => FieldCode::FeedRequired,
        Arc(_) | SmallRadius { .. } | ClosedRadius | NoCenter | Ellipse | NoTangent | NoPole => {
            FieldCode::NoArc
        }
        Endless(_) | TooManyMoves(_) | DeepCalls(_) | LongBlock(_) => FieldCode::LimitExceeded,
        _ => FieldCode::RefusedWord,
    }
}

fn advice(fault: &Fault) -> Option<&'static str> {
    Some(match fault {
        Fault::Compensation => {
            "send `compensation: wear` if the program's path is that of the cutter's centre, or `compute`"
        }
        Fault::UnknownRadius => "send `cutter_radius_mm`, or to verify the tool with its `number`",
        Fault::ChangesTool(_) => "leave it out, and send the tool as it cuts",
        Fault::CutterTooLarge => "send the right radius, or take a smaller cutter",
        Fault::UnknownStart(_) => "send `start`, or let the program go to a place in X, Y and Z first",
        Fault::UnknownEnd(_) => "send `offsets`",
        Fault::NoPoint => "or send `without_point: units`",
        Fault::OtherAxis => "`/v1/five-axis/smooth` reads programs of five axes",
        _ => return None,
    })
}

impl From<&Note> for Warning {
    fn from(note: &Note) -> Self {
        let fact = note.to_string();
        let (code, advice) = match note {
            Note::UnitsAssumed { .. } | Note::BasicUnits { .. } => {
                (WarningCode::UnitsAssumed, "send `units` if that is wrong")
            }
            Note::LengthAxisAssumed { .. }
            | Note::ScalesAllAxes { .. }
            | Note::ShiftTraversed { .. }
            | Note::TenthsOfInch { .. } => (WarningCode::SettingAssumed, "check this setting of the control"),
            Note::LeastIncrements { .. } => {
                (WarningCode::PointsMissing, "send `without_point: units` if the control reads whole units")
            }
            Note::WholeUnits { .. } => (
                WarningCode::PointsMissing,
                "send `without_point: increments` if the control reads least increments",
            ),
            Note::LongDwell { .. } => (WarningCode::LongDwell, "check the unit of the pause"),
            Note::DwellAssumed { .. } => (WarningCode::DwellAssumed, "check the unit of the pause"),
            Note::UnrelatedOffset { .. } => (WarningCode::UnrelatedOffsets, "send `offsets`"),
            Note::UnrelatedPlace { .. } => (WarningCode::UnrelatedOffsets, "send `start` or `offsets`"),
            Note::CompensationAsWear { .. } => {
                (WarningCode::CompensationAsWear, "the cut differs if the control corrects the whole radius")
            }
            Note::CompensationComputed { .. } => {
                (WarningCode::CompensationComputed, "check the offset, and how the control turns corners")
            }
            Note::PeckClearance { .. } => {
                (WarningCode::PeckClearanceAssumed, "the rapid lengths of the cycle depend on it")
            }
            Note::RunsAgain { .. } => (WarningCode::ProgramRepeats, "the times are those of one run"),
            Note::ArcsMoved { .. } => (WarningCode::ArcsMadeExact, "check their centres if that is too far"),
            Note::CentersAssumed { .. } => (WarningCode::CentersAssumed, "write G91.1 or G90.1"),
            Note::ScaleAssumed { .. } => (WarningCode::PointsMissing, "write the factor with a point"),
            Note::Tapping { .. } => (WarningCode::TappingAssumed, "check the feed and the speed"),
        };
        Self::new(code, format!("{fact}; {advice}"))
    }
}
