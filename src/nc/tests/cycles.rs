//! Canned cycles against the sums of their moves.

use super::*;

#[test]
fn each_cycle_makes_its_own_moves() {
    let at = "G21 G90\nG0 X0. Y0. Z10.\nG98";
    // From Z10 over X10 to R1, down to Z-5 and back to Z10.
    for (words, cut, rapid) in [
        ("G81 X10. Z-5. R1. F100.", 6.0, 10.0 + 9.0 + 15.0),
        ("G82 X10. Z-5. R1. P500 F100.", 6.0, 10.0 + 9.0 + 15.0),
        ("G99 G81 X10. Z-5. R1. F100.", 6.0, 10.0 + 9.0 + 6.0),
        ("G85 X10. Z-5. R1. F100.", 12.0, 10.0 + 9.0 + 9.0),
        ("G89 X10. Z-5. R1. F100.", 12.0, 10.0 + 9.0 + 9.0),
        ("G84 X10. Z-5. R1. F100.", 12.0, 10.0 + 9.0 + 9.0),
        ("G86 X10. Z-5. R1. F100.", 6.0, 10.0 + 9.0 + 15.0),
        ("G81 X10. Z-5. R1. F100.\nX20.\nG80", 12.0, 2.0 * (10.0 + 9.0 + 15.0)),
        ("G91 G81 X10. Z-6. R-9. F100. K3", 18.0, 3.0 * (10.0 + 9.0 + 15.0)),
        ("G81 Z-5. R1. F100.", 6.0, 9.0 + 15.0),
    ] {
        close(&lengths("fanuc", &format!("{at}\n{words}\nM30\n")), &[cut, rapid]);
    }
}

#[test]
fn a_tool_below_r_rises_before_it_crosses_the_part_on_linuxcnc() {
    // Up from Z-20 to R-5, over X10 at this height, down to Z-30 and back to R.
    let text = "G21 G90 G94\nG0 X0 Y0 Z-20\nG98 G81 X10 Z-30 R-5 F100\nG80\nM2\n";
    let reading = reading(&ReadJob { start: [Some(0.0); 3], ..job("linuxcnc", text) });
    let measures = measures(&reading);
    close(&[measures.cutting_length_mm, measures.rapid_length_mm], &[25.0, 20.0 + 15.0 + 10.0 + 25.0]);
}

#[test]
fn pecking_rapids_down_its_own_hole() {
    // Pecks to -1 and -3, then the bottom at -5: two ways out to R and back to 1 mm above the peck.
    let text = "G21 G90\nG0 X0. Y0. Z10.\nG98 G83 Z-5. R1. Q2. F100.\nM30\n";
    let reading = of("fanuc", text);
    close(&lengths("fanuc", text), &[2.0 + 3.0 + 3.0, 9.0 + (2.0 + 1.0) + (4.0 + 3.0) + 15.0]);
    assert!(reading.notes.contains(&Note::PeckClearance { line: 3, mm: 1.0 }));
    let chips = text.replace("G83", "G73");
    close(&lengths("fanuc", &chips), &[8.0, 9.0 + 1.0 + 1.0 + 15.0]);
}

#[test]
fn a_cycle_without_its_words_is_refused() {
    let of = |words: &str| {
        let text = format!("G21 G90\nG0 X0. Y0. Z10.\n{words}\nM30\n");
        faults("haas", &text).into_iter().map(|(_, _, fault)| fault).collect::<Vec<_>>()
    };
    assert_eq!(of("G81 X1. Z-5. F100."), [Fault::Missing('R')]);
    assert_eq!(of("G83 X1. Z-5. R1. F100."), [Fault::Missing('Q')]);
    assert_eq!(of("G81 X1. Z5. R1. F100."), [Fault::CycleUpward]);
    assert_eq!(of("G87 X1. Z-5. R1. F100."), [Fault::NotRead]);
    assert_eq!(of("G81 X1. Z-5. R1."), [Fault::NoFeed]);
}

#[test]
fn a_cycle_along_a_turned_axis_is_refused() {
    let program = |turn: &str| {
        format!("G21 G90 G94 F100\nG10 L2 P1 R{turn} X0 Y0 Z0\nG0 X1 Y5 Z5\nG18 G81 X1 Z2 Y-2 R1\nG80\nM2\n")
    };
    for turn in ["30", "90", "180"] {
        let found = faults("linuxcnc", &program(turn));
        assert!(found.iter().any(|(_, _, fault)| *fault == Fault::TiltedCycle), "{turn}: {found:?}");
    }
    of("linuxcnc", &program("0"));
}

#[test]
fn a_depth_of_whole_pecks_has_no_further_peck() {
    let text = "G20 G90 G94 F10 G0 X6 Y5 Z5\nG83 X6 Y5 Z-2 R4 Q1.5\nG80\nM2\n";
    let cuts = of("linuxcnc", text)
        .toolpath
        .moves()
        .filter(|own| matches!(own, toolpathd_core::toolpath::Move::Feed { .. }))
        .count();
    assert_eq!(cuts, 4);
}
