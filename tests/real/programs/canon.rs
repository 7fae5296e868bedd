//! Runs LinuxCNC's interpreter and adds up what it prints.

use std::f64::consts::TAU;
use std::fs::{self, File};
use std::ops::RangeInclusive;
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Longest time for one program.
const PATIENCE: Duration = Duration::from_secs(30);

/// The numbers of the tools of the table.
pub const TOOLS: RangeInclusive<u32> = 1..=99;

/// Radius of every cutter of the table, which is in inches, mm.
pub const CUTTER_RADIUS_MM: f64 = 0.05 * 25.4;

/// The sums of a program.
#[derive(Debug, Clone, Copy, Default)]
pub struct Figures {
    pub cut_mm: f64,
    pub cut_s: f64,
    pub rapid_mm: f64,
    pub dwell_s: f64,
    pub end: [f64; 3],
    pub moves: usize,
    /// There are rapids whose ends are not known, which do not count.
    pub has_unknown_rapids: bool,
    /// There are splines, which the interpreter does not print.
    pub has_splines: bool,
}

impl Figures {
    /// What differs by more than the printed decimals allow.
    pub fn difference(&self, theirs: &Self) -> Option<String> {
        // Each end is rounded to 0.0001 of an inch or a millimetre.
        let allowed = 0.006 * (self.moves.max(theirs.moves) as f64 + 1.0);
        let slowest = 5.0;
        let pairs = [
            ("cuts", self.cut_mm, theirs.cut_mm, allowed),
            ("rapids", self.rapid_mm, theirs.rapid_mm, allowed),
            ("pauses", self.dwell_s, theirs.dwell_s, 1e-3 * (self.moves as f64 + 1.0)),
            ("seconds of cuts", self.cut_s, theirs.cut_s, allowed * 60.0 / slowest),
            ("x", self.end[0], theirs.end[0], 0.006),
            ("y", self.end[1], theirs.end[1], 0.006),
            ("z", self.end[2], theirs.end[2], 0.006),
        ];
        let differs = |(_, a, b, allowed): &&(&str, f64, f64, f64)| (a - b).abs() > *allowed;
        let is_told = |(name, ..): &&(&str, f64, f64, f64)| match *name {
            "rapids" => !self.has_unknown_rapids && !theirs.has_splines,
            "cuts" | "seconds of cuts" => !theirs.has_splines,
            _ => true,
        };
        let found = pairs.iter().filter(is_told).find(differs);
        found.map(|(name, ours, theirs, _)| format!("{name}: {ours} here, {theirs} there"))
    }
}

/// The figures of a program, or the message of the interpreter.
pub fn interpret(text: &[u8], directory: &Path) -> Result<Figures, String> {
    fs::write(directory.join("program.ngc"), text).map_err(|error| error.to_string())?;
    let tools: String = TOOLS.map(|k| format!("T{k} P{k} Z0.0 D0.1\n")).collect();
    fs::write(directory.join("tool.tbl"), tools).map_err(|error| error.to_string())?;
    let open = |name: &str| File::create(directory.join(name)).map_err(|error| error.to_string());
    let mut child = Command::new("rs274")
        .args(["-t", "tool.tbl", "-g", "program.ngc"])
        .current_dir(directory)
        .stdin(Stdio::null())
        .stdout(open("out")?)
        .stderr(open("err")?)
        .spawn()
        .map_err(|error| error.to_string())?;
    let begun = Instant::now();
    let status = loop {
        match child.try_wait().map_err(|error| error.to_string())? {
            Some(status) => break status,
            None if begun.elapsed() > PATIENCE => {
                let _ = child.kill();
                let _ = child.wait();
                return Err("the interpreter hangs".to_owned());
            }
            None => sleep(Duration::from_millis(2)),
        }
    };
    if !status.success() {
        let told = fs::read(directory.join("err")).unwrap_or_default();
        return Err(String::from_utf8_lossy(&told).into_owned());
    }
    let out = fs::read(directory.join("out")).map_err(|error| error.to_string())?;
    Ok(add_up(&String::from_utf8_lossy(&out)))
}

fn add_up(out: &str) -> Figures {
    let mut figures = Figures::default();
    let (mut unit, mut rate, mut axes) = (1.0, 0.0, [0, 1, 2]);
    let mut at = [0.0; 3];
    // What is added to the coordinates of the program, mm.
    let (mut zero, mut shift) = ([0.0; 3], [0.0; 3]);
    // The turn of the work offset about its zero: cosine and sine.
    let mut turned = [1.0, 0.0];
    for line in out.lines() {
        // The number of the call, the number of the block, the call.
        let call = line.trim_start().splitn(3, char::is_whitespace).nth(2).unwrap_or_default();
        let Some((name, rest)) = call.trim_start().split_once('(') else { continue };
        let arguments = rest.trim_end().trim_end_matches(')');
        let numbers: Vec<f64> = arguments.split(',').filter_map(|text| text.trim().parse().ok()).collect();
        let cut = |figures: &mut Figures, length: f64| {
            figures.cut_mm += length;
            figures.moves += 1;
            figures.cut_s += if length > 0.0 { length / rate * 60.0 } else { 0.0 };
        };
        match name {
            "USE_LENGTH_UNITS" => unit = if arguments.contains("INCHES") { 25.4 } else { 1.0 },
            "SET_FEED_RATE" => rate = numbers[0] * unit,
            "SELECT_PLANE" => {
                axes = match arguments {
                    "CANON_PLANE_XZ" => [2, 0, 1],
                    "CANON_PLANE_YZ" => [1, 2, 0],
                    _ => [0, 1, 2],
                };
            }
            "SET_G5X_OFFSET" => zero = [numbers[1], numbers[2], numbers[3]].map(|x| x * unit),
            "SET_XY_ROTATION" => {
                let (sin, cos) = numbers[0].to_radians().sin_cos();
                turned = [cos, sin];
            }
            "SET_G92_OFFSET" => shift = [numbers[0], numbers[1], numbers[2]].map(|x| x * unit),
            "NURBS_FEED" => figures.has_splines = true,
            "DWELL" => figures.dwell_s += numbers[0],
            "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED" => {
                let to = placed([0, 1, 2].map(|k| numbers[k] * unit + shift[k]), turned, zero);
                let length = (0..3).map(|k| (to[k] - at[k]).powi(2)).sum::<f64>().sqrt();
                if name == "STRAIGHT_FEED" {
                    cut(&mut figures, length);
                } else {
                    figures.moves += 1;
                    figures.rapid_mm += length;
                }
                at = to;
            }
            "ARC_FEED" => {
                let [a, b, n] = axes;
                // No arc of the random programs lies in another plane while the work offset is turned.
                let place = |first: usize, second: usize| {
                    let mut at = [0.0; 3];
                    (at[a], at[b], at[n]) = (numbers[first], numbers[second], numbers[5]);
                    placed([0, 1, 2].map(|k| at[k] * unit + shift[k]), turned, zero)
                };
                let (end, center) = (place(0, 1), place(2, 3));
                let [ea, eb, ca, cb, en] = [end[a], end[b], center[a], center[b], end[n]];
                let (from, to) = ([at[a] - ca, at[b] - cb], [ea - ca, eb - cb]);
                let turn = numbers[4];
                let mut sweep = (to[1].atan2(to[0]) - from[1].atan2(from[0])) * turn.signum();
                // Ends within the printed decimals are equal.
                let is_closed = (ea - at[a]).hypot(eb - at[b]) <= 3e-4 * unit;
                sweep = if is_closed { TAU } else { sweep.rem_euclid(TAU) } + TAU * (turn.abs() - 1.0);
                let length = (from[0].hypot(from[1]) * sweep).hypot(en - at[n]);
                cut(&mut figures, length);
                (at[a], at[b], at[n]) = (ea, eb, en);
            }
            _ => {}
        }
    }
    figures.end = at;
    figures
}

/// A place of the program in coordinates of the machine, mm.
fn placed([x, y, z]: [f64; 3], [cos, sin]: [f64; 2], zero: [f64; 3]) -> [f64; 3] {
    [x * cos - y * sin + zero[0], x * sin + y * cos + zero[1], z + zero[2]]
}
