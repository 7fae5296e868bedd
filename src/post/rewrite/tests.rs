use std::fmt::Write;

use super::*;
use crate::dialect::Dialect;
use crate::dialects::fanuc::FANUC;
use crate::dialects::linuxcnc::LINUXCNC;
use toolpathd_core::geometry::arc_fit::{Fit, Method};

mod accepted;
mod comments;
mod evaluator;
mod jumps;
mod random;

use evaluator::{SAGITTA_MM, distance, stops};

const TOLERANCE_MM: f64 = 0.01;

fn job(dialect: &'static Dialect) -> RewriteJob {
    let fit = Fit { method: Method::Greedy, ..Fit::within(TOLERANCE_MM) };
    RewriteJob { dialect, fit }
}

fn rewritten_as(dialect: &'static Dialect, program: &[u8], cut: usize) -> (Vec<u8>, Figures) {
    let mut rewriter = Rewriter::new(job(dialect));
    let (budget, mut out) = (Budget::unlimited(), Vec::new());
    for bytes in program.chunks(cut) {
        rewriter.push(bytes, &mut out, &budget).unwrap();
    }
    rewriter.finish(&mut out, &budget).unwrap();
    let figures = *rewriter.figures();
    assert_eq!((figures.bytes_in, figures.bytes_out), (program.len() as u64, out.len() as u64));
    (out, figures)
}

fn rewritten(program: &str) -> String {
    String::from_utf8(rewritten_as(&LINUXCNC, program.as_bytes(), usize::MAX).0).unwrap()
}

/// Blocks along an arc of radius 20 in the plane of two axes, from the place (20, 0), with `rise` along the
/// third.
fn arc(letters: [char; 3], n: usize, sweep: f64, rise: f64) -> String {
    let mut text = String::new();
    for k in 1..=n {
        let t = k as f64 / n as f64;
        let (sin, cos) = (sweep * t).sin_cos();
        let [a, b, c] = letters;
        let _ = write!(text, "{a}{:.3} {b}{:.3}", 20.0 * cos, 20.0 * sin);
        if rise != 0.0 {
            let _ = write!(text, " {c}{:.3}", rise * t);
        }
        text.push('\n');
    }
    text
}

/// The lines of the program with an arc in the middle.
fn check(before: &str, run: &str, behind: &str) -> String {
    let program = format!("{before}{run}{behind}");
    let output = rewritten(&program);
    let (one, other) = (stops(&program, 1.0), stops(&output, 1.0));
    assert_eq!(one.len(), other.len());
    for (a, b) in one.iter().zip(&other) {
        let apart = distance(&a.path, &b.path);
        assert!(apart <= TOLERANCE_MM + SAGITTA_MM, "{apart} mm at {}\n{output}", a.line);
        assert_eq!(a.state.at, b.state.at);
    }
    output
}

#[test]
fn an_arc_is_found_in_each_plane() {
    for (letters, plane) in [(['X', 'Y', 'Z'], 17), (['Z', 'X', 'Y'], 18), (['Y', 'Z', 'X'], 19)] {
        let before = format!("G{plane} G21 G90 G94\nG0 X0 Y0 Z0\nG0 {}20\nG1 F100\n", letters[0]);
        for (sweep, word) in [(1.5, "G3"), (-1.5, "G2")] {
            let output = check(&before, &arc(letters, 80, sweep, 0.0), "G0 Z50\nM30\n");
            let lines: Vec<_> = output.lines().collect();
            assert_eq!(lines.len(), 7, "{output}");
            assert!(lines[4].starts_with(word), "{output}");
            assert_eq!(&lines[5..], ["G0 Z50", "M30"]);
        }
    }
}

#[test]
fn a_helix_is_one_block() {
    let output = check("G0 X20 Y0 Z0\nG1 F100\n", &arc(['X', 'Y', 'Z'], 80, 1.5, 3.0), "M30\n");
    assert_eq!(output.lines().count(), 4, "{output}");
    assert!(
        output.lines().nth(2).is_some_and(|line| line.starts_with("G3") && line.contains("Z3")),
        "{output}"
    );
}

#[test]
fn a_mode_that_a_line_relies_on_is_set_again() {
    let before = "G17\nG0 X0 Y0 Z20\nG1 F100\n";
    let arc = arc(['Z', 'X', 'Y'], 40, 1.0, 0.0);
    let behind = |text: &str| {
        let output = rewritten(&format!("{before}{arc}{text}"));
        output.lines().skip(3).map(str::to_owned).collect::<Vec<_>>()
    };
    // The arc lies in G18 and is G3.
    let lines = behind("G0 X50\n");
    assert!(lines[0].starts_with("G18 G3"));
    assert_eq!(&lines[1..], ["G0 X50"]);
    assert_eq!(&behind("N7 X50 F200\nM30\n")[1..], ["N7 G1 X50 F200", "G17", "M30"]);
    assert_eq!(&behind("(one)\n\nX50 (two)\n")[1..], ["(one)", "", "G1 X50 (two)"]);
    assert_eq!(&behind("#1=5\nX50\n")[1..], ["G17 G1", "#1=5", "X50"]);
    assert_eq!(&behind("/X50\n")[1..], ["G17 G1", "/X50"]);
    assert_eq!(&behind("G19\nG2 Y5 Z5 J5 K0\n")[1..], ["G19", "G2 Y5 Z5 J5 K0"]);
    assert_eq!(&behind("G2 X5 Y5 I5 J0\n")[1..], ["G17", "G2 X5 Y5 I5 J0"]);
    assert_eq!(&behind("M30\n")[1..], ["G17", "M30"]);
    assert_eq!(&behind("M30\nM99\n")[1..], ["G17", "M30", "M99"]);
    assert_eq!(&behind("G41 D1 X5\n")[1..], ["G17", "G1 G41 D1 X5"]);
    assert_eq!(&behind("G53 Z0\n")[1..], ["G1 G53 Z0"]);
    assert_eq!(&behind("G28 Z0\nG0 Z5\n")[1..], ["G28 Z0", "G0 Z5"]);
    assert_eq!(&behind("M8\nG4 P1\nA90\n")[1..], ["M8", "G4 P1", "G1 A90"]);
}

#[test]
fn nothing_is_fitted_under_a_modifier_or_across_other_lines() {
    let arc = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    let bars = "G41 D1|G42|G68 X0 Y0 R30|G51 P2|G51.1 X0|G16|G7|G43.4 H1|G95|G66 P100|G112";
    for bar in bars.split('|') {
        let program = format!("G17 G21 G90\nG0 X20 Y0 Z0\nG1 F100\n{bar}\nX20 Y0 Z0\n{arc}M30\n");
        assert_eq!(rewritten(&program), program, "{bar}");
    }
    let interrupted = arc.lines().enumerate().map(|(k, line)| match k % 3 {
        0 => format!("{line}\n(MSG, a comment)\n"),
        1 => format!("{line} F{k}\n"),
        _ => format!("/{line}\nA{k}\n{line} M8\n\n"),
    });
    let program = format!("G0 X20 Y0 Z0\nG1 F100\n{}", interrupted.collect::<String>());
    assert_eq!(rewritten(&program), program);
}

#[test]
fn a_block_from_an_unknown_position_stays() {
    let arc = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    let first = arc.lines().next().unwrap();
    let stays = |line: &str| {
        let before = format!("G17 G21 G90\nG0 X20 Y0 Z0\nG1 F100\n{line}\nG90 G17 G21 G1\n");
        let output = rewritten(&format!("{before}{arc}G0 Z5\n"));
        assert!(output.starts_with(&before) && output.lines().count() < 10, "{output}");
        output.lines().any(|line| line == first)
    };
    let losing = "G81 X0 Y0 Z-1 R1|G28 Z0|M98 P100|O100 call|G38.2 X5|T1|M6|G54|G92 X0|G43 H1|G49|G52 X1|G53 Z0|#1=5|X#1|O7|G65 P100|G65 P9 X1 G90|\
        WHILE[1]DO1|G10 L2 P1 X0|G20|G5.1 Q1|A5|G69|/X5 Y5|M123|\u{fc}|G1 X1.0000001 Y2.0000001|G1 X1 Y1 R2";
    for line in losing.split('|') {
        assert!(stays(line), "{line}");
    }
    for line in
        "M8|(G28)|;G28|G4 X1.5|S500|G64 P0.1|G0 X20 Y0|G2 X20 Y0 I1|/M8|F5|N5|G91|G40|G61|G61.1|G187 P2 E0.1|"
            .split('|')
    {
        assert!(!stays(line), "{line}");
    }
}

#[test]
fn a_block_that_moves_an_unknown_axis_is_in_no_run() {
    let arc = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    // X and Y are known after the first block; Z never moves.
    let output = rewritten(&format!("G1 F100\n{arc}"));
    let lines: Vec<_> = output.lines().collect();
    assert_eq!(lines.len(), 3, "{output}");
    assert_eq!(lines[1], arc.lines().next().unwrap());
    assert!(!lines[2].contains('Z'));
    let shifted = rewritten(&format!("G0 X20 Y0 Z0\nG55\nG1 F100\n{arc}"));
    assert_eq!(shifted.lines().count(), 5, "{shifted}");
    // Under G91 no position has to be known.
    let steps = "G91\nG1 X0.5 Y0.001 F1\nX0.5 Y-0.001\nX0.5\nX0.5 F2\nX0.5\nX1.5\nX1\n";
    assert_eq!(rewritten(steps), "G91\nG1 X1.5 F1\nX3.5 F2\n");
}

#[test]
fn new_words_are_spelled_like_the_words_of_the_run() {
    let spaced = "N10 G1 X1.500 Y0.000 F100\nN20 X2.500 Y0.000 F100\nN30 X3.500 Y0.000\nN40 X4.500 Y1.000\n";
    let before = "G0 X0.5 Y0 Z0\n";
    assert_eq!(
        rewritten(&format!("{before}{spaced}M30")),
        format!("{before}N10 G1 X3.500 F100\nN40 X4.500 Y1.000\nM30")
    );
    let dense = "N10G1X1.Y-0F100\r\nN20X2.\r\nN30X3.\r\nN40X3.25";
    assert_eq!(rewritten(&format!("{before}{dense}")), format!("{before}N10G1X3.25F100"));
    let inches = "G20\nG0 X0 Y0\nG1 X.5 F10\nX 1.\nX+1.25\n";
    assert_eq!(rewritten(inches), "G20\nG0 X0 Y0\nG1 X1.25 F10\n");
}

#[test]
fn numbers_without_a_point_count_least_increments_on_a_fanuc() {
    let program = "G21 G90\nG0 X0. Y0. Z0.\nG1 X1000 F100.\nX2000\nX3.\nX3. Y1.\n";
    let (output, _) = rewritten_as(&FANUC, program.as_bytes(), usize::MAX);
    let wanted = "G21 G90\nG0 X0. Y0. Z0.\nG1 X3. F100.\nX3. Y1.\n";
    assert_eq!(String::from_utf8(output).unwrap(), wanted);
    let run: String =
        arc(['X', 'Y', 'Z'], 60, 1.5, 0.0).replace('.', "").replace("X0", "X").replace("Y0", "Y");
    let program = format!("G0 X20. Y0. Z0.\nG1 F100.\n{run}M30 (end)\n");
    let (output, figures) = rewritten_as(&FANUC, program.as_bytes(), usize::MAX);
    let output = String::from_utf8(output).unwrap();
    assert_eq!(figures.n_arcs, 1, "{output}");
    let (one, other) = (stops(&program, 0.001), stops(&output, 0.001));
    assert!(distance(&one[0].path, &other[0].path) <= TOLERANCE_MM + SAGITTA_MM);
    // More decimals than the dialect has.
    let fine = "G0 X0. Y0.\nG1 X1.00001 F1.\nX2.00002\nX3.00003\nX4.\n";
    assert_eq!(rewritten_as(&FANUC, fine.as_bytes(), 5).0, fine.as_bytes());
}

#[test]
fn inverse_time_feeds_keep_the_time_of_a_run() {
    let mut run = String::new();
    let mut at = (20.0f64, 0.0f64);
    for line in arc(['X', 'Y', 'Z'], 60, 1.5, 0.0).lines() {
        let mut words = line.split(' ').map(|word| word[1..].parse::<f64>().unwrap());
        let to = (words.next().unwrap(), words.next().unwrap());
        let length = (to.0 - at.0).hypot(to.1 - at.1);
        let _ = writeln!(run, "{line} F{:.4}", 300.0 / length);
        at = to;
    }
    let program = format!("G0 X20 Y0 Z0\nG93 G1\n{run}X0 F9\n(a)\nX5 F9 (b)\n#1=2\n");
    let output = rewritten(&program);
    let (one, other) = (stops(&program, 1.0), stops(&output, 1.0));
    assert!(output.lines().count() < 10, "{output}");
    for (a, b) in one.iter().zip(&other) {
        assert!((a.minutes - b.minutes).abs() <= 1e-6 * a.minutes, "{} {}", a.minutes, b.minutes);
    }
    // A block with another speed starts another run, and a block without a feed is in no run.
    let program = "G0 X0 Y0\nG93\nG1 X1 F10\nX2 F10\nX3 F11\nX4 F11\nX5\nX6\nX7\n";
    assert_eq!(rewritten(program), program);
}

#[test]
fn a_spike_and_repeated_points_are_kept() {
    let run = "G1 X1 F9\nX2\nX3\nX3\nX9\nX3\nX4\nX5\nX6\nX6 Y1\nX6 Y0\nX6 Y-1\n";
    let output = check("G0 X0 Y0 Z0\n", run, "M30\n");
    assert!(output.contains("X9") && output.contains("Y1") && output.lines().count() < 12, "{output}");
}

#[test]
fn repeated_speeds_and_long_numbers_leave_no_program_alone() {
    let run = arc(['X', 'Y', 'Z'], 40, 1.0, 0.0);
    let start = "\u{feff}G90 G17 G0 X20 Y0 Z0 S255\nG1 F100\n";
    let spoken: String = run.lines().map(|line| format!("{line} S255\n")).collect();
    let (_, figures) = rewritten_as(&LINUXCNC, format!("{start}{spoken}").as_bytes(), 7);
    assert_eq!((figures.n_points, figures.n_arcs), (40, 1));
    let (_, figures) =
        rewritten_as(&LINUXCNC, format!("{start}{}", spoken.replacen("S255", "S25", 20)).as_bytes(), 7);
    assert_eq!((figures.n_points, figures.left_alone.others), (38, 2));
    let lines: Vec<&str> = run.lines().collect();
    let long = lines[20].replace(" Y", "0000000003 Y");
    let text = format!("{start}{}\n{long}\n{}\n", lines[..20].join("\n"), lines[21..].join("\n"));
    let (output, figures) = rewritten_as(&LINUXCNC, text.as_bytes(), 7);
    assert_eq!((figures.n_points, figures.n_arcs, figures.left_alone.others), (39, 2, 1));
    assert!(String::from_utf8(output).unwrap().contains(&long));
}

#[test]
fn centers_are_absolute_under_g90_1() {
    let run = arc(['X', 'Y', 'Z'], 80, 1.5, 0.0);
    let output = check("G90.1\nG0 X20 Y0 Z0\nG1 F100\n", &run, "(a)\n");
    assert!(output.contains("G3") && stops(&output, 1.0).len() == 2);
    // An unknown position cannot be written.
    let program = format!("G90.1\nG0 X20 Y0\nG1 F100\n{run}");
    assert_eq!(rewritten(&program), program);
}

#[test]
fn long_runs_are_fitted_in_bounded_memory() {
    let mut rewriter = Rewriter::new(job(&LINUXCNC));
    let (budget, mut out) = (Budget::unlimited(), Vec::new());
    rewriter.push(b"G0 X0 Y0 Z0\nG1 F100\n", &mut out, &budget).unwrap();
    let mut largest = 0;
    for k in 0..60_000 {
        let t = f64::from(k) * 0.01;
        let line = format!("X{:.3} Y{:.3}\n", 10.0 * t, 30.0 * t.sin());
        rewriter.push(line.as_bytes(), &mut out, &budget).unwrap();
        let run = &rewriter.run;
        largest = largest.max(run.text.capacity() + 64 * run.blocks.capacity() + rewriter.written.capacity());
        assert!(run.blocks.len() < WINDOW);
    }
    assert!(largest < 2_000_000, "{largest}");
    assert!(out.len() > 50_000);
    rewriter.finish(&mut out, &budget).unwrap();
    let figures = rewriter.figures();
    assert_eq!((figures.n_runs, figures.n_points), (1, 60_000));
    assert!(figures.n_arcs + figures.n_lines < 20_000, "{figures:?}");
    assert!(figures.deviation_max_mm > 0.0 && figures.deviation_max_mm <= TOLERANCE_MM);
}

#[test]
fn arcs_of_two_windows_join_without_a_gap() {
    let output = check("G0 X20 Y0 Z0\nG1 F100\n", &arc(['X', 'Y', 'Z'], 5000, 5.0, 4.0), "M30\n");
    assert!(output.lines().count() < 200, "{output}");
}

#[test]
fn a_long_line_and_a_spent_budget_are_errors() {
    let mut rewriter = Rewriter::new(job(&LINUXCNC));
    let (budget, mut out) = (Budget::unlimited(), Vec::new());
    rewriter.push(&[b'\n'; 3], &mut out, &budget).unwrap();
    rewriter.push(&vec![b'('; MAX_LINE_LENGTH], &mut out, &budget).unwrap();
    let limit = MAX_LINE_LENGTH;
    rewriter.push(b"x", &mut out, &budget).unwrap();
    assert_eq!(rewriter.finish(&mut out, &budget), Err(RewriteError::LineTooLong { line: 4, limit }));
    budget.cancel();
    let stopped = Rewriter::new(job(&LINUXCNC)).finish(&mut out, &budget);
    assert_eq!(stopped, Err(RewriteError::Stopped(Stopped::Cancelled)));
}

#[test]
fn a_rewriter_can_go_to_another_thread() {
    fn is_send<T: Send>(_: &T) {}
    is_send(&Rewriter::new(job(&LINUXCNC)));
}
