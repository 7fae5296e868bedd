//! Cycles for holes and patterns.

use super::*;

const DRILL: &str = "CYCL DEF 200 DRILLING ~\n Q200=+2 ;SET-UP CLEARANCE ~\n Q201=-20 ;DEPTH ~\n Q206=+100 ~\n Q202=+25 ~\n Q210=+0 ~\n Q203=+0 ~\n Q204=+10 ~\n Q211=+0\n";

#[test]
fn a_hole_is_drilled_and_left_at_the_second_clearance() {
    // Down 22 mm by feed, up by rapid.
    let one = format!("L Z+50 FMAX\n{DRILL}L X+10 Y+0 R0 FMAX M99");
    close(&lengths(&one), &[22.0, 50.0 + 10.0 + 48.0 + 22.0 + 8.0]);
    close(&end(&one), &[10.0, 0.0, 10.0]);
    for call in ["L X+10 Y+0 FMAX\nCYCL CALL M3", "CYCL CALL POS X+10 Y+0 Z+0 FMAX M3"] {
        close(&lengths(&format!("L Z+50 FMAX\n{DRILL}{call}")), &lengths(&one));
    }
    let raised = format!("L Z+50 FMAX\n{DRILL}CYCL CALL POS X+10 Y+0 Z+5 FMAX M3");
    close(&end(&raised), &[10.0, 0.0, 15.0]);
    let seconds = measures(&of(&one)).cutting_time_s.unwrap();
    close(&[seconds], &[13.2]);
}

#[test]
fn infeeds_come_back_to_above_the_last_bottom() {
    let peck =
        DRILL.replace("Q202=+25", "Q202=+8").replace("Q210=+0", "Q210=+0.5").replace("Q211=+0", "Q211=+1");
    let text = format!("L Z+50 FMAX\n{peck}CYCL CALL");
    // Bottoms 8, 16 and 20: cuts 2+8, 2+8, 2+4; rapids up and down the hole.
    close(&lengths(&text), &[26.0, 50.0 + 48.0 + (10.0 + 8.0) + (18.0 + 16.0) + 22.0 + 8.0]);
    close(&[measures(&of(&text)).dwell_time_s], &[2.0]);
    let deep = "CYCL DEF 205 X ~\nQ200=2 ~\nQ201=-20 ~\nQ206=100 ~\nQ202=8 ~\nQ203=0 ~\nQ204=0 ~\nQ212=0 ~\nQ205=0 ~\nQ258=0.5 ~\nQ259=0.5 ~\nQ257=0 ~\nQ256=0.2 ~\nQ211=0 ~\nQ379=0 ~\nQ253=750\n";
    close(
        &lengths(&format!("L Z+50 FMAX\n{deep}CYCL CALL")),
        &[10.0 + 8.5 + 4.5, 50.0 + 48.0 + (10.0 + 9.5) + (18.0 + 17.5) + 22.0],
    );
}

#[test]
fn each_cycle_goes_out_in_its_own_way() {
    let common = "Q200=2 ~\nQ201=-20 ~\nQ203=0 ~\nQ204=2 ~\n";
    let seconds = |cycle: &str| {
        let measures = measures(&of(&format!("L Z+2 FMAX\n{cycle}\nCYCL CALL")));
        [measures.cutting_length_mm, measures.cutting_time_s.unwrap(), measures.dwell_time_s]
    };
    let cycle = |number: u32, rest: &str| seconds(&format!("CYCL DEF {number} NAME ~\n{common}{rest}"));
    close(&cycle(201, "Q206=60 ~\nQ211=1 ~\nQ208=120"), &[44.0, 33.0, 1.0]);
    close(&cycle(201, "Q206=60 ~\nQ211=0 ~\nQ208=0"), &[44.0, 44.0, 0.0]);
    close(&cycle(201, "Q206=60 ~\nQ211=0 ~\nQ208=99999"), &[22.0, 22.0, 0.0]);
    close(&cycle(202, "Q206=60 ~\nQ211=0 ~\nQ208=FMAX ~\nQ214=0 ~\nQ336=0"), &[22.0, 22.0, 0.0]);
    close(
        &cycle(203, "Q206=60 ~\nQ202=20 ~\nQ210=0 ~\nQ212=0 ~\nQ213=0 ~\nQ205=0 ~\nQ211=0 ~\nQ208=0"),
        &[22.0, 22.0, 0.0],
    );
    close(&cycle(206, "Q206=60 ~\nQ211=0.5"), &[44.0, 44.0, 0.5]);
    // 1000 turns a minute, 1.5 mm each.
    close(&cycle(207, "Q239=+1.5"), &[44.0, 44.0 / 25.0, 0.0]);
    close(&cycle(240, "Q206=FAUTO ~\nQ343=0 ~\nQ344=-8 ~\nQ211=0"), &[22.0, 13.2, 0.0]);
}

#[test]
fn cycles_of_the_older_form_begin_where_the_tool_stands() {
    let peck = "CYCL DEF 1.0 PECKING\nCYCL DEF 1.1 SET UP 2\nCYCL DEF 1.2 DEPTH -15\nCYCL DEF 1.3 PECKG 10\nCYCL DEF 1.4 DWELL 1\nCYCL DEF 1.5 F60\n";
    let text = format!("L Z+2 FMAX\n{peck}L X+10 FMAX M99");
    // 12 down, 12 up, down to 0.6 above 10, and 5.6 on.
    close(&lengths(&text), &[12.0 + 5.6, 2.0 + 10.0 + 12.0 + 11.4 + 17.0]);
    close(&end(&text), &[10.0, 0.0, 2.0]);
    let german = peck.replace("SET UP", "ABST").replace("DWELL", "V.ZEIT").replace("DEPTH -15", "TIEFE -Q7");
    close(&lengths(&format!("Q7 = 15\nL Z+2 FMAX\n{german}L X+10 FMAX M99")), &lengths(&text));
    let tap = "CYCL DEF 2.0 TAPPING\nCYCL DEF 2.1 SET UP 2\nCYCL DEF 2.2 DEPTH -10\nCYCL DEF 2.3 DWELL 0\nCYCL DEF 2.4 F100\n";
    close(&[cut(&format!("L Z+2 FMAX\n{tap}CYCL CALL"))], &[24.0]);
    let rigid =
        "CYCL DEF 17.0 RIGID\nCYCL DEF 17.1 SET UP 2\nCYCL DEF 17.2 DEPTH -10\nCYCL DEF 17.3 PITCH +1\n";
    let seconds = measures(&of(&format!("L Z+2 FMAX\n{rigid}CYCL CALL"))).cutting_time_s.unwrap();
    close(&[seconds], &[24.0 * 0.06]);
}

#[test]
fn a_modal_call_runs_behind_each_positioning() {
    let text = format!("L Z+50 FMAX\n{DRILL}L X+10 FMAX M89\nL X+20 FMAX\nL X+30 FMAX M99\nL X+40 FMAX");
    close(&[cut(&text)], &[66.0]);
}

#[test]
fn patterns_run_the_cycle_at_their_places() {
    let points = "PATTERN DEF POS1 (X+10 Y+0 Z+0) ~\n POS2 (X+20 Y+10 Z+0)\n";
    let text = format!("L Z+50 FMAX\n{DRILL}{points}CYCL CALL PAT FMAX M13");
    let hole = 48.0 + 22.0 + 8.0;
    close(&lengths(&text), &[44.0, 50.0 + 10.0 + hole + 40.0 + 200f64.sqrt() + hole]);
    assert_eq!(of(&text).end, [Some(20.0), Some(10.0), None]);
    let circle = "CYCL DEF 220 POLAR ~\nQ216=50 ~\nQ217=50 ~\nQ244=80 ~\nQ245=0 ~\nQ246=360 ~\nQ247=0 ~\nQ241=4 ~\nQ200=2 ~\nQ203=0 ~\nQ204=20 ~\nQ301=1 ~\nQ365=0\n";
    let reading = of(&format!("L Z+20 FMAX\n{DRILL}{circle}"));
    let measured = measures(&reading);
    let across = 90f64.hypot(50.0) + 3.0 * 40.0 * 2f64.sqrt();
    close(
        &[measured.cutting_length_mm, measured.rapid_length_mm],
        &[88.0, 20.0 + across + 4.0 * (18.0 + 22.0 + 18.0)],
    );
    let part = circle.replace("Q246=360", "Q246=90").replace("Q241=4", "Q241=2");
    close(&of(&format!("L Z+20 FMAX\n{DRILL}{part}")).end.map(Option::unwrap), &[50.0, 90.0, 20.0]);
    let rows = "CYCL DEF 221 CARTESIAN ~\nQ225=10 ~\nQ226=5 ~\nQ237=10 ~\nQ238=8 ~\nQ242=3 ~\nQ243=2 ~\nQ224=0 ~\nQ200=2 ~\nQ203=0 ~\nQ204=20 ~\nQ301=0\n";
    let reading = of(&format!("L Z+20 FMAX\n{DRILL}{rows}"));
    let measured = measures(&reading);
    let across = 10f64.hypot(5.0) + 4.0 * 10.0 + 8.0;
    close(
        &[measured.cutting_length_mm, measured.rapid_length_mm],
        &[132.0, 20.0 + across + 18.0 + 6.0 * 22.0],
    );
    assert_eq!(reading.end, [Some(10.0), Some(13.0), None]);
}

#[test]
fn a_cycle_may_call_a_program() {
    let text = "BEGIN PGM A MM\nTOOL CALL 1 Z S1 F100\nL X+0 Y+0 Z+0 FMAX\nCYCL DEF 12.0 PGM CALL\nCYCL DEF 12.1 PGM TNC:\\B.H\nL X+10 M99\nCYCL CALL\nEND PGM A MM\nBEGIN PGM B MM\nL IY+5\nEND PGM B MM";
    close(&whole(text).end.map(Option::unwrap), &[10.0, 10.0, 0.0]);
}

#[test]
fn what_a_cycle_does_not_say_for_certain_is_refused() {
    let with = |from: &str, to: &str| faults(&format!("{}CYCL CALL", DRILL.replace(from, to)))[0].clone();
    assert_eq!(with("Q201=-20", "Q201=+20").2, Fault::OutOfRange(-20.0));
    assert_eq!(with("Q202=+25", "Q202=+0").2, Fault::OutOfRange(0.0));
    assert_eq!(with("Q211=+0", "Q211=+0 ~\n Q395=+1").2, Fault::UnsureParameter(395));
    assert_eq!(with(" Q203=+0 ~\n", ""), (4, "200".into(), Fault::LacksParameter(203)));
    assert_eq!(with("Q203=+0", "Q99=+0"), (10, "Q99=+0".into(), Fault::UnusedWord));
    assert_eq!(with("Q203=+0", "Q203=+Q77"), (10, "Q203=+Q77".into(), Fault::AtMachine));
    assert_eq!(with("Q203=+0", "Q203=+0 Q203=1").2, Fault::Twice);
    assert_eq!(faults(&format!("L Z+50 FMAX\n{DRILL}Q201 = -30\nCYCL CALL"))[0].2, Fault::ChangedCycle);
    assert_eq!(faults("CYCL CALL")[0].2, Fault::Lacks("CYCL DEF"));
    assert_eq!(faults("L X+5 FMAX M99")[0], (4, "M99".into(), Fault::Lacks("CYCL DEF")));
    for number in [204, 208, 241, 251, 256, 262, 400, 14, 20, 25, 290] {
        assert_eq!(
            faults(&format!("CYCL DEF {number} NAME\nCYCL CALL")),
            [(4, number.to_string(), Fault::NotRead)]
        );
    }
    assert_eq!(
        faults("CYCL DEF 14.0 CONTOUR\nCYCL DEF 14.1 CONTOUR LABEL 1"),
        [(4, "14.0".into(), Fault::NotRead)]
    );
    assert_eq!(faults(&format!("L Z+50 FMAX\n{DRILL}L X+9 FMAX M99\nL X+10"))[0].2, Fault::FeedBehindCycle);
    // A rapid, and a block with an F, need no feed of before.
    close(
        &end(&format!("L Z+50 FMAX\n{DRILL}L X+9 FMAX M99\nL X+10 FMAX\nL X+11 F50\nL X+12")),
        &[12.0, 0.0, 10.0],
    );
}

#[test]
fn chips_are_broken_inside_the_hole() {
    let common = "Q200=2 ~\nQ201=-20 ~\nQ206=60 ~\nQ203=0 ~\nQ204=2 ~\nQ211=0 ~\n";
    let of = |number: u32, rest: &str| {
        let reading = of(&format!("L Z+2 FMAX\nCYCL DEF {number} NAME ~\n{common}{rest}\nCYCL CALL"));
        let measures = measures(&reading);
        [measures.cutting_length_mm, measures.rapid_length_mm - 2.0, measures.dwell_time_s]
    };
    // Bottoms 8, 16 and 20; each time out, and down to 2 mm above the bottom.
    close(&of(203, "Q208=0 ~\nQ202=8 ~\nQ210=1 ~\nQ213=0"), &[26.0, 10.0 + 8.0 + 18.0 + 16.0 + 22.0, 2.0]);
    // One break at 8, then out behind 16.
    close(
        &of(203, "Q208=0 ~\nQ202=8 ~\nQ213=1 ~\nQ256=0.5 ~\nQ210=1"),
        &[24.5, 0.5 + 18.0 + 16.0 + 22.0, 1.0],
    );
    // Infeeds of 8, 5, 4 and 3: each less by 3, but no less than 4.
    close(&of(203, "Q208=0 ~\nQ202=8 ~\nQ212=3 ~\nQ205=4 ~\nQ213=9 ~\nQ256=0.5")[..1], &[22.0 + 3.0 * 0.5]);
    // The way out at a feed of its own.
    close(&of(203, "Q208=30 ~\nQ202=8 ~\nQ213=0")[..1], &[26.0 + 10.0 + 18.0 + 22.0]);
    let deep = "Q258=0.5 ~\nQ259=0.5 ~\nQ202=10 ~\nQ257=4 ~\nQ256=0.2";
    // Breaks at 4 and 8, out behind 10, breaks at 14 and 18.
    close(&of(205, deep), &[22.0 + 0.5 + 4.0 * 0.2, 4.0 * 0.2 + 12.0 + 11.5 + 22.0, 0.0]);
    let fault = |number: u32, rest: &str| faults(&format!("CYCL DEF {number} NAME ~\n{common}{rest}"))[0].2;
    assert_eq!(fault(203, "Q208=0 ~\nQ202=8 ~\nQ213=1"), Fault::LacksParameter(256));
    assert_eq!(fault(203, "Q208=0 ~\nQ202=8 ~\nQ212=3"), Fault::OutOfRange(0.0));
}

#[test]
fn a_tap_breaks_chips_by_turns_of_its_thread() {
    let common = "Q200=2 ~\nQ201=-12 ~\nQ239=+1.5 ~\nQ203=0 ~\nQ204=2 ~\nQ257=5 ~\n";
    let of = |rest: &str| {
        let reading = of(&format!("L Z+2 FMAX\nCYCL DEF 209 TAP ~\n{common}{rest}\nCYCL CALL"));
        [measures(&reading).cutting_length_mm, measures(&reading).cutting_time_s.unwrap()]
    };
    // 1000 turns a minute of 1.5 mm; to 5 and 10 and back by a turn each, to 12, and out twice as fast.
    close(&of("Q256=+1 ~\nQ336=0 ~\nQ403=2"), &[14.0 + 4.0 * 1.5 + 14.0, 20.0 / 25.0 + 14.0 / 50.0]);
    // Out of the hole by the thread, and in again.
    close(&of("Q256=0 ~\nQ336=0"), &[7.0 + 7.0 + 12.0 + 12.0 + 14.0 + 14.0, 66.0 / 25.0]);
    let wrong = format!("CYCL DEF 209 TAP ~\n{common}Q256=1 ~\nQ403=0");
    assert_eq!(faults(&wrong)[0].2, Fault::OutOfRange(0.0));
}

#[test]
fn cycles_of_programs_in_inches_have_lengths_in_inches_and_feeds_in_tenths() {
    let of = |cycle: &str| {
        let text = format!(
            "0 BEGIN PGM T INCH\n1 TOOL CALL 1 Z S1000 F100\n2 L X+0 Y+0 Z+1 R0 FMAX M3\n{cycle}\nCYCL CALL\n9 END PGM T INCH\n"
        );
        let reading = whole(&text);
        let told = reading.notes.contains(&crate::notes::Note::TenthsOfInch { line: 4 });
        assert!(told, "{:?}", reading.notes);
        (measures(&reading), reading.end[2].unwrap())
    };
    let drill = "CYCL DEF 200 D ~\nQ200=0.1 ~\nQ201=-0.5 ~\nQ206=100 ~\nQ202=1 ~\nQ203=0 ~\nQ204=0.1";
    let (measured, end) = of(drill);
    // 0.6 inch at 10 inches a minute.
    close(&[measured.cutting_length_mm, measured.cutting_time_s.unwrap(), end], &[15.24, 3.6, 2.54]);
    let (measured, _) = of(&drill.replace("Q206=100", "Q206=FAUTO"));
    close(&[measured.cutting_time_s.unwrap()], &[3.6]);
    let older = "CYCL DEF 2.0 T\nCYCL DEF 2.1 SET UP 1\nCYCL DEF 2.2 DEPTH -0.5\nCYCL DEF 2.3 DWELL 0\nCYCL DEF 2.4 F100";
    let text = format!(
        "BEGIN PGM T INCH\nTOOL CALL 1 Z S1000 F100\nL X+0 Y+0 Z+1 FMAX\n{older}\nCYCL CALL\nEND PGM T INCH"
    );
    close(&[measures(&whole(&text)).cutting_length_mm], &[2.0 * 1.5 * 25.4]);
    let pitch = "BEGIN PGM T INCH\nCYCL DEF 207 T ~\nQ200=1 Q201=-1 Q239=0.05 Q203=0 Q204=1\nEND PGM T INCH";
    assert_eq!(faults_of(pitch)[0].2, Fault::UnsureFeed);
}
