//! The way from the tool change to the start of a leaning toolpath: the rotary axes turn, then the tool goes
//! across, then down.

use super::posed::{leaning, text_of};
use super::*;
use crate::dialects::haas::HAAS;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::siemens::SIEMENS;
use crate::read::{Fault, Placed, Posed, PosedFeed, ROTARY, TipMode};
use toolpathd_core::machine::{Machine, Straying, named};

const COARSE: Straying = Straying { tip_mm: 1.0, axis: 1.0 };

/// The rapids before the first feed block.
fn approach(text: &str, dialect: &Dialect) -> Vec<Posed> {
    let steps = Reader::new(text, dialect, 0.0015).map(|placed| placed.map(|Placed { step, .. }| step));
    let rapids = steps.map_while(|step| match step.unwrap() {
        Step::Posed(posed) if posed.feed == PosedFeed::Rapid => Some(posed),
        _ => None,
    });
    rapids.collect()
}

/// Where the linear axes are behind a block, as far as it is known.
fn linear_mm(posed: &Posed, machine: &Machine) -> [Option<f64>; 3] {
    let rotary = [0, 1].map(|k| {
        let letter = ROTARY.iter().position(|letter| *letter == machine.rotary()[k].name).unwrap();
        posed.angles[letter].unwrap().to_radians()
    });
    match (posed.mode, posed.to) {
        (TipMode::Off, to) => to,
        (_, [Some(x), Some(y), Some(z)]) => machine.at(&Point3::new(x, y, z), rotary).linear_mm.map(Some),
        (_, to) => panic!("a tip is at {to:?}"),
    }
}

#[test]
fn the_axes_turn_and_go_across_before_they_go_down() {
    for (dialect, output) in [
        (&FANUC, AxisOutput::Angles),
        (&HAAS, AxisOutput::Angles),
        (&SIEMENS, AxisOutput::Angles),
        (&HEIDENHAIN, AxisOutput::Angles),
        (&LINUXCNC, AxisOutput::Angles),
        (&LINUXCNC, AxisOutput::Machine),
    ] {
        for machine in named::named() {
            let Ok(program) = text_of(dialect, &leaning(), output, Some(&machine), COARSE) else { continue };
            let steps = approach(&program.text, dialect);
            let [turn, across, down, ..] = &steps[..] else { panic!("{}", program.text) };
            assert_eq!((turn.to, turn.mode), ([None; 3], TipMode::Off), "{}", program.text);
            assert_eq!((across.to[2], across.angles), (None, turn.angles), "{}", program.text);
            let [over, above] = [across, down].map(|posed| linear_mm(posed, &machine));
            for axis in 0..2 {
                let way_mm = above[axis].unwrap() - over[axis].unwrap();
                // Two places are rounded, each by half a unit along three axes.
                assert!(way_mm.abs() <= 2.0 * MM.step_mm(), "{way_mm} mm\n{}", program.text);
            }
            assert_eq!(down.angles, turn.angles, "{}", program.text);
        }
    }
}

#[test]
fn a_tip_with_a_vector_goes_across_before_it_goes_down() {
    for dialect in [&FANUC, &SIEMENS, &HEIDENHAIN] {
        let program = text_of(dialect, &leaning(), AxisOutput::Vectors, None, COARSE).unwrap();
        let steps = approach(&program.text, dialect);
        let [across, down, ..] = &steps[..] else { panic!("{}", program.text) };
        assert_eq!(across.to, [Some(0.0), Some(16.0), None], "{}", program.text);
        assert_eq!((down.from, down.to), (across.to, [0.0, 16.0, 45.0].map(Some)), "{}", program.text);
        assert_eq!(down.vector, Some([0.0, 0.8, 0.6]), "{}", program.text);
    }
}

/// Coordinates before tip control are those of another point, and a cut must not begin from them.
#[test]
fn the_place_of_the_tip_is_not_known_before_tip_control_states_it() {
    let table = named::by_name("table_table_ac").unwrap();
    let program = text_of(&FANUC, &leaning(), AxisOutput::Angles, Some(&table), COARSE).unwrap();
    let spoiled = program.text.replacen("G43.4 H4 X0.000 Y16.000 Z45.000\nZ12.000", "G43.4 H4 Z12.000", 1);
    assert_ne!(spoiled, program.text);
    let read: Result<Vec<_>, _> = Reader::new(&spoiled, &FANUC, 0.0015).collect();
    assert_eq!(read.unwrap_err().fault, Fault::UnknownStart);
}

/// A plain line of Klartext knows no vector: only the way across may be one.
#[test]
fn klartext_goes_across_without_a_vector_only_before_the_first() {
    let text = text_of(&HEIDENHAIN, &leaning(), AxisOutput::Vectors, None, COARSE).unwrap().text;
    let across = "L X+0.000 Y+16.000 R0 FMAX";
    for wrong in
        ["L X+0.000 Y+16.000 Z+45.000 R0 FMAX", "L X+0.000 Y+16.000 R0 F500", "L X+0.000 A+5.0000 R0 FMAX"]
    {
        let spoiled = text.replacen(across, wrong, 1);
        assert_ne!(spoiled, text);
        assert!(Reader::new(&spoiled, &HEIDENHAIN, 0.0015).any(|placed| placed.is_err()), "{wrong}");
    }
}

/// LinuxCNC keeps the tip on its line where its kinematics are switched, and only where it is asked to.
#[test]
fn linuxcnc_switches_its_kinematics_around_the_path_of_the_tip() {
    let table = named::by_name("table_table_ac").unwrap();
    let text = text_of(&LINUXCNC, &leaning(), AxisOutput::Angles, Some(&table), COARSE).unwrap().text;
    let body: Vec<&str> = text.lines().skip_while(|line| !line.starts_with("G0 A")).collect();
    assert_eq!(
        body,
        [
            "G0 A-53.13010 C-180.00000",
            "X0.000 Y26.400",
            "M428",
            "X0.000 Y16.000 Z45.000",
            "Z12.000",
            "G1 Y0.000 Z0.000 F400",
            "X20.000 Z1.000 A-36.86990 F800",
            "G93 C-90.00000 F120",
            "G4 P0.250",
            "G94 X32.000 Z17.000 F400",
            "G0 Z45.000",
            "M429",
            "M5",
            "M9",
            "M30",
        ]
    );
    for (from, to) in [
        ("\nM428\n", "\n"),
        ("\nM428\n", "\nM429\n"),
        ("\nM429\n", "\n"),
        ("\nM429\n", "\nM430\n"),
        ("\nM428\n", "\nM428 X1\n"),
    ] {
        let spoiled = text.replacen(from, to, 1);
        assert_ne!(spoiled, text);
        let (program, cutting) = (Program::plain(MM), cutting());
        let five_axes = FiveAxes {
            output: AxisOutput::Angles,
            machine: Some(&table),
            allowed: COARSE,
            speeds: [f64::INFINITY; 5],
        };
        let job = ProgramJob {
            tool: Some(&TOOL),
            five_axes: Some(five_axes),
            ..ProgramJob::plain(&program, &cutting, &LINUXCNC)
        };
        let read = check_text(&spoiled, &leaning(), &job);
        assert!(read.is_err(), "{from} {to}");
    }
    let others = [("linuxcnc", true), ("grbl", false), ("fanuc", false)];
    for (name, knows) in others {
        assert_eq!(read_switch(name), knows, "{name}");
    }
}

/// Whether a dialect reads M428.
fn read_switch(name: &str) -> bool {
    let dialect = crate::dialect(name).unwrap();
    let text = "%\nO0001\nG21\nM428\nM429\nM30\n%\n";
    let text = if name == "fanuc" { text } else { "G21\nM428\nM429\nM30\n" };
    Reader::new(text, dialect, 0.0015).all(|placed| placed.is_ok())
}
