//! Canned cycles: how each dialect writes them, and that the check reads all of their words.

use nalgebra::Point2;

use super::corrupted::survivors;
use super::*;
use crate::dialects::grbl::GRBL;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::siemens::SIEMENS;
use toolpathd_core::toolpath::cycle::{CycleKind, Hole, ReturnTo};

/// A tool that every dialect can call.
const DRILL: Tool = Tool { length_offset: None, ..TOOL };

fn text_in(dialect: &Dialect, hole: Hole, program: &Program) -> String {
    let cutting = cutting();
    let job = ProgramJob { tool: Some(&DRILL), ..ProgramJob::plain(program, &cutting, dialect) };
    write(&drilled(hole), &job, &Budget::unlimited()).unwrap().text
}

/// A hole of 12 mm from 2 mm above the material, in pecks of 5 mm where the cycle has pecks.
pub fn hole(kind: CycleKind) -> Hole {
    Hole {
        kind,
        top_z_mm: 0.0,
        retract_z_mm: 2.0,
        bottom_z_mm: -12.0,
        peck_mm: kind.pecks().then_some(5.0),
        dwell_s: 0.0,
        rate: feed(200.0),
        return_to: ReturnTo::RetractPlane,
    }
}

/// One cycle at two places, from 20 mm above.
fn drilled(hole: Hole) -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 20.0));
    path.cycle(hole, vec![Point2::new(10.0, 5.0), Point2::new(30.0, 8.0)]).unwrap();
    path.rapid(Point3::new(30.0, 8.0, 20.0)).unwrap();
    path.finish().unwrap()
}

/// The text from the first hole on to the last rapid.
fn body(dialect: &'static Dialect, hole: Hole) -> String {
    let text = text_in(dialect, hole, &Program::plain(MM));
    let lines: Vec<&str> = text.lines().collect();
    let unnumbered = |line: &&str| {
        let line = line.trim_start_matches('N').trim_start_matches(|c: char| c.is_ascii_digit());
        line.strip_prefix(' ').unwrap_or(line).to_owned()
    };
    let lines: Vec<String> = lines.iter().map(unnumbered).collect();
    let is_start = |line: &String| {
        ["G98", "G99", "F200", "MCALL CYCLE85", "CYCL DEF 20"].iter().any(|own| line.starts_with(own))
    };
    let from = lines.iter().position(is_start).unwrap();
    let to = lines.iter().rposition(|line| line.contains("Z20.000") || line.contains("Z+20.000")).unwrap();
    lines[from..=to].join("\n")
}

#[test]
fn iso_words_state_a_cycle_once_and_then_its_places() {
    let pauses = Hole { dwell_s: 0.5, ..hole(CycleKind::Drill) };
    let returns = Hole { return_to: ReturnTo::Start, ..hole(CycleKind::Ream) };
    let at = "X10.000 Y5.000 Z-12.000 R2.000";
    for (hole, words, linuxcnc, fanuc) in [
        (hole(CycleKind::Drill), "G99 G81", "", ""),
        (pauses, "G99 G82", " P0.500", " P500"),
        (hole(CycleKind::Peck), "G99 G83", " Q5.000", " Q5.000"),
        (hole(CycleKind::ChipBreak), "G99 G73", " Q5.000", " Q5.000"),
        (returns, "G98 G85", "", ""),
        (Hole { dwell_s: 0.5, ..returns }, "G98 G89", " P0.500", " P500"),
    ] {
        let tail = if hole.return_to == ReturnTo::Start { "" } else { "\nG0 Z20.000" };
        let places = "X30.000 Y8.000\nG80";
        if !tail.is_empty() {
            assert_eq!(body(&LINUXCNC, hole), format!("{words} {at}{linuxcnc} F200\n{places}{tail}"));
            assert_eq!(body(&FANUC, hole), format!("{words} {at}{fanuc} F200.\n{places}{tail}"));
        } else {
            let text = text_in(&FANUC, hole, &Program::plain(MM));
            assert!(text.contains(&format!("\n{words} {at}{fanuc} F200.\n{places}\n")), "{text}");
        }
    }
}

#[test]
fn siemens_calls_its_cycles_behind_each_place() {
    let places = "G0 X10.000 Y5.000\nG0 X30.000 Y8.000\nMCALL\nG0 Z20.000";
    let head = "2.000,0.000,2.000,-12.000";
    for (hole, call) in [
        (hole(CycleKind::Drill), format!("CYCLE81({head})")),
        (Hole { dwell_s: 0.5, ..hole(CycleKind::Drill) }, format!("CYCLE82({head},,0.500)")),
        (hole(CycleKind::Peck), format!("CYCLE83({head},,,5.000,0,0,0,1,1)")),
        (hole(CycleKind::ChipBreak), format!("CYCLE83({head},,,5.000,0,0,0,1,0)")),
        (hole(CycleKind::Ream), format!("CYCLE85({head},,0.000,200,200)")),
    ] {
        let feed = if hole.kind == CycleKind::Ream { "" } else { "F200\n" };
        assert_eq!(body(&SIEMENS, hole), format!("{feed}MCALL {call}\n{places}"));
    }
}

#[test]
fn heidenhain_defines_a_cycle_and_runs_it_by_m99() {
    let expected = "CYCL DEF 200 DRILLING ~\n Q200=+2.000 ; SET-UP CLEARANCE ~\n Q201=-12.000 ; DEPTH ~\n \
        Q206=+200 ; FEED RATE FOR PLNGNG ~\n Q202=+5.000 ; PLUNGING DEPTH ~\n Q210=+0 ; DWELL TIME AT TOP ~\n \
        Q203=+0.000 ; SURFACE COORDINATE ~\n Q204=+2.000 ; 2ND SET-UP CLEARANCE ~\n \
        Q211=+0.000 ; DWELL TIME AT DEPTH\nL X+10.000 Y+5.000 R0 FMAX M99\nL X+30.000 Y+8.000 R0 FMAX M99\n\
        L Z+20.000 R0 FMAX";
    assert_eq!(body(&HEIDENHAIN, hole(CycleKind::Peck)), expected);
    // The control has no cycle of its own that breaks chips and no more.
    let text = text_in(&HEIDENHAIN, hole(CycleKind::ChipBreak), &Program::plain(MM));
    assert!(!text.contains("CYCL DEF 20") && text.contains("L Z-3.000 R0 F200"), "{text}");
}

#[test]
fn a_control_without_cycles_runs_their_moves() {
    let text = text_in(&GRBL, hole(CycleKind::Peck), &Program::plain(MM));
    assert!(
        text.contains("X10.000 Y5.000\nZ2.000\nG1 Z-3.000 F200\nG0 Z2.000\nZ-2.500\nG1 Z-8.000\n"),
        "{text}"
    );
}

#[test]
fn what_rounding_leaves_of_a_cycle_is_written() {
    let coarse = Program::plain(Resolution { units: Units::Mm, decimals: 1 });
    let write = |hole| text_in(&FANUC, hole, &coarse);
    // One peck is no peck.
    let deep = Hole { peck_mm: Some(12.0), ..hole(CycleKind::Peck) };
    assert!(write(deep).contains("G99 G81 X10.0 Y5.0 Z-12.0 R2.0 F200."));
}

#[test]
fn heights_that_rounding_joins_are_refused_in_every_dialect() {
    let coarse = Program::plain(Resolution { units: Units::Mm, decimals: 1 });
    let (drill, cutting) = (hole(CycleKind::Drill), cutting());
    for dialect in DIALECTS.iter().filter(|dialect| dialect.abilities.has_dwells) {
        let job = ProgramJob { tool: Some(&DRILL), ..ProgramJob::plain(&coarse, &cutting, dialect) };
        for wrong in [
            Hole { bottom_z_mm: -0.01, ..drill },
            Hole { retract_z_mm: 0.04, ..drill },
            // The plane is rounded down, into the material.
            Hole { top_z_mm: 0.12, retract_z_mm: 0.14, ..drill },
        ] {
            let refused = write(&drilled(wrong), &job, &Budget::unlimited());
            assert!(matches!(refused, Err(WriteError::CycleHeights { .. })), "{}", dialect.name);
        }
    }
}

#[test]
fn heights_of_any_decimals_are_written_in_every_dialect() {
    for dialect in DIALECTS.iter().filter(|dialect| dialect.abilities.has_dwells) {
        for k in 0..200 {
            let top_z_mm = -10.0 + 0.1 * f64::from(k);
            let (kind, dwell_s) = (CycleKind::ALL[k as usize % 4], if k % 4 == 0 { 0.5 } else { 0.0 });
            let (retract_z_mm, bottom_z_mm) = (top_z_mm + 2.2, top_z_mm - 0.7 * f64::from(1 + k % 9));
            let return_to = if k % 3 == 0 { ReturnTo::Start } else { ReturnTo::RetractPlane };
            let peck_mm = kind.pecks().then_some(0.3);
            let hole =
                Hole { kind, top_z_mm, retract_z_mm, bottom_z_mm, peck_mm, dwell_s, return_to, ..hole(kind) };
            // From the retract plane, and from above it.
            for start_z_mm in [retract_z_mm, retract_z_mm + 0.1] {
                let mut path = Toolpath::builder(Point3::new(0.0, 0.0, start_z_mm));
                path.cycle(hole, vec![Point2::new(0.0, 0.0), Point2::new(0.1, 0.2)]).unwrap();
                let path = path.finish().unwrap();
                for resolution in [MM, INCH, Resolution { units: Units::Mm, decimals: 1 }] {
                    let (program, cutting) = (Program::plain(resolution), cutting());
                    let job =
                        ProgramJob { tool: Some(&DRILL), ..ProgramJob::plain(&program, &cutting, dialect) };
                    let written = write(&path, &job, &Budget::unlimited());
                    let bound_mm = written.unwrap_or_else(|error| panic!("{}: {error}", dialect.name));
                    assert!(bound_mm.max_displacement_mm <= 0.9 * resolution.step_mm());
                }
            }
        }
    }
}

#[test]
fn heidenhain_states_the_feed_again_behind_a_cycle() {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 20.0));
    path.line(Point3::new(0.0, 0.0, 19.0), feed(200.0), Role::Cut).unwrap();
    path.cycle(Hole { rate: feed(50.0), ..hole(CycleKind::Drill) }, vec![Point2::new(5.0, 0.0)]).unwrap();
    path.line(Point3::new(5.0, 9.0, 2.0), feed(200.0), Role::Cut).unwrap();
    let path = path.finish().unwrap();
    let (program, cutting) = (Program::plain(MM), cutting());
    let job = ProgramJob { tool: Some(&DRILL), ..ProgramJob::plain(&program, &cutting, &HEIDENHAIN) };
    let text = write(&path, &job, &Budget::unlimited()).unwrap().text;
    assert!(text.contains("L Y+9.000 R0 F200"), "{text}");
    assert!(check_text(&text.replace("L Y+9.000 R0 F200", "L Y+9.000 R0"), &path, &job).is_err());
}

#[test]
fn heidenhain_pecks_where_a_rapid_stops_a_little_above_the_bottom() {
    for (above_mm, is_cycle) in [(0.2, false), (0.5, true), (5.0, true), (9.0, false)] {
        let low = Hole { retract_z_mm: above_mm, ..hole(CycleKind::Peck) };
        let text = text_in(&HEIDENHAIN, low, &Program::plain(MM));
        assert_eq!(text.contains("CYCL DEF 200"), is_cycle, "{text}");
    }
}

#[test]
fn each_corrupted_word_of_a_cycle_is_found() {
    let (mut found, mut tried) = (Vec::new(), 0);
    let program = Program::plain(MM);
    for dialect in DIALECTS.iter().filter(|dialect| !dialect.abilities.cycles.is_empty()) {
        let cutting = cutting();
        let job = ProgramJob { tool: Some(&DRILL), ..ProgramJob::plain(&program, &cutting, dialect) };
        for kind in CycleKind::ALL {
            for dwell_s in [0.0, 0.5].into_iter().filter(|dwell_s| *dwell_s == 0.0 || !kind.pecks()) {
                for return_to in [ReturnTo::Start, ReturnTo::RetractPlane] {
                    let toolpath = drilled(Hole { dwell_s, return_to, ..hole(kind) });
                    let own = survivors(&[Operation { name: None, toolpath: &toolpath, job }], &mut tried);
                    found.extend(own.into_iter().map(|own| (dialect.name, own)));
                }
            }
        }
    }
    assert!(found.is_empty(), "{} of {tried}: {found:#?}", found.len());
    assert!(tried > 5000, "{tried}");
}

#[test]
fn each_parameter_of_a_call_is_compared() {
    let program = Program::plain(MM);
    let cutting = cutting();
    let job = ProgramJob { tool: Some(&DRILL), ..ProgramJob::plain(&program, &cutting, &SIEMENS) };
    for hole in [hole(CycleKind::Peck), Hole { dwell_s: 0.5, ..hole(CycleKind::Ream) }] {
        let path = drilled(hole);
        let text = write(&path, &job, &Budget::unlimited()).unwrap().text;
        let (head, call) = text.split_once("MCALL CYCLE").unwrap();
        let (call, tail) = call.split_once(')').unwrap();
        let (name, arguments) = call.split_once('(').unwrap();
        let arguments: Vec<&str> = arguments.split(',').collect();
        for k in 0..arguments.len() {
            for wrong in ["", "7.000"] {
                let mut arguments = arguments.clone();
                if std::mem::replace(&mut arguments[k], wrong) == wrong {
                    continue;
                }
                let wrong = format!("{head}MCALL CYCLE{name}({}){tail}", arguments.join(","));
                assert!(check_text(&wrong, &path, &job).is_err(), "{wrong}");
            }
        }
    }
}
