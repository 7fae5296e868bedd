//! Cutter compensation against closed forms.

use std::f64::consts::PI;

use super::*;
use toolpathd_core::toolpath::Move;

/// A cutter of radius 5 for every tool.
const FIVE: [Cutter; 1] = [Cutter { number: None, radius_mm: 5.0 }];

fn computed<'a>(dialect: &str, text: &'a str) -> ReadJob<'a> {
    ReadJob { correction: Correction::Computed(&FIVE), ..job(dialect, text) }
}

fn figures(dialect: &str, text: &str) -> (f64, [f64; 4]) {
    let measures = measures(&reading(&computed(dialect, text)));
    let (min, max) = (measures.bounds.min, measures.bounds.max);
    (measures.cutting_length_mm, [min.x, min.y, max.x, max.y])
}

#[test]
fn outside_a_square_the_centre_goes_round_its_corners() {
    let text = "G21 G90 G94 G17\nT1 M6 G43 H1\nG0 X-20 Y-20 Z-1\nG1 G41 D1 X0 Y0 F500\nY40\nX40\nY0\nX0\nG40 X-20 Y-20\nM2\n";
    // On LinuxCNC the entry leads to the crossing of its own offset with that of the first side, and the way
    // out begins 5 mm below the corner.
    let (length, bounds) = figures("linuxcnc", text);
    let above = 5.0 * (2.0f64.sqrt() - 1.0);
    let sides = 40.0 - above + 3.0 * 40.0 + 3.0 * 5.0 * PI / 2.0;
    close(&[length], &[15.0f64.hypot(20.0 + above) + sides + 20.0f64.hypot(15.0)]);
    close(&bounds, &[-20.0, -20.0, 45.0, 45.0]);
    // On Fanuc the entry ends beside the start of the first side, and corners are sharp.

    let fanuc = dotted(text);
    let (length, bounds) = figures("fanuc", &fanuc);
    close(&[length], &[15.0f64.hypot(20.0) + 45.0 + 50.0 + 50.0 + 45.0 + 20.0f64.hypot(15.0)]);
    close(&bounds, &[-20.0, -20.0, 45.0, 45.0]);
}

#[test]
fn inside_a_pocket_the_centre_turns_at_crossings() {
    // Down along the normal after the entry, round the inside of a slot with round ends, and out.
    let slot = "G21 G90 G94 G17\nT1 M6 G43 H1\nG0 X20 Y10 Z5\nG1 G41 D1 X20 Y0 F500\nG4 P0.5\nG1 Z-2\nX40\nG3 X40 Y20 I0 J10\nG1 X0\nG3 X0 Y0 I0 J-10\nG1 X20\nG40 Y10\nM2\n";
    let (length, bounds) = figures("linuxcnc", slot);
    // Downward on the left lies +X: the entry ends beside its own end at (25, 0); the crossing with the first
    // side lies at (25, 5).
    close(&[length], &[5.0f64.hypot(5.0) + 7.0 + 15.0 + 5.0 * PI + 40.0 + 5.0 * PI + 20.0 + 5.0]);
    close(&bounds, &[-5.0, 5.0, 45.0, 15.0]);
    let reading = reading(&computed("linuxcnc", slot));
    assert_eq!(reading.end.map(Option::unwrap), [20.0, 10.0, -2.0]);
    // A line into an arc at an inside corner: the crossing of line and circle.
    let corner = "G21 G90 G94 G17\nG0 X-10 Y20 Z0\nG1 G41 D1 X0 Y0 F500\nX30\nG2 X50 Y20 I20 J0\nG1 Y40\nG40 X60 Y60\nM2\n";
    let path = super::reading(&computed("linuxcnc", corner)).toolpath;
    let ends: Vec<_> = path
        .moves()
        .filter_map(|own| match own {
            Move::Feed { along, .. } => Some(along.end()),
            _ => None,
        })
        .collect();
    // The circle about (50, 0) with 25; the line y = 5.
    let x = 50.0 - (625.0f64 - 25.0).sqrt();
    assert!(ends.iter().any(|end| (end.x - x).hypot(end.y - 5.0) < 1e-9), "{ends:?}");
}

#[test]
fn mirrors_exchange_the_sides_and_arcs_keep_their_distance() {
    let circle = "G0 X0 Y0 Z0\nG1 G42 D1 X20 Y0 F500\nG3 X20 Y0 I-20 J0\nG40 G1 X30 Y10\nM2\n";
    let (_, bounds) = figures("linuxcnc", &format!("G21 G90 G94 G17\nT1 M6 G43 H1\n{circle}"));
    close(&bounds, &[-25.0, -25.0, 30.0, 25.0]);
}

#[test]
fn a_cutter_that_does_not_fit_is_refused() {
    let start = "G21 G90 G94 G17\nG0 X0 Y0 Z0\nG1 G41 D1 X10 Y0 F500\n";
    for (rest, line, fault) in [
        ("G3 X10 Y6 I0 J3\nG40 G1 X0\n", 4, Fault::CutterTooLarge),
        ("X20\nY3\nX10\nG40 X0 Y0\n", 5, Fault::CutterTooLarge),
    ] {
        let text = format!("{start}{rest}M2\n");
        let refusals = refused(&computed("linuxcnc", &text));
        assert_eq!((refusals[0].line, refusals[0].fault), (line, fault), "{rest}");
    }
    let first = |text: &str| refused(&computed("linuxcnc", text))[0].fault;
    let by_arc = "G21 G0 X0. Y0. Z0.\nG41 D1\nG2 X10. I5. F100.\nM30\n";
    assert_eq!(refused(&computed("fanuc", by_arc))[0].fault, Fault::CompensationByArc);
    // LinuxCNC goes there by an arc of another radius.
    close(&[figures("linuxcnc", "G21 G0 X0 Y0 Z0\nG41 D1\nG2 X10 I5 F100\nM2\n").0], &[7.5 * PI]);
    assert_eq!(first(&format!("{start}X20\nG41 D1 X30\nM2\n")), Fault::InCompensation);
    assert_eq!(first(&format!("{start}X20\nG40\nG2 X30 I5\nM2\n")), Fault::ArcAfterCompensation);
    assert_eq!(first(&format!("{start}X20\nG28\nG40 X0\nM2\n")), Fault::InCompensation);
    assert_eq!(first("G21 G0 X0 Y0 Z0\nG41 D2.5 X1\nM2\n"), Fault::UnknownRadius);
    let none = ReadJob {
        correction: Correction::Computed(&[]),
        ..job("linuxcnc", "G21 G0 X0 Y0 Z0\nG41 D1 X1\nM2")
    };
    assert_eq!(refused(&none)[0].fault, Fault::UnknownRadius);
}

/// The text with a point behind every whole coordinate.
fn dotted(text: &str) -> String {
    let word = |word: &str| {
        let is_length = word.starts_with(['X', 'Y', 'Z']) && !word.contains('.');
        if is_length { format!("{word}.") } else { word.to_owned() }
    };
    let line = |line: &str| line.split(' ').map(word).collect::<Vec<_>>().join(" ");
    text.lines().map(line).collect::<Vec<_>>().join("\n")
}
