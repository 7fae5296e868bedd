use std::f64::consts::PI;

use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;
use crate::DIALECTS;
use crate::dialects::fanuc::FANUC;
use crate::dialects::linuxcnc::LINUXCNC;
use crate::nc::WordFault;
use toolpathd_core::geometry::curve::ArcError;

const LIMIT_MM: f64 = 0.0015;

fn read(text: &str) -> Result<Vec<Step>, ReadError> {
    read_as(&LINUXCNC, text)
}

pub fn read_as(dialect: &Dialect, text: &str) -> Result<Vec<Step>, ReadError> {
    Reader::new(text, dialect, LIMIT_MM).map(|placed| placed.map(|placed| placed.step)).collect()
}

/// Checks that each change of a program gives a fault in its line.
pub fn check_faults(dialect: &Dialect, program: &str, cases: &[(&str, &str, usize, Fault)]) {
    read_as(dialect, program).unwrap();
    for &(from, to, line, fault) in cases {
        assert!(program.contains(from), "{from}");
        let error = read_as(dialect, &program.replacen(from, to, 1)).unwrap_err();
        assert_eq!(error, ReadError { line, fault }, "{from} -> {to}");
    }
}

pub const fn word(name: &'static str, fault: WordFault) -> Fault {
    Fault::Word(name, fault)
}

fn fault(text: &str) -> (usize, Fault) {
    let error = read(text).unwrap_err();
    (error.line, error.fault)
}

#[test]
fn every_kind_of_step_is_read() {
    let text = "%\n(PROGRAM: DIE)\nN10 G17 G21 G90 G40 G49 G80 G94\nG64 P0.001 Q0\nG54\nT1 M6\nG43 H1\nS1000 M3\nM8\n\
                G0 Z50.000\nX0.000 Y0.000 ; across\ng1 z0. f300\nG18 G3 X10 I5 K0\nG19 G2 Y10. J5.\nG4 P1.5\n\
                G17 G2 I-5 J0\nG5.1 X20 Y12 I3 J4\nM5\nM9\nM30\nG0 X99\n%\n";
    let steps = read(text).unwrap();
    assert_eq!(steps.len(), 8);
    assert_eq!(steps[0], Step::Rapid { from: [None; 3], to: [None, None, Some(50.0)] });
    let highest = |step: &Step| match step {
        Step::Feed { along: Curve::Arc(arc), .. } => arc.point_at(0.5),
        _ => panic!("no arc"),
    };
    assert!((highest(&steps[3]) - Point3::new(5.0, 0.0, 5.0)).norm() < 1e-12);
    assert!((highest(&steps[4]) - Point3::new(10.0, 5.0, 5.0)).norm() < 1e-12);
    assert_eq!(steps[5], Step::Dwell { seconds: 1.5 });
    let Step::Feed { along, rate, .. } = steps[6] else { panic!("no feed") };
    assert!((along.length() - 10.0 * PI).abs() < 1e-12);
    assert_eq!(rate.mm_per_min(), 300.0);
    let Step::Feed { along: Curve::Parabola(parabola), .. } = steps[7] else { panic!("no parabola") };
    assert_eq!(parabola.control() - parabola.start(), Vector3::new(3.0, 4.0, 0.0));
    assert_eq!((parabola.end().x, parabola.end().y), (20.0, 12.0));
}

#[test]
fn inches_are_read_as_millimetres() {
    let steps = read("G20 G0 X0 Y0 Z1\nG1 X2 F10\nM2").unwrap();
    let Step::Feed { along, rate, .. } = steps[1] else { panic!("no feed") };
    assert_eq!((along.length(), rate.mm_per_min()), (50.8, 254.0));
}

#[test]
fn every_fault_is_found_with_its_line() {
    let before = "G21 F100\nG0 X0 Y0 Z0\n";
    let cases = [
        ("G1 X1 U5", Fault::UnknownWord('U')),
        ("G2 X1 I.5 A5", Fault::Conflict),
        ("G1 X1 A5 I1", Fault::Unused('I')),
        ("G93 G1 X1 A5", Fault::NoFeed),
        ("G93 G1 X1 F5", Fault::Conflict),
        ("G93 G94", Fault::Conflict),
        ("G43.4 H1", Fault::UnknownG(43.4)),
        ("G1 Xé", Fault::BadNumber('X')),
        ("é", Fault::UnknownWord('é')),
        ("G1 X", Fault::BadNumber('X')),
        ("G1 X1-2", Fault::BadNumber('X')),
        ("G1 X1e5", Fault::UnknownWord('E')),
        ("(OPEN", Fault::OpenComment),
        ("G5 X1", Fault::UnknownG(5.0)),
        ("G61.1", Fault::UnknownG(61.1)),
        ("M98", Fault::UnknownM(98.0)),
        ("G1 X1 X2", Fault::Twice('X')),
        ("G1 X1 I2", Fault::Unused('I')),
        ("G17 G2 X1 K1 I.5", Fault::Unused('K')),
        ("X1 H2", Fault::Unused('H')),
        ("G5.1 X1 Y1 I1", Fault::Missing('J')),
        ("G5.1 X1 Y1 J1", Fault::Missing('I')),
        ("G5.1 I1 J1", Fault::Missing('X')),
        ("G5.1", Fault::Missing('X')),
        ("G5.1 X1 Z0 I1 J1", Fault::Unused('Z')),
        ("G5.1 X1 K0 I1 J1", Fault::Unused('K')),
        ("G18 G5.1 X1 I1 J1", Fault::ParabolaPlane),
        ("G1 G5.1 X1 I1 J1", Fault::Conflict),
        ("G43", Fault::Missing('H')),
        ("G4", Fault::Missing('P')),
        ("X1 P2", Fault::Unused('P')),
        ("X1 Q2", Fault::Unused('Q')),
        ("G0 G1 X1", Fault::Conflict),
        ("G17 G18", Fault::Conflict),
        ("G4 P1 X1", Fault::Conflict),
        ("G80 X1", Fault::NoMotion),
        ("F-5", Fault::BadNumber('F')),
        ("G2 X1", Fault::MissingCenter),
        ("G2 X1 I0", Fault::Arc(ArcError::ZeroRadius)),
        ("", Fault::NoEnd),
    ];
    for (line, wanted) in cases {
        let (at, found) = fault(&format!("{before}{line}\n"));
        // A centre at the start is refused for its mismatch before any other fault.
        if line == "G2 X1 I0" {
            assert!(matches!(found, Fault::RadiusMismatch { .. }));
        } else {
            assert_eq!((at, found), (3, wanted), "{line}");
        }
    }
    assert_eq!(fault("G0 X0 Y0 Z0\nG1 X1"), (2, Fault::NoFeed));
    assert_eq!(fault("F100 G1 X1"), (1, Fault::UnknownStart));
    assert_eq!(fault("F100 G5.1 X1 I1 J1"), (1, Fault::UnknownStart));
    assert_eq!(fault("G0 X0 Y0 Z0\nG5.1 X1 I1 J1"), (2, Fault::NoFeed));
    // The control would run the second as a rapid.
    assert_eq!(fault(&format!("{before}G5.1 X1 Y1 I1 J0\nX2")), (4, Fault::NoMotion));
    let (line, found) = fault(&format!("{before}G3 X10 I5.002 J0"));
    assert!(
        line == 3
            && matches!(found, Fault::RadiusMismatch { mismatch_mm } if (mismatch_mm - 0.004).abs() < 1e-9)
    );
}

#[test]
fn fanuc_programs_need_points_marks_and_a_number() {
    let whole = "%\nO0501\n(DIE)\nG21\nG0 G43 H1 Z5.\nX0. Y0.\nG1 X10. F800.\nG4 P250\nM30\n%\n";
    let steps = read_as(&FANUC, whole).unwrap();
    assert_eq!(steps.len(), 4);
    assert_eq!(steps[3], Step::Dwell { seconds: 0.25 });
    let contour_control = whole.replacen("G1 X10.", "G5.1 X10. Y1. I1. J1.", 1);
    let error = read_as(&FANUC, &contour_control).unwrap_err();
    assert_eq!(error, ReadError { line: 7, fault: Fault::Conflict });
    let cases = [
        ("%\nO0501", "O0501", 1, Fault::TapeMark),
        ("M30\n%\n", "M30\n", 9, Fault::TapeMark),
        ("M30\n%\n", "M30\n%\nG0 X99.\n", 11, Fault::TapeMark),
        ("O0501\n", "", 2, Fault::ProgramNumber),
        ("O0501", "O0000", 2, Fault::ProgramNumber),
        ("O0501", "O10000", 2, Fault::ProgramNumber),
        ("O0501", "O501", 2, Fault::ProgramNumber),
        ("X10.", "X10", 7, Fault::MissingPoint('X')),
        ("F800.", "F800", 7, Fault::MissingPoint('F')),
        ("Z5.", "Z5", 5, Fault::MissingPoint('Z')),
        ("H1", "H1.", 5, Fault::UnexpectedPoint('H')),
        ("P250", "P.25", 8, Fault::UnexpectedPoint('P')),
    ];
    for (from, to, line, fault) in cases {
        assert!(whole.contains(from));
        let error = read_as(&FANUC, &whole.replacen(from, to, 1)).unwrap_err();
        assert_eq!(error, ReadError { line, fault }, "{from} {to}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_gives_steps_and_at_most_one_fault(text in "(?s)([GMXYZIJKFHPQSTN%(); \n.+-]|[0-9]|.){0,200}") {
        for dialect in DIALECTS {
            for text in [text.clone(), format!("%\nO0001\n{text}")] {
                let faults = Reader::new(&text, dialect, LIMIT_MM).filter(|placed| placed.is_err()).count();
                prop_assert!(faults <= 1);
            }
        }
    }
}
