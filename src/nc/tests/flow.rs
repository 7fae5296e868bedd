//! Calls, loops, jumps and variables.

use super::*;

fn cut(dialect: &str, text: &str) -> f64 {
    lengths(dialect, text)[0]
}

#[test]
fn subprograms_run_as_often_as_they_are_called() {
    let sub = "O1000\nG91 G1 X2. F60.\nG90\nM99\n%\n";
    let head = "%\nO1\nG21 G90\nG0 X0. Y0. Z0.\n";
    for (call, length) in
        [("M98 P1000", 2.0), ("M98 P1000 L3", 6.0), ("M98 P51000", 10.0), ("G65 P1000 L2", 4.0)]
    {
        assert_eq!(cut("fanuc", &format!("{head}{call}\nM30\n{sub}")), length, "{call}");
    }
    let local = format!("{head}M97 P100 L2\nM30\nN100 G91 G1 X3. F60.\nG90\nM99\n%\n");
    assert_eq!(cut("haas", &local), 6.0);
    let oword =
        "G21\nO100 sub\nG91 G1 X#1 F60\nG90\nO100 endsub\nG0 X0 Y0 Z0\nO100 call [2*3]\nO100 call [1]\nM2\n";
    assert_eq!(cut("linuxcnc", oword), 7.0);
    let open = format!("{head}M98 P1000\nM30\nO1000\nG91 G1 X2. F60.\n%\n");
    assert_eq!(faults("fanuc", &open), [(5, "M98 P1000".into(), Fault::OpenCall)]);
    assert_eq!(faults("fanuc", &format!("{head}M98 P7\nM30\n%\n"))[0].2, Fault::NoProgram);
    assert_eq!(faults("fanuc", &format!("{head}M98 P1\nM30\n%\n"))[0].2, Fault::DeepCalls(16));
}

#[test]
fn loops_and_branches_of_both_languages_run() {
    let fanuc = "O1\nG21 G90\nG0 X0. Y0. Z0.\n#1=0\nWHILE [#1 LT 5] DO1\nG91 G1 X1. F60.\n#1=#1+1\nEND1\nIF [#1 NE 5] GOTO 99\nG1 X[#1*2]\nIF [#1 EQ 5] THEN #2=3\nX#2\nN99 G90\nM30\n";
    assert_eq!(cut("fanuc", fanuc), 5.0 + 10.0 + 3.0);
    let jump =
        "G21\nG0 X0. Y0. Z0.\n#1=0\nN5 G91 G1 X1. F60.\n#1=#1+1\nIF [#1 LT 4] GOTO5\nGOTO 9\nX100.\nN9 M30\n";
    assert_eq!(cut("haas", jump), 4.0);
    let o_words = "G21 G91\nG92 X0 Y0 Z0\n#1=0\no1 while [#1 lt 3]\nG1 X1 F60\n#1=[#1+1]\no1 endwhile\no2 do\n#1=[#1-1]\nX1\no2 while [#1 gt 0]\no3 repeat [4]\nX1\no4 if [#1 eq 0]\no3 break\no4 endif\no3 endrepeat\no5 if [#1 gt 5]\nX100\no5 elseif [#1 eq 0]\nX2\no5 else\nX200\no5 endif\n#<a>=7\nX#<a>\nM2\n";
    assert_eq!(cut("linuxcnc", o_words), 3.0 + 3.0 + 1.0 + 2.0 + 7.0);
}

#[test]
fn endless_programs_end_in_a_refusal_or_after_one_run() {
    let text = "G21\nN1 G0 X0. Y0. Z0.\nGOTO 1\nM30\n";
    assert!(matches!(faults("fanuc", text)[0].2, Fault::Endless(_)));
    let bar = "G21\nG0 X0. Y0. Z0.\nG1 X1. F60.\nM99\n";
    let reading = of("fanuc", bar);
    assert!(reading.notes.contains(&Note::RunsAgain { line: 4 }));
    assert_eq!(faults("fanuc", "G21\nG0 X#500\nM30\n"), [(2, "X#500".into(), Fault::AtMachine)]);
    assert_eq!(faults("fanuc", "#3000=1(STOP)\nM30\n")[0].2, Fault::Alarm);
    assert_eq!(faults("fanuc", "GOTO 7\nM30\n")[0].2, Fault::NoLabel);
    assert_eq!(faults("fanuc", "WHILE [1 EQ 2] DO1\nM30\n")[0].2, Fault::OpenLoop);
}

#[test]
fn optional_blocks_run_unless_they_are_skipped() {
    let text = "G21\nG0 X0 Y0 Z0\n/G1 X5 F60\nG1 X10 F60\nM2\n";
    let skips = ReadJob { skips_optional: true, ..job("linuxcnc", text) };
    assert_eq!((of("linuxcnc", text).lines, reading(&skips).lines), (vec![3, 4], vec![4]));
}

#[test]
fn arguments_of_a_macro_are_its_own_and_the_callers_variables_stay() {
    // A, B, C, I, X and Z are #1 to #4, #24 and #26; the caller's #1 is another.
    let text = "%\nO1\nG21 G90\nG0 X0. Y0. Z0.\n#1=100.\nG65 P9 A1. B2. C3. I4. X5. Z6.\nG91 G1 X#1 F60.\nM30\nO9\nG91 G1 F60. X[#1+#2+#3+#4+#24+#26]\n#1=7.\nY#1\nG90\nM99\n%\n";
    assert_eq!(of("fanuc", text).end, [Some(121.0), Some(7.0), Some(0.0)]);
    // A variable that no argument sets is vacant: its word counts as absent.
    let vacant = text.replace(" Z6.", "").replace("+#26]", "]\nZ#26");
    assert_eq!(of("fanuc", &vacant).end, [Some(115.0), Some(7.0), Some(0.0)]);
    assert_eq!(faults("fanuc", &text.replace("A1.", "A1"))[0], (6, "A1".into(), Fault::NoPoint));
    assert_eq!(faults("fanuc", "G21\nG66 P9 A1.\nM30\n")[0].2, Fault::NotRead);
}

#[test]
fn a_subroutine_gives_a_value_back() {
    // LinuxCNC's interpreter ends at the same places.
    let text = "G21 G90 F100\nG0 X0 Y0 Z0\no1 sub\no1 return [#1*2]\nG1 X99\no1 endsub\no2 sub\no2 endsub [7]\no3 sub\no3 endsub\no1 call [4]\nG1 X[#<_value>] Y[#<_value_returned>]\no2 call\nX[#<_value>]\no3 call\nZ[#<_value>+#<_value_returned>-3]\nM2\n";
    assert_eq!(of("linuxcnc", text).end, [Some(7.0), Some(1.0), Some(-3.0)]);
}

#[test]
fn a_saved_modal_state_comes_back() {
    let start = "G21 G90 G17 F100 S500 M3\nG0 X0 Y0 Z0";
    let end = |lines: &str| of("linuxcnc", &format!("{start}\n{lines}\nM2\n")).end[0];
    // The motion in force is no part of the state.
    assert_eq!(end("M70\nG91 G20 G18 G1 X1 F5\nM72\nX30"), Some(30.0));
    let sub = "o1 sub\nM73\nG91 G20 F1\nG1 X1\no1 endsub\no1 call";
    assert_eq!(end(&format!("{sub}\nX30")), Some(30.0));
    assert_eq!(end(&format!("{}\nX1", sub.replace("M73", "M70"))), Some(2.0 * 25.4));
    let measured = measures(&of("linuxcnc", &format!("{start}\nM70\nF5\nM72\nG1 X10\nM2\n")));
    close(&[measured.cutting_time_s.unwrap()], &[6.0]);
    let fault = |lines: &str| faults("linuxcnc", &format!("{start}\n{lines}\nM2\n"))[0].2;
    assert_eq!(fault("M72"), Fault::NothingSaved);
    assert_eq!(fault("M70\nM71\nM72"), Fault::NothingSaved);
    assert_eq!(fault("M70\no1 sub\nM72\no1 endsub\no1 call"), Fault::NothingSaved);
    assert_eq!(fault("G1 X1 M70"), Fault::Conflict);
}

/// The end of a program along X, Y and Z.
fn end(dialect: &str, text: &str) -> [Option<f64>; 3] {
    of(dialect, text).end
}

#[test]
fn all_words_beside_g65_are_arguments() {
    let macros = |arguments: &str, body: &str| {
        let main = format!("G21 G90 G0 X0. Y0. Z5.\nG1 Z-2. F100.\nG65 P9010 {arguments}\nG1 X50.\nM30\n");
        of("fanuc", &format!("{main}O9010\n{body}\nM99\n"))
    };
    for (argument, variable) in [("S8.", 19), ("T8.", 20), ("F8.", 9), ("D8.", 7), ("H8.", 11), ("A8.", 1)] {
        let program = macros(argument, &format!("G1 Z-#{variable}"));
        assert_eq!(program.end, [Some(50.0), Some(0.0), Some(-8.0)], "{argument}");
        // No word acts on the caller.
        assert!(program.feeds.iter().all(|own| own.feed_mm_per_min == 100.0), "{:?}", program.feeds);
    }
}

#[test]
fn a_bare_g_word_and_what_is_no_word_end_no_reading() {
    for dialect in ["fanuc", "haas", "mazak", "mach4"] {
        assert_eq!(end(dialect, "G21 G90 G0 X1. Y1. Z1.\nG1\nX2. F100.\nM30\n")[0], Some(2.0));
        for line in ["G", "E", "EN", "END", "/G1", "N1 G1", "I", "W", "D"] {
            let program = format!("G21 G90 G0 X1. Y1. Z1.\n{line}");
            let _ = crate::read(&job(dialect, &program), &toolpathd_core::budget::Budget::unlimited());
        }
    }
}

#[test]
fn each_run_of_a_repeated_call_restores_its_modes() {
    let repeated = "G21 G90 G94 G0 X0 Y0 Z0\nG1 F100\nM98 P1 L3\nG1 X1\nM2\nO1\nG1 X2\nM73\nG91 G1 X2\nM99\n";
    // Of 2, 4, 2, 4, 2, 4 and the way back to 1.
    assert_eq!(end("linuxcnc", repeated)[0], Some(1.0));
    close(&[lengths("linuxcnc", repeated)[0]], &[2.0 * 6.0 + 3.0]);
    let saved_again =
        "G21 G90 G94 G0 X5 Y0 Z0\nG1 F100\no1 sub\nM73\nM70\nG91\nG1 X1\no1 endsub\no1 call\nG1 X10\nM2\n";
    assert_eq!(end("linuxcnc", saved_again)[0], Some(10.0));
}

#[test]
fn g92_3_brings_back_the_last_shift_of_g92() {
    let start = "G21 G90 G94 F100 G0 X0 Y0 Z0\nG1 X6\n";
    assert_eq!(end("linuxcnc", &format!("{start}G92 X1\nG92.3\nG1 X-2\nM2\n"))[0], Some(3.0));
    let twice = format!("{start}G92 X1\nG92.2\nG92 Y2\nG92.3\nG1 X-2\nM2\n");
    assert_eq!(end("linuxcnc", &twice)[0], Some(3.0));
}

#[test]
fn before_the_first_call_nothing_is_returned() {
    let text = "G21 G90 G94 F100 G0 X5 Y0 Z0\nG1 X[3+#<_value>+#<_value_returned>]\nM2\n";
    assert_eq!(end("linuxcnc", text)[0], Some(3.0));
}
