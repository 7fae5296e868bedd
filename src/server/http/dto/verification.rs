//! The request to verify a program or a toolpath, its conversion to a job, and the report.

mod receipt;
mod report;
mod solid;
mod tool;
mod travel;

use serde::Deserialize;
use utoipa::ToSchema;

use super::check::{Range, Violations};
use super::dialect::DialectName;
use super::meta::{self, Meta, MetaTexts};
use super::outline::Region;
use super::point::Point;
use super::program_reading::{Compensation, ProgramReading, ReadRequest, WithoutPoint, WorkZero};
use super::schema::{array_of, reference, schema_of};
use super::sent_toolpath::{Read, ReadSettings, SentToolpath};
use super::surface::Surface;
use crate::config::Limits;
use crate::http::decode::files::FileReading;
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, FieldCode};
use crate::http::messages::Warning;
use crate::http::pointer::Pointer;
pub use receipt::{Asked, DIGESTED, Digests, Premises, Receipt, SCHEMA, VerifyMembers, VerifyQuery};
pub use report::{Lines, Told, VerifyReport};
pub use solid::Solid;
pub use tool::{NumberedTool, VerifiedTool};
use toolpathd_core::operations::verification as core;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::program::Units;
pub use travel::{Rapids, Travel};

/// The most fixtures.
const MOST_FIXTURES: usize = 200;

/// The most cells of the height map.
pub const MOST_CELLS: usize = 2_000_000;

/// How far the radii of an arc of a toolpath may differ, mm.
const ARC_TOLERANCE_MM: f64 = 0.0015;

/// Legal tolerances, mm.
const TOLERANCE: Range = Range { min: 1e-6, max: 10.0 };

/// Legal values of what the control may leave the path, and of clearances, mm.
const ALLOWED: Range = Range { min: 0.0, max: 40.0 };

/// A program or a toolpath to be verified against a part, a stock, fixtures and the travel of a machine.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct VerifyRequest {
    /// The toolpath: moves as other endpoints return them, and canned cycles, with an upright tool. Either
    /// `toolpath` or `nc` is required.
    #[serde(default, deserialize_with = "object::optional")]
    toolpath: Option<SentToolpath>,
    /// The text of the program, with its line ends.
    #[schema(max_length = 16_777_216)]
    nc: Option<String>,
    /// Name of the dialect of `nc`, as listed by `/v1/dialects`. `deckel` is not
    /// read. Default: `linuxcnc`.
    #[schema(value_type = Option<DialectName>)]
    dialect: Option<String>,
    /// Unit of lengths of `nc` before the first G20 or G21. Default: `mm`.
    units: Option<Units>,
    /// What a length of `nc` without a decimal point means. Default: `increments` for `fanuc`, `haas` and
    /// `mazak`, `units` for the others.
    without_point: Option<WithoutPoint>,
    /// Where the tip stands before the first block of `nc`, in mm. Default: not known. A rapid from or to a
    /// place that is not known is not verified, and the answer says how many there are.
    start: Option<Point>,
    /// The zeros of work offsets of `nc`. Part, stock, fixtures and travel are in coordinates of G54, or of
    /// the first of the offsets where G54 is absent.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<WorkZeros>)]
    offsets: Option<Vec<WorkZero>>,
    /// Whether blocks of `nc` behind a slash are left out. Default: they run.
    block_delete: Option<bool>,
    /// What G41 and G42 of `nc` mean. `compute` takes the radii of the tools. Default: `refuse`.
    compensation: Option<Compensation>,
    /// The tool. Either `tool` or `tools` is required.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<VerifiedTool>,
    /// The tools of a program that changes them, each with its `number`.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<VerifiedTools>)]
    tools: Option<Vec<VerifiedTool>>,
    /// The surface of the part. All below the surface stays. Excludes `region`.
    surface: Option<Surface>,
    /// Material that has to stay on `surface`, in mm.
    #[schema(minimum = 0, maximum = 1_000, default = 0)]
    allowance_mm: Option<f64>,
    /// The walls of a pocket and its islands. All outside the walls stays up to `top_z_mm`, and all below
    /// `floor_z_mm`.
    region: Option<Region>,
    /// Height of the top of the part around a pocket, in mm.
    #[schema(minimum = -1_000_000, maximum = 1_000_000, default = 0)]
    top_z_mm: Option<f64>,
    /// Height of the floor of a pocket, in mm. Required with `region`.
    #[schema(minimum = -1_000_000, maximum = 1_000_000)]
    floor_z_mm: Option<f64>,
    /// The raw part. Default: of a `region` what is cut out of it; else none, and rapids, air and depth are
    /// not verified.
    stock: Option<Solid>,
    /// Largest size of a cell of the height map of the stock, in mm. A smaller cell decides more, and takes
    /// more time. Default: chosen so that there are 250,000 cells, but at most a quarter of the smallest
    /// cutter's radius.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    cell_mm: Option<f64>,
    /// Clamps, vices and stops. Each counts as material from its top down to any depth.
    #[schema(value_type = Option<Fixtures>)]
    fixtures: Option<Vec<Solid>>,
    /// Where the tip may go, in coordinates of the program. Default: anywhere.
    #[serde(default, deserialize_with = "object::optional")]
    travel: Option<Travel>,
    /// How deep the cutter may enter the part and, on a rapid, the stock, in mm.
    #[schema(minimum = 0.000_001, maximum = 10)]
    tolerance_mm: f64,
    /// How far the control may leave the programmed path, in mm, for example with G64 P. Where the two radii
    /// of arcs differ, the distance by which the arcs had to be moved is added.
    #[schema(minimum = 0, maximum = 40, default = 0)]
    control_tolerance_mm: Option<f64>,
    /// Least distance of the tool from fixtures, and of shank and holder from stock and part, in mm.
    #[schema(minimum = 0, maximum = 40, default = 0)]
    clearance_mm: Option<f64>,
    /// How much may stand above the part at the end, in mm: on a surface, on the floor of a `region`, and at
    /// its walls, where a cutter of the program can reach. More is a finding `material_left`. On a surface
    /// what no cutter can reach counts, too. Default: anything.
    #[schema(minimum = 0, maximum = 1_000)]
    allowed_excess_mm: Option<f64>,
    /// How the control runs a rapid along several axes. Default: `straight` for a toolpath and for
    /// `linuxcnc`, `mach4` and `grbl`, else `dog_leg`.
    rapids: Option<Rapids>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

schema_of!(VerifiedTools of VerifiedTool, "Tools, each with another number.", {
    array_of(reference::<VerifiedTool>(), 1, tool::MOST)
});

schema_of!(Fixtures of Solid, "Clamps, vices and stops.", { array_of(reference::<Solid>(), 0, MOST_FIXTURES) });

schema_of!(WorkZeros of WorkZero, "Zeros of work offsets.", { array_of(reference::<WorkZero>(), 0, 100) });

/// The job of verifying.
#[derive(Debug)]
pub struct Verification {
    pub path: Path,
    pub tools: Vec<NumberedTool>,
    /// Whether the tools came as a list.
    pub is_list: bool,
    pub part: Option<core::Part>,
    pub stock: Option<core::Raw>,
    pub cell_mm: Option<f64>,
    pub fixtures: Vec<core::Fixture>,
    pub travel: Option<core::Travel>,
    pub tolerance_mm: f64,
    pub control_tolerance_mm: f64,
    pub clearance_mm: f64,
    pub allowed_excess_mm: Option<f64>,
    pub rapids: Option<core::Rapids>,
    pub meta: Option<Meta>,
    /// `None` where no receipt is asked for.
    pub receipt: Option<Asked>,
}

/// What is verified.
#[derive(Debug)]
pub enum Path {
    /// With a bound of how far arcs were moved to become exact, mm.
    Toolpath {
        toolpath: Toolpath,
        moved_mm: f64,
    },
    Program(ProgramReading),
}

impl IntoJob for VerifyRequest {
    type Job = Verification;

    fn read_files(&mut self, reading: &mut FileReading) {
        let root = Pointer::root();
        if let Some(surface) = &mut self.surface {
            surface.read_file(&root.field("surface"), reading);
        }
        if let Some(region) = &mut self.region {
            region.read_file(&root.field("region"), reading);
        }
    }

    fn put_right(&mut self, limits: &Limits) -> Vec<Warning> {
        self.surface.as_mut().map(|surface| surface.put_right(limits)).unwrap_or_default()
    }

    fn into_job(self, limits: &Limits) -> Result<Verification, ApiError> {
        let Self {
            toolpath,
            nc,
            dialect,
            units,
            without_point,
            start,
            offsets,
            block_delete,
            compensation,
            tool,
            tools,
            surface,
            allowance_mm,
            region,
            top_z_mm,
            floor_z_mm,
            stock,
            cell_mm,
            fixtures,
            travel,
            tolerance_mm,
            control_tolerance_mm,
            clearance_mm,
            allowed_excess_mm,
            rapids,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        let of_program = [
            ("dialect", dialect.is_some()),
            ("units", units.is_some()),
            ("without_point", without_point.is_some()),
            ("start", start.is_some()),
            ("offsets", offsets.is_some()),
            ("block_delete", block_delete.is_some()),
            ("compensation", compensation.is_some()),
        ];
        let path = match (toolpath, nc) {
            (Some(toolpath), None) => {
                let detail = "this member belongs to `nc`; leave it out";
                refuse(of_program, detail, &mut violations);
                upright(toolpath, limits, &mut violations)
            }
            (None, Some(nc)) => {
                let request = ReadRequest {
                    nc,
                    dialect,
                    units,
                    without_point,
                    start,
                    offsets: offsets.unwrap_or_default(),
                    block_delete,
                    compensation,
                    cutter_radius_mm: None,
                    rapid_feed_mm_per_min: None,
                    meta: None,
                };
                Some(Path::Program(request.into_job(limits)?))
            }
            (one, _) => {
                let detail = "send either `toolpath`, or `nc` with its `dialect`";
                let at = if one.is_some() { root.field("nc") } else { root.clone() };
                violations.add(&at, FieldCode::Conflict, detail);
                None
            }
        };
        let is_list = tools.is_some();
        let tools = tool::checked(tool, tools, &mut violations);
        let path = path.map(|path| match path {
            Path::Program(reading) => Path::Program(reading.with_cutters(tool::cutters(&tools))),
            toolpath => toolpath,
        });
        if tools.len() > 1 && matches!(path, Some(Path::Toolpath { .. })) {
            let detail = "a toolpath has one tool, because it calls none; send `tool`";
            violations.add(&root.field("tools"), FieldCode::Conflict, detail);
        }
        let part = part((surface, allowance_mm), (region, top_z_mm, floor_z_mm), limits, &mut violations);
        let stock = stock.map(|solid| solid.stock(&root.field("stock"), limits, &mut violations));
        let fixtures = checked_fixtures(fixtures.unwrap_or_default(), limits, &mut violations);
        let travel = travel.map(|Travel { min, max }| {
            let [low, high] = solid::corners((&min, &max), &root.field("travel"), &mut violations);
            core::Travel { low, high }
        });
        violations.number(&root.field("tolerance_mm"), tolerance_mm, TOLERANCE, "mm");
        violations.optional(&root.field("cell_mm"), cell_mm, Range::POSITIVE, "mm");
        let at = root.field("control_tolerance_mm");
        violations.optional(&at, control_tolerance_mm, ALLOWED, "mm");
        violations.optional(&root.field("clearance_mm"), clearance_mm, ALLOWED, "mm");
        let at = root.field("allowed_excess_mm");
        violations.optional(&at, allowed_excess_mm, Range { min: 0.0, max: 1e3 }, "mm");
        if allowed_excess_mm.is_some() && part.is_none() {
            let detail = "material stands above a part; send `surface` or `region`, or leave it out";
            violations.add(&at, FieldCode::Conflict, detail);
        }
        meta::check(meta.as_ref(), &mut violations);
        let Some(path) = path else { return Err(violations.into_error()) };
        violations.result()?;
        Ok(Verification {
            path,
            tools,
            is_list,
            part,
            stock,
            cell_mm,
            fixtures,
            travel,
            tolerance_mm,
            control_tolerance_mm: control_tolerance_mm.unwrap_or(0.0),
            clearance_mm: clearance_mm.unwrap_or(0.0),
            allowed_excess_mm,
            rapids: rapids.map(|rapids| match rapids {
                Rapids::Straight => core::Rapids::Straight,
                Rapids::DogLeg => core::Rapids::DogLeg,
            }),
            meta,
            receipt: None,
        })
    }
}

/// Refuses the members that were sent.
fn refuse<const N: usize>(members: [(&str, bool); N], detail: &str, violations: &mut Violations) {
    for (name, _) in members.into_iter().filter(|(_, is_sent)| *is_sent) {
        violations.add(&Pointer::root().field(name), FieldCode::Conflict, detail);
    }
}

/// A toolpath with an upright tool.
fn upright(sent: SentToolpath, limits: &Limits, violations: &mut Violations) -> Option<Path> {
    let reading = ReadSettings {
        cutting: None,
        arc_tolerance_mm: ARC_TOLERANCE_MM,
        max_moves: limits.moves,
        may_be_apart: true,
    };
    let at = Pointer::root().field("toolpath");
    let Read { toolpath, moved_mm } = sent.convert(&at, &reading, violations)?;
    if !toolpath.is_upright() {
        let detail = "the tool axis leans or turns; only toolpaths with an upright tool are verified";
        violations.add(&at, FieldCode::Unsupported, detail);
        return None;
    }
    Some(Path::Toolpath { toolpath, moved_mm })
}

fn part(
    (surface, allowance_mm): (Option<Surface>, Option<f64>),
    (region, top_z_mm, floor_z_mm): (Option<Region>, Option<f64>, Option<f64>),
    limits: &Limits,
    violations: &mut Violations,
) -> Option<core::Part> {
    let root = Pointer::root();
    let of_region = [("top_z_mm", top_z_mm.is_some()), ("floor_z_mm", floor_z_mm.is_some())];
    let of_surface = [("allowance_mm", allowance_mm.is_some())];
    violations.optional(&root.field("allowance_mm"), allowance_mm, Range { min: 0.0, max: 1e3 }, "mm");
    violations.optional(&root.field("top_z_mm"), top_z_mm, Range::COORDINATE, "mm");
    violations.optional(&root.field("floor_z_mm"), floor_z_mm, Range::COORDINATE, "mm");
    let (no_region, no_surface) =
        ("this member belongs to `region`; leave it out", "this member belongs to `surface`; leave it out");
    match (surface, region) {
        (Some(_), Some(_)) => {
            let detail = "send either `surface` or `region`";
            violations.add(&root.field("region"), FieldCode::Conflict, detail);
            None
        }
        (Some(surface), None) => {
            refuse(of_region, no_region, violations);
            surface.check(&root.field("surface"), limits, violations);
            if violations.total() > 0 {
                return None;
            }
            let allowance_mm = allowance_mm.unwrap_or(0.0);
            Some(core::Part::Surface { source: surface.into(), allowance_mm })
        }
        (None, Some(region)) => {
            refuse(of_surface, no_surface, violations);
            let outlines = region.convert(&root.field("region"), limits, violations);
            let top_mm = top_z_mm.unwrap_or(0.0);
            let Some(floor_mm) = floor_z_mm else {
                let detail = "`region` needs the height of its floor";
                violations.add(&root.field("floor_z_mm"), FieldCode::MissingField, detail);
                return None;
            };
            if floor_mm >= top_mm {
                let detail = format!("the floor at {floor_mm} mm is not below the top at {top_mm} mm");
                violations.add(&root.field("floor_z_mm"), FieldCode::OutOfRange, detail);
            }
            Some(core::Part::Pocket { outlines, top_mm, floor_mm })
        }
        (None, None) => {
            refuse(of_region, no_region, violations);
            refuse(of_surface, no_surface, violations);
            None
        }
    }
}

fn checked_fixtures(
    fixtures: Vec<Solid>,
    limits: &Limits,
    violations: &mut Violations,
) -> Vec<core::Fixture> {
    let at = Pointer::root().field("fixtures");
    if fixtures.len() > MOST_FIXTURES {
        let detail = format!("there are {} fixtures; send at most {MOST_FIXTURES}", fixtures.len());
        violations.add(&at, FieldCode::TooLong, detail);
        return Vec::new();
    }
    let convert = |(k, solid): (usize, Solid)| solid.fixture(&at.index(k), limits, violations);
    fixtures.into_iter().enumerate().map(convert).collect()
}
