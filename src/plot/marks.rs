//! Marks on a path: its start, its end, its direction and its holes.

use nalgebra::{Point2, Point3, Vector2};

use super::number::fixed;
use super::view::View;
use super::{Scene, class};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::toolpath::{Move, Pass, Role, Toolpath};

/// Least distance between arrows along the path, mm of paper.
const ARROW_SPACING_MM: f64 = 40.0;
/// Least area of the plan for each arrow, mm2 of paper.
const ARROW_AREA_MM2: f64 = 600.0;
const MOST_ARROWS: f64 = 16.0;
/// Most holes that are marked. More would cover each other.
const MOST_HOLES: usize = 2_000;

/// The marks of zero, start and end, and in the plan arrows and holes. The other views have no arrows,
/// because passes lie on top of each other there.
pub fn draw(scene: &Scene, view: &View) -> String {
    let Some(toolpath) = scene.toolpath else { return String::new() };
    let last = toolpath.moves().filter_map(class::of).last();
    let end = last.map_or(toolpath.start(), |(_, curve)| curve.end());
    let of_plan = || arrows(toolpath, view) + &holes(toolpath, view);
    let of_plan = if view.axes == [0, 1] { of_plan() } else { String::new() };
    datum_in(view) + &of_plan + &start(view.project(&toolpath.start())) + &cross(view.project(&end))
}

/// The mark of the coordinates' zero, if the zero is inside the view.
fn datum_in(view: &View) -> String {
    let at = view.project(&Point3::origin());
    let [left, top, width, height] = view.frame;
    let is_shown = (left..=left + width).contains(&at.x) && (top..=top + height).contains(&at.y);
    if is_shown { datum(at) } else { String::new() }
}

/// The mark of a zero: a circle with two quarters filled.
pub fn datum(at: Point2<f64>) -> String {
    let (x, y) = (fixed(at.x), fixed(at.y));
    format!(
        "<circle class=\"datum\" cx=\"{x}\" cy=\"{y}\" r=\"1.6\"/>\n\
         <path class=\"solid\" d=\"M{x} {y}v-1.6a1.6 1.6 0 0 1 1.6 1.6zM{x} {y}v1.6a1.6 1.6 0 0 1 -1.6 -1.6z\"/>\n"
    )
}

/// The mark of the start.
pub fn start(at: Point2<f64>) -> String {
    format!("<circle class=\"start\" cx=\"{}\" cy=\"{}\" r=\"1.3\"/>\n", fixed(at.x), fixed(at.y))
}

/// The mark of the end, a cross. It fits into the circle of the start.
pub fn cross(at: Point2<f64>) -> String {
    format!(
        "<path class=\"end\" d=\"M{} {}l1.5 1.5m0 -1.5l-1.5 1.5\"/>\n",
        fixed(at.x - 0.75),
        fixed(at.y - 0.75)
    )
}

/// The places of holes of canned cycles; none where they are too many to be marked.
pub fn places_of_holes(toolpath: &Toolpath) -> Vec<Point2<f64>> {
    let places = toolpath.passes().iter().flat_map(Pass::cycles).flat_map(|cycle| &cycle.places);
    let places: Vec<_> = places.take(MOST_HOLES + 1).copied().collect();
    if places.len() > MOST_HOLES { Vec::new() } else { places }
}

/// The marks of holes, which the plan sees from above.
fn holes(toolpath: &Toolpath, view: &View) -> String {
    let mark = |place: &Point2<f64>| hole(view.project(&Point3::new(place.x, place.y, 0.0)));
    places_of_holes(toolpath).iter().map(mark).collect()
}

/// The mark of a hole: an upright cross.
pub fn hole(at: Point2<f64>) -> String {
    let (x, y) = (fixed(at.x - 1.0), fixed(at.y));
    format!("<path d=\"M{x} {y}h2m-1 -1v2\"/>\n")
}

/// An arrow whose middle is at `at`.
pub fn arrow(at: Point2<f64>, along: Vector2<f64>) -> String {
    let across = Vector2::new(-along.y, along.x);
    let [tip, one, other] =
        [at + along * 1.2, at - along * 1.2 + across * 0.8, at - along * 1.2 - across * 0.8];
    let corner = |p: Point2<f64>| format!("{} {}", fixed(p.x), fixed(p.y));
    format!("<path class=\"solid\" d=\"M{}L{}L{}Z\"/>\n", corner(tip), corner(one), corner(other))
}

/// Arrows at equal distances along the cutting moves.
fn arrows(toolpath: &Toolpath, view: &View) -> String {
    let cuts = || toolpath.moves().filter_map(cut);
    let length: f64 = cuts().map(|curve| curve.length()).sum();
    let [_, _, width, height] = view.frame;
    let most = (width * height / ARROW_AREA_MM2).ceil().min(MOST_ARROWS);
    let count = (length * view.scale() / ARROW_SPACING_MM).ceil().min(most);
    let spacing = length / count;
    let (mut out, mut next, mut passed) = (String::new(), 0.5 * spacing, 0.0);
    for curve in cuts() {
        let own = curve.length();
        while next < passed + own {
            out += &arrow_on(&curve, (next - passed) / own, view);
            next += spacing;
        }
        passed += own;
    }
    out
}

fn cut(step: &Move) -> Option<Curve> {
    match step {
        Move::Feed { along, role: Role::Cut, .. } => Some(*along),
        _ => None,
    }
}

/// The arrow at the fraction `t` of a curve; empty if the view sees the curve from its end.
fn arrow_on(curve: &Curve, t: f64, view: &View) -> String {
    /// A fraction of a curve so small that the curve is straight there.
    const STEP: f64 = 1e-3;
    let [before, after] = [t - STEP, t + STEP].map(|t| view.project(&curve.point_at(t.clamp(0.0, 1.0))));
    let along = after - before;
    let is_seen = along.norm() > STEP * curve.length() * view.scale();
    if is_seen { arrow(view.project(&curve.point_at(t)), along.normalize()) } else { String::new() }
}
