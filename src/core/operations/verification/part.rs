//! The part that stays: a surface, or the walls and the floor of a pocket.

use nalgebra::{Point3, Vector3};

use super::motions::{Motion, farthest};
use super::{Error, Job, MaterialReport, Owner, Part, Worst, region};
use crate::budget::{Budget, Stopped};
use crate::geometry::curve::Curve;
use crate::geometry::region::Containment;
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::cutter::Cutter;
use crate::machining::gouge::{GougeProof, Penetration};
use crate::machining::prism::{Asked, Material, Prism, depth_in_floor};
use crate::machining::uncut::{self, Leftover, Reach, Swept, Wanted};

/// By how much the bound of what stands above a surface may exceed what was found: as a share of it, and as
/// a share of the tolerance.
const EXCESS_GAP_SHARE: f64 = 0.08;
const EXCESS_GAP: f64 = 0.05;

/// Parts of a surface smaller than this share of the gap count as points.
const SMALLEST_SHARE: f64 = 0.1;

/// The most parts of the search for what stands above a surface.
const PARTS: usize = 400_000;

/// A part, ready for proofs.
pub(super) enum PartProof {
    Surface { surface: AnySurface, allowance_mm: f64 },
    Pocket { walls: Prism, floor_mm: f64 },
}

/// How deep a tool enters the part on one curve.
pub(super) trait Depths: Sync {
    /// # Errors
    /// Only the budget's stop.
    fn penetration(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        known: Penetration,
        budget: &Budget,
    ) -> Result<Penetration, Stopped>;
}

impl PartProof {
    pub(super) fn new(part: &Part, budget: &Budget) -> Result<Self, Error> {
        Ok(match part {
            Part::Surface { source, allowance_mm } => {
                Self::Surface { surface: source.surface()?, allowance_mm: *allowance_mm }
            }
            Part::Pocket { outlines, top_mm, floor_mm } => {
                let region = region(outlines, Owner::Part, budget)?;
                let walls = Prism { region, material: Material::Outside, top_mm: *top_mm };
                Self::Pocket { walls, floor_mm: *floor_mm }
            }
        })
    }

    /// How deep the moves of a cutter enter the part. A surface is grown by `by` mm along its normals.
    pub(super) fn depths(&self, cutter: &Cutter, by: f64) -> Box<dyn Depths + '_> {
        match self {
            Self::Surface { surface, allowance_mm } => {
                let by = by + allowance_mm;
                match surface {
                    AnySurface::Bicubic(surface) => Box::new(GougeProof::new(surface, cutter, by)),
                    AnySurface::Rational(surface) => Box::new(GougeProof::new(surface, cutter, by)),
                    AnySurface::HighDegree(surface) => Box::new(GougeProof::new(surface, cutter, by)),
                }
            }
            Self::Pocket { walls, floor_mm } => {
                Box::new(PocketProof { walls, floor_mm: *floor_mm, cutter: *cutter })
            }
        }
    }

    /// What stands above the part at the end, and the area of a floor that is not cut down to it, mm².
    pub(super) fn left(
        &self,
        job: &Job,
        motions: &[Motion],
        material: Option<&MaterialReport>,
        budget: &Budget,
    ) -> Result<(Option<Worst>, Option<f64>), Error> {
        match self {
            Self::Surface { surface, allowance_mm } => {
                let excess = match surface {
                    AnySurface::Bicubic(surface) => excess(surface, *allowance_mm, job, motions, budget)?,
                    AnySurface::Rational(surface) => excess(surface, *allowance_mm, job, motions, budget)?,
                    AnySurface::HighDegree(surface) => excess(surface, *allowance_mm, job, motions, budget)?,
                };
                Ok((excess, None))
            }
            Self::Pocket { walls, floor_mm } => {
                Ok(material.map_or((None, None), |material| above_floor(walls, *floor_mm, job, material)))
            }
        }
    }
}

impl<P: Patch> Depths for GougeProof<'_, P> {
    fn penetration(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        known: Penetration,
        budget: &Budget,
    ) -> Result<Penetration, Stopped> {
        let mut deepest = known;
        self.penetrate(tip, slack, gap, &mut deepest, budget)?;
        Ok(deepest)
    }
}

/// The walls and the floor of a pocket, for one cutter.
struct PocketProof<'a> {
    walls: &'a Prism,
    floor_mm: f64,
    cutter: Cutter,
}

impl Depths for PocketProof<'_> {
    fn penetration(
        &self,
        tip: &Curve,
        slack: f64,
        gap: f64,
        known: Penetration,
        budget: &Budget,
    ) -> Result<Penetration, Stopped> {
        let asked =
            Asked { slack_mm: slack, gap_mm: gap, enough_mm: known.bound_mm.max(known.found_mm + gap) };
        let of_walls = self.walls.depth(&self.cutter, tip, asked, budget)?;
        let walls = Penetration {
            bound_mm: of_walls.bound.max(0.0),
            found_mm: of_walls.found.max(0.0),
            at: of_walls.at,
        };
        let lowest = farthest(tip, 2, -1.0);
        let least = -tip.support(&-Vector3::z());
        let depth = |z: f64| depth_in_floor(&self.cutter, self.floor_mm, z).max(0.0);
        let floor =
            Penetration { bound_mm: depth(least - slack), found_mm: depth(lowest.z), at: Some(lowest) };
        let own = walls.or_deeper(floor);
        Ok(known.or_deeper(Penetration { at: own.at.filter(|_| own.found_mm > 0.0), ..own }))
    }
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

/// What the feed moves leave on a surface. Of several tools the one that leaves least counts: what it leaves
/// bounds what all leave together.
fn excess<P: Patch>(
    surface: &BezierSurface<P>,
    allowance_mm: f64,
    job: &Job,
    motions: &[Motion],
    budget: &Budget,
) -> Result<Option<Worst>, Error> {
    let gap_mm = EXCESS_GAP * job.tolerance_mm;
    let mut least: Option<Leftover> = None;
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
        let swept = Swept::new(cutter, allowance_mm, slices, job.control_tolerance_mm, gap_mm);
        let wanted = Wanted {
            gap_share: EXCESS_GAP_SHARE,
            gap_mm,
            target_mm: None,
            grain_mm: cutter.radius(),
            smallest_mm: SMALLEST_SHARE * gap_mm,
            part_limit: PARTS,
        };
        let left = uncut::left(surface, &swept, &All, wanted, budget)?.reached;
        if least.is_none_or(|least| left.bound_mm < least.bound_mm) {
            least = Some(left);
        }
    }
    Ok(least.filter(|left| left.bound_mm.is_finite()).map(|left| Worst {
        bound_mm: left.bound_mm,
        found_mm: Some(left.found_mm),
        at: left.place(),
        place: None,
    }))
}

/// What stands above the floor inside the walls, farther than a diagonal of a cell from each wall.
fn above_floor(
    walls: &Prism,
    floor_mm: f64,
    job: &Job,
    material: &MaterialReport,
) -> (Option<Worst>, Option<f64>) {
    let grid = material.left.grid();
    let mut worst = Worst { bound_mm: 0.0, found_mm: None, at: None, place: None };
    let mut area = 0.0;
    // A cell beside a wall may reach past what a cutter along the wall sweeps.
    let diagonal = 2.0 * grid.half_diagonal();
    let place = |center, radius: f64| walls.region.place(center, radius + diagonal);
    grid.divide([[0, grid.n[0]], [0, grid.n[1]]], &place, &mut |[columns, rows], own| {
        if own != Containment::Inside {
            return;
        }
        for (i, j) in (rows[0]..rows[1]).flat_map(|j| (columns[0]..columns[1]).map(move |i| (i, j))) {
            let [outer, _] = material.left.cell(i, j);
            let above = outer - floor_mm;
            if above > job.tolerance_mm {
                area += grid.cell.x * grid.cell.y;
            }
            if above > worst.bound_mm {
                let center = grid.corner(i, j) + 0.5 * grid.cell;
                worst.bound_mm = above;
                worst.at = Some(Point3::new(center.x, center.y, outer));
            }
        }
    });
    (Some(worst), Some(area))
}
