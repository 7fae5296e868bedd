//! APPR and DEP against closed forms.

use std::f64::consts::PI;

use super::*;
use crate::machine::{Correction, Cutter};

/// A cutter of radius 5 for every tool.
const FIVE: [Cutter; 1] = [Cutter { number: None, radius_mm: 5.0 }];

fn reading(lines: &str, correction: Correction<'_>) -> ReadProgram {
    let text = framed(lines);
    read(&ReadJob { correction, ..job(&text) }, &Budget::unlimited())
        .unwrap_or_else(|error| panic!("{error:?}\n{text}"))
}

/// Cuts and rapids in mm with a cutter of radius 5, and where the tool ends.
fn computed(lines: &str) -> [f64; 4] {
    let reading = reading(lines, Correction::Computed(&FIVE));
    let measures = measures(&reading);
    let [x, y, _] = reading.end.map(Option::unwrap);
    [measures.cutting_length_mm, measures.rapid_length_mm, x, y]
}

/// From (40, 10) to a contour that runs from (20, 20) to (20, 50), and out to the right.
fn led(approach: &str) -> [f64; 4] {
    computed(&format!("L X+40 Y+10 R0 FMAX\n{approach}\nL X+20 Y+50\nL X+60 R0"))
}

#[test]
fn an_approach_leads_to_the_place_beside_the_first_point() {
    let start = 40f64.hypot(10.0);
    // The centre runs along X25 on the right of the contour, and along X15 on the left.
    let right = 30.0 + 35.0;
    close(&led("APPR LT X+20 Y+20 LEN15 RR F100"), &[15.0 + right, start + 15f64.hypot(5.0), 60.0, 50.0]);
    // The auxiliary point lies 20 mm from the contour: LEN and the radius of the cutter.
    close(&led("APPR LN X+20 Y+20 LEN+15 RR F100"), &[15.0 + right, start + 10.0, 60.0, 50.0]);
    // RR with a positive radius turns clockwise, about (35, 20), from (35, 10).
    close(&led("APPR CT X+20 Y+20 CCA90 R+10 RR F100"), &[5.0 * PI + right, start + 5.0, 60.0, 50.0]);
    // RL turns counterclockwise, about (5, 20), from (5, 10); a negative radius about (25, 20).
    let left = 30.0 + 45.0;
    close(&led("APPR CT X+20 Y+20 CCA90 R+10 RL F100"), &[5.0 * PI + left, start + 35.0, 60.0, 50.0]);
    close(&led("APPR CT X+20 Y+20 CCA90 R-10 RL F100"), &[5.0 * PI + left, start + 15.0, 60.0, 50.0]);
    close(
        &led("APPR CT X+20 Y+20 CCA180 R10 RR F100"),
        &[10.0 * PI + right, start + 5f64.hypot(10.0), 60.0, 50.0],
    );
    // LCT goes to the auxiliary point at its own feed: along Y10 to (35, 10), where its arc begins.
    close(&led("APPR LCT X+20 Y+20 R10 RR F100"), &[5.0 + 5.0 * PI + right, start, 60.0, 50.0]);
}

#[test]
fn the_way_to_the_auxiliary_point_has_the_feed_of_the_block_before() {
    let lines = "L X+40 Y+10 R0 F50\nAPPR LT X+20 Y+20 LEN15 R0 F100\nL X+20 Y+50";
    let reading = of(lines);
    let slow = 40f64.hypot(10.0) + 20f64.hypot(5.0);
    let feeds: Vec<_> = reading.feeds.iter().map(|feed| (feed.feed_mm_per_min, feed.length_mm)).collect();
    close(&[feeds[0].0, feeds[0].1, feeds[1].0, feeds[1].1], &[50.0, slow, 100.0, 45.0]);
    // A rapid before leads on as a rapid; without compensation the contour itself is the path.
    let rapid = lines.replace("F50", "FMAX");
    close(&lengths(&rapid), &[45.0, slow]);
    let wear = reading_of_wear(&rapid.replace("LEN15 R0", "LEN15 RR"));
    close(&[measures(&wear).cutting_length_mm], &[45.0]);
}

fn reading_of_wear(lines: &str) -> ReadProgram {
    reading(lines, Correction::Wear)
}

#[test]
fn a_departure_leads_away_from_the_place_beside_the_last_point() {
    let out = |departure: &str| {
        let lines = format!(
            "L X+15 Y+0 R0 FMAX\nAPPR LT X+20 Y+20 LEN10 RL F100\nL X+20 Y+50\n{departure}\nL X+0 Y+0 FMAX"
        );
        let text = lines.replace("\nL X+0 Y+0 FMAX", "");
        let [cut, rapid, x, y] = computed(&text);
        // What follows starts where the departure has ended.
        close(&computed(&lines), &[cut, rapid + x.hypot(y), 0.0, 0.0]);
        [cut - 40.0, x, y]
    };
    close(&out("DEP LT LEN12.5 F100"), &[12.5, 15.0, 62.5]);
    close(&out("DEP LN LEN+20 F100"), &[20.0, -5.0, 50.0]);
    // RL turns counterclockwise, about (7, 50).
    close(&out("DEP CT CCA 180 R+8 F100"), &[8.0 * PI, -1.0, 50.0]);
    close(&out("DEP CT CCA90 R-8 F100"), &[4.0 * PI, 23.0, 58.0]);
    close(&out("DEP LCT X-20 Y+60 R+10 F100"), &[5.0 * PI + 25.0, -20.0, 60.0]);
}

#[test]
fn a_round_pocket_is_entered_and_left_by_arcs() {
    let lines = "APPR LCT X+30 Y+0 R5 RL F100\nCC X+0 Y+0\nC X+30 Y+0 DR+\nDEP LCT X+0 Y+0 R5";
    // The centre runs on a radius of 25. From the middle a tangent leads to the arc about (20, 0).
    let lead = 375f64.sqrt() + 5.0 * (PI - 0.25f64.acos());
    close(&computed(lines), &[2.0 * lead + 50.0 * PI, 0.0, 0.0, 0.0]);
    let mirror = format!("CYCL DEF 8.0 MIRROR\nCYCL DEF 8.1 Y\n{lines}");
    close(&computed(&mirror), &computed(lines));
    let mirrored = reading(&mirror, Correction::Computed(&FIVE));
    let bounds = measures(&mirrored).bounds;
    close(&[bounds.min.x, bounds.max.x, bounds.min.y, bounds.max.y], &[-25.0, 25.0, -25.0, 25.0]);
}

#[test]
fn a_plate_with_two_chamfers_is_milled_round_its_outside() {
    let text = "0 BEGIN PGM PLATE MM\n1 BLK FORM 0.1 Z X+0 Y+0 Z-20\n2 BLK FORM 0.2 X+100 Y+100 Z+0\n3 TOOL CALL 1 Z S4000\n4 L Z+50 R0 FMAX\n5 L X-10 Y-10 R0 FMAX\n6 L Z-5 R0 F1000 M3\n7 APPR LT X+5 Y+5 LEN10 RL F300\n8 L Y+95\n9 L X+95\n10 CHF 10\n11 L Y+5\n12 CHF 20\n13 L X+5\n14 DEP LT LEN10 F1000\n15 L Z+50 R0 FMAX M2\n16 END PGM PLATE MM\n";
    let computed = ReadJob { correction: Correction::Computed(&FIVE), ..job(text) };
    let reading = read(&computed, &Budget::unlimited()).unwrap();
    // Sides and chamfers of the plate, and arcs about its outside corners that turn by 270 degrees.
    let sides = 90.0 + 80.0 + 60.0 + 70.0 + 30.0 * 2f64.sqrt() + 7.5 * PI;
    let leads = [10.0, 10.0, 10f64.hypot(5.0), 55.0];
    close(&[measures(&reading).cutting_length_mm], &[sides + leads.iter().sum::<f64>()]);
    close(&reading.end.map(Option::unwrap), &[-5.0, 0.0, 50.0]);
}

#[test]
fn approaches_that_are_not_certain_are_refused() {
    let fault = |lines: &str| {
        let text = framed(lines);
        let computed = ReadJob { correction: Correction::Computed(&FIVE), ..job(&text) };
        match read(&computed, &Budget::unlimited()) {
            Err(ReadError::Refused(refusals)) => refusals[0].fault,
            other => panic!("{other:?}\n{text}"),
        }
    };
    let next = "L X+20 Y+50";
    for (lines, expected) in [
        ("APPR LT X+20 Y+20 Z-10 LEN15 RR F100", Fault::HeightInLead),
        ("APPR CT X+20 Y+20 CCA90 R+10 R0 F100", Fault::Lacks("RL or RR")),
        ("APPR LN X+20 Y+20 LEN15 F100", Fault::Lacks("RL or RR")),
        ("APPR LT X+20 Y+20 RR F100", Fault::Lacks("LEN")),
        ("APPR LT X+20 Y+20 LEN-5 RR F100", Fault::OutOfRange(-5.0)),
        ("APPR CT X+20 Y+20 R5 RR F100", Fault::Lacks("CCA")),
        ("APPR CT X+20 Y+20 CCA400 R5 RR F100", Fault::OutOfRange(400.0)),
        ("APPR LCT X+20 Y+20 RR F100", Fault::Missing('R')),
        ("APPR LCT X+20 Y+20 R5 LEN5 RR F100", Fault::UnusedWord),
        ("APPR LT X+20 Y+20 LEN15 RR FMAX", Fault::Conflict),
        ("APPR LT X+20 Y+20 LEN15 RR F100 M99", Fault::Conflict),
        ("APPR LT LEN15 RR F100", Fault::NoAxis),
        ("APPR LT X+20 Y+20 LEN15 RR F100\nM5", Fault::Lacks("the next element")),
        ("APPR LT X+20 Y+20 LEN15 RR F100\nL X+20 Y+40 R0", Fault::Conflict),
        ("APPR LT X+20 Y+20 LEN15 RR F100\nL X+20 Y+20", Fault::NoTangent),
        ("L X+26 Y+21\nAPPR LCT X+20 Y+20 R10 RR F100", Fault::NoTangent),
        ("L X+1 RL\nAPPR LT X+20 Y+20 LEN15 RR F100", Fault::Conflict),
        ("DEP LT LEN5", Fault::Lacks("an element before it")),
        ("L X+5\nDEP LN LEN5", Fault::Lacks("RL or RR")),
        ("L X+5\nDEP LT X+5 LEN5", Fault::UnusedWord),
        ("L X+5\nDEP CT CCA90 R5 FMAX", Fault::Conflict),
    ] {
        assert_eq!(fault(&format!("{lines}\n{next}")), expected, "{lines}");
    }
    assert_eq!(faults("APPR LT X+20 Y+20 LEN15 RR F100\nL X+20 Y+50")[0].2, Fault::Compensation);
}
