//! Runs the interpreter as a process and reads the canonical motions that the interpreter prints.

use std::fs::{self, File};
use std::path::Path;
use std::process::{Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::curve::{Direction, Parabola};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_post::dialect::{Dialect, Dwell, Syntax};

/// Longest time for one program. If the interpreter takes longer, it hangs.
const PATIENCE: Duration = Duration::from_secs(300);

/// One canonical motion, in mm, mm/min and s. Coordinates have the four decimals that the interpreter prints.
#[derive(Debug, Clone, Copy)]
pub enum Motion {
    Rapid {
        to: Point3<f64>,
    },
    Line {
        to: Point3<f64>,
        rate: f64,
    },
    Arc {
        plane: Plane,
        direction: Direction,
        to: Point3<f64>,
        center: Point3<f64>,
        rate: f64,
    },
    /// The start and the control point are exact, because the preview computes them.
    Parabola {
        curve: Parabola,
        rate: f64,
    },
    Dwell {
        seconds: f64,
    },
}

/// A tool table with tools 1 to 99, all without length. Programs may call any of them.
fn tool_table() -> String {
    (1..=99).map(|k| format!("T{k} P{k} Z0.0 D0.1\n")).collect()
}

/// The text translated for LinuxCNC. The line of the program's number is left out, because LinuxCNC takes the
/// number for a subroutine's. A dwell in milliseconds becomes a dwell in seconds.
pub fn translated(text: &str, dialect: &Dialect) -> String {
    let iso = match dialect.syntax {
        Syntax::Iso(iso) => iso,
        Syntax::Siemens(_) | Syntax::Klartext | Syntax::Deckel => return text.to_owned(),
    };
    let is_number = |line: &str| {
        let rest = iso.program_number.and_then(|number| line.strip_prefix(number.letter));
        rest.is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    let mut lines: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| !is_number(line)) {
        let pauses = ["G4", "G82", "G89"].iter().any(|code| line.split(' ').any(|word| word == *code));
        let in_seconds = |word: &str| match word.strip_prefix('P').map(str::parse::<f64>) {
            Some(Ok(count)) => format!("P{:.3}", count / 1000.0),
            _ => word.to_owned(),
        };
        lines.push(if iso.dwell == Dwell::Milliseconds && pauses {
            line.split(' ').map(in_seconds).collect::<Vec<_>>().join(" ")
        } else {
            line.to_owned()
        });
    }
    lines.join("\n") + "\n"
}

/// Runs the interpreter on `text` and returns the motions that the control would make.
///
/// The interpreter keeps its parameters in the working directory, and all interpreters of one home directory
/// share a tool table. So each program has a directory of its own below `directory`, which serves as working
/// directory and as home. The directory of a refused program stays.
pub fn interpret(text: &str, directory: &Path, name: &str) -> Result<Vec<Motion>, String> {
    let home = directory.join(name);
    let fault = |error: std::io::Error| error.to_string();
    fs::create_dir_all(&home).map_err(fault)?;
    fs::write(home.join("tool.tbl"), tool_table()).map_err(fault)?;
    fs::write(home.join("program.ngc"), text).map_err(fault)?;
    let (canon, complaint) = (home.join("canon"), home.join("complaint"));
    let mut child = Command::new("rs274")
        .args(["-t", "tool.tbl", "-g", "program.ngc"])
        .current_dir(&home)
        .env("HOME", &home)
        .stdin(Stdio::null())
        .stdout(File::create(&canon).map_err(fault)?)
        .stderr(File::create(&complaint).map_err(fault)?)
        .spawn()
        .map_err(|error| format!("rs274: {error}"))?;
    let begun = Instant::now();
    let status = loop {
        match child.try_wait().map_err(fault)? {
            Some(status) => break status,
            None if begun.elapsed() > PATIENCE => {
                child.kill().map_err(fault)?;
                child.wait().map_err(fault)?;
                return Err("the interpreter does not come to an end".into());
            }
            None => sleep(Duration::from_millis(2)),
        }
    };
    if !status.success() {
        return Err(format!("refused: {}", fs::read_to_string(&complaint).map_err(fault)?));
    }
    let printed = fs::read_to_string(&canon).map_err(fault)?;
    let splines = if printed.contains("NURBS_FEED(") { splines(&home)? } else { Vec::new() };
    let motions = parse(&printed, splines)?;
    fs::remove_dir_all(&home).map_err(fault)?;
    Ok(motions)
}

/// The curves of the program's spline blocks, computed by `preview.py`, because the interpreter prints no
/// points.
fn splines(home: &Path) -> Result<Vec<Parabola>, String> {
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/real/controller/preview.py");
    let mut command = Command::new("/usr/bin/python3");
    command.arg(script).arg("program.ngc").current_dir(home).env("HOME", home).stdin(Stdio::null());
    let output = command.output().map_err(|error| format!("the preview: {error}"))?;
    if !output.status.success() {
        return Err(format!("the preview: {}", String::from_utf8_lossy(&output.stderr)));
    }
    String::from_utf8_lossy(&output.stdout).lines().map(spline).collect()
}

/// The parabola through the points of one line of the preview. The points lie at equal steps of the
/// parameter, and the last point is the end. The parabola lies at height zero: the preview gives wrong
/// heights after arcs in other planes, and the interpreter's own call has no height.
fn spline(line: &str) -> Result<Parabola, String> {
    let numbers: Result<Vec<f64>, _> = line.split(' ').map(str::parse).collect();
    let numbers = numbers.map_err(|error| format!("the preview: {error}"))?;
    let points: Vec<_> = numbers.chunks_exact(3).map(|p| Point3::new(p[0], p[1], 0.0)).collect();
    let n = points.len();
    if n < 3 || !n.is_multiple_of(3) {
        return Err(format!("a spline of {n} points"));
    }
    // At a third of the parameter 9 P = 4 start + 4 control + end. At two thirds start and end change places.
    let (third, rest, end) = (points[n / 3 - 1], points[2 * n / 3 - 1], points[n - 1]);
    let start = end + (third - rest) * 3.0;
    let control = Point3::from((third.coords * 9.0 - start.coords * 4.0 - end.coords) / 4.0);
    let curve = Parabola::new(start, control, end).map_err(|error| error.to_string())?;
    for (k, point) in points.iter().enumerate() {
        let off = (curve.at((k + 1) as f64 / n as f64) - point).norm();
        if off > 1e-9 {
            return Err(format!("a spline block is no parabola: {off} mm at its point {k}"));
        }
    }
    Ok(curve)
}

/// The motions in the text that the interpreter prints. `splines` holds the curves of its spline blocks.
fn parse(text: &str, splines: Vec<Parabola>) -> Result<Vec<Motion>, String> {
    let mut splines = splines.into_iter();
    let (mut unit, mut rate, mut plane, mut height) = (1.0, 0.0, Plane::Xy, 0.0);
    let mut motions = Vec::new();
    for line in text.lines() {
        let Some((head, rest)) = line.split_once('(') else { continue };
        let name = head.rsplit(|c: char| !(c.is_ascii_uppercase() || c == '_')).next().unwrap_or_default();
        let arguments = rest.strip_suffix(')').ok_or_else(|| format!("cut off: {line}"))?;
        let numbers = || -> Result<Vec<f64>, String> {
            arguments.split(',').map(|n| n.trim().parse().map_err(|_| format!("no number: {line}"))).collect()
        };
        match name {
            "USE_LENGTH_UNITS" => unit = if arguments == "CANON_UNITS_MM" { 1.0 } else { 25.4 },
            "SET_FEED_RATE" => rate = numbers()?[0] * unit,
            "SELECT_PLANE" => {
                plane = match arguments {
                    "CANON_PLANE_XY" => Plane::Xy,
                    "CANON_PLANE_XZ" => Plane::Zx,
                    "CANON_PLANE_YZ" => Plane::Yz,
                    other => return Err(format!("plane {other}")),
                }
            }
            "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED" => {
                let n = numbers()?;
                let to = Point3::new(n[0], n[1], n[2]) * unit;
                height = to.z;
                motions.push(if name == "STRAIGHT_FEED" {
                    Motion::Line { to, rate }
                } else {
                    Motion::Rapid { to }
                });
            }
            "ARC_FEED" => {
                let n = numbers()?;
                let direction = match n[4] {
                    1.0 => Direction::Ccw,
                    -1.0 => Direction::Cw,
                    turns => return Err(format!("an arc of {turns} turns")),
                };
                let [to, center] = [[n[0], n[1], n[5]], [n[2], n[3], n[5]]]
                    .map(|local| plane.to_workpiece(&(Vector3::from(local) * unit)));
                height = to.z;
                motions.push(Motion::Arc { plane, direction, to, center, rate });
            }
            "DWELL" => motions.push(Motion::Dwell { seconds: numbers()?[0] }),
            "NURBS_FEED" => {
                let curve = splines.next().ok_or("a spline without its points")?;
                // The end is rounded as the interpreter prints it, because the next motion starts at the
                // printed point, and a full circle ends there too.
                let end = curve.end().map(|x| (x / unit * 1e4).round() / 1e4 * unit);
                let curve = Parabola::new(curve.start(), curve.control(), end).map_err(|e| e.to_string())?;
                let curve = curve.translated(&Vector3::new(0.0, 0.0, height));
                motions.push(Motion::Parabola { curve, rate });
            }
            "STRAIGHT_PROBE" | "RIGID_TAP" => return Err(format!("unexpected: {line}")),
            _ => {}
        }
    }
    if splines.next().is_none() { Ok(motions) } else { Err("more splines than the interpreter runs".into()) }
}
