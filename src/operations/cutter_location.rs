//! Where a cutter that comes down at given places touches a surface.
//!
//! # Method
//! Direct contact ([`contact`](crate::geometry::contact)), each point with the one before as a first guess. Points are shared out
//! to threads in groups whose size does not depend on these.
//!
//! # Guarantees
//! Tips are proved to within [`Location::gap_mm`].
//!
//! # Cost
//! O(n log m) for n points and m patches.

use nalgebra::{Point2, Point3};

use crate::budget::{Budget, Stopped};
use crate::geometry::contact::{Contact, Contacts};
use crate::geometry::surface::source::{AnySurface, Source, SourceError};
use crate::geometry::surface::{BezierSurface, Patch};
use crate::operations::sharing::in_order;
use crate::toolpath::tool::Tool;

/// Points that follow each other on one thread.
const GROUP: usize = 256;

#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    pub surface: Source,
    pub tool: Tool,
    /// Where the axis is, mm.
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

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error(transparent)]
    Source(#[from] SourceError),
}

/// The location at each point; `None` beside the surface.
///
/// # Errors
/// When the data make no surface, or the budget stops.
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
    let groups: Vec<&[Point2<f64>]> = job.points.chunks(GROUP).collect();
    let located = in_order(groups.len(), |k| locate_group(&contacts, groups[k], budget))?;
    Ok(located.into_iter().flatten().collect())
}

fn locate_group<P: Patch>(
    contacts: &Contacts<P>,
    points: &[Point2<f64>],
    budget: &Budget,
) -> Result<Vec<Option<Location>>, Stopped> {
    budget.check()?;
    let mut before: Option<Contact> = None;
    let mut locations = Vec::with_capacity(points.len());
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
