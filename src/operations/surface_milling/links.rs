//! Joins passes to one toolpath: straight links where they are clear and quicker, else retract and plunge.

use nalgebra::{Point3, Vector3};

use super::passes::CutPass;
use super::{CERTIFICATE_GAP, CutDirection, Error, Job, certificate};
use crate::budget::Budget;
use crate::geometry::clearance::{Clearance, Penetration};
use crate::geometry::contact::Contacts;
use crate::geometry::curve::{Curve, Line};
use crate::geometry::surface::Patch;
use crate::toolpath::cutting::Cutting;
use crate::toolpath::{Builder, Role, Toolpath};

/// The part of the tolerance by which a link of a cutter without a certificate may cut into the surface.
const TOLERANCE_SHARE: f64 = 0.9;

/// Its depth is proved to that, halved fewer times than so many.
const DEPTHS: i32 = 12;

/// The toolpath of `passes`, from the clearance plane over the first to that over the last, and how deep links cut at most as far as
/// they were proved one by one, mm.
pub(super) fn join(
    job: &Job,
    cutting: &Cutting,
    passes: &[CutPass],
    proof: &Proof<impl Patch>,
    budget: &Budget,
) -> Result<(Toolpath, f64), Error> {
    let mut depth_mm = 0.0f64;
    let at_height = |p: Point3<f64>, z: f64| Point3::new(p.x, p.y, z);
    let mut builder = Toolpath::builder(at_height(passes[0].start(), cutting.clearance_z_mm));
    for (k, pass) in passes.iter().enumerate() {
        builder.begin_pass(None);
        let link = Line { start: builder.at(), end: pass.start() };
        budget.check()?;
        let may_link = k > 0 && job.direction == CutDirection::Zigzag && is_quicker(cutting, &link);
        let depth = if may_link { proof.depth(&link, job, budget)? } else { None };
        if let Some(depth) = depth {
            depth_mm = depth_mm.max(depth);
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
    Ok((builder.finish()?, depth_mm))
}

fn rapid_to(builder: &mut Builder, to: Point3<f64>) -> Result<(), Error> {
    if builder.at() != to {
        builder.rapid(to)?;
    }
    Ok(())
}

/// What proves that a straight link does not cut into the surface.
pub(super) enum Proof<'a, P> {
    /// Of a ball, by the certificate of all moves.
    Certificate(&'a Clearance<'a, P>),
    /// Of any cutter, by direct contact.
    Contact(&'a Contacts<'a, P>),
}

impl<P: Patch> Proof<'_, P> {
    /// How deep a link cuts at most, as computed and as written, mm, where that is proved to be within the tolerance; zero where the
    /// certificate says it.
    fn depth(&self, link: &Line, job: &Job, budget: &Budget) -> Result<Option<f64>, Error> {
        match self {
            Self::Certificate(clearance) => {
                let gap = CERTIFICATE_GAP * job.tolerance.mm();
                // How deep does not matter, as long as it is no deeper than this.
                let most = job.tolerance.mm() - gap;
                let mut deepest = Penetration { bound_mm: most, ..Penetration::NONE };
                let curve = Curve::Line(*link);
                certificate::penetrate(&curve, clearance, job, gap, &mut deepest, budget)?;
                Ok((deepest.bound_mm <= most).then_some(0.0))
            }
            Self::Contact(contacts) => {
                let tip = |p: Point3<f64>| p - Vector3::z() * job.allowance_mm;
                let step = job.resolution.step_mm();
                let most = TOLERANCE_SHARE * job.tolerance.mm() - step;
                let depth = |halves: i32| most * 0.5f64.powi(halves);
                let is_clear = |halves: i32| contacts.is_clear(tip(link.start), tip(link.end), depth(halves));
                if !(most > 0.0 && is_clear(0)) {
                    return Ok(None);
                }
                let (mut clear, mut open) = (0, DEPTHS);
                while open - clear > 1 {
                    let middle = (clear + open) / 2;
                    if is_clear(middle) {
                        clear = middle;
                    } else {
                        open = middle;
                    }
                }
                Ok(Some(depth(clear) + step))
            }
        }
    }
}

/// Whether a straight link is quicker than a retract.
fn is_quicker(cutting: &Cutting, link: &Line) -> bool {
    let (up, down) = (cutting.retract_z_mm - link.start.z, cutting.retract_z_mm - link.end.z);
    let across = (link.end - link.start).xy().norm();
    let retract_min =
        (up + across) / cutting.rapid_feed.mm_per_min() + down / cutting.plunge_feed.mm_per_min();
    link.length() / cutting.link_feed.mm_per_min() <= retract_min
}
