//! How the program is to be written, as it is sent.

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::check::Violations;
use super::meta::MAX_TEXT_CHARACTERS;
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;
use crate::http::v1::dialects;
use crate::post::Dialect;
use crate::toolpath::program as core;

const NUMBERS: (u32, u32) = (1, 99_999_999);

/// How the NC program is written. Units and decimals also bound the rounding that the tolerance allows for.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// A name listed by `/v1/dialects`. Default: `linuxcnc`.
    #[schema(schema_with = dialects::schema)]
    dialect: Option<String>,
    /// Default: 1. Some dialects take a smaller number at most, as listed by `/v1/dialects`.
    #[schema(minimum = 1, maximum = 99_999_999)]
    number: Option<u32>,
    /// Appears in a comment, cleaned to plain letters and digits.
    #[schema(max_length = 1000)]
    name: Option<String>,
    #[serde(default)]
    #[schema(default = "mm")]
    units: Units,
    /// Decimals of a written coordinate. Default: 3 with mm, 4 with inches.
    #[schema(minimum = 1, maximum = 6)]
    decimals: Option<u32>,
    #[serde(default)]
    #[schema(default = false)]
    block_numbers: bool,
    /// Written at the start of the program. Default: none.
    #[schema(inline)]
    work_offset: Option<WorkOffset>,
    /// The way up along Z before the tool is changed and before the program ends: `g28`, to the reference point; `g53`, to zero of the
    /// machine's coordinates; `none`: the tool is changed where it is, and the program ends at the clearance height.
    #[serde(default)]
    #[schema(default = "none")]
    safe_home: SafeHome,
}

#[derive(Debug, Clone, Copy, Default, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum SafeHome {
    #[default]
    None,
    G28,
    G53,
}

#[derive(Debug, Clone, Copy, Default, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum Units {
    #[default]
    Mm,
    Inch,
}

impl From<core::Units> for Units {
    fn from(units: core::Units) -> Self {
        match units {
            core::Units::Mm => Self::Mm,
            core::Units::Inch => Self::Inch,
        }
    }
}

#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
pub enum WorkOffset {
    G54,
    G55,
    G56,
    G57,
    G58,
    G59,
}

impl Program {
    pub fn check(&self, at: &Pointer, violations: &mut Violations) {
        let Self {
            dialect,
            number,
            name,
            units: _,
            decimals,
            block_numbers: _,
            work_offset: _,
            safe_home: _,
        } = self;
        let dialect = dialects::find(dialect.as_deref()).unwrap_or_else(|detail| {
            violations.add(&at.field("dialect"), FieldCode::UnknownDialect, detail);
            dialects::DEFAULT
        });
        if let Some(number) = *number {
            let max = dialect.program_number.map_or(NUMBERS.1, |numbers| numbers.max);
            violations.integer(&at.field("number"), number, (NUMBERS.0, max));
        }
        if let Some(name) = name {
            violations.text(&at.field("name"), name, MAX_TEXT_CHARACTERS);
        }
        if let Some(decimals) = *decimals {
            violations.integer(&at.field("decimals"), decimals, (1, dialect.max_decimals.into()));
        }
    }

    /// Converts what has been checked; the default of what was to blame.
    pub fn convert(self) -> (&'static Dialect, core::Program) {
        let Self { dialect, number, name, units, decimals, block_numbers, work_offset, safe_home } = self;
        let dialect = dialects::find(dialect.as_deref()).unwrap_or(dialects::DEFAULT);
        let (units, usual) = match units {
            Units::Mm => (core::Units::Mm, dialect.default_decimals_mm),
            Units::Inch => (core::Units::Inch, dialect.default_decimals_inch),
        };
        let decimals = decimals
            .and_then(|value| u8::try_from(value).ok())
            .filter(|value| (1..=dialect.max_decimals).contains(value))
            .unwrap_or(usual);
        let program = core::Program {
            resolution: core::Resolution { units, decimals },
            number: number.unwrap_or(1),
            name,
            block_numbers,
            work_offset: work_offset.map(|offset| match offset {
                WorkOffset::G54 => 54,
                WorkOffset::G55 => 55,
                WorkOffset::G56 => 56,
                WorkOffset::G57 => 57,
                WorkOffset::G58 => 58,
                WorkOffset::G59 => 59,
            }),
            safe_home: match safe_home {
                SafeHome::None => core::SafeHome::None,
                SafeHome::G28 => core::SafeHome::G28,
                SafeHome::G53 => core::SafeHome::G53,
            },
        };
        (dialect, program)
    }
}
