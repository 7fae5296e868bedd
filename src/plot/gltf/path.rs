//! The passes of a toolpath as strips of lines.

use nalgebra::{Point3, UnitVector3};
use serde_json::json;

use super::container::{Document, Mode};
use super::{Content, KINDS, MOST_VERTICES};
use toolpathd_core::geometry::curve::Curve;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::flattened::{chord, flat};
use toolpathd_core::toolpath::path::{Move, Pass, Role};
use toolpathd_core::toolpath::tool_axes::{angle_between, between};

/// The largest turn of the tool axis between two vertices, radians, unless there are too many.
const LARGEST_TURN: f64 = 0.05;

/// Up to so many passes have a node each. In a toolpath with more passes, several passes share a node.
const MOST_NODES: usize = 2000;

/// The numbers of a dwell and of a way that is not known among the kinds.
const DWELL: u8 = 7;
const UNKNOWN: u8 = 9;

/// Stands for a deviation that is not known.
const NOT_KNOWN: f32 = -1.0;

/// The colours of the kinds: red, green, blue and opacity.
const COLORS: [[u8; 4]; KINDS.len()] = [
    [150, 150, 150, 255],
    [0, 90, 200, 255],
    [204, 51, 17, 255],
    [238, 119, 51, 255],
    [0, 153, 136, 255],
    [140, 90, 200, 255],
    [0, 153, 136, 255],
    [238, 51, 119, 255],
    [238, 51, 119, 255],
    [200, 200, 200, 255],
];

/// The strips of all passes, behind each other.
#[derive(Default)]
pub struct Strips {
    places: Vec<Point3<f64>>,
    /// Seconds from the start of the program; without a value where some move has no feed.
    times: Vec<f64>,
    has_times: bool,
    /// The number of the kind of the stretch that ends at the vertex.
    kinds: Vec<u8>,
    feeds: Vec<f32>,
    lines: Vec<u32>,
    /// The deviation of the stretch that ends at the vertex, mm; [`NOT_KNOWN`] where it is not known.
    deviations_mm: Vec<f32>,
    /// Seconds from the start of the program at the end of each move, where a clock needs them.
    ends_s: Vec<f64>,
    /// The tool axis; empty where it is straight up throughout.
    axes: Vec<UnitVector3<f64>>,
    pub passes: Vec<Strip>,
}

/// The vertices of a pass, or of several.
pub struct Strip {
    name: String,
    level: Option<u32>,
    first: usize,
    count: usize,
}

/// The strips of a toolpath, and the chord that they keep, mm.
pub fn strips(toolpath: &Toolpath, content: &Content) -> (Strips, f64) {
    let chord_mm = chord(toolpath, content.chord_mm, MOST_VERTICES);
    let mut strips = Strips { has_times: true, ..Strips::default() };
    let shared = toolpath.passes().len().div_ceil(MOST_NODES).max(1);
    let turn = largest_turn(toolpath);
    let is_leaning = !toolpath.is_upright();
    let mut walk = Walk { chord_mm, turn, content, is_leaning, seconds: 0.0, n_moves: 0, n_cuts: 0 };
    let mut at = toolpath.start();
    for (k, pass) in toolpath.passes().iter().enumerate() {
        if k % shared == 0 {
            strips.begin(k, pass, content);
            walk.start(&mut strips, pass, pass.start().unwrap_or(at));
        } else if let Some(start) = pass.start() {
            walk.jump(&mut strips, pass, start);
        }
        at = walk.follow(&mut strips, pass).unwrap_or(at);
        strips.end();
    }
    strips.passes.retain(|strip| strip.count > 1);
    (strips, chord_mm)
}

/// The largest turn of the tool axis between two vertices, radians: wider where there would be too many.
fn largest_turn(toolpath: &Toolpath) -> f64 {
    let mut whole = 0.0;
    for pass in toolpath.passes() {
        let mut axis = pass.axes().start();
        for k in 0..pass.moves().len() {
            let to = pass.axes().after(k);
            whole += angle_between(&axis, &to);
            axis = to;
        }
    }
    LARGEST_TURN.max(whole / MOST_VERTICES as f64)
}

/// The points of a curve in `count` parts of the same length.
fn even_points(curve: &Curve, count: usize) -> Vec<Point3<f64>> {
    let inner = (0..count).map(|k| curve.point_at(k as f64 / count as f64));
    inner.chain([curve.end()]).collect()
}

impl Strips {
    /// Seconds from the start of the program at the end of each move; nothing where they are not known.
    pub fn move_ends_s(&self) -> &[f64] {
        if self.has_times { &self.ends_s } else { &[] }
    }

    fn begin(&mut self, index: usize, pass: &Pass, content: &Content) {
        let told = content.names.iter().rev().find(|(from, _)| *from <= index).map(|(_, text)| text.as_str());
        let name = match told {
            Some(text) => format!("pass {}, {text}", index + 1),
            None => format!("pass {}", index + 1),
        };
        self.passes.push(Strip { name, level: pass.level(), first: self.places.len(), count: 0 });
    }

    /// Counts the vertices of the strip so far.
    fn end(&mut self) {
        if let Some(strip) = self.passes.last_mut() {
            strip.count = self.places.len() - strip.first;
        }
    }
}

/// What a walk along the moves knows.
struct Walk<'a> {
    chord_mm: f64,
    /// The largest turn of the tool axis between two vertices, radians.
    turn: f64,
    content: &'a Content<'a>,
    is_leaning: bool,
    seconds: f64,
    n_moves: usize,
    n_cuts: usize,
}

/// What holds along a move.
struct MoveFacts {
    kind: u8,
    feed: f32,
    /// `None` where the move has no feed.
    seconds: Option<f64>,
    line: u32,
    deviation_mm: f32,
    axes: [UnitVector3<f64>; 2],
}

impl Walk<'_> {
    /// The first vertex of a strip.
    fn start(&mut self, strips: &mut Strips, pass: &Pass, at: Point3<f64>) {
        let first = pass.moves().first();
        let (kind, feed) = first.map_or((0, 0.0), |step| (kind(step), feed(step)));
        let deviation_mm = first.map_or(NOT_KNOWN, |step| self.deviation_mm(step));
        let line = self.n_moves.checked_sub(1).and_then(|k| self.content.lines.get(k)).copied().unwrap_or(0);
        let axis = pass.axes().start();
        let stretch = MoveFacts { kind, feed, seconds: Some(0.0), line, deviation_mm, axes: [axis; 2] };
        self.push(strips, at, &stretch, 1.0);
    }

    /// The deviation of the next move, mm.
    fn deviation_mm(&self, step: &Move) -> f32 {
        let known = if is_cut(step) { self.content.deviations_mm.get(self.n_cuts) } else { None };
        known.map_or(NOT_KNOWN, |mm| if mm.is_finite() { *mm as f32 } else { NOT_KNOWN })
    }

    /// Goes on at a place to which the way is not known, within a strip that several passes share.
    fn jump(&self, strips: &mut Strips, pass: &Pass, at: Point3<f64>) {
        let axes = [pass.axes().start(); 2];
        let stretch = MoveFacts {
            kind: UNKNOWN,
            feed: 0.0,
            seconds: Some(0.0),
            line: 0,
            deviation_mm: NOT_KNOWN,
            axes,
        };
        if let Some(last) = strips.places.last().copied() {
            self.push(strips, last, &stretch, 0.0);
        }
        self.push(strips, at, &stretch, 1.0);
    }

    /// Follows the moves of a pass. Returns where they end.
    fn follow(&mut self, strips: &mut Strips, pass: &Pass) -> Option<Point3<f64>> {
        let mut axis = pass.axes().start();
        let mut at = None;
        for (k, step) in pass.moves().iter().enumerate() {
            let line = self.content.lines.get(self.n_moves).copied().unwrap_or(0);
            let to = pass.axes().after(k);
            let rapid_feed = self.content.rapid_feed.mm_per_min();
            let seconds = seconds(step, rapid_feed);
            let (kind, feed, deviation_mm) = (kind(step), feed(step), self.deviation_mm(step));
            let stretch = MoveFacts { kind, feed, seconds, line, deviation_mm, axes: [axis, to] };
            at = self.step(strips, step, &stretch).or(at);
            (axis, self.n_moves) = (to, self.n_moves + 1);
            self.n_cuts += usize::from(is_cut(step));
            if !self.content.diagram_ends_s.is_empty() {
                strips.ends_s.push(self.seconds);
            }
        }
        at
    }

    /// Adds the vertices of a move. Returns where it ends; none for a move that goes nowhere.
    fn step(&mut self, strips: &mut Strips, step: &Move, stretch: &MoveFacts) -> Option<Point3<f64>> {
        // The colour changes at once, not along the first stretch.
        if let (Some(last), Some(before)) = (strips.places.last().copied(), strips.kinds.last())
            && *before != stretch.kind
        {
            self.push(strips, last, &MoveFacts { seconds: Some(0.0), ..*stretch }, 0.0);
        }
        let turning = (angle_between(&stretch.axes[0], &stretch.axes[1]) / self.turn).ceil() as usize;
        let curve = match step {
            Move::Rapid { line } => Curve::Line(*line),
            Move::Feed { along, .. } => *along,
            Move::Turn { .. } | Move::Dwell { .. } => {
                let at = strips.places.last().copied()?;
                let parts = turning.max(1);
                (1..=parts).for_each(|k| self.push(strips, at, stretch, k as f64 / parts as f64));
                self.pass_time(strips, stretch);
                return None;
            }
        };
        let mut along = flat(&curve, self.chord_mm);
        if along.len() <= turning {
            along = even_points(&curve, turning);
        }
        let whole: f64 = along.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let mut done = 0.0;
        for (k, pair) in along.windows(2).enumerate() {
            done += (pair[1] - pair[0]).norm();
            let is_last = k + 2 == along.len();
            self.push(strips, pair[1], stretch, if is_last || whole == 0.0 { 1.0 } else { done / whole });
        }
        self.pass_time(strips, stretch);
        Some(curve.end())
    }

    /// Adds a vertex at a part of a stretch.
    fn push(&self, strips: &mut Strips, at: Point3<f64>, stretch: &MoveFacts, part: f64) {
        strips.places.push(at);
        strips.times.push(self.seconds + part * stretch.seconds.unwrap_or(0.0));
        strips.kinds.push(stretch.kind);
        strips.feeds.push(stretch.feed);
        strips.lines.push(stretch.line);
        strips.deviations_mm.push(stretch.deviation_mm);
        if self.is_leaning {
            strips.axes.push(between(&stretch.axes[0], &stretch.axes[1], part));
        }
    }

    fn pass_time(&mut self, strips: &mut Strips, stretch: &MoveFacts) {
        match stretch.seconds {
            Some(seconds) => self.seconds += seconds,
            None => strips.has_times = false,
        }
    }
}

/// The number of the kind of a move.
fn kind(step: &Move) -> u8 {
    let of = |role: &Role| match role {
        Role::Cut => 1,
        Role::Plunge => 2,
        Role::Ramp => 3,
        Role::LeadIn => 4,
        Role::Link => 5,
        Role::LeadOut => 6,
    };
    match step {
        Move::Rapid { .. } => 0,
        Move::Feed { role, .. } => of(role),
        Move::Dwell { .. } => DWELL,
        Move::Turn { .. } => DWELL + 1,
    }
}

fn is_cut(step: &Move) -> bool {
    matches!(step, Move::Feed { role: Role::Cut, .. })
}

/// The feed of a move, mm/min; 0 for a move without one.
fn feed(step: &Move) -> f32 {
    match step {
        Move::Feed { rate: Some(rate), .. } => rate.mm_per_min() as f32,
        Move::Feed { .. } | Move::Rapid { .. } | Move::Turn { .. } | Move::Dwell { .. } => 0.0,
    }
}

/// The time of a move, s; none for a cut without a feed.
fn seconds(step: &Move, rapid_mm_per_min: f64) -> Option<f64> {
    match step {
        Move::Rapid { line } => Some(60.0 * line.length() / rapid_mm_per_min),
        Move::Feed { along, rate, .. } => rate.map(|rate| 60.0 * along.length() / rate.mm_per_min()),
        Move::Turn { seconds, .. } => *seconds,
        Move::Dwell { seconds } => Some(*seconds),
    }
}

/// The arrays of all strips, in the order in which they are first asked for.
pub struct Arrays {
    placed: Vec<[f32; 3]>,
    positions: super::container::Array,
    others: Vec<(&'static str, super::container::Array)>,
}

impl Arrays {
    pub fn new(document: &mut Document, strips: &Strips) -> Self {
        let placed: Vec<[f32; 3]> = strips.places.iter().map(|p| document.place(p)).collect();
        let positions = document.vec3(&placed);
        let scalars = |values: Vec<f32>, document: &mut Document| document.scalars(&values);
        let mut others = Vec::new();
        if strips.has_times {
            let times = strips.times.iter().map(|s| *s as f32).collect();
            others.push(("_TIME", scalars(times, document)));
        }
        let kinds = strips.kinds.iter().map(|kind| f32::from(*kind)).collect();
        others.push(("_KIND", scalars(kinds, document)));
        others.push(("_FEED", scalars(strips.feeds.clone(), document)));
        if strips.lines.iter().any(|line| *line > 0) {
            let lines = strips.lines.iter().map(|line| *line as f32).collect();
            others.push(("_BLOCK", scalars(lines, document)));
        }
        if strips.deviations_mm.iter().any(|mm| *mm >= 0.0) {
            others.push(("_DEVIATION", scalars(strips.deviations_mm.clone(), document)));
        }
        if !strips.axes.is_empty() {
            let axes: Vec<[f32; 3]> =
                strips.axes.iter().map(|axis| [axis.x as f32, axis.y as f32, axis.z as f32]).collect();
            others.push(("_AXIS", document.vec3(&axes)));
        }
        let linear = COLORS.map(linear);
        let colors: Vec<[u8; 4]> = strips.kinds.iter().map(|kind| linear[usize::from(*kind)]).collect();
        others.push(("COLOR_0", document.colors(&colors)));
        Self { placed, positions, others }
    }
}

/// A colour of a screen (sRGB) as glTF has it: in proportion to the light.
fn linear([red, green, blue, opacity]: [u8; 4]) -> [u8; 4] {
    let light = |channel: u8| {
        let part = f64::from(channel) / 255.0;
        let light = if part <= 0.04045 { part / 12.92 } else { ((part + 0.055) / 1.055).powf(2.4) };
        (255.0 * light).round() as u8
    };
    [light(red), light(green), light(blue), opacity]
}

/// The node of a strip.
pub fn node(document: &mut Document, arrays: &Arrays, strip: &Strip) -> usize {
    let Strip { name, level, first, count } = strip;
    let places = &arrays.placed[*first..first + count];
    let mut attributes = vec![("POSITION", document.places(arrays.positions, *first, places))];
    for (name, array) in &arrays.others {
        attributes.push((name, document.accessor(*array, *first, *count)));
    }
    let mesh = document.mesh(name, Mode::LineStrip, attributes, None, None);
    let mut told = json!({ "name": name });
    if let Some(level) = level {
        told["extras"] = json!({ "level": level });
    }
    document.node(told, Some(mesh), &[])
}
