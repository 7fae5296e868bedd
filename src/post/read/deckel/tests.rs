use proptest::prelude::*;

use super::super::{Placed, ReadError, Reader as Steps};
use super::*;
use crate::dialects::deckel::DECKEL;
use toolpathd_core::geometry::curve::Curve;

const LIMIT_MM: f64 = 0.0015;

/// The print with most of its motions left out.
const PRINTED: &str = "&X501\nT 1 R 5 L0.000 S A A ( )\nZ\n(&X501)\nN1 G0 X+0 Y+0 Z+100\nN2 G17 T 1\n\
                       N3 G0 X-15 Y 0 Z 45\nN4 S 800\nN5 G0 Z 0\nN6 G1 X 0 F 1000\nN7 X 5 Z 1.45\n\
                       N8 X 25 Z 8.425\nN9 X 71.97 Z .87\nN10 X 77.93 Z -.47\nN11 X 80.9 Z -1.62\n\
                       N12 G0 Z 45\nN13 G0 X-15 Y 105\nN14 Z 0\nN15 G1 X 0\nN16 X 115\nN17 G0 Z 45\nN18 T 0\n\
                       N19 G0 Z+100\nN20 G0 X+0 Y+0 M30\n?\n";

fn read(text: &str) -> Result<Vec<Step>, ReadError> {
    Steps::new(text, &DECKEL, LIMIT_MM).map(|placed| placed.map(|Placed { step, .. }| step)).collect()
}

#[test]
fn the_printed_program_is_read() {
    let steps = read(PRINTED).unwrap();
    assert_eq!(steps.len(), 17);
    let place = |x, y, z| [Some(x), Some(y), Some(z)];
    assert_eq!(steps[0], Step::Rapid { from: [None; 3], to: place(0.0, 0.0, 100.0) });
    assert_eq!(steps[1], Step::Rapid { from: place(0.0, 0.0, 100.0), to: place(-15.0, 0.0, 45.0) });
    assert_eq!(steps[2], Step::Rapid { from: place(-15.0, 0.0, 45.0), to: place(-15.0, 0.0, 0.0) });
    let ends: Vec<_> = steps
        .iter()
        .filter_map(|step| match step {
            Step::Feed { along: Curve::Line(line), rate, .. } => {
                assert_eq!(rate.mm_per_min(), 1000.0);
                Some((line.end.x, line.end.y, line.end.z))
            }
            _ => None,
        })
        .collect();
    assert_eq!(ends[..4], [(0.0, 0.0, 0.0), (5.0, 0.0, 1.45), (25.0, 0.0, 8.425), (71.97, 0.0, 0.87)]);
    assert_eq!(ends[4..], [(77.93, 0.0, -0.47), (80.9, 0.0, -1.62), (0.0, 105.0, 0.0), (115.0, 105.0, 0.0)]);
    assert_eq!(steps[15], Step::Rapid { from: place(115.0, 105.0, 45.0), to: place(115.0, 105.0, 100.0) });
    assert_eq!(steps[16], Step::Rapid { from: place(115.0, 105.0, 100.0), to: place(0.0, 0.0, 100.0) });
}

#[test]
fn the_speed_may_be_absent_and_the_height_larger() {
    let text = "&X1\nT 12 R 2.5 L0.000 S A A ( )\nZ\n(&X1)\nN1 G0 X+0 Y+0 Z+120.5\nN2 G17 T 12\n\
                N3 G0 X 1 Y -2 Z 3\nN4 G1 Z -.5 F 250.5\nN5 T 0\nN6 G0 Z+120.5\nN7 G0 X+0 Y+0 M30\n?";
    let steps = read(text).unwrap();
    assert_eq!(steps.len(), 5);
    assert!(matches!(steps[2], Step::Feed { rate, .. } if rate.mm_per_min() == 250.5));
}

#[test]
fn every_change_of_the_print_is_a_fault() {
    let word = Fault::Word;
    use WordFault::{Form, Missing, Number, Order, Range, Twice, Unused};
    let cases = [
        ("&X501\nT", "&X0501\nT", 1, Fault::ProgramNumber),
        ("&X501\nT", "X501\nT", 1, Fault::ProgramNumber),
        ("&X501\nT", "&X0\nT", 1, Fault::ProgramNumber),
        ("&X501\nT", "&X10000\nT", 1, Fault::ProgramNumber),
        ("&X501\n", "\n&X501\n", 1, Fault::ProgramNumber),
        ("T 1 R 5", "T 1 R 5.0", 2, Fault::Frame(TOOL_ROW)),
        ("T 1 R 5", "T 1 R -5", 2, Fault::Frame(TOOL_ROW)),
        ("T 1 R 5", "T 1 R 0", 2, Fault::Frame(TOOL_ROW)),
        ("T 1 R 5", "T1 R 5", 2, Fault::Frame(TOOL_ROW)),
        ("T 1 R 5", "T 0 R 5", 2, Fault::Frame(TOOL_ROW)),
        ("L0.000", "L0.00", 2, Fault::Frame(TOOL_ROW)),
        ("A ( )", "A ()", 2, Fault::Frame(TOOL_ROW)),
        ("\nZ\n", "\nZ 0\n", 3, Fault::Frame("Z")),
        ("\nZ\n", "\n", 3, Fault::Frame("Z")),
        ("(&X501)", "(&X502)", 4, Fault::ProgramNumber),
        ("(&X501)", "&X501", 4, Fault::ProgramNumber),
        ("N1 G0 X+0 Y+0 Z+100", "N1 G0 X 0 Y 0 Z 100", 5, Fault::Frame(START)),
        ("N1 G0 X+0 Y+0 Z+100", "N1 G0 X+0 Y+0 Z+99", 5, Fault::Frame(START)),
        ("N1 G0 X+0 Y+0 Z+100", "N1 G0 X+0 Y+0 Z+100.0", 5, Fault::Frame(START)),
        ("N1 G0 X+0 Y+0 Z+100", "N0 G0 X+0 Y+0 Z+100", 5, Fault::BlockNumber { expected: 1 }),
        ("G17 T 1", "G17 T 2", 6, Fault::Frame(TOOL)),
        ("G17 T 1", "T 1", 6, Fault::Frame(TOOL)),
        ("N3 G0 X-15 Y 0 Z 45", "N3 G0 X-15 Z 45", 7, Fault::Frame(FIRST_RAPID)),
        ("N3 G0 X-15 Y 0 Z 45", "N3 G1 X-15 Y 0 Z 45", 7, Fault::Frame(FIRST_RAPID)),
        ("N3 G0 X-15 Y 0 Z 45", "N3 X-15 Y 0 Z 45", 7, Fault::Frame(FIRST_RAPID)),
        ("S 800", "S800", 8, word("S", Form)),
        ("S 800", "S 800.5", 8, word("S", Form)),
        ("S 800", "S 0", 8, word("S", Range)),
        ("S 800", "S 100000", 8, word("S", Range)),
        ("S 800", "M3", 8, Fault::UnknownWord('M')),
        ("N5 G0 Z 0", "N5 S 800", 9, Fault::UnknownWord('S')),
        ("N5 G0 Z 0", "N6 G0 Z 0", 9, Fault::BlockNumber { expected: 5 }),
        ("N5 G0 Z 0", "N05 G0 Z 0", 9, Fault::BlockNumber { expected: 5 }),
        ("N5 G0 Z 0", "G0 Z 0", 9, Fault::BlockNumber { expected: 5 }),
        ("N5 G0 Z 0", "", 9, Fault::BlockNumber { expected: 5 }),
        ("N5 G0 Z 0", "N5 ", 9, Fault::UnknownBlock),
        ("N5 G0 Z 0", "N5 G0 Z -0", 9, word("Z", Form)),
        ("N5 G0 Z 0", "N5 G0 Z 0 F 100", 9, word("F", Unused)),
        ("N5 G0 Z 0", "N5 G0", 9, word("X", Missing)),
        ("G1 X 0 F 1000", "G1 X 0", 10, Fault::NoFeed),
        ("G1 X 0 F 1000", "G1 X 0 F1000", 10, word("F", Form)),
        ("G1 X 0 F 1000", "G1 X 0 F 0", 10, word("F", Range)),
        ("G1 X 0 F 1000", "G1 F 1000", 10, word("X", Missing)),
        ("G1 X 0 F 1000", "G1 X 0 F -1000", 10, word("F", Form)),
        ("G1 X 0 F 1000", "G2 X 0 F 1000", 10, Fault::UnknownG(2.0)),
        ("G1 X 0 F 1000", "G01 X 0 F 1000", 10, word("G", Form)),
        ("G1 X 0 F 1000", "G1 X 0 I 5", 10, Fault::UnknownWord('I')),
        ("X 5 Z 1.45", "Z 1.45 X 5", 11, word("X", Order)),
        ("X 5 Z 1.45", "X 5 X 6", 11, word("X", Twice)),
        ("X 5 Z 1.45", "X5 Z 1.45", 11, word("X", Form)),
        ("X 5 Z 1.45", "X  5 Z 1.45", 11, word("X", Form)),
        ("X 5 Z 1.45", "X 5  Z 1.45", 11, word("X", Form)),
        ("X 5 Z 1.45", "X 5Z 1.45", 11, word("X", Number)),
        ("X 5 Z 1.45", "X+5 Z 1.45", 11, word("X", Form)),
        ("X 5 Z 1.45", "X 5. Z 1.45", 11, word("X", Form)),
        ("X 5 Z 1.45", "X 05 Z 1.45", 11, word("X", Form)),
        ("X 5 Z 1.45", "X 5 Z 1.450", 11, word("Z", Form)),
        ("X 5 Z 1.45", "X 5 Z 1.4501", 11, word("Z", Form)),
        ("X 5 Z 1.45", "X 123456.789", 11, word("X", Form)),
        ("X 5 Z 1.45", "X 5 Z 1.45 ", 11, word("Z", Form)),
        ("X 5 Z 1.45", "X 5 é", 11, Fault::UnknownWord('é')),
        ("X 5 Z 1.45", "X 5 (A)", 11, Fault::UnknownWord('(')),
        ("Z .87", "Z 0.87", 13, word("Z", Form)),
        ("Z -.47", "Z -0.47", 14, word("Z", Form)),
        ("Z -.47", "Z - .47", 14, word("Z", Form)),
        ("N18 T 0", "N18 T 1", 22, Fault::UnknownWord('T')),
        ("N18 T 0\n", "", 22, Fault::BlockNumber { expected: 18 }),
        ("G0 Z+100\n", "G0 Z 100\n", 23, Fault::Frame(UP)),
        ("G0 Z+100\nN20", "G0 Z+101\nN20", 23, Fault::Frame(UP)),
        ("X+0 Y+0 M30", "X 0 Y 0 M30", 24, Fault::Frame(END)),
        ("X+0 Y+0 M30", "X+0 Y+0", 24, Fault::Frame(END)),
        ("?\n", "", 24, Fault::Frame(MARK)),
        ("?\n", "%\n", 25, Fault::Frame(MARK)),
        ("?\n", "?\n\n", 26, Fault::AfterEnd),
        ("?\n", "?\nN21 G0 Z 0\n", 26, Fault::AfterEnd),
        ("N20 G0 X+0 Y+0 M30\n?\n", "", 23, Fault::NoEnd),
    ];
    for (from, to, line, fault) in cases {
        assert!(PRINTED.contains(from), "{from}");
        // The last place, because the first block and the last ones look alike.
        let start = if to.contains("Z 100\n") { PRINTED.rfind(from) } else { PRINTED.find(from) }.unwrap();
        let text = format!("{}{to}{}", &PRINTED[..start], &PRINTED[start + from.len()..]);
        assert_eq!(read(&text).unwrap_err(), ReadError { line, fault }, "{from} {to}");
    }
    let long = PRINTED.replacen("X 5 Z", &format!("X 5{}Z", " ".repeat(80)), 1);
    assert_eq!(read(&long).unwrap_err().fault, Fault::LongLine { limit: 80 });
    assert_eq!(read("").unwrap_err(), ReadError { line: 0, fault: Fault::NoEnd });
}

#[test]
fn a_minus_needs_no_blank_before_it() {
    assert_eq!(read(&PRINTED.replacen("Z -.47", "Z-.47", 1)), read(PRINTED));
    assert_eq!(read(&PRINTED.replace("X-15", "X -15")), read(PRINTED));
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_text_gives_steps_and_at_most_one_fault(
        text in "(?s)([GNXYZFSTM&?() \n.+-]|\nN5 |X 1|Z-|[0-9]|.){0,120}",
        kept in 0..PRINTED.len(),
    ) {
        for text in [text.clone(), format!("{}{text}", &PRINTED[..kept])] {
            let faults = Steps::new(&text, &DECKEL, LIMIT_MM).filter(|placed| placed.is_err()).count();
            prop_assert!(faults <= 1);
        }
    }
}
