//! What holds in every dialect: random toolpaths, user text, and whole programs as a machinist reads them.

use super::*;
use toolpathd_core::toolpath::Move;
use toolpathd_core::toolpath::quantize::quantize;

/// Cutting conditions that every dialect can write.
fn plain() -> Cutting {
    Cutting { coolant: Coolant::Off, ..cutting() }
}

const NUMBERED: Tool = Tool { length_offset: None, ..TOOL };

fn in_dialect(
    dialect: &Dialect,
    path: &Toolpath,
    program: &Program,
    cutting: &Cutting,
    comments: &[String],
) -> Result<NcProgram, WriteError> {
    let job = ProgramJob { tool: Some(&NUMBERED), comments, ..ProgramJob::plain(program, cutting, dialect) };
    write(path, &job, &Budget::unlimited())
}

fn with_tool(dialect: &Dialect, path: &Toolpath, tool: &Tool) -> Result<NcProgram, WriteError> {
    let (program, cutting) = (Program::plain(usual(dialect, Units::Mm)), plain());
    let job = ProgramJob { tool: Some(tool), ..ProgramJob::plain(&program, &cutting, dialect) };
    write(path, &job, &Budget::unlimited())
}

/// As many cases as `PROPTEST_CASES` says, or enough for each dialect to be drawn several times.
fn cases() -> u32 {
    let usual = ProptestConfig { failure_persistence: None, ..ProptestConfig::default() }.cases;
    if usual == 256 { 88 } else { usual }
}

/// The usual resolution of a dialect.
fn usual(dialect: &Dialect, units: Units) -> Resolution {
    let decimals = match units {
        Units::Mm => dialect.default_decimals_mm,
        Units::Inch => dialect.default_decimals_inch,
    };
    Resolution { units, decimals }
}

/// The largest distance between the cutting moves of a toolpath and those that are read from a text, mm, both
/// ways and in order.
fn apart(path: &Toolpath, text: &str, dialect: &Dialect, resolution: Resolution) -> f64 {
    let step_mm = resolution.step_mm();
    let is_off_grid =
        |p: Point3<f64>| [p.x, p.y].iter().any(|at| (at / step_mm - (at / step_mm).round()).abs() > 0.0005);
    let mut cuts = Reader::new(text, dialect, 0.05).filter_map(|placed| match placed.unwrap().step {
        // A helix of Klartext ends beside the grid, and a short line leads back.
        Step::Feed { along: Curve::Line(line), .. }
            if dialect.name == "heidenhain"
                && (line.end - line.start).norm() <= 2.0 * step_mm
                && (is_off_grid(line.start) || (line.end - line.start).norm() < 1e-9) =>
        {
            None
        }
        Step::Feed { along, .. } => Some(along),
        _ => None,
    });
    let mut apart: f64 = 0.0;
    for step in path.moves() {
        let Move::Feed { along, .. } = step else { continue };
        let count = quantize(along, resolution, &dialect.curves).unwrap().len();
        let mine: Vec<Curve> = cuts.by_ref().take(count).collect();
        assert_eq!(mine.len(), count, "the program cuts less");
        let whole: f64 = mine.iter().map(Curve::length).sum();
        let slip = 0.03 + 8.0 * resolution.step_mm() / whole;
        let mut from = 0.0;
        for cut in mine {
            let share = cut.length() / whole;
            // Many short lines stand for one curve: their middles tell enough.
            let parts: &[f64] = if count > 100 { &[0.5] } else { &[0.0, 0.2, 0.5, 0.7, 1.0] };
            for &part in parts {
                apart = apart.max(nearest(&cut.point_at(part), along, from + share * part, slip));
            }
            // What of the given curve corresponds to the written one is near that.
            for part in [0.1, 0.5, 0.9].into_iter().take(parts.len()) {
                let at = along.point_at(from + share * part);
                apart = apart.max(nearest(&at, &cut, part, (slip / share).min(1.0)).min(0.5 * whole));
            }
            from += share;
        }
    }
    assert!(cuts.next().is_none(), "the program cuts more");
    apart
}

/// The distance from `p` to the part of a curve within `width` of the fraction `guess`, mm.
fn nearest(p: &Point3<f64>, curve: &Curve, guess: f64, width: f64) -> f64 {
    let off = |t: f64| (p - curve.point_at(t.clamp(0.0, 1.0))).norm();
    let (mut best, mut width) = (guess, width);
    while width > 1e-10 {
        let places = (-8..=8).map(|k| best + width * f64::from(k) / 8.0);
        best = places.min_by(|a, b| off(*a).total_cmp(&off(*b))).unwrap_or(best);
        width /= 5.0;
    }
    off(best)
}

/// How far the radii of an arc may differ on the controls themselves, mm, apart from the table of dialects.
fn mismatch_limit_mm(name: &str) -> f64 {
    match name {
        "grbl" => 0.005,
        "siemens" => 0.01,
        _ => 0.016,
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: cases(), ..ProptestConfig::default() })]

    #[test]
    fn a_control_cuts_along_the_toolpath_in_every_dialect(
        hops in prop::collection::vec(hops(), 1..12), inch: bool, block_numbers: bool,
        dialect in prop::sample::select(DIALECTS),
    ) {
        let units = if inch && dialect.abilities.units.contains(&Units::Inch) { Units::Inch } else { Units::Mm };
        let mut path = Toolpath::builder(Point3::new(1.0, 2.0, 50.0));
        for one in &hops {
            if matches!(one, Hop::Dwell(_)) && !dialect.abilities.has_dwells {
                continue;
            }
            // The builder refuses a centre that rounding has moved off its arc; the tool then stays where it
            // is.
            let _ = hop(&mut path, one);
        }
        let path = path.finish().unwrap();
        let resolution = usual(dialect, units);
        let program = Program { block_numbers, ..Program::plain(resolution) };
        let written = match in_dialect(dialect, &path, &program, &plain(), &[]) {
            // A slow feed may need more digits than a line has room for.
            Err(error @ WriteError::LineTooLong { .. }) => {
                return Err(TestCaseError::reject(error.to_string()));
            }
            written => written.unwrap(),
        };
        let limit_mm = 1.5 * resolution.step_mm();
        prop_assert!(written.max_displacement_mm <= limit_mm);
        prop_assert!(written.max_radius_mismatch_mm <= mismatch_limit_mm(dialect.name));
        let apart_mm = apart(&path, &written.text, dialect, resolution);
        prop_assert!(apart_mm <= limit_mm + 1e-9, "{apart_mm} mm");
        let (mut length, mut time, mut slowest) = (0.0, 0.0, f64::INFINITY);
        for placed in Reader::new(&written.text, dialect, limit_mm) {
            if let Step::Feed { along, rate, .. } = placed.unwrap().step {
                length += along.length();
                time += along.length() / rate.mm_per_s();
                slowest = rate.mm_per_s().min(slowest);
            }
        }
        let measures = measure(&path, feed(10_000.0));
        // Each circle is rounded to one of another length.
        let slack_mm = 1e-3 * measures.cutting_length_mm + 8.0 * resolution.step_mm() * path.moves().count() as f64;
        prop_assert!((length - measures.cutting_length_mm).abs() <= slack_mm);
        // A feed that the decimals of the control state badly is slower.
        let written_s = |along: &Curve, rate: FeedRate| {
            let word = words::feed(rate, units, &dialect.numbers).unwrap();
            60.0 * along.length() / (word.value() * units.mm())
        };
        let cutting_time_s: f64 = path
            .moves()
            .map(|step| match step {
                Move::Feed { along, rate: Some(rate), .. } => written_s(along, *rate),
                _ => 0.0,
            })
            .sum();
        let slack_s = 1e-3 * cutting_time_s + 0.1 + slack_mm / slowest;
        prop_assert!((time - cutting_time_s).abs() <= slack_s, "{time} {cutting_time_s}");
        for line in written.text.lines() {
            prop_assert!(line.is_ascii() && line.len() <= dialect.max_line_length, "{line}");
            prop_assert!(!line.contains("-0.000 ") && !line.contains("e-"), "{line}");
        }
    }

    /// Names and notes leave the blocks of a program as they are: what remains without comments is the same.
    #[test]
    fn user_text_stays_in_comments_in_every_dialect(
        name in "(?s)([)%;&?~(\r\n]|.){0,60}", note in "(?s)([)%;&?~(\r\n]|.){0,60}",
        dialect in prop::sample::select(DIALECTS),
    ) {
        let path = plunge();
        let told = Program { name: Some(name), ..Program::plain(usual(dialect, Units::Mm)) };
        let bare = Program { name: None, ..told.clone() };
        let notes = [note, "x".repeat(10_000), ")\n%\n0 L Z-99 FMAX\n".repeat(300)];
        let told = in_dialect(dialect, &path, &told, &plain(), &notes).unwrap().text;
        let bare = in_dialect(dialect, &path, &bare, &plain(), &[]).unwrap().text;
        prop_assert!(told.is_ascii());
        prop_assert_eq!(blocks(&told), blocks(&bare));
        for line in told.lines().filter(|line| line.contains('(')) {
            prop_assert!(line.matches('(').count() == 1 && line.ends_with(')'), "{line}");
        }
    }
}

/// The lines of a program without comments, block numbers and lines of comments.
fn blocks(text: &str) -> Vec<String> {
    let without = |line: &str| {
        let line = line.split(';').next().unwrap_or_default();
        let line = if line.contains("(&X") { line } else { line.split('(').next().unwrap_or_default() };
        let line = line.trim().trim_start_matches(|c: char| c.is_ascii_digit());
        line.trim().to_owned()
    };
    text.lines().map(without).filter(|line| !line.is_empty()).collect()
}

/// What a control cannot read is refused before the program is written, not found by the check.
#[test]
fn numbers_beyond_a_control_are_refused_with_their_limit() {
    let program_of = |dialect: &Dialect| Program::plain(usual(dialect, Units::Mm));
    let far = |x: f64, rate: f64| {
        let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 45.0));
        path.line(Point3::new(x, 0.0, -1.0), feed(rate), Role::Cut).unwrap();
        path.finish().unwrap()
    };
    let mut waiting = Toolpath::builder(Point3::origin());
    waiting.dwell(7200.0).unwrap();
    let waiting = waiting.finish().unwrap();
    let klartext = &crate::dialects::heidenhain::HEIDENHAIN;
    let in_klartext =
        |path: &Toolpath| in_dialect(klartext, path, &program_of(klartext), &plain(), &[]).map(|_| ());
    let too_many = Err(WriteError::TooManyWholeDigits { limit: 5 });
    assert_eq!(in_klartext(&far(99_999.0, 99_999.0)), Ok(()));
    assert_eq!(in_klartext(&far(100_000.0, 500.0)), too_many);
    assert_eq!(in_klartext(&far(10.0, 200_000.0)), too_many);
    assert_eq!(in_klartext(&waiting), Err(WriteError::Dwell { seconds: 7200.0, most_s: 3600.0 }));
    // Whatever a request may ask for, the check of the written program finds nothing.
    for dialect in DIALECTS {
        for (number, length_offset) in [(99_999_999, None), (1, Some(99_999_999)), (32_768, Some(32_768))] {
            for path in [&far(10.0, 500.0), &far(1e6, 1e6), &far(1e-3, 1e-3), &waiting] {
                let tool = Tool { number: Some(number), length_offset, ..TOOL };
                let written = with_tool(dialect, path, &tool);
                let is_fault = matches!(written, Err(WriteError::Unreadable(_) | WriteError::Differs { .. }));
                assert!(!is_fault, "{} {number} {length_offset:?} {written:?}", dialect.name);
            }
        }
    }
}

#[test]
fn a_siemens_program_selects_the_cutting_edge_that_is_asked_for() {
    let siemens = &crate::dialects::siemens::SIEMENS;
    for (length_offset, edge, head) in
        [(None, "\nD1\n", "T2 D1 "), (Some(2), "\nD2\n", "T2 D2 "), (Some(1), "\nD1\n", "T2 D1 ")]
    {
        let tool = Tool { number: Some(2), length_offset, ..TOOL };
        let text = with_tool(siemens, &plunge(), &tool).unwrap().text;
        assert!(text.contains(edge) && text.contains(head), "{text}");
    }
}

/// A plunge, a cut, and a rapid up.
fn plunge() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 45.0));
    path.line(Point3::new(0.0, 0.0, -1.0), feed(400.0), Role::Plunge).unwrap();
    path.line(Point3::new(10.5, 0.0, -1.0), feed(800.0), Role::Cut).unwrap();
    path.rapid(Point3::new(10.5, 0.0, 45.0)).unwrap();
    path.finish().unwrap()
}
