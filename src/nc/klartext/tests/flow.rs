//! Labels, calls, repeats, jumps and parameters.

use super::*;

#[test]
fn subprograms_run_as_often_as_they_are_called() {
    let text = framed(
        "CALL LBL 1\nCALL LBL \"Side\"\nL Z+9\nL X+1 M30\nLBL 1\nL IX+10\nCALL LBL \"Side\"\nLBL 0\nLBL \"Side\"\nL IY+5\nLBL 0",
    );
    close(&whole(&text).end.map(Option::unwrap), &[1.0, 10.0, 9.0]);
    // A label without a call is passed.
    close(&end("LBL 7\nL IX+3\nLBL 0\nL IX+3\nCALL LBL 7 REP"), &[9.0, 0.0, 0.0]);
}

#[test]
fn a_part_is_repeated_as_often_as_rep_says() {
    close(&end("LBL 1\nL IX+10\nCALL LBL 1 REP 3\nL IY+1"), &[40.0, 1.0, 0.0]);
    close(&end("LBL 1\nL IX+10\nCALL LBL 1 REP 2/2"), &[30.0, 0.0, 0.0]);
    // Repeats in repeats, and in a subprogram that is called again.
    close(&end("LBL 1\nLBL 2\nL IX+1\nCALL LBL 2 REP2\nL IY+1\nCALL LBL 1 REP 3"), &[12.0, 4.0, 0.0]);
    let text = framed("CALL LBL 5\nCALL LBL 5\nM30\nLBL 5\nLBL 6\nL IX+1\nCALL LBL 6 REP 4\nLBL 0");
    assert_eq!(whole(&text).end[0], Some(10.0));
    close(&end("Q3 = 1\nLBL 1\nL IX+1\nLBL 0\nCALL LBL Q3"), &[2.0, 0.0, 0.0]);
    close(&end("Q3 = 4\nLBL 1\nL IX+1\nCALL LBL 1 REP Q3"), &[5.0, 0.0, 0.0]);
}

#[test]
fn jumps_follow_conditions() {
    for (condition, is_true) in [
        ("+Q1 EQU +5", true),
        ("+Q1 NE +5", false),
        ("+Q1 GT +4.9", true),
        ("+Q1 LT 5", false),
        ("-Q1 LT +0", true),
        ("Q1 + 1 EQU Q2 * 3", true),
    ] {
        let jump = format!("Q1 = 5\nQ2 = 2\nFN 9: IF {condition} GOTO LBL 9\nL IX+1\nLBL 9\nL IY+1");
        assert_eq!(end(&jump)[0], if is_true { 0.0 } else { 1.0 }, "{condition}");
    }
    close(&end("Q1 = 0\nLBL 1\nL IX+1\nQ1 = Q1 + 0.125\nFN 12: IF +Q1 LT +1 GOTO LBL 1"), &[8.0, 0.0, 0.0]);
    close(&end("Q1 = 3\nIF Q1 >= 3 THEN GOTO LBL \"x\"\nL X+9\nLBL \"x\"\nL Y+1"), &[0.0, 1.0, 0.0]);
}

#[test]
fn a_condition_that_rounding_decides_is_refused() {
    let rounded = "Q1 = 0\nLBL 1\nL IX+1\nQ1 = Q1 + 0.1\nFN 12: IF +Q1 LT +1 GOTO LBL 1";
    assert_eq!(faults(rounded)[0].2, Fault::NoValue("both sides are equal but for rounding"));
}

#[test]
fn functions_with_numbers_compute() {
    for (function, value) in [
        ("FN 0: Q1 = -5", -5.0),
        ("FN0:Q1=+Q9", 4.0),
        ("FN 1: Q1 = -Q9 + -5", -9.0),
        ("FN 2: Q1 = +10 - +Q9", 6.0),
        ("FN 3: Q1 = +3 * +Q9", 12.0),
        ("FN 4: Q1 = +10 DIV +Q9", 2.5),
        ("FN 5: Q1 = SQRT 4", 2.0),
        ("FN 6: Q1 = SIN +30", 0.5),
        ("FN 7: Q1 = COS +60", 0.5),
        ("FN 8: Q1 = +3 LEN +Q9", 5.0),
        ("FN 13: Q1 = +1 ANG -1", 135.0),
    ] {
        close(&end(&format!("Q9 = 4\n{function}\nL X+Q1")), &[value, 0.0, 0.0]);
    }
}

#[test]
fn called_programs_have_units_labels_and_local_parameters_of_their_own() {
    let text = "0 BEGIN PGM MAIN MM\n1 TOOL CALL 1 Z S1000 F100\nL X+0 Y+0 Z+0 FMAX\nQL1 = 7\nQ1 = 2\nCALL PGM SUB\nCALL LBL 1\nL Y+QL1\nEND PGM MAIN MM\nBEGIN PGM SUB INCH\nQL1 = 1\nLBL 1\nL X+QL1\nL Z+Q1\nEND PGM SUB INCH\n";
    assert_eq!(faults_of(text), [(7, "1".into(), Fault::NoLabel)]);
    let read = whole(&text.replace("CALL LBL 1\n", ""));
    close(&read.end.map(Option::unwrap), &[25.4, 7.0, 50.8]);
    assert_eq!(
        faults("CALL PGM TNC:\\NOT\\HERE.H"),
        [(4, "CALL PGM TNC:\\NOT\\HERE.H".into(), Fault::NoProgram)]
    );
    let twice = text.replace("CALL LBL 1\n", "") + "BEGIN PGM SUB MM\nEND PGM SUB MM";
    assert_eq!(faults_of(&twice)[0].2, Fault::DoubleLabel);
    let ends = text.replace("CALL LBL 1\n", "").replace("L Z+Q1", "L Z+Q1 M30");
    assert_eq!(faults_of(&ends), [(13, "M30".into(), Fault::Conflict)]);
}

#[test]
fn optional_blocks_run_unless_they_are_skipped() {
    let text = framed("/ L X+5\n/5 L Y+5\nL Z+1");
    assert_eq!(whole(&text).end[0], Some(5.0));
    let skips = ReadJob { skips_optional: true, ..job(&text) };
    assert_eq!(read(&skips, &Budget::unlimited()).unwrap().end, [Some(0.0), Some(0.0), Some(1.0)]);
}

#[test]
fn endless_and_deep_programs_end_in_a_refusal() {
    let fault = |lines: &str| faults(lines)[0].2;
    assert_eq!(fault("LBL 1\nFN 9: IF +0 EQU +0 GOTO LBL 1"), Fault::Endless(5_000_000));
    assert_eq!(fault("LBL 1\nCALL LBL 1\nLBL 0"), Fault::DeepCalls(32));
    assert_eq!(
        fault("LBL 1\nLBL 2\nLBL 3\nQ1 = 1\nCALL LBL 3 REP 65534\nCALL LBL 2 REP 65534"),
        Fault::Endless(5_000_000)
    );
    assert_eq!(
        fault("LBL 1\nL IX+1\nCALL LBL 1 REP 65534\nCALL LBL 1 REP 65534"),
        Fault::TooManyMoves(100_000)
    );
    assert!(matches!(fault("LBL 1\nL IX+1\nCALL LBL 1 REP 70000"), Fault::OutOfRange(_)));
    assert!(matches!(fault("LBL 1\nCALL LBL 1 REP 0"), Fault::OutOfRange(_)));
    assert!(matches!(fault("LBL 1\nCALL LBL 1 REP 1.5"), Fault::OutOfRange(_)));
    assert_eq!(fault("CALL PGM T"), Fault::DeepCalls(32));
    assert_eq!(fault(&format!("Q1 = {}1", "(".repeat(100_000))), Fault::TooDeep);
    let nothing = "CYCL DEF 200 X ~\nQ200=2 Q201=0 Q206=1 Q202=1 Q203=0 Q204=0\nLBL 1\nCYCL DEF 221 X ~\nQ225=0 Q226=0 Q237=0 Q238=0 Q242=1000 Q243=100 Q224=0 Q200=2 Q203=0 Q204=0 Q301=0\nCALL LBL 1 REP 65534";
    assert_eq!(fault(nothing), Fault::Endless(5_000_000));
}

#[test]
fn a_repeat_that_a_jump_has_left_is_not_counted_on() {
    let lines = "Q1 = 0\nLBL 1\nQ1 = Q1 + 1\nFN 9: IF +Q1 EQU +2 GOTO LBL 3\nLBL 4\nCALL LBL 1 REP 3\nFN 11: IF +Q1 GT +2 GOTO LBL 5\nLBL 3\nFN 9: IF +0 EQU +0 GOTO LBL 4\nLBL 5";
    assert_eq!(faults(lines)[0], (9, "CALL LBL 1 REP 3".into(), Fault::NotRead));
}

#[test]
fn parameters_that_only_the_control_knows_are_refused_where_they_are_used() {
    for lines in [
        "L X+Q5",
        "L X+QR5",
        "L X+QL5",
        "L X+Q108",
        "FN 0: Q108 = +1\nL X+Q108",
        "FN 18: SYSREAD Q5 = ID210 NR4\nL X-Q5",
        "Q7 = Q5 + 1",
        "FN 9: IF +Q5 EQU +1 GOTO LBL 1\nLBL 1",
        "TOOL CALL Q5 Z S100",
    ] {
        let found = faults(lines);
        assert_eq!((found.len(), found[0].2), (1, Fault::AtMachine), "{lines}");
    }
    // What follows from the refusal is not refused again.
    assert_eq!(faults("Q7 = Q5 + 1\nQ8 = Q7 * 2\nL X+Q8\nL Y+Q7 F100\nCC X+Q7 Y+0\nC X+0 Y+0 DR+").len(), 1);
    assert!(matches!(faults("Q2000 = 5")[0].2, Fault::OutOfRange(_)));
    assert!(faults("QS1 = \"text\"")[0].2 == Fault::NotRead);
}
