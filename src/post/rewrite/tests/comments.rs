//! Comments at and between replaced blocks, and ends of lines.

use super::*;
use crate::dialects::grbl::GRBL;

const START: &str = "G0 X20 Y0 Z0\nG1 F100\n";

/// An arc with `behind` each of its blocks, where `@` is the number of the block.
fn with(behind: &str) -> String {
    let run = arc(['X', 'Y', 'Z'], 24, 1.0, 0.0);
    let line = |(k, line): (usize, &str)| format!("{line}{}\n", behind.replace('@', &k.to_string()));
    run.lines().enumerate().map(line).collect()
}

#[test]
fn comments_of_replaced_blocks_stand_before_the_arc_in_their_order() {
    let comments = |form: &str| (0..24).map(|k| form.replace('@', &k.to_string()) + "\n").collect::<String>();
    for (behind, kept) in
        [(" (c @)", "(c @)"), (" ; c @", "; c @"), ("\n(c @)", "(c @)"), ("(a)(@)", "(a)\n(@)")]
    {
        let output = rewritten(&format!("{START}{}M30\n", with(behind)));
        let end = output.strip_prefix(START).and_then(|rest| rest.strip_suffix("M30\n")).unwrap();
        let (arcs, others): (Vec<&str>, Vec<&str>) = end.lines().partition(|line| line.contains("G3"));
        assert_eq!(arcs.len(), 1, "{output}");
        assert_eq!(others.join("\n") + "\n", comments(kept), "{output}");
        // A line behind the last block stays behind the arc.
        assert_eq!(end.lines().last() == Some(arcs[0]), !behind.starts_with('\n'), "{output}");
    }
}

#[test]
fn blank_lines_and_semicolons_alone_are_no_comments() {
    let output = rewritten(&format!("{START}{}M30\n", with("\n\n ")));
    assert_eq!(output.lines().count(), 6, "{output}");
    let (output, _) =
        rewritten_as(&FANUC, format!("G0 X20. Y0. Z0.;\nG1 F100.;\n{}M30;\n", with(";")).as_bytes(), 9);
    let output = String::from_utf8(output).unwrap();
    assert!(output.lines().count() == 4 && output.lines().all(|line| line.ends_with(';')), "{output}");
}

#[test]
fn a_comment_that_a_control_obeys_ends_a_run() {
    for comment in ["(MSG, a)", "; log, b", "( Print,#1)", "(probeopen a.txt)", "(py,a)", "(D E B U G, x)"] {
        let program = format!("{START}{}", with(&format!(" {comment}")));
        assert_eq!(rewritten(&program), program);
        let program = format!("{START}X19.99 Y0.1\n{comment}\nX19.98 Y0.2\n{comment}\nX19.97 Y0.3\n");
        assert_eq!(rewritten(&program), program);
    }
}

/// On Fanuc and its kind a block may follow a semicolon.
#[test]
fn words_behind_a_semicolon_stay_where_it_ends_blocks() {
    let program = "G90 G0 X0. Y0. Z0.\nG1 X1. F9.; Y5.\nX2.; Y6.\nX3.; Y7.\n".to_owned();
    assert_eq!(rewritten_as(&FANUC, program.as_bytes(), 7).0, program.as_bytes());
    // The mode behind the semicolon may be in force.
    let program = format!("G90 G0 X20. Y0. Z0.; G91\nG1 F100.\n{}M30\n", with(""));
    assert_eq!(rewritten_as(&FANUC, program.as_bytes(), 7).0, program.as_bytes());
    let program = "G90 G0 X0. Y0. Z0.\nG1 X1. F9.; Y5.\nX2.; Y6.\nX3.; Y7.\n".to_owned();
    assert_ne!(rewritten_as(&GRBL, program.as_bytes(), 7).0, program.as_bytes());
}

#[test]
fn a_line_may_end_with_cr_alone() {
    let program = format!("{START}{}M30\n", with(" (c @)"));
    let wanted = rewritten(&program);
    for end in ["\r", "\r\n"] {
        let other = program.replace('\n', end);
        for cut in [1, 7, usize::MAX] {
            let (output, _) = rewritten_as(&LINUXCNC, other.as_bytes(), cut);
            assert_eq!(String::from_utf8(output).unwrap(), wanted.replace('\n', end));
        }
    }
    let mixed = "G0 X0 Y0\rG1 X1 F9\r\nX2\rX3\nX4\r";
    assert_eq!(rewritten(mixed), "G0 X0 Y0\rG1 X4 F9\r");
}

#[test]
fn remarks_without_end_take_no_memory() {
    let mut rewriter = Rewriter::new(job(&LINUXCNC));
    let (budget, mut out) = (Budget::unlimited(), Vec::new());
    rewriter.push(b"G0 X0 Y0\nG1 X1 F9\n", &mut out, &budget).unwrap();
    let remarks = format!("({})\n", "r".repeat(200)).repeat(100);
    for _ in 0..100 {
        rewriter.push(remarks.as_bytes(), &mut out, &budget).unwrap();
        assert!(rewriter.run.text.len() <= 1024 * 1024);
    }
    rewriter.finish(&mut out, &budget).unwrap();
    assert_eq!(out.len() as u64, rewriter.figures().bytes_in);
}
