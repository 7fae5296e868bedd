//! A wrong word in the data of a dialect is found by the reader, which has words of its own.

use super::posed::{leaning, text_of};
use super::*;
use crate::dialect::{Dwell, Frame, Numbers, ProgramNumber, TipControl};
use crate::dialects::haas::HAAS;
use crate::dialects::heidenhain::HEIDENHAIN;
use crate::dialects::mach4::MACH4;
use crate::dialects::okuma::OKUMA;
use crate::dialects::siemens::SIEMENS;
use toolpathd_core::machine::{Straying, named};

/// The words of tip control of a dialect, changed.
fn with_tip_control(dialect: &Dialect, output: AxisOutput, change: impl Fn(&mut TipControl)) -> Dialect {
    let mut five_axes = dialect.five_axes;
    let control = match output {
        AxisOutput::Angles => &mut five_axes.angles,
        AxisOutput::Vectors => &mut five_axes.vectors,
        AxisOutput::Rails | AxisOutput::Machine => panic!("no tip control"),
    };
    change(control.as_mut().unwrap());
    Dialect { five_axes, ..*dialect }
}

fn leaning_in(dialect: &Dialect, output: AxisOutput) -> Result<NcProgram, WriteError> {
    let table = named::by_name("table_table_ac").unwrap();
    text_of(dialect, &leaning(), output, Some(&table), Straying { tip_mm: 1.0, axis: 1.0 })
}

#[test]
fn a_wrong_word_of_tip_control_is_refused() {
    use AxisOutput::{Angles, Vectors};
    type Change = fn(&mut TipControl);
    let cases: [(&Dialect, AxisOutput, &[Change]); 7] = [
        (
            &FANUC,
            Angles,
            &[
                |control| control.words = Some("G43.5 H{offset}"),
                |control| control.words = Some("G43 H{offset}"),
                |control| control.words = Some("G44.4 H{offset}"),
                |control| control.words = Some("G234 H{offset}"),
                |control| control.words = Some("G43.4 D{offset}"),
                |control| control.words = Some("G43.4"),
                |control| control.words = None,
                |control| control.off = "G40",
                |control| control.off = "",
            ],
        ),
        (
            &FANUC,
            Vectors,
            &[
                |control| control.words = Some("G43.4 H{offset}"),
                |control| control.words = Some("G43 H{offset}"),
                |control| control.vector = ["J", "I", "K"],
                |control| control.vector = ["A", "B", "C"],
                |control| control.off = "G80",
            ],
        ),
        (
            &HAAS,
            Angles,
            &[
                |control| control.words = Some("G43.4 H{offset}"),
                |control| control.words = Some("G254 H{offset}"),
                |control| control.off = "G50",
            ],
        ),
        (
            &SIEMENS,
            Angles,
            &[
                |control| control.before = &["TRAORI", "ORIWKS", "ORIVECT"],
                |control| control.before = &["ORIWKS", "ORIAXES"],
                |control| control.off = "",
            ],
        ),
        (
            &SIEMENS,
            Vectors,
            &[
                |control| control.before = &["TRAORI", "ORIWKS", "ORIAXES"],
                |control| control.vector = ["B3=", "A3=", "C3="],
                |control| control.off = "TRAORI",
            ],
        ),
        (
            &HEIDENHAIN,
            Angles,
            &[
                |control| control.before = &["FUNCTION TCPM F TCP AXIS SPAT PATHCTRL VECTOR"],
                |control| control.before = &[],
                |control| control.off = "M129",
            ],
        ),
        (
            &HEIDENHAIN,
            Vectors,
            &[
                |control| control.before = &["FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS"],
                |control| control.off = "",
            ],
        ),
    ];
    for (dialect, output, changes) in cases {
        leaning_in(dialect, output).unwrap();
        for (k, change) in changes.iter().enumerate() {
            let wrong = with_tip_control(dialect, output, change);
            assert_refused(leaning_in(&wrong, output), &format!("{} {output:?} {k}", dialect.name));
        }
    }
}

#[test]
fn a_wrong_word_of_a_dialect_is_refused() {
    type Change = fn(&mut Dialect, &mut Iso);
    let cases: [(&Dialect, &[Change]); 5] = [
        (
            &FANUC,
            &[
                |_, iso| iso.tape_mark = None,
                |_, iso| iso.tape_mark = Some("#"),
                |_, iso| iso.program_number = None,
                |_, iso| iso.program_number = Some(ProgramNumber { letter: 'P', digits: 4 }),
                |_, iso| iso.program_number = Some(ProgramNumber { letter: 'O', digits: 3 }),
                |_, iso| iso.dwell = Dwell::Seconds,
                |_, iso| iso.dwell = Dwell::FeedWord,
                |_, iso| iso.length_offset = "G44 H{offset}",
                |_, iso| iso.length_offset = "G56 H{offset}",
                |_, iso| iso.length_offset = "G43 D{offset}",
                |_, iso| iso.work_offset = "G15 H",
                |_, iso| iso.work_offset = "G5",
                |_, iso| iso.machine_zero = &["G54 G0 {Z0}"],
                |_, iso| iso.machine_zero = &["G53 G1 {Z0}"],
                |_, iso| iso.start = &[Frame::ByUnits { mm: "G20", inch: "G21" }, Frame::Text("G17 G90 G94")],
                |dialect, _| {
                    dialect.numbers = Numbers { point: Point::WhereNeeded, ..dialect.numbers };
                },
                |dialect, _| dialect.curves.parabolas = LINUXCNC.curves.parabolas,
            ],
        ),
        (&HAAS, &[|_, iso| iso.program_number = Some(ProgramNumber { letter: 'O', digits: 4 })]),
        (
            &LINUXCNC,
            &[
                |_, iso| iso.tape_mark = Some("#"),
                |_, iso| iso.dwell = Dwell::Milliseconds,
                |_, iso| iso.length_offset = "G43.4 H{offset}",
            ],
        ),
        (
            &MACH4,
            &[
                |_, iso| iso.dwell = Dwell::Milliseconds,
                |_, iso| iso.start = &[Frame::Text("G17 G21 G90 G90.1 G94")],
            ],
        ),
        (
            &OKUMA,
            &[
                |_, iso| iso.work_offset = "G",
                |_, iso| iso.length_offset = "G43 H{offset}",
                |_, iso| iso.dwell = Dwell::Seconds,
                |_, iso| iso.tape_mark = Some("%"),
            ],
        ),
    ];
    for (dialect, changes) in cases {
        write_all(dialect).unwrap();
        for (k, change) in changes.iter().enumerate() {
            let (mut wrong, mut words) = (*dialect, iso(dialect));
            change(&mut wrong, &mut words);
            wrong.syntax = Syntax::Iso(words);
            assert_refused(write_all(&wrong), &format!("{} {k}", dialect.name));
        }
    }
}

/// A program with every word that a dialect has for three axes, and a parabola.
fn write_all(dialect: &Dialect) -> Result<NcProgram, WriteError> {
    let home =
        if dialect.abilities.safe_homes.contains(&SafeHome::G53) { SafeHome::G53 } else { SafeHome::None };
    let program = Program { work_offset: Some(54), safe_home: home, ..Program::plain(MM) };
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 12.0));
    path.line(Point3::origin(), feed(400.0), Role::Plunge).unwrap();
    path.parabola(Point3::new(20.0, 0.0, 0.0), Point3::new(10.0, 8.0, 0.0), feed(400.0), Role::Cut).unwrap();
    path.dwell(0.25).unwrap();
    written_in(dialect, &path.finish().unwrap(), &program, &cutting(), &[])
}

/// The reader refused the text, or saw another motion.
#[track_caller]
fn assert_refused(written: Result<NcProgram, WriteError>, what: &str) {
    match written {
        Err(WriteError::Unreadable(_) | WriteError::Differs { .. }) => {}
        Err(error) => panic!("{what}: {error}"),
        Ok(program) => panic!("{what} passed:\n{}", program.text),
    }
}
