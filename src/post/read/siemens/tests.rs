use std::f64::consts::PI;

use nalgebra::Point3;
use proptest::prelude::*;

use super::super::tests::{check_faults, read_as, word};
use super::super::{Posed, PosedFeed, ReadError, Reader as Steps};
use super::*;
use crate::dialects::siemens::SIEMENS;
use toolpathd_core::geometry::curve::{ArcError, Curve};

const LIMIT_MM: f64 = 0.0015;

fn read(text: &str) -> Result<Vec<Step>, ReadError> {
    read_as(&SIEMENS, text)
}

const THREE_AXES: &str = "; DIE (7)\nN10 G17 G710 G90 G40 G94\nG64\nG54\nG0 SUPA Z0.000 D0\nN20 T3 M6\nD1\n\
    S12000 M3\nM8\nG0 X0.000 Y0.000\nZ50 ; DOWN\nG1 Z0 F300\nX10. F800\nG3 X10 Y10 I0 J5\nG4 F0.250\n\
    G18 G3 X20 I5 K0\nG19 G2 Y20 J5\nG17 G2 J-5\nG2 X25 Y15 Z5 J-5\nG1 Z9.5\nG0 SUPA Z0.000 D0\nM5\nM9\nM30\n";

const ANGLES: &str = "G17 G710 G90 G40 G94\nT3 M6\nD1\nG0 B10 C-20.5\nTRAORI\nORIWKS\nORIAXES\n\
    G0 X1 Y2 Z30 B10 C-20.5\nG1 X2 B11 F500\nX3 C-21\nG93 G1 B12 F4\nX4 F2\nG94 G1 X5 F500\nG0 Z40\nTRAFOOF\n\
    G0 SUPA Z0 D0\nM30\n";

const VECTORS: &str = "G17 G710 G90 G40 G94\nT3 M6\nD1\nTRAORI\nORIWKS\nORIVECT\n\
    G0 X1 Y2 Z30 A3=0 B3=0 C3=1\nG1 X2 A3=3 B3=0 C3=4 F500\nG93 G1 A3=0 B3=-0.6 C3=0.8 F6\n\
    G94 G1 X5 A3=0 B3=-0.6 C3=0.8 F500\nTRAFOOF\nG0 SUPA Z0 D0\nM30\n";

const POSITIONS: &str = "G17 G710 G90 G40 G94\nT3 M6\nD1\nG0 A10 C20\nX1 Y2\nZ3\nG93\nG1 X2 A11 F4\nA12 F2\nG94\n\
    G0 SUPA Z0 D0\nM30\n";

fn middle(step: &Step) -> Point3<f64> {
    match step {
        Step::Feed { along: Curve::Arc(arc), .. } => arc.point_at(0.5),
        _ => panic!("no arc: {step:?}"),
    }
}

fn rate(step: &Step) -> f64 {
    match step {
        Step::Feed { rate, .. } => rate.mm_per_min(),
        _ => panic!("no feed: {step:?}"),
    }
}

fn posed(steps: &[Step]) -> Vec<Posed> {
    steps
        .iter()
        .map(|step| match step {
            Step::Posed(posed) => *posed,
            _ => panic!("{step:?}"),
        })
        .collect()
}

fn near(p: Point3<f64>, x: f64, y: f64, z: f64) -> bool {
    (p - Point3::new(x, y, z)).norm() < 1e-12
}

#[test]
fn every_kind_of_step_of_three_axes_is_read() {
    let steps = read(THREE_AXES).unwrap();
    assert_eq!(steps.len(), 11);
    assert_eq!(steps[0], Step::Rapid { from: [None; 3], to: [Some(0.0), Some(0.0), None] });
    assert_eq!((rate(&steps[2]), rate(&steps[3]), rate(&steps[4])), (300.0, 800.0, 800.0));
    assert!(near(middle(&steps[4]), 15.0, 5.0, 0.0));
    assert_eq!(steps[5], Step::Dwell { seconds: 0.25 });
    // The dwell has not changed the feed.
    assert_eq!(rate(&steps[6]), 800.0);
    assert!(near(middle(&steps[6]), 15.0, 10.0, 5.0));
    assert!(near(middle(&steps[7]), 20.0, 15.0, 5.0));
    let Step::Feed { along: Curve::Arc(circle), center, .. } = steps[8] else { panic!("no arc") };
    assert!((circle.length() - 10.0 * PI).abs() < 1e-12);
    assert_eq!(center, Some(Point3::new(20.0, 15.0, 0.0)));
    let Step::Feed { along: Curve::Arc(helix), .. } = steps[9] else { panic!("no arc") };
    assert_eq!(helix.end(), Point3::new(25.0, 15.0, 5.0));
    assert!((helix.length() - (2.5 * PI).hypot(5.0)).abs() < 1e-12);
}

#[test]
fn helices_are_read_in_every_plane() {
    let cases = [
        ("G17 G3 X0 Y5 Z9 I-5", [5.0, 0.0, 0.0]),
        ("G18 G3 Z0 X5 Y9 K-5", [0.0, 0.0, 5.0]),
        ("G19 G3 Y0 Z5 X9 J-5", [0.0, 5.0, 0.0]),
    ];
    for (block, [x, y, z]) in cases {
        let text = format!("G710 G90 G94\nD1\nG0 X{x} Y{y} Z{z}\nF100 {block}\nM30");
        let steps = read(&text).unwrap();
        let Step::Feed { along: Curve::Arc(arc), .. } = steps[1] else { panic!("no arc") };
        assert!((arc.sweep() - 0.5 * PI).abs() < 1e-12 && arc.rise() == 9.0, "{block}");
        assert!((arc.length() - (2.5 * PI).hypot(9.0)).abs() < 1e-12);
    }
}

#[test]
fn inches_are_read_as_millimetres() {
    let steps = read(&THREE_AXES.replace("G710", "G700")).unwrap();
    assert_eq!((rate(&steps[2]), rate(&steps[3])), (7620.0, 20_320.0));
    assert!((middle(&steps[4]) - Point3::new(381.0, 127.0, 0.0)).norm() < 1e-9);
}

#[test]
fn angles_are_read_under_tip_control() {
    let posed = posed(&read(ANGLES).unwrap());
    let feed = PosedFeed::Feed(FeedRate::from_mm_per_min(500.0).unwrap());
    let feeds: Vec<_> = posed.iter().map(|posed| posed.feed).collect();
    let [rapid, turn, timed] = [PosedFeed::Rapid, PosedFeed::Seconds(15.0), PosedFeed::Seconds(30.0)];
    assert_eq!(feeds, [rapid, rapid, feed, feed, turn, timed, feed, rapid]);
    assert_eq!((posed[0].mode, posed[0].to), (TipMode::Off, [None; 3]));
    assert_eq!((posed[1].mode, posed[1].from), (TipMode::Angles, [None; 3]));
    assert_eq!(posed[3].angles, [None, Some(11.0), Some(-21.0)]);
    assert_eq!(posed[5].to, [Some(4.0), Some(2.0), Some(30.0)]);
}

#[test]
fn vectors_are_read_as_they_are_written() {
    let posed = posed(&read(VECTORS).unwrap());
    assert!(posed.iter().all(|posed| posed.mode == TipMode::Vectors));
    assert_eq!((posed[1].vector, posed[3].vector), (Some([3.0, 0.0, 4.0]), Some([0.0, -0.6, 0.8])));
    assert_eq!(posed[2].feed, PosedFeed::Seconds(10.0));
}

#[test]
fn positions_of_five_axes_have_the_time_of_the_block() {
    let posed = posed(&read(POSITIONS).unwrap());
    assert!(posed.iter().all(|posed| posed.mode == TipMode::Off));
    assert_eq!((posed[3].feed, posed[4].feed), (PosedFeed::Seconds(15.0), PosedFeed::Seconds(30.0)));
    assert_eq!(posed[4].angles, [Some(12.0), None, Some(20.0)]);
}

use WordFault::{Form, Missing, Number as NoNumber, Order, Range, Twice, Unused};

#[test]
fn every_fault_of_a_line_is_found() {
    let number = |expected| Fault::BlockNumber { expected };
    check_faults(
        &SIEMENS,
        THREE_AXES,
        &[
            ("; DIE (7)", "(DIE)", 1, Fault::UnknownWord('(')),
            ("; DIE (7)", "%", 1, Fault::UnknownWord('%')),
            ("; DIE (7)", "%_N_DIE_MPF", 1, Fault::UnknownWord('%')),
            ("; DIE (7)", "/G90", 1, Fault::UnknownWord('/')),
            ("; DIE (7)", "MSG(\"A\")", 1, Fault::UnknownWord('M')),
            ("; DIE (7)", "é", 1, Fault::UnknownWord('é')),
            ("; DIE (7)", "g90", 1, Fault::UnknownWord('g')),
            ("N10 G17", "N20 G17", 2, number(10)),
            ("N10 G17", "G17 N10", 2, word("N", Order)),
            ("N10 G17", "N10.0 G17", 2, word("N", Form)),
            ("N20 T3", "N30 T3", 6, number(20)),
            ("N20 T3", "N T3", 6, word("N", NoNumber)),
            ("G710 G90", "G90", 10, Fault::NoMode("G700 or G710")),
            ("G710 G90", "G71 G90", 2, Fault::UnknownG(71.0)),
            ("G710 G90", "G710 G91", 2, Fault::UnknownG(91.0)),
            ("G710 G90", "G710", 10, Fault::NoMode("G90")),
            ("G710 G90", "G700 G710", 2, Fault::Conflict),
            ("G40 G94", "G40", 12, Fault::NoMode("G93 or G94")),
            ("G40 G94", "G43 G94", 2, Fault::UnknownG(43.0)),
            ("G40 G94", "G40 G94 G93", 2, Fault::Conflict),
            ("G64", "G641", 3, word("ADIS", Unused)),
            ("G64", "G641 ADIS=0.01 G64", 3, Fault::Conflict),
            ("G64", "ADIS=0.01", 3, word("ADIS", Unused)),
            ("G64", "G64.0", 3, Fault::UnknownG(64.0)),
            ("G64", "G-1", 3, Fault::UnknownG(-1.0)),
            ("G54", "G58", 4, Fault::UnknownG(58.0)),
            ("G54", "G59", 4, Fault::UnknownG(59.0)),
            ("G0 SUPA Z0.000 D0", "G0 SUPA Z0.000", 5, Fault::Conflict),
            ("G0 SUPA Z0.000 D0", "SUPA Z0.000 D0", 5, Fault::Conflict),
            ("G0 SUPA Z0.000 D0", "G0 SUPA Z1.000 D0", 5, Fault::Conflict),
            ("G0 SUPA Z0.000 D0", "G0 SUPA X0 Z0 D0", 5, Fault::Conflict),
            ("G0 SUPA Z0.000 D0", "G0 SUPA Z0 D1", 5, Fault::Conflict),
            ("G0 SUPA Z0.000 D0", "G0 SUPA(1) Z0 D0", 5, word("SUPA", Form)),
            ("G0 SUPA Z0.000 D0", "G0 G53 Z0 D0", 5, Fault::UnknownG(53.0)),
            ("G0 SUPA Z0.000 D0", "G0 Z0.000", 5, Fault::NoEdge),
            ("T3 M6", "T3", 6, word("M6", Missing)),
            ("T3 M6", "M6", 6, word("T", Missing)),
            ("T3 M6", "T=\"A\" M6", 6, word("T", NoNumber)),
            ("T3 M6", "T3.0 M6", 6, word("T", Form)),
            ("T3 M6", "T100000000 M6", 6, word("T", Range)),
            ("\nD1", "\nD0", 11, Fault::NoEdge),
            ("\nD1", "\n", 11, Fault::NoEdge),
            ("S12000 M3", "S0 M3", 8, word("S", Range)),
            ("S12000 M3", "S-5 M3", 8, word("S", Form)),
            ("S12000 M3", "M3 M5", 8, Fault::Conflict),
            ("S12000 M3", "M4", 8, Fault::UnknownM(4.0)),
            ("G0 X0.000 Y0.000", "G0 X 0 Y0", 10, word("X", NoNumber)),
            ("G0 X0.000 Y0.000", "G0 X=0 Y0", 10, word("X", NoNumber)),
            ("G0 X0.000 Y0.000", "G0 X0 X0", 10, word("X", Twice)),
            ("G0 X0.000 Y0.000", "G0 X0E1 Y0", 10, Fault::UnknownWord('E')),
            ("G0 X0.000 Y0.000", "G0 X0.1.2 Y0", 10, word("X", NoNumber)),
            ("G0 X0.000 Y0.000", "G0 X0.0000001 Y0", 10, word("X", Form)),
            ("G0 X0.000 Y0.000", "G0 X1234567890123456 Y0", 10, word("X", Form)),
            ("G0 X0.000 Y0.000", "G0 G1 X0", 10, Fault::Conflict),
            ("G0 X0.000 Y0.000", "G0 X0 I1", 10, word("I", Unused)),
            ("G0 X0.000 Y0.000", "G0 X0 R5", 10, Fault::UnknownWord('R')),
            ("G0 X0.000 Y0.000", "G0 XA0", 10, Fault::UnknownWord('X')),
            ("G1 Z0 F300", "G1 Z0", 12, Fault::NoFeed),
            ("G1 Z0 F300", "G1 Z0 F0", 12, word("F", Range)),
            ("G1 Z0 F300", "G0 SUPA Z0 D0\nG1 X1", 13, Fault::NoFeed),
            ("G1 Z0 F300", "G0 SUPA Z0 D0\nG1 X1 F300", 13, Fault::UnknownStart),
            ("G1 Z0 F300", "G0 SUPA Z0 D0\nG1 Z1 F300", 13, Fault::NoEdge),
            ("G1 Z0 F300", "G55\nG1 Z1 F300", 13, Fault::UnknownStart),
            ("G1 Z0 F300", "D2\nG1 Z1 F300", 13, Fault::UnknownStart),
            ("G1 Z0 F300", "G1 F300 A3=0 B3=0 C3=1", 12, Fault::NoTipControl),
            ("G4 F0.250", "G4", 15, word("F", Missing)),
            ("G4 F0.250", "G4 F-1", 15, word("F", Form)),
            ("G4 F0.250", "G4 S30", 15, word("F", Missing)),
            ("G4 F0.250", "G4 F1 X1", 15, Fault::Conflict),
            ("G4 F0.250", "G4 F1 M5", 15, Fault::Conflict),
            ("G4 F0.250", "G1 G4 F1", 15, Fault::Conflict),
            ("M30\n", "", 23, Fault::NoEnd),
            ("M30\n", "M30\n\n; END", 26, Fault::AfterEnd),
            ("M30\n", "M2\n", 24, Fault::UnknownM(2.0)),
        ],
    );
    let long = THREE_AXES.replacen("DIE", &"D".repeat(500), 1);
    assert_eq!(read(&long).unwrap_err(), ReadError { line: 1, fault: Fault::LongLine { limit: 500 } });
    assert_eq!(read(&format!("{THREE_AXES}\n \n")), read(THREE_AXES));
}

#[test]
fn every_fault_of_an_arc_is_found() {
    check_faults(
        &SIEMENS,
        THREE_AXES,
        &[
            ("G17 G710", "G710", 14, Fault::NoMode("G17, G18 or G19")),
            ("G3 X10 Y10 I0 J5", "G3 X10 Y10", 14, Fault::MissingCenter),
            ("G3 X10 Y10 I0 J5", "G3 X10 Y10 I0 J5 K0", 14, word("K", Unused)),
            ("G3 X10 Y10 I0 J5", "G3 X10 Y10 CR=5", 14, Fault::UnknownWord('C')),
            ("G3 X10 Y10 I0 J5", "G3 X10 Y10 I=AC(10) J5", 14, word("I", NoNumber)),
            ("G3 X10 Y10 I0 J5", "G3 X10 Y10 J5 TURN=1", 14, Fault::UnknownWord('T')),
            ("G3 X10 Y10 I0 J5", "G3 I0 J0", 14, Fault::Arc(ArcError::ZeroRadius)),
            ("G3 X10 Y10 I0 J5", "G93 G3 X10 Y10 J5 F5", 14, Fault::Conflict),
            ("G18 G3 X20 I5 K0", "G18 G3 X20 I5 J0", 16, word("J", Unused)),
        ],
    );
    let error = read(&THREE_AXES.replacen("I0 J5", "I0 J5.001", 1)).unwrap_err();
    let Fault::RadiusMismatch { mismatch_mm } = error.fault else { panic!("{error}") };
    assert!(error.line == 14 && (mismatch_mm - 0.002).abs() < 1e-9);
}

#[test]
fn every_fault_of_five_axes_is_found() {
    check_faults(
        &SIEMENS,
        ANGLES,
        &[
            ("G0 B10 C-20.5\nTRAORI", "G0 B10.000001\nTRAORI", 4, word("B", Form)),
            ("TRAORI\n", "TRAORI(1)\n", 5, word("TRAORI", Form)),
            ("TRAORI\n", "TRAORI G17\n", 5, Fault::Conflict),
            ("TRAORI\n", "TRAORI ORIWKS\n", 5, Fault::Conflict),
            ("TRAORI\n", "TRAORI\nTRAORI\n", 6, Fault::UnderTipControl),
            ("TRAORI\n", "TRANS\n", 5, Fault::UnknownWord('T')),
            ("ORIAXES\n", "\n", 8, Fault::NoMode("ORIAXES or ORIVECT")),
            ("ORIAXES\n", "T4 M6\n", 7, Fault::UnderTipControl),
            ("ORIAXES\n", "ORIVECT\n", 8, word("B", Unused)),
            ("D1\n", "\n", 8, Fault::NoEdge),
            ("G0 X1 Y2 Z30 B10", "G1 F500 X1 Y2 Z30 B10", 8, Fault::UnknownStart),
            ("G1 X2 B11 F500", "G1 X2 B11", 9, Fault::NoFeed),
            ("G1 X2 B11 F500", "G1 X2 A11 F500", 9, Fault::UnknownStart),
            ("G1 X2 B11 F500", "G2 X2 I5 F500", 9, Fault::Conflict),
            ("G1 X2 B11 F500", "G1 X2 A3=0 B3=0 C3=1 F500", 9, Fault::NoTipControl),
            ("G93 G1 B12 F4", "G1 B12 F4", 11, Fault::Conflict),
            ("G93 G1 B12 F4", "G93 G1 B12", 11, Fault::NoFeed),
            ("X4 F2", "X4", 12, Fault::NoFeed),
            ("X4 F2", "F2", 12, word("F", Unused)),
            ("X4 F2", "G0 X4 F2", 12, word("F", Unused)),
            ("G94 G1 X5 F500", "G94 G1 X5", 13, Fault::NoFeed),
            ("TRAFOOF\n", "", 15, Fault::UnderTipControl),
            ("G0 SUPA Z0 D0", "G1 Z0", 16, Fault::UnknownStart),
        ],
    );
    check_faults(
        &SIEMENS,
        VECTORS,
        &[
            ("G0 X1 Y2 Z30 A3=0 B3=0 C3=1", "G1 X1 Y2 Z30 A3=0 B3=0 C3=1 F5", 7, Fault::UnknownStart),
            ("A3=3 B3=0 C3=4", "A3=3 C3=4", 8, word("B3", Missing)),
            ("A3=3 B3=0 C3=4", "A3=0 B3=0 C3=0", 8, word("A3", Range)),
            ("A3=3 B3=0 C3=4", "A3=3 A3=3 B3=0 C3=4", 8, word("A3", Twice)),
            ("A3=3 B3=0 C3=4", "A3= B3=0 C3=4", 8, word("A3", NoNumber)),
            ("A3=3 B3=0 C3=4", "", 8, word("A3", Missing)),
            ("A3=3 B3=0 C3=4", "A3 B3=0 C3=4", 8, word("A", Unused)),
            ("A3=3 B3=0 C3=4", "A2=3 B2=0 C2=4", 8, word("A", NoNumber)),
            ("G93 G1 A3=0 B3=-0.6", "G1 A3=0 B3=-0.6", 9, Fault::Conflict),
            ("TRAFOOF\nG0 SUPA Z0 D0", "TRAFOOF\nG0 X0 Y0 Z0\nG1 X1 F5", 13, Fault::UnknownStart),
        ],
    );
    check_faults(
        &SIEMENS,
        POSITIONS,
        &[
            ("G93\nG1", "G1", 7, Fault::Conflict),
            ("A12 F2", "A12", 9, Fault::NoFeed),
            ("G0 A10 C20\n", "G0\n", 8, Fault::UnknownStart),
        ],
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_gives_steps_and_at_most_one_fault(
        text in "(?s)([GMXYZIJKFSTDABCN=; \n.+-]|G[0-4] |A3=|TRAORI\n|ORIVECT\n|SUPA|[0-9]|.){0,150}",
        start in "(G17 G710 G90 G94\nD1\nG0 X0 Y0 Z0\nF9 ?)?",
        kept in 0..THREE_AXES.len(),
    ) {
        for text in [format!("{start}{text}"), format!("{}{text}", &THREE_AXES[..kept])] {
            let faults = Steps::new(&text, &SIEMENS, LIMIT_MM).filter(|placed| placed.is_err()).count();
            prop_assert!(faults <= 1);
        }
    }
}
