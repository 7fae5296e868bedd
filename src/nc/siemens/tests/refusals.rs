//! What is refused, with its line and its word.

use super::*;

#[test]
fn words_that_are_not_read_are_refused_by_name() {
    for (lines, word) in [
        ("BSPLINE", "BSPLINE"),
        ("G1 X1 POLY", "POLY"),
        ("TRAORI", "TRAORI"),
        ("TRANSMIT", "TRANSMIT"),
        ("G96 S200", "G96"),
        ("G33 Z1 K1", "G33"),
        ("G58 X5", "G58"),
        ("CYCLE800(0,\"T\",0,57,0,0,0,30,0,0,0,0,0,1)", "CYCLE800(0,\"T\",0,57,0,0,0,30,0,0,0,0,0,1"),
        ("POCKET3(1,2)", "POCKET3"),
        ("CYCLE71(1)", "CYCLE71"),
        ("ORIWKS", "ORIWKS"),
        ("G147 DISR=5", "G147"),
        ("EXTCALL(\"X\")", "EXTCALL"),
        ("OVR=50", "OVR"),
        ("MCALL POCKET4(1)", "POCKET4(1)"),
        ("$P_PFRAME=CTRANS(X,1)", "$"),
    ] {
        let found = framed_faults(&format!("{lines}\nG0 X1"));
        assert_eq!((found[0].0, found[0].1.as_str()), (1, word), "{found:?}");
        assert!(matches!(found[0].2, Fault::NotRead | Fault::AtMachine | Fault::OtherAxis), "{found:?}");
    }
}

#[test]
fn faults_are_told_with_their_words() {
    for (lines, word, fault) in [
        ("PART_2", "PART_2", Fault::NoProgram),
        ("L200 P2", "L200", Fault::NoProgram),
        ("G1 X1 XY=5", "XY", Fault::UnknownCode),
        ("G1 X1 X2", "X2", Fault::Twice),
        ("G1 G2 X5", "G2", Fault::Conflict),
        ("G1 X=$AA_IW[X]", "X=", Fault::AtMachine),
        ("R1=R2+1", "R1=R2", Fault::AtMachine),
        ("R1=1 R2=R1", "R2=R1", Fault::SetInBlock),
        ("G1 X1 B5", "B5", Fault::OtherAxis),
        ("G1 X1 U5", "U5", Fault::OtherAxis),
        ("G1 X1 I5", "I5", Fault::UnusedWord),
        ("G1 X1 CR=5", "CR=5", Fault::UnusedWord),
        ("G1 X1 P5", "P5", Fault::UnusedWord),
        ("G1 X1 L5", "L5", Fault::UnusedWord),
        ("G41 X5", "G41", Fault::Compensation),
        ("G1000", "G1000", Fault::UnknownCode),
        ("SETAL(65000)", "SETAL(65000)", Fault::Alarm),
        ("GOTOF NOWHERE", "GOTOF NOWHERE", Fault::NoLabel),
        ("ENDIF", "ENDIF", Fault::OpenLoop),
        ("WHILE R1==1", "WHILE R1==1", Fault::OpenLoop),
        ("IF $AC_TIME>5\nENDIF", "$AC_TIME>5", Fault::AtMachine),
        ("G2 X10 Y10", "G2 X10 Y10", Fault::NoCenter),
        ("G2 X0 Y0 CR=5", "CR=5", Fault::ClosedRadius),
        ("G2 X10 Y0 AR=360", "AR=360", Fault::OutOfRange(360.0)),
        ("CT X10 Y5", "CT X10 Y5", Fault::NoTangent),
        ("CIP X10 Y5 Z5 I1=5 J1=0 K1=2", "CIP X10 Y5 Z5 I1=5 J1=0 K1=2", Fault::TiltedArc),
        ("CIP X10 Y0 I1=5 J1=0", "CIP X10 Y0 I1=5 J1=0", Fault::NoCenter),
        ("G91 SUPA G0 X0", "G91 SUPA G0 X0", Fault::Conflict),
        ("G4 X5 F1", "X5", Fault::UnusedWord),
        ("UNTIL R1", "UNTIL R1", Fault::OpenLoop),
        ("DEF REAL AA, AA", "REAL AA, AA", Fault::BadExpression),
        ("TRANS X5 CR=3", "CR=3", Fault::UnusedWord),
        ("G110 AP=IC(5) RP=3", "AP=IC(5)", Fault::BadExpression),
        ("G2 X5 Y5 CR=IC(5)", "CR=IC(5)", Fault::BadExpression),
        ("G74", "G74", Fault::NoAxis),
        ("G1 X5 \"", "\"", Fault::NoWord),
        ("G1 X1,5", ",", Fault::NoWord),
        ("F=-5 G1 X5", "F=-5", Fault::OutOfRange(-5.0)),
    ] {
        let found = framed_faults(lines);
        assert_eq!((found[0].0, found[0].1.as_str(), found[0].2), (1, word, fault), "{lines}");
    }
}

#[test]
fn arcs_whose_radii_differ_are_refused_as_by_alarm_14040() {
    // An arc that a rounding leaves in one point is no circle.
    assert_eq!(framed_faults("G2 X10 Y10 I10 J0 RND=5\nX0 Y0 CR=10")[0].2, Fault::NoCorner);
    close(&[cut("G2 X10.009 Y10 I10 J0").round()], &[16.0]);
    assert!(matches!(framed_faults("G2 X10 Y10.05 I10 J0")[0].2, Fault::Arc(_)));
}

#[test]
fn missing_states_are_refused_once() {
    let found = faults("G90\nG1 X1 Y1\nX2\nX3\nM30");
    assert_eq!(found, [(2, "G1 X1 Y1".into(), Fault::UnknownStart('X'))]);
    let found = faults("G90 G0 X0 Y0 Z0\nG1 X1\nX2\nM30");
    assert_eq!(found, [(2, "G1 X1".into(), Fault::NoFeed)]);
    assert_eq!(faults("G90 X5\nM30")[0].2, Fault::NoMotion);
    assert_eq!(framed_faults("G93 G1 X1 F5\nX2")[0], (2, "X2".into(), Fault::NoInverseTime));
    assert_eq!(faults("G0 X0 Y0 Z0\nG95 G1 X1 F0.1")[0].2, Fault::NoSpindleSpeed);
}

#[test]
fn what_follows_from_a_refusal_is_not_refused_again() {
    let found =
        framed_faults("TRAORI\nORIWKS\nG1 X1 A3=0 B3=0 C3=1\nG1 X5 A5 B3\nTRAFOOF\nBSPLINE\nG2 X9 Y9 I1");
    let words: Vec<_> = found.iter().map(|(line, word, _)| (*line, word.as_str())).collect();
    assert_eq!(words, [(1, "TRAORI"), (6, "BSPLINE")]);
    let found = framed_faults("R1=$AA_IW[X]\nG1 X=R1\nR1=5\nG1 X=R1+1\nG1 X=R9");
    let words: Vec<_> = found.iter().map(|(line, word, _)| (*line, word.as_str())).collect();
    assert_eq!(words, [(1, "R1="), (5, "X=R9")]);
    assert_eq!(framed_faults("R1=$AA_IW[X]\nIF R1>5\nG1 X1\nENDIF").len(), 1);
}

#[test]
fn what_changes_a_computed_path_is_refused_where_it_is_computed() {
    use crate::machine::{Correction, Cutter};
    let five = [Cutter { number: None, radius_mm: 5.0 }];
    let computed = |lines: &str| {
        let text = format!("G17 G90 G71 G94 G54\nS1000 M3 F500\nG0 X0 Y0 Z0\n{lines}\nM30\n");
        let start = [Some(0.0); 3];
        match crate::read(
            &crate::ReadJob { correction: Correction::Computed(&five), start, ..job(&text) },
            &toolpathd_core::budget::Budget::unlimited(),
        ) {
            Err(crate::ReadError::Refused(refusals)) => Some((refusals[0].line, refusals[0].fault)),
            _ => None,
        }
    };
    let contour = "G41 G1 X20 Y0\nY40\nX60\nG40 X80 Y60";
    assert_eq!(computed(contour), None);
    for (lines, line, fault) in [
        (format!("G451\n{contour}"), 4, Fault::NotRead),
        (format!("KONT\n{contour}"), 4, Fault::NotRead),
        ("D0 G0 Z0\nG41 G1 X20 Y0".to_owned(), 5, Fault::Conflict),
        ("D1 G0 Z0\nG41 G1 X20 Y0\nY40\nD0 G0 Z0".to_owned(), 7, Fault::InCompensation),
        ("G41 G1 X20 Y0\nY40\nMIRROR X0".to_owned(), 6, Fault::InCompensation),
        ("SCALE X2\nG1 X30 CHF=5\nY30".to_owned(), 5, Fault::Ellipse),
    ] {
        assert_eq!(computed(&lines), Some((line, fault)), "{lines}");
    }
    // M6 in a text changes no tool, and T does.
    let thread =
        "G17 G90 G71 F100\nT1 D1\nG0 X0 Y0 Z50\nG1 Z-2\nG0 Z50\nT2 D1 MSG(\"TAP M6\")\nG1 Z-5\nM30\n";
    assert!(faults(thread).iter().any(|(line, _, fault)| (*line, *fault) == (7, Fault::UnknownStart('Z'))));
}
