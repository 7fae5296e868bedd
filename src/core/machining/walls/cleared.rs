//! What moves sweep at one level: discs about lines and arcs in plan.

use nalgebra::{Point2, Vector2};

use crate::geometry::bounding_tree::{BoundingTree, Visitor, Volume};
use crate::geometry::curve::Curve;
use crate::geometry::segment::Segment;
use crate::machining::cutter::Cutter;
use crate::machining::prism::{PlanPiece, pieces};

/// Parts of a slope along which the rounded corner of a cutter passes the level. More of them bound a wall
/// that is cut on a slope more closely.
const PARTS: usize = 8;

/// The largest turn of one track, radians: the sector of a track has to be convex.
const MOST_TURN: f64 = 2.0;

/// A feed move with its cutter.
#[derive(Debug, Clone, Copy)]
pub struct Swath<'a> {
    pub tip: &'a Curve,
    pub cutter: &'a Cutter,
    /// The number by which the move is told.
    pub number: usize,
}

/// A level plane through the moves: where walls are measured.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slice {
    pub z_mm: f64,
    /// How far the control may leave the path, mm.
    pub slack_mm: f64,
    /// The height of chords that replace upright arcs and parabolas, mm.
    pub chord_mm: f64,
}

/// A line or an arc in plan with the radius of the discs along it.
#[derive(Debug, Clone, Copy)]
struct Track {
    path: Segment,
    radius: f64,
    number: usize,
}

/// What some moves sweep at one level.
#[derive(Debug)]
pub struct Cleared {
    tracks: Vec<Track>,
    tree: BoundingTree<Rectangle, usize>,
    off_mm: f64,
}

/// The track that is nearest to a place.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    track: usize,
    /// The distance of the place from the nearest disc of the track, mm; negative inside a disc.
    pub(super) distance_mm: f64,
    /// The number of its move.
    pub(super) number: usize,
}

/// The radius in which a cutter cuts at a height over its tip, mm; `None` below the tip.
pub fn radius_at(cutter: &Cutter, height_mm: f64) -> Option<f64> {
    let corner = cutter.corner_radius();
    if height_mm < 0.0 {
        return None;
    }
    let below = (corner - height_mm).max(0.0);
    Some(cutter.flat_radius() + ((corner - below) * (corner + below)).max(0.0).sqrt())
}

impl Cleared {
    pub fn new<'a>(swaths: impl Iterator<Item = Swath<'a>>, level: Slice) -> Self {
        let mut tracks = Vec::new();
        let mut off_mm = level.slack_mm;
        for swath in swaths {
            let (all, chord_mm) = pieces(swath.tip, level.chord_mm);
            let off = level.slack_mm + chord_mm;
            off_mm = off_mm.max(off);
            for piece in all {
                add(&mut tracks, &swath, &piece, level.z_mm - off, off);
            }
        }
        let mut tree = BoundingTree::default();
        if !tracks.is_empty() {
            add_boxes(&mut tree, &tracks, [0, tracks.len()]);
        }
        Self { tracks, tree, off_mm }
    }

    /// How far the control and the chords may leave the path together, mm.
    pub fn off_mm(&self) -> f64 {
        self.off_mm
    }

    /// The number of the move that sweeps nearest to a place, or deepest over it; `None` without
    /// moves at the level.
    pub fn nearest_move(&self, p: Point2<f64>) -> Option<usize> {
        self.nearest(p).map(|near| near.number)
    }

    /// The track whose discs are nearest to a place; `None` where nothing is swept.
    pub(super) fn nearest(&self, p: Point2<f64>) -> Option<Near> {
        let mut search = Nearest { tracks: &self.tracks, p, best: None };
        self.tree.search(&mut search);
        search.best
    }

    /// An upper bound of the distances of all places of a piece from the nearest disc of a track, mm;
    /// infinite where no bound is known.
    pub(super) fn farthest(&self, near: Near, piece: &Segment) -> f64 {
        let Track { path, radius, .. } = &self.tracks[near.track];
        let ends = [piece.start(), piece.end()];
        let far = match path {
            Segment::Line { .. } => {
                ends.map(|p| path.distance_to(p)).into_iter().fold(0.0, f64::max) + height(piece)
            }
            Segment::Arc(arc) => {
                let hull = hull(piece);
                if !hull.iter().all(|p| arc.covers(p - arc.center())) {
                    return f64::INFINITY;
                }
                let from_center = |p: &Point2<f64>| (p - arc.center()).norm();
                let most = hull.iter().map(from_center).fold(0.0, f64::max);
                let most = match piece {
                    Segment::Line { .. } => most,
                    Segment::Arc(own) => most.min(own.radius() + (own.center() - arc.center()).norm()),
                };
                (most - arc.radius()).max(arc.radius() - piece.distance_to(arc.center()))
            }
        };
        far - radius
    }
}

/// Adds the tracks of a piece of a move, for a level that is lower by what the control may leave the path.
fn add(tracks: &mut Vec<Track>, swath: &Swath<'_>, piece: &PlanPiece, level: f64, off: f64) {
    let corner = swath.cutter.corner_radius();
    let [from, to] = [piece.height(0.0), piece.height(1.0)];
    let mut cuts = vec![0.0, 1.0];
    let parts = if corner > 0.0 { PARTS } else { 0 };
    for k in 0..=parts {
        let z = level - corner * k as f64 / PARTS as f64;
        let t = (z - from) / (to - from);
        if t > 0.0 && t < 1.0 {
            cuts.push(t);
        }
    }
    cuts.sort_unstable_by(f64::total_cmp);
    for ends in cuts.windows(2) {
        let highest = piece.height(ends[0]).max(piece.height(ends[1]));
        // Rounding of a height that was cut at the level itself.
        let height = (level - highest) * (1.0 + f64::EPSILON) + 1e-12;
        let Some(radius) = radius_at(swath.cutter, height).map(|radius| radius - off) else { continue };
        if radius <= 0.0 {
            continue;
        }
        let path = piece.plan.part(ends[0], ends[1]);
        let n = (path.turn().abs() / MOST_TURN).ceil().max(1.0);
        for k in 0..n as usize {
            let path = path.part(k as f64 / n, (k as f64 + 1.0) / n);
            tracks.push(Track { path, radius, number: swath.number });
        }
    }
}

/// The height of an arc over its chord, mm; zero for a line.
fn height(piece: &Segment) -> f64 {
    match piece {
        Segment::Line { .. } => 0.0,
        Segment::Arc(arc) => arc.radius() * (1.0 - (0.5 * arc.turn()).cos()),
    }
}

/// Places whose convex hull holds a line, or an arc of less than half a turn.
fn hull(piece: &Segment) -> Vec<Point2<f64>> {
    let mut hull = vec![piece.start(), piece.end()];
    if let Segment::Arc(arc) = piece {
        let out = (piece.at(0.5) - arc.center()) / (0.5 * arc.turn()).cos();
        hull.push(arc.center() + out);
    }
    hull
}

/// A rectangle that holds some tracks.
#[derive(Debug, Clone, Copy)]
struct Rectangle {
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Volume for Rectangle {
    fn joined(&self, other: &Self) -> Self {
        Self { low: self.low.inf(&other.low), high: self.high.sup(&other.high) }
    }
}

fn add_boxes(tree: &mut BoundingTree<Rectangle, usize>, tracks: &[Track], [from, to]: [usize; 2]) -> usize {
    if to - from == 1 {
        let Track { path, radius, .. } = &tracks[from];
        let (middle, reach) = path.disc();
        let out = Vector2::new(1.0, 1.0) * (reach + radius);
        let ends = [path.start(), path.end()];
        let volume = match path {
            Segment::Line { .. } => {
                let own = Vector2::new(*radius, *radius);
                Rectangle { low: ends[0].inf(&ends[1]) - own, high: ends[0].sup(&ends[1]) + own }
            }
            Segment::Arc(_) => Rectangle { low: middle - out, high: middle + out },
        };
        return tree.add(volume, from);
    }
    let middle = from + (to - from) / 2;
    let halves = [[from, middle], [middle, to]].map(|half| add_boxes(tree, tracks, half));
    tree.join(halves)
}

/// The search for the track nearest to a place.
struct Nearest<'a> {
    tracks: &'a [Track],
    p: Point2<f64>,
    best: Option<Near>,
}

impl Visitor<Rectangle, usize> for Nearest<'_> {
    fn promise(&self, volume: &Rectangle) -> f64 {
        let beyond = |k: usize| (volume.low[k] - self.p[k]).max(self.p[k] - volume.high[k]);
        // Inside, no track is deeper than the box.
        let [x, y] = [beyond(0), beyond(1)];
        if x <= 0.0 && y <= 0.0 { -x.max(y) } else { -x.max(0.0).hypot(y.max(0.0)) }
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.best.is_some_and(|best| promise <= -best.distance_mm)
    }

    fn visit(&mut self, track: &usize, _promise: f64) {
        let Track { path, radius, number } = &self.tracks[*track];
        let distance_mm = path.distance_to(self.p) - radius;
        if self.best.is_none_or(|best| distance_mm < best.distance_mm) {
            self.best = Some(Near { track: *track, distance_mm, number: *number });
        }
    }
}
