//! The solid that a cutter sweeps while it follows passes, with a search for the nearest piece of the passes.

use nalgebra::{Point3, Vector3};

use crate::geometry::bounding_tree::{BoundingTree, Visitor};
use crate::geometry::curve::Curve;
use crate::geometry::solve::highest_place;
use crate::geometry::surface::patch::Bounds;
use crate::machining::cutter::Cutter;
use crate::machining::gouge::piece::{PathPiece, PieceCurve, pieces};
use crate::machining::gouge::solid::Solid;

/// Largest length of one piece, mm. Only arcs of more than a quarter turn are shorter.
const LONGEST_MM: f64 = f64::MAX;

/// Two pieces are joined where the end of one is this near to the start of the next, mm.
const JOINED_MM: f64 = 1e-9;

/// Sine of the largest angle between joined pieces. At a sharper corner the pieces are bounded one by one.
const SHARPEST: f64 = 0.3;

/// How much nearer the nearest place of a piece may be than the one that is found, mm.
const PLACE_ACCURACY_MM: f64 = 1e-7;

/// One piece of the path of the cutter's point C (`gouge::solid`).
#[derive(Debug, Clone, Copy)]
pub(super) struct SweptPiece {
    pub(super) path: PathPiece,
    /// Unit tangents at the start and at the end.
    pub(super) tangents: [Vector3<f64>; 2],
    /// The sines of the angles to the piece before and to the piece after; `None` where there is none or the
    /// corner is sharp.
    pub(super) kinks: [Option<f64>; 2],
}

/// The solid that a cutter with its shank has swept.
pub struct Swept {
    pub(super) solid: Solid,
    /// The radius of the cutter's corner without the allowance, mm.
    pub(super) own_corner: f64,
    pub(super) allowance: f64,
    pub(super) pieces: Vec<SweptPiece>,
    tree: BoundingTree<Bounds, usize>,
    /// How far a control may leave the path, mm.
    pub(super) slack: f64,
}

/// The piece nearest to a point.
#[derive(Debug, Clone, Copy)]
pub(super) struct Nearest {
    pub(super) piece: usize,
    /// Distance of the point from the solid that is swept along the piece, mm; zero inside.
    pub(super) distance: f64,
}

impl Swept {
    /// The solid that `cutter`, enlarged by `allowance` mm, sweeps while its tip follows `passes`. `slack` is
    /// the largest distance by which a control may leave the passes, mm. Helices and parabolas become chords
    /// with a height of about `chord_height` mm.
    pub fn new<'a>(
        cutter: &Cutter,
        allowance: f64,
        passes: impl Iterator<Item = &'a [Curve]>,
        slack: f64,
        chord_height: f64,
    ) -> Self {
        let own_corner = cutter.corner_radius();
        let mut all: Vec<SweptPiece> = Vec::new();
        for pass in passes {
            let first = all.len();
            for path in pass.iter().flat_map(|tip| pieces(tip, own_corner, LONGEST_MM, 0.0, chord_height)) {
                if path.length() > 0.0 || all.len() == first {
                    add(&mut all, first, path);
                }
            }
        }
        let mut tree = BoundingTree::default();
        if !all.is_empty() {
            add_boxes(&mut tree, &all, [0, all.len()]);
        }
        let solid = Solid { flat: cutter.flat_radius(), corner: own_corner + allowance };
        Self { solid, own_corner, allowance, pieces: all, tree, slack }
    }

    /// The piece whose swept solid is nearest to `p`; `None` without passes. `hint` is a piece that may be
    /// near.
    pub(super) fn nearest(&self, p: &Vector3<f64>, hint: Option<usize>) -> Option<Nearest> {
        let mut search = NearestPiece { swept: self, p: *p, best: None };
        if let Some(hint) = hint {
            search.look_at(hint);
        }
        self.tree.search(&mut search);
        search.best.map(|near| Nearest { distance: near.distance.max(0.0), ..near })
    }

    /// The distance of `p` from the solid swept along one piece, mm, negative inside. For an arc that does
    /// not bend up like a valley it is a bound: another place of the piece may be nearer than the one that
    /// is found.
    pub(super) fn distance(&self, path: &PathPiece, p: &Vector3<f64>) -> f64 {
        let from = |c: &Vector3<f64>| -self.solid.depth(&(p - c));
        if self.solid.flat == 0.0 {
            let near = path.nearest(p, 0.0);
            if p.z <= near.z {
                return from(&near);
            }
        }
        let within = path.track.point_at(self.nearest_fraction(path, p));
        [within, path.track.start(), path.track.end()].iter().map(from).fold(f64::INFINITY, f64::min)
    }

    /// The fraction of the length of a piece at which the cutter is nearest to `p`. Along the piece the
    /// distance falls while the tangent and the direction from the cutter's core to `p` enclose less than a
    /// right angle.
    pub(super) fn nearest_fraction(&self, path: &PathPiece, p: &Vector3<f64>) -> f64 {
        let towards = |c: Point3<f64>, tangent: &Vector3<f64>| {
            self.solid.away_from_core(&(p - c.coords)).map_or(0.0, |away| away.dot(tangent))
        };
        // How the distance falls over the whole length, mm.
        let fall = |t: f64| match &path.track {
            PieceCurve::Line(line) => towards(line.point_at(t), &(line.end - line.start)),
            PieceCurve::Arc(arc) => {
                let c = arc.point_at(t);
                towards(c, &(arc.tangent_in(&c) * arc.sweep()))
            }
        };
        highest_place([0.0, 1.0], PLACE_ACCURACY_MM, fall)
    }

    /// The height of a scallop of a part with an allowance that leaves `distance` mm to the enlarged cutter,
    /// where the convex curvature is `curvature`, 1/mm.
    ///
    /// Let R be the corner radius and a the allowance. On a level part, let the centre of the enlarged corner
    /// be R + a + u away from a point P of the part. Its distance from the point Q that lies a above P is
    /// then the root of R^2 + 2 (R + a) u + u^2. A convex part spreads the points Q by 1 + a k more.
    pub(super) fn over_allowance(&self, distance: f64, curvature: f64) -> f64 {
        if self.allowance == 0.0 || distance <= 0.0 {
            return distance.max(0.0);
        }
        let (r, u) = (self.own_corner, distance);
        let more = u * (2.0 * (r + self.allowance) + u);
        let left = more / ((r * r + more).sqrt() + r);
        left * (1.0 + self.allowance * curvature.max(0.0))
    }
}

/// Adds a piece and joins it to the one before it, if they meet without a sharp corner.
fn add(all: &mut Vec<SweptPiece>, first: usize, path: PathPiece) {
    let tangents = tangents(&path.track);
    let mut piece = SweptPiece { path, tangents, kinks: [None; 2] };
    if all.len() > first
        && let Some(before) = all.last_mut()
        && (before.path.track.end() - path.track.start()).norm() <= JOINED_MM
    {
        let (out, on) = (before.tangents[1], tangents[0]);
        let sine = out.cross(&on).norm();
        if out.dot(&on) > 0.0 && sine <= SHARPEST {
            before.kinks[1] = Some(sine);
            piece.kinks[0] = Some(sine);
        }
    }
    all.push(piece);
}

fn tangents(track: &PieceCurve) -> [Vector3<f64>; 2] {
    let tangents = match track {
        PieceCurve::Line(line) => line.tangents(),
        PieceCurve::Arc(arc) => arc.tangents(),
    };
    tangents.map(|t| t.try_normalize(0.0).unwrap_or_default())
}

fn add_boxes(tree: &mut BoundingTree<Bounds, usize>, all: &[SweptPiece], [from, to]: [usize; 2]) -> usize {
    if to - from == 1 {
        return tree.add(bounds(&all[from].path), from);
    }
    let middle = from + (to - from) / 2;
    let halves = [[from, middle], [middle, to]].map(|half| add_boxes(tree, all, half));
    tree.join(halves)
}

fn bounds(path: &PathPiece) -> Bounds {
    let highest = |c: usize| path.support(&Vector3::ith(c, 1.0));
    let lowest = |c: usize| -path.support(&-Vector3::ith(c, 1.0));
    Bounds {
        min: Vector3::new(lowest(0), lowest(1), lowest(2)),
        max: Vector3::new(highest(0), highest(1), highest(2)),
    }
}

struct NearestPiece<'a> {
    swept: &'a Swept,
    p: Vector3<f64>,
    best: Option<Nearest>,
}

impl NearestPiece<'_> {
    fn look_at(&mut self, piece: usize) {
        let distance = self.swept.distance(&self.swept.pieces[piece].path, &self.p);
        if self.best.is_none_or(|best| distance < best.distance) {
            self.best = Some(Nearest { piece, distance });
        }
    }
}

impl Visitor<Bounds, usize> for NearestPiece<'_> {
    fn promise(&self, bounds: &Bounds) -> f64 {
        let beside = |c: usize| (bounds.min[c] - self.p[c]).max(self.p[c] - bounds.max[c]).max(0.0);
        let out = (beside(0).hypot(beside(1)) - self.swept.solid.flat).max(0.0);
        self.swept.solid.corner - out.hypot((bounds.min.z - self.p.z).max(0.0))
    }

    fn is_settled(&self, promise: f64) -> bool {
        self.best.is_some_and(|best| promise <= -best.distance)
    }

    fn visit(&mut self, piece: &usize, _promise: f64) {
        self.look_at(*piece);
    }
}
