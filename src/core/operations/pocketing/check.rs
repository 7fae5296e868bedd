//! The check of a route: what of the shape it leaves uncut, how near it comes to the walls, and where its
//! links run. It knows nothing of how the route was made.

use nalgebra::Point2;

use super::PocketError;
use super::conditions::Conditions;
use super::level::Shape;
use super::router::{Purpose, Run};
use crate::budget::Budget;
use crate::geometry::element::Element;
use crate::geometry::offset::swept;
use crate::geometry::region::{self, Region};

/// Uncut slivers that are thinner are forgiven, mm: a hundredth of a finishing allowance.
const SLIVER_MM: f64 = 0.02;

/// Parts of the boundary of what is swept that are shorter are rounding, mm.
const SPECK_MM: f64 = 1e-3;

/// The largest part of the reachable area that a valid route leaves uncut.
const UNCUT_PART: f64 = 5e-4;

/// How much nearer to a wall than its radius a cutter may come, mm: above the rounding of offsets.
const GOUGE_MM: f64 = 1e-5;

/// The pattern `engagement` keeps the angle within this multiple of that of a straight pass.
const BOUNDED: f64 = 1.1;

/// A part of a route along which the angle is more than 1.1 of that of a straight pass.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Exception {
    pub at: Point2<f64>,
    pub length_mm: f64,
    /// The largest angle, radians.
    pub angle: f64,
}

/// The figures of a route that hold at any height.
#[derive(Debug, Clone, Default)]
pub struct Check {
    /// What the tool can reach and does not cut, mm².
    pub uncut_area_mm2: f64,
    /// The edges of the uncut places.
    pub uncut: Vec<Element>,
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
    /// Why the route is not valid.
    pub invalid_because: Option<String>,
}

pub fn check(
    runs: &[Run],
    shape: &Shape,
    conditions: &Conditions,
    budget: &Budget,
) -> Result<Check, PocketError> {
    let mut check = Check::default();
    angles(runs, conditions, &mut check);
    let chains: Vec<Vec<Element>> = runs.iter().map(Run::chain).collect();
    let all: Vec<&[Element]> = chains.iter().chain(&shape.emptied).map(Vec::as_slice).collect();
    let boundary = swept::boundary(&all, conditions.radius_mm, budget)?;
    let is_inside = |element: &&Element| {
        element.length() > SPECK_MM && shape.reach.distance_to_boundary(element.at(0.5)) > SLIVER_MM
    };
    check.uncut = boundary.iter().filter(is_inside).copied().collect();
    if !check.uncut.is_empty() {
        check.uncut_area_mm2 = if shape.emptied.is_empty() {
            (shape.reach.area() - region::area(&boundary)).max(0.0)
        } else {
            // Emptied places may be outside the reach.
            let swept = Region::on_the_left(&[boundary], budget)?;
            shape.reach.difference(&swept, budget)?.area()
        };
    }
    let allowed = UNCUT_PART * shape.reach.area();
    if check.uncut_area_mm2 > allowed {
        check.invalid_because = Some(format!("it leaves {:.3} mm2 uncut", check.uncut_area_mm2));
    }
    let limit = conditions.radius_mm - GOUGE_MM;
    for element in chains.iter().flatten() {
        let clearance = shape.pocket.clearance(element, conditions.radius_mm);
        if clearance < limit {
            let gouge = conditions.radius_mm - clearance;
            check.invalid_because =
                Some(format!("it cuts {gouge:.4} mm into a wall near {}", element.at(0.5)));
        }
    }
    Ok(check)
}

fn angles(runs: &[Run], conditions: &Conditions, check: &mut Check) {
    let limit = BOUNDED * conditions.straight_angle;
    let mut is_over = false;
    for step in runs.iter().flat_map(|run| &run.steps) {
        let length = step.element.length();
        for stretch in &step.angles {
            let own = (stretch.to - stretch.from) * length;
            let was_over = std::mem::replace(&mut is_over, stretch.angle > limit);
            match check.exceptions.last_mut() {
                Some(last) if is_over && was_over => {
                    last.length_mm += own;
                    last.angle = last.angle.max(stretch.angle);
                }
                _ if is_over => {
                    let at = step.element.at(stretch.from);
                    check.exceptions.push(Exception { at, length_mm: own, angle: stretch.angle });
                }
                _ => {}
            }
            if stretch.is_clear() {
                check.air_length_mm += own;
            } else if step.purpose == Purpose::Link {
                let at = step.element.at(stretch.from);
                check.invalid_because = Some(format!("a link runs through material near {at}"));
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
