//! The report on a program or a toolpath that was verified.

use nalgebra::Point3;
use serde::Serialize;
use utoipa::ToSchema;

use crate::http::dto::point::Point;
use toolpathd_core::machining::stock::Volume;
use toolpathd_core::operations::verification::{
    Certainty, Finding, Job, Kind, MaterialReport, MoveNumber, Report, Verdict, Worst,
};
use toolpathd_core::toolpath::units::rounded_up;

/// What is proved of a program or a toolpath. Bounds hold over the whole of every move, with what the control
/// may leave the path.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub struct VerifyReport {
    /// `fail` where something is certain to be wrong, else `undecided` where something may be, else `pass`.
    verdict: Verdict,
    /// How deep the cutter or its shank enters the part at most. `null` without a part.
    #[schema(required)]
    gouge_max_mm: Option<Figure>,
    /// Proved largest distance, in mm, from any place of a `surface` to the nearest place that the program
    /// cuts. Of a `region`: largest height that may stand over the floor, farther than a diagonal of a cell
    /// from each wall. Both count what no cutter can reach. With `allowance_mm` an estimate. `null` without a
    /// part, and where nothing is cut.
    #[schema(required)]
    excess_max_mm: Option<f64>,
    /// A place with `excess_max_mm`, in mm.
    #[schema(required)]
    excess_at: Option<Point>,
    /// Area of the floor of a `region`, in mm2, over which more than `tolerance_mm` may stand, farther than a
    /// diagonal of a cell from each wall. `null` without a `region`.
    #[schema(required)]
    uncut_area_mm2: Option<f64>,
    /// Proved largest distance, in mm, from any place of the walls of a `region` that a cutter of the program
    /// can touch to the nearest place that the program cuts, at the floor or where the rounded corner of the
    /// cutter ends. The move is the one nearest to the place. `null` without a `region`, and where no cutter
    /// that cuts touches a wall or nothing is cut.
    #[schema(required)]
    wall_excess_max_mm: Option<Figure>,
    /// Rapids that enter the part or the stock: those of `findings`.
    rapid_collisions: Vec<FindingReport>,
    /// How deep a rapid enters the stock at most. Beside walls that the program has cut the bound is as large
    /// as one and a half diagonals of a cell, which is no finding. `null` without stock.
    #[schema(required)]
    rapid_depth_max_mm: Option<Figure>,
    /// Least distance of shank and holder from stock and part; at most 50 mm is told. `null` without
    /// `holder`, and where there is neither stock nor part.
    #[schema(required)]
    holder_clearance_min_mm: Option<Figure>,
    /// Least distance of cutter, shank and holder from fixtures; at most 50 mm is told. `null` without
    /// `fixtures`.
    #[schema(required)]
    fixture_clearance_min_mm: Option<Figure>,
    /// Length of feed moves, in mm, that are not certain to remove anything. A move that removes a strip
    /// thinner than a cell may count. `null` without stock.
    #[schema(required)]
    air_length_mm: Option<f64>,
    /// How far the material that a feed move certainly removes stands above the tip at most. Material that is
    /// thinner than a cell may be missed. `null` without stock, and where nothing is certain to be removed.
    #[schema(required)]
    depth_max_mm: Option<Depth>,
    /// The volume of the stock before the first move, in mm3. `null` without stock.
    #[schema(required)]
    stock_volume_mm3: Option<VolumeReport>,
    /// The volume of the stock behind the last move, in mm3. `null` without stock.
    #[schema(required)]
    left_volume_mm3: Option<VolumeReport>,
    /// The size of a cell of the height map along x and y, in mm. `null` without stock.
    #[schema(required, value_type = Option<Vec<f64>>, min_items = 2, max_items = 2)]
    cell_mm: Option<[f64; 2]>,
    /// What is wrong or may be, the certain findings first; at most 1,000.
    findings: Vec<FindingReport>,
    /// How many findings there are of each kind, those that `findings` leaves out included.
    pub(super) counts: Vec<FindingCount>,
    /// What was not verified, because neither the request nor the program tells of it.
    pub(super) not_checked: Vec<NotChecked>,
    /// Number of moves that were verified.
    n_moves: usize,
    /// Number of rapids of the program from or to a place that is not known. They are not verified.
    n_rapids_not_counted: usize,
}

/// A proved bound, with the move that it belongs to.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct Figure {
    /// Proved bound: at least every depth, or at most every distance, in mm.
    bound: f64,
    /// The depth or the distance that was found at a place, in mm. `null` where none was.
    #[schema(required)]
    found: Option<f64>,
    /// That place, in mm: a point of the part, of the stock or of the path of the tip. `null` where there is
    /// none.
    #[schema(required)]
    at: Option<Point>,
    /// Number of the pass of the move with this bound, counted from 0. Absent where there is no such move, as
    /// are `move` and `line`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pass: Option<usize>,
    /// Number of the move in the pass, counted from 0.
    #[serde(rename = "move", skip_serializing_if = "Option::is_none")]
    index: Option<usize>,
    /// Number of the line of the program, counted from 1. Absent for a toolpath.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u32>,
}

/// A move of the toolpath, with its line of the program.
#[derive(Debug, Clone, Copy)]
struct MovePlace {
    pass: usize,
    index: usize,
    line: Option<u32>,
}

/// The depth of a cut.
#[derive(Debug, Clone, Serialize, ToSchema)]
#[schema(as = CutDepth)]
struct Depth {
    /// The depth that was found, in mm.
    found: f64,
    /// The top of the material there, in mm.
    #[schema(required)]
    at: Option<Point>,
    /// Number of the pass, counted from 0.
    pass: usize,
    /// Number of the move in the pass, counted from 0.
    #[serde(rename = "move")]
    index: usize,
    /// Number of the line of the program, counted from 1. Absent for a toolpath.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u32>,
}

/// One thing that is wrong, or may be.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct FindingReport {
    /// What the finding is about.
    kind: Kind,
    /// Whether it holds for every path that the control may run.
    certainty: Certainty,
    /// Number of the pass, counted from 0.
    pass: usize,
    /// Number of the move in the pass, counted from 0.
    #[serde(rename = "move")]
    index: usize,
    /// Number of the line of the program, counted from 1. Absent for a toolpath.
    #[serde(skip_serializing_if = "Option::is_none")]
    line: Option<u32>,
    /// A place of it, in mm. `null` where none is known.
    #[schema(required)]
    at: Option<Point>,
    /// Proved bound, in mm: of a depth, of a distance, or of how far a limit is exceeded.
    bound_mm: f64,
    /// The depth, the distance or the excess that was found, in mm. `null` where none was.
    #[schema(required)]
    found_mm: Option<f64>,
    /// The finding in words.
    detail: String,
}

/// How many findings there are of one kind.
#[derive(Debug, Clone, Serialize, ToSchema)]
pub(super) struct FindingCount {
    /// What the findings are about.
    kind: Kind,
    /// Whether they hold for every path that the control may run.
    certainty: Certainty,
    /// Number of such findings; it has no unit.
    count: usize,
}

/// A volume between two proved bounds.
#[derive(Debug, Clone, Serialize, ToSchema)]
struct VolumeReport {
    /// The volume is at least this, in mm3.
    least: f64,
    /// The volume is at most this, in mm3.
    most: f64,
}

/// What was not verified, or not on all moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
pub(super) enum NotChecked {
    /// Without `surface` and `region`.
    Part,
    /// Without `stock`.
    Stock,
    /// Where a tool has no `holder`.
    Holder,
    /// Without `fixtures`.
    Fixtures,
    /// Without `travel`.
    Travel,
    /// Where a tool has no `flute_length_mm`, and without stock.
    Flutes,
    /// Rapids of the program from or to a place that is not known. Where such a rapid ends at a known place,
    /// the place is verified.
    Rapids,
}

/// Whether the request tells of the holders and of the flutes of all tools.
pub struct Told {
    pub holders: bool,
    pub flutes: bool,
}

/// The lines of the moves of a program.
pub struct Lines<'a> {
    pub of_moves: &'a [u32],
    pub n_rapids_not_counted: usize,
}

impl VerifyReport {
    pub fn new(report: &Report, job: &Job, told: &Told, lines: Option<&Lines<'_>>) -> Self {
        let place = |place: MoveNumber| MovePlace {
            pass: place.pass,
            index: place.index,
            line: lines.and_then(|lines| lines.of_moves.get(place.number).copied()),
        };
        let figure = |worst: &Worst| Figure {
            bound: worst.bound_mm,
            found: worst.found_mm,
            at: worst.at.map(Point::from),
            pass: worst.place.map(|place| place.pass),
            index: worst.place.map(|place| place.index),
            line: worst.place.and_then(|own| place(own).line),
        };
        let depth = |worst: &Worst| {
            let MovePlace { pass, index, line } = place(worst.place?);
            Some(Depth { found: worst.bound_mm, at: worst.at.map(Point::from), pass, index, line })
        };
        let findings: Vec<FindingReport> = report
            .findings
            .listed
            .iter()
            .map(|finding| FindingReport::new(finding, place(finding.place)))
            .collect();
        let is_rapid = |kind| matches!(kind, Kind::RapidThroughPart | Kind::RapidThroughStock);
        let counts = report.findings.counts.iter();
        let material = report.material.as_ref();
        let n_rapids_not_counted = lines.map_or(0, |lines| lines.n_rapids_not_counted);
        Self {
            verdict: report.verdict,
            gouge_max_mm: report.gouge.as_ref().map(figure),
            excess_max_mm: report.excess.map(|worst| worst.bound_mm),
            excess_at: report.excess.and_then(|worst| worst.at).map(Point::from),
            uncut_area_mm2: report.uncut_area_mm2,
            wall_excess_max_mm: report.wall_excess.as_ref().map(figure),
            rapid_collisions: findings.iter().filter(|finding| is_rapid(finding.kind)).cloned().collect(),
            rapid_depth_max_mm: material.map(|material| figure(&material.rapid_depth)),
            holder_clearance_min_mm: report.holder_clearance.as_ref().map(figure),
            fixture_clearance_min_mm: report.fixture_clearance.as_ref().map(figure),
            air_length_mm: material.map(|material| material.air_length_mm),
            depth_max_mm: material.and_then(|material| material.depth.as_ref()).and_then(depth),
            stock_volume_mm3: material.map(|material| material.before.into()),
            left_volume_mm3: material.map(|material| material.after.into()),
            cell_mm: material.map(|MaterialReport { left, .. }| left.grid().cell.into()),
            findings,
            counts: counts
                .map(|(&(kind, certainty), &count)| FindingCount { kind, certainty, count })
                .collect(),
            not_checked: not_checked(job, told, material.is_some(), n_rapids_not_counted),
            n_moves: job.toolpath.moves().count(),
            n_rapids_not_counted,
        }
    }
}

impl VerifyReport {
    /// The verdict and the first findings, as sentences.
    pub fn sentences(&self, most: usize) -> Vec<String> {
        let verdict = match self.verdict {
            Verdict::Pass => "pass",
            Verdict::Fail => "fail",
            Verdict::Undecided => "undecided",
        };
        let total: usize = self.counts.iter().map(|count| count.count).sum();
        let found = match total {
            0 => format!("verdict: {verdict}, no findings"),
            1 => format!("verdict: {verdict}, 1 finding"),
            n => format!("verdict: {verdict}, {n} findings"),
        };
        let first = self.findings.iter().take(most).map(|finding| finding.detail.clone());
        std::iter::once(found).chain(first).collect()
    }
}

fn not_checked(job: &Job, told: &Told, has_stock: bool, n_rapids_not_counted: usize) -> Vec<NotChecked> {
    let has_part = job.part.is_some();
    let checked = [
        (NotChecked::Part, has_part),
        (NotChecked::Stock, has_stock),
        (NotChecked::Holder, told.holders && (has_stock || has_part)),
        (NotChecked::Fixtures, !job.fixtures.is_empty()),
        (NotChecked::Travel, job.travel.is_some()),
        (NotChecked::Flutes, told.flutes && has_stock),
        (NotChecked::Rapids, n_rapids_not_counted == 0),
    ];
    checked.into_iter().filter(|(_, is_checked)| !is_checked).map(|(name, _)| name).collect()
}

impl FindingReport {
    fn new(finding: &Finding, place: MovePlace) -> Self {
        let Finding { kind, certainty, at, found_mm, bound_mm, .. } = *finding;
        let detail = detail(kind, certainty, (found_mm, bound_mm), place, at);
        let MovePlace { pass, index, line } = place;
        Self { kind, certainty, pass, index, line, at: at.map(Point::from), bound_mm, found_mm, detail }
    }
}

/// The sentence of a finding.
fn detail(
    kind: Kind,
    certainty: Certainty,
    (found_mm, bound_mm): (Option<f64>, f64),
    place: MovePlace,
    at: Option<Point3<f64>>,
) -> String {
    let who = match place.line {
        Some(line) => format!("line {line}"),
        None => format!("move {} of pass {}", place.index, place.pass),
    };
    let verb = |certain, possible| if certainty == Certainty::Certain { certain } else { possible };
    let depth = if certainty == Certainty::Certain {
        format!("{:.4} mm", found_mm.unwrap_or(bound_mm))
    } else {
        format!("up to {:.4} mm", rounded_up(bound_mm))
    };
    let does = match kind {
        Kind::Gouge => format!("{} {depth} into the part", verb("the cutter cuts", "the cutter may cut")),
        Kind::RapidThroughPart => {
            format!("the rapid {} {depth} into the part", verb("runs", "may run"))
        }
        Kind::RapidThroughStock => {
            format!("the rapid {} {depth} into the stock", verb("runs", "may run"))
        }
        Kind::HolderNearStock | Kind::HolderNearPart | Kind::FixtureNear => {
            let (what, from) = match kind {
                Kind::HolderNearStock => ("shank or holder", "the stock"),
                Kind::HolderNearPart => ("shank or holder", "the part"),
                _ => ("the tool", "a fixture"),
            };
            match (certainty, found_mm) {
                (Certainty::Certain, Some(0.0)) => format!("{what} meets {from}"),
                (Certainty::Certain, Some(found)) => format!("{what} comes within {found:.4} mm of {from}"),
                _ if bound_mm == 0.0 => format!("{what} may meet {from}"),
                _ => format!("{what} may come within {bound_mm:.4} mm of {from}"),
            }
        }
        Kind::OutsideTravel => format!("the tip {} the travel by {depth}", verb("leaves", "may leave")),
        Kind::DeeperThanFlutes => format!("the material stands {depth} above the cutting edges"),
        Kind::MaterialLeft => {
            format!("{} {depth} above the part", verb("at the end there stand", "at the end there may stand"))
        }
    };
    let near = at.map_or_else(String::new, |at| format!(", near ({:.3}, {:.3}, {:.3})", at.x, at.y, at.z));
    format!("{who}: {does}{near}")
}

impl From<Volume> for VolumeReport {
    fn from(Volume { least_mm3, most_mm3 }: Volume) -> Self {
        Self { least: least_mm3, most: most_mm3 }
    }
}
