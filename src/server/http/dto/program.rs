//! The member `program` of requests: how the service writes the NC program.

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::dialect::{self, DialectName};
use super::meta::MAX_TEXT_CHARACTERS;
use crate::http::decode::object;
use crate::http::error::FieldCode;
use crate::http::messages;
use crate::http::pointer::Pointer;
use toolpathd_core::toolpath::program::{self as core, SafeHome, SmoothingMode, Units};
use toolpathd_post::{Dialect, MAX_LINES};

/// The smallest and the largest legal number of a program.
const NUMBERS: (u32, u32) = (1, 99_999_999);

/// How the NC program is written.
#[derive(Debug, Default, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Program {
    /// Name of the control's dialect, as listed by `/v1/dialects`.
    #[schema(value_type = Option<DialectName>, default = "linuxcnc")]
    dialect: Option<String>,
    /// Number of the program: the O number in a dialect that has O numbers, else a part of the file's name.
    /// `/v1/dialects` lists the largest number of each dialect.
    #[schema(minimum = 1, maximum = 99_999_999, default = 1)]
    number: Option<u32>,
    /// Name of the program. The name stands in a comment of the program, in plain letters and digits, and in
    /// the file's name.
    #[schema(max_length = 1000)]
    name: Option<String>,
    /// Units of the written program. Lengths in requests and reports are always in mm.
    #[serde(default)]
    #[schema(default = "mm")]
    units: Units,
    /// Number of decimals of a written coordinate. With more decimals, rounding moves the path less. Default:
    /// as `/v1/dialects` lists for the dialect, mostly 3 in mm and 4 in inches.
    #[schema(minimum = 1, maximum = 6)]
    decimals: Option<u32>,
    /// Whether blocks are numbered: N10, N20 and so on.
    #[serde(default)]
    #[schema(default = false)]
    block_numbers: bool,
    /// Work offset that the start of the program selects. Without a work offset the program runs with the
    /// active offset, and the answer warns. On Heidenhain G54 to G59 are the rows 1 to 6 of the table of
    /// presets.
    work_offset: Option<WorkOffset>,
    /// How the tool moves up along Z before each tool change and before the end of the program. `g28`: to the
    /// reference point. `g53`: to zero of the machine's coordinates. `none`: the tool is changed where it
    /// stands, and the program ends at the clearance plane.
    #[serde(default)]
    #[schema(default = "none")]
    safe_home: SafeHome,
    /// How the control may leave the written path to run it faster, in the control's own word. A dialect
    /// without such a word, and a value that the word does not take, are refused. Default: the program
    /// keeps the path to one unit of the last decimal on LinuxCNC (G64 P) and Siemens (G641 ADIS), and
    /// leaves the control as it is on others. A line of `custom.header` or `custom.tool_change` that
    /// chooses the smoothing takes the place of either; together with `smoothing` it is refused.
    #[serde(default, deserialize_with = "object::optional")]
    smoothing: Option<Smoothing>,
    /// Lines of your own in the program. The service checks each line, writes it as it is, and behind the
    /// lines sets the modes of the program again. Default: none.
    #[serde(default, deserialize_with = "object::required")]
    custom: core::Custom,
}

/// How the control may leave the written path: by `G64 P` on LinuxCNC, `CYCLE832` on Siemens, `G5.1 Q1` on
/// Fanuc, `G187` on Haas, and cycle 32 on Heidenhain. What is absent is the control's choice. `/v1/dialects`
/// lists what the word of each dialect takes and needs.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct Smoothing {
    /// Largest distance from the written path, in mm. The program states it rounded down to the decimals that
    /// the control reads.
    #[schema(minimum = 0.000_001, maximum = 10)]
    tolerance_mm: Option<f64>,
    /// Largest difference of the angles of the rotary axes, in degrees.
    #[schema(minimum = 0.000_1, maximum = 10)]
    tolerance_deg: Option<f64>,
    /// What the program is for.
    mode: Option<SmoothingMode>,
}

/// Legal values of `tolerance_mm` and of `tolerance_deg`.
const TOLERANCE_MM: Range = Range { min: 1e-6, max: 10.0 };
const TOLERANCE_DEG: Range = Range { min: 1e-4, max: 10.0 };

impl Smoothing {
    fn check(self, at: &Pointer, violations: &mut Violations) {
        let Self { tolerance_mm, tolerance_deg, mode: _ } = self;
        if let Some(mm) = tolerance_mm {
            violations.number(&at.field("tolerance_mm"), mm, TOLERANCE_MM, "mm");
        }
        if let Some(degrees) = tolerance_deg {
            violations.number(&at.field("tolerance_deg"), degrees, TOLERANCE_DEG, "degrees");
        }
    }

    fn convert(self) -> core::Smoothing {
        let Self { tolerance_mm, tolerance_deg, mode } = self;
        core::Smoothing { tolerance_mm, tolerance_deg, mode }
    }
}

/// A work offset of the control.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
pub enum WorkOffset {
    G54 = 54,
    G55 = 55,
    G56 = 56,
    G57 = 57,
    G58 = 58,
    G59 = 59,
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
            smoothing,
            custom,
        } = self;
        let dialect = dialect::find(dialect.as_deref()).unwrap_or_else(|detail| {
            violations.add(&at.field("dialect"), FieldCode::UnknownDialect, detail);
            dialect::DEFAULT
        });
        if let Some(number) = *number {
            let max = dialect.max_program_number.unwrap_or(NUMBERS.1);
            violations.integer(&at.field("number"), number, (NUMBERS.0, max));
        }
        Self::check_custom(custom, dialect, &at.field("custom"), violations);
        if let Some(smoothing) = smoothing {
            smoothing.check(&at.field("smoothing"), violations);
            if let Some(own) = toolpathd_post::own_smoothing(dialect, custom) {
                let (at, detail) = messages::smoothed_twice(&own);
                violations.add(&at, FieldCode::Unsupported, detail);
            }
        }
        if let Some(name) = name {
            violations.text(&at.field("name"), name, MAX_TEXT_CHARACTERS);
        }
        if let Some(decimals) = *decimals {
            violations.integer(&at.field("decimals"), decimals, (1, dialect.max_decimals.into()));
        }
    }

    fn check_custom(custom: &core::Custom, dialect: &Dialect, at: &Pointer, violations: &mut Violations) {
        let core::Custom { header, tool_change, footer } = custom;
        for (field, lines) in [("header", header), ("tool_change", tool_change), ("footer", footer)] {
            if lines.len() > MAX_LINES {
                let detail = format!("{} lines are too many; send at most {MAX_LINES}", lines.len());
                violations.add(&at.field(field), FieldCode::TooLong, detail);
                return;
            }
        }
        for refused in toolpathd_post::refused(dialect, custom) {
            let (at, detail) = messages::refused(&refused);
            violations.add(&at, FieldCode::Unsupported, detail);
        }
    }

    /// The dialect and the program. Illegal values, which `check` has reported, become the defaults.
    pub fn convert(self) -> (&'static Dialect, core::Program) {
        let Self {
            dialect,
            number,
            name,
            units,
            decimals,
            block_numbers,
            work_offset,
            safe_home,
            smoothing,
            custom,
        } = self;
        let dialect = dialect::find(dialect.as_deref()).unwrap_or(dialect::DEFAULT);
        let usual = match units {
            Units::Mm => dialect.default_decimals_mm,
            Units::Inch => dialect.default_decimals_inch,
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
            work_offset: work_offset.map(|offset| offset as u8),
            safe_home,
            smoothing: smoothing.map(Smoothing::convert),
            blank: None,
            custom,
        };
        (dialect, program)
    }
}
