//! The check of a route: what of the shape it leaves uncut, how near it comes to the walls, and where its
//! links run. It knows nothing of how the route was made.

use nalgebra::Point2;

use super::PocketError;
use super::conditions::Conditions;
use super::level::Shape;
use super::pieces::thinnest_mm;
use super::router::{Purpose, Run};
use crate::budget::Budget;
use crate::geometry::offset::swept;
use crate::geometry::region::{self, Outline, Region};
use crate::geometry::segment::Segment;

/// Uncut slivers that are thinner are forgiven, mm: a hundredth of a finishing allowance.
const SLIVER_MM: f64 = 0.02;

/// Parts of the boundary of what is swept that are shorter are rounding, mm.
const SPECK_MM: f64 = 1e-3;

/// The largest part of the reachable area that a valid route leaves uncut.
const UNCUT_PART: f64 = 5e-4;

/// How much nearer to a wall than its radius a cutter may come, mm: above the rounding of offsets.
const GOUGE_MM: f64 = 1e-5;

/// Distances from walls that are larger than this multiple of what is asked for are not told apart.
const FAR: f64 = 2.0;

/// The pattern `engagement` keeps the angle within this multiple of that of a straight pass.
const BOUNDED: f64 = 1.1;

/// A part of the path along which the angle of the cutter in the material is large.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = EngagementException))]
pub struct Exception {
    /// Where it begins, `[x, y]`, in mm.
    #[cfg_attr(feature = "wire", schema(value_type = [f64; 2]))]
    pub at: Point2<f64>,
    /// Its length, in mm.
    pub length_mm: f64,
    /// Proved largest angle, in degrees.
    pub angle_deg: f64,
}

/// Why a pattern is not valid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Invalid {
    #[error("it leaves {area_mm2:.3} mm2 uncut")]
    Uncut { area_mm2: f64 },
    #[error("it cuts {depth_mm:.4} mm into a wall near {at}")]
    Gouge { depth_mm: f64, at: Point2<f64> },
    #[error("a link runs through material near {at}")]
    LinkInMaterial { at: Point2<f64> },
}

/// The figures of a route that hold at any height.
#[derive(Debug, Clone, Default)]
pub struct Check {
    /// What the tool can reach and does not cut, mm².
    pub uncut_area_mm2: f64,
    /// The edges of the uncut places.
    pub uncut: Vec<Segment>,
    /// The largest angle in material, radians.
    pub engagement_max: f64,
    /// Where it is.
    pub engagement_max_at: Option<Point2<f64>>,
    /// The length on which the angle is above that of a straight pass, mm.
    pub engagement_over_length_mm: f64,
    /// Where the angle is far above that of a straight pass.
    pub exceptions: Vec<Exception>,
    /// Feed motion that cuts nothing, links included, mm.
    pub air_length_mm: f64,
    /// How near to a wall or an island the cutter comes where it does not cut along it, mm.
    pub side_mm: f64,
    /// Why the route is not valid.
    pub invalid_because: Option<Invalid>,
}

pub fn check(
    runs: &[Run],
    shape: &Shape,
    conditions: &Conditions,
    budget: &Budget,
) -> Result<Check, PocketError> {
    let mut check = Check::default();
    angles(runs, conditions, &mut check);
    let chains: Vec<Vec<Segment>> = runs.iter().map(Run::chain).collect();
    let all: Vec<&[Segment]> = chains.iter().chain(&shape.emptied).map(Vec::as_slice).collect();
    // What strokes leave as too thin is forgiven.
    let sliver_mm = SLIVER_MM.max(thinnest_mm(conditions.radius_mm));
    if shape.opened.is_some() {
        // What is swept may run beside material that no route has touched.
        let swept = Region::swept(&all, conditions.radius_mm, budget)?;
        let left = shape.reach.difference(&swept, budget)?;
        if !left.is_empty() && !left.offset_inward(0.5 * sliver_mm, budget)?.is_empty() {
            check.uncut = left.outlines().flat_map(Outline::elements).copied().collect();
            check.uncut_area_mm2 = left.area();
        }
    } else {
        let boundary = swept::boundary(&all, conditions.radius_mm, budget)?;
        let is_inside = |element: &&Segment| {
            element.length() > SPECK_MM && shape.reach.distance_to_boundary(element.at(0.5)) > sliver_mm
        };
        check.uncut = boundary.iter().filter(is_inside).copied().collect();
        if !check.uncut.is_empty() {
            check.uncut_area_mm2 = if shape.emptied.is_empty() {
                (shape.reach.area() - region::area(&boundary)).max(0.0)
            } else {
                // Emptied places may be outside the reach.
                let swept = Region::swept(&all, conditions.radius_mm, budget)?;
                shape.reach.difference(&swept, budget)?.area()
            };
        }
    }
    let allowed = UNCUT_PART * shape.reach.area();
    if check.uncut_area_mm2 > allowed {
        check.invalid_because = Some(Invalid::Uncut { area_mm2: check.uncut_area_mm2 });
    }
    let keeps = conditions.radius_mm + shape.allowance_mm;
    let limit = keeps - GOUGE_MM;
    for element in chains.iter().flatten() {
        let clearance = shape.pocket.clearance(element, keeps);
        if clearance < limit {
            let depth_mm = keeps - clearance;
            check.invalid_because = Some(Invalid::Gouge { depth_mm, at: element.at(0.5) });
        }
    }
    check.side_mm = side_mm(runs, shape, keeps);
    Ok(check)
}

/// How near to a wall or an island the cutter comes on its way down, up and from cut to cut, mm.
fn side_mm(runs: &[Run], shape: &Shape, keeps_mm: f64) -> f64 {
    let bound = keeps_mm + FAR * shape.room.side_mm;
    let mut least = bound;
    for run in runs {
        let links = run.steps.iter().filter(|step| step.purpose == Purpose::Link).map(|step| step.element);
        let [down, up] = run.ends().map(|end| Segment::Line { start: end, end });
        for element in run.entry.ways(run.start).into_iter().chain(links).chain([down, up]) {
            least = least.min(shape.pocket.clearance(&element, bound));
        }
    }
    (least - keeps_mm).max(0.0)
}

fn angles(runs: &[Run], conditions: &Conditions, check: &mut Check) {
    let limit = BOUNDED * conditions.straight_angle;
    let mut is_over = false;
    for step in runs.iter().flat_map(|run| &run.steps) {
        let length = step.element.length();
        for stretch in &step.angles {
            let own = (stretch.to - stretch.from) * length;
            let angle_deg = stretch.angle.to_degrees();
            let was_over = std::mem::replace(&mut is_over, stretch.angle > limit);
            match check.exceptions.last_mut() {
                Some(last) if is_over && was_over => {
                    last.length_mm += own;
                    last.angle_deg = last.angle_deg.max(angle_deg);
                }
                _ if is_over => {
                    let at = step.element.at(stretch.from);
                    check.exceptions.push(Exception { at, length_mm: own, angle_deg });
                }
                _ => {}
            }
            if stretch.is_clear() {
                check.air_length_mm += own;
            } else if step.purpose == Purpose::Link {
                let at = step.element.at(stretch.from);
                check.invalid_because = Some(Invalid::LinkInMaterial { at });
            }
            if stretch.angle > conditions.slot_angle {
                check.engagement_over_length_mm += own;
            }
            if stretch.angle > check.engagement_max {
                check.engagement_max = stretch.angle;
                check.engagement_max_at = Some(step.element.at(stretch.from));
            }
        }
    }
}
