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
