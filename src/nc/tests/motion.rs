//! Lines, arcs, offsets and units against closed forms.

use std::f64::consts::{PI, TAU};

use super::*;

/// A program of LinuxCNC about these lines.
fn framed(lines: &str) -> String {
    format!("G21 G17 G90 G94 G40 G80\n{lines}\nM2\n")
}

#[test]
fn a_place_that_is_not_known_counts_in_nothing() {
    // The way to the start, and the way after G28, have no known start.
    let text = framed("G0 X100 Y50\nZ20\nX0 Y0\nZ1\nG1 X30 Y40 F600\nG28\nG0 X500 Y0 Z20\nG0 Z30");
    let reading = of("linuxcnc", &text);
    let measures = measures(&reading);
    close(
        &[measures.cutting_length_mm, measures.rapid_length_mm],
        &[50.0, 100.0f64.hypot(50.0) + 19.0 + 10.0],
    );
    close(&[measures.bounds.max.x, measures.bounds.max.z], &[500.0, 30.0]);
    assert_eq!((reading.n_rapids_not_counted, reading.toolpath.start().z), (4, 20.0));
    let apart: Vec<_> = reading.toolpath.passes().iter().filter_map(|pass| pass.start()).collect();
    assert_eq!(apart, [[500.0, 0.0, 20.0].into()]);
    assert_eq!(reading.end, [Some(500.0), Some(0.0), Some(30.0)]);
    assert_eq!(
        faults("linuxcnc", &framed("G0 X0 Y0\nG1 X10 F100\nG1 X20"))[0],
        (3, "G1 X10 F100".into(), Fault::UnknownStart('Z'))
    );
    let known = ReadJob { start: [None, None, Some(5.0)], ..job("linuxcnc", "G21 G0 X0 Y0\nG1 X9 F100\nM2") };
    close(&[super::measures(&super::reading(&known)).cutting_length_mm], &[9.0]);
    assert_eq!(read(&job("linuxcnc", "G21 G0 X1\nM2"), &Budget::unlimited()), Err(ReadError::NoMotion));
}

#[test]
fn arcs_turn_in_their_planes_and_circles_close() {
    let start = "G0 X0 Y0 Z0";
    for (word, length) in [
        ("G17 G2 X10 Y10 I10 J0 F100", 5.0 * PI),
        ("G17 G3 X10 Y10 I10 J0 F100", 15.0 * PI),
        ("G18 G3 X10 Z0 I5 K0 F100", 5.0 * PI),
        ("G19 G2 Y10 Z0 J5 K0 F100", 5.0 * PI),
        ("G3 I-4.5 F100", 9.0 * PI),
        ("G3 X0 Y0 I-4.5 F100", 9.0 * PI),
        ("G2 X10 Y0 R5 F100", 5.0 * PI),
        ("G2 X10 Y10 R10 F100", 5.0 * PI),
        ("G2 X10 Y10 R-10 F100", 15.0 * PI),
        ("G2 X0 Y0 Z3 I5 F100", (10.0 * PI).hypot(3.0)),
        ("G2 X0 Y0 Z6 I5 P3 F100", (30.0 * PI).hypot(6.0)),
        ("G2 X10 Y10 Z5 I10 P2 F100", (10.0 * (TAU + PI / 2.0)).hypot(5.0)),
        ("G90.1 G2 X10 Y10 I10 J0 F100", 5.0 * PI),
        ("G91 G2 X10 Y10 I10 F100", 5.0 * PI),
        ("G91 G3 X10 Y0 I5 F100\nI-5\nX0 Y0 I-5", 25.0 * PI),
    ] {
        close(&[lengths("linuxcnc", &framed(&format!("{start}\n{word}")))[0]], &[length]);
    }
    // G18: X right, Z up; G3 from X0 to X10 humps toward +Z. G19: G2 from Y0 to Y10 does.
    for word in ["G18 G3 X10 I5 F100", "G19 G2 Y10 J5 F100"] {
        let bounds = measures(&of("linuxcnc", &framed(&format!("{start}\n{word}")))).bounds;
        close(&[bounds.min.z, bounds.max.z], &[0.0, 5.0]);
    }
}

#[test]
fn units_points_and_feeds_count_as_on_each_control() {
    let inch = "G20\nG0 X0. Y0. Z0.\nG1 X1. F10.\nM30\n";
    for dialect in ["linuxcnc", "fanuc", "haas", "grbl", "mach4", "mazak", "okuma", "iso"] {
        let measures = measures(&of(dialect, inch));
        close(&[measures.cutting_length_mm, measures.cutting_time_s.unwrap()], &[25.4, 6.0]);
    }
    let bare = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F600\nX20.\nM30\n";
    let fanuc = of("fanuc", bare);
    close(&[measures(&fanuc).cutting_length_mm], &[20.0]);
    close(&[measures(&fanuc).bounds.max.x], &[20.0]);
    assert_eq!(fanuc.notes, [Note::LeastIncrements { count: 1, line: 3, ten_mm: 0.01 }]);
    let tiny = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F600\nM30\n";
    close(
        &[lengths("fanuc", tiny)[0], lengths("okuma", tiny)[0], lengths("linuxcnc", tiny)[0]],
        &[0.01, 10.0, 10.0],
    );
    let units =
        ReadJob { without_point: Some(super::super::control::WithoutPoint::Units), ..job("haas", tiny) };
    close(&[measures(&reading(&units)).cutting_length_mm], &[10.0]);
    let assumed = of("linuxcnc", "G0 X0 Y0 Z0\nG1 X1 F60\nM2\n");
    assert_eq!(assumed.notes, [Note::UnitsAssumed { line: 1, units: "mm" }]);
    for (words, seconds) in
        [("G93 G1 X10 F2", 30.0), ("S1000 M3 G95 G1 X10 F0.1", 6.0), ("G94 G1 X10 F60", 10.0)]
    {
        let time = measures(&of("linuxcnc", &framed(&format!("G0 X0 Y0 Z0\n{words}")))).cutting_time_s;
        close(&[time.unwrap()], &[seconds]);
    }
}

#[test]
fn pauses_count_in_the_unit_of_each_control() {
    for (dialect, word, seconds) in [
        ("grbl", "G4 P3000", 3000.0),
        ("linuxcnc", "G4 P1.5", 1.5),
        ("fanuc", "G4 P1500", 1.5),
        ("fanuc", "G4 X1.5", 1.5),
        ("fanuc", "G4 X1500", 1.5),
        ("haas", "G4 P1.5", 1.5),
        ("haas", "G4 P1500", 1.5),
        ("okuma", "G4 F2", 2.0),
    ] {
        let text = format!("G21\nG0 X0. Y0. Z0.\n{word}\nG1 X1. F60.\nM30\n");
        let reading = of(dialect, &text);
        close(&[measures(&reading).dwell_time_s], &[seconds]);
        let told = reading.notes.iter().any(|note| note.to_string().contains("50.0 minutes"));
        assert_eq!(told, seconds == 3000.0, "{dialect} {word}");
    }
}

#[test]
fn shifts_and_offsets_move_the_zero_where_they_are_certain() {
    let at = |text: &str| of("linuxcnc", &framed(text)).end;
    assert_eq!(at("G0 X1 Y2 Z3\nG92 X0 Y0 Z0\nG0 X5 Y5 Z5")[0], Some(6.0));
    assert_eq!(at("G92 X0 Y0 Z0\nG0 X5 Y5 Z5\nG1 X6 F10"), [Some(6.0), Some(5.0), Some(5.0)]);
    assert_eq!(at("G0 X1 Y2 Z3\nG92 X0\nG92.1\nG0 X5 Y5 Z5\nG0 X6")[0], Some(6.0));
    assert_eq!(at("G0 X1 Y2 Z3\nG52 X10\nG0 X5 Y5 Z5\nG52 X0\nG0 Z6")[0], Some(15.0));
    assert_eq!(at("G0 X1 Y2 Z3\nG10 L20 P1 X0\nG0 X5 Y5 Z5\nG0 Z6")[0], Some(6.0));
    assert_eq!(at("G0 X1 Y2 Z3\nG0 X2\nG53 G0 Z0"), [Some(2.0), Some(2.0), None]);
    let text = framed("G0 X1 Y2 Z3\nG55 G0 X0 Y0 Z0\nG53 G0 Z0");
    let offsets = [(1, [-100.0, 0.0, -50.0]), (2, [-80.0, 0.0, -50.0])];
    let reading = super::reading(&ReadJob { offsets: &offsets, ..job("linuxcnc", &text) });
    assert_eq!(reading.end, [Some(20.0), Some(0.0), Some(50.0)]);
    let apart = of("linuxcnc", &framed("G0 X1 Y2 Z3\nG0 X2\nG55 G0 X0 Y0 Z0\nG0 X1"));
    assert_eq!(measures(&apart).rapid_length_mm, 2.0);
    assert!(matches!(apart.notes[0], Note::UnrelatedOffset { line: 4, .. }));
}

#[test]
fn an_inch_program_with_three_decimals_is_read_and_told_where_arcs_move() {
    let text = "G20\nG0 X0. Y0. Z0.\nG2 X.354 Y.146 I.353 J-.354 F10.\nM30\n";
    let reading = of("fanuc", text);
    let radius = 25.4 * 0.353f64.hypot(0.354);
    let length = measures(&reading).cutting_length_mm;
    assert!((length - radius * PI / 4.0).abs() < 0.1, "{length}");
    assert!(matches!(reading.notes[0], Note::ArcsMoved { count: 1, line: 3, .. }), "{:?}", reading.notes);
}

#[test]
fn tools_are_told_apart() {
    let text = "%\nO1\nG21 G90\nT1 M6\nS1000 M3\nG0 X0. Y0.\nG43 H1 Z5.\nG1 Z-1. F60.\nG0 Z50.\nT2\nM6\nG0 X9. Y0.\nG43 H2 Z5.\nG1 Z0. F30.\nM30\n%\n";
    let reading = of("fanuc", text);
    let tools: Vec<_> =
        reading.tools.iter().map(|t| (t.number, t.line, t.first_pass, t.cutting_length_mm)).collect();
    assert_eq!(tools, [(Some(1), 4, 0, 6.0), (Some(2), 11, 1, 5.0)]);
    close(&[reading.feeds[0].time_s, reading.feeds[1].time_s], &[10.0, 6.0]);
    assert_eq!(reading.lines, [8, 9, 14]);
}

#[test]
fn a_way_of_rounding_errors_takes_no_time_of_a_block() {
    // 0.1 + 0.2 is not 0.3 in floating point; the block to 0.3 would take 15 s.
    let text = "G21 G91 G94\nG0 X0 Y0 Z0\nG1 X0.1 F60\nX0.2\nG90 G93 G1 X0.3 F4\nG94 F60\nM2\n";
    let reading = reading(&ReadJob { start: [Some(0.0); 3], ..job("linuxcnc", text) });
    close(&[measures(&reading).cutting_time_s.expect("feeds")], &[0.3]);
}

#[test]
fn an_arc_stays_in_force_and_needs_its_centre_in_each_block() {
    for dialect in ["linuxcnc", "fanuc", "haas", "grbl", "mach4", "okuma"] {
        let text = "G21 G90 G91.1\nG0 X0. Y0. Z0.\nG2 X10. Y10. I10. J0. F100.\nX20. Y0. I0. J-10.\nG1 X30.\nX40.\nM30\n";
        let text = if matches!(dialect, "linuxcnc" | "mach4" | "grbl") {
            text.to_owned()
        } else {
            text.replace(" G91.1", "")
        };
        close(&[lengths(dialect, &text)[0]], &[10.0 * PI + 20.0]);
        let lacking = text.replace("X20. Y0. I0. J-10.", "X20. Y0.");
        assert_eq!(faults(dialect, &lacking)[0], (4, "X20. Y0.".into(), Fault::NoCenter), "{dialect}");
    }
}

#[test]
fn a_circle_without_x_and_y_is_whole_where_the_control_allows_it() {
    for (dialect, plane, words) in [
        ("linuxcnc", "G17", "I-4.5"),
        ("fanuc", "G17", "I-4.5"),
        ("fanuc", "G18", "K-4.5"),
        ("haas", "G19", "J-4.5"),
        ("mach4", "G17", "I-4.5"),
    ] {
        let text = format!("G21 G90\nG0 X0. Y0. Z0.\n{plane} G3 {words} F100.\nM30\n");
        close(&[lengths(dialect, &text)[0]], &[9.0 * PI]);
    }
    assert_eq!(faults("grbl", "G21\nG0 X0 Y0 Z0\nG3 I-4.5 F100\nM30\n")[0].2, Fault::Missing('X'));
    // A radius says no whole circle.
    assert_eq!(faults("fanuc", "G21\nG0 X0. Y0. Z0.\nG3 R4.5 F100.\nM30\n")[0].2, Fault::ClosedRadius);
}
