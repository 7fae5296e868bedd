//! Drilling cycles and patterns.

use super::*;
use crate::notes::Note;

/// Lengths of cuts and rapids, and the pauses, of one hole from Z50 over the zero.
fn hole(call: &str) -> [f64; 3] {
    let text = framed(&format!("G0 Z50\n{call}\nG1 Z50 X1 F600"));
    let measures = measures(&text);
    let way = |call: &str| {
        let reading = of(&framed(&format!("G0 Z50\n{call}")));
        reading.end[2].unwrap_or(f64::NAN)
    };
    let last = (way(call) - 50.0).hypot(1.0);
    [measures.cutting_length_mm - last, measures.rapid_length_mm - 50.0, measures.dwell_time_s]
}

#[test]
fn each_cycle_makes_its_moves() {
    for (call, expected) in [
        ("CYCLE81(20,0,2,-10)", [12.0, 48.0 + 30.0, 0.0]),
        ("CYCLE81(20,0,2,,10)", [12.0, 78.0, 0.0]),
        ("CYCLE81(20, 0, 2, -10, , 0, 0, 10)", [12.0, 78.0, 0.0]),
        ("CYCLE83(20,0,2,-10,,-4,,0,,,1,0,,4,0.5,0.5,0,0,0,1001110)", [14.0, 78.0, 0.5]),
        ("CYCLE82(20,0,2,-10,0,1.5)", [12.0, 78.0, 1.5]),
        ("CYCLE82(20,0,2,-10,,-30)", [12.0, 78.0, 1.8]),
        ("CYCLE82(20,0,2,-10,0,0.6,0,1,12)", [12.0, 78.0, 0.6]),
        // Chips are broken by 1 mm at -4 and -8.
        ("CYCLE83(20,0,2,-10,0,-4,0,0,0.5,0,1,0)", [16.0, 78.0, 1.5]),
        ("CYCLE83(20,0,2,-10,,,4,,,,,0,,,0.5)", [14.0, 78.0, 0.0]),
        // Out to 2 mm and back to 0.6 mm above -4 and -8.
        ("CYCLE83(20,0,2,-10,0,-4,0,0,0,0.25,1,1)", [12.0 + 1.2, 48.0 + 6.0 + 5.4 + 10.0 + 9.4 + 30.0, 0.5]),
        ("CYCLE83(20,0,2,-10,0,-4,0,0,0,0,1,1,0,0,0,0,1)", [14.0, 48.0 + 6.0 + 5.0 + 10.0 + 9.0 + 30.0, 0.0]),
        ("CYCLE84(20,0,2,-10,,0.5,3,,1.25,0,400,500)", [24.0, 48.0 + 18.0, 0.5]),
        ("CYCLE840(20,0,2,-10,,0,4,3,0,8)", [24.0, 66.0, 0.0]),
        ("CYCLE840(20,0,2,-10,,1,4,3,1)", [24.0, 66.0, 1.0]),
        ("CYCLE85(20,0,2,-10,,1,300,450)", [24.0, 66.0, 1.0]),
        ("CYCLE86(20,0,2,-10,,1,3,-1,0,0,0)", [12.0, 48.0 + 1.0 + 12.0 + 18.0f64.hypot(1.0), 1.0]),
        ("CYCLE87(20,0,2,-10,,3)", [12.0, 78.0, 0.0]),
        ("CYCLE88(20,0,2,-10,,1,3)", [12.0, 78.0, 1.0]),
        ("CYCLE89(20,0,2,-10,,1)", [24.0, 66.0, 1.0]),
    ] {
        close(&hole(call), &expected);
    }
    let tap = of(&framed("G0 Z5\nCYCLE84(20,0,2,-10,,0,3,10,,0,400)"));
    assert_eq!(tap.feeds[0].feed_mm_per_min, 600.0);
    assert!(tap.notes.iter().any(|note| matches!(note, Note::Tapping { line: 5 })));
}

#[test]
fn strokes_shrink_by_their_degression() {
    // 10, 7, 4, 3, 3, then 2 and 2: each peck breaks chips by 1 mm.
    let lengths = hole("CYCLE83(20,0,2,-31,0,-10,0,3,0,0,1,0)");
    close(&lengths[..1], &[33.0 + 2.0 * 6.0]);
    // 10, 5, 2.5, 2, 0.5 with a factor of a half and a least stroke of 2.
    close(&hole("CYCLE83(20,0,2,-20,0,-10,0,-0.5,0,0,1,0,0,2)")[..1], &[22.0 + 2.0 * 4.0]);
}

#[test]
fn modal_cycles_run_behind_each_block_that_moves() {
    let lines = "G0 Z10\nMCALL CYCLE81(10,0,2,-5)\nG0 X10 Y0\nX20\nM8\nMCALL\nX30";
    close(&lengths(lines), &[14.0, 10.0 + 30.0 + 2.0 * (8.0 + 15.0)]);
    let row = "G0 Z10\nMCALL CYCLE81(10,0,2,-5)\nHOLES1(10,0,0,0,10,3)\nMCALL";
    close(&lengths(row), &[21.0, 10.0 + 30.0 + 3.0 * 23.0]);
    let circle = "G0 X10 Z10\nMCALL CYCLE81(10,0,2,-5)\nHOLES2(0,0,10,0,90,4)\nMCALL";
    let chord = 200f64.sqrt();
    close(&lengths(circle), &[28.0, 10f64.hypot(10.0) + 3.0 * chord + 4.0 * 23.0]);
    assert_eq!(end("G0 X35 Z10\nHOLES1(0,0,0,10,10,3)")[0], 10.0);
}

#[test]
fn parameters_that_contradict_are_refused() {
    for (call, name) in [
        ("CYCLE81(0,5,2,-10)", "RTP"),
        ("CYCLE81(10,0,2)", "DP"),
        ("CYCLE81(10,0,2,5)", "DP"),
        ("CYCLE81(10)", "RFP"),
        ("CYCLE81(10,0,2,-5,,,1)", "_GMODE"),
        ("CYCLE81(10,0,2,-5,,,0,2)", "_DMODE"),
        ("CYCLE81(10,0,2,-5,,,0,1,112)", "_AMODE"),
        ("CYCLE83(10,0,2,-5,,-9)", "FDEP"),
        ("CYCLE83(10,0,2,-5,,-1,,2)", "_DAM"),
        ("CYCLE83(10,0,2,-5,,-1,,,,,,2)", "VARI"),
        ("CYCLE84(10,0,2,-5,,,3,,,,400)", "PIT"),
        ("CYCLE84(10,0,2,-5,,,3,7,,,400)", "PIT"),
        ("CYCLE84(10,0,2,-5,,,3,8)", "SST"),
        ("CYCLE85(10,0,2,-5)", "FFR"),
        ("HOLES1(0,0,0,0,10)", "NUM"),
        ("HOLES2(0,0,10,0,0,4,1)", "_VARI"),
        ("HOLES2(0,0,10,0,0,4,1010)", "_VARI"),
        ("HOLES2(0,0,10,0,30,4,1000)", "_VARI"),
        ("HOLES2(0,0,10,0,0,4,0,0,,,2)", "_DMODE"),
        ("HOLES1(0,0,0,0,10,3,0,0,\"2\")", "_HIDE"),
        ("CYCLE801(0,0,0,10,10,2,2,0,0,5)", "behind _VARI"),
        ("CYCLE801(0,0,0,10,10,2,2,2)", "_VARI"),
        ("CYCLE802(111111112,111111111,1,2)", "_XA"),
        ("CYCLE802(111111111,111111111,1)", "a place"),
    ] {
        let found = framed_faults(&format!("G0 Z10\n{call}\nG1 X10"));
        assert_eq!(found, [(2, call.chars().take(40).collect(), Fault::CycleParameter(name))], "{call}");
    }
}

#[test]
fn patterns_are_read_in_the_form_of_the_editor_too() {
    let drilled = |pattern: &str| {
        let text = framed(&format!("G0 Z10\nMCALL CYCLE81(10,0,2,-5)\n{pattern}\nMCALL"));
        let reading = of(&text);
        let holes = measure(&reading.toolpath, FeedRate::DEFAULT_RAPID);
        (reading.end.map(|place| place.unwrap_or(f64::NAN)), holes.cutting_length_mm / 7.0, holes.bounds)
    };
    let (end, number, _) = drilled("HOLES1(10,0,0,0,10,3,0,0,,,1)");
    assert_eq!((end, number), ([30.0, 0.0, 10.0], 3.0));
    let (end, number, bounds) = drilled("HOLES2(0,0,10,0,90,4,1000,0,,,1)");
    close(&[end[0], end[1], number, bounds.max.y], &[0.0, -10.0, 4.0, 10.0]);
    let (end, number, _) = drilled("HOLES2(0,0,10,0,45,3,2000,0,,,1)");
    close(&[end[0], end[1], number], &[0.0, 10.0, 3.0]);
    let places = "CYCLE802(111111111,111111111,-40,30,40,30,5,6,,,,,,,,,,,,,0,0,1)";
    let (end, number, bounds) = drilled(places);
    close(&[end[0], end[1], number, bounds.min.x], &[5.0, 6.0, 3.0, -40.0]);
    // Three columns and four rows; the frame leaves the two holes inside out.
    let (end, number, bounds) = drilled("CYCLE801(10,20,0,5,7,3,4,0,0,,,,,1)");
    assert!(end[0].is_nan() && end[1].is_nan() && end[2] == 10.0);
    close(&[number, bounds.max.x, bounds.max.y], &[12.0, 20.0, 41.0]);
    assert_eq!(drilled("CYCLE801(10,20,0,5,7,3,4,1)").1, 10.0);
    let (_, _, turned) = drilled("CYCLE801(10,20,90,5,7,3,4)");
    close(&[turned.min.x, turned.max.y], &[10.0 - 21.0, 30.0]);
}
