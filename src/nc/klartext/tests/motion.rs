//! Straight blocks, circles, polar coordinates and corners.

use std::f64::consts::{PI, SQRT_2};

use super::*;

#[test]
fn straight_blocks_are_absolute_or_incremental_along_each_axis() {
    close(&[cut("3 L X+30 Y+40 F600")], &[50.0]);
    close(&end("3 L X+10 IY-5 F600\n4 L IX+2,5 Z-1\n5 Y+7 F50\n6 IZ-1"), &[12.5, 7.0, -2.0]);
    close(&lengths("3 L Z+5 FMAX\n4 L X+10\n5 L X+20 F MAX\n6 l x+30 f50"), &[20.0, 15.0]);
    close(&end("Q1 = 5\nQL2 = 3\nL X-Q1 Y+QL2 Z-QL2"), &[-5.0, 3.0, -3.0]);
}

#[test]
fn feeds_hold_until_the_next_and_a_rapid_is_for_its_block() {
    let seconds = |lines: &str| measures(&of(lines)).cutting_time_s.unwrap();
    close(&[seconds("3 L X+10 F600\n4 L Z+5 FMAX\n5 L X+20")], &[2.0]);
    close(&[seconds("3 L X+10 F600\n4 L X+20 F AUTO")], &[1.0 + 6.0]);
    close(&[seconds("3 L X+10 FU0.1"), seconds("3 L X+10 F0.1 M136\n4 L X+20 F60 M137")], &[6.0, 16.0]);
    close(&[seconds("3 FN 0: Q10 = +600\n4 L X+10 FQ10\n5 L X+20 F Q10")], &[2.0]);
    close(&[seconds("3 TOOL CALL S2000\n4 L X+10 FU0.1\n5 TOOL CALL Z S3000 F600\n6 L X+20")], &[3.0 + 1.0]);
}

#[test]
fn a_program_in_inches_counts_feeds_in_tenths_of_an_inch() {
    let text =
        "0 BEGIN PGM T INCH\n1 TOOL CALL 1 Z S1000\n2 L X+0 Y+0 Z+0 FMAX\n3 L X+1 F100\n4 END PGM T INCH";
    let measures = measures(&whole(text));
    close(&[measures.cutting_length_mm, measures.cutting_time_s.unwrap()], &[25.4, 6.0]);
}

#[test]
fn circles_turn_about_the_pole() {
    for (lines, length) in [
        ("CC X+10 Y+0\nC X+10 Y+10 DR-", 5.0 * PI),
        ("CC X+10 Y+0\nC X+10 Y+10 DR+", 15.0 * PI),
        ("CC IX+5 IY+0\nC IX+10 IY+0 DR+", 5.0 * PI),
        ("CC X+5 Y+0\nC X+0 Y+0 DR+", 10.0 * PI),
        ("CC X+5 Y+0\nC X+0 DR-", 10.0 * PI),
        ("CC X+5 Z+0\nC X+10 Z+0 DR+", 5.0 * PI),
        ("CC Y+5 Z+0\nC Y+10 Z+0 DR-", 5.0 * PI),
        ("CC\nL X+5\nC X+0 Y+5 DR+", 5.0 + 2.5 * PI),
        ("CR X+10 Y+10 R+10 DR-", 5.0 * PI),
        ("CR X+10 Y+10 R-10 DR+ R0 F50", 15.0 * PI),
        ("CR IX+10 Y+0 R5 DR+", 5.0 * PI),
    ] {
        close(&[cut(lines)], &[length]);
    }
    // DR+ turns as G3: in ZX from X0 to X10 toward +Z, in YZ from Y0 to Y10 toward -Z.
    for (lines, low, high) in [
        ("CC X+5 Z+0\nC X+10 Z+0 DR+", 0.0, 5.0),
        ("CC Y+5 Z+0\nC Y+10 Z+0 DR-", 0.0, 5.0),
        ("CC Y+5 Z+0\nC Y+10 Z+0 DR+", -5.0, 0.0),
    ] {
        let bounds = measures(&of(lines)).bounds;
        close(&[bounds.min.z, bounds.max.z], &[low, high]);
    }
    let bounds = measures(&of("CC X+5 Y+0\nC X+10 Y+0 DR+")).bounds;
    close(&[bounds.min.y, bounds.max.y], &[-5.0, 0.0]);
}

#[test]
fn radii_may_differ_by_a_fixed_length() {
    let is_read = |off: f64| {
        let text = framed(&format!("CC X+{} Y+0\nC X+10 Y+0 DR+", 5.0 + off));
        read(&job(&text), &Budget::unlimited()).is_ok()
    };
    assert_eq!([0.007, 0.009].map(is_read), [true, false]);
}

#[test]
fn tangential_arcs_go_on_in_the_direction_of_the_element_before() {
    close(&[cut("L X+10\nCT X+20 Y+10")], &[10.0 + 5.0 * PI]);
    close(&[cut("L X+10\nCT IX+0 IY-10\nCT IX+0 IY-10")], &[10.0 + 10.0 * PI]);
    close(&[cut("CC X+10 Y+0\nC X+10 Y-10 DR+\nCT X+20 Y+0")], &[10.0 * PI]);
    close(&[cut("L X+10\nCC X+10 Y+10\nLBL 1\nCTP PR+10 PA+0")], &[10.0 + 5.0 * PI]);
}

#[test]
fn polar_ends_count_from_the_pole() {
    close(&[cut("CC X+0 Y+0\nLP PR+10 PA+0\nLP PA+90\nLP IPA+90\nLP IPR+5")], &[15.0 + 20.0 * SQRT_2]);
    close(&end("CC X+20 Y+10\nLP PR+5 PA-90 FMAX"), &[20.0, 5.0, 0.0]);
    close(&end("TOOL CALL 2 Y\nL X+0 Y+0 Z+0 FMAX\nCC X+0 Z+0\nLP PR+5 PA+90 FMAX"), &[5.0, 0.0, 0.0]);
    close(&end("TOOL CALL 2 X\nL X+0 Y+0 Z+0 FMAX\nCC\nLP PR+5 PA+90 FMAX"), &[0.0, 0.0, 5.0]);
}

#[test]
fn helices_make_whole_turns_and_parts() {
    let helix = |words: &str| format!("CC X+10 Y+0\n{words}");
    for (words, length) in [
        ("CP IPA+360 IZ+5 DR+", (20.0 * PI).hypot(5.0)),
        ("CP IPA-1080 IZ-6 DR- F50", (60.0 * PI).hypot(6.0)),
        ("CP IPA+450 Z-5 DR+", (25.0 * PI).hypot(5.0)),
        ("CP PA+270 DR+", 5.0 * PI),
        ("CP PA+270 IZ+2 DR-", (15.0 * PI).hypot(2.0)),
        ("CP PA+180 DR+", 20.0 * PI),
    ] {
        close(&[cut(&helix(words))], &[length]);
    }
    close(&end(&helix("CP IPA+450 IZ-5 DR+")), &[10.0, -10.0, -5.0]);
    close(&end(&helix("CP IPA-3600 IZ-5 DR-")), &[0.0, 0.0, -5.0]);
}

#[test]
fn polar_arcs_turn_in_the_plane_of_their_pole() {
    // From beside the surface down onto it, as CAM systems lead in.
    close(&end("L X+21 Z+8 FMAX\nCC X+13 Z+8\nCP IPA+90 DR+"), &[13.0, 0.0, 0.0]);
    close(&end("L Y-31 Z+8 FMAX\nCC Y-23 Z+8\nCP IPA+90 DR+"), &[0.0, -23.0, 0.0]);
    close(&[cut("L X+10\nCC X+20 Y+0\nCP IPA+412 DR+")], &[10.0 + 20.0 * PI * 412.0 / 360.0]);
}

#[test]
fn corners_are_rounded_or_cut() {
    close(&[cut("L X+20\nRND R5\nL Y+20")], &[30.0 + 2.5 * PI]);
    close(&[cut("L X+20\nCHF 5\nL Y+20")], &[30.0 + 5.0 * SQRT_2]);
    close(&[cut("L X+20\nRND R5 F50\nL X+20 Y+20\nRND R2\nL X+0 Y+20")], &[60.0 - 14.0 + 3.5 * PI]);
    // Two lines at 120 degrees: each loses r tan 60, and the arc turns by 120 degrees.
    let bent = "L X+20\nRND R2\nLP PR+20 PA+120";
    close(&[cut(&format!("CC X+20 Y+0\n{bent}"))], &[40.0 - 4.0 * 3f64.sqrt() + 4.0 * PI / 3.0]);
    let seconds = measures(&of("L X+20 F600\nCHF 3 F60\nL Y+20")).cutting_time_s.unwrap();
    close(&[seconds], &[34.0 / 10.0 + 3.0 * SQRT_2]);
    let seconds = measures(&of("L X+20 F600\nCHF 3\nL Y+20 F60")).cutting_time_s.unwrap();
    close(&[seconds], &[(17.0 + 3.0 * SQRT_2) / 10.0 + 17.0]);
    // Elements that go on tangentially have no corner.
    close(&[cut("L X+20\nRND R5\nL X+40")], &[40.0]);
    close(
        &[cut("L X+20\nRND R5 ; label and formula may stand between\nLBL 5\nQ1 = 20\nL Y+Q1")],
        &[30.0 + 2.5 * PI],
    );
}

#[test]
fn corners_between_lines_and_arcs_touch_both() {
    // A line toward the centre of an arc of radius 10 that it meets at a right angle.
    let length = cut("L X+10\nRND R2\nCC X+0 Y+0\nC X-10 Y+0 DR+");
    // The centre lies 2 beside the line and 8 from the centre of the arc.
    let along = 60f64.sqrt();
    let off = (2.0 / 8.0_f64).asin();
    let expected = along + 2.0 * (PI / 2.0 + off) + 10.0 * (PI - off);
    close(&[length], &[expected]);
    let arcs = "CC X+10 Y+0\nC X+20 Y+0 DR-\nRND R2\nCC X+20 Y+10\nC X+30 Y+10 DR+";
    let sharp = 15.0 * PI;
    assert!(cut(arcs) < sharp && cut(arcs) > sharp - 10.0);
    let bounds = measures(&of(arcs)).bounds;
    close(&[bounds.min.x, bounds.max.x, bounds.max.y], &[0.0, 30.0, 10.0]);
}

#[test]
fn a_mirrored_corner_is_the_mirror_of_the_corner() {
    let corner = "L X+20\nRND R5\nL Y+20\nRND R2\nCT X+10 Y+30";
    let plain = "L X+20\nRND R5\nL Y+20\nCT X+10 Y+30\nCR X+0 Y+30 R+7 DR+";
    let mirrored = format!("CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 X\n{plain}");
    close(&[cut(&mirrored)], &[cut(plain)]);
    let [x, y, _] = end(plain);
    close(&end(&mirrored)[..2], &[-x, y]);
    assert!(matches!(faults(corner)[0].2, Fault::Lacks(_)));
}

#[test]
fn places_of_the_machine_are_known_only_if_zeros_are() {
    let text = framed("L X+5\nL Z+0 R0 FMAX M91\nL X-10 Y-20 FMAX M91");
    assert_eq!(whole(&text).end, [None; 3]);
    let offsets = [(1, [-100.0, -50.0, -20.0])];
    let reading = read(&ReadJob { offsets: &offsets, ..job(&text) }, &Budget::unlimited()).unwrap();
    assert_eq!(reading.end, [Some(90.0), Some(30.0), None]);
    assert_eq!(of("L Y+0 X+1\nL X+5 FMAX M92\nL Z+3 FMAX").end, [None, Some(0.0), Some(3.0)]);
    assert_eq!(of("L Z-5\nL M140 MB MAX FMAX").end, [Some(0.0), Some(0.0), None]);
}

#[test]
fn a_tool_call_loses_the_height() {
    let reading = of("L X+5\nTOOL CALL 2 Z S500\nL X+50 FMAX\nL Z+5 FMAX\nL X+60 F100");
    close(&[measures(&reading).cutting_length_mm, measures(&reading).rapid_length_mm], &[15.0, 0.0]);
    assert_eq!(reading.tools.iter().map(|tool| tool.number).collect::<Vec<_>>(), [Some(1), Some(2)]);
    let named = of("L X+5\nTOOL CALL \"Mill_d10\" Z S500 DL+0 DR-0.1\nL X+5 Y+5 Z+5 FMAX\nL X+9");
    assert_eq!(named.tools[1].name.as_deref(), Some("Mill_d10"));
    assert_eq!(faults("TOOL CALL 2 Z S500\nL X+50 F100")[0].2, Fault::UnknownStart('Z'));
    assert_eq!(faults("L X+5 M6\nL X+50 F100")[0].2, Fault::UnknownStart('Z'));
}
