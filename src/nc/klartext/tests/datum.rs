//! Shifts, mirrors, turns, scalings and presets.

use std::f64::consts::PI;

use super::*;
use crate::notes::Note;

const SHIFT: &str = "CYCL DEF 7.0 DATUM SHIFT\nCYCL DEF 7.1 X+10\nCYCL DEF 7.2 Y+20\n";

#[test]
fn shifts_add_and_end_along_each_axis() {
    close(&end(&format!("{SHIFT}L X+1 Y+1")), &[11.0, 21.0, 0.0]);
    close(&end(&format!("{SHIFT}CYCL DEF 7.0 N\nCYCL DEF 7.1 IX+5\nL X+1 Y+1")), &[16.0, 21.0, 0.0]);
    close(&end(&format!("{SHIFT}CYCL DEF 7.0 N\nCYCL DEF 7.1 X+0\nL X+1 Y+1")), &[1.0, 21.0, 0.0]);
    close(&end("TRANS DATUM AXIS X+10 Z-1\nL X+1 Z+0\nTRANS DATUM RESET\nL Y+3 IX+0"), &[11.0, 3.0, -1.0]);
    close(&end(&format!("{SHIFT}L IX+1 IY+1")), &[1.0, 1.0, 0.0]);
}

#[test]
fn cycles_act_in_the_order_of_their_definitions() {
    let turn = "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\n";
    close(&end(&format!("{SHIFT}{turn}L X+5 Y+1")), &[9.0, 25.0, 0.0]);
    close(&end(&format!("{turn}{SHIFT}L X+5 Y+1")), &[-21.0, 15.0, 0.0]);
    close(&end(&format!("{turn}CYCL DEF 10.0 D\nCYCL DEF 10.1 IROT+90\nL X+5 Y+1")), &[-5.0, -1.0, 0.0]);
    close(&end(&format!("{turn}CYCL DEF 10.0 D\nCYCL DEF 10.1 ROT+0\nL X+5 Y+1")), &[5.0, 1.0, 0.0]);
    let reset = "CYCL DEF 7.0 N\nCYCL DEF 7.1 X+0\nCYCL DEF 7.2 Y+0\n";
    close(&end(&format!("{SHIFT}{turn}{reset}L X+5 Y+1")), &[-1.0, 5.0, 0.0]);
    close(
        &end(&format!("{SHIFT}{turn}{reset}CYCL DEF 10.0\nCYCL DEF 10.1 ROT+0\nL X+5 Y+1")),
        &[5.0, 1.0, 0.0],
    );
    // The earlier kind comes again: where it acts is not certain.
    let again = format!("{SHIFT}{turn}CYCL DEF 7.0 N\nCYCL DEF 7.1 X+30\nL X+5 F100");
    assert_eq!(faults(&again)[0], (10, "CYCL DEF 7.1 X+30".into(), Fault::NotRead));
}

#[test]
fn mirrors_and_scalings_change_arcs() {
    let arc = "CC X+10 Y+0\nC X+10 Y+10 DR-";
    close(&[cut(&format!("CYCL DEF 8.0 M\nCYCL DEF 8.1 Y\n{arc}"))], &[5.0 * PI]);
    close(&end(&format!("CYCL DEF 8.0 M\nCYCL DEF 8.1 Y\n{arc}")), &[10.0, -10.0, 0.0]);
    close(
        &end(&format!("CYCL DEF 8.0 M\nCYCL DEF 8.1 X Y\n{arc}\nCYCL DEF 8.0\nCYCL DEF 8.1\nL X+3 Y+3")),
        &[3.0, 3.0, 0.0],
    );
    let scaled = of(&format!("CYCL DEF 11.0 SCALING\nCYCL DEF 11.1 SCL 0.5\n{arc}"));
    close(&[measures(&scaled).cutting_length_mm], &[2.5 * PI]);
    assert_eq!(scaled.notes, [Note::ScalesAllAxes { line: 5 }]);
    close(&end("CYCL DEF 26.0 S\nCYCL DEF 26.1 X2 Y0.5 CCX+10 CCY+20\nL X+15 Y+30"), &[20.0, 25.0, 0.0]);
    let ellipse = format!("CYCL DEF 26.0 S\nCYCL DEF 26.1 X2\n{arc}");
    assert_eq!(faults(&ellipse)[0].2, Fault::Ellipse);
}

#[test]
fn polar_ends_turn_with_the_datum() {
    let turn = "CYCL DEF 10.0 ROTATION\nCYCL DEF 10.1 ROT+90\n";
    close(&end(&format!("{turn}CC X+0 Y+0\nLP PR+10 PA+0\nLP IPA+30\nLP PA+90")), &[-10.0, 0.0, 0.0]);
    close(&end(&format!("{turn}L X+10\nCC X+0 Y+0\nCP IPA+90 IZ-1 DR+")), &[-10.0, 0.0, -1.0]);
    let mirror = "CYCL DEF 8.0\nCYCL DEF 8.1 X\n";
    close(&end(&format!("{mirror}L X+10\nCC X+0 Y+0\nCP IPA+90 DR+\nLP IPA+90")), &[10.0, 0.0, 0.0]);
    close(&[cut(&format!("{mirror}L X+10\nCC X+0 Y+0\nCP IPA+90 DR+"))], &[10.0 + 5.0 * PI]);
}

#[test]
fn a_preset_ends_the_shifts_and_loses_the_place_unless_zeros_are_given() {
    let preset = "CYCL DEF 247 DATUM SETTING ~\n Q339=+2 ;DATUM NUMBER\n";
    let text = framed(&format!("L X+5\n{SHIFT}{preset}L X+1 Y+1 Z+1 FMAX"));
    let unknown = whole(&text);
    assert_eq!((unknown.end, unknown.work_offset), ([Some(1.0); 3], 2));
    assert!(matches!(&unknown.notes[0], Note::UnrelatedOffset { offset, .. } if offset == "preset 2"));
    let offsets = [(1, [-100.0, 0.0, -50.0]), (2, [-80.0, 0.0, -50.0])];
    let known = read(&ReadJob { offsets: &offsets, ..job(&text) }, &Budget::unlimited()).unwrap();
    assert_eq!(known.end, [Some(21.0), Some(1.0), Some(1.0)]);
    assert_eq!(of("CYCL DEF 247 X ~\nQ339=1\nL X+5").end[0], Some(5.0));
}

#[test]
fn a_pole_ends_with_the_datum_in_which_it_lies() {
    assert_eq!(faults(&format!("CC X+5 Y+0\n{SHIFT}C X+0 Y+0 DR+"))[0].2, Fault::Lacks("CC"));
}

#[test]
fn angles_of_a_level_plane_are_zero() {
    for plane in [
        "PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY SEQ-",
        "CYCL DEF 19.0 WORKING PLANE\nCYCL DEF 19.1 A+0 B+0 C+0",
    ] {
        close(&end(&format!("L X+5\n{plane}\nL A+Q120 C+Q122 R0 FMAX\nL Y+3 B+Q121")), &[5.0, 3.0, 0.0]);
    }
    for lines in [
        "L A+Q120 C+Q122 FMAX",
        "PLANE RESET STAY\nL A+Q120 FMAX",
        "PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY\nCYCL DEF 19.0 W\nCYCL DEF 19.1\nL A+Q120 FMAX",
        "PLANE SPATIAL SPA+0 SPB+0 SPC+0 STAY\nL X+Q119",
    ] {
        assert_eq!(faults(lines)[0].2, Fault::AtMachine, "{lines}");
    }
}
