//! Smooth paths of five axes.

use super::writing::not_followed;
use super::{Warning, WarningCode, member, too_large};
use crate::http::error::{ApiError, Code, FieldCode};
use toolpathd_core::operations::five_axis::{self, FiveAxisError};
use toolpathd_core::toolpath::PathError;
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_post::path_text::{LeftWord, PathFault, PathTextError};

impl From<&five_axis::Warning> for Warning {
    fn from(warning: &five_axis::Warning) -> Self {
        use five_axis::Warning as Of;
        let fact = warning.to_string();
        let (code, detail) = match *warning {
            Of::ToleranceExceeded { deviation_mm, deviation_deg } => (
                WarningCode::ToleranceExceeded,
                format!(
                    "`method: paper` leaves the tolerances: up to {:.4} mm and {:.4} degrees from the given path; send `interpolating`",
                    rounded_up(deviation_mm),
                    rounded_up(deviation_deg)
                ),
            ),
            Of::LimitsNotProved { .. } => (WarningCode::LimitsNotProved, fact),
            Of::AboveLowerBound { .. } => (WarningCode::AboveLowerBound, fact),
            Of::RoundingExceedsTolerance { .. } => {
                let advice = "send more `decimals`, or a larger `tolerance_mm`";
                (WarningCode::RoundingExceedsTolerance, format!("{fact}: {advice}"))
            }
        };
        Self::new(code, detail)
    }
}

impl From<FiveAxisError> for ApiError {
    fn from(error: FiveAxisError) -> Self {
        let fact = error.to_string();
        match error {
            FiveAxisError::Stopped(stopped) => stopped.into(),
            FiveAxisError::NoMotion => {
                Self::new(Code::InvalidRequest, format!("{fact}; send at least two different poses"))
                    .blaming(&member("/path"), FieldCode::OutOfRange)
            }
            FiveAxisError::OppositeAxes { index } => {
                let advice = "send a pose between the two, so that the way of the axis is certain";
                Self::new(Code::InvalidRequest, format!("{fact}; {advice}"))
                    .blaming(&member("/path").index(index).field("axis"), FieldCode::OutOfRange)
            }
            FiveAxisError::ToleranceNotReached { at } => {
                Self::new(Code::ToleranceNotReached, format!("{fact}; send a larger tolerance")).at(at.into())
            }
            FiveAxisError::NotFollowed { error, at } => Self::new(not_followed(&error), fact).at(at.into()),
            FiveAxisError::OnPole { at } => Self::new(Code::AxisOnPole, fact).at(at.into()),
            FiveAxisError::NotScheduled { at, .. } => Self::new(Code::InvalidRequest, fact)
                .blaming(&member("/limits"), FieldCode::OutOfRange)
                .at(at.into()),
            FiveAxisError::Moves(PathError::TooManyMoves { .. }) => {
                too_large("/tolerance_mm", format!("{fact}; send a larger tolerance"))
            }
            FiveAxisError::Moves(_) => Self::new(Code::InternalError, fact),
            FiveAxisError::TooManySamples { .. } => {
                too_large("/sample_period_ms", format!("{fact}; send a larger `sample_period_ms`"))
            }
        }
    }
}

/// The detail of CL data or an NC program that cannot be read.
pub fn path_text(error: &PathTextError) -> String {
    match error.fault {
        PathFault::NoFeed => format!("{error}; send `feed_mm_per_min`"),
        PathFault::NoMachine => format!("{error}; send `machine`"),
        _ => error.to_string(),
    }
}

/// The warning that a program states the axis of the tool alone, and the control chooses the positions.
pub fn positions_of_control() -> Warning {
    Warning::new(
        WarningCode::PositionsOfControl,
        "the program states the tool axis, and the control chooses positions and speeds of the rotary axes: the limits hold for the samples, and the control keeps its own; send `axis_output: angles` or `machine` to state the positions of the motion",
    )
}

/// The warning of the words of a program that were left alone. `None` without such words.
pub fn words_left_alone_in(words: &[toolpathd_nc::notes::LeftWord]) -> Option<Warning> {
    let words: Vec<LeftWord> = words
        .iter()
        .map(|left| LeftWord { word: left.word.clone(), count: left.count, line: left.line })
        .collect();
    words_left_alone("nc", &words)
}

/// The warning of the words of `member`, `cl` or `nc`, that were left alone. `None` without such words.
pub fn words_left_alone(member: &str, words: &[LeftWord]) -> Option<Warning> {
    let told = |LeftWord { word, count, line }: &LeftWord| match count {
        1 => format!("{word} in line {line}"),
        count => format!("{word} {count} times, first in line {line}"),
    };
    let all: Vec<String> = words.iter().map(told).collect();
    (!all.is_empty()).then(|| {
        let detail = format!("words of `{member}` change nothing of the answer: {}", all.join(", "));
        Warning::new(WarningCode::WordsLeftAlone, detail)
    })
}
