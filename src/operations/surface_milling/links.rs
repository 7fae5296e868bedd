//! Joins passes to one toolpath: straight links where they are clear and quicker, else retract and plunge.

use nalgebra::Point3;

use super::passes::CutPass;
use super::{CERTIFICATE_GAP, CutDirection, Error, Job};
use crate::budget::Budget;
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::curve::{Curve, Line};
use crate::geometry::surface::Patch;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::quantize::{Parabolas, quantize};
use crate::toolpath::{Builder, Role, Toolpath};

/// The toolpath of `passes`, from the clearance plane over the first to that over the last.
pub(super) fn join(
    job: &Job,
    cutting: &Cutting,
    passes: &[CutPass],
    clearance: &Clearance<impl Patch>,
    budget: &Budget,
) -> Result<Toolpath, Error> {
    let at_height = |p: Point3<f64>, z: f64| Point3::new(p.x, p.y, z);
    let mut builder = Toolpath::builder(at_height(passes[0].start(), cutting.clearance_z_mm));
    for (k, pass) in passes.iter().enumerate() {
        builder.begin_pass(None);
        let link = Line { start: builder.at(), end: pass.start() };
        if k > 0 && is_linked(job, cutting, &link, clearance, budget)? {
            builder.line(link.end, cutting.feed_of(Role::Link), Role::Link)?;
        } else {
            rapid_to(&mut builder, at_height(link.start, cutting.retract_z_mm))?;
            rapid_to(&mut builder, at_height(link.end, cutting.retract_z_mm))?;
            builder.line(link.end, cutting.feed_of(Role::Plunge), Role::Plunge)?;
        }
        for curve in &pass.curves {
            match curve {
                Curve::Line(line) => builder.line(line.end, cutting.feed, Role::Cut)?,
                Curve::Arc(arc) => {
                    let turn = (arc.plane(), arc.direction());
                    builder.arc(arc.end(), arc.center(), turn, cutting.feed, Role::Cut)?;
                }
                Curve::Parabola(parabola) => {
                    builder.parabola(parabola.end(), parabola.control(), cutting.feed, Role::Cut)?;
                }
            }
        }
    }
    let last = builder.at();
    rapid_to(&mut builder, at_height(last, cutting.clearance_z_mm))?;
    Ok(builder.finish()?)
}

fn rapid_to(builder: &mut Builder, to: Point3<f64>) -> Result<(), Error> {
    if builder.at() != to {
        builder.rapid(to)?;
    }
    Ok(())
}

/// Whether a straight link is quicker than a retract and proved to keep within the tolerance of the surface,
/// as computed and as written.
fn is_linked(
    job: &Job,
    cutting: &Cutting,
    link: &Line,
    clearance: &Clearance<impl Patch>,
    budget: &Budget,
) -> Result<bool, Error> {
    if job.direction == CutDirection::OneWay {
        return Ok(false);
    }
    let (up, down) = (cutting.retract_z_mm - link.start.z, cutting.retract_z_mm - link.end.z);
    let across = (link.end - link.start).xy().norm();
    let retract_min =
        (up + across) / cutting.rapid_feed.mm_per_min() + down / cutting.plunge_feed.mm_per_min();
    if link.length() / cutting.link_feed.mm_per_min() > retract_min {
        return Ok(false);
    }
    let gap = CERTIFICATE_GAP * job.tolerance.mm();
    let mut deepest = Penetration::NONE;
    let curve = Curve::Line(*link);
    clearance.penetrate(&curve, 0.0, gap, &mut deepest, budget)?;
    for written in quantize(&curve, job.resolution, Parabolas::AsLines)? {
        clearance.penetrate(&written.curve, written.slack_mm, gap, &mut deepest, budget)?;
    }
    Ok(deepest.bound_mm <= job.tolerance.mm() - gap)
}
