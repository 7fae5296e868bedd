//! Finds where a cutter touches a surface when it comes down at given points of the plan.
//!
//! # Method
//! 1. Order the points so that the way through them is short: as given, or up and down along parallel strips.
//! 2. Divide the ordered points into groups, and the groups among threads. The size of a group does not
//!    depend on the number of threads.
//! 3. Drop the cutter at each point ([`drop_cutter`](crate::machining::drop_cutter)). If the previous point
//!    of the group is near, its contact is the start of the search.
//!
//! # Guarantees
//! The true tip is at the reported tip, or higher by at most [`Location::gap_mm`].
//!
//! # Cost
//! O(n log m) for n points and m patches.

use nalgebra::{Point2, Point3};

use crate::budget::{Budget, Progress, Stopped};
use crate::geometry::surface::any_surface::AnySurface;
use crate::geometry::surface::source::{Source, SourceError};
use crate::geometry::surface::{BezierSurface, Patch};
use crate::machining::drop_cutter::{Contact, Contacts};
use crate::toolpath::tool::Tool;

/// The number of points in a group, which one thread handles in order.
const GROUP: usize = 256;

/// The square of the number of strips divided by the number of points. For n points in a square, the way up
/// and down the strips is shortest with sqrt(n / 3) strips.
const STRIPS_SQUARED: f64 = 1.0 / 3.0;

#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    pub surface: Source,
    pub tool: Tool,
    /// The places of the axis, mm.
    pub points: Vec<Point2<f64>>,
}

/// A cutter that touches the surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Location {
    /// The tip, mm.
    pub tip: Point3<f64>,
    /// A point of the surface that the cutter touches, mm.
    pub contact: Point3<f64>,
    /// The true tip is at most this much higher, mm.
    pub gap_mm: f64,
}

/// Where the cutter touches.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema), schema(as = DropReport))]
pub struct Report {
    /// For each point the position of the cutter's tip, in mm, when the cutter, lowered from above, first
    /// touches the surface. `null` where the cutter misses the surface.
    #[cfg_attr(feature = "wire", schema(value_type = crate::wire::Places))]
    pub tips: Vec<Option<Point3<f64>>>,
    /// For each point a place where the cutter then touches the surface, in mm. `null` where the cutter
    /// misses the surface.
    #[cfg_attr(feature = "wire", schema(value_type = crate::wire::Places))]
    pub contacts: Vec<Option<Point3<f64>>>,
    /// Proved bound of how far a tip is below its exact height, in mm. No tip is above its exact height.
    /// Floating-point rounding is not included in either statement.
    pub gap_max_mm: f64,
}

impl Report {
    pub fn new(locations: &[Option<Location>]) -> Self {
        let all = || locations.iter();
        Self {
            tips: all().map(|at| at.map(|location| location.tip)).collect(),
            contacts: all().map(|at| at.map(|location| location.contact)).collect(),
            gap_max_mm: all().flatten().map(|location| location.gap_mm).fold(0.0, f64::max),
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Source(#[from] SourceError),
}

/// The location at each point; `None` where the cutter passes beside the surface.
///
/// # Errors
/// When the data make no surface, or the budget stops.
///
/// # Example
/// On a plane that rises 1 mm in 2 mm, a flat end of radius 5 mm touches with its rim.
///
/// ```
/// use nalgebra::{Point2, Point3};
/// use toolpathd_core::budget::Budget;
/// use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
/// use toolpathd_core::geometry::surface::source::Source;
/// use toolpathd_core::operations::cutter_location::{Job, locate};
/// use toolpathd_core::toolpath::tool::{Shape, Tool};
///
/// let points = [0.0, 40.0].map(|x| [0.0, 40.0].map(|y| Point3::new(x, y, x / 2.0)).to_vec()).to_vec();
/// let grid = PointGrid { points, twist: Twist::Spline, ends: Ends::Usual };
/// let surface = Source::PointGrid(grid);
/// let tool = Tool { shape: Shape::Flat, ..Tool::ball(5.0) };
/// let job = Job { surface, tool, points: vec![Point2::new(20.0, 20.0)] };
/// let location = locate(&job, &Budget::unlimited()).unwrap()[0].unwrap();
/// assert!((location.tip - Point3::new(20.0, 20.0, 12.5)).norm() < 1e-9);
/// assert!((location.contact - Point3::new(25.0, 20.0, 12.5)).norm() < 1e-6);
/// ```
pub fn locate(job: &Job, budget: &Budget) -> Result<Vec<Option<Location>>, Error> {
    match job.surface.surface()? {
        AnySurface::Bicubic(surface) => locate_on(&surface, job, budget),
        AnySurface::Rational(surface) => locate_on(&surface, job, budget),
        AnySurface::HighDegree(surface) => locate_on(&surface, job, budget),
    }
}

fn locate_on<P: Patch>(
    surface: &BezierSurface<P>,
    job: &Job,
    budget: &Budget,
) -> Result<Vec<Option<Location>>, Error> {
    let contacts = Contacts::new(surface, job.tool.cutter(), budget)?;
    let order = order(&job.points);
    let groups: Vec<&[usize]> = order.chunks(GROUP).collect();
    let progress = Progress::new("points", groups.len());
    let of_group = |k: usize| {
        let located = locate_group(&contacts, groups[k].iter().map(|&k| job.points[k]), budget);
        progress.tell_one(budget);
        located
    };
    let located = budget.in_order(groups.len(), of_group)?;
    let mut locations = vec![None; job.points.len()];
    for (k, location) in order.into_iter().zip(located.into_iter().flatten()) {
        locations[k] = location;
    }
    Ok(locations)
}

/// The indices of the points, in an order in which neighbours are close together.
fn order(points: &[Point2<f64>]) -> Vec<usize> {
    let along_strips = to_and_fro(points);
    let given: Vec<usize> = (0..points.len()).collect();
    let length = |order: &[usize]| -> f64 {
        order.windows(2).map(|pair| (points[pair[1]] - points[pair[0]]).norm()).sum()
    };
    if length(&along_strips) < length(&given) { along_strips } else { given }
}

/// The indices of the points along strips parallel to y, up and down in turn.
fn to_and_fro(points: &[Point2<f64>]) -> Vec<usize> {
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p.x), high.max(p.x)));
    let strips = (points.len() as f64 * STRIPS_SQUARED).sqrt().ceil();
    // If all x are equal, there is one strip.
    let strip = |p: &Point2<f64>| ((p.x - low) / (high - low) * strips).max(0.0) as usize;
    let key = |k: usize| {
        let p = &points[k];
        let strip = strip(p);
        (strip, if strip.is_multiple_of(2) { p.y } else { -p.y })
    };
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| {
        let ((strip_a, y_a), (strip_b, y_b)) = (key(a), key(b));
        strip_a.cmp(&strip_b).then(y_a.total_cmp(&y_b))
    });
    order
}

fn locate_group<P: Patch>(
    contacts: &Contacts<P>,
    points: impl Iterator<Item = Point2<f64>>,
    budget: &Budget,
) -> Result<Vec<Option<Location>>, Stopped> {
    budget.check()?;
    let mut before: Option<Contact> = None;
    let mut locations = Vec::with_capacity(GROUP);
    for point in points {
        let near = before.filter(|contact| (contact.tip.xy() - point).norm() <= contacts.cutter().radius());
        let found = contacts.drop(point.coords, near.map(|contact| contact.place), budget)?;
        locations.push(found.map(|contact| Location {
            tip: contact.tip,
            contact: contact.point,
            gap_mm: contact.gap_mm,
        }));
        before = found.or(before);
    }
    Ok(locations)
}
