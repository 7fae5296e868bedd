//! Random programs: lines outside of runs stay unchanged, and the path of each run stays within the
//! tolerance.

use proptest::prelude::*;

use super::evaluator::{SAGITTA_MM, Stop, distance, stops};
use super::*;

/// Lines that end runs. Each has a comment with a number in it, which a control may obey, so that both
/// programs can be compared there.
const BARRIERS: &[&str] = &[
    "(MSG,@)",
    "G0 X# Y# (MSG,@)",
    "G1 X# Y# (MSG,@)",
    "X# Y# (MSG,@)",
    "Y# M8 (MSG,@)",
    "G17 (MSG,@)",
    "G18 (MSG,@)",
    "G19 (MSG,@)",
    "G90 (MSG,@)",
    "G91 (MSG,@)",
    "G41 D1 (MSG,@)",
    "G40 (MSG,@)",
    "G68 X0 Y0 R0 (MSG,@)",
    "G69 (MSG,@)",
    "M5 (MSG,@)",
    "F250 (MSG,@)",
    "#1=5 (MSG,@)",
    "G1 (MSG,@)",
    "G90.1 (MSG,@)",
    "G91.1 (MSG,@)",
    "/M8 (MSG,@)",
    "\u{e9} (MSG,@)",
    "% (MSG,@)",
    "G4 P1 (MSG,@)",
    "G20 (MSG,@)",
    "G21 (MSG,@)",
    "N5 Z# (MSG,@)",
    "G61 (MSG,@)",
    "G187 P2 E0.1 (MSG,@)",
    "G64 (MSG,@)",
    "A5 (MSG,@)",
    "G0 X0 Y0 Z0 (MSG,@)",
    "G90 G0 X0 Y0 Z0 (MSG,@)",
    "G17 G21 G90 G40 G69 G64 G91.1 (MSG,@)\nG0 X# Y# Z# (MSG,@)\nG1 F90 (MSG,@)",
];

#[derive(Debug, Clone)]
enum Part {
    Barrier(usize, [i64; 3]),
    /// Steps along a path that turns and rises, in thousandths.
    Run {
        plane: usize,
        n: usize,
        radius: f64,
        start: f64,
        step: f64,
        rise: f64,
        jitter: u8,
    },
    Blank,
}

fn part() -> impl Strategy<Value = Part> {
    let coordinate = -50_000i64..50_000;
    let run =
        (0usize..3, 1usize..60, 1.0..100.0, 0.0..6.3, -0.2..0.2, prop_oneof![Just(0.0), -0.1..0.1], 0u8..4);
    prop_oneof![
        4 => (0..BARRIERS.len(), [coordinate.clone(), coordinate.clone(), coordinate])
            .prop_map(|(kind, numbers)| Part::Barrier(kind, numbers)),
        2 => Just(Part::Barrier(BARRIERS.len() - 1, [1000, 2000, 3000])),
        6 => run.prop_map(|(plane, n, radius, start, step, rise, jitter)| {
            Part::Run { plane, n, radius, start, step, rise, jitter }
        }),
        1 => Just(Part::Blank),
    ]
}

#[derive(Debug, Clone, Copy)]
struct Looks {
    is_spaced: bool,
    end: &'static str,
    /// What stands behind each block of a run; `@` is the number of the block.
    remark: &'static str,
    is_numbered: bool,
    says_g1: bool,
    is_padded: bool,
}

/// The text of the parts. It follows the position as the evaluator does, so that the runs go where they
/// should.
fn program(parts: &[Part], looks: Looks) -> String {
    let end = looks.end;
    let mut text =
        String::from("G17 G21 G90 G94 (start)\nG0 X0 Y0 Z0 (start)\nG1 F100 (start)\n").replace('\n', end);
    for (k, part) in parts.iter().enumerate() {
        match part {
            Part::Blank => text.push_str(end),
            Part::Barrier(kind, numbers) => {
                let mut line = BARRIERS[*kind].replace('@', &k.to_string()).replace('\n', end);
                for number in numbers.iter().cycle() {
                    if !line.contains(['#']) || line.starts_with('#') {
                        break;
                    }
                    line = line.replacen('#', &format!("{}", *number as f64 / 1000.0), 1);
                }
                text.push_str(&line);
                text.push_str(end);
            }
            Part::Run { plane, n, radius, start, step, rise, jitter } => {
                let state = stops(&text, 1.0).pop().unwrap().state;
                let at: [i64; 3] =
                    std::array::from_fn(|axis| (state.at[axis] / state.unit * 1000.0).round() as i64);
                let mut before = at;
                for i in 1..=*n {
                    let to = turned(at, *plane, [*radius, *start, *step, *rise], i, *jitter);
                    block(&mut text, [before, to], i, state.is_absolute, looks);
                    if *jitter == 3 && i % 11 == 5 {
                        let _ = write!(text, "F{}", i / 22 + 3);
                    }
                    text.push_str(&looks.remark.replace('\n', end).replace('@', &i.to_string()));
                    text.push_str(end);
                    before = to;
                }
            }
        }
    }
    text
}

fn turned(
    from: [i64; 3],
    plane: usize,
    [radius, start, step, rise]: [f64; 4],
    i: usize,
    jitter: u8,
) -> [i64; 3] {
    let axes = [[0, 1, 2], [2, 0, 1], [1, 2, 0]][plane];
    let angle = start + step * i as f64;
    let noise = |k: usize| if jitter == 0 { 0.0 } else { ((i * 7 + k * 3) % 5) as f64 * f64::from(jitter) };
    let moved = [
        1000.0 * radius * (angle.cos() - start.cos()) + noise(0),
        1000.0 * radius * (angle.sin() - start.sin()) + noise(1),
        1000.0 * rise * i as f64,
    ];
    let mut to = from;
    for (axis, moved) in axes.into_iter().zip(moved) {
        to[axis] += moved.round() as i64;
    }
    to
}

fn block(text: &mut String, [from, to]: [[i64; 3]; 2], i: usize, is_absolute: bool, looks: Looks) {
    let gap = if looks.is_spaced { " " } else { "" };
    let mut words = Vec::new();
    if looks.is_numbered {
        words.push(format!("N{}", i * 10));
    }
    if looks.says_g1 || i == 1 {
        words.push("G1".to_owned());
    }
    for axis in 0..3 {
        if from[axis] != to[axis] || axis == 0 {
            let units = if is_absolute { to[axis] } else { to[axis] - from[axis] };
            let value = units as f64 / 1000.0;
            let letter = ['X', 'Y', 'Z'][axis];
            words.push(if looks.is_padded {
                format!("{letter}{value:.3}")
            } else {
                format!("{letter}{value}")
            });
        }
    }
    text.push_str(&words.join(gap));
}

/// The line without an added G1, and without blanks.
fn without_g1(line: &str) -> String {
    line.replace([' ', '\r'], "")
        .replace("G1X", "X")
        .replace("G1Y", "Y")
        .replace("G1Z", "Z")
        .replace("G1A", "A")
}

fn compare(one: &Stop, other: &Stop) -> Result<(), TestCaseError> {
    prop_assert_eq!(without_g1(&one.line), without_g1(&other.line));
    let apart = distance(&one.path, &other.path);
    prop_assert!(apart <= TOLERANCE_MM + SAGITTA_MM, "{} mm before {}", apart, one.line);
    let (a, b) = (one.state, other.state);
    prop_assert!((a.at - b.at).norm() < 1e-9, "{:?} {:?} at {}", a, b, one.line);
    prop_assert_eq!((a.unit, a.is_absolute, a.feed), (b.unit, b.is_absolute, b.feed));
    prop_assert_eq!(a.has_absolute_centers, b.has_absolute_centers);
    let depends = one.line.starts_with(['#', '%', '/', '\u{e9}']);
    if one.moves || depends {
        prop_assert_eq!(a.motion, b.motion, "at {}", one.line);
    }
    if depends {
        prop_assert_eq!(a.plane, b.plane, "at {}", one.line);
    }
    Ok(())
}

fn looks() -> impl Strategy<Value = Looks> {
    let ends = prop::sample::select(&["\n", "\r\n", "\r"][..]);
    let remarks = prop::sample::select(&["", "", " ; c@", "\n; r@", "\n\n", ";", ";c@\n;r@"][..]);
    let flags = (any::<bool>(), ends, remarks, any::<bool>(), any::<bool>(), any::<bool>());
    flags.prop_map(|(is_spaced, end, remark, is_numbered, says_g1, is_padded)| Looks {
        is_spaced,
        end,
        remark,
        is_numbered,
        says_g1,
        is_padded,
    })
}

/// The comments behind semicolons, in order.
fn remarks(text: &str) -> Vec<&str> {
    let inside =
        text.split(['\n', '\r']).filter_map(|line| line.split_once(';')).map(|(_, text)| text.trim());
    inside.filter(|text| !text.is_empty()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn the_path_and_every_other_line_stay(parts in prop::collection::vec(part(), 1..14), looks in looks()) {
        let input = program(&parts, looks);
        let (output, figures) = rewritten_as(&LINUXCNC, input.as_bytes(), usize::MAX);
        let output = String::from_utf8(output).unwrap();
        let (one, other) = (stops(&input, 1.0), stops(&output, 1.0));
        prop_assert_eq!(one.len(), other.len());
        for (one, other) in one.iter().zip(&other) {
            compare(one, other).map_err(|e| TestCaseError::fail(format!("{e}\n{input}\n=>\n{output}")))?;
        }
        prop_assert_eq!(remarks(&input), remarks(&output));
        let LeftAlone { macros, other_axes, modes, labels, others, short_runs } = figures.left_alone;
        let left_alone = macros + other_axes + modes + labels + others + short_runs;
        prop_assert_eq!(figures.n_motions, figures.n_points + figures.n_other_motions + left_alone);
        prop_assert!(figures.deviation_max_mm <= TOLERANCE_MM);
        prop_assert!(figures.n_arcs + figures.n_lines <= figures.n_points);
    }

    #[test]
    fn the_output_does_not_depend_on_the_chunks(parts in prop::collection::vec(part(), 1..6), looks in looks(), cut in 1usize..60) {
        let input = program(&parts, looks);
        let (whole, _) = rewritten_as(&LINUXCNC, input.as_bytes(), usize::MAX);
        for cut in [1, cut] {
            let (cut, _) = rewritten_as(&LINUXCNC, input.as_bytes(), cut);
            prop_assert_eq!(&cut, &whole);
        }
    }

    #[test]
    fn random_bytes_pass_unchanged(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        let (output, _) = rewritten_as(&LINUXCNC, &bytes, 7);
        prop_assert_eq!(output, bytes);
    }

    #[test]
    fn random_words_are_accepted(text in "([GXYZFNIJ] ?-?[0-9]{0,3}\\.?[0-9]{0,4} ?|\n|\r\n|/|%|;|\\(|G1X|G91){0,120}") {
        let (output, figures) = rewritten_as(&LINUXCNC, text.as_bytes(), 11);
        prop_assert!(figures.n_runs > 0 || output.len() >= text.len());
    }
}
