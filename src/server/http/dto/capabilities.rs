//! What each dialect can write, as `/v1/dialects` lists it.

use serde::Serialize;
use utoipa::ToSchema;

use super::dialect::DEFAULT;
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_core::toolpath::program::{SafeHome, SmoothingMode, Units};
use toolpathd_post::DIALECTS;
use toolpathd_post::dialect::{Arcs, AxisOutput, Parabolas, SmoothingWords, Verification};

/// The dialects in which programs can be written.
#[derive(Debug, Serialize, ToSchema)]
pub struct Dialects {
    /// Name of the dialect that is used where `program.dialect` is absent.
    default: &'static str,
    /// All dialects.
    dialects: Vec<Dialect>,
}

/// What one dialect can write. A request that asks for anything else is refused, with a pointer to it.
#[derive(Debug, Serialize, ToSchema)]
pub struct Dialect {
    /// Name of the dialect: the value of `program.dialect`.
    name: &'static str,
    /// The controls that the dialect is for.
    description: &'static str,
    /// What has read programs of this dialect besides the reader with which the service checks each program.
    verified_by: Verification,
    /// Extension of a program's file, without the dot.
    file_extension: &'static str,
    /// Number of decimals of a written coordinate where the request has no `program.decimals`.
    default_decimals: DefaultDecimals,
    /// Largest number of decimals of a written coordinate.
    max_decimals: u8,
    /// Largest number of decimals of a written feed. A feed that these decimals state with an error above
    /// 0.05 % is rounded down. Where the feed becomes slower by more than 1 %, the answer warns.
    max_feed_decimals: u8,
    /// The largest `program.number`: a plain number. Absent where the dialect has no program numbers.
    #[serde(skip_serializing_if = "Option::is_none")]
    max_program_number: Option<u32>,
    /// Largest number of characters of a line.
    max_line_length: usize,
    /// Units of programs.
    units: &'static [Units],
    /// The arcs that are written as arcs. All others become lines within the rounding of the program.
    arcs: Arcs,
    /// The largest radius of an arc that is fitted or written as an arc, in mm. `heidenhain` and `mazak`:
    /// from their manuals. `linuxcnc`: the service's own limit, since the control has none. Others: 10,000
    /// mm, where no figure of the control is known.
    largest_radius_mm: f64,
    /// Whether parabolas at one height are written as parabolas. All others become lines.
    parabolas: bool,
    /// Legal values of `program.work_offset`.
    work_offsets: Vec<String>,
    /// Legal values of `program.safe_home`.
    safe_home: &'static [SafeHome],
    /// Legal values of `cutting.coolant`.
    coolant: &'static [Coolant],
    /// Whether programs can pause.
    dwells: bool,
    /// The canned cycles that programs have. All others are written as moves. `heidenhain` has none in
    /// programs in inches, and no pecks where the retract plane is less than 0.5 mm or more than 5 mm above
    /// the material.
    cycles: &'static [CycleKind],
    /// Whether a program can have several tools, one after the other.
    tool_changes: bool,
    /// Whether programs hold comments: the name, `meta`, figures and warnings. Without comments, warnings are
    /// in the JSON answer and in the header `toolpathd-warnings` only.
    comments: bool,
    /// Whether programs state the radius of the tool, so that requests need `tool`.
    needs_tool: bool,
    /// Whether `tool.length_offset` may differ from `tool.number`.
    length_offsets: bool,
    /// The members of `program.smoothing` that the control's word takes. Absent where the control has no word
    /// for smoothing.
    #[serde(skip_serializing_if = "Option::is_none")]
    smoothing: Option<SmoothingMembers>,
    /// Legal values of `axis_output`: how programs state the axis of a leaning tool. Empty for a control of
    /// three axes.
    axis_output: Vec<AxisOutput>,
}

/// What the word for smoothing of one control takes.
#[derive(Debug, Serialize, ToSchema)]
pub struct SmoothingMembers {
    /// Whether `tolerance_mm` may be sent.
    tolerance_mm: bool,
    /// Whether `tolerance_mm` has to be sent.
    needs_tolerance_mm: bool,
    /// Whether `tolerance_deg` may be sent.
    tolerance_deg: bool,
    /// Legal values of `mode`.
    modes: &'static [SmoothingMode],
}

impl From<SmoothingWords> for SmoothingMembers {
    fn from(words: SmoothingWords) -> Self {
        Self {
            tolerance_mm: words.takes_tolerance,
            needs_tolerance_mm: words.needs_tolerance,
            tolerance_deg: words.takes_degrees,
            modes: words.modes,
        }
    }
}

/// Numbers of decimals by units.
#[derive(Debug, Serialize, ToSchema)]
pub struct DefaultDecimals {
    /// Number of decimals of a program in mm.
    mm: u8,
    /// Number of decimals of a program in inches.
    inch: u8,
}

impl Dialects {
    /// All dialects.
    pub fn all() -> Self {
        Self { default: DEFAULT.name, dialects: DIALECTS.iter().map(|&dialect| dialect.into()).collect() }
    }
}

impl From<&toolpathd_post::Dialect> for Dialect {
    fn from(dialect: &toolpathd_post::Dialect) -> Self {
        let abilities = dialect.abilities;
        Self {
            name: dialect.name,
            description: dialect.description,
            file_extension: dialect.file_extension,
            default_decimals: DefaultDecimals {
                mm: dialect.default_decimals_mm,
                inch: dialect.default_decimals_inch,
            },
            verified_by: dialect.verification,
            max_decimals: dialect.max_decimals,
            max_feed_decimals: dialect.numbers.max_feed_decimals,
            max_program_number: dialect.max_program_number,
            max_line_length: dialect.max_line_length,
            units: abilities.units,
            arcs: dialect.curves.arcs,
            largest_radius_mm: dialect.curves.largest_radius_mm,
            parabolas: dialect.curves.parabolas != Parabolas::AsLines,
            work_offsets: abilities.work_offsets.iter().map(|number| format!("G{number}")).collect(),
            safe_home: abilities.safe_homes,
            coolant: abilities.coolants,
            dwells: abilities.has_dwells,
            cycles: abilities.cycles,
            tool_changes: dialect.changes_tools(),
            comments: abilities.has_comments,
            needs_tool: abilities.needs_tool,
            length_offsets: abilities.length_offsets.is_some(),
            smoothing: dialect.smoothing.map(SmoothingMembers::from),
            axis_output: dialect.five_axes.outputs().collect(),
        }
    }
}
