//! Joins passes to one toolpath: straight links where they are clear and quicker, else retract and plunge.

use nalgebra::Point3;

use super::passes::CutPass;
use super::{CERTIFICATE_GAP, CutDirection, Error, Job, certificate};
use crate::budget::Budget;
use crate::geometry::curve::{Curve, Line};
use crate::geometry::gouge::{GougeProof, Penetration};
use crate::geometry::surface::Patch;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::{Builder, Role, Toolpath};

/// The toolpath of `passes`, from the clearance plane over the first to that over the last.
pub(super) fn join(
    job: &Job,
    cutting: &Cutting,
    passes: &[CutPass],
    proof: &GougeProof<impl Patch>,
    budget: &Budget,
) -> Result<Toolpath, Error> {
    let at_height = |p: Point3<f64>, z: f64| Point3::new(p.x, p.y, z);
    let mut builder = Toolpath::builder(at_height(passes[0].start(), cutting.clearance_z_mm));
    for (k, pass) in passes.iter().enumerate() {
        builder.begin_pass(None);
        let link = Line { start: builder.at(), end: pass.start() };
        budget.check()?;
        let may_link = k > 0 && job.direction == CutDirection::Zigzag && is_quicker(cutting, &link);
        if may_link && is_clear(&link, proof, job, budget)? {
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

/// Whether a straight link is proved to cut no deeper than the tolerance, as computed and as written.
fn is_clear(link: &Line, proof: &GougeProof<impl Patch>, job: &Job, budget: &Budget) -> Result<bool, Error> {
    let gap = CERTIFICATE_GAP * job.tolerance.mm();
    // How deep does not matter, as long as it is no deeper than this.
    let most = job.tolerance.mm() - gap;
    let mut deepest = Penetration { bound_mm: most, ..Penetration::NONE };
    certificate::penetrate(&Curve::Line(*link), proof, job, gap, &mut deepest, budget)?;
    Ok(deepest.bound_mm <= most)
}

/// Whether a straight link is quicker than a retract.
fn is_quicker(cutting: &Cutting, link: &Line) -> bool {
    let (up, down) = (cutting.retract_z_mm - link.start.z, cutting.retract_z_mm - link.end.z);
    let across = (link.end - link.start).xy().norm();
    let retract_min =
        (up + across) / cutting.rapid_feed.mm_per_min() + down / cutting.plunge_feed.mm_per_min();
    link.length() / cutting.link_feed.mm_per_min() <= retract_min
}
