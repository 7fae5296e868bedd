//! Programs of toolpaths that hold the positions of the rotary axes.

use super::*;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::siemens::SIEMENS;
use toolpathd_core::machine::{AxisPositions, Straying, named};

const ALLOWED: Straying = Straying { tip_mm: 0.002, axis: 1e-4 };

/// A line along which the rotary axes turn as stated: C by a turn and a half, on the other branch than the
/// nearest, and a turn at rest.
fn with_positions() -> Toolpath {
    let table = named::by_name("table_table_ac").unwrap();
    let axis = |rotary| table.forward(&AxisPositions { linear_mm: [0.0; 3], rotary }).axis;
    let at = |part: f64| [0.3, 2.0 + 3.0 * std::f64::consts::PI * part];
    let mut path = Toolpath::builder(Point3::origin());
    path.rotate_next(at(0.0));
    path.begin_leaning_pass(None, axis(at(0.0)));
    for k in 1..=100 {
        let rotary = at(f64::from(k) / 100.0);
        path.rotate_next(rotary);
        path.turn_next(axis(rotary)).unwrap();
        path.line(Point3::new(0.2 * f64::from(k), 0.0, 0.0), feed(2000.0), Role::Cut).unwrap();
    }
    path.rotate_next([0.3, at(1.0)[1] + 0.1]);
    path.turn(axis([0.3, at(1.0)[1] + 0.1]), Some(0.01), Role::Cut).unwrap();
    path.finish().unwrap()
}

#[test]
fn the_positions_of_a_toolpath_are_written_and_no_axis_is_too_fast() {
    let table = named::by_name("table_table_ac").unwrap();
    let (program, cutting) = (Program::plain(MM), cutting());
    let limits = [40.0, 40.0, 40.0, 3.0, 2.0];
    let toolpath = with_positions();
    for (dialect, output) in [
        (&LINUXCNC, AxisOutput::Machine),
        (&FANUC, AxisOutput::Angles),
        (&HEIDENHAIN, AxisOutput::Angles),
        (&SIEMENS, AxisOutput::Angles),
    ] {
        let is_klartext = dialect.name == "heidenhain";
        let text = |speeds: [f64; 5]| {
            let five_axes = FiveAxes { output, machine: Some(&table), allowed: ALLOWED, speeds };
            let job = ProgramJob {
                tool: Some(&Tool { length_offset: None, ..TOOL }),
                five_axes: Some(five_axes),
                ..ProgramJob::plain(&program, &cutting, dialect)
            };
            write(&toolpath, &job, &Budget::unlimited()).unwrap().text
        };
        let turns = |text: &str| speeds_of(text, is_klartext);
        let within = text(limits);
        let blocks = turns(&within);
        let (first, last) = (blocks.first().unwrap(), blocks.last().unwrap());
        let turned = last.c_deg - first.from_c_deg;
        assert!((turned - 540.0 - 0.1_f64.to_degrees()).abs() < 1e-2, "{}: {turned}", dialect.name);
        let largest = |blocks: &[TurnOfC]| blocks.iter().map(|block| block.deg_per_s).fold(0.0, f64::max);
        let allowed = limits[4].to_degrees();
        assert!(largest(&blocks) <= 1.001 * allowed, "{}: {}", dialect.name, largest(&blocks));
        // 20 mm at 2000 mm/min turn C by 540 degrees in 0.6 s.
        assert!(largest(&turns(&text([f64::INFINITY; 5]))) > 800.0);
        assert!(largest(&turns(&with_faster_feeds(&within))) > 1.05 * allowed, "{}", dialect.name);
    }
}

/// A program whose feeds are all larger by a tenth.
fn with_faster_feeds(text: &str) -> String {
    let faster = |word: &str| match word.strip_prefix('F').map(str::parse::<f64>) {
        Some(Ok(feed)) => format!("F{}", 1.1 * feed),
        _ => word.to_owned(),
    };
    let line = |line: &str| line.split(' ').map(faster).collect::<Vec<_>>().join(" ");
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}

/// How far and how fast C turns in a block.
struct TurnOfC {
    from_c_deg: f64,
    c_deg: f64,
    deg_per_s: f64,
}

/// The turns of C of the feed blocks of a program, read word by word.
fn speeds_of(text: &str, is_klartext: bool) -> Vec<TurnOfC> {
    let (mut at, mut c, mut feed) = ([0.0_f64; 3], f64::NAN, 0.0);
    let (mut is_time, mut is_rapid, mut blocks) = (false, true, Vec::new());
    for line in text.lines().filter(|line| !line.starts_with(['(', '%', ';'])) {
        let (mut to, mut to_c) = (at, c);
        let line = line.replace("FMAX", "RAPID");
        for word in line.split_whitespace() {
            let Ok(value) = word[1..].trim_start_matches('=').parse::<f64>() else {
                is_rapid = is_klartext && word == "RAPID" || is_rapid && !is_klartext;
                continue;
            };
            match word.as_bytes()[0] {
                b'X' => to[0] = value,
                b'Y' => to[1] = value,
                b'Z' => to[2] = value,
                b'C' => to_c = value,
                b'F' => (feed, is_rapid) = (value, is_rapid && !is_klartext),
                b'G' if value == 93.0 => is_time = true,
                b'G' if value == 94.0 => is_time = false,
                b'G' if value <= 1.0 => is_rapid = value == 0.0,
                _ => {}
            }
        }
        let way = (0..3).map(|k| (to[k] - at[k]).powi(2)).sum::<f64>().sqrt();
        if to_c != c && !c.is_nan() && !is_rapid {
            let seconds = match (is_time, way > 0.0) {
                (true, _) => 60.0 / feed,
                (false, true) => 60.0 * way / feed,
                (false, false) => 60.0 * (to_c - c).abs() / feed,
            };
            blocks.push(TurnOfC { from_c_deg: c, c_deg: to_c, deg_per_s: (to_c - c).abs() / seconds });
        }
        (at, c) = (to, to_c);
    }
    blocks
}
