//! What stands in the comments of programs: the texts of users, and figures.

use super::*;

fn written(dialect: &Dialect, path: &Toolpath, name: &str, notes: &[String]) -> String {
    let cutting = Cutting { coolant: Coolant::Off, ..cutting() };
    let resolution = Resolution { units: Units::Mm, decimals: dialect.default_decimals_mm };
    let program = Program { name: Some(name.to_owned()), ..Program::plain(resolution) };
    let job = ProgramJob {
        tool: Some(&Tool { length_offset: None, ..TOOL }),
        comments: notes,
        ..ProgramJob::plain(&program, &cutting, dialect)
    };
    write(path, &job, &Budget::unlimited()).unwrap().text
}

/// A plunge and a cut to `far`.
fn cut(far: f64) -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 45.0));
    path.line(Point3::new(0.0, 0.0, -1.0), FeedRate::from_mm_per_min(400.0).unwrap(), Role::Plunge).unwrap();
    path.line(Point3::new(far, -far, -1.0), FeedRate::from_mm_per_min(800.0).unwrap(), Role::Cut).unwrap();
    path.finish().unwrap()
}

/// The interpreter of LinuxCNC skips blanks in a comment and reads small letters as capitals.
#[test]
fn no_comment_begins_with_a_word_that_a_control_obeys() {
    let names = [
        "log,x",
        "L o G, x",
        "LOGOPEN,a",
        "LOGCLOSE",
        " debug, #5221",
        "Print,1",
        "msg, hi",
        "probeopen a.txt",
        "PROBE CLOSE",
        "py,import os",
        "PYRUN,x",
        "PYRELOAD",
        "abort,now",
    ];
    let obeyed = ["log", "debug", "print", "msg", "probe", "py", "abort", "system"];
    for dialect in DIALECTS {
        for name in names {
            let text = written(dialect, &cut(10.0), name, &[name.to_owned()]);
            for line in text.lines() {
                let Some((_, comment)) = line.split_once(['(', ';']) else { continue };
                let packed = comment.replace(' ', "").to_ascii_lowercase();
                assert!(!obeyed.iter().any(|word| packed.starts_with(word)), "{} {line}", dialect.name);
            }
        }
    }
    assert!(written(&FANUC, &cut(10.0), "Log cabin", &[]).contains("\nO0001 (PROGRAM LOG CABIN)\n"));
    assert!(written(&FANUC, &cut(10.0), "Pyramid", &[]).contains("\nO0001 (PYRAMID)\n"));
}

/// The figures of a remark, from all of its lines.
fn figures(text: &str, label: &str) -> String {
    let is_before = |c: char| c.is_ascii_digit() || "(; ".contains(c);
    let own = text.lines().filter_map(|line| line.trim_start_matches(is_before).strip_prefix(label));
    let bodies: Vec<&str> =
        own.map(|line| line.trim_start_matches([' ', '=', ':']).trim_end_matches(')')).collect();
    bodies.join(" ")
}

#[test]
fn a_short_line_divides_no_number_and_leaves_none_out() {
    let grbl = &crate::dialects::grbl::GRBL;
    for far in [10.0, 1234.567, 9876.543] {
        let (short, long) = (written(grbl, &cut(far), "die", &[]), written(&LINUXCNC, &cut(far), "die", &[]));
        for label in ["RANGE", "TOOL", "FEED", "ROUNDING"] {
            assert_eq!(figures(&short, label).replace(" H3", ""), figures(&long, label).replace(" H3", ""));
        }
    }
    let note = format!("{} 12345.678 {}", "A".repeat(50), "1".repeat(90));
    for dialect in DIALECTS.iter().filter(|dialect| dialect.abilities.has_comments) {
        let text = written(dialect, &cut(10.0), "die", std::slice::from_ref(&note));
        let told = figures(&text, "NOTE");
        assert!(note.starts_with(&told) && told.starts_with('A'), "{} {told}", dialect.name);
        assert!([50, 60].contains(&told.len()), "{} {told}", dialect.name);
    }
}

/// Two passes, each with a cut at its own depth.
fn two_levels() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 45.0));
    for (level, z) in [(0, -1.27), (1, -2.54)] {
        path.begin_pass(Some(level));
        path.line(Point3::new(0.0, 0.0, z), FeedRate::from_mm_per_min(400.0).unwrap(), Role::Plunge).unwrap();
        path.line(Point3::new(9.0, 0.0, z), FeedRate::from_mm_per_min(800.0).unwrap(), Role::Cut).unwrap();
        path.rapid(Point3::new(9.0, 0.0, 45.0)).unwrap();
        path.rapid(Point3::new(0.0, 0.0, 45.0)).unwrap();
    }
    path.finish().unwrap()
}

#[test]
fn a_note_stands_before_the_first_block_of_its_pass_and_changes_nothing_else() {
    let (path, cutting) = (two_levels(), Cutting { coolant: Coolant::Off, ..cutting() });
    let note = |pass: usize, z_mm: f64| PassNote {
        pass,
        label: "LEVEL",
        text: format!("{} of 2 - \u{fc}ber (all)\nG0 Z-99", pass + 1),
        z_mm,
    };
    let notes = [note(0, -1.27), note(1, -2.54)];
    for dialect in DIALECTS {
        for units in [Units::Mm, Units::Inch] {
            let program = Program::plain(Resolution { units, decimals: dialect.default_decimals_mm });
            let tool = Tool { length_offset: None, ..TOOL };
            let bare = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
            let with_notes = ProgramJob { pass_notes: &notes, ..bare };
            let Ok(bare) = write(&path, &bare, &Budget::unlimited()) else { continue };
            let told = write(&path, &with_notes, &Budget::unlimited()).unwrap().text;
            if !dialect.abilities.has_comments {
                assert_eq!(told, bare.text, "{}", dialect.name);
                continue;
            }
            let is_told = |line: &&str| line.contains("LEVEL");
            let parts: Vec<String> = told
                .lines()
                .collect::<Vec<_>>()
                .split(is_told)
                .map(|part| part.iter().filter(|line| !line.contains(['(', ';'])).copied().collect())
                .collect();
            assert_eq!(parts.len(), 3, "{}:\n{told}", dialect.name);
            let depths = if units == Units::Mm { ["-1.27", "-2.54"] } else { ["-0.05", "-0.1"] };
            for (k, part) in parts.iter().enumerate() {
                let reached = depths.map(|depth| part.contains(&format!("Z{depth}")));
                assert_eq!(reached, [k == 1, k == 2], "{}:\n{told}", dialect.name);
            }
            for (line, depth) in told.lines().filter(is_told).zip(depths) {
                assert!(line.contains(&format!(" OF 2 - UBER ALL G0 Z-99 - Z {depth}")), "{line}");
            }
            let blocks = |text: &str| -> Vec<String> {
                let is_number = |c: char| c.is_ascii_digit() || c == ' ';
                let blocks = text.lines().filter(|line| !is_told(line));
                blocks.map(|line| line.trim_start_matches(is_number).to_owned()).collect()
            };
            assert_eq!(blocks(&told), blocks(&bare.text), "{}", dialect.name);
        }
    }
}
