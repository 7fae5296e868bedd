//! NC programs that are not written, and what a request asks of a dialect that the dialect cannot write.

use super::{Warning, WarningCode, member, too_large, violation};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::machine::FollowError;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::{Program, SafeHome, SmoothingMode};
use toolpathd_core::toolpath::quantize::QuantizeError;
use toolpathd_core::toolpath::units::rounded_up;
use toolpathd_post::{
    CoarseFeeds, CustomFault, CustomPart, Dialect, Missing, OwnSmoothing, OwnWorkOffset, Refused, Unjoinable,
    WriteError,
};

impl From<QuantizeError> for ApiError {
    fn from(error: QuantizeError) -> Self {
        let fact = error.to_string();
        match error {
            QuantizeError::OutOfRange { .. } => {
                violation(&member("/program/decimals"), FieldCode::OutOfRange, fact)
            }
            QuantizeError::TooManyPieces { .. } => too_large("/program/decimals", fact),
        }
    }
}

impl From<CoarseFeeds> for Warning {
    fn from(coarse: CoarseFeeds) -> Self {
        let CoarseFeeds { moves, asked_mm_per_min, written_mm_per_min, by_s } = coarse;
        let by_s = rounded_up(by_s);
        let detail = format!(
            "the decimals of F cannot state the feeds of {moves} moves: the program writes {asked_mm_per_min} mm/min as {written_mm_per_min:.6} mm/min, and takes {by_s} s longer in all; send a feed that F can state, or choose another dialect"
        );
        Self::new(WarningCode::FeedRounded, detail)
    }
}

impl From<WriteError> for ApiError {
    fn from(error: WriteError) -> Self {
        match error {
            WriteError::InOperation { index, error } => {
                Self::of_operation(*error, &format!("/further_operations/{}", index - 1))
            }
            error => Self::of_operation(error, ""),
        }
    }
}

impl ApiError {
    /// A program that is not written. `operation` is the path of the operation at fault in the request.
    fn of_operation(error: WriteError, operation: &str) -> Self {
        let fact = error.to_string();
        let of_cutting = |path: &str, detail: String| {
            violation(&member(&format!("{operation}{path}")), FieldCode::OutOfRange, detail)
        };
        let out_of_range =
            |path: &str, detail: String| violation(&member(path), FieldCode::OutOfRange, detail);
        let unsupported =
            |path: &str, detail: String| violation(&member(path), FieldCode::Unsupported, detail);
        match error {
            WriteError::Stopped(stopped) => stopped.into(),
            WriteError::Quantize(quantize) => quantize.into(),
            WriteError::Decimals { .. } => out_of_range("/program/decimals", fact),
            WriteError::ProgramNumber { .. } => out_of_range("/program/number", fact),
            // Fewer decimals leave more digits before the point.
            WriteError::TooManyDigits { .. } => out_of_range("/program/decimals", fact),
            WriteError::TooManyWholeDigits { .. } => out_of_range("/program/dialect", fact),
            WriteError::Missing(error) => {
                let (at, detail) = missing(&error);
                violation(&at, FieldCode::Unsupported, detail)
            }
            WriteError::Custom(error) => {
                let (at, detail) = refused(&error);
                violation(&at, FieldCode::Unsupported, detail)
            }
            WriteError::SmoothedTwice(own) => {
                let (at, detail) = smoothed_twice(&own);
                violation(&at, FieldCode::Unsupported, detail)
            }
            WriteError::Unjoinable(reason) => {
                let (path, advice) = unjoinable(&reason);
                unsupported(path, format!("{fact}; {advice}"))
            }
            WriteError::SmallTolerance { .. } => out_of_range("/program/smoothing", fact),
            WriteError::CycleHeights { .. } => out_of_range("/program/decimals", fact),
            WriteError::NoDwells => unsupported("/program/dialect", fact),
            // Block numbers and decimals make lines long.
            WriteError::LineTooLong { .. } => out_of_range("/program/decimals", fact),
            WriteError::SpindleSpeed { .. } => of_cutting("/cutting/spindle_rpm", fact),
            WriteError::FeedMissing => Self::new(Code::FeedRequired, fact),
            // Any feed of `cutting` may be at fault, also a plunge feed that is half of `feed_mm_per_min`.
            WriteError::Feed { .. } => of_cutting("/cutting", fact),
            WriteError::MachineMissing => {
                let advice = "send `machine`, or `axis_output: vectors` in a dialect that has vectors";
                violation(&member("/machine"), FieldCode::MissingField, format!("{fact}; {advice}"))
            }
            WriteError::AxisOutput => unsupported("/axis_output", fact),
            WriteError::SecondPointTooNear => {
                unsupported("/axis_output", format!("{fact}; send `axis_output: vectors`"))
            }
            WriteError::NotFollowed { error, at } => Self::new(not_followed(&error), fact).at(at.into()),
            WriteError::NearPole { at } => Self::new(Code::AxisOnPole, fact).at(at.into()),
            WriteError::InverseTime { .. } => Self::new(Code::LimitExceeded, fact),
            WriteError::TooManyBlocks { .. } => Self::new(Code::LimitExceeded, fact),
            WriteError::Dwell { .. } => out_of_range("/program/dialect", fact),
            // These are faults of the service.
            WriteError::Unreadable(_) | WriteError::Differs { .. } | WriteError::InOperation { .. } => {
                Self::new(Code::InternalError, fact)
            }
        }
    }
}

/// The member of a request by which operations cannot stand in one program, and what to do.
fn unjoinable(reason: &Unjoinable) -> (&'static str, &'static str) {
    const FURTHER: &str = "/further_operations";
    match reason {
        Unjoinable::Nothing | Unjoinable::Programs | Unjoinable::Leaning => {
            (FURTHER, "send each toolpath in a request of its own")
        }
        Unjoinable::Several { .. } => {
            (FURTHER, "send each toolpath in a request of its own, or choose another dialect")
        }
        Unjoinable::ToolChange { .. } => {
            (FURTHER, "send the operations of each tool in a request of their own, or choose another dialect")
        }
        Unjoinable::OwnToolChange => (
            "/program/custom/tool_change",
            "leave `tool_change` out, or send each tool in a request of its own",
        ),
        Unjoinable::TwoTools { .. } => (FURTHER, "send another `number` for each tool"),
        Unjoinable::LengthOffsets { .. } => (FURTHER, "send the same `length_offset`, or none"),
        Unjoinable::NoSafeHome { has_homes: true } => {
            ("/program/safe_home", "send a `safe_home` other than `none`")
        }
        Unjoinable::NoSafeHome { has_homes: false } => (
            FURTHER,
            "the dialect has no word for a safe home: send each work offset in a request of its own",
        ),
    }
}

/// The code of a path that a machine cannot follow.
pub fn not_followed(error: &FollowError) -> Code {
    match error {
        FollowError::Unreachable { .. } => Code::AxisUnreachable,
        _ => Code::OutOfTravel,
    }
}

/// The member of a request that asks for what a dialect cannot write, and the detail.
pub fn missing(missing: &Missing) -> (Pointer, String) {
    let (path, advice) = match missing {
        Missing::Units { .. } => ("/program/units", "choose other units or another dialect".to_owned()),
        Missing::WorkOffset { has_others, .. } => {
            let others = if *has_others { ", or choose another" } else { "" };
            ("/program/work_offset", format!("leave `work_offset` out{others}"))
        }
        Missing::SafeHome { has, .. } => ("/program/safe_home", format!("send {}", any_of(has, safe_home))),
        Missing::Coolant { has, .. } => ("/cutting/coolant", format!("send {}", any_of(has, coolant))),
        Missing::Smoothing { .. } => {
            ("/program/smoothing", "leave `smoothing` out, or choose another dialect".to_owned())
        }
        Missing::SmoothingMember { member: "mode", .. } => {
            ("/program/smoothing/mode", "leave it out".to_owned())
        }
        Missing::SmoothingMember { member: "tolerance_deg", .. } => {
            ("/program/smoothing/tolerance_deg", "leave it out".to_owned())
        }
        Missing::SmoothingMember { .. } => {
            ("/program/smoothing/tolerance_mm", "leave it out: a parameter of the control has it".to_owned())
        }
        Missing::SmoothingTolerance { .. } => ("/program/smoothing", "send `tolerance_mm`".to_owned()),
        Missing::SmoothingMode { has, .. } => {
            ("/program/smoothing/mode", format!("send {}", any_of(has, smoothing_mode)))
        }
        Missing::Tool { .. } => ("/tool", "send `tool`".to_owned()),
        Missing::ToolNumber { most, .. } => ("/tool/number", format!("send a number of at most {most}")),
        Missing::LengthOffset { .. } => ("/tool/length_offset", "leave `length_offset` out".to_owned()),
        Missing::LengthOffsetNumber { most, .. } => {
            ("/tool/length_offset", format!("send a number of at most {most}"))
        }
    };
    (member(path), format!("{missing}; {advice}"))
}

fn any_of<T>(all: &[T], name: impl Fn(&T) -> &'static str) -> String {
    all.iter().map(|one| format!("`{}`", name(one))).collect::<Vec<_>>().join(" or ")
}

fn safe_home(home: &SafeHome) -> &'static str {
    match home {
        SafeHome::None => "none",
        SafeHome::G28 => "g28",
        SafeHome::G53 => "g53",
    }
}

fn smoothing_mode(mode: &SmoothingMode) -> &'static str {
    match mode {
        SmoothingMode::Roughing => "roughing",
        SmoothingMode::SemiFinishing => "semi_finishing",
        SmoothingMode::Finishing => "finishing",
    }
}

fn coolant(coolant: &Coolant) -> &'static str {
    match coolant {
        Coolant::Off => "off",
        Coolant::Flood => "flood",
        Coolant::Mist => "mist",
    }
}

/// The place of a shop's own line that is refused, and the detail.
pub fn refused(Refused { part, index, fault }: &Refused) -> (Pointer, String) {
    let advice = match fault {
        CustomFault::BlockNumber(_) => ", and set `program.block_numbers`",
        CustomFault::ProgramNumber(_) => ", and set `program.number`",
        CustomFault::WorkOffset(_) => "; set `program.work_offset`, or move it to `header`",
        CustomFault::NoToolChange => "; move the line to `header`",
        CustomFault::NoPlace => "; leave `custom` out, or choose another dialect",
        _ => "",
    };
    (place(*part, *index), format!("{fault}{advice}"))
}

/// The place of `smoothing` beside a shop's own line that chooses it too, and the detail, which names the
/// line.
pub fn smoothed_twice(own: &OwnSmoothing) -> (Pointer, String) {
    (member("/program/smoothing"), format!("{own} (`{}`)", place(own.part, own.index)))
}

/// The warning of a shop's own line that selects a work offset beside `work_offset`. The modes of the program
/// are set again behind the line.
pub fn second_work_offset(dialect: &Dialect, program: &Program) -> Option<Warning> {
    let number = program.work_offset?;
    let OwnWorkOffset { index, word } = toolpathd_post::own_work_offset(dialect, &program.custom)?;
    let detail = format!(
        "`{word}` selects a work offset beside `program.work_offset`, which is G{number}: leave out the one that is wrong"
    );
    Some(Warning::new(WarningCode::WorkOffsetTwice, detail).about(&place(CustomPart::Header, index)))
}

/// The place of a shop's own line.
fn place(part: CustomPart, index: usize) -> Pointer {
    let part = match part {
        CustomPart::Header => "header",
        CustomPart::ToolChange => "tool_change",
        CustomPart::Footer => "footer",
    };
    member("/program/custom").field(part).index(index)
}
