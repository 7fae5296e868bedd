//! What stands above the part behind the last move: over a surface, over the floor of a pocket, at its walls.

use nalgebra::{Point2, Point3, Vector3};

use super::findings::{Certainty, Finding, Findings, Kind, MoveNumber};
use super::motions::Motion;
use super::part::PartProof;
use super::{Error, Job, MaterialReport, Worst};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Curve;
use crate::geometry::region::{Containment, Region, RegionError};
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::cutter::Cutter;
use crate::machining::prism::Prism;
use crate::machining::uncut::{self, Reach, Swept, Wanted};
use crate::machining::walls::{Cleared, Slice, Swath, radius_at, thickest};

/// By how much the bound of what stands above a surface may exceed what was found: as a share of it, and as
/// a share of the tolerance.
const EXCESS_GAP_SHARE: f64 = 0.08;
const EXCESS_GAP: f64 = 0.05;

/// Parts of a surface smaller than this share of the gap count as points.
const SMALLEST_SHARE: f64 = 0.1;

/// The most parts of the search for what stands above a surface.
const PARTS: usize = 400_000;

/// By how much the bound of what stands at a wall may exceed what was found, as a share of the tolerance.
const WALL_GAP: f64 = 0.1;

/// How much farther than a cutter may stand from the walls a place has to lie that counts as reached, mm.
const TOUCH_MM: f64 = 1e-3;

/// What stands above the part at the end.
#[derive(Debug, Default)]
pub(super) struct Left {
    pub(super) excess: Option<Worst>,
    /// The area of a floor that is not cut down to it, mm².
    pub(super) uncut_area_mm2: Option<f64>,
    pub(super) of_walls: Option<Worst>,
}

/// Bounds what stands above the part. What exceeds the allowed excess becomes a finding.
pub(super) fn of(
    part: &PartProof,
    job: &Job,
    motions: &[Motion],
    material: Option<&MaterialReport>,
    findings: &mut Findings,
    budget: &Budget,
) -> Result<Left, Error> {
    match part {
        PartProof::Surface { surface, allowance_mm } => {
            let excess = match surface {
                AnySurface::Bicubic(surface) => excess(surface, *allowance_mm, job, motions, budget)?,
                AnySurface::Rational(surface) => excess(surface, *allowance_mm, job, motions, budget)?,
                AnySurface::HighDegree(surface) => excess(surface, *allowance_mm, job, motions, budget)?,
            };
            find(excess, job, motions, findings);
            Ok(Left { excess, ..Left::default() })
        }
        PartProof::Pocket { walls, floor_mm } => {
            let cutters = cutters(job, motions);
            let of_walls = at_walls(walls, *floor_mm, &cutters, job, motions, budget)?;
            find(of_walls, job, motions, findings);
            let Some(material) = material else { return Ok(Left { of_walls, ..Left::default() }) };
            let floor = Floor::new(walls, *floor_mm, &cutters, job, budget)?;
            let (excess, area, reached) = floor.above(material);
            find(reached, job, motions, findings);
            Ok(Left { excess: Some(excess), uncut_area_mm2: Some(area), of_walls })
        }
    }
}

/// The cutters of the feed moves.
fn cutters<'j>(job: &'j Job, motions: &[Motion]) -> Vec<&'j Cutter> {
    let is_used =
        |k: usize| motions.iter().any(|motion| !motion.is_rapid && job.tool_of_pass[motion.place.pass] == k);
    let used = job.tools.iter().enumerate().filter(|(k, _)| is_used(*k));
    used.map(|(_, tool)| &tool.assembly.cutter).collect()
}

/// The feed moves, each with its index in `motions`.
fn swaths<'j>(job: &'j Job, motions: &'j [Motion]) -> impl Iterator<Item = Swath<'j>> {
    let all = motions.iter().enumerate().filter(|(_, motion)| !motion.is_rapid);
    all.filter_map(|(number, motion)| {
        let cutter = &job.tool(motion).assembly.cutter;
        motion.along().map(|tip| Swath { tip, cutter, number })
    })
}

/// A finding where more stands than is allowed.
fn find(left: Option<Worst>, job: &Job, motions: &[Motion], findings: &mut Findings) {
    let Some((left, allowed)) = left.zip(job.allowed_excess_mm) else { return };
    if left.bound_mm <= allowed {
        return;
    }
    let nearest = || {
        let at = left.at?;
        let chord_mm = job.tolerance_mm;
        let level = Slice { z_mm: at.z + chord_mm, slack_mm: 0.0, chord_mm };
        let number = Cleared::new(swaths(job, motions), level).nearest_move(at.xy())?;
        Some(motions[number].place)
    };
    let place = left.place.or_else(nearest).or(motions.first().map(|motion| motion.place));
    let found = left.found_mm.unwrap_or(0.0);
    findings.add(Finding {
        kind: Kind::MaterialLeft,
        certainty: if found - job.control_tolerance_mm > allowed {
            Certainty::Certain
        } else {
            Certainty::Possible
        },
        place: place.unwrap_or(MoveNumber { pass: 0, index: 0, number: 0 }),
        at: left.at,
        found_mm: left.found_mm,
        bound_mm: left.bound_mm,
    });
}

/// Every place counts as reached: what stands there stands, whatever the cutter.
struct All;

impl Reach for All {
    fn is_reached(&self, _: &Point3<f64>, _: &Vector3<f64>, _: f64, _: &Budget) -> Result<bool, Stopped> {
        Ok(true)
    }
}

/// Whether a move begins where another one ends.
fn joined(one: &Motion, other: &Motion) -> bool {
    one.along().zip(other.along()).is_some_and(|(one, other)| one.end() == other.start())
}

/// What the feed moves of all tools together leave on a surface.
fn excess<P: Patch>(
    surface: &BezierSurface<P>,
    allowance_mm: f64,
    job: &Job,
    motions: &[Motion],
    budget: &Budget,
) -> Result<Option<Worst>, Error> {
    let gap_mm = EXCESS_GAP * job.tolerance_mm;
    let mut swept = Vec::new();
    let mut grain_mm = f64::INFINITY;
    for (k, tool) in job.tools.iter().enumerate() {
        let is_own = |motion: &Motion| job.tool_of_pass[motion.place.pass] == k && !motion.is_rapid;
        let runs: Vec<Vec<Curve>> = motions
            .chunk_by(|one, other| is_own(one) && is_own(other) && joined(one, other))
            .filter(|run| is_own(&run[0]))
            .map(|run| run.iter().filter_map(Motion::along).copied().collect())
            .collect();
        if runs.is_empty() {
            continue;
        }
        let slices = runs.iter().map(Vec::as_slice);
        let cutter = &tool.assembly.cutter;
        swept.push(Swept::new(cutter, allowance_mm, slices, job.control_tolerance_mm, gap_mm));
        grain_mm = cutter.radius().min(grain_mm);
    }
    if swept.is_empty() {
        return Ok(None);
    }
    let wanted = Wanted {
        gap_share: EXCESS_GAP_SHARE,
        gap_mm,
        target_mm: None,
        grain_mm,
        smallest_mm: SMALLEST_SHARE * gap_mm,
        part_limit: PARTS,
    };
    let left = uncut::left(surface, &swept, &All, wanted, budget)?.reached;
    Ok(left.bound_mm.is_finite().then_some(Worst {
        bound_mm: left.bound_mm,
        found_mm: Some(left.found_mm),
        at: left.place(),
        place: None,
    }))
}

/// What stands at the walls of a pocket, for each cutter where it can touch them. The walls are measured at
/// the height at which the cutter is widest while it stands on the floor.
fn at_walls(
    walls: &Prism,
    floor_mm: f64,
    cutters: &[&Cutter],
    job: &Job,
    motions: &[Motion],
    budget: &Budget,
) -> Result<Option<Worst>, Error> {
    let gap_mm = WALL_GAP * job.tolerance_mm;
    let mut worst: Option<Worst> = None;
    let mut looked: Vec<&Cutter> = Vec::new();
    for &cutter in cutters {
        if looked.contains(&cutter) {
            continue;
        }
        looked.push(cutter);
        let height = cutter.corner_radius().min(walls.top_mm - floor_mm);
        let Some(radius) = radius_at(cutter, height).filter(|radius| *radius > 0.0) else { continue };
        // A floor that is cut within the tolerance counts as cut.
        let z_mm = floor_mm + height + job.tolerance_mm + job.control_tolerance_mm;
        let level = Slice { z_mm, slack_mm: job.control_tolerance_mm, chord_mm: gap_mm };
        let cleared = Cleared::new(swaths(job, motions), level);
        let Some(own) = thickest(&walls.region, &cleared, radius, gap_mm, budget)? else { continue };
        if own.bound_mm.is_finite() && worst.is_none_or(|worst| own.bound_mm > worst.bound_mm) {
            worst = Some(Worst {
                bound_mm: own.bound_mm,
                found_mm: Some(own.found_mm),
                at: Some(Point3::new(own.at.x, own.at.y, floor_mm + height)),
                place: own.nearest.map(|number| motions[number].place),
            });
        }
    }
    Ok(worst)
}

/// The floor of a pocket.
struct Floor<'a> {
    walls: &'a Prism,
    floor_mm: f64,
    /// For each cutter where its axis may stand, and the radius of its flat, mm. Empty where nothing is asked
    /// of it.
    stands: Vec<(Region, f64)>,
    job: &'a Job,
}

impl<'a> Floor<'a> {
    fn new(
        walls: &'a Prism,
        floor_mm: f64,
        cutters: &[&Cutter],
        job: &'a Job,
        budget: &Budget,
    ) -> Result<Self, Error> {
        let mut stands = Vec::new();
        for cutter in cutters.iter().filter(|_| job.allowed_excess_mm.is_some()) {
            match walls.region.offset_inward(cutter.radius(), budget) {
                Ok(region) => stands.push((region, cutter.flat_radius())),
                Err(RegionError::Stopped(stopped)) => return Err(stopped.into()),
                // Without the offset no place counts as out of reach.
                Err(_) => stands.push((walls.region.clone(), f64::INFINITY)),
            }
        }
        Ok(Self { walls, floor_mm, stands, job })
    }

    /// Whether the flat of a cutter that enters no wall reaches all of a disc.
    fn is_reached(&self, center: Point2<f64>, radius: f64) -> bool {
        self.stands.iter().any(|(region, flat)| {
            let is_within = region.place(center, 0.0) == Containment::Inside;
            let away = if is_within { 0.0 } else { region.distance_to_boundary(center) };
            away + radius + TOUCH_MM <= *flat || (is_within && region.distance_to_boundary(center) >= radius)
        })
    }

    /// What stands above the floor inside the walls, farther than a diagonal of a cell from each wall; the
    /// area over which more than the tolerance stands, mm²; and what stands where a cutter reaches.
    fn above(&self, material: &MaterialReport) -> (Worst, f64, Option<Worst>) {
        let grid = material.left.grid();
        let none = Worst { bound_mm: 0.0, found_mm: None, at: None, place: None };
        let (mut worst, mut area, mut reached) = (none, 0.0, none);
        // A cell beside a wall may reach past what a cutter along the wall sweeps.
        let diagonal = 2.0 * grid.half_diagonal();
        let region = &self.walls.region;
        let place = |center, radius: f64| region.place(center, radius + diagonal);
        grid.divide([[0, grid.n[0]], [0, grid.n[1]]], &place, &mut |[columns, rows], own| {
            if own != Containment::Inside {
                return;
            }
            for (i, j) in (rows[0]..rows[1]).flat_map(|j| (columns[0]..columns[1]).map(move |i| (i, j))) {
                let [outer, inner] = material.left.cell(i, j);
                let above = outer - self.floor_mm;
                if above > self.job.tolerance_mm {
                    area += grid.cell.x * grid.cell.y;
                }
                let center = grid.corner(i, j) + 0.5 * grid.cell;
                let at = Some(Point3::new(center.x, center.y, outer));
                if above > worst.bound_mm {
                    (worst.bound_mm, worst.at) = (above, at);
                }
                let allowed = self.job.allowed_excess_mm.unwrap_or(f64::INFINITY);
                let is_more = |known: &Worst| {
                    let found = inner - self.floor_mm;
                    above > known.bound_mm || known.found_mm.is_none_or(|known| found > known.max(allowed))
                };
                if above > allowed && is_more(&reached) && self.is_reached(center, grid.half_diagonal()) {
                    let found = (inner - self.floor_mm).max(0.0);
                    if reached.found_mm.is_none_or(|known| found > known) {
                        (reached.found_mm, reached.at) = (Some(found), at);
                    }
                    reached.bound_mm = reached.bound_mm.max(above);
                }
            }
        });
        (worst, area, (reached.bound_mm > 0.0).then_some(reached))
    }
}
