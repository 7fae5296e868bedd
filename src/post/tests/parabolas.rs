//! Parabolas in each dialect.

use super::*;
use toolpathd_core::geometry::curve::Parabola;

/// Level parabolas after a plunge along an arc in another plane, and before moves that need their G words
/// again.
fn wave() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 45.0));
    path.rapid(Point3::new(0.0, 0.0, 1.0)).unwrap();
    let about = (Plane::Zx, Direction::Ccw);
    path.arc(Point3::new(2.0, 0.0, 1.0), Point3::new(1.0, 0.0, 1.0), about, feed(200.0), Role::LeadIn)
        .unwrap();
    let mut cut = |to: [f64; 2], control: [f64; 2], rate| {
        let [to, control] = [to, control].map(|[x, y]| Point3::new(x, y, 1.0));
        path.parabola(to, control, feed(rate), Role::Cut).unwrap();
    };
    cut([12.0, 0.0], [7.0, 4.0], 800.0);
    cut([12.0, 6.0], [15.0, 3.0], 800.0);
    cut([4.0, 6.0], [8.0, 6.0], 500.0);
    path.line(Point3::new(4.0, 8.0, 1.0), feed(500.0), Role::Cut).unwrap();
    path.finish().unwrap()
}

#[test]
fn linuxcnc_writes_parabolas_as_splines_with_every_word_on_every_block() {
    let text = written(&wave(), &Program::plain(MM), &cutting(), &[]).unwrap().text;
    let expected = "\nG18 G3 X2.000 Z1.000 I1.000 K0.000 F200\n\
        G17 G5.1 X12.000 Y0.000 I5.000 J4.000 F800\nG5.1 X12.000 Y6.000 I3.000 J3.000\n\
        G1 X4.000 F500\nY8.000\nG0 Z45.000\n";
    assert!(text.contains(expected), "{text}");
    let kinds: Vec<_> = Reader::new(&text, DIALECTS[0], 0.0015)
        .filter_map(|placed| match placed.unwrap().step {
            Step::Feed { along: Curve::Parabola(parabola), .. } => Some(parabola.control()),
            _ => None,
        })
        .collect();
    assert_eq!(kinds, [Point3::new(7.0, 4.0, 1.0), Point3::new(15.0, 3.0, 1.0)]);
}

#[test]
fn fanuc_writes_parabolas_as_lines_within_its_rounding() {
    let written = written_in(&FANUC, &wave(), &Program::plain(MM), &cutting(), &[]).unwrap();
    assert!(!written.text.contains("G5.1") && written.max_displacement_mm <= 0.0015);
    lies_along(&wave(), &written.text, &FANUC, 0.0015);
}

/// Every cutting point of the text is within 1.5 units of the toolpath, and the other way round.
fn lies_along(path: &Toolpath, text: &str, dialect: &Dialect, limit_mm: f64) {
    let written: Vec<Curve> = Reader::new(text, dialect, limit_mm)
        .filter_map(|placed| match placed.unwrap().step {
            Step::Feed { along, .. } => Some(along),
            _ => None,
        })
        .collect();
    let meant: Vec<Curve> = path
        .moves()
        .filter_map(|step| match step {
            toolpathd_core::toolpath::Move::Feed { along, .. } => Some(*along),
            _ => None,
        })
        .collect();
    for (these, others) in [(&written, &meant), (&meant, &written)] {
        for curve in these {
            for k in 0..=20 {
                let p = curve.point_at(f64::from(k) / 20.0);
                let off = others.iter().map(|other| other.distance_to(&p)).fold(f64::INFINITY, f64::min);
                assert!(off <= limit_mm + 1e-9, "{off} {curve:?}");
            }
        }
    }
}

#[test]
fn a_changed_spline_fails_the_check() {
    let program = Program::plain(MM);
    let cutting = cutting();
    let dialect = DIALECTS[0];
    let job = ProgramJob { tool: Some(&TOOL), ..ProgramJob::plain(&program, &cutting, dialect) };
    let text = write(&wave(), &job, &Budget::unlimited()).unwrap().text;
    for (from, to, what) in [
        ("I5.000 J4.000", "I5.001 J4.000", "control"),
        ("I5.000 J4.000", "I5.000 J-4.000", "control"),
        ("G5.1 X12.000 Y0.000", "G5.1 X12.000 Y0.001", "place"),
        ("J4.000 F800", "J4.000 F801", "feed"),
        ("G1 X4.000", "G0 X4.000", "kind"),
    ] {
        let changed = text.replacen(from, to, 1);
        let error = check_text(&changed, &wave(), &job).unwrap_err();
        assert!(matches!(error, WriteError::Differs { what: found, .. } if found == what), "{from} {error}");
    }
    let unsaid = text.replacen("G1 X4.000", "X4.000", 1);
    let error = check_text(&unsaid, &wave(), &job).unwrap_err();
    assert!(matches!(error, WriteError::Unreadable(_)), "{error}");
}

#[test]
fn a_rising_parabola_becomes_lines_and_a_large_parabola_several_splines() {
    let count = |control: [f64; 3], to: [f64; 3]| {
        let mut path = Toolpath::builder(Point3::origin());
        path.parabola(to.into(), control.into(), feed(100.0), Role::Cut).unwrap();
        let path = path.finish().unwrap();
        let program = written(&path, &Program::plain(MM), &cutting(), &[]).unwrap();
        assert!(program.max_displacement_mm <= 0.0015);
        lies_along(&path, &program.text, DIALECTS[0], 0.0015);
        let splines = program.text.matches("G5.1").count();
        // Besides the approach and the retract.
        (splines, program.blocks - 4 - splines)
    };
    assert_eq!(count([5.0, 4.0, 0.0], [10.0, 0.0, 0.0]), (1, 0));
    let (splines, lines) = count([5.0, 4.0, 1.0], [10.0, 0.0, 0.0]);
    assert!(splines == 0 && lines > 20, "{lines}");
    let (splines, lines) = count([300.0, 200.0, 0.0], [600.0, 0.0, 0.0]);
    assert!((2..10).contains(&splines) && lines == 0, "{splines}");
}

#[test]
fn a_cutting_move_without_a_feed_is_refused() {
    let mut path = Toolpath::builder(Point3::origin());
    path.parabola(Point3::new(2.0, 0.0, 0.0), Point3::new(1.0, 1.0, 0.0), None, Role::Cut).unwrap();
    let path = path.finish().unwrap();
    for dialect in WORDS {
        let refused = written_in(dialect, &path, &Program::plain(MM), &cutting(), &[]);
        assert_eq!(refused, Err(WriteError::FeedMissing));
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 64, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn every_parabola_is_written_within_one_and_a_half_units(
        points in prop::collection::vec(prop::array::uniform3(-20.0..20.0f64), 2..8), level: bool,
        dialect in prop::sample::select(WORDS.to_vec()),
    ) {
        let mut path = Toolpath::builder(Point3::origin());
        for pair in points.chunks_exact(2) {
            let [control, to] = [pair[0], pair[1]].map(|[x, y, z]| Point3::new(x, y, if level { 0.0 } else { z }));
            path.parabola(to, control, feed(300.0), Role::Cut).unwrap();
        }
        let path = path.finish().unwrap();
        let written = written_in(dialect, &path, &Program::plain(MM), &cutting(), &[]).unwrap();
        prop_assert!(written.max_displacement_mm <= 0.0015);
        lies_along(&path, &written.text, dialect, 0.0015);
        let length: f64 = Reader::new(&written.text, dialect, 0.0015)
            .filter_map(|placed| match placed.unwrap().step {
                Step::Feed { along, .. } => Some(along.length()),
                _ => None,
            })
            .sum();
        let wanted = measure(&path, feed(1.0)).cutting_length_mm;
        prop_assert!((length - wanted).abs() <= 1e-3 * wanted, "{length} {wanted}");
    }
}

#[test]
fn a_parabola_that_turns_back_is_cut_to_its_turning_point() {
    let turning =
        Parabola::new(Point3::origin(), Point3::new(8.0, 0.0, 0.0), Point3::new(4.0, 0.0, 0.0)).unwrap();
    let mut path = Toolpath::builder(turning.start());
    path.parabola(turning.end(), turning.control(), feed(100.0), Role::Cut).unwrap();
    let path = path.finish().unwrap();
    for dialect in WORDS {
        let text = written_in(dialect, &path, &Program::plain(MM), &cutting(), &[]).unwrap().text;
        assert!(text.contains("X5.33") && !text.contains("G5.1"), "{text}");
    }
}
