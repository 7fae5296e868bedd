//! Marks on a path: where it starts, where it ends, which way it goes.

use nalgebra::{Point2, Point3, Vector2};

use super::number::fixed;
use super::view::View;
use super::{Scene, class};
use crate::geometry::curve::Curve;
use crate::toolpath::{Move, Role, Toolpath};

/// Arrows are at least so far apart along the path, mm of paper, and each has so much of the plan, mm2.
const ARROW_SPACING_MM: f64 = 40.0;
const ARROW_AREA_MM2: f64 = 600.0;
const MOST_ARROWS: f64 = 16.0;

/// Start, end and, in the plan, directions. In the other views passes lie over each other.
pub fn draw(scene: &Scene, view: &View) -> String {
    let Some(toolpath) = scene.toolpath else { return String::new() };
    let last = toolpath.moves().filter_map(class::of).last();
    let end = last.map_or(toolpath.start(), |(_, curve)| curve.end());
    let arrows = if view.axes == [0, 1] { arrows(toolpath, view) } else { String::new() };
    datum_in(view) + &arrows + &start(view.project(&toolpath.start())) + &cross(view.project(&end))
}

/// The mark of the zero of all coordinates, where the view shows it.
fn datum_in(view: &View) -> String {
    let at = view.project(&Point3::origin());
    let [left, top, width, height] = view.frame;
    let is_shown = (left..=left + width).contains(&at.x) && (top..=top + height).contains(&at.y);
    if is_shown { datum(at) } else { String::new() }
}

/// The mark of a zero: a circle with two of its quarters filled.
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

/// The mark of the end. It fits into that of the start.
pub fn cross(at: Point2<f64>) -> String {
    format!(
        "<path class=\"end\" d=\"M{} {}l1.5 1.5m0 -1.5l-1.5 1.5\"/>\n",
        fixed(at.x - 0.75),
        fixed(at.y - 0.75)
    )
}

/// An arrow whose middle is at `at`.
pub fn arrow(at: Point2<f64>, along: Vector2<f64>) -> String {
    let across = Vector2::new(-along.y, along.x);
    let [tip, one, other] =
        [at + along * 1.2, at - along * 1.2 + across * 0.8, at - along * 1.2 - across * 0.8];
    let corner = |p: Point2<f64>| format!("{} {}", fixed(p.x), fixed(p.y));
    format!("<path class=\"solid\" d=\"M{}L{}L{}Z\"/>\n", corner(tip), corner(one), corner(other))
}

/// Arrows at equal distances along what is cut.
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

/// The arrow at the fraction `t` of a curve; none where it is seen from its end.
fn arrow_on(curve: &Curve, t: f64, view: &View) -> String {
    /// A part of a curve so short that it is straight.
    const STEP: f64 = 1e-3;
    let [before, after] = [t - STEP, t + STEP].map(|t| view.project(&curve.point_at(t.clamp(0.0, 1.0))));
    let along = after - before;
    let is_seen = along.norm() > STEP * curve.length() * view.scale();
    if is_seen { arrow(view.project(&curve.point_at(t)), along.normalize()) } else { String::new() }
}
