//! Checks programs of G1 blocks that are rewritten with arcs: the control's path moves by at most the
//! tolerance.

use std::f64::consts::TAU;
use std::fmt::{self, Write};
use std::path::Path;

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::arc_fit::{Fit, Method};
use toolpathd_core::geometry::curve::{Direction, Line};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_post::dialect;
use toolpathd_post::rewrite::{RewriteJob, Rewriter};

use crate::canon::{self, Motion};

/// Tolerance of the fit, mm.
const TOLERANCE_MM: f64 = 0.005;

/// How much the rounded decimals that the interpreter prints may add to a distance, mm.
const PRINTED_MM: f64 = 0.0015;

/// Largest distance of the compared points along a motion, mm.
const STEP_MM: f64 = 0.05;

/// Largest sweep of a written arc, degrees. A wider arc is a full circle, or may become one by rounding.
const WIDEST_DEG: f64 = 351.0;

/// Number of programs along random splines.
const SPLINES: u64 = 40;

const METHODS: [(&str, Method); 2] = [("optimal", Method::Optimal), ("greedy", Method::Greedy)];

/// Figures of the rewritten programs, and the largest distance from the original programs.
#[derive(Debug, Clone, Copy, Default)]
struct Figures {
    programs: usize,
    motions_in: usize,
    motions_out: usize,
    apart_mm: f64,
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { programs, motions_in, motions_out, apart_mm } = self;
        write!(
            f,
            "{programs} programs, {motions_in} motions became {motions_out}, at most {apart_mm:.5} mm apart"
        )
    }
}

/// Rewrites the programs of all forms and along random splines by each method. Returns the figures as text.
pub fn check(directory: &Path) -> Result<String, String> {
    let mut figures = Figures::default();
    for (name, program) in forms().into_iter().chain((0..SPLINES).map(spline)) {
        let before = canon::interpret(&program, directory, &name)?;
        for (by, method) in METHODS {
            let name = format!("{name}-{by}");
            let fault = |what: String| format!("{name}: {what}");
            let (text, proved_mm) = rewritten(&program, method).map_err(fault)?;
            let after = canon::interpret(&text, directory, &name).map_err(fault)?;
            let apart_mm = compare(&before, &after).map_err(fault)?;
            if !(proved_mm <= TOLERANCE_MM && apart_mm <= proved_mm + PRINTED_MM) {
                return Err(fault(format!("{apart_mm} mm apart, {proved_mm} mm are proved")));
            }
            figures.programs += 1;
            figures.motions_in += before.len();
            figures.motions_out += after.len();
            figures.apart_mm = figures.apart_mm.max(apart_mm);
        }
    }
    Ok(figures.to_string())
}

/// The rewritten program, and the proved bound of its distance from the original program, mm.
fn rewritten(program: &str, method: Method) -> Result<(String, f64), String> {
    let linuxcnc = dialect("linuxcnc").ok_or("no dialect")?;
    let fit = Fit { method, ..Fit::within(TOLERANCE_MM) };
    let mut rewriter = Rewriter::new(RewriteJob { dialect: linuxcnc, fit });
    let (budget, mut out) = (Budget::unlimited(), Vec::new());
    rewriter.push(program.as_bytes(), &mut out, &budget).map_err(|error| error.to_string())?;
    rewriter.finish(&mut out, &budget).map_err(|error| error.to_string())?;
    let text = String::from_utf8(out).map_err(|error| error.to_string())?;
    Ok((text, rewriter.figures().deviation_max_mm))
}

/// The largest distance, both ways, between the cutting motions of the two programs, mm. Motions are compared
/// between the same rapids. An error where feeds, rapids or dwells differ.
fn compare(before: &[Motion], after: &[Motion]) -> Result<f64, String> {
    if after.len() >= before.len() {
        return Err(format!("{} motions became {}", before.len(), after.len()));
    }
    if rates(before) != rates(after) {
        return Err("other feeds".into());
    }
    let (before, after) = (stretches(before)?, stretches(after)?);
    if before.len() != after.len() {
        return Err(format!("{} rapids and dwells became {}", before.len(), after.len()));
    }
    let mut apart_mm = 0.0f64;
    for (one, other) in before.iter().zip(&after) {
        for (a, b) in one.ends.iter().zip(&other.ends) {
            if (a - b).norm() > 1e-9 {
                return Err(format!("it ends at {b}, not at {a}"));
            }
        }
        apart_mm = apart_mm.max(farthest(&one.cuts, &other.cuts)).max(farthest(&other.cuts, &one.cuts));
    }
    Ok(apart_mm)
}

/// The feeds of the cutting motions in order, equal neighbours once, mm/min.
fn rates(motions: &[Motion]) -> Vec<f64> {
    let mut rates: Vec<f64> = Vec::new();
    for motion in motions {
        if let Motion::Line { rate, .. } | Motion::Arc { rate, .. } | Motion::Parabola { rate, .. } = motion {
            rates.push(*rate);
        }
    }
    rates.dedup();
    rates
}

/// The cutting motions before a rapid, a dwell or the end of the program.
struct Stretch {
    cuts: Vec<Cut>,
    /// Where the cuts end, and where the next stretch starts.
    ends: [Point3<f64>; 2],
}

/// Divides the motions of a program at rapids and dwells. An error for parabolas and full circles.
fn stretches(motions: &[Motion]) -> Result<Vec<Stretch>, String> {
    let mut at = Point3::origin();
    let (mut stretches, mut cuts) = (Vec::new(), Vec::new());
    for motion in motions {
        let start = at;
        match *motion {
            Motion::Rapid { to } => {
                at = to;
                stretches.push(Stretch { cuts: std::mem::take(&mut cuts), ends: [start, to] });
            }
            Motion::Dwell { .. } => {
                stretches.push(Stretch { cuts: std::mem::take(&mut cuts), ends: [start, start] });
            }
            Motion::Line { to, .. } => {
                at = to;
                cuts.push(Cut::Line(Line { start, end: to }));
            }
            Motion::Arc { plane, direction, to, center, .. } => {
                at = to;
                let turn = Turn::new(plane, direction, [start, to], center);
                if !(turn.sweep > 0.0 && turn.sweep.to_degrees() <= WIDEST_DEG) {
                    return Err(format!("a full circle at {start}"));
                }
                cuts.push(Cut::Turn(turn));
            }
            Motion::Parabola { .. } => return Err("a parabola".into()),
        }
    }
    stretches.push(Stretch { cuts, ends: [at, at] });
    Ok(stretches)
}

/// The largest distance of the compared points of `cuts` from `others`, mm.
fn farthest(cuts: &[Cut], others: &[Cut]) -> f64 {
    let mut farthest = 0.0f64;
    for cut in cuts {
        let count = (cut.length() / STEP_MM).ceil().max(1.0);
        for k in 0..=count as usize {
            let p = cut.point_at(k as f64 / count);
            let off = others.iter().map(|other| other.distance_to(&p)).fold(f64::INFINITY, f64::min);
            farthest = farthest.max(off);
        }
    }
    farthest
}

/// One motion at feed.
enum Cut {
    Line(Line),
    Turn(Turn),
}

impl Cut {
    fn length(&self) -> f64 {
        match self {
            Self::Line(line) => line.length(),
            Self::Turn(turn) => (turn.sweep * turn.radii[0]).hypot(turn.heights[1] - turn.heights[0]),
        }
    }

    fn point_at(&self, t: f64) -> Point3<f64> {
        match self {
            Self::Line(line) => line.point_at(t),
            Self::Turn(turn) => turn.point_at(t),
        }
    }

    fn distance_to(&self, p: &Point3<f64>) -> f64 {
        match self {
            Self::Line(line) => line.distance_to(p),
            Self::Turn(turn) => turn.distance_to(p),
        }
    }
}

/// An arc whose radii at the two ends may differ slightly. Radius and height change in proportion to the
/// angle.
struct Turn {
    plane: Plane,
    ends: [Point3<f64>; 2],
    center: Vector3<f64>,
    radii: [f64; 2],
    heights: [f64; 2],
    start_angle: f64,
    /// The sense of the turn: 1 for counterclockwise, -1 for clockwise.
    sign: f64,
    sweep: f64,
}

impl Turn {
    fn new(plane: Plane, direction: Direction, ends: [Point3<f64>; 2], center: Point3<f64>) -> Self {
        let center = plane.to_local(&center);
        let local = ends.map(|p| plane.to_local(&p));
        let [from, until] = local.map(|p| (p - center).xy());
        let sign = if direction == Direction::Ccw { 1.0 } else { -1.0 };
        Self {
            plane,
            ends,
            center,
            radii: [from.norm(), until.norm()],
            heights: local.map(|p| p.z),
            start_angle: from.y.atan2(from.x),
            sign,
            sweep: (sign * from.perp(&until).atan2(from.dot(&until))).rem_euclid(TAU),
        }
    }

    /// The point at the fraction `t` of the sweep.
    fn point_at(&self, t: f64) -> Point3<f64> {
        let between = |[from, until]: [f64; 2]| from + (until - from) * t;
        let (sin, cos) = (self.start_angle + self.sign * self.sweep * t).sin_cos();
        let radius = between(self.radii);
        let (x, y) = (self.center.x + radius * cos, self.center.y + radius * sin);
        self.plane.to_workpiece(&Vector3::new(x, y, between(self.heights)))
    }

    /// An upper bound for the distance of `p`: the distance to the point at the angle of `p`, or to an end.
    fn distance_to(&self, p: &Point3<f64>) -> f64 {
        let spoke = self.plane.to_local(p) - self.center;
        let turned = (self.sign * (spoke.y.atan2(spoke.x) - self.start_angle)).rem_euclid(TAU);
        let ends = (p - self.ends[0]).norm().min((p - self.ends[1]).norm());
        if turned <= self.sweep { ends.min((p - self.point_at(turned / self.sweep)).norm()) } else { ends }
    }
}

/// NC text with a block for each point, with words for the given axes only.
fn blocks(axes: &str, points: &[[f64; 3]], decimals: usize) -> String {
    let mut text = String::new();
    for point in points {
        let words = ['X', 'Y', 'Z'].into_iter().zip(point).filter(|(letter, _)| axes.contains(*letter));
        let words: Vec<_> = words.map(|(letter, value)| format!("{letter}{value:.decimals$}")).collect();
        text.push_str(&words.join(" "));
        text.push('\n');
    }
    text
}

/// The points `at(1)` to `at(count)`.
fn points(count: u32, at: impl Fn(f64) -> [f64; 3]) -> Vec<[f64; 3]> {
    (1..=count).map(|k| at(f64::from(k))).collect()
}

/// A program for each form of runs, with its name.
fn forms() -> Vec<(String, String)> {
    let head = "G17 G21 G90 G94\nG0 X0 Y0 Z5\nG1 Z-1 F300\n";
    let tail = "G0 Z20\nM2\n";
    let sine = points(400, |k| [0.25 * k, 20.0 * (0.25 * k / 20.0).sin(), 0.0]);
    let flat = blocks("XY", &sine, 3);
    let wave = |k: f64| 3.0 * (0.05 * k).cos() - 3.0;

    let (mut rows_xz, mut rows_yz) = (String::new(), String::new());
    for row in 0..4 {
        let place = |k: f64| if row % 2 == 0 { 0.25 * k } else { 40.0 - 0.25 * k };
        let _ = writeln!(rows_xz, "Y{}", 2 * row);
        rows_xz += &blocks("XZ", &points(160, |k| [place(k), 0.0, wave(place(k) * 4.0)]), 3);
        let _ = writeln!(rows_yz, "X{}", 2 * row);
        rows_yz += &blocks("YZ", &points(160, |k| [0.0, place(k), wave(place(k) * 4.0)]), 3);
    }
    let level = "G17 G21 G90 G94\nG0 X0 Y0 Z5\nG1 Z0 F600\n";

    let round = |k: f64| [8.0 * (TAU * k / 120.0).cos(), 8.0 * (TAU * k / 120.0).sin(), -0.005 * k];
    let beside = "G17 G21 G90 G94\nG0 X8 Y0 Z5\nG1 Z0 F300\n";

    let inches = points(400, |k| [0.01 * k, 0.8 * (0.01 * k / 0.8).sin(), 0.0]);
    let mut increments = Vec::new();
    let mut at = [0.0; 3];
    for point in &sine {
        let to = point.map(|value| (1000.0 * value).round());
        increments.push([0, 1, 2].map(|axis| (to[axis] - at[axis]) / 1000.0));
        at = to;
    }
    let (mut noted, mut numbered) = (String::new(), String::new());
    for (k, line) in flat.lines().enumerate() {
        noted += line;
        noted += match k % 200 {
            40 => "\n(a part)\n",
            80 => " (here)\n",
            120 => "\nM8\n\n",
            160 => "\nG4 P0.1\n; on\n",
            199 => " F450\n",
            _ => "\n",
        };
        let feed = if k == 200 { "F900" } else { "" };
        let _ = writeln!(numbered, "N{}G1{}{feed}", 10 * (k + 1), line.replace(' ', ""));
    }
    [
        ("sine", format!("{head}{flat}{tail}")),
        ("rows-xz", format!("{level}{rows_xz}{tail}")),
        ("rows-yz", format!("{level}{rows_yz}{tail}")),
        ("helix", format!("{beside}{}{tail}", blocks("XYZ", &points(360, round), 3))),
        ("circle", format!("{beside}{}{tail}", blocks("XY", &points(120, round), 3))),
        (
            "inch",
            format!("G17 G20 G90 G94\nG0 X0 Y0 Z0.2\nG1 Z-0.04 F12\n{}G0 Z1\nM2\n", blocks("XY", &inches, 4)),
        ),
        ("increments", format!("{head}G91\n{}G90\n{tail}", blocks("XY", &increments, 3))),
        ("noted", format!("{head}{noted}{tail}")),
        ("numbered", format!("{head}{numbered}{tail}")),
    ]
    .map(|(name, program)| (name.to_owned(), program))
    .into()
}

/// A pseudorandom number in 0..1, the same on every machine: SplitMix64 at position `place`.
fn noise(seed: u64, place: u64) -> f64 {
    let mut x = (seed << 32 | place).wrapping_add(1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// A program along a uniform cubic B-spline with random control points, in one of the planes or in space.
fn spline(seed: u64) -> (String, String) {
    let axes = ["XY", "XZ", "YZ", "XYZ"][(seed % 4) as usize];
    let control = |k: u64| [0, 1, 2].map(|axis| 80.0 * noise(seed, 3 * k + axis) - 40.0);
    let at = |segment: u64, t: f64| {
        let s = 1.0 - t;
        let weights =
            [s * s * s, 3.0 * t * t * t - 6.0 * t * t + 4.0, 3.0 * s * s * s - 6.0 * s * s + 4.0, t * t * t];
        let mut sum = [0.0; 3];
        for (k, weight) in (segment..).zip(weights) {
            for (sum, value) in sum.iter_mut().zip(control(k)) {
                *sum += weight * value / 6.0;
            }
        }
        sum
    };
    let mut points = Vec::new();
    for segment in 0..5 {
        points.extend((1..=160).map(|k| at(segment, f64::from(k) / 160.0)));
    }
    let start = blocks("XYZ", &[at(0, 0.0)], 3);
    let program = format!("G17 G21 G90 G94\nG0 {start}G1 F600\n{}G0 Z100\nM2\n", blocks(axes, &points, 3));
    (format!("spline{seed}"), program)
}
