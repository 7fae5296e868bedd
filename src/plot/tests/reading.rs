//! Reads a sheet as a person does: the stated scale, positions by the numbers at the axes, and paths by the
//! rules of SVG. It shares no code with the drawing.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use nalgebra::Point3;
use roxmltree::{Document, Node};

use super::of_path;
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::toolpath::{Move, Role, Toolpath};

/// The axes that point to the right and upward.
const VIEWS: [(&str, [usize; 2]); 3] = [("plan", [0, 1]), ("front", [0, 2]), ("left-side", [2, 1])];
/// Allowed distance: thinning, chords and rounding of the drawing, and the rounding of the ticks.
const AGREEMENT_MM: f64 = 0.02 + 0.008;

type Straight = [[f64; 2]; 2];

pub struct Drawing {
    pub scale: f64,
    pub texts: Vec<String>,
    frames: BTreeMap<String, [f64; 4]>,
    paths: BTreeMap<(String, String), String>,
    /// For each view and side, a value and its place on paper.
    ticks: BTreeMap<(String, &'static str), (f64, f64)>,
}

impl Drawing {
    /// Reads a sheet. Panics if anything is not in its place.
    pub fn read(svg: &str) -> Self {
        let document = Document::parse(svg).unwrap();
        let root = document.root_element();
        assert_eq!(root.attribute("viewBox"), Some("0 0 297 210"));
        let texts: Vec<String> = root
            .descendants()
            .filter(|n| n.has_tag_name("text"))
            .filter_map(|n| n.text())
            .map(str::to_owned)
            .collect();
        let stated = texts.iter().find_map(|text| text.strip_prefix("Scale ")).unwrap();
        let (paper, part) = stated.split_once(':').unwrap();
        let scale = paper.parse::<f64>().unwrap() / part.parse::<f64>().unwrap();
        let (mut frames, mut paths, mut ticks) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
        for view in root.children().filter(|n| n.attribute("class") == Some("view")) {
            let id = view.attribute("id").unwrap().to_owned();
            for node in view.children().filter(Node::is_element) {
                let class = node.attribute("class").unwrap().to_owned();
                let number = |name: &str| node.attribute(name).unwrap().parse::<f64>().unwrap();
                match (node.tag_name().name(), class.as_str()) {
                    ("rect", _) => drop(frames.insert(id.clone(), ["x", "y", "width", "height"].map(number))),
                    ("path", "grid" | "solid" | "end") => {}
                    ("path", _) => {
                        // A class has a path on each level.
                        let data: &mut String = paths.entry((id.clone(), class)).or_default();
                        data.push_str(node.attribute("d").unwrap());
                    }
                    ("text", "middle") => {
                        ticks.insert(
                            (id.clone(), "across"),
                            (node.text().unwrap().parse().unwrap(), number("x")),
                        );
                    }
                    ("text", "right") => {
                        // The middle of the digits is a third of their height above the base line.
                        let y = number("y") - 2.5 / 3.0;
                        ticks.insert((id.clone(), "up"), (node.text().unwrap().parse().unwrap(), y));
                    }
                    _ => {}
                }
            }
        }
        for [left, top, width, height] in frames.values() {
            assert!(*left > 7.0 && *top > 7.0 && left + width < 222.0 && top + height < 203.0);
        }
        Self { scale, texts, frames, paths, ticks }
    }

    pub fn frame(&self, view: &str) -> [f64; 4] {
        self.frames[view]
    }

    pub fn data(&self, view: &str, class: &str) -> Option<&str> {
        self.paths.get(&(view.to_owned(), class.to_owned())).map(String::as_str)
    }

    /// The place of the values in a view, to a hundredth of a millimetre. The numbers of x and y are at the
    /// plan, those of z at the front and below the left side.
    pub fn at(&self, view: &str, values: [f64; 2]) -> [f64; 2] {
        let below = if view == "front" { "plan" } else { view };
        let beside = if view == "left-side" { "plan" } else { view };
        let (value, x) = self.ticks[&(below.to_owned(), "across")];
        let (other, y) = self.ticks[&(beside.to_owned(), "up")];
        let at = [x + (values[0] - value) * self.scale, y - (values[1] - other) * self.scale];
        at.map(|mm| (mm * 100.0).round() / 100.0)
    }

    /// The strokes of a class as short straight lines.
    pub fn strokes(&self, view: &str, class: &str) -> Vec<Straight> {
        self.data(view, class).map(strokes).unwrap_or_default()
    }
}

/// Asserts that every move is drawn in its place with its class, and that every stroke belongs to a move.
pub fn compare(toolpath: &Toolpath) {
    let drawing = Drawing::read(&of_path(toolpath));
    for (view, axes) in VIEWS {
        let mut meant: BTreeMap<&str, Vec<Straight>> = BTreeMap::new();
        for (class, curve) in toolpath.moves().filter_map(classed) {
            let project = |p: Point3<f64>| drawing.at(view, axes.map(|axis| p[axis]));
            let chords = if matches!(curve, Curve::Line(_)) { 1 } else { 600 };
            // Points at equal lengths would miss the tip of a parabola that turns back sharply. At equal
            // parameters all chords leave the parabola equally little.
            let at = |t: f64| match curve {
                Curve::Parabola(parabola) => parabola.at(t),
                _ => curve.point_at(t),
            };
            let points: Vec<_> =
                (0..=chords).map(|k| project(at(f64::from(k) / f64::from(chords)))).collect();
            meant.entry(class).or_default().extend(points.windows(2).map(|pair| [pair[0], pair[1]]));
        }
        let [left, top, width, height] = drawing.frame(view);
        for class in ["rapid", "link", "cut", "cut-arc", "cut-parabola", "entry"] {
            let drawn = drawing.strokes(view, class);
            let meant = meant.remove(class).unwrap_or_default();
            assert!(lies_on(&drawn, &meant), "{view} {class}: drawn, but not meant");
            assert!(lies_on(&meant, &drawn), "{view} {class}: meant, but not drawn");
            for [x, y] in drawn.into_iter().flatten() {
                assert!(
                    x > left && x < left + width && y > top && y < top + height,
                    "{view} {class}: {x} {y}"
                );
            }
        }
    }
}

fn classed(step: &Move) -> Option<(&'static str, Curve)> {
    match step {
        Move::Rapid { line } => Some(("rapid", Curve::Line(*line))),
        Move::Feed { along, role, .. } => {
            let class = match (role, along) {
                (Role::Cut, Curve::Line(_)) => "cut",
                (Role::Cut, Curve::Arc(_)) => "cut-arc",
                (Role::Cut, Curve::Parabola(_)) => "cut-parabola",
                (Role::Link, _) => "link",
                _ => "entry",
            };
            Some((class, *along))
        }
        Move::Turn { .. } | Move::Dwell { .. } => None,
    }
}

/// Whether points along every segment are on some segment of `others`.
fn lies_on(straights: &[Straight], others: &[Straight]) -> bool {
    straights.iter().step_by(7.min(straights.len() / 20 + 1)).all(|[a, b]| {
        [0.0, 0.37, 1.0].iter().all(|t| {
            let at = [0, 1].map(|k| a[k] + t * (b[k] - a[k]));
            others.iter().any(|other| distance(at, *other) <= AGREEMENT_MM)
        })
    })
}

pub fn distance(p: [f64; 2], [a, b]: Straight) -> f64 {
    let (along, to) = ([b[0] - a[0], b[1] - a[1]], [p[0] - a[0], p[1] - a[1]]);
    let squared = along[0] * along[0] + along[1] * along[1];
    let t =
        if squared > 0.0 { ((to[0] * along[0] + to[1] * along[1]) / squared).clamp(0.0, 1.0) } else { 0.0 };
    (to[0] - t * along[0]).hypot(to[1] - t * along[1])
}

/// The lines of path data of M, L, A, Q and h0.
pub fn strokes(data: &str) -> Vec<Straight> {
    let mut straights = Vec::new();
    let mut at = [0.0; 2];
    for part in data.split_inclusive(|c: char| !"0123456789. -".contains(c)).collect::<Vec<_>>().windows(2) {
        let command = part[0].chars().last().unwrap();
        let numbers: Vec<f64> = part[1]
            .trim_end_matches(|c: char| c.is_alphabetic())
            .split(' ')
            .filter(|text| !text.is_empty())
            .map(|text| text.parse().unwrap())
            .collect();
        match (command, &numbers[..]) {
            ('M', &[x, y]) => at = [x, y],
            ('L', &[x, y]) => {
                straights.push([at, [x, y]]);
                at = [x, y];
            }
            ('h', &[0.0]) => straights.push([at, at]),
            ('A', &[rx, ry, 0.0, 0.0, sense, x, y]) if rx == ry => {
                arc(at, rx, sense == 1.0, [x, y], &mut straights);
                at = [x, y];
            }
            ('Q', &[cx, cy, x, y]) => {
                let chords = 300;
                let point = |k: i32| {
                    let t = f64::from(k) / f64::from(chords);
                    [(at[0], cx, x), (at[1], cy, y)]
                        .map(|(a, b, c)| (1.0 - t) * ((1.0 - t) * a + t * b) + t * ((1.0 - t) * b + t * c))
                };
                straights.extend((0..chords).map(|k| [point(k), point(k + 1)]));
                at = [x, y];
            }
            other => panic!("{other:?} in {data}"),
        }
    }
    straights
}

/// SVG 2, appendix B.2.4: from end points to a centre; always the smaller of the two arcs.
fn arc(from: [f64; 2], radius: f64, clockwise: bool, to: [f64; 2], straights: &mut Vec<Straight>) {
    let half = [0.5 * (from[0] - to[0]), 0.5 * (from[1] - to[1])];
    let squared = half[0] * half[0] + half[1] * half[1];
    let radius = radius.max(squared.sqrt());
    let factor = ((radius * radius - squared) / squared).max(0.0).sqrt() * if clockwise { 1.0 } else { -1.0 };
    let inner = [factor * half[1], -factor * half[0]];
    let center = [inner[0] + 0.5 * (from[0] + to[0]), inner[1] + 0.5 * (from[1] + to[1])];
    let angle = |p: [f64; 2]| (p[1] - center[1]).atan2(p[0] - center[0]);
    let turned = match (clockwise, angle(to) - angle(from)) {
        (true, turned) if turned < 0.0 => turned + TAU,
        (false, turned) if turned > 0.0 => turned - TAU,
        (_, turned) => turned,
    };
    let chords = 150;
    let point = |k: i32| {
        let angle = angle(from) + turned * f64::from(k) / f64::from(chords);
        [center[0] + radius * angle.cos(), center[1] + radius * angle.sin()]
    };
    straights.extend((0..chords).map(|k| [point(k), point(k + 1)]));
}
