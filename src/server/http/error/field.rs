//! Violations of the rules for a request, each with its place in the body.

use serde::Serialize;
use utoipa::ToSchema;

use super::shortened;
use crate::http::pointer::Pointer;

/// What is wrong at one place of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = FieldCode)]
pub enum FieldCode {
    UnknownField,
    MissingField,
    WrongType,
    WrongLength,
    UnknownValue,
    Conflict,
    UnknownDialect,
    Unsupported,
    OutOfRange,
    TooLarge,
    TooLong,
    TooFewPoints,
    RaggedGrid,
    PatchesApart,
    LimitExceeded,
    HeightBelowTop,
    ToleranceBelowDecimals,
    /// The points do not make an arc.
    NoArc,
    /// The expression or section curve cannot be parsed; `offset` says where.
    Syntax,
    /// The expression has no value somewhere in its domain; `offset` is the place of the operation.
    Undefined,
    /// Neighbouring points, rows or columns are the same.
    Coincident,
    /// A row of points runs the other way than most rows.
    ReversedRow,
    /// A row or column of points does not follow the one before.
    OutOfOrder,
    /// A point is off the surface of its neighbours.
    Outlier,
    /// The number stands for a missing value.
    MissingValue,
    /// z is exchanged with another axis.
    ExchangedAxes,
    FeedRequired,
    /// The request has no such file, or nothing refers to the file.
    UnknownFile,
    /// The file breaks its format, or holds nothing of what is asked for; `detail` tells the place in it.
    UnreadableFile,
    /// The file states no unit of length.
    UnitMissing,
    /// The control would refuse the word of the program; `line` and `column` say where it stands.
    RefusedWord,
}

/// One violation of the rules for a request.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, ToSchema)]
pub struct FieldError {
    /// The place in the request's body: a JSON pointer as URI fragment (RFC 6901).
    #[schema(example = "#/surface/points/2/3/1")]
    pub pointer: String,
    /// What is wrong at that place, for software.
    pub code: FieldCode,
    /// What is wrong at that place, for people: the received value, the limit, and what to do.
    pub detail: String,
    /// Number of the byte at fault, counted from 0, in an expression or a section curve. Absent for other
    /// fields.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 0, maximum = 16_777_216)]
    pub offset: Option<usize>,
    /// Number of the line of a program, counted from 1. Present with a word of a program that is read.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 16_777_216)]
    pub line: Option<usize>,
    /// Number of the byte in the line, counted from 1. Present with `line`.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(minimum = 1, maximum = 16_777_216)]
    pub column: Option<usize>,
    /// The word of the program, or its beginning. Present with `line`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub word: Option<String>,
}

impl FieldError {
    pub fn new(at: &Pointer, code: FieldCode, detail: impl Into<String>) -> Self {
        Self {
            pointer: at.as_str().to_owned(),
            code,
            detail: shortened(detail.into()),
            offset: None,
            line: None,
            column: None,
            word: None,
        }
    }

    /// The same violation, of a word of a program.
    pub fn in_program(self, line: usize, column: usize, word: &str) -> Self {
        Self { line: Some(line), column: Some(column), word: Some(word.to_owned()), ..self }
    }

    /// As [`FieldError::new`], for byte `offset` of an expression or a section curve.
    pub fn in_text(at: &Pointer, offset: usize, code: FieldCode, detail: impl Into<String>) -> Self {
        Self { offset: Some(offset), ..Self::new(at, code, detail) }
    }
}
