use std::f64::consts::PI;

use proptest::prelude::*;

use super::super::tests::{check_faults, read_as, word};
use super::super::{Posed, PosedFeed, ReadError, Reader as Steps};
use super::*;
use crate::dialects::heidenhain::HEIDENHAIN;
use toolpathd_core::geometry::curve::{ArcError, Curve};

const LIMIT_MM: f64 = 0.0015;

/// The blocks of a program, with their numbers.
fn numbered(blocks: &str) -> String {
    blocks.lines().enumerate().map(|(number, block)| format!("{number} {block}\n")).collect()
}

fn read(text: &str) -> Result<Vec<Step>, ReadError> {
    read_as(&HEIDENHAIN, text)
}

const THREE_AXES: &str = "BEGIN PGM 501 MM\n; DIE 7\nL Z+0.000 R0 FMAX M91\nTOOL CALL 3 Z S12000\nM3\nM8\n\
    L X+0.000 Y+0.000 R0 FMAX\nL Z+50.000 FMAX M3\nL Z+0.000 R0 F300\nL X+10.000 F800\n\
    CC X+10.000 Y+5.000\nC X+10.000 Y+10.000 DR+\nCYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 0.250\n\
    CC Z+0.000 X+15.000\nC Z+0.000 X+20.000 DR+ R0 F500\nCC Y+15.000 Z+0.000\nC Y+20.000 Z+0.000 DR-\n\
    CC X+20.000 Y+15.000\nC X+20.000 Y+20.000 DR-\nCP IPA-90.0000 IZ+5.000 DR-\nL Z+9.5 F99.125\n\
    L Z+0.000 R0 FMAX M91\nM5\nM9\nM30\nEND PGM 501 MM\n";

const ANGLES: &str = "BEGIN PGM TIP_1 MM\nTOOL CALL 3 Z\nL B+10.0000 C-20.5000 R0 FMAX\n\
    FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\nL X+1.000 Y+2.000 Z+30.000 B+10.0000 C-20.5000 R0 FMAX\n\
    L X+2.000 B+11.0000 F500\nL X+3.000 C-21.0000\nL B+12.0000 F90\nL B+13.0000\nL X+4.000 F500\n\
    L Z+40.000 FMAX\nFUNCTION RESET TCPM\nL Z+0.000 R0 FMAX M91\nM30\nEND PGM TIP_1 MM\n";

const VECTORS: &str = "BEGIN PGM 7 MM\nTOOL CALL 3 Z\nFUNCTION TCPM F TCP AXIS SPAT PATHCTRL VECTOR\n\
    LN X+1.000 Y+2.000 Z+30.000 TX+0.0000000 TY+0.0000000 TZ+1.0000000 R0 FMAX\n\
    LN X+2.000 Y+2.000 Z+30.000 TX+0.6000000 TY+0.0000000 TZ+0.8000000 R0 F500\n\
    LN X+2.000 Y+2.000 Z+30.000 TX+0.0000000 TY-0.6000000 TZ+0.8000000 F90\n\
    LN X+5.000 Y+2.000 Z+30.000 TX+0.0000000 TY-0.6000000 TZ+0.8000000 F500\n\
    FUNCTION RESET TCPM\nL Z+0.000 R0 FMAX M91\nM30\nEND PGM 7 MM\n";

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

fn near(p: Point3<f64>, x: f64, y: f64, z: f64) -> bool {
    (p - Point3::new(x, y, z)).norm() < 1e-12
}

#[test]
fn every_kind_of_step_of_three_axes_is_read() {
    let steps = read(&numbered(THREE_AXES)).unwrap();
    assert_eq!(steps.len(), 11);
    assert_eq!(steps[0], Step::Rapid { from: [None; 3], to: [Some(0.0), Some(0.0), None] });
    let up = [Some(0.0), Some(0.0), Some(50.0)];
    assert_eq!(steps[1], Step::Rapid { from: [Some(0.0), Some(0.0), None], to: up });
    assert_eq!((rate(&steps[2]), rate(&steps[3]), rate(&steps[4])), (300.0, 800.0, 800.0));
    assert!(near(middle(&steps[4]), 15.0, 5.0, 0.0));
    assert_eq!(steps[5], Step::Dwell { seconds: 0.25 });
    // As G3 in G18 and G2 in G19: the arcs hump towards +Z.
    assert!(near(middle(&steps[6]), 15.0, 10.0, 5.0));
    assert!(near(middle(&steps[7]), 20.0, 15.0, 5.0));
    let Step::Feed { along: Curve::Arc(circle), center, .. } = steps[8] else { panic!("no arc") };
    assert!((circle.length() - 10.0 * PI).abs() < 1e-12);
    assert_eq!(center, Some(Point3::new(20.0, 15.0, 0.0)));
    let Step::Feed { along: Curve::Arc(helix), .. } = steps[9] else { panic!("no arc") };
    assert!(near(helix.end(), 25.0, 15.0, 5.0));
    assert!((helix.length() - (2.5 * PI).hypot(5.0)).abs() < 1e-12);
    assert_eq!(rate(&steps[10]), 99.125);
}

#[test]
fn a_centre_in_zx_is_read_in_either_order() {
    let other = THREE_AXES.replace("CC Z+0.000 X+15.000", "CC X+15.000 Z+0.000");
    assert_eq!(read(&numbered(&other)), read(&numbered(THREE_AXES)));
    let other = other.replace("C Z+0.000 X+20.000", "C X+20.000");
    assert_eq!(read(&numbered(&other)), read(&numbered(THREE_AXES)));
}

#[test]
fn a_full_turn_of_a_helix_ends_above_its_start() {
    for (angle, sense) in [("+360.0000", "DR+"), ("-360", "DR-")] {
        let text =
            THREE_AXES.replace("CP IPA-90.0000 IZ+5.000 DR-", &format!("CP IPA{angle} IZ-8.000 {sense}"));
        let steps = read(&numbered(&text)).unwrap();
        let Step::Feed { along: Curve::Arc(helix), .. } = steps[9] else { panic!("no arc") };
        assert_eq!(helix.end(), Point3::new(20.0, 20.0, -8.0));
        assert!((helix.length() - (10.0 * PI).hypot(8.0)).abs() < 1e-12);
    }
}

#[test]
fn inches_are_read_as_millimetres_and_feeds_as_tenths_of_an_inch() {
    let steps = read(&numbered(&THREE_AXES.replace("501 MM", "501 INCH"))).unwrap();
    assert_eq!((rate(&steps[2]), rate(&steps[3])), (762.0, 2032.0));
    assert!((middle(&steps[4]) - Point3::new(381.0, 127.0, 0.0)).norm() < 1e-9);
    // A turn about a resting tip has degrees also here.
    let steps = read(&numbered(&ANGLES.replace(" MM", " INCH"))).unwrap();
    assert!(matches!(steps[4], Step::Posed(Posed { feed: PosedFeed::DegreesPerMinute(90.0), .. })));
}

#[test]
fn angles_under_tip_control_have_degrees_by_the_minute_where_the_tip_rests() {
    let steps = read(&numbered(ANGLES)).unwrap();
    let posed: Vec<_> = steps
        .iter()
        .map(|step| match step {
            Step::Posed(posed) => *posed,
            _ => panic!("{step:?}"),
        })
        .collect();
    let feed = PosedFeed::Feed(FeedRate::from_mm_per_min(500.0).unwrap());
    let feeds: Vec<_> = posed.iter().map(|posed| posed.feed).collect();
    let turn = PosedFeed::DegreesPerMinute(90.0);
    assert_eq!(feeds, [PosedFeed::Rapid, PosedFeed::Rapid, feed, feed, turn, turn, feed, PosedFeed::Rapid]);
    assert_eq!((posed[0].mode, posed[0].from, posed[0].to), (TipMode::Off, [None; 3], [None; 3]));
    assert_eq!((posed[1].mode, posed[1].from), (TipMode::Angles, [None; 3]));
    assert_eq!(posed[3].angles, [None, Some(11.0), Some(-21.0)]);
    assert_eq!(posed[6].to, [Some(4.0), Some(2.0), Some(30.0)]);
}

#[test]
fn vectors_are_read_under_tip_control_with_vectors() {
    let steps = read(&numbered(VECTORS)).unwrap();
    let Step::Posed(last) = steps[3] else { panic!("not posed") };
    assert_eq!((last.mode, last.vector), (TipMode::Vectors, Some([0.0, -0.6, 0.8])));
    assert_eq!(last.from, [Some(2.0), Some(2.0), Some(30.0)]);
    assert!(matches!(steps[2], Step::Posed(Posed { feed: PosedFeed::DegreesPerMinute(90.0), .. })));
    assert!(matches!(steps[0], Step::Posed(Posed { feed: PosedFeed::Rapid, from: [None, None, None], .. })));
}

use WordFault::{Form, Missing, Number as NoNumber, Order, Range, Twice, Unused};

#[test]
fn every_fault_of_the_frame_is_found_with_its_line() {
    let number = |expected| Fault::BlockNumber { expected };
    check_faults(
        &HEIDENHAIN,
        &numbered(THREE_AXES),
        &[
            ("0 BEGIN PGM 501 MM\n", "", 1, number(0)),
            ("0 BEGIN", "1 BEGIN", 1, number(0)),
            ("0 BEGIN PGM 501 MM", "0 BEGIN PGM MM", 1, Fault::Frame(BEGIN)),
            ("0 BEGIN PGM 501 MM", "0 BEGIN PGM 501 CM", 1, Fault::Frame(BEGIN)),
            ("0 BEGIN PGM 501 MM", "0 BEGIN PGM 5,1 MM", 1, Fault::Frame(BEGIN)),
            ("0 BEGIN PGM 501 MM", "0 BEGIN PGM 100000000 MM", 1, Fault::Frame(BEGIN)),
            ("0 BEGIN PGM 501 MM", "0 ; DIE", 1, Fault::Frame(BEGIN)),
            ("1 ; DIE 7", "2 ; DIE 7", 2, number(1)),
            ("1 ; DIE 7", "01 ; DIE 7", 2, number(1)),
            ("1 ; DIE 7", "; DIE 7", 2, number(1)),
            ("1 ; DIE 7", "", 2, number(1)),
            ("1 ; DIE 7", "1 ", 2, Fault::UnknownBlock),
            ("1 ; DIE 7", "1 ; DIE ~", 2, Fault::UnknownBlock),
            ("1 ; DIE 7", "1 (DIE)", 2, Fault::UnknownBlock),
            ("1 ; DIE 7", "1 G0 X+1", 2, Fault::UnknownBlock),
            ("1 ; DIE 7", "1 BLK FORM 0.1 Z X+0 Y+0 Z+0", 3, Fault::Frame(blank::HIGH)),
            ("1 ; DIE 7", "1 BLK FORM 0.2 X+0 Y+0 Z+0", 2, Fault::Frame(blank::LOW)),
            ("1 ; DIE 7", "1 BLK FORM 0.1 Z X+0 Y+0", 2, Fault::Word("BLK FORM", Missing)),
            ("END PGM 501", "END PGM 502", 27, Fault::Frame(END)),
            ("END PGM 501 MM", "END PGM 501 INCH", 27, Fault::Frame(END)),
            ("END PGM 501 MM", "M30", 27, Fault::AfterEnd),
            ("END PGM 501 MM\n", "END PGM 501 MM\n\n27 M5", 29, Fault::AfterEnd),
            ("26 END PGM 501 MM\n", "", 26, Fault::Frame(END)),
            ("25 M30\n26 END", "25 END", 26, Fault::NoEnd),
            ("25 M30\n26 END PGM 501 MM\n", "", 25, Fault::NoEnd),
        ],
    );
    let long = numbered(THREE_AXES).replacen("DIE", &"D".repeat(120), 1);
    assert_eq!(read(&long).unwrap_err(), ReadError { line: 2, fault: Fault::LongLine { limit: 120 } });
    assert_eq!(read("").unwrap_err(), ReadError { line: 0, fault: Fault::Frame(BEGIN) });
    assert_eq!(read(&format!("{}\n \n", numbered(THREE_AXES))), read(&numbered(THREE_AXES)));
}

#[test]
fn every_fault_of_a_block_is_found_with_its_line() {
    check_faults(
        &HEIDENHAIN,
        &numbered(THREE_AXES),
        &[
            ("TOOL CALL 3 Z S12000", "TOOL CALL 3 Y S12000", 4, Fault::UnknownBlock),
            ("TOOL CALL 3 Z S12000", "TOOL CALL Z", 4, Fault::UnknownBlock),
            ("TOOL CALL 3 Z S12000", "TOOL CALL 3 Z S12000 F100", 4, Fault::UnknownBlock),
            ("TOOL CALL 3 Z", "TOOL CALL 32768 Z", 4, word("TOOL CALL", Range)),
            ("TOOL CALL 3 Z", "TOOL CALL 3.1 Z", 4, word("TOOL CALL", NoNumber)),
            ("S12000", "S12000.5", 4, word("S", Form)),
            ("S12000", "S0", 4, word("S", Range)),
            ("S12000", "S100000", 4, word("S", Range)),
            ("4 M3", "4 M4", 5, Fault::UnknownM(4.0)),
            ("4 M3", "4 M91", 5, Fault::Conflict),
            ("4 M3", "4 M3 M5", 5, Fault::Conflict),
            ("4 M3", "4 M3 ; ON", 5, Fault::UnknownWord(';')),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X0.000 Y+0.000 R0 FMAX", 7, word("X", Form)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L Y+0.000 X+0.000 R0 FMAX", 7, word("X", Order)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 X+0.000 R0 FMAX", 7, word("X", Twice)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 Y+0.000 RL FMAX", 7, Fault::UnknownWord('R')),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 Y+0.000 FMAX R0", 7, word("R", Order)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 Y+0.000 F5 FMAX", 7, word("F", Twice)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0,000 Y+0.000 R0 FMAX", 7, word("X", NoNumber)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.00000 FMAX", 7, word("X", Form)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+100000 FMAX", 7, word("X", Form)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+.5 FMAX", 7, word("X", Form)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+5. FMAX", 7, word("X", Form)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+1e3 FMAX", 7, word("X", NoNumber)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+ FMAX", 7, word("X", NoNumber)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L R0 FMAX", 7, word("X", Missing)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L IX+0.000 FMAX", 7, Fault::UnknownWord('I')),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 DR+ FMAX", 7, word("DR", Unused)),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 Y+0.000", 7, Fault::NoFeed),
            ("L X+0.000 Y+0.000 R0 FMAX", "L X+0.000 Y+0.000 F5", 7, Fault::UnknownStart),
            ("L X+0.000 Y+0.000 R0 FMAX", "LN X+0.000 Y+0.000 FMAX", 7, Fault::NoTipControl),
            ("L Z+50.000 FMAX M3\n", "L Z+50.000 M3\n", 8, Fault::NoFeed),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0", 9, Fault::NoFeed),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 F0", 9, word("F", Range)),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 F+300", 9, word("F", Form)),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 F300.1234", 9, word("F", Form)),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 FAUTO", 9, Fault::UnknownWord('F')),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 F300 M91", 9, Fault::Conflict),
            ("L Z+0.000 R0 F300", "L Z+1.000 R0 FMAX M91", 9, Fault::Conflict),
            ("L Z+0.000 R0 F300", "L X+0.000 Z+0.000 R0 FMAX M91", 9, Fault::Conflict),
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 FMAX M3 M91", 9, Fault::Conflict),
            // The fault is in the block behind: Z is unknown after the move to zero of the machine.
            ("L Z+0.000 R0 F300", "L Z+0.000 R0 FMAX M91", 10, Fault::UnknownStart),
            ("L Z+0.000 R0 F300", "TOOL CALL 4 Z", 10, Fault::UnknownStart),
            ("9 L X+10.000 F800", "9 l X+10.000 F800", 10, Fault::UnknownBlock),
            ("CYCL DEF 9.0 DWELL TIME", "CYCL DEF 9.0", 13, Fault::UnknownBlock),
            ("CYCL DEF 9.0 DWELL TIME", "; PAUSE", 14, Fault::UnknownBlock),
            ("CYCL DEF 9.1 DWELL 0.250", "; PAUSE", 14, Fault::Frame(DWELL)),
            ("DWELL 0.250", "DWELL 3600.001", 14, word("DWELL", Range)),
            ("DWELL 0.250", "DWELL +0.250", 14, word("DWELL", Form)),
            ("DWELL 0.250", "DWELL 0.2500", 14, word("DWELL", Form)),
            ("DWELL 0.250", "DWELL", 14, Fault::Frame(DWELL)),
        ],
    );
}

#[test]
fn every_fault_of_an_arc_is_found_with_its_line() {
    let cases = [
        ("CC X+10.000 Y+5.000", "CC X+10.000", 11, word("Z", Missing)),
        ("CC X+10.000 Y+5.000", "CC X+10.000 Y+5.000 Z+0.000", 11, Fault::Conflict),
        ("CC X+10.000 Y+5.000", "CC", 11, word("X", Missing)),
        ("CC X+10.000 Y+5.000", "CC X+10.000 Y+5.000 F500", 11, word("F", Unused)),
        ("CC X+10.000 Y+5.000", "CC Y+5.000 X+10.000 Y+5.000", 11, word("Y", Twice)),
        ("CC X+10.000 Y+5.000", "; CENTRE", 12, Fault::MissingCenter),
        ("C X+10.000 Y+10.000 DR+", "C X+10.000 Y+10.000", 12, word("DR", Missing)),
        ("C X+10.000 Y+10.000 DR+", "C X+10.000 Y+10.000 DR", 12, word("DR", Form)),
        ("C X+10.000 Y+10.000 DR+", "C DR+", 12, word("X", Missing)),
        ("C X+10.000 Y+10.000 DR+", "C X+10.000 Y+10.000 Z+5.000 DR+", 12, word("Z", Unused)),
        ("C X+10.000 Y+10.000 DR+", "C X+10.000 Y+10.000 DR+ FMAX", 12, Fault::Conflict),
        ("C X+10.000 Y+10.000 DR+", "C X+10.000 DR+ Y+10.000", 12, word("Y", Order)),
        ("C X+10.000 Y+10.000 DR+", "C X+10.000 I+5 DR+", 12, Fault::UnknownWord('I')),
        ("C X+10.000 Y+10.000 DR+", "CR X+10.000 Y+10.000 R+5 DR+", 12, Fault::UnknownBlock),
        ("CC X+20.000 Y+15.000", "CC X+20.000 Y+20.000", 20, Fault::Arc(ArcError::ZeroRadius)),
        ("CC X+20.000 Y+15.000", "CC X+20.000 Z+15.000", 20, word("Y", Unused)),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA-90.0000 IZ+5.000 DR+", 21, Fault::Conflict),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA+0.0000 IZ+5.000 DR-", 21, word("IPA", Range)),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA-5400.0001 IZ+5.000 DR-", 21, word("IPA", Range)),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA-5400.0000 IZ+5.000 DR-", 21, Fault::ManyTurns),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA90.0000 IZ+5.000 DR-", 21, word("IPA", Form)),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IZ+5.000 DR-", 21, word("IPA", Missing)),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA-90.0000 Z+5.000 DR-", 21, word("Z", Unused)),
        ("CP IPA-90.0000 IZ+5.000 DR-", "CP IPA-90.0000 DR- FMAX", 21, Fault::Conflict),
    ];
    check_faults(&HEIDENHAIN, &numbered(THREE_AXES), &cases);
    let text = numbered(THREE_AXES).replacen("CC X+10.000 Y+5.000", "CC X+10.000 Y+5.001", 1);
    let error = read(&text).unwrap_err();
    let Fault::RadiusMismatch { mismatch_mm } = error.fault else { panic!("{error}") };
    assert!(error.line == 12 && (mismatch_mm - 0.002).abs() < 1e-9);
    let other_plane = THREE_AXES
        .replace("CC X+20.000 Y+15.000", "CC Y+15.000 Z+0.000")
        .replace("C X+20.000 Y+20.000 DR-", "C Y+20.000 DR-");
    assert_eq!(read(&numbered(&other_plane)).unwrap_err(), ReadError { line: 21, fault: Fault::Conflict });
}

#[test]
fn every_fault_of_tip_control_is_found_with_its_line() {
    check_faults(
        &HEIDENHAIN,
        &numbered(ANGLES),
        &[
            ("TOOL CALL 3 Z", "; NO TOOL", 4, Fault::NoTool),
            ("TOOL CALL 3 Z", "TOOL CALL 0 Z", 4, Fault::NoTool),
            ("L B+10.0000 C-20.5000 R0 FMAX", "L B+10.00000 R0 FMAX", 3, word("B", Form)),
            ("L B+10.0000 C-20.5000 R0 FMAX", "L B+10.0000 C-20.5000 R0 F500", 3, Fault::Conflict),
            ("AXIS POS PATHCTRL AXIS", "AXIS POS PATHCTRL VECTOR", 4, Fault::UnknownBlock),
            ("FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS", "M128", 4, Fault::UnknownM(128.0)),
            (
                "4 L X+1.000",
                "4 FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS\n5 L X+1.000",
                5,
                Fault::UnderTipControl,
            ),
            ("4 L X+1.000", "4 TOOL CALL 4 Z\n5 L X+1.000", 5, Fault::UnderTipControl),
            ("4 L X+1.000", "4 L Z+0 R0 FMAX M91\n5 L X+1.000", 5, Fault::UnderTipControl),
            ("B+10.0000 C-20.5000 R0 FMAX\n5", "B+10.0000 C-20.5000 R0 F500\n5", 5, Fault::UnknownStart),
            ("L X+2.000 B+11.0000 F500", "L X+2.000 B+11.0000", 6, Fault::NoFeed),
            ("L X+2.000 B+11.0000 F500", "L X+2.000 A+11.0000 F500", 6, Fault::UnknownStart),
            ("L X+2.000 B+11.0000 F500", "LN X+2.000 F500", 6, Fault::NoTipControl),
            ("L B+12.0000 F90", "L B+12.0000", 8, Fault::NoFeed),
            ("L X+4.000 F500", "L X+4.000", 10, Fault::NoFeed),
            ("L Z+40.000 FMAX", "C X+9 DR+ F100", 11, Fault::MissingCenter),
            ("L Z+40.000 FMAX", "CC X+0 Y+0\n11 C X+9 DR+", 12, Fault::UnderTipControl),
            ("L Z+0.000 R0 FMAX M91", "L Z+0.000 F500", 13, Fault::UnknownStart),
            ("11 FUNCTION RESET TCPM\n12", "11", 12, Fault::UnderTipControl),
        ],
    );
    check_faults(
        &HEIDENHAIN,
        &numbered(VECTORS),
        &[
            ("LN X+2.000 Y+2.000", "LN X+2.000", 5, word("Y", Missing)),
            ("LN X+2.000 Y+2.000", "LN Y+2.000 X+2.000", 5, word("X", Order)),
            ("LN X+2.000 Y+2.000", "L X+2.000 Y+2.000", 5, word("TX", Unused)),
            ("TX+0.6000000 ", "", 5, word("TX", Missing)),
            ("TX+0.6000000", "TX0.6000000", 5, word("TX", Form)),
            ("TX+0.6000000", "TX+0.600000", 5, word("TX", Form)),
            ("TX+0.6000000", "TX+0.6000100", 5, word("TX", Range)),
            ("TX+0.6000000", "A+10.0000 TX+0.6000000", 5, word("A", Unused)),
            ("TZ+0.8000000 R0 F500", "TZ+0.8000000 R0", 5, Fault::NoFeed),
            ("TZ+0.8000000 F90", "TZ+0.8000000", 6, Fault::NoFeed),
            ("TZ+0.8000000 F500", "TZ+0.8000000", 7, Fault::NoFeed),
            ("R0 FMAX\n4", "R0 F500\n4", 4, Fault::UnknownStart),
            ("AXIS SPAT PATHCTRL VECTOR", "AXIS POS PATHCTRL AXIS", 4, Fault::NoTipControl),
            ("7 FUNCTION", "7 L Z+50.000 FMAX\n8 FUNCTION", 8, Fault::UnderTipControl),
            (
                "L Z+0.000 R0 FMAX M91",
                "L X+0.000 Y+0.000 Z+0.000 FMAX\n9 L X+1 F500",
                10,
                Fault::UnknownStart,
            ),
        ],
    );
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_gives_steps_and_at_most_one_fault(
        text in "(?s)([LNCXYZTABFMRD; \n.+-]|L |CC |CP IPA|FMAX|DR[+-]|TX|CYCL DEF 9|[0-9]|.){0,120}",
        first in 0usize..27,
        blocks in prop::collection::vec("(L|LN|CC|C|CP|M)( (X|Y|Z|A|IPA|IZ|F|M|DR|TX)[+-]?[0-9.]{0,3}){0,4}", 0..8),
    ) {
        let good: String = THREE_AXES.lines().take(first).map(|line| format!("{line}\n")).collect();
        let blocks = numbered(&format!("{good}{}", blocks.join("\n")));
        for text in [text.clone(), format!("{}{text}", numbered(&good)), blocks] {
            let faults = Steps::new(&text, &HEIDENHAIN, LIMIT_MM).filter(|placed| placed.is_err()).count();
            prop_assert!(faults <= 1);
        }
    }
}
