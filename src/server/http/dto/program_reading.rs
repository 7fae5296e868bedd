//! The request to read an NC program, as JSON or as a query beside NC text, and the report.

mod premises;
mod query;
mod report;
mod trace;

use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::dialect::{self, DialectName};
use super::meta::{self, Meta, MetaTexts};
use super::point::Point;
use crate::config::Limits;
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, Code, FieldCode};
use crate::http::pointer::Pointer;
pub use premises::ReadPremises;
pub use query::ReadQuery;
pub use report::ReadReport;
use toolpathd_core::toolpath::program::Units;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_nc::ReadJob;
use toolpathd_nc::control::{self, Control};
use toolpathd_nc::frames::EXTENDED;
use toolpathd_nc::machine::{Correction, Cutter};

/// Most work offsets of a request.
const MAX_OFFSETS: usize = 100;

/// Most blocks of a trace. One takes some 400 bytes of JSON.
const MOST_TRACED: usize = 200_000;

/// An NC program, and what its text does not say.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct ReadRequest {
    /// The text of the program, with its line ends.
    #[schema(max_length = 16_777_216)]
    pub(super) nc: String,
    /// Name of the control's dialect, as listed by `/v1/dialects`. `deckel` is not
    /// read.
    #[schema(value_type = Option<DialectName>, default = "linuxcnc")]
    pub(super) dialect: Option<String>,
    /// Unit of lengths before the first G20 or G21. Default: `mm`, and the answer warns.
    #[schema(default = "mm")]
    pub(super) units: Option<Units>,
    /// What a length without a decimal point means. `increments`: 0.001 mm or 0.0001 inch, the default of
    /// `fanuc`, `haas` and `mazak`. `units`: the same as with a point, the default of `okuma` and `iso`. The
    /// other dialects always read units. The answer warns where a number has no point.
    pub(super) without_point: Option<WithoutPoint>,
    /// Where the tip of the tool stands before the first block, in mm. Default: not known. A cut from a place
    /// that is not known is refused.
    pub(super) start: Option<Point>,
    /// The zeros of work offsets. Places of the answer are in coordinates of G54, or of the first of them
    /// where G54 is absent.
    #[serde(default, deserialize_with = "object::list")]
    #[schema(max_items = 100)]
    pub(super) offsets: Vec<WorkZero>,
    /// Whether blocks behind a slash are left out. Default: they run.
    pub(super) block_delete: Option<bool>,
    /// What G41 and G42 mean. `wear`: the program's path is that of the cutter's centre, because the control
    /// corrects wear alone. `compute`: the program's path is the contour; the path of the centre is computed
    /// for a cutter of `cutter_radius_mm`. Default: `refuse`.
    #[schema(default = "refuse")]
    pub(super) compensation: Option<Compensation>,
    /// Radius of the cutter for `compensation: compute`, in mm.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    pub(super) cutter_radius_mm: Option<f64>,
    /// Speed of rapids, in mm/min.
    #[schema(minimum = 0.001, maximum = 1_000_000, default = 10_000)]
    pub(super) rapid_feed_mm_per_min: Option<f64>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    pub(super) meta: Option<Meta>,
}

/// The zero of a work offset.
#[derive(Debug, Clone, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct WorkZero {
    /// The work offset: `G54` to `G59`, `G59.1` to `G59.3`, `G54.1 P1` to `G54.1 P300`.
    #[schema(max_length = 12)]
    name: String,
    /// The zero in coordinates of the machine, in mm.
    zero: Point,
}

/// What a length without a decimal point means.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub enum WithoutPoint {
    Increments,
    Units,
}

/// What G41 and G42 mean.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = ReadCompensation)]
pub enum Compensation {
    Refuse,
    Wear,
    Compute,
}

/// The cutter for `compensation: compute`, where its radius is given.
fn cutter_of(settings: &ReadQuery) -> Vec<Cutter> {
    settings.cutter_radius_mm.map(|radius_mm| Cutter { number: None, radius_mm }).into_iter().collect()
}

/// The control of a dialect.
fn control_of(name: Option<&str>) -> Result<&'static Control, (FieldCode, String)> {
    let dialect = dialect::find(name).map_err(|detail| (FieldCode::UnknownDialect, detail))?;
    Control::named(dialect.name).ok_or_else(|| {
        let names: Vec<&str> = control::CONTROLS.iter().map(|control| control.name).collect();
        let read = names.join("`, `");
        (FieldCode::Unsupported, format!("programs in `{}` are not read; send one of `{read}`", dialect.name))
    })
}

/// The job of reading a program.
#[derive(Debug)]
pub struct ProgramReading {
    pub text: Vec<u8>,
    /// Whether the text is the whole body.
    pub is_body: bool,
    /// `None` where the body names no dialect.
    control: Option<&'static Control>,
    settings: ReadQuery,
    offsets: Vec<(u32, [f64; 3])>,
    /// The cutters for `compensation: compute`.
    cutters: Vec<Cutter>,
    most_moves: usize,
    pub meta: Option<Meta>,
}

impl ProgramReading {
    /// The job of a body that is NC text.
    pub fn of_text(text: &[u8], query: ReadQuery, limits: &Limits) -> Self {
        let cutters = cutter_of(&query);
        Self {
            text: text.to_vec(),
            is_body: true,
            control: None,
            settings: query,
            offsets: Vec::new(),
            cutters,
            most_moves: limits.moves,
            meta: None,
        }
    }

    /// The same job; what its body does not say is that of the query.
    pub fn or(mut self, query: ReadQuery) -> Self {
        let own = std::mem::take(&mut self.settings);
        self.settings = ReadQuery {
            dialect: query.dialect,
            units: own.units.or(query.units),
            without_point: own.without_point.or(query.without_point),
            start: own.start.or(query.start),
            block_delete: own.block_delete.or(query.block_delete),
            compensation: own.compensation.or(query.compensation),
            cutter_radius_mm: own.cutter_radius_mm.or(query.cutter_radius_mm),
            rapid_feed_mm_per_min: own.rapid_feed_mm_per_min.or(query.rapid_feed_mm_per_min),
            trace: query.trace,
        };
        self.cutters = cutter_of(&self.settings);
        self
    }

    /// The same job, with cutters for `compensation: compute`.
    pub fn with_cutters(mut self, cutters: Vec<Cutter>) -> Self {
        self.cutters = cutters;
        self
    }

    /// The control that reads the program.
    ///
    /// # Errors
    /// `invalid_query` for a dialect that is not read; the query was checked before.
    pub fn control(&self) -> Result<&'static Control, ApiError> {
        let of_query = || {
            control_of(self.settings.dialect.as_deref())
                .map_err(|(_, detail)| ApiError::new(Code::InvalidQuery, detail))
        };
        self.control.map_or_else(of_query, Ok)
    }

    pub fn read_job(&self, control: &'static Control) -> ReadJob<'_> {
        let settings = &self.settings;
        ReadJob {
            text: &self.text,
            control,
            in_inches: settings.units == Some(Units::Inch),
            without_point: settings.without_point.map(|own| match own {
                WithoutPoint::Increments => control::WithoutPoint::Increments,
                WithoutPoint::Units => control::WithoutPoint::Units,
            }),
            start: settings.start.map_or([None; 3], |start| start.map(Some)),
            offsets: &self.offsets,
            skips_optional: settings.block_delete.unwrap_or(false),
            correction: match settings.compensation {
                None | Some(Compensation::Refuse) => Correction::Refused,
                Some(Compensation::Wear) => Correction::Wear,
                Some(Compensation::Compute) => Correction::Computed(&self.cutters),
            },
            most_moves: self.most_moves,
            most_traced: if settings.trace == Some(true) { MOST_TRACED } else { 0 },
        }
    }

    /// Whether the answer holds the modal state behind each block.
    pub fn is_traced(&self) -> bool {
        self.settings.trace == Some(true)
    }

    pub fn rapid_feed(&self) -> FeedRate {
        let own = self.settings.rapid_feed_mm_per_min.and_then(FeedRate::from_mm_per_min);
        own.unwrap_or(FeedRate::DEFAULT_RAPID)
    }
}

impl IntoJob for ReadRequest {
    type Job = ProgramReading;

    fn into_job(self, limits: &Limits) -> Result<ProgramReading, ApiError> {
        let Self {
            nc,
            dialect,
            units,
            without_point,
            start,
            offsets,
            block_delete,
            compensation,
            cutter_radius_mm,
            rapid_feed_mm_per_min,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        let control = dialect.and_then(|name| match control_of(Some(&name)) {
            Ok(control) => Some(control),
            Err((code, detail)) => {
                violations.add(&root.field("dialect"), code, detail);
                None
            }
        });
        if let Some(start) = &start {
            start.check(&root.field("start"), &mut violations);
        }
        let at = root.field("rapid_feed_mm_per_min");
        violations.optional(&at, rapid_feed_mm_per_min, Range::POSITIVE, "mm/min");
        let at = root.field("cutter_radius_mm");
        violations.optional(&at, cutter_radius_mm, Range::POSITIVE, "mm");
        let offsets = zeros(offsets, &root.field("offsets"), &mut violations);
        meta::check(meta.as_ref(), &mut violations);
        violations.result()?;
        let settings = ReadQuery {
            dialect: None,
            units,
            without_point,
            start: start.map(|point| point.0),
            block_delete,
            compensation,
            cutter_radius_mm,
            rapid_feed_mm_per_min,
            trace: None,
        };
        let text = nc.into_bytes();
        Ok(ProgramReading {
            text,
            is_body: false,
            control,
            settings,
            offsets,
            cutters: Vec::new(),
            most_moves: limits.moves,
            meta,
        })
    }
}

/// The work offsets with their numbers. Each may stand once.
fn zeros(sent: Vec<WorkZero>, at: &Pointer, violations: &mut Violations) -> Vec<(u32, [f64; 3])> {
    let mut zeros: Vec<(u32, [f64; 3])> = Vec::new();
    if sent.len() > MAX_OFFSETS {
        let detail = format!("there are {} work offsets; send at most {MAX_OFFSETS}", sent.len());
        violations.add(at, FieldCode::TooLong, detail);
        return zeros;
    }
    for (k, WorkZero { name, zero }) in sent.into_iter().enumerate() {
        let own = at.index(k);
        zero.check(&own.field("zero"), violations);
        match offset_number(&name) {
            None => {
                let shown: String = name.chars().take(40).collect();
                let detail = format!(
                    "`{shown}` is no work offset; send `G54` to `G59`, `G59.1` to `G59.3` or `G54.1 P1` to `G54.1 P300`"
                );
                violations.add(&own.field("name"), FieldCode::UnknownValue, detail);
            }
            Some(number) if zeros.iter().any(|(other, _)| *other == number) => {
                let detail = format!("`{name}` stands twice; send it once");
                violations.add(&own.field("name"), FieldCode::Conflict, detail);
            }
            Some(number) => zeros.push((number, zero.0)),
        }
    }
    zeros
}

fn offset_number(name: &str) -> Option<u32> {
    let name = name.trim().to_ascii_uppercase();
    if let Some(extended) = name.strip_prefix("G54.1").or(name.strip_prefix("G154")) {
        let number: u32 = extended.trim().strip_prefix('P')?.parse().ok()?;
        return (1..=300).contains(&number).then_some(EXTENDED + number);
    }
    let names = ["G54", "G55", "G56", "G57", "G58", "G59", "G59.1", "G59.2", "G59.3"];
    names.iter().position(|own| *own == name).map(|k| k as u32 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_offsets_are_known_by_their_names() {
        let found =
            ["G54", "g59", "G59.3", "G54.1 P2", "G154 P99", "G53", "G54.1", "G54.1 P0"].map(offset_number);
        assert_eq!(found, [Some(1), Some(6), Some(9), Some(102), Some(199), None, None, None]);
    }
}
