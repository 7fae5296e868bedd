//! The passes along walls and islands, which leave them at their size.
//!
//! # Method
//! Each wall is followed once, with the material on the side that the job asks for. The cutter comes to the
//! wall and leaves it on a quarter of a circle that touches it, from ground that the passes before have
//! cleared. A closed pass goes on beyond its start, so that no mark stays where it began. It starts where the
//! largest arc fits, and among such places at the nearest. Where earlier tools have emptied some of the
//! pocket, only the pieces of a wall that meet material are followed.
//!
//! # Guarantees
//! Nothing but these passes and their leads comes nearer to a wall than the safe region, where that has room.

use nalgebra::{Point2, Vector2};

use super::PocketError;
use super::chain::{begun_at, first_part, nearest};
use super::conditions::Conditions;
use super::job::{LeadKind, Milling};
use super::level::Room;
use super::pieces::Pieces;
use super::rings;
use super::router::{Purpose, Router};
use crate::geometry::region::{Containment, Outline, Region};
use crate::geometry::segment::{Segment, left};

/// The radius of a lead where none is given, in cutter radii.
const RADIUS: f64 = 0.5;

/// How far a closed pass goes on beyond its start where nothing is given, in cutter radii.
const OVERLAP: f64 = 0.2;

/// The lead begins at least this far beyond the layer that the pass cuts, mm.
const BEYOND_MM: f64 = 0.02;

/// How near the edge of a region a lead may come, mm: above the rounding of offsets.
const BESIDE_MM: f64 = 2e-6;

/// How often the radius of a lead is made smaller until it fits, and by which factor.
const SMALLER: (usize, f64) = (12, 0.8);

/// The most places of a loop at which a pass may begin.
const STARTS: usize = 48;

/// Where on its elements a pass may begin.
const PLACES: [f64; 3] = [0.5, 0.25, 0.75];

/// Leads that differ by less count as equally large, as a part of the radius.
const EQUAL: f64 = 1e-6;

/// Where a closed pass begins.
struct Start {
    element: usize,
    t: f64,
    lead_mm: f64,
    is_free: bool,
    distance_mm: f64,
}

/// Where the edge of the region of centres is followed.
#[derive(Debug, Clone, Copy)]
pub enum Followed<'a> {
    /// All along, unless earlier tools have emptied some of the pocket: then only beside material.
    WhereMaterialIs,
    Whole,
    /// As far as the centre is in this region.
    Over(&'a Region),
}

/// The pass along all walls and islands, the nearest first.
pub fn cut<'a>(router: &mut Router<'a>, room: &'a Room, followed: Followed) -> Result<(), PocketError> {
    let mut parts = room.centers.parts();
    while !parts.is_empty() {
        let k = router.at().map_or(0, |at| {
            let distance = |part: &Region| part.distance_to_boundary(at);
            (0..parts.len()).min_by(|a, b| distance(&parts[*a]).total_cmp(&distance(&parts[*b]))).unwrap_or(0)
        });
        let part = parts.swap_remove(k);
        let mut left: Vec<&Outline> = part.outlines().collect();
        while !left.is_empty() {
            let k = router.at().map_or(0, |at| {
                let distance = |outline: &&Outline| {
                    let (k, t) = nearest(outline.elements(), at);
                    (outline.elements()[k].at(t) - at).norm()
                };
                (0..left.len())
                    .min_by(|a, b| distance(&left[*a]).total_cmp(&distance(&left[*b])))
                    .unwrap_or(0)
            });
            let outline = left.swap_remove(k);
            // Outlines have the region on their left.
            if router.conditions.milling == Milling::Conventional {
                cut_wall(router, room, outline.reversed().elements(), followed)?;
            } else {
                cut_wall(router, room, outline.elements(), followed)?;
            }
        }
    }
    Ok(())
}

fn cut_wall<'a>(
    router: &mut Router<'a>,
    room: &'a Room,
    wall: &[Segment],
    followed: Followed,
) -> Result<(), PocketError> {
    let pieces = match followed {
        Followed::WhereMaterialIs if router.is_rest() => router.pieces(wall, RADIUS)?,
        Followed::WhereMaterialIs | Followed::Whole => Pieces::Whole,
        Followed::Over(region) => over(wall, region),
    };
    match pieces {
        Pieces::Whole => cut_loop(router, room, wall),
        Pieces::Some(pieces) => pieces.iter().try_for_each(|piece| cut_piece(router, room, piece)),
    }
}

/// The pieces of a closed wall in a region.
fn over(wall: &[Segment], region: &Region) -> Pieces {
    let pieces = rings::clipped(wall, region);
    let is_closed = |piece: &Vec<Segment>| piece[0].start() == piece[piece.len() - 1].end();
    if pieces.len() == 1 && is_closed(&pieces[0]) { Pieces::Whole } else { Pieces::Some(pieces) }
}

/// Follows a closed wall from the best place on it.
fn cut_loop<'a>(router: &mut Router<'a>, room: &'a Room, wall: &[Segment]) -> Result<(), PocketError> {
    let Some(start) = best_start(router, room, wall) else { return Ok(()) };
    let mut pass = begun_at(wall, start.element, start.t);
    let length: f64 = pass.iter().map(Segment::length).sum();
    let conditions = router.conditions;
    let overlap = conditions.lead.overlap_mm.unwrap_or(OVERLAP * conditions.radius_mm).min(length);
    pass.extend(first_part(&pass, overlap));
    cut_piece(router, room, &pass)
}

/// Follows a chain beside walls, with a lead at both ends.
fn cut_piece<'a>(router: &mut Router<'a>, room: &'a Room, pass: &[Segment]) -> Result<(), PocketError> {
    let (Some(first), Some(last)) = (pass.first(), pass.last()) else { return Ok(()) };
    let conditions = router.conditions;
    let (p, along) = (first.start(), first.direction(0.0));
    let lead_in = largest(room, conditions, |radius| lead_in(p, along, radius, conditions), Segment::start);
    let (q, onward) = (last.end(), last.direction(1.0));
    let lead_out = largest(room, conditions, |radius| lead_out(q, onward, radius, conditions), Segment::end);
    let chain: Vec<Segment> = lead_in.iter().chain(pass).copied().collect();
    let is_safe = room.safe.place(chain[0].start(), BESIDE_MM) != Containment::Outside;
    router.move_within(if is_safe { &room.safe } else { &room.centers });
    if !router.come_to(&chain)? {
        // A part that has no room for an entry away from its walls may have room for a ramp along them.
        router.move_within(&room.centers);
        if !is_safe || !router.come_to(&chain)? {
            return Ok(());
        }
    }
    router.follow(&lead_in.into_iter().collect::<Vec<_>>(), Purpose::LeadIn)?;
    router.follow(pass, Purpose::Cut)?;
    router.follow(&lead_out.into_iter().collect::<Vec<_>>(), Purpose::LeadOut)
}

/// The place of a closed wall with the largest lead that begins in cleared ground, the nearest of those.
fn best_start(router: &mut Router, room: &Room, wall: &[Segment]) -> Option<Start> {
    let conditions = router.conditions;
    let at = router.at();
    let stride = wall.len().div_ceil(STARTS).max(1);
    let mut places: Vec<(usize, f64)> =
        (0..wall.len()).step_by(stride).flat_map(|k| PLACES.map(|t| (k, t))).collect();
    places.extend(at.map(|at| nearest(wall, at)));
    let mut best: Option<Start> = None;
    for (element, t) in places {
        let (p, along) = (wall[element].at(t), wall[element].direction(t));
        let lead = largest(room, conditions, |radius| lead_in(p, along, radius, conditions), Segment::start);
        let start = lead.as_ref().map_or(p, Segment::start);
        let found = Start {
            element,
            t,
            lead_mm: lead.as_ref().map_or(0.0, |lead| (lead.end() - lead.start()).norm()),
            is_free: router.is_free(start),
            distance_mm: at.map_or(0.0, |at| (start - at).norm()),
        };
        if best.as_ref().is_none_or(|best| found.is_better(best, EQUAL * conditions.radius_mm)) {
            best = Some(found);
        }
    }
    best
}

impl Start {
    fn is_better(&self, other: &Self, equal_mm: f64) -> bool {
        if self.is_free != other.is_free {
            return self.is_free;
        }
        if (self.lead_mm - other.lead_mm).abs() > equal_mm {
            return self.lead_mm > other.lead_mm;
        }
        self.distance_mm < other.distance_mm - equal_mm
    }
}

/// The largest lead that fits: it stays where the centre may be, and its far end stays in the safe region.
/// Where the safe region has no room, the far end may be anywhere.
fn largest(
    room: &Room,
    conditions: &Conditions,
    lead: impl Fn(f64) -> Option<Segment>,
    far_end: impl Fn(&Segment) -> Point2<f64>,
) -> Option<Segment> {
    let layer = conditions.stepover_mm.min(conditions.radius_mm).max(room.side_mm) + BEYOND_MM;
    let usual = (RADIUS * conditions.radius_mm).max(layer);
    let mut radius = conditions.lead.radius_mm.unwrap_or(usual);
    let mut narrow = None;
    for _ in 0..SMALLER.0 {
        let lead = lead(radius)?;
        if room.centers.contains(&lead, BESIDE_MM) {
            if room.safe.place(far_end(&lead), BESIDE_MM) != Containment::Outside {
                return Some(lead);
            }
            narrow.get_or_insert(lead);
        }
        radius *= SMALLER.1;
    }
    narrow
}

/// The way to the place `p` on a wall, along which the pass goes on; none where the cutter comes down there.
fn lead_in(p: Point2<f64>, along: Vector2<f64>, radius: f64, conditions: &Conditions) -> Option<Segment> {
    let (inward, turn) = side(along, conditions);
    let center = p + inward * radius;
    match conditions.lead.kind {
        LeadKind::Arc => Some(Segment::about(center, radius, [center - along * radius, p], turn)),
        LeadKind::Line => Some(Segment::Line { start: center, end: p }),
        LeadKind::None => None,
    }
}

/// The way from the place `p` at the end of a pass.
fn lead_out(p: Point2<f64>, along: Vector2<f64>, radius: f64, conditions: &Conditions) -> Option<Segment> {
    let (inward, turn) = side(along, conditions);
    let center = p + inward * radius;
    match conditions.lead.kind {
        LeadKind::Arc => Some(Segment::about(center, radius, [p, center + along * radius], turn)),
        LeadKind::Line => Some(Segment::Line { start: p, end: center }),
        LeadKind::None => None,
    }
}

/// The direction away from a wall, and the turn of a quarter of a circle on that side, radians.
fn side(along: Vector2<f64>, conditions: &Conditions) -> (Vector2<f64>, f64) {
    let quarter = std::f64::consts::FRAC_PI_2;
    match conditions.milling {
        Milling::Climb => (left(along), quarter),
        Milling::Conventional => (-left(along), -quarter),
    }
}
