//! Sections of a surface with planes: stretches with known neighbours.
//!
//! # Method
//! 1. Each patch whose control points lie on both sides of the plane is halved until every part is decided
//!    (`part`).
//! 2. Where two parts share a side, the places where the section crosses the side from one part to the other
//!    are joined in their order along the side. The sides of neighbouring patches are joined likewise.
//!
//! So the section crosses every joint of patches in a point of its own, and no part of it is lost: both parts
//! beside a side find the same crossings of it. They can differ by rounding only, where the section touches
//! the side; then the crossings that are left over are joined with each other.

use std::collections::HashMap;

use nalgebra::{Point3, Vector3};

use super::WireError;
use super::part::{self, Finding, Halving, Plane, Side};
use crate::budget::Budget;
use crate::geometry::surface::topology::KINK_LIMIT;
use crate::geometry::surface::{BezierSurface, Patch, Surface};

/// Most halvings from a patch to one of its parts. Where both directions are halved equally often, the
/// smallest part is a billion times smaller than the patch.
const MOST_HALVINGS: usize = 64;

/// Most parts of one section: some ten seconds of work.
const PART_LIMIT: usize = 1_000_000;

/// Parts between two checks of the budget.
const PARTS_BETWEEN_CHECKS: usize = 256;

/// An end of a stretch.
#[derive(Debug, Clone, Copy)]
pub(super) struct End {
    pub(super) point: Point3<f64>,
    /// The unit normal of the patch of the stretch; zero where it has none.
    pub(super) normal: Vector3<f64>,
    /// The index of the end of the next stretch that joins this one; `None` where the surface ends.
    pub(super) mate: Option<usize>,
    /// Whether the two stretches meet at an edge of the surface, or where it has no normal.
    pub(super) is_corner: bool,
}

/// The section with one plane. Stretch k has the ends 2 k and 2 k + 1.
#[derive(Debug, Default)]
pub(super) struct Section {
    pub(super) ends: Vec<End>,
}

/// The ends on each side of a part, each with its parameter along the side, in ascending order.
#[derive(Debug, Default)]
struct Exits([Vec<(f64, usize)>; 4]);

impl Exits {
    fn on(&self, side: Side) -> &[(f64, usize)] {
        &self.0[side as usize]
    }
}

/// The section of the patches `met`, by their indices in [`BezierSurface::patches`].
///
/// # Errors
/// When a part cannot be decided, or the budget stops.
pub(super) fn section<P: Patch>(
    surface: &BezierSurface<P>,
    met: &[usize],
    plane: &Plane,
    budget: &Budget,
) -> Result<Section, WireError> {
    let [_, nv] = surface.spans();
    let mut tracer = Tracer { plane, budget, parts: 0, section: Section::default() };
    let mut exits = HashMap::with_capacity(met.len());
    for &k in met {
        let of_patch = tracer.walk(&surface.patches()[k], 0)?;
        exits.insert(k, of_patch);
    }
    for k in met {
        let Some(own) = exits.get(k) else { continue };
        let below = |distance: usize| k.checked_sub(distance).and_then(|k| exits.get(&k));
        if let Some(before) = below(nv) {
            tracer.join(before.on(Side::LastU), own.on(Side::FirstU), true);
        }
        if let Some(before) = below(1).filter(|_| !k.is_multiple_of(nv)) {
            tracer.join(before.on(Side::LastV), own.on(Side::FirstV), true);
        }
    }
    Ok(tracer.section)
}

struct Tracer<'a> {
    plane: &'a Plane,
    budget: &'a Budget,
    parts: usize,
    section: Section,
}

impl Tracer<'_> {
    /// Adds the stretches of a part that `halvings` halvings have made.
    fn walk(&mut self, part: &impl Patch, halvings: usize) -> Result<Exits, WireError> {
        self.parts += 1;
        if self.parts.is_multiple_of(PARTS_BETWEEN_CHECKS) {
            self.budget.check()?;
        }
        match part::examine(part, self.plane) {
            Finding::Missed => Ok(Exits::default()),
            Finding::Met(pairs) => {
                let mut exits = Exits::default();
                for crossing in pairs.into_iter().flatten() {
                    let end = self.section.ends.len();
                    let (point, normal) = (crossing.point, crossing.normal);
                    self.section.ends.push(End { point, normal, mate: None, is_corner: false });
                    exits.0[crossing.side as usize].push((crossing.t, end));
                }
                Ok(exits)
            }
            Finding::Undecided(_) if halvings >= MOST_HALVINGS || self.parts >= PART_LIMIT => {
                Err(WireError::SectionLost { at: part.center().into() })
            }
            Finding::Undecided(halving) => {
                let halves = match halving {
                    Halving::U => part.split_u(),
                    Halving::V => part.split_v(),
                };
                let one = self.walk(&halves[0], halvings + 1)?;
                let other = self.walk(&halves[1], halvings + 1)?;
                Ok(self.merged(halving, one, other))
            }
        }
    }

    /// The exits of a part, from those of its halves. The ends on the side between the halves are joined.
    fn merged(&mut self, halving: Halving, one: Exits, other: Exits) -> Exits {
        let Exits([u0, u1, v0, v1]) = one;
        let Exits([x0, x1, y0, y1]) = other;
        match halving {
            Halving::U => {
                self.join(&u1, &x0, false);
                Exits([u0, x1, in_order(v0, y0), in_order(v1, y1)])
            }
            Halving::V => {
                self.join(&v1, &y0, false);
                Exits([in_order(u0, x0), in_order(u1, x1), v0, y1])
            }
        }
    }

    /// Joins the ends on the two banks of one side. If `may_bend`, an edge may run along the side.
    fn join(&mut self, one: &[(f64, usize)], other: &[(f64, usize)], may_bend: bool) {
        let (mut a, mut b) = (one.iter().peekable(), other.iter().peekable());
        while let (Some(&&(t, end)), Some(&&(s, mate))) = (a.peek(), b.peek()) {
            let (ahead, behind) = if t <= s { (&mut a, s) } else { (&mut b, t) };
            let first = if t <= s { end } else { mate };
            // Rounding may hide two crossings from one bank. The other bank's two are nearer to each other.
            let mut look = ahead.clone();
            let (near, _) = *look.next().unwrap_or(&(0.0, 0));
            if let Some((next, second)) = look.next().filter(|(next, _)| next - near < behind - near) {
                debug_assert!(*next >= near);
                self.mate(first, *second, false);
                ahead.next();
                ahead.next();
                continue;
            }
            self.mate(end, mate, may_bend);
            a.next();
            b.next();
        }
        let rest: Vec<usize> = a.chain(b).map(|(_, end)| *end).collect();
        for pair in rest.chunks_exact(2) {
            self.mate(pair[0], pair[1], false);
        }
    }

    fn mate(&mut self, one: usize, other: usize, may_bend: bool) {
        let ends = &mut self.section.ends;
        let [a, b] = [ends[one].normal, ends[other].normal];
        let has_normals = a != Vector3::zeros() && b != Vector3::zeros();
        let is_corner = may_bend && !(has_normals && a.cross(&b).norm().atan2(a.dot(&b)) <= KINK_LIMIT);
        for (end, mate) in [(one, other), (other, one)] {
            ends[end].mate = Some(mate);
            ends[end].is_corner = is_corner;
        }
    }
}

/// The ends of the first and of the second half of a side.
fn in_order(first: Vec<(f64, usize)>, second: Vec<(f64, usize)>) -> Vec<(f64, usize)> {
    let first = first.into_iter().map(|(t, end)| (0.5 * t, end));
    first.chain(second.into_iter().map(|(t, end)| (0.5 + 0.5 * t, end))).collect()
}
