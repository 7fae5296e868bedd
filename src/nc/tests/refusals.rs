//! What is refused, with its place, and what is left alone.

use super::*;

#[test]
fn all_refusals_are_told_with_line_column_and_word() {
    let text = "G21 G90\nG0 X0 Y0 Z0\nG999 X5\nG1 X5 F100 Q7\nG2 X10\nM777\nX?\nM2\n";
    let told: Vec<_> =
        refused(&job("linuxcnc", text)).into_iter().map(|r| (r.line, r.column, r.word, r.fault)).collect();
    let expected = [
        (3, 1, "G999", Fault::UnknownCode),
        (4, 12, "Q7", Fault::UnusedWord),
        (5, 1, "G2 X10", Fault::NoCenter),
        (6, 1, "M777", Fault::UnknownCode),
        (7, 1, "X?", Fault::NoNumber),
    ];
    let expected = expected.map(|(line, column, word, fault)| (line, column, word.to_owned(), fault));
    assert_eq!(told, expected);
}

#[test]
fn what_a_control_refuses_is_refused() {
    let framed = |words: &str| format!("G21 G90\nG0 X0 Y0 Z0\n{words}\nM2\n");
    for (words, fault) in [
        ("G1 X5", Fault::NoFeed),
        ("G1 X5 F0", Fault::NoFeed),
        ("G93 G1 X5 F1\nX6", Fault::NoInverseTime),
        ("G95 G1 X5 F1", Fault::NoSpindleSpeed),
        ("G2 X10 Y0 R4 F100", Fault::SmallRadius { chord_mm: 10.0, radius_mm: 4.0 }),
        ("G2 X0 Y0 R4 F100", Fault::ClosedRadius),
        ("G2 X10 F100", Fault::NoCenter),
        ("G80\nX5", Fault::NoMotion),
        ("G41 G1 X5 F100 D1", Fault::Compensation),
        ("G68 X0 Y0 R30", Fault::UnknownCode),
        ("G1 A5 X1 F100", Fault::OtherAxis),
        ("G0 G1 X5 F100", Fault::Conflict),
        ("G1 X5 X6 F100", Fault::Twice),
        ("G4", Fault::Missing('P')),
        ("G38.2 Z-5 F100", Fault::NotRead),
        ("G90.1 G2 X10 I5 F100", Fault::Missing('J')),
        ("G92 F100", Fault::NoAxis),
        ("G52", Fault::NoAxis),
        ("G2 F100", Fault::NoCenter),
        ("M3 M3 S1000", Fault::Conflict),
        ("M3 M4 S1000", Fault::Conflict),
        ("G61 I5", Fault::UnusedWord),
    ] {
        assert_eq!(faults("linuxcnc", &framed(words))[0].2, fault, "{words}");
    }
    let mismatch = |dialect: &str, off: f64| {
        let text = format!("G21 G90\nG0 X0. Y0. Z0.\nG2 X10. Y0. I{} J0. F100.\nM2\n", 5.0 + off);
        read(&job(dialect, &text), &Budget::unlimited()).is_ok()
    };
    // The radii differ by twice what the centre is off.
    assert_eq!([0.002, 0.003, 0.02].map(|off| mismatch("grbl", off)), [true, false, false]);
    assert_eq!([0.003, 0.013, 0.02].map(|off| mismatch("linuxcnc", off)), [true, true, false]);
    assert_eq!([0.009, 0.02].map(|off| mismatch("fanuc", off)), [true, false]);
    assert_eq!(faults("linuxcnc", "G21 G0 X1 Y1 Z1\n")[0].2, Fault::NoEnd);
    assert_eq!(faults("fanuc", "G21\nG68.2 X0. Y0. I30.\nM30\n")[0].2, Fault::Tilted);
    assert_eq!(faults("fanuc", "G21\nG53.1\nM30\n")[0].2, Fault::Tilted);
    for word in ["M6 T1", "G43 H1", "G81 Z-1 R1", "G3 I-4.5 F100"] {
        assert!(!faults("grbl", &framed(word)).is_empty(), "{word}");
    }
}

#[test]
fn what_changes_nothing_is_left_alone_and_counted() {
    let text = "%\nO1 (A)\nG21 G90 G64\nM8\nG0 X0. Y0. Z0. A0.\nG187 P3 E0.1\nG1 X1. F60. D5\nM123\nM30\n%\n";
    let reading = of("haas", text);
    let left: Vec<_> = reading.left_alone.iter().map(|w| (w.word.as_str(), w.count, w.line)).collect();
    assert_eq!(
        left,
        [("A0", 1, 5), ("D", 1, 7), ("E", 1, 6), ("G187", 1, 6), ("G64", 1, 3), ("M123", 1, 8), ("P", 1, 6)]
    );
    assert_eq!(reading.n_left_alone, 7);
}

#[test]
fn centres_of_mach_are_those_that_fit() {
    let text = "G21 G90\nG0 X20. Y0. Z0.\nG2 X30. Y10. I30. J0. F100.\nM30\n";
    let reading = of("mach4", text);
    assert!(matches!(reading.notes[0], Note::CentersAssumed { line: 3 }));
    assert!((measures(&reading).bounds.max.y - 10.0).abs() < 1e-9);
}

#[test]
fn wear_compensation_is_the_centre_where_the_caller_says_so() {
    let text = "G21 G90\nG0 X0 Y0 Z0\nG41 D1 G1 X10 F100\nG40 X20\nM2\n";
    let wear = ReadJob { correction: Correction::Wear, ..job("linuxcnc", text) };
    assert!(reading(&wear).notes.contains(&Note::CompensationAsWear { line: 3 }));
}

#[test]
fn what_linuxcnc_refuses_of_o_words_and_of_data_is_refused() {
    let fault = |lines: &str| faults("linuxcnc", &format!("G21 G90\nG0 X0 Y0 Z0\n{lines}\nM2\n"))[0].2;
    for lines in [
        "o1 if [1] x\no1 endif",
        "o1 sub sub\no1 endsub",
        "o1 sub\no1 return [1] [2]\no1 endsub\no1 call",
        "o1 sub\no1 endsub\no1 call call [1]",
        "o1 repeat [2] 2]\no1 endrepeat",
        "o1 while [0] 3]\no1 endwhile",
        "o1 do x\no1 while [0]",
    ] {
        assert_eq!(fault(lines), Fault::UnusedWord, "{lines}");
    }
    assert_eq!(fault("G10 L3 P1 X1"), Fault::OutOfRange(3.0));
    assert_eq!(fault("G10 L-24.5 P1 R0"), Fault::OutOfRange(-24.5));
    assert_eq!(fault("G10 L2 P10 X1"), Fault::UnknownOffset);
    // Comments may stand there.
    let text = "G21 F100\nG0 X0 Y0 Z0\no1 if [1] (why)\nG1 X5\no1 endif ; end\nM2\n";
    assert_eq!(lengths("linuxcnc", text)[0], 5.0);
}
