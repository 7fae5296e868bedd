//! What is refused, with its place, and what is left alone.

use super::*;
use crate::machine::Correction;

#[test]
fn all_refusals_are_told_with_line_and_word() {
    let found = faults("L X+5 G7 F100\nLN X+5 Y+5\nL X+1 X+2\nL A+30\nHELLO 5\nL X\nL X+1 F-5");
    let expected = [
        (4, "G7", Fault::NoWord),
        (5, "LN X+5 Y+5", Fault::NotRead),
        (6, "X+2", Fault::Twice),
        (7, "A+30", Fault::OtherAxis),
        (8, "HELLO", Fault::NoWord),
        (9, "X", Fault::NoNumber),
        (10, "F-5", Fault::OutOfRange(-5.0)),
    ];
    assert_eq!(found, expected.map(|(line, word, fault)| (line, word.to_owned(), fault)));
}

#[test]
fn blocks_that_move_in_ways_that_are_not_read_are_refused_by_name() {
    for block in [
        "LN X+1 Y+1 Z+1 NX+0 NY+0 NZ+1 F100",
        "SPL X+10 Y+5 K3X-1 K2X+2",
        "FL PR+20 PA+30",
        "FPOL X+5 Y+5",
        "FCT DR- R15",
        "APPR PLT PR+15 PA+30 LEN15 RL F100",
        "DEP PLCT PR+15 PA+30 R5",
        "PLANE SPATIAL SPA+0 SPB+0 SPC-1 STAY",
        "PLANE SPATIAL SPA+30 SPB+0 SPC+0 TURN FMAX",
        "FUNCTION TCPM F TCP AXIS POS PATHCTRL AXIS",
        "FUNCTION MODE TURN",
        "FUNCTION PROG PATH IS OFFSET",
        "SEL PATTERN \"A.PNT\"",
        "SEL CONTOUR \"A\"",
        "CONTOUR DEF P1 = LBL 1",
        "TCH PROBE 1.0 REF",
        "TRANS DATUM TABLE TABLINE5",
        "TRANS MIRROR AXIS X",
        "PATTERN DEF ROW1 (X+25 Y+33 D+8 NUM5 ROT+0 Z+0)",
        "FN 17: SYSWRITE ID 210 NR4 = +1",
        "FN 20: WAIT FOR I12 EQU +1",
    ] {
        let found = faults(block);
        assert_eq!((found.len(), found[0].0, found[0].2), (1, 4, Fault::NotRead), "{block}");
    }
    for word in ["M128", "M118 X1", "M103 F50", "M124 T0.01", "M97", "M114", "M144"] {
        let found = faults(&format!("L X+5 F100 {word}"));
        assert!(found.iter().any(|(_, _, fault)| *fault == Fault::NotRead), "{word} {found:?}");
    }
}

#[test]
fn faults_of_motion_are_told() {
    for (lines, fault) in [
        ("C X+10 Y+0 DR+", Fault::Lacks("CC")),
        ("CC X+5 Y+0\nC X+10 Y+0", Fault::Lacks("DR")),
        ("CC X+5 Y+0\nC DR+", Fault::NoAxis),
        ("CC X+5 Y+0\nC X+10 Y+0 DR+ FMAX", Fault::Conflict),
        ("CC X+5", Fault::Lacks("the other coordinate of the pole")),
        ("CR X+10 Y+0 R4 DR+", Fault::SmallRadius { chord_mm: 10.0, radius_mm: 4.0 }),
        ("CR X+0 Y+0 R4 DR+", Fault::ClosedRadius),
        ("CR X+10 Y+0 DR+", Fault::Missing('R')),
        ("CC X+5 Y+0\nC X+10 Y+0 Z-1 DR+", Fault::NotRead),
        ("CC X+5 Y+0\nCP IPA-90 DR+", Fault::OutOfRange(-90.0)),
        ("CC X+5 Y+0\nCP DR+", Fault::Lacks("PA")),
        ("CC X+0 Y+0\nCP IPA+90 DR+", Fault::NoCenter),
        ("CC X+0 Y+0\nLP PA+90", Fault::Lacks("PR")),
        ("LP PR+5 PA+90", Fault::Lacks("CC")),
        ("M3\nTOOL CALL 1 Z S1\nL X+0 Y+0 Z+0 FMAX\nCT X+5 Y+5", Fault::Lacks("an element before it")),
        ("CYCL DEF 7.0\nCYCL DEF 7.1 X+5\nCT X+5 Y+5", Fault::Lacks("an element before it")),
        ("RND R5\nL X+5", Fault::Lacks("a known start")),
        ("L X+5\nRND R0\nL Y+5", Fault::OutOfRange(0.0)),
        ("L X+5\nRND R9\nL Y+5", Fault::OutOfRange(9.0)),
        ("L X+5\nCHF 5.1\nL Y+9", Fault::OutOfRange(5.1)),
        ("L X+5\nRND R1\nM5", Fault::Lacks("the next element")),
        ("L X+5\nRND R1\nL Y+5 Z+1", Fault::NotRead),
        ("L X+5 RL", Fault::Compensation),
        ("L X+5 F0", Fault::NoFeed),
        ("L X+5 R5", Fault::UnusedWord),
        ("TOOL CALL S0\nL X+5 FU0.1", Fault::NoSpindleSpeed),
        ("L X+5 FZ0.1", Fault::NotRead),
        ("FN 14: ERROR= 1000", Fault::Alarm),
        ("CALL LBL 5", Fault::NoLabel),
        ("LBL 1\nLBL 1\nCALL LBL 1", Fault::DoubleLabel),
        ("CYCL DEF 7.0\nCYCL DEF 7.1 #5", Fault::NoWord),
        ("CYCL DEF 7.1 X+5", Fault::Lacks("the first block of the cycle")),
        ("CYCL DEF 19.0 W\nCYCL DEF 19.1 A+45 B+0", Fault::OtherAxis),
        ("CYCL DEF 11.0 S\nCYCL DEF 11.1 SCL 0", Fault::OutOfRange(0.0)),
        ("CYCL DEF 247 X Q339=1.5", Fault::OutOfRange(1.5)),
        ("CYCL DEF 9.0 DWELL\nCYCL DEF 9.1 DWELL -1", Fault::OutOfRange(-1.0)),
        (";comment ~\nL X+5", Fault::NoWord),
        ("TOOL CALL 5 Z FMAX", Fault::UnusedWord),
        ("CALL PGM T REP 2", Fault::UnusedWord),
        ("LBL 0 X+5", Fault::UnusedWord),
        ("CYCL DEF 9.0 D\nCYCL DEF 9.1 X5 DWELL 1", Fault::UnusedWord),
        ("L X+5 ;one ~\nY+20 F100", Fault::NoWord),
        ("Q1 = 5 ;one ~\ntwo", Fault::BadExpression),
    ] {
        assert_eq!(faults(lines)[0].2, fault, "{lines}");
    }
    assert!(matches!(faults("CC X+5.1 Y+0\nC X+10 Y+0 DR+")[0].2, Fault::Arc(_)));
}

#[test]
fn what_is_not_known_is_no_start_of_a_cut() {
    let start = |lines: &str| {
        faults_of(&format!("BEGIN PGM T MM\nTOOL CALL 1 Z S1000\n{lines}\nEND PGM T MM"))[0].clone()
    };
    assert_eq!(start("L X+0 Y+0 FMAX\nL X+5 F100"), (4, "L X+5 F100".into(), Fault::UnknownStart('Z')));
    assert_eq!(start("L X+0 Y+0 Z+0 FMAX\nL X+5"), (4, "L X+5".into(), Fault::NoFeed));
    assert_eq!(
        start("L X+0 Z+0 FMAX\nCC IX+5 IY+0\nC X+10 Y+0 DR+ F100").2,
        Fault::Lacks("a pole whose place is known")
    );
    assert_eq!(start("L X+0 Z+0 FMAX\nL IY+5 F100").2, Fault::UnknownStart('Y'));
}

#[test]
fn a_text_has_its_beginning_and_its_end() {
    assert_eq!(faults_of("L X+5\nL Y+5"), [(1, "L X+5".into(), Fault::Lacks("BEGIN PGM"))]);
    assert_eq!(
        faults_of("0 BEGIN PGM T MM\n1 L X+5 FMAX"),
        [(2, "L X+5 FMAX".into(), Fault::Lacks("END PGM"))]
    );
    assert_eq!(faults_of("BEGIN PGM T\nEND PGM T"), [(1, "BEGIN PGM T".into(), Fault::Lacks("MM or INCH"))]);
    let text = framed("L X+5") + "L X+6\n";
    assert_eq!(faults_of(&text), [(6, "L X+6".into(), Fault::UnusedWord)]);
    assert_eq!(faults("CALL LBL 1\nM30\nLBL 1\nL X+5"), [(4, "CALL LBL 1".into(), Fault::Lacks("LBL 0"))]);
}

#[test]
fn what_cannot_move_the_tool_is_left_alone_and_counted() {
    let reading = of(
        "BLK FORM 0.1 Z X+0 Y+0 Z-20\nBLK FORM 0.2 X+100 Y+100 Z+0\nTOOL DEF 5\n* - Structure\n; comment\nCYCL DEF 32.0 TOLERANCE\nCYCL DEF 32.1 T0.05\nCYCL DEF 32.2 HSC-MODE:0 TA0.5\nCYCL DEF 13.0 ORIENTATION\nCYCL DEF 13.1 ANGLE 90\nCYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1\nCYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+0 C+0 F5000\nPLANE RESET STAY\nFUNCTION RESET TCPM\nM129\nM127 M8\nFN 16: F-PRINT A.A / B.TXT\nL X+5 A+0 C0 M13\nSTOP M9\nFUNCTION PROG PATH IS CONTOUR\nFUNCTION MODE MILL\nM120 LA10\nL Y+5",
    );
    let words: Vec<_> = reading.left_alone.iter().map(|left| (left.word.as_str(), left.count)).collect();
    for expected in [
        ("BLK FORM", 2),
        ("TOOL DEF", 1),
        ("CYCL DEF 19", 2),
        ("CYCL DEF 32", 1),
        ("STOP", 1),
        ("M8", 1),
        ("M129", 1),
        ("A0", 2),
        ("FN 16", 1),
    ] {
        assert!(words.contains(&expected), "{expected:?} {words:?}");
    }
    assert_eq!(reading.end[0], Some(5.0));
}

#[test]
fn pauses_count_in_seconds() {
    let seconds = |lines: &str| measures(&of(&format!("L X+1\n{lines}"))).dwell_time_s;
    close(
        &[
            seconds("CYCL DEF 9.0 DWELL TIME\nCYCL DEF 9.1 DWELL 1.5"),
            seconds("CYCL DEF 9.0 V.\nCYCL DEF 9.1 V.ZEIT 2"),
            seconds("FUNCTION DWELL TIME3"),
        ],
        &[1.5, 2.0, 3.0],
    );
}

#[test]
fn wear_compensation_is_the_path_of_the_centre() {
    let text = framed("L X+5 RL\nL Y+5 RL\nL X+0 R0");
    let wear = ReadJob { correction: Correction::Wear, ..job(&text) };
    close(&[measures(&read(&wear, &Budget::unlimited()).unwrap()).cutting_length_mm], &[15.0]);
    assert_eq!(faults_of(&text).len(), 1);
}

#[test]
fn a_corner_between_two_sides_of_a_contour_is_refused_where_the_path_is_computed() {
    use crate::machine::Cutter;
    let five = [Cutter { number: None, radius_mm: 5.0 }];
    let first = |lines: &str| {
        let text = framed(lines);
        let computed = ReadJob { correction: Correction::Computed(&five), ..job(&text) };
        match read(&computed, &Budget::unlimited()) {
            Err(ReadError::Refused(refusals)) => Some(refusals[0].fault),
            _ => None,
        }
    };
    let start = "L X-20 Y+0 Z+10 R0 FMAX\nL X+0 Y+0 RL F100\nL Y+50";
    assert_eq!(first(&format!("{start}\nL X-30 R0")), None);
    assert_eq!(first(&format!("{start}\nRND R6\nL X-30 R0")), Some(Fault::CornerBetweenSides));
    assert_eq!(first(&format!("{start}\nL X+50 RR")), Some(Fault::Conflict));
    assert_eq!(first("TOOL CALL 1 Z S1000 DR+1\nL X+0 Y+0 Z+0 R0 FMAX"), Some(Fault::ChangesTool(1.0)));
    // The radius that the program states is the one of the request, or it is refused.
    assert_eq!(first("TOOL DEF 1 L+0 R+5\nTOOL CALL 1 Z S1000\nL X+0 Y+0 Z+0 R0 FMAX"), None);
    assert_eq!(first("TOOL DEF 1 L+0 R+4\nL X+0"), Some(Fault::ChangesTool(-1.0)));
    assert_eq!(first("TOOL DEF 1 L+0 D+4\nL X+0"), Some(Fault::UnusedWord));
    assert_eq!(faults("TOOL CALL 1 Z S1000 DL+1\nL X+0 Y+0 Z+0 FMAX")[0].2, Fault::ChangesTool(1.0));
    assert_eq!(faults("CYCL DEF 8.0 M\nCYCL DEF 8.1 Z")[0].2, Fault::UnusedWord);
    assert_eq!(faults("L X+5 M104")[0].2, Fault::NotRead);
}
