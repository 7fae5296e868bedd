//! Verification of programs and toolpaths.

use super::{in_plane, member, too_large, violation};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
use toolpathd_core::geometry::region::{OutlineError, RegionError};
use toolpathd_core::machining::stock::ShapeError;
use toolpathd_core::operations::verification::{Error, Owner};
use toolpathd_nc::record::ToolUse;

impl From<Error> for ApiError {
    fn from(error: Error) -> Self {
        let fact = error.to_string();
        match error {
            Error::Stopped(stopped) => stopped.into(),
            Error::Source(source) => source.into(),
            Error::Leaning => violation(&member("/toolpath"), FieldCode::Unsupported, fact),
            Error::Outline { owner, island, error } => {
                // A box has no outline of its own in the body.
                let at = match (island, owner) {
                    (None, Owner::Part) => outlines(owner).field("boundary"),
                    (None, _) => outlines(owner),
                    (Some(k), _) => outlines(owner).field("islands").index(k),
                };
                let failed = violation(&at, FieldCode::OutOfRange, fact);
                if let OutlineError::Crosses { at } = error { failed.at(in_plane(at)) } else { failed }
            }
            Error::Region { owner, error: RegionError::TooMany { .. } } => {
                Self::new(Code::LimitExceeded, fact).blaming(&outlines(owner), FieldCode::LimitExceeded)
            }
            Error::Region { owner, error } => {
                let failed = violation(&outlines(owner), FieldCode::OutOfRange, fact);
                if let RegionError::Tangled { at } = error { failed.at(in_plane(at)) } else { failed }
            }
            Error::Empty { owner } => violation(&outlines(owner), FieldCode::OutOfRange, fact),
            Error::Shape(ShapeError::TooManyCells { .. }) => {
                too_large("/cell_mm", format!("{fact}; send a larger `cell_mm`"))
            }
            Error::Shape(_) => violation(&member("/stock"), FieldCode::OutOfRange, fact),
        }
    }
}

/// The member that holds the outlines.
fn outlines(owner: Owner) -> Pointer {
    match owner {
        Owner::Part => member("/region"),
        Owner::Stock => member("/stock"),
        Owner::Fixture(k) => member("/fixtures").index(k),
    }
}

/// The failure of a program that calls a tool of which the request tells nothing.
pub fn tool_not_told(called: &ToolUse, is_list: bool) -> ApiError {
    let (line, is_called) = (called.line, called.number.is_some() || called.name.is_some());
    let called = match (called.number, &called.name) {
        (Some(number), _) => format!("line {line} calls tool {number}"),
        (None, Some(name)) => format!("line {line} calls tool `{name}`"),
        (None, None) => "the program moves before its first tool change".to_owned(),
    };
    let (at, advice) = match (is_list, is_called) {
        (true, true) => ("/tools", "add it to `tools`"),
        (true, false) => ("/tools", "send the one `tool`, or a program that calls its tools"),
        (false, _) => ("/tool", "send all `tools`, each with its number or name"),
    };
    violation(
        &member(at),
        FieldCode::MissingField,
        format!("{called}, which is not in the request; {advice}"),
    )
}
