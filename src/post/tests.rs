use std::f64::consts::TAU;

use nalgebra::{Point3, Vector3};
use proptest::prelude::*;

use super::dialect::{Comment, Iso, Point, Syntax};
use super::dialects::fanuc::FANUC;
use super::dialects::linuxcnc::LINUXCNC;
use super::read::{Reader, Step};
use super::*;
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::cutting::{Coolant, CuttingRequest};
use toolpathd_core::toolpath::measure::measure;
use toolpathd_core::toolpath::program::{Resolution, SafeHome, Units};
use toolpathd_core::toolpath::tool::Shape;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Builder, Role};

pub mod accepted_arcs;
mod approach;
mod blank;
mod comments;
mod corrupted;
mod custom;
mod cycles;
mod deckel;
mod dialects;
mod feeds;
mod golden;
mod helices;
mod inverse_time;
mod parabolas;
mod posed;
mod positions;
mod rails;
mod sequence;
mod smoothing;
mod wrong_words;

const MM: Resolution = Resolution { units: Units::Mm, decimals: 3 };
const INCH: Resolution = Resolution { units: Units::Inch, decimals: 4 };

/// Two dialects of ISO words that differ in most of their data.
const WORDS: [&Dialect; 2] = [&LINUXCNC, &FANUC];

/// The data of a dialect of ISO words.
fn iso(dialect: &Dialect) -> Iso {
    match dialect.syntax {
        Syntax::Iso(iso) | Syntax::Siemens(iso) => iso,
        Syntax::Klartext | Syntax::Deckel => panic!("{} has no ISO words", dialect.name),
    }
}

fn feed(mm_per_min: f64) -> FeedRate {
    FeedRate::from_mm_per_min(mm_per_min).unwrap()
}

fn cutting() -> Cutting {
    let request = CuttingRequest {
        spindle_rpm: Some(12_000.0),
        coolant: Coolant::Flood,
        ..CuttingRequest::at_feed(feed(800.0))
    };
    request.at_heights(45.0, 12.0)
}

/// A warning longer than a line.
const WARNING: &str = "length_offset_differs - tool 3 is cut with the length offset 4, which is that of another place of the \
                       table: `tool.length_offset`";

const TOOL: Tool = Tool { shape: Shape::Ball, radius_mm: 5.0, number: Some(3), length_offset: Some(4) };

fn written_in(
    dialect: &Dialect,
    toolpath: &Toolpath,
    program: &Program,
    cutting: &Cutting,
    comments: &[String],
) -> Result<NcProgram, WriteError> {
    let warnings = &[WARNING.to_owned()];
    let job = ProgramJob {
        program,
        tool: Some(&TOOL),
        cutting,
        dialect,
        comments,
        warnings,
        five_axes: None,
        pass_notes: &[],
        called: None,
    };
    write(toolpath, &job, &Budget::unlimited())
}

/// In the default dialect.
fn written(
    toolpath: &Toolpath,
    program: &Program,
    cutting: &Cutting,
    comments: &[String],
) -> Result<NcProgram, WriteError> {
    written_in(DIALECTS[0], toolpath, program, cutting, comments)
}

/// The check of a text against one operation.
fn check_text(text: &str, toolpath: &Toolpath, job: &ProgramJob) -> Result<f64, WriteError> {
    let (operations, budget) = ([Operation { name: None, toolpath, job: *job }], Budget::unlimited());
    check::read_back(text, &[], &parts(&operations, &budget)?, &budget)
}

/// A short program with a plunge, arcs in two planes, a rapid down and a dwell.
fn sample() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(1.0, 2.0, 45.0));
    path.rapid(Point3::new(0.0, 0.0, 12.0)).unwrap();
    path.line(Point3::new(0.0, 0.0, 0.0), feed(400.0), Role::Plunge).unwrap();
    let about = (Plane::Zx, Direction::Ccw);
    path.arc(Point3::new(10.0, 0.0, 0.0), Point3::new(5.0, 0.0, 0.0), about, feed(800.0), Role::Cut).unwrap();
    path.line(Point3::new(10.0, 2.0, 0.0), feed(800.0), Role::Link).unwrap();
    path.dwell(0.25).unwrap();
    let about = (Plane::Xy, Direction::Cw);
    path.arc(Point3::new(10.0, 2.0, 0.0), Point3::new(8.0, 2.0, 0.0), about, feed(333.333), Role::Cut)
        .unwrap();
    path.rapid(Point3::new(-1e-9, 0.0, 12.0)).unwrap();
    path.finish().unwrap()
}

#[test]
fn inches_block_numbers_and_a_stopped_spindle_are_written() {
    let program = Program { block_numbers: true, ..Program::plain(INCH) };
    let cutting = Cutting { spindle_rpm: None, coolant: Coolant::Off, ..cutting() };
    let text = written(&sample(), &program, &cutting, &[]).unwrap().text;
    assert!(text.contains("G17 G20 G90"));
    assert!(text.contains(" G64 P0.0001 Q0\n"));
    assert!(text.contains(" Z1.7717\n"));
    assert!(!text.contains("M3\n") && !text.contains("M7") && !text.contains("M8"));
    for (k, line) in text.lines().enumerate() {
        assert!(line.starts_with(&format!("N{} ", 10 * (k + 1))), "{line}");
    }
    // The marks and the number of a Fanuc program have no block number.
    let text = written_in(&FANUC, &sample(), &program, &cutting, &[]).unwrap().text;
    let numbered: Vec<bool> = text.lines().map(|line| line.starts_with('N')).collect();
    let n = numbered.len();
    assert!(numbered.iter().enumerate().all(|(k, &is)| is == (2..n - 1).contains(&k)));
    assert!(text.contains("N10 (WRITTEN = ") && text.contains(" G20\n"));
}

#[test]
fn block_numbers_start_again_behind_the_largest() {
    let mut path = Toolpath::builder(Point3::origin());
    for k in 0..11_000 {
        path.line(Point3::new(f64::from(k % 2 + 1), 0.0, 0.0), feed(100.0), Role::Cut).unwrap();
    }
    let program = Program { block_numbers: true, ..Program::plain(MM) };
    let text = written(&path.finish().unwrap(), &program, &cutting(), &[]).unwrap().text;
    assert!(text.contains("\nN99990 ") && !text.contains("N100000") && text.matches("\nN20 ").count() == 2);
}

#[test]
fn a_path_without_length_still_gives_a_whole_program() {
    for z in [0.0, 45.0, 100.0] {
        let mut path = Toolpath::builder(Point3::new(0.0, 0.0, z));
        path.line(Point3::new(0.0, 0.0, z), feed(1.0), Role::Cut).unwrap();
        path.rapid(Point3::new(0.0, 1e-5, z)).unwrap();
        path.dwell(0.0).unwrap();
        let path = path.finish().unwrap();
        for dialect in WORDS {
            let text = written_in(dialect, &path, &Program::plain(MM), &cutting(), &[]).unwrap().text;
            assert!(text.contains("\nM30\n") && !text.contains("G1 ") && !text.contains("-0"));
            // The first motion is across, at the height where the machine is; the next to the clearance plane
            // or above, with a length offset in force.
            let mut motions = text.lines().skip_while(|line| !line.starts_with("G0"));
            let (first, next) = (motions.next().unwrap(), motions.next().unwrap());
            assert!(first.starts_with("G0 X") && !first.contains('Z'), "{first}");
            assert!(next.ends_with(&format!("Z{:.3}", f64::max(z, 45.0))), "{next}");
            assert!(text.find("G43").is_some_and(|at| at < text.find(next).unwrap() + next.len()));
        }
    }
}

#[test]
fn a_value_that_no_program_can_hold_is_an_error() {
    let path = sample();
    let decimals = |decimals| Program::plain(Resolution { units: Units::Mm, decimals });
    for count in [0, 7, 255] {
        let error = written(&path, &decimals(count), &cutting(), &[]).unwrap_err();
        assert_eq!(error, WriteError::Decimals { decimals: count, max: 6 });
    }
    let offset = Program { work_offset: Some(60), ..Program::plain(MM) };
    let refused = written(&path, &offset, &cutting(), &[]);
    assert!(matches!(refused, Err(WriteError::Missing(Missing::WorkOffset { number: 60, .. }))));
    let still = Cutting { spindle_rpm: Some(-1.0), ..cutting() };
    assert_eq!(written(&path, &Program::plain(MM), &still, &[]), Err(WriteError::SpindleSpeed { rpm: -1.0 }));
    let nowhere = Cutting { clearance_z_mm: f64::NAN, ..cutting() };
    assert!(matches!(written(&path, &Program::plain(MM), &nowhere, &[]), Err(WriteError::Quantize(_))));
    let mut path = Toolpath::builder(Point3::origin());
    path.dwell(1e9).unwrap();
    let long = path.finish().unwrap();
    assert_eq!(
        written(&long, &Program::plain(MM), &cutting(), &[]),
        Err(WriteError::Dwell { seconds: 1e9, most_s: 1e6 })
    );
    let mut path = Toolpath::builder(Point3::origin());
    path.line(Point3::new(1.0, 0.0, 0.0), feed(1e-12), Role::Cut).unwrap();
    let slow = path.finish().unwrap();
    assert_eq!(
        written(&slow, &Program::plain(MM), &cutting(), &[]),
        Err(WriteError::Feed { mm_per_min: 1e-12 })
    );
}

#[test]
fn a_changed_program_fails_the_check() {
    let (program, cutting) = (Program::plain(MM), cutting());
    let job = ProgramJob { tool: Some(&TOOL), ..ProgramJob::plain(&program, &cutting, DIALECTS[0]) };
    let text = write(&sample(), &job, &Budget::unlimited()).unwrap().text;
    assert!(check_text(&text, &sample(), &job).is_ok());
    let changes = [
        ("Z0.000 F400", "Z0.001 F400", "place"),
        ("F400", "F401", "feed"),
        ("G3 X", "G2 X", "sense"),
        ("G1 Z", "G0 Z", "kind"),
        ("Y2.000\nG4", "Y2.000\nY2.000\nG4", "kind"),
        ("G4 P0.250", "G4 P0.251", "dwell"),
        ("Z45.000\nM5", "Z45.000\nX0.000\nM5", "end"),
        ("\nZ45.000\nM5", "\nM5", "end"),
        ("I-2.000 J0.000", "I-2.000 J0.010", "centre"),
    ];
    for (from, to, what) in changes {
        assert!(text.contains(from));
        let error = check_text(&text.replacen(from, to, 1), &sample(), &job).unwrap_err();
        assert!(matches!(error, WriteError::Differs { what: found, .. } if found == what), "{from} {error}");
    }
}

/// One random move, relative to where the tool is.
#[derive(Debug, Clone)]
enum Hop {
    Rapid([f64; 3]),
    Line([f64; 3], f64),
    Arc { plane: Plane, direction: Direction, radius: f64, angle: f64, sweep: f64, rise: f64, rate: f64 },
    Parabola { control: [f64; 3], by: [f64; 3], rate: f64 },
    Dwell(f64),
}

fn hops() -> impl Strategy<Value = Hop> {
    let along = || prop::array::uniform3(-20.0..20.0f64);
    let arc = (
        prop::sample::select(Plane::ALL.to_vec()),
        prop::sample::select(vec![Direction::Cw, Direction::Ccw]),
        (-1.5..3.9f64).prop_map(|size| 10f64.powf(size)),
        0.0..TAU,
        prop_oneof![0.01..TAU, Just(TAU)],
        prop_oneof![Just(0.0), -5.0..5.0f64],
        0.1..5000.0f64,
    );
    prop_oneof![
        1 => along().prop_map(Hop::Rapid),
        3 => (along(), 0.1..5000.0f64).prop_map(|(by, rate)| Hop::Line(by, rate)),
        6 => arc.prop_map(|(plane, direction, radius, angle, sweep, rise, rate)| {
            Hop::Arc { plane, direction, radius, angle, sweep, rise, rate }
        }),
        2 => (along(), along(), any::<bool>(), 0.1..5000.0f64).prop_map(|(control, by, level, rate)| {
            let [control, by] = [control, by].map(|[x, y, z]| [x, y, if level { 0.0 } else { z }]);
            Hop::Parabola { control, by, rate }
        }),
        1 => (0.0..10.0f64).prop_map(Hop::Dwell),
    ]
}

fn hop(path: &mut Builder, hop: &Hop) -> Result<(), toolpathd_core::toolpath::PathError> {
    let at = path.at();
    match *hop {
        Hop::Rapid(by) => path.rapid(at + Vector3::from(by)),
        Hop::Line(by, rate) => path.line(at + Vector3::from(by), feed(rate), Role::Cut),
        Hop::Dwell(seconds) => path.dwell(seconds),
        Hop::Parabola { control, by, rate } => {
            path.parabola(at + Vector3::from(by), at + Vector3::from(control), feed(rate), Role::Cut)
        }
        Hop::Arc { plane, direction, radius, angle, sweep, rise, rate } => {
            let turned = if direction == Direction::Ccw { angle + sweep } else { angle - sweep };
            let spoke = |angle: f64| Vector3::new(radius * angle.cos(), radius * angle.sin(), 0.0);
            let local = plane.to_local(&at);
            let center = local - spoke(angle);
            let mut end = if sweep == TAU { local } else { center + spoke(turned) };
            end.z = local.z + rise;
            let [end, center] = [end, center].map(|p| plane.to_workpiece(&p));
            path.arc(end, center, (plane, direction), feed(rate), Role::Cut)
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn the_text_has_the_lengths_and_times_of_the_toolpath(
        hops in prop::collection::vec(hops(), 1..30), inch: bool, numbers: bool,
        work_offset in prop::option::of(54u8..=59), dialect in prop::sample::select(WORDS.to_vec()),
    ) {
        let mut path = Toolpath::builder(Point3::new(1.0, 2.0, 50.0));
        for one in &hops {
            // The builder refuses a centre that rounding has moved off its arc; the tool then stays where it
            // is.
            let _ = hop(&mut path, one);
        }
        let path = path.finish().unwrap();
        let resolution = if inch { INCH } else { MM };
        let program = Program { block_numbers: numbers, work_offset, ..Program::plain(resolution) };
        let program = written_in(dialect, &path, &program, &cutting(), &[]).unwrap();
        let limit_mm = 1.5 * resolution.step_mm();
        prop_assert!(program.max_radius_mismatch_mm <= limit_mm && program.max_displacement_mm <= limit_mm);
        prop_assert_eq!(work_offset.is_some(), program.text.contains(&format!("G{}\n", work_offset.unwrap_or(0))));
        let (mut length, mut time, mut dwell) = (0.0, 0.0, 0.0);
        for placed in Reader::new(&program.text, dialect, limit_mm) {
            match placed.unwrap().step {
                Step::Feed { along, rate, .. } => {
                    length += along.length();
                    time += along.length() / rate.mm_per_min() * 60.0;
                }
                Step::Dwell { seconds } => dwell += seconds,
                Step::Rapid { .. } | Step::Posed(_) | Step::Rail(_) | Step::Hole(_) => {}
            }
        }
        let measures = measure(&path, feed(10_000.0));
        prop_assert!((length - measures.cutting_length_mm).abs() <= 1e-3 * measures.cutting_length_mm + 0.01);
        let cutting_time_s = measures.cutting_time_s.unwrap();
        prop_assert!((time - cutting_time_s).abs() <= 1e-3 * cutting_time_s + 0.1);
        prop_assert!((dwell - measures.dwell_time_s).abs() <= 5e-4 * hops.len() as f64);
        check_words(&program.text, dialect, resolution)?;
    }

    #[test]
    fn user_text_stays_in_comments(
        name in "(?s).{0,300}", note in "[(]?(MSG|LOG|DEBUG|PRINT|PROBEOPEN)[,)%\n].{0,50}", numbers: bool,
        dialect in prop::sample::select(WORDS.to_vec()),
    ) {
        let job = Program { name: Some(name), block_numbers: numbers, ..Program::plain(MM) };
        let notes = [note, "x".repeat(10_000), ")\n%".repeat(3_000)];
        let text = written_in(dialect, &sample(), &job, &cutting(), &notes).unwrap().text;
        prop_assert!(text.is_ascii());
        let Iso { comment: Comment { open, separator, close }, tape_mark, .. } = iso(dialect);
        let labels = ["PROGRAM", "NOTE", "WRITTEN", "TOOL", "FEED", "SPINDLE", "RANGE", "TIME", "ROUNDING", "WARNING"];
        let mut remarks = 0;
        for line in text.lines() {
            prop_assert!(line.len() <= dialect.max_line_length);
            let block = line.split_once(' ').filter(|_| numbers && line.starts_with('N')).map_or(line, |(_, block)| block);
            // The line of the program number also has the program's name.
            let block = block.strip_prefix('O').map_or(block, |rest| rest.trim_start_matches(|c: char| c.is_ascii_digit()));
            let named = block.strip_prefix(" (").and_then(|rest| rest.strip_suffix(')'));
            if let Some(name) = named {
                let is_plain = |c: u8| c.is_ascii_uppercase() || c.is_ascii_digit() || b" ._-/+,=#'".contains(&c);
                prop_assert!(name.bytes().all(is_plain), "{line}");
                continue;
            }
            let words = block.strip_prefix(open).and_then(|rest| rest.strip_suffix(close));
            if let Some((label, rest)) = words.and_then(|words| words.split_once(separator)) {
                let is_plain = |c: u8| c.is_ascii_uppercase() || c.is_ascii_digit() || b" ._-/+,=#'".contains(&c);
                prop_assert!(labels.contains(&label) && rest.bytes().all(is_plain), "{line}");
                remarks += 1;
            } else {
                prop_assert!(!block.contains(['(', ')', ':', '=']), "{line}");
                prop_assert!(!block.contains('%') || Some(block) == tape_mark);
            }
        }
        prop_assert!(remarks >= 8);
        prop_assert_eq!(text.matches('%').count(), if tape_mark.is_some() { 2 } else { 0 });
    }
}

/// Checks a text as characters: the decimals of every coordinate, no lower case, no exponent, no minus zero.
fn check_words(text: &str, dialect: &Dialect, resolution: Resolution) -> Result<(), TestCaseError> {
    let header = |line: &&str| line.contains(iso(dialect).comment.open);
    for line in text.lines().filter(|line| !header(line)) {
        prop_assert!(
            !line.contains(|c: char| c.is_ascii_lowercase()) && line.len() <= dialect.max_line_length
        );
        for word in line.split(' ').filter(|word| word.starts_with(['X', 'Y', 'Z', 'I', 'J', 'K'])) {
            let (whole, fraction) = word[1..].split_once('.').expect("a decimal point");
            let is_digits = |text: &str| !text.is_empty() && text.bytes().all(|c| c.is_ascii_digit());
            prop_assert!(
                is_digits(whole.strip_prefix('-').unwrap_or(whole)) && is_digits(fraction),
                "{line}"
            );
            prop_assert_eq!(fraction.len(), usize::from(resolution.decimals));
            let is_zero = word[1..].bytes().all(|c| b"-.0".contains(&c));
            prop_assert!(!is_zero || !whole.starts_with('-'), "{line}");
        }
        for word in line.split(' ').filter(|word| word.starts_with('F')) {
            prop_assert!(word.contains('.') || dialect.numbers.point == Point::WhereNeeded, "{line}");
        }
    }
    Ok(())
}

#[test]
fn an_arc_flatter_than_half_a_unit_is_written_as_a_line() {
    let mut path = Toolpath::builder(Point3::origin());
    let (r, half) = (5000.0, 2e-4f64);
    let (end, center) =
        (Point3::new(2.0 * r * half.sin(), 0.0, 0.0), Point3::new(r * half.sin(), -r * half.cos(), 0.0));
    path.arc(end, center, (Plane::Xy, Direction::Cw), feed(100.0), Role::Cut).unwrap();
    let text = written(&path.finish().unwrap(), &Program::plain(MM), &cutting(), &[]).unwrap().text;
    let kinds: Vec<_> = Reader::new(&text, DIALECTS[0], 0.0015)
        .filter_map(|placed| match placed.unwrap().step {
            Step::Feed { along, .. } => Some(matches!(along, Curve::Line(_))),
            _ => None,
        })
        .collect();
    assert_eq!(kinds, [true]);
}
