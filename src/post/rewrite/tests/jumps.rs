//! Blocks to which a program jumps, and what stands behind them.

use super::*;

/// Blocks along an arc, each with a number.
fn numbered() -> String {
    let run = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    run.lines().enumerate().map(|(k, line)| format!("N{k} {line}\n")).collect()
}

#[test]
fn numbered_blocks_behind_a_jump_stay() {
    let arc = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    let numbered: String = arc.lines().map(|line| format!("N5 {line}\n")).collect();
    let program = format!("G0 X20 Y0 Z0\nG1 F100\nIF[#1 EQ 2]GOTO 5\nG90 G17 G1 X20 Y0 Z0\n{numbered}");
    assert_eq!(rewritten(&program), program);
    let other = program.replace("GOTO 5", "THEN #2=1");
    assert!(rewritten(&other).len() < other.len());
}

#[test]
fn a_block_to_which_the_program_jumps_back_keeps_its_number_and_its_place() {
    let numbered = numbered();
    let start = "G90 G17 G0 X20 Y0 Z0\nG1 F100\n";
    for jump in ["IF[#1 EQ 2]GOTO 20\n", "M99 P20\n", "M97 P20\n"] {
        let output = rewritten(&format!("{start}{numbered}{jump}"));
        let label = numbered.lines().nth(20).unwrap();
        assert!(output.lines().any(|line| line == label), "{output}");
        // What stands before the label is shorter. Behind it the modes are those of the jump.
        assert!(output.lines().count() < 28 && output.contains("G3"), "{output}");
    }
    let program = format!("{start}{numbered}GOTO #5\n");
    assert_eq!(rewritten(&program), program);
}

#[test]
fn a_late_jump_to_a_replaced_block_is_an_error() {
    let mut rewriter = Rewriter::new(job(&FANUC));
    let (budget, mut out) = (Budget::unlimited(), Vec::new());
    let numbered = numbered();
    rewriter
        .push(format!("G90 G17 G0 X20. Y0. Z0.\nG1 F100.\n{numbered}").as_bytes(), &mut out, &budget)
        .unwrap();
    rewriter.push(&b"(a)\n".repeat(SCANNED / 4 + 1), &mut out, &budget).unwrap();
    let late = rewriter.push(b"GOTO 20\n", &mut out, &budget);
    assert!(matches!(late, Err(RewriteError::LateJump { limit: SCANNED, .. })), "{late:?}");
}

/// How many blocks of an arc stay of a program with a loop over it. `label` begins the loop, `end` ends it.
fn kept(before: &str, label: &str, end: &str) -> usize {
    let run = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    let program = format!("{before}{label}{run}{end}M30\n");
    let output = rewritten(&program);
    let own: Vec<&str> = run.lines().collect();
    output.lines().filter(|line| own.contains(&line.trim_start_matches("G1 "))).count()
}

#[test]
fn a_loop_is_shortened_where_all_ways_to_its_label_have_its_modes() {
    let (start, loops) = ("G90 G17 G1 X20 Y0 Z0 F100\n", "#1=#1+1\nIF [#1 LT 3] GOTO 10\n");
    // The label states the position, which the loop does not keep.
    assert_eq!(kept(start, "N10 X20 Y0 Z0\n", loops), 0);
    assert_eq!(kept(start, "N10 X20 Y0 Z0\n", "G0 Z5\nG1\nIF [#1 LT 3] GOTO 10\nX0\n"), 0);
    // The program arrives under another motion, in another plane, or under increments.
    for other in ["G0 X20 Y0\n", "G18\n", "G91\n", "M98 P5\n", "G65 P5 A1\n", "X#1\n", "G41 D1\n"] {
        assert_eq!(kept(start, "N10 X20 Y0 Z0\n", &format!("{other}{loops}")), 40, "{other}");
    }
    // A way to the label that tells no modes.
    for other in ["M97 P10\n", "M99 P10\n", "GOTO 10 G91\n", "IF [#2] THEN GOTO 10\n"] {
        assert_eq!(kept(start, "N10 X20 Y0 Z0\n", &format!("{loops}{other}")), 40, "{other}");
    }
    // A jump forward over blocks with other modes.
    let over = format!("{start}IF [#1 EQ 1] GOTO 10\nG91\nX1\nG90\n");
    assert_eq!(kept(&over, "N10 X20 Y0 Z0\n", ""), 0);
    assert_eq!(kept(&over.replace("\nG90", ""), "N10 X20 Y0 Z0\n", ""), 40);
}

#[test]
fn an_inner_loop_loses_the_modes_of_its_outer_loop() {
    let start = "G90 G17 G1 X20 Y0 Z0 F100\nN1 M8\n";
    let inner = "IF [#1 LT 3] GOTO 10\n";
    assert_eq!(kept(start, "N10 X20 Y0 Z0\n", &format!("{inner}IF [#2 LT 3] GOTO 1\n")), 0);
    assert_eq!(kept(start, "N10 X20 Y0 Z0\n", &format!("{inner}G18\nIF [#2 LT 3] GOTO 1\n")), 40);
}

#[test]
fn the_modes_at_a_label_are_restored_before_a_jump_to_it() {
    let run = arc(['Z', 'X', 'Y'], 40, 1.0, 0.0);
    let program =
        format!("G90 G17 G1 X0 Y0 Z20 F100\nN10 G1 X0 Z20\n{run}IF [#1 LT 3] GOTO 10\nG0 Z50\nM30\n");
    let output = rewritten(&program);
    let lines: Vec<&str> = output.lines().collect();
    assert!(lines[2].starts_with("G18 G3"), "{output}");
    assert_eq!(&lines[3..], ["G17 G1", "IF [#1 LT 3] GOTO 10", "G0 Z50", "M30"]);
}

#[test]
fn a_late_jump_to_a_label_whose_modes_were_taken_as_known_is_an_error() {
    let start = "G90 G17 G1 X20. Y0. Z0. F100.\nN10 X20. Y0.\nIF [#1 LT 3] GOTO 10\n";
    for (late, is_told) in [("GOTO 10\n", true), ("GOTO #1\n", true), ("GOTO 11\n", false), ("X1.\n", false)]
    {
        let mut rewriter = Rewriter::new(job(&FANUC));
        let (budget, mut out) = (Budget::unlimited(), Vec::new());
        rewriter.push(start.as_bytes(), &mut out, &budget).unwrap();
        rewriter.push(&b"M8\n".repeat(SCANNED / 3 + 1), &mut out, &budget).unwrap();
        let taken = rewriter.push(late.as_bytes(), &mut out, &budget);
        assert_eq!(matches!(taken, Err(RewriteError::LateJump { limit: SCANNED, .. })), is_told, "{late}");
    }
}

/// Modes that a line of expressions or another part of the text may have set allow no run.
#[test]
fn a_mode_that_may_have_changed_unseen_keeps_the_blocks() {
    let arc = arc(['X', 'Y', 'Z'], 60, 1.0, 0.0);
    let n_arcs = |before: &str, behind: &str| {
        let text = format!("{before}G90 G17 G1 X20 Y0 Z0 F100\n{arc}{behind}");
        rewritten(&text).lines().filter(|line| line.contains("G2 ") || line.contains("G3 ")).count()
    };
    assert_eq!(n_arcs("G21 G0 X#1\n", "M30\n"), 1);
    for unseen in
        ["G20 G0 X#1\n", "G66 P9100 R#1\n", "G90.1 X#1\n", "G51 X0 I#1\n", "G41 D#101\n", "G93 F#3\n"]
    {
        assert_eq!(n_arcs(unseen, "M30\n"), 0, "{unseen}");
    }
    // A subprogram of LinuxCNC stands above the line that changes the units.
    assert_eq!(n_arcs("o100 sub\n", "o100 endsub\nG20\no100 call\nM2\n"), 0);
    // A text that ends as a subprogram may be called under G91.
    let called = format!("O1000\nG1 X20 Y0 Z0 F100\n{arc}M99\n");
    assert!(!rewritten(&called).contains("G3 "));
}

#[test]
fn a_feed_of_another_kind_behind_an_arc_is_no_fault() {
    let arc = arc(['X', 'Y', 'Z'], 60, 1.0, 0.0);
    let text = format!("G21 G90 G94 G17 G1 X20 Y0 Z0 F100\n{arc}G93\n#1=5\nG1 X0 F2\nM30\n");
    let lines = rewritten(&text);
    assert!(lines.contains("G1\nG93\n"), "{lines}");
}
