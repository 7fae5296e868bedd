//! The request to smooth a path of five axes, and the samples of the motion.

mod limits;
mod machine;
mod mtconnect;
mod samples;
mod text;

use nalgebra::Point3;
use serde::Deserialize;
use utoipa::ToSchema;

use super::axis::{self, AxisDirection};
use super::axis_output::AxisSetup;
use super::check::{Range, Violations};
use super::cutting::Cutting;
use super::meta::{Meta, MetaTexts};
use super::point::{Coordinates, Point};
use super::program::Program;
use super::schema::{array_of, reference, schema_of};
use super::setup::{SentSetup, Setup};
use super::tool::Tool;
use crate::config::Limits;
use crate::http::decode::{IntoJob, object};
use crate::http::error::{ApiError, FieldCode};
use crate::http::messages;
use crate::http::pointer::Pointer;
use limits::SentLimits;
pub use machine::{Machines, SentMachine};
pub use samples::{Sample, SampleMembers, SmoothMembers, SmoothQuery};
pub use text::Carried;
use toolpathd_core::machine::{Machine, Straying};
use toolpathd_core::operations::five_axis::{self as core, AtPole, Method};
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::pose::{Pace, Pose, Waypoint};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_post::AxisOutput;
use toolpathd_post::path_text::{self, PathText, PathTextError, ReadSettings};

/// Legal values of `tolerance_mm`, of `tolerance_deg`, of `sample_period_ms` and of `retract_mm`.
const TOLERANCE_MM: Range = Range { min: 1e-5, max: 10.0 };
const TOLERANCE_DEG: Range = Range { min: 1e-4, max: 10.0 };
const PERIOD_MS: Range = Range { min: 0.01, max: 1000.0 };
const RETRACT_MM: Range = Range { min: 0.0, max: 1000.0 };

/// A path of tool poses to be smoothed: `path`, `cl` or `nc`.
#[derive(Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct SmoothRequest {
    /// The poses of the tool. Between two poses the tip moves on a line, and the axis turns on the great
    /// circle in step with the tip.
    #[serde(default, deserialize_with = "object::optional_list")]
    #[schema(value_type = Option<PoseList>)]
    path: Option<Vec<SentPose>>,
    /// The text of APT CL data: `GOTO/x,y,z,i,j,k` with `FEDRAT` and `RAPID`. Each word is read, or left
    /// alone with a warning, or refused with its line; docs/five-axis-programs.md lists all words.
    cl: Option<String>,
    /// The text of an NC program of five axes: Fanuc with G43.4 or G43.5, Siemens with TRAORI, Heidenhain
    /// with M128, LinuxCNC with M428. A program without any of these states the positions of the axes of
    /// `machine`. Words are treated as those of `cl`.
    nc: Option<String>,
    /// Speed of the tip where the path states no feed, in mm/min. Where the tip rests and the axis turns, the
    /// top of the tool moves at this speed. Default: `cutting.feed_mm_per_min`.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: Option<f64>,
    /// Largest distance between the smooth path of the tip and the given path, in mm. With `tool` also the
    /// largest distance by which tip and axis together move the surface that the tool cuts.
    #[schema(minimum = 0.000_01, maximum = 10)]
    tolerance_mm: f64,
    /// Largest angle between the axis and the axis of the given path at the nearest place, in degrees. With
    /// `tool` the angle moves the cut surface by a quarter of `tolerance_mm` at most.
    #[schema(minimum = 0.000_1, maximum = 10)]
    tolerance_deg: f64,
    /// Distance from the tip of the tool to its top, in mm. The service smooths the path of the tip and the
    /// path of the top.
    #[schema(minimum = 0.001, maximum = 1_000_000, default = 50)]
    top_distance_mm: Option<f64>,
    /// How the path is smoothed.
    #[serde(default)]
    #[schema(default = "interpolating")]
    method: Method,
    /// The machine whose axes move. Samples then hold the positions of the axes. Default: none.
    #[serde(default, deserialize_with = "object::optional")]
    machine: Option<SentMachine>,
    /// What the path does where its axis comes within the tolerance of a pole of `machine`: a direction at
    /// which a rotary axis may have any angle, and beside which this axis turns far.
    #[serde(default)]
    #[schema(default = "quickest")]
    at_pole: AtPole,
    /// Limits of the axes. The motion then starts and ends at rest, stops where it has to, and is as fast as
    /// the limits and the feed allow. Default: none; the feed is constant, without ramps.
    #[serde(default, deserialize_with = "object::optional")]
    limits: Option<SentLimits>,
    /// How the program states the tool axis. Default: as `angles` where the dialect can and `machine` is
    /// given, as `vectors` where the dialect can and there is no `machine`, else as `machine`.
    axis_output: Option<AxisOutput>,
    /// Way along the tool axis to the first pose and away from the last pose, in mm. There is none where the
    /// first pose is reached by a rapid, as in `cl` and `nc`, and where the path ends with a rapid.
    #[schema(minimum = 0, maximum = 1000, default = 20)]
    retract_mm: Option<f64>,
    /// The tool. Its size counts in the tolerances. Without `tool` the program calls tool 1 with length
    /// offset 1.
    #[serde(default, deserialize_with = "object::optional")]
    tool: Option<Tool>,
    /// Spindle, coolant, the clearance plane and the traverse rate.
    #[serde(default, deserialize_with = "object::optional")]
    cutting: Option<Cutting>,
    /// How the NC program is written. Default: for LinuxCNC in mm.
    #[serde(default, deserialize_with = "object::optional")]
    program: Option<Program>,
    /// Time between two samples of the motion, in milliseconds. Without `?samples=true`, figures and pictures
    /// of a motion of more than 100,000 samples are made of as many, which are farther apart.
    #[schema(minimum = 0.01, maximum = 1000, default = 1)]
    sample_period_ms: Option<f64>,
    /// Up to 32 names with texts of your choice, for example part id, operation and work order. The answer
    /// and the sheet repeat the texts.
    #[schema(value_type = Option<MetaTexts>)]
    meta: Option<Meta>,
}

/// The tool at one place of the path.
#[derive(Debug, Clone, Copy, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
#[schema(as = ToolPose)]
pub struct SentPose {
    /// The tip of the tool, in mm.
    #[schema(value_type = Point)]
    tip: Point,
    /// The direction from the tip to the spindle, of any length: three plain numbers without a unit.
    #[schema(value_type = AxisDirection)]
    axis: Coordinates<3>,
    /// Speed of the tip on the way to this pose, in mm/min. Default: `feed_mm_per_min` of the request.
    #[schema(minimum = 0.001, maximum = 1_000_000)]
    feed_mm_per_min: Option<f64>,
    /// Whether the tool goes to this pose as a rapid.
    #[serde(default)]
    #[schema(default = false)]
    rapid: bool,
}

schema_of!(PoseList of SentPose, "Poses of a tool.", {
    array_of(reference::<SentPose>(), 2, Limits::DEFAULT.curve_points)
});

/// A request in the core's terms.
#[derive(Debug)]
pub struct SmoothJob {
    pub job: core::Job,
    pub setup: Setup,
    pub cutting: Option<CuttingRequest>,
    /// Whether the request says anything about a program.
    pub has_program: bool,
    pub meta: Option<Meta>,
    pub text: Carried,
}

impl IntoJob for SmoothRequest {
    type Job = SmoothJob;

    fn into_job(self, limits: &Limits) -> Result<SmoothJob, ApiError> {
        let Self {
            path,
            cl,
            nc,
            feed_mm_per_min,
            tolerance_mm,
            tolerance_deg,
            top_distance_mm,
            method,
            machine,
            at_pole,
            limits: sent_limits,
            axis_output,
            retract_mm,
            tool,
            cutting,
            program,
            sample_period_ms,
            meta,
        } = self;
        let root = Pointer::root();
        let mut violations = Violations::default();
        violations.optional(&root.field("feed_mm_per_min"), feed_mm_per_min, Range::POSITIVE, "mm/min");
        violations.number(&root.field("tolerance_mm"), tolerance_mm, TOLERANCE_MM, "mm");
        violations.number(&root.field("tolerance_deg"), tolerance_deg, TOLERANCE_DEG, "degrees");
        violations.optional(&root.field("top_distance_mm"), top_distance_mm, Range::POSITIVE, "mm");
        violations.optional(&root.field("retract_mm"), retract_mm, RETRACT_MM, "mm");
        violations.optional(&root.field("sample_period_ms"), sample_period_ms, PERIOD_MS, "ms");
        let is_sent = machine.is_some();
        let machine = machine.and_then(|sent| sent.convert(&root.field("machine"), &mut violations));
        // What speaks of the axes of a machine that is refused cannot be checked.
        let is_known = machine.is_some() || !is_sent;
        let motion = sent_limits
            .filter(|_| is_known)
            .map(|sent| sent.convert(&root.field("limits"), machine.as_ref(), &mut violations));
        let has_program = program.is_some() || cutting.is_some() || tool.is_some() || axis_output.is_some();
        let body = tool.as_ref().map(Tool::body).unwrap_or_default();
        let tool = tool.map(|tool| tool.convert_mill(&root.field("tool"), &mut violations));
        let swing_mm = tool.map_or(0.0, |tool| tool.swing_mm());
        let sent = SentSetup { tool, body, cutting, program: program.unwrap_or_default(), meta };
        let (mut setup, cutting, meta) = sent.convert(&mut violations);
        if !is_known {
            return Err(violations.into_error());
        }

        let top_mm = top_distance_mm.unwrap_or(core::DEFAULT_TOP_MM);
        let feed =
            feed_mm_per_min.and_then(FeedRate::from_mm_per_min).or(cutting.map(|cutting| cutting.feed));
        let given = Given { path, cl, nc };
        let part = |tolerance: f64| core::CHORDS * tolerance;
        let chords = Straying {
            tip_mm: part(tolerance_mm.max(TOLERANCE_MM.min)),
            axis: part(tolerance_deg.max(TOLERANCE_DEG.min).to_radians()),
        };
        let reading = ReadSettings { feed, limit: limits.curve_points, chords };
        let member = given.member();
        let text = given.read(machine.as_ref(), top_mm, reading, &mut violations);
        let (path, text) = Carried::new(text, member, &mut setup, cutting.as_ref(), &mut violations);

        let step_mm = setup.program.resolution.step_mm();
        let allowed =
            Straying { tip_mm: part(tolerance_mm).max(step_mm), axis: part(tolerance_deg.to_radians()) };
        setup.five_axes =
            AxisSetup::choose(axis_output, machine.clone(), setup.dialect, allowed, &mut violations);
        violations.result()?;
        if let (Some(five), Some(motion)) = (&mut setup.five_axes, &motion) {
            five.limit(motion);
        }
        let strays_mm = setup.five_axes.as_ref().map_or(0.0, AxisSetup::strays_mm);
        let job = core::Job {
            path,
            rapid_feed: cutting.and_then(|own| own.rapid_feed).unwrap_or(FeedRate::DEFAULT_RAPID),
            tolerance_mm,
            tolerance_axis: tolerance_deg.to_radians(),
            swing_mm,
            top_mm,
            method,
            period_s: sample_period_ms.map_or(core::DEFAULT_PERIOD_S, |ms| ms * 1e-3),
            machine,
            at_pole,
            limits: motion,
            sample_limit: limits.samples,
            wants_samples: true,
            move_limit: limits.moves,
            retract_mm: retract_mm.unwrap_or(core::DEFAULT_RETRACT_MM),
            in_step: setup.five_axes.as_ref().and_then(AxisSetup::in_step),
            // Half a unit along each coordinate.
            rounding_mm: 0.5 * 3f64.sqrt() * step_mm + strays_mm,
        };
        Ok(SmoothJob { job, setup, cutting, has_program, meta, text })
    }
}

/// The three forms of a path.
struct Given {
    path: Option<Vec<SentPose>>,
    cl: Option<String>,
    nc: Option<String>,
}

impl Given {
    /// The member that holds the text.
    fn member(&self) -> &'static str {
        if self.cl.is_some() { "cl" } else { "nc" }
    }

    /// The path in the core's terms, and what a text says beside it. Adds violations to `violations`.
    fn read(
        self,
        machine: Option<&Machine>,
        top_mm: f64,
        reading: ReadSettings,
        violations: &mut Violations,
    ) -> PathText {
        let root = Pointer::root();
        let told = |at: &str, read: Result<PathText, PathTextError>, violations: &mut Violations| {
            let at = root.field(at);
            match read {
                Ok(text) if text.path.len() < 2 => {
                    violations.add(&at, FieldCode::OutOfRange, "the text has fewer than two poses");
                    PathText::default()
                }
                Ok(text) => text,
                Err(error) => {
                    violations.add(&at, FieldCode::OutOfRange, messages::path_text(&error));
                    PathText::default()
                }
            }
        };
        match (self.path, self.cl, self.nc) {
            (Some(path), None, None) => PathText {
                path: waypoints(&path, &root.field("path"), reading, violations),
                ..PathText::default()
            },
            (None, Some(text), None) => told("cl", path_text::cl::read(&text, reading), violations),
            (None, None, Some(text)) => {
                told("nc", path_text::nc::read(&text, machine, top_mm, reading), violations)
            }
            (None, None, None) => {
                violations.add(&root.field("path"), FieldCode::MissingField, "send `path`, `cl` or `nc`");
                PathText::default()
            }
            _ => {
                violations.add(&root, FieldCode::Conflict, "send only one of `path`, `cl` and `nc`");
                PathText::default()
            }
        }
    }
}

/// Sent poses in the core's terms. Adds violations to `violations`.
fn waypoints(
    path: &[SentPose],
    at: &Pointer,
    reading: ReadSettings,
    violations: &mut Violations,
) -> Vec<Waypoint> {
    if !violations.count_of_points(at, path.len(), 2, reading.limit) {
        return Vec::new();
    }
    let mut waypoints = Vec::with_capacity(path.len());
    let mut is_feed_missing = false;
    for (k, SentPose { tip, axis, feed_mm_per_min, rapid }) in path.iter().enumerate() {
        if !tip.is_legal() {
            tip.check(&at.index(k).field("tip"), violations);
        }
        if feed_mm_per_min.is_some() {
            let at = at.index(k).field("feed_mm_per_min");
            violations.optional(&at, *feed_mm_per_min, Range::POSITIVE, "mm/min");
        }
        let feed = feed_mm_per_min.and_then(FeedRate::from_mm_per_min).or(reading.feed);
        let pace = match feed {
            Some(feed) if !rapid => Pace::Feed(feed),
            // The way to the first pose is no part of the path.
            None if !rapid && k > 0 => {
                is_feed_missing = true;
                Pace::Rapid
            }
            _ => Pace::Rapid,
        };
        if let Some(axis) = axis::unit(*axis, &at.index(k).field("axis"), violations) {
            waypoints.push(Waypoint::new(Pose { tip: Point3::from(*tip), axis }, pace));
        }
    }
    if is_feed_missing {
        let at = Pointer::root().field("feed_mm_per_min");
        violations.add(
            &at,
            FieldCode::FeedRequired,
            "poses have no feed of their own: send `feed_mm_per_min`",
        );
    }
    waypoints
}
