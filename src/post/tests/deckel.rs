//! The program that the paper prints, block for block (Y. H. Koo and others, 1989, Fig. 4-4).
//!
//! The print leaves out what stands between N16 and N570. Here, passes of the test's own fill the gap, so
//! that all printed numbers of blocks hold. The print shows N582 four times; they are N582 to N585. Zeros
//! that were printed badly are zeros here.

use super::*;
use crate::dialects::deckel::DECKEL;

/// The points of the wire at y = 0, as (x, z).
const FIRST_WIRE: [[f64; 2]; 20] = [
    [0.0, 0.0],
    [5.0, 1.45],
    [10.0, 3.72],
    [15.0, 6.05],
    [20.0, 7.84],
    [25.0, 8.425],
    [30.0, 7.25],
    [35.0, 4.87],
    [40.0, 2.06],
    [44.42, 0.0],
    [55.56, 0.0],
    [60.0, 2.06],
    [65.0, 4.87],
    [70.0, 7.26],
    [75.0, 8.429],
    [80.0, 7.84],
    [85.0, 6.05],
    [90.0, 3.72],
    [95.0, 1.48],
    [100.0, 0.0],
];

/// Blocks N1 to N16 of the print, with the lines before them.
const HEAD: &str = "&X501\nT 1 R 5 L0.000 S A A ( )\nZ\n(&X501)\nN1 G0 X+0 Y+0 Z+100\nN2 G17 T 1\nN3 G0 X-15 Y 0 Z 45\n\
    N4 S 800\nN5 G0 Z 0\nN6 G1 X 0 F 1000\nN7 X 5 Z 1.45\nN8 X 10 Z 3.72\nN9 X 15 Z 6.05\nN10 X 20 Z 7.84\n\
    N11 X 25 Z 8.425\nN12 X 30 Z 7.25\nN13 X 35 Z 4.87\nN14 X 40 Z 2.06\nN15 X 44.42 Z 0\nN16 X 55.56 Z 0\n";

/// Blocks N570 to N591 of the print, with the line behind them.
const TAIL: &str = "N570 X 44.42 Z 0\nN571 X 55.56 Z 0\nN572 X 60 Z 2.06\nN573 X 65 Z 4.87\nN574 X 70 Z 7.26\n\
    N575 X 75 Z 8.429\nN576 X 80 Z 7.84\nN577 X 85 Z 6.05\nN578 X 90 Z 3.72\nN579 X 95 Z 1.48\nN580 X 100 Z 0\n\
    N581 X 115\nN582 G0 Z 45\nN583 G0 X-15 Y 105\nN584 Z 0\nN585 G1 X 0\nN586 X 100 Z 0\nN587 X 115\n\
    N588 G0 Z 45\nN589 T 0\nN590 G0 Z+100\nN591 G0 X+0 Y+0 M30\n?\n";

/// Cuts along a wire in one direction, with 15 mm beside the part at both ends.
fn pass(path: &mut Builder, y: f64, wire: &[[f64; 2]]) {
    let rate = feed(1000.0);
    let at = |[x, z]: [f64; 2]| Point3::new(x, y, z);
    let (first, last) = (wire[0], wire[wire.len() - 1]);
    path.rapid(at([-15.0, 45.0])).unwrap();
    path.rapid(at([-15.0, first[1]])).unwrap();
    path.line(at(first), rate, Role::LeadIn).unwrap();
    for &point in &wire[1..] {
        path.line(at(point), rate, Role::Cut).unwrap();
    }
    path.line(at([115.0, last[1]]), rate, Role::LeadOut).unwrap();
    path.rapid(at([115.0, 45.0])).unwrap();
}

fn deckel(path: &Toolpath, tool: &Tool, cutting: &Cutting, number: u32) -> Result<String, WriteError> {
    let program = Program { number, ..Program::plain(MM) };
    let job = ProgramJob { tool: Some(tool), ..ProgramJob::plain(&program, cutting, &DECKEL) };
    write(path, &job, &Budget::unlimited()).map(|program| program.text)
}

fn dry(rpm: f64) -> Cutting {
    Cutting { coolant: Coolant::Off, spindle_rpm: Some(rpm), ..cutting() }
}

const BALL: Tool = Tool { shape: Shape::Ball, radius_mm: 5.0, number: Some(1), length_offset: None };

#[test]
fn the_printed_program_is_reproduced_block_for_block() {
    let wire = &FIRST_WIRE;
    let mut path = Toolpath::builder(Point3::new(-15.0, 0.0, 45.0));
    pass(&mut path, 0.0, wire);
    // The first pass is N3 to N27 with N4, and this one again from N559 to N582: 24 blocks each. Between them
    // 21 passes more, and one of 27 blocks, which has 23 points.
    let mut y = 1.0;
    for _ in 0..21 {
        pass(&mut path, y, wire);
        y += 1.0;
    }
    let longer: Vec<[f64; 2]> = (0..23).map(|k| [f64::from(k), f64::from(k % 3)]).collect();
    pass(&mut path, y, &longer);
    pass(&mut path, 100.0, wire);
    pass(&mut path, 105.0, &[[0.0, 0.0], [100.0, 0.0]]);
    let text = deckel(&path.finish().unwrap(), &BALL, &dry(800.0), 501).unwrap();
    assert!(text.starts_with(HEAD), "{text}");
    assert!(text.ends_with(TAIL), "{}", &text[text.len() - TAIL.len() - 100..]);
    assert_eq!(text.lines().count(), 591 + 5);
}

/// Of the second printed program: numbers below one, negative numbers, a step straight up.
#[test]
fn the_second_printed_program_has_its_numbers() {
    let points: [[f64; 2]; 14] = [
        [57.07, 5.33],
        [60.0, 5.0],
        [63.03, 4.22],
        [66.01, 3.17],
        [68.95, 1.98],
        [71.97, 0.87],
        [75.0, 0.0],
        [77.93, -0.47],
        [80.9, -1.62],
        [83.909, -2.54],
        [86.95, -3.1],
        [90.0, 0.0],
        [90.0, 5.0],
        [105.0, 5.0],
    ];
    let mut path = Toolpath::builder(Point3::new(-15.0, 0.0, 45.0));
    path.rapid(Point3::new(-15.0, 0.0, 11.38)).unwrap();
    path.line(Point3::new(0.0, 0.0, 11.38), feed(200.0), Role::LeadIn).unwrap();
    for (k, [x, z]) in points.into_iter().enumerate() {
        let role = if k == 13 { Role::LeadOut } else { Role::Cut };
        path.line(Point3::new(x, 0.0, z), feed(200.0), role).unwrap();
    }
    path.rapid(Point3::new(105.0, 0.0, 45.0)).unwrap();
    let text = deckel(&path.finish().unwrap(), &BALL, &dry(1000.0), 503).unwrap();
    let expected = "N4 S 1000\nN5 G0 Z 11.38\nN6 G1 X 0 F 200\nN7 X 57.07 Z 5.33\nN8 X 60 Z 5\nN9 X 63.03 Z 4.22\n\
        N10 X 66.01 Z 3.17\nN11 X 68.95 Z 1.98\nN12 X 71.97 Z .87\nN13 X 75 Z 0\nN14 X 77.93 Z -.47\n\
        N15 X 80.9 Z -1.62\nN16 X 83.909 Z -2.54\nN17 X 86.95 Z -3.1\nN18 X 90 Z 0\nN19 X 90 Z 5\nN20 X 105\n\
        N21 G0 Z 45\nN22 T 0\n";
    assert!(text.contains(expected), "{text}");
}

#[test]
fn what_the_paper_does_not_print_is_refused() {
    let path = sample();
    let cutting = dry(800.0);
    assert_eq!(deckel(&path, &BALL, &cutting, 1), Err(WriteError::NoDwells));
    let mist = Cutting { coolant: Coolant::Mist, ..cutting };
    assert!(matches!(deckel(&path, &BALL, &mist, 1), Err(WriteError::Missing(Missing::Coolant { .. }))));
    let error = WriteError::ProgramNumber { number: 10_000, max: 9999 };
    let mut path = Toolpath::builder(Point3::origin());
    path.line(Point3::new(1.0, 0.0, 0.0), feed(100.0), Role::Cut).unwrap();
    assert_eq!(deckel(&path.finish().unwrap(), &BALL, &cutting, 10_000), Err(error));
}
