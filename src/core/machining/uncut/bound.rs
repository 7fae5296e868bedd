//! Bounds from above the distance of all points of a part of a patch from the solid that a cutter sweeps.

use nalgebra::Vector3;

use super::swept::{Swept, SweptPiece};
use crate::geometry::curve::{Arc, Line};
use crate::geometry::surface::Patch;
use crate::machining::gouge::piece::{PathPiece, PieceCurve};

/// Rounding of one bound, as a share of the coordinates' magnitude: some hundred operations of half an ulp
/// each.
const ROUNDING: f64 = 1e-13;

/// Rounding of a squared distance, as a share of its largest term.
const SQUARE_ROUNDING: f64 = 1e-13;

/// The most control points of a patch.
const MOST_POINTS: usize = 64;

/// Steps in the search for the weight of two distances.
const HALVINGS: usize = 8;

/// Largest number of pieces before and after the nearest one that one bound takes together.
const CHAIN: usize = 3;

/// Parts nearer to the axis of an arc than this share of its radius have no bound by the arc.
const NEAREST_SHARE: f64 = 1e-2;

/// How much wider than its feet the stretch of an arc is that a chord replaces.
const WIDENED: f64 = 0.05;

/// The squared distance of a part from the full line or circle of a piece, and how far the part goes beyond
/// the ends of the piece.
struct ToTrack {
    /// An upper bound of the squared distance, mm^2.
    squared: f64,
    /// The largest distance of the part beyond the planes across the start and across the end, mm.
    beyond: [f64; 2],
    /// The radius of the circle over the least distance of the part from its axis; 1 for a line.
    ratio: f64,
    /// The least distance of the part from the circle's axis, mm; infinite for a line.
    nearest_to_axis: f64,
}

impl Swept {
    /// An upper bound of the distance of every point of `part` from the swept solid, mm, zero or more. The
    /// bound is by the piece `nearest` and its neighbours. Bounds are tried until one is at most `enough` mm.
    pub(super) fn bound(&self, part: &impl Patch, nearest: usize, enough: f64) -> f64 {
        let piece = &self.pieces[nearest];
        let more = self.more(part);
        let mut bound = f64::INFINITY;
        if self.solid.flat == 0.0 {
            let squared = self.squared_bound(part, nearest, enough + self.solid.corner - more);
            bound = squared.max(0.0).sqrt() - self.solid.corner + more;
            if bound <= enough {
                return bound.max(0.0);
            }
        }
        bound = bound.min(self.by_hull(part, &piece.path) + more);
        if bound > enough
            && let Some(other) = self.other(part, nearest)
        {
            bound = bound.min(by_two(part, [(self, &piece.path), (self, &self.pieces[other].path)]) + more);
        }
        bound.max(0.0)
    }

    /// What the control and rounding add to a bound, mm.
    fn more(&self, part: &impl Patch) -> f64 {
        let magnitude = part.corners().iter().map(Vector3::amax).fold(0.0, f64::max);
        self.slack + ROUNDING * (magnitude + self.solid.radius())
    }

    /// The piece that is nearest to the corner of the part that is farthest from `piece`, if it is another.
    fn other(&self, part: &impl Patch, piece: usize) -> Option<usize> {
        let path = &self.pieces[piece].path;
        let corners = part.corners().map(|corner| (self.distance(path, &corner), corner));
        let (_, farthest) = corners.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
        self.nearest(&farthest, Some(piece)).map(|near| near.piece).filter(|other| *other != piece)
    }

    /// An upper bound of the squared distance from the path of a ball's centre, mm^2. The search for a better
    /// one ends at a distance of `enough` mm.
    ///
    /// *One piece.* A point beyond an end of the piece by the length o is at most the root of d^2 + o^2 away
    /// from this end, where d is its distance from the line of the piece. For an arc, let r be the point's
    /// distance from the arc's axis, and q the arc's radius. Then o^2 is replaced by
    /// 2 q o^2 / (r + sqrt(r^2 - o^2)).
    ///
    /// *A chain of pieces.* A point beyond the end of a piece is ahead of the start of the next one, or it
    /// lies in the wedge between the planes across both. In the wedge, it is beyond the end by at most its
    /// distance from this end times the sine of the corner. So each point is near one of the pieces.
    fn squared_bound(&self, part: &impl Patch, nearest: usize, enough: f64) -> f64 {
        let Some(own) = to_track(part, &self.pieces[nearest]) else { return f64::INFINITY };
        let alone = own.squared + own.past_end(own.beyond[0].max(own.beyond[1]));
        if alone <= enough * enough || own.squared > enough * enough {
            return alone;
        }
        let (mut squared, mut kinked, mut free) = (own.squared, 0.0f64, 0.0f64);
        let (mut ratio, mut nearest_to_axis) = (own.ratio, own.nearest_to_axis);
        for side in [0, 1] {
            let (mut at, mut beyond) = (nearest, own.beyond[side]);
            let mut last = own.past_end(beyond);
            for _ in 0..CHAIN {
                let Some(kink) = self.pieces[at].kinks[side].filter(|_| beyond > 0.0) else { break };
                at = if side == 0 { at - 1 } else { at + 1 };
                let Some(next) = to_track(part, &self.pieces[at]) else { return alone };
                squared = squared.max(next.squared);
                kinked = kinked.max(kink * kink);
                (ratio, nearest_to_axis) = (ratio.max(next.ratio), nearest_to_axis.min(next.nearest_to_axis));
                beyond = next.beyond[side];
                last = next.past_end(beyond);
            }
            free = free.max(last);
        }
        // In a wedge, 2 r / (r + sqrt(r^2 - o^2)) is at most 1 + (o / r)^2. The squared distance from the end
        // is at most twice `squared`, because `wedge` is at most a half.
        let turned = 2.0 * squared.max(0.0) * kinked / (nearest_to_axis * nearest_to_axis);
        let wedge = kinked * ratio * (1.0 + turned);
        if wedge <= 0.5 && turned < 1.0 { alone.min((squared + free) / (1.0 - wedge)) } else { alone }
    }

    /// A bound by the control points of the part: the distance from a convex solid is a convex function, so
    /// its largest value is at a control point.
    fn by_hull(&self, part: &impl Patch, path: &PathPiece) -> f64 {
        let (path, more) = self.convex(part, path);
        part.control_points().map(|p| self.distance(&path, &p)).fold(f64::NEG_INFINITY, f64::max) + more
    }

    /// A piece along which the cutter sweeps a convex solid, in place of `path`, and an error in mm. For
    /// every point of the part, take its distance from that solid and add the error: the point is no farther
    /// away from what the cutter sweeps along `path`.
    ///
    /// The solid swept along a line is convex. So is the solid above an arc that bends up like a valley. Any
    /// other arc is replaced by the chord under the part, and the height of the chord is added.
    fn convex(&self, part: &impl Patch, path: &PathPiece) -> (PathPiece, f64) {
        match &path.track {
            PieceCurve::Arc(arc) if !is_valley(arc) => {
                let (chord, height) = self.chord_under(part, path, arc);
                (PathPiece { track: PieceCurve::Line(chord), slack: path.slack }, height + path.slack)
            }
            _ => (*path, path.slack),
        }
    }

    /// The chord of the stretch of an arc that is nearest to the part, and its height, mm.
    fn chord_under(&self, part: &impl Patch, path: &PathPiece, arc: &Arc) -> (Line, f64) {
        let feet = part.corners().map(|p| self.nearest_fraction(path, &p));
        let low = feet.iter().copied().fold(1.0, f64::min);
        let high = feet.iter().copied().fold(0.0, f64::max);
        let wider = WIDENED * (high - low);
        let (low, high) = ((low - wider).max(0.0), (high + wider).min(1.0));
        let chord = Line { start: arc.point_at(low), end: arc.point_at(high) };
        (chord, arc.radius() * (1.0 - (0.5 * (high - low) * arc.sweep()).cos()))
    }
}

impl ToTrack {
    /// By how much the squared distance from the end of the piece may exceed that from its line or circle,
    /// mm^2, for points `beyond` mm beyond the end.
    fn past_end(&self, beyond: f64) -> f64 {
        if beyond <= 0.0 {
            return 0.0;
        }
        let share = beyond / self.nearest_to_axis;
        if share >= 1.0 {
            return f64::INFINITY;
        }
        beyond * beyond * self.ratio * 2.0 / (1.0 + (1.0 - share * share).sqrt())
    }
}

/// The least value over w in 0..=1 of the largest w a + (1 - w) b over the pairs [a, b], or little more.
fn least_mean(pairs: &[[f64; 2]]) -> f64 {
    let largest = |w: f64| pairs.iter().map(|[a, b]| w * a + (1.0 - w) * b).fold(f64::NEG_INFINITY, f64::max);
    // The largest of linear functions is convex: the side of its least value on which w lies is that to which
    // the steepest of the largest ones falls.
    let [mut low, mut high] = [0.0, 1.0];
    let mut least = f64::INFINITY;
    for _ in 0..HALVINGS {
        let w = 0.5 * (low + high);
        let top = largest(w);
        least = least.min(top);
        let rises = pairs.iter().any(|[a, b]| w * a + (1.0 - w) * b >= top && a > b);
        if rises { high = w } else { low = w }
    }
    least
}

/// `None` where a part comes near the axis of an arc, or lies beyond it.
fn to_track(part: &impl Patch, piece: &SweptPiece) -> Option<ToTrack> {
    let track = &piece.path.track;
    let (start, end) = (track.start(), track.end());
    let mut beyond = [f64::NEG_INFINITY; 2];
    for p in part.control_points() {
        beyond[0] = beyond[0].max(-(p - start).dot(&piece.tangents[0]));
        beyond[1] = beyond[1].max((p - end).dot(&piece.tangents[1]));
    }
    let (squared, ratio, nearest_to_axis) = match track {
        PieceCurve::Line(_) => {
            let along = piece.tangents[0];
            let bound = if along == Vector3::zeros() {
                beyond = [0.0; 2];
                part.bound_squares(&start, &[Vector3::x(), Vector3::y(), Vector3::z()], &[1.0; 3])
            } else {
                let across = along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize();
                part.bound_squares(&start, &[across, along.cross(&across)], &[1.0; 2])
            };
            (bound.highest + SQUARE_ROUNDING * bound.magnitude, 1.0, f64::INFINITY)
        }
        PieceCurve::Arc(arc) => {
            let [near, far] = from_axis(part, arc)?;
            (to_circle(part, arc, [near, far]), arc.radius() / near, near)
        }
    };
    let slack = piece.path.slack;
    let squared = if slack > 0.0 { (squared.max(0.0).sqrt() + slack).powi(2) } else { squared };
    Some(ToTrack { squared, beyond, ratio, nearest_to_axis })
}

/// A bound by a piece of each of two cutters, with a ridge between them, mm, zero or more.
pub(super) fn by_two_cutters(part: &impl Patch, cutters: [(&Swept, usize); 2]) -> f64 {
    let more = cutters.map(|(swept, _)| swept.more(part)).into_iter().fold(0.0, f64::max);
    (by_two(part, cutters.map(|(swept, piece)| (swept, &swept.pieces[piece].path))) + more).max(0.0)
}

/// A bound by two pieces with a ridge between them. Each point is as near to one of the pieces as any mean of
/// its two distances. A mean is a convex function, and where its weight fits, it hardly varies across the
/// ridge.
fn by_two(part: &impl Patch, paths: [(&Swept, &PathPiece); 2]) -> f64 {
    let [(a, more_a), (b, more_b)] = paths.map(|(swept, path)| swept.convex(part, path));
    let [one, other] = paths.map(|(swept, _)| swept);
    let mut at = [[0.0; 2]; MOST_POINTS];
    let mut n = 0;
    for p in part.control_points() {
        at[n] = [one.distance(&a, &p) + more_a, other.distance(&b, &p) + more_b];
        n += 1;
    }
    least_mean(&at[..n])
}

/// Bounds of the distance of the part from the axis of an arc, mm: below the least and above the largest.
/// `None` where the part comes near the axis, or lies on the side of it that is away from the arc.
fn from_axis(part: &impl Patch, arc: &Arc) -> Option<[f64; 2]> {
    let [a, b, _] = arc.plane().axes();
    let center = arc.center();
    let in_plane = |p: &Vector3<f64>| [p[a] - center[a], p[b] - center[b]];
    let middle = arc.point_at(0.5).coords;
    let [mx, my] = in_plane(&middle);
    let [x, y] = in_plane(&part.center());
    let distance = x.hypot(y);
    if distance < NEAREST_SHARE * arc.radius() {
        return None;
    }
    let (mut near, mut far) = (f64::INFINITY, 0.0f64);
    for p in part.control_points() {
        let [px, py] = in_plane(&p);
        if px * mx + py * my <= 0.0 {
            return None;
        }
        near = near.min((px * x + py * y) / distance);
        far = far.max(px.hypot(py));
    }
    (near >= NEAREST_SHARE * arc.radius()).then_some([near, far])
}

/// An upper bound of the squared distance of a part from the circle of an arc, mm^2. The part is from `near`
/// to `far` mm away from the axis of the circle.
///
/// Let r be the radius of the circle. For a surface point, let h be its height over the plane of the circle,
/// and q its squared distance from the axis. Then distance^2 = q + r^2 - 2 r sqrt(q) + h^2. The root is
/// concave, so it is at least its chord between near^2 and far^2: sqrt(q) >= (q + near far) / (near + far).
fn to_circle(part: &impl Patch, arc: &Arc, [near, far]: [f64; 2]) -> f64 {
    let r = arc.radius();
    let axes = arc.plane().axes().map(|c| Vector3::ith(c, 1.0));
    let weight = 1.0 - 2.0 * r / (near + far);
    let bound = part.bound_squares(&arc.center().coords, &axes, &[weight, weight, 1.0]);
    let rest = r * (r - 2.0 * near * far / (near + far));
    bound.highest + rest + SQUARE_ROUNDING * (bound.magnitude + r * (r + far))
}

/// Whether an arc stands upright and bends up like a valley, so that what lies above it is convex.
fn is_valley(arc: &Arc) -> bool {
    let center = arc.center();
    let is_upright = arc.plane().axes()[2] != 2;
    let below = |t: f64| arc.point_at(t).z <= center.z;
    is_upright && arc.rise() == 0.0 && below(0.0) && below(0.5) && below(1.0)
}
