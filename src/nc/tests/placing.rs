//! Turned, scaled, mirrored and polar coordinates against closed forms.

use super::*;

/// The end of a program of Haas.
fn end(lines: &str) -> [f64; 3] {
    of("haas", &format!("G21 G90 G94 G17\nT1 M6\nG54\n{lines}\nM30")).end.map(Option::unwrap)
}

fn bounds(lines: &str) -> [f64; 4] {
    let bounds = measures(&of("haas", &format!("G21 G90 G94 G17\nT1 M6\nG54\n{lines}\nM30"))).bounds;
    [bounds.min.x, bounds.min.y, bounds.max.x, bounds.max.y]
}

#[test]
fn coordinates_turn_about_a_centre_or_about_the_tool() {
    let start = "G0 X10. Y0. Z5.";
    close(&end(&format!("{start}\nG68 X0. Y0. R90.\nG1 X20. Y5. F100.")), &[-5.0, 20.0, 5.0]);
    close(&end(&format!("{start}\nG68 R90.\nG1 X20. F100.")), &[10.0, 10.0, 5.0]);
    // A distance turns with the axes; what follows G69 does not.
    close(&end(&format!("{start}\nG68 X0. Y0. R90.\nG91 G1 X20. F100.")), &[10.0, 20.0, 5.0]);
    close(&end(&format!("{start}\nG68 X0. Y0. R90.\nG1 X20. Y0. F100.\nG69\nX1. Y2.")), &[1.0, 2.0, 5.0]);
    // Without a point the angle counts thousandths of a degree.
    close(&end(&format!("{start}\nG68 X0. Y0. R90000\nG1 X20. Y5. F100.")), &[-5.0, 20.0, 5.0]);
    // Centres of arcs turn, too.
    let arc = format!("{start}\nG68 X0. Y0. R90.\nG1 X10. Y0. F100.\nG3 X-10. Y0. I-10.");
    close(&bounds(&arc), &[-10.0, -10.0, 10.0, 10.0]);
    close(&end(&arc), &[0.0, -10.0, 5.0]);
}

#[test]
fn scales_and_mirrors_keep_circles() {
    let start = "G0 X10. Y0. Z5.";
    close(&end(&format!("{start}\nG51 X0. Y0. Z0. P2.\nG1 X20. Y5. F100.")), &[40.0, 10.0, 5.0]);
    close(
        &end(&format!("{start}\nG51 X10. Y0. Z5. P0.5\nG3 X30. Y0. R10. F100.\nG50\nG1 X1.")),
        &[1.0, 0.0, 5.0],
    );
    let mirrored = format!("{start}\nG101 X0.\nG1 X10. Y0. F100.\nG3 X-10. Y0. R10.\nG100");
    // The arc over the top stays over the top, and runs the other way round.
    close(&bounds(&mirrored), &[-10.0, 0.0, 10.0, 10.0]);
    let fanuc = "G21 G90 G94 G17\nG0 X10. Y0. Z5.\nG51 X0. Y0. Z0. P2000\nG1 X20. F100.\nM30";
    let reading = of("fanuc", fanuc);
    close(&reading.end.map(Option::unwrap), &[40.0, 0.0, 5.0]);
    assert!(reading.notes.iter().any(|note| matches!(note, Note::ScaleAssumed { line: 3, .. })));
    let turned = format!("{start}\nG51 X0. Y0. Z0. P2.\nG68 X10. Y0. R90.\nG1 X20. Y0. F100.");
    close(&end(&turned), &[20.0, 20.0, 5.0]);
}

#[test]
fn polar_words_make_circles_of_holes() {
    let holes = "G0 X0. Y0. Z5.\nG16\nG81 X50. Y0. Z-5. R2. F100.\nG91 Y60. L5\nG80 G15 G90\nG0 X0. Y0.";
    let reading = of("haas", &format!("G21 G90 G94 G17\nT1 M6\nG54\n{holes}\nM30"));
    let bounds = measures(&reading).bounds;
    let high = 50.0 * 60.0f64.to_radians().sin();
    close(&[bounds.min.x, bounds.max.x, bounds.min.y, bounds.max.y], &[-50.0, 50.0, -high, high]);
    close(&end("G0 X0. Y0. Z5.\nG16\nG1 X20. Y30. F100.\nG15"), &[10.0 * 3.0f64.sqrt(), 10.0, 5.0]);
}

#[test]
fn what_a_turn_leaves_open_is_refused() {
    let start = "G21 G90 G94 G17\nG0 X0. Y0. Z5.\n";
    for (line, fault) in [
        ("G68 X0. Y0.", Fault::Missing('R')),
        ("G91 G68 R10.", Fault::AtMachine),
        ("G68 X0. Y0. Z0. I1. J0. K0. R10.", Fault::NotRead),
        ("G51 X0. Y0.", Fault::Missing('P')),
        ("G101", Fault::NoAxis),
        ("G91 G101 X0.", Fault::IncrementalCenter),
    ] {
        assert_eq!(faults("haas", &format!("{start}{line}\nM30"))[0].2, fault, "{line}");
    }
    let arc = format!("{start}G51 X0. Y0. Z0. I2. J1. K1.\nG3 X10. R8. F100.\nM30");
    assert_eq!(faults("haas", &arc)[0].2, Fault::Ellipse);
}

#[test]
fn radius_and_angle_of_linuxcnc_are_those_about_the_zero() {
    let end = |lines: &str| of("linuxcnc", &format!("G21 G90 G94 G17\n{lines}\nM2")).end.map(Option::unwrap);
    close(&end("G0 X0 Y0 Z5\nG1 @20 ^30 F100"), &[10.0 * 3.0f64.sqrt(), 10.0, 5.0]);
    close(&end("G0 X0 Y10 Z5\nG1 ^0 F100\n@4"), &[4.0, 0.0, 5.0]);
    close(&end("G0 X10 Y0 Z5\nG91 G1 ^90 F100\n@2"), &[0.0, 12.0, 5.0]);
    assert_eq!(
        faults("linuxcnc", "G0 X0 Y0 Z5\nG1 @2 F100\nM2")[0].2,
        Fault::NoValue("the tool stands at the pole")
    );
    assert_eq!(faults("linuxcnc", "G0 X0 Y0 Z5\nG1 @2 X3 F100\nM2")[0].2, Fault::Conflict);
}

#[test]
fn a_work_offset_of_linuxcnc_turns_about_its_zero() {
    let at = |lines: &str| {
        let text = format!("G21 G90 F100\nG10 L2 P1 X0 Y0 R90\nG0 X10 Y0 Z0\n{lines}\nM2\n");
        let offsets = [(1, [0.0; 3]), (2, [100.0, 0.0, 0.0])];
        reading(&ReadJob { offsets: &offsets, ..job("linuxcnc", &text) }).end.map(Option::unwrap)
    };
    close(&at("G1 Y5"), &[-5.0, 10.0, 0.0]);
    close(&at("G91 G1 X1"), &[0.0, 11.0, 0.0]);
    close(&at("G2 X20 I5"), &[0.0, 20.0, 0.0]);
    close(&at("G10 L2 P1 R0\nG1 X3 Y4"), &[3.0, 4.0, 0.0]);
    // Another work offset has a turn of its own.
    close(&at("G55 G1 X1 Y2"), &[101.0, 2.0, 0.0]);
    close(&at("G10 L2 P2 R180\nG55 G1 X1 Y2\nG54 G1 Y3"), &[-3.0, -2.0, 0.0]);
    let fault = |lines: &str| {
        let text = format!("G21 G90 F100\nG0 X0 Y0 Z0\n{lines}\nM2\n");
        faults("linuxcnc", &text)[0].2
    };
    assert_eq!(fault("G10 L20 P1 X0 R30"), Fault::UnusedWord);
    assert_eq!(fault("G10 L2 P1 R30\nG92 X5"), Fault::ShiftInTurn);
    assert_eq!(fault("G52 X5\nG10 L2 P1 R30"), Fault::ShiftInTurn);
    assert_eq!(fault("G10 L2 P1 R30\nG18 G2 X10 I5"), Fault::Ellipse);
}

#[test]
fn a_level_plane_moves_the_zero_alone() {
    let at = |lines: &str| {
        let text = format!("G21 G90\nG0 X1. Y2. Z3.\n{lines}\nM30\n");
        of("fanuc", &text).end.map(Option::unwrap)
    };
    close(&at("G68.2 X10. Y20. Z30. I0. J0. K0.\nG53.1\nG0 X1.\nG1 Y1. Z1. F100."), &[11.0, 21.0, 31.0]);
    close(&at("G68.2 X10. Y20. Z30. I0 J0 K0\nG69\nG0 X1. Y1. Z1.\nX4."), &[4.0, 1.0, 1.0]);
    let fault = |lines: &str| faults("fanuc", &format!("G21 G90\nG0 X1. Y2. Z3.\n{lines}\nM30\n"))[0].2;
    assert_eq!(fault("G68.2 X0 Y0 Z0 I0 J90. K0"), Fault::Tilted);
    assert_eq!(fault("G51 X0. Y0. Z0. P2.\nG68.2 I0 J0 K0"), Fault::Conflict);
    assert_eq!(fault("G91 G68.2 X1. I0 J0 K0"), Fault::IncrementalCenter);
    assert_eq!(fault("G68.2 I0 J0 K0\nG68 X0 Y0 R30."), Fault::Conflict);
    assert_eq!(faults("haas", "G21\nG68.2 I0 J0 K0\nM30\n")[0].2, Fault::NotRead);
}
