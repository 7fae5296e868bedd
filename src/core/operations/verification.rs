//! Verifies a toolpath against the part, the stock, the fixtures and the travel of the machine.
//!
//! # Method
//! 1. Each move becomes one curve, or several for a rapid that a control may run as a dog-leg (`motions`).
//! 2. The depth of the cutter in the part is bounded on every curve (`gouges`): in a surface by
//!    [`gouge`](crate::machining::gouge), in a pocket by [`prism`](crate::machining::prism).
//! 3. What the moves leave of the stock is bounded by a height map ([`stock`](crate::machining::stock)).
//!    Before each move cuts, rapids, shank and holder are measured against it (`material`).
//! 4. Distances from fixtures and from the part, and places outside the travel, are bounded on every curve
//!    (`clearances`).
//! 5. What stands above a surface at the end is bounded by [`uncut`](crate::machining::uncut), what stands at
//!    the walls of a pocket by [`walls`](crate::machining::walls), and what stands over its floor by the
//!    height map (`left`).
//!
//! # Guarantees
//! * A bound holds over the whole of every move, with what the control may leave the path. It is found from
//!   the moves alone, whatever has made them.
//! * A finding is *certain* if it holds for every path that the control may run, and *possible* if the bound
//!   does not exclude it. The verdict is `Fail` with a certain finding, else `Undecided` with a possible one,
//!   else `Pass`.
//! * Rapids through stock are decided to within one and a half diagonals of a cell beside walls that the
//!   program has cut, and to within the tolerance everywhere else.
//!
//! # Degenerate input
//! Without feed moves nothing is removed, and what stands above a surface has no bound.
//!
//! # Cost
//! The sum of the costs of the proofs. Moves are shared out to threads in rows; the result does not depend on
//! their number.

mod clearances;
mod findings;
mod gouges;
mod left;
mod material;
mod motions;
mod part;

use std::f64::consts::PI;

use nalgebra::{Point2, Point3};

use super::pocketing::Outlines;
use crate::budget::{Budget, Stopped};
use crate::geometry::region::{Outline, OutlineError, Region, RegionError};
use crate::geometry::segment::Segment;
use crate::geometry::surface::source::{Source, SourceError};
use crate::machining::assembly::Assembly;
use crate::machining::prism::{Material, Prism};
use crate::machining::stock::{Shape, ShapeError, Stock, Volume};
use crate::toolpath::Toolpath;
pub use findings::{Certainty, Finding, Findings, Kind, MOST_LISTED, MoveNumber, Verdict};
use left::Left;
use motions::{Motion, motions};
use part::PartProof;

/// What is verified, against what.
#[derive(Debug, Clone)]
pub struct Job {
    pub toolpath: Toolpath,
    /// The tools; not empty.
    pub tools: Vec<Tool>,
    /// For each pass the index of its tool.
    pub tool_of_pass: Vec<usize>,
    pub part: Option<Part>,
    pub stock: Option<Raw>,
    /// Largest size of a cell of the height map, mm; chosen from stock and tools if absent.
    pub cell_mm: Option<f64>,
    pub most_cells: usize,
    pub fixtures: Vec<Fixture>,
    pub travel: Option<Travel>,
    /// How deep the cutter may enter the part and, on a rapid, the stock, mm.
    pub tolerance_mm: f64,
    /// How far the control may leave the path, mm.
    pub control_tolerance_mm: f64,
    /// The least distance of the tool from fixtures, and of shank and holder from all else, mm.
    pub clearance_mm: f64,
    /// How much may stand above the part at the end, mm; anything if absent.
    pub allowed_excess_mm: Option<f64>,
    pub rapids: Rapids,
    /// Whether the report has the bound of every move, and not only of the worst.
    pub lists_moves: bool,
}

/// A tool of the program.
#[derive(Debug, Clone, PartialEq)]
pub struct Tool {
    pub assembly: Assembly,
    /// Length of the cutting edges from the tip upwards, mm.
    pub flute_length_mm: Option<f64>,
}

/// The part that stays.
#[derive(Debug, Clone, PartialEq)]
pub enum Part {
    /// All below a surface.
    Surface { source: Source, allowance_mm: f64 },
    /// All outside the outlines below the top, and all below the floor.
    Pocket { outlines: Outlines, top_mm: f64, floor_mm: f64 },
}

/// The raw part.
#[derive(Debug, Clone, PartialEq)]
pub enum Raw {
    Block { low: Point3<f64>, high: Point3<f64> },
    Cylinder { center: Point2<f64>, radius_mm: f64, bottom_mm: f64, top_mm: f64 },
    Outline { outlines: Outlines, bottom_mm: f64, top_mm: f64 },
}

/// A clamp, a vice or a stop: material from far below up to a level top.
#[derive(Debug, Clone, PartialEq)]
pub struct Fixture {
    pub outlines: Outlines,
    /// Where it ends below, for pictures, mm. Nothing passes below it.
    pub bottom_mm: f64,
    pub top_mm: f64,
}

/// Where the tip may go.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Travel {
    pub low: Point3<f64>,
    pub high: Point3<f64>,
}

/// How a control runs a rapid along several axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Rapids {
    /// Along a straight line.
    Straight,
    /// Along a straight line, or with each axis at the same speed until it has arrived. Both are verified.
    DogLeg,
}

/// A figure with the move and the place where it was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// Proved bound, mm.
    pub bound_mm: f64,
    /// The largest depth, or the least distance, that was found, mm.
    pub found_mm: Option<f64>,
    pub at: Option<Point3<f64>>,
    /// The move of the bound.
    pub place: Option<MoveNumber>,
}

/// What is proved of a toolpath.
#[derive(Debug, Clone, PartialEq)]
pub struct Report {
    pub verdict: Verdict,
    /// How deep the cutter enters the part. `None` without a part.
    pub gouge: Option<Worst>,
    /// The same of each move, in order, where the job asks for it. Empty without a part.
    pub gouges_of_moves: Vec<Worst>,
    /// What stands above the part at the end. `None` where it has no bound.
    pub excess: Option<Worst>,
    /// Area of the floor of a pocket that is not cut down to the floor, mm². Places nearer to a wall than a
    /// diagonal of a cell count neither here nor in the excess.
    pub uncut_area_mm2: Option<f64>,
    /// What stands at the walls of a pocket where a cutter of the program can touch them, with the nearest
    /// move. `None` without a pocket, and where no cutter touches its walls.
    pub wall_excess: Option<Worst>,
    /// The least distance of shank and holder from stock and part. `None` without shank and holder.
    pub holder_clearance: Option<Worst>,
    /// The least distance of tool, shank and holder from fixtures. `None` without fixtures.
    pub fixture_clearance: Option<Worst>,
    /// What is known of the stock. `None` without stock.
    pub material: Option<MaterialReport>,
    pub findings: Findings,
}

/// What the program does to the stock.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialReport {
    pub before: Volume,
    pub after: Volume,
    /// Length of feed moves that remove nothing for certain, mm.
    pub air_length_mm: f64,
    /// How far the material that a feed move removes stands above the tip at most.
    pub depth: Option<Worst>,
    /// How deep a rapid enters the stock at most.
    pub rapid_depth: Worst,
    /// What is left.
    pub left: Stock,
}

/// The member of a job that outlines belong to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Owner {
    Part,
    Stock,
    Fixture(usize),
}

/// Why a toolpath is not verified.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("the tool axis leans or turns; only toolpaths with an upright tool are verified")]
    Leaning,
    #[error(transparent)]
    Source(#[from] SourceError),
    #[error("{}{error}", island.map_or_else(String::new, |k| format!("island {k}: ")))]
    Outline { owner: Owner, island: Option<usize>, error: OutlineError },
    #[error("{error}")]
    Region { owner: Owner, error: RegionError },
    #[error("the outlines enclose nothing")]
    Empty { owner: Owner },
    #[error(transparent)]
    Shape(ShapeError),
}

/// Verifies a toolpath.
///
/// # Errors
/// One of [`Error`].
///
/// # Example
/// A cutter runs 0.02 mm too deep along a pocket of 2 mm.
///
/// ```
/// use nalgebra::{Point2, Point3};
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::segment::Segment;
/// use toolpathd_core::machining::{assembly::Assembly, cutter::Cutter};
/// use toolpathd_core::operations::pocketing::Outlines;
/// use toolpathd_core::operations::verification::{Job, Part, Tool, Verdict, verify};
/// use toolpathd_core::toolpath::units::FeedRate;
/// use toolpathd_core::toolpath::{Role, Toolpath};
///
/// let corner = [[0.0, 0.0], [50.0, 0.0], [50.0, 30.0], [0.0, 30.0]].map(Point2::from);
/// let sides = [0, 1, 2, 3].map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] });
/// let outlines = Outlines { boundary: sides.to_vec(), islands: Vec::new() };
///
/// let mut builder = Toolpath::builder(Point3::new(10.0, 15.0, 5.0));
/// let feed = FeedRate::from_mm_per_min(500.0).unwrap();
/// builder.line(Point3::new(10.0, 15.0, -2.0), feed, Role::Plunge).unwrap();
/// builder.line(Point3::new(40.0, 15.0, -2.02), feed, Role::Cut).unwrap();
///
/// let tool = Tool { assembly: Assembly::bare(Cutter::bull_nose(5.0, 0.0)), flute_length_mm: None };
/// let part = Part::Pocket { outlines, top_mm: 0.0, floor_mm: -2.0 };
/// let job = Job { part: Some(part), ..Job::new(builder.finish().unwrap(), tool, 0.01) };
/// let report = verify(&job, &Budget::unlimited()).unwrap();
/// assert_eq!(report.verdict, Verdict::Fail);
/// assert!((report.gouge.unwrap().bound_mm - 0.02).abs() < 1e-4);
/// ```
pub fn verify(job: &Job, budget: &Budget) -> Result<Report, Error> {
    if !job.toolpath.is_upright() {
        return Err(Error::Leaning);
    }
    let motions = motions(job);
    let mut findings = Findings::default();
    let part = job.part.as_ref().map(|part| PartProof::new(part, budget)).transpose()?;
    let gouges = match &part {
        Some(part) => Some(gouges::deepest(part, job, &motions, &mut findings, budget)?),
        None => None,
    };
    let (gouge, gouges_of_moves) = gouges.unzip();
    let mut holder_clearance = match &part {
        Some(part) => clearances::of_part(part, job, &motions, &mut findings, budget)?,
        None => None,
    };
    let fixtures = job.fixtures.iter().enumerate().map(|(k, fixture)| {
        let region = region(&fixture.outlines, Owner::Fixture(k), budget)?;
        Ok(Prism { region, material: Material::Inside, top_mm: fixture.top_mm })
    });
    let fixtures = fixtures.collect::<Result<Vec<Prism>, Error>>()?;
    let fixture_clearance = clearances::of_fixtures(&fixtures, job, &motions, &mut findings, budget)?;
    clearances::travel(job, &motions, &mut findings);
    let raw = raw(job, part.as_ref(), budget)?;
    let run = raw.map(|raw| material::run(&raw, job, &motions, &mut findings, budget)).transpose()?;
    let (material, near_stock) = run.unzip();
    if let Some(near) = near_stock.flatten() {
        holder_clearance = Some(holder_clearance.map_or(near, |own| own.or_nearer(near)));
    }
    let left = match &part {
        Some(part) => left::of(part, job, &motions, material.as_ref(), &mut findings, budget)?,
        None => Left::default(),
    };
    findings.sort();
    Ok(Report {
        verdict: findings.verdict(),
        gouge,
        gouges_of_moves: gouges_of_moves.unwrap_or_default(),
        excess: left.excess,
        uncut_area_mm2: left.uncut_area_mm2,
        wall_excess: left.of_walls,
        holder_clearance,
        fixture_clearance,
        material,
        findings,
    })
}

impl Job {
    /// The job of verifying a toolpath of one tool, against nothing yet.
    pub fn new(toolpath: Toolpath, tool: Tool, tolerance_mm: f64) -> Self {
        let n_passes = toolpath.passes().len();
        Self {
            toolpath,
            tools: vec![tool],
            tool_of_pass: vec![0; n_passes],
            part: None,
            stock: None,
            cell_mm: None,
            most_cells: DEFAULT_MOST_CELLS,
            fixtures: Vec::new(),
            travel: None,
            tolerance_mm,
            control_tolerance_mm: 0.0,
            clearance_mm: 0.0,
            allowed_excess_mm: None,
            rapids: Rapids::Straight,
            lists_moves: false,
        }
    }

    fn tool(&self, motion: &Motion) -> &Tool {
        &self.tools[self.tool_of_pass[motion.place.pass]]
    }
}

/// The most cells of a job whose caller sets no limit.
pub const DEFAULT_MOST_CELLS: usize = 4_000_000;

impl Raw {
    /// The outlines of the raw part with the heights of its bottom and its top, mm.
    pub fn outlines(&self) -> (Outlines, f64, f64) {
        let of = |boundary: Vec<Segment>| Outlines { boundary, islands: Vec::new() };
        match self {
            Self::Block { low, high } => {
                let corners = [low.xy(), Point2::new(high.x, low.y), high.xy(), Point2::new(low.x, high.y)];
                let side = |k: usize| Segment::Line { start: corners[k], end: corners[(k + 1) % 4] };
                (of([0, 1, 2, 3].map(side).to_vec()), low.z, high.z)
            }
            Self::Cylinder { center, radius_mm, bottom_mm, top_mm } => {
                let [right, left] = [*radius_mm, -radius_mm].map(|x| Point2::new(center.x + x, center.y));
                let half = |ends| Segment::about(*center, *radius_mm, ends, PI);
                (of(vec![half([right, left]), half([left, right])]), *bottom_mm, *top_mm)
            }
            Self::Outline { outlines, bottom_mm, top_mm } => (outlines.clone(), *bottom_mm, *top_mm),
        }
    }
}

impl Worst {
    fn or_nearer(self, other: Self) -> Self {
        if other.bound_mm < self.bound_mm { other } else { self }
    }
}

/// The stock as it is before the first move: the job's, or else what a pocket is cut from.
fn raw(job: &Job, part: Option<&PartProof>, budget: &Budget) -> Result<Option<Shape>, Error> {
    let shape = match (&job.stock, part) {
        (Some(Raw::Block { low, high }), _) => Shape::Block { low: *low, high: *high },
        (Some(Raw::Cylinder { center, radius_mm, bottom_mm, top_mm }), _) => {
            Shape::Cylinder { center: *center, radius_mm: *radius_mm, bottom_mm: *bottom_mm, top_mm: *top_mm }
        }
        (Some(Raw::Outline { outlines, bottom_mm, top_mm }), _) => Shape::Outline {
            region: region(outlines, Owner::Stock, budget)?,
            bottom_mm: *bottom_mm,
            top_mm: *top_mm,
        },
        (None, Some(PartProof::Pocket { walls, floor_mm })) => {
            Shape::Outline { region: walls.region.clone(), bottom_mm: *floor_mm, top_mm: walls.top_mm }
        }
        (None, _) => return Ok(None),
    };
    Ok(Some(shape))
}

/// The region of outlines with islands.
fn region(outlines: &Outlines, owner: Owner, budget: &Budget) -> Result<Region, Error> {
    let outline = |elements, island| {
        Outline::new(elements, budget).map_err(|error| match error {
            OutlineError::Stopped(stopped) => Error::Stopped(stopped),
            error => Error::Outline { owner, island, error },
        })
    };
    let boundary = outline(&outlines.boundary, None)?;
    let islands = outlines.islands.iter().enumerate().map(|(k, island)| outline(island, Some(k)));
    let islands = islands.collect::<Result<Vec<_>, Error>>()?;
    let region = Region::new(&[boundary], &islands, budget).map_err(|error| match error {
        RegionError::Stopped(stopped) => Error::Stopped(stopped),
        error => Error::Region { owner, error },
    })?;
    if region.is_empty() { Err(Error::Empty { owner }) } else { Ok(region) }
}

impl From<ShapeError> for Error {
    fn from(error: ShapeError) -> Self {
        match error {
            ShapeError::Stopped(stopped) => Self::Stopped(stopped),
            error => Self::Shape(error),
        }
    }
}

#[cfg(test)]
mod tests;
