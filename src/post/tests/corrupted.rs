//! Each word of a program changed, dropped, doubled and swapped with the next one: the check finds each of
//! them, but for those that change nothing.

use super::posed::leaning;
use super::*;
use crate::dialects::mach4::MACH4;
use toolpathd_core::machine::{Straying, named};

/// Words that may be dropped, and why they change nothing.
const IDLE: [(&str, &str); 11] = [
    ("G40", "ends a compensation of the radius that no program begins"),
    ("G49", "ends a length offset before one is selected"),
    ("G80", "ends a cycle that no program begins"),
    ("R0", "ends a compensation of the radius that no program begins"),
    ("ORIWKS", "states the frame of vectors in a program with angles"),
    ("POLYPATH(\"AXES\",\"VECT\")", "lets polynomials turn the axis in a program without polynomials"),
    ("G94", "states a mode before G93, or at the end of the program"),
    ("G0", "restates the motion of the rapid before"),
    ("G91.1", "states how centres count in a program without arcs"),
    ("I0.000", "an offset that is absent is zero"),
    ("J0.000", "an offset that is absent is zero"),
];

/// Whether a corruption changes nothing, as the manuals have it.
fn is_idle(dialect: &Dialect, line: &str, word: &str, corruption: Corruption) -> bool {
    // A control without length offsets takes the plane for its arcs alone, each of which states it.
    if word == "G17" && dialect.abilities.length_offsets.is_none() {
        return matches!(corruption, Corruption::Changed | Corruption::Dropped | Corruption::Swapped);
    }
    let is_arc = ["G2 ", "G3 ", " I", " DR"].iter().any(|arc| line.contains(arc));
    match corruption {
        // Blocks of ISO words have no order. Klartext takes coordinates in two orders.
        Corruption::Swapped => {
            !matches!(dialect.syntax, Syntax::Klartext | Syntax::Deckel) || word.starts_with('X')
        }
        Corruption::Dropped => {
            // An arc restates the coordinates that it keeps.
            let is_restated = is_arc && word.starts_with(['X', 'Y', 'Z']);
            is_restated || word == "K0.000" || IDLE.iter().any(|(idle, _)| *idle == word)
        }
        Corruption::Changed | Corruption::Negated | Corruption::Doubled => false,
    }
}

/// One way to corrupt a word.
#[derive(Clone, Copy, PartialEq)]
enum Corruption {
    Changed,
    Negated,
    Dropped,
    Doubled,
    Swapped,
}

impl Corruption {
    const ALL: [Self; 5] = [Self::Changed, Self::Negated, Self::Dropped, Self::Doubled, Self::Swapped];

    const fn name(self) -> &'static str {
        match self {
            Self::Changed => "changed",
            Self::Negated => "negated",
            Self::Dropped => "dropped",
            Self::Doubled => "doubled",
            Self::Swapped => "swapped",
        }
    }

    /// A line whose word `k` is corrupted; `None` where the word has no such fault.
    fn line(self, words: &[&str], k: usize) -> Option<String> {
        let mut words: Vec<String> = words.iter().map(|word| (*word).to_owned()).collect();
        match self {
            Self::Changed => {
                let at = words[k].rfind(|c: char| c.is_ascii_digit())?;
                let digit = words[k].as_bytes()[at] - b'0';
                words[k].replace_range(at..=at, &((digit + 1) % 10).to_string());
            }
            Self::Negated => {
                let at = words[k].find(|c: char| c.is_ascii_digit() || "+-.".contains(c))?;
                if !words[k][at..].contains(|c: char| ('1'..='9').contains(&c)) {
                    return None;
                }
                let text = match words[k].as_bytes()[at] {
                    b'-' => words[k].replacen('-', if words[k].contains('+') { "+" } else { "" }, 1),
                    b'+' => words[k].replacen('+', "-", 1),
                    _ => format!("{}-{}", &words[k][..at], &words[k][at..]),
                };
                words[k] = text;
            }
            Self::Dropped => {
                words.remove(k);
            }
            Self::Doubled => words.insert(k, words[k].clone()),
            Self::Swapped if k + 1 < words.len() => words.swap(k, k + 1),
            Self::Swapped => return None,
        }
        Some(words.join(" "))
    }
}

/// Whether a line is for people alone.
fn is_comment(line: &str) -> bool {
    let text = line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start();
    text.starts_with(['(', ';'])
}

/// The corruptions of a written program that change something and that its check does not find. `tried`
/// counts all corruptions.
pub fn survivors(operations: &[Operation], tried: &mut usize) -> Vec<String> {
    let (budget, dialect) = (Budget::unlimited(), operations[0].job.dialect);
    let parts = parts(operations, &budget).unwrap();
    let text = write_all(operations, &budget).unwrap().text;
    check::read_back(&text, &[], &parts, &budget).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let mut survivors = Vec::new();
    for (at, line) in lines.iter().enumerate().filter(|(_, line)| !is_comment(line)) {
        let words: Vec<&str> = line.split(' ').collect();
        for (k, corruption) in (0..words.len()).flat_map(|k| Corruption::ALL.map(|own| (k, own))) {
            let Some(wrong) = corruption.line(&words, k) else { continue };
            if wrong == *line {
                continue;
            }
            let mut corrupted = lines.clone();
            corrupted[at] = &wrong;
            let corrupted = format!("{}\n", corrupted.join("\n"));
            *tried += 1;
            let passes = check::read_back(&corrupted, &[], &parts, &budget).is_ok();
            if passes && !is_idle(dialect, line, words[k], corruption) {
                survivors.push(format!("{} {}: {line}", words[k], corruption.name()));
            }
        }
    }
    survivors
}

#[test]
fn each_corrupted_word_is_found_unless_it_changes_nothing() {
    let table = named::by_name("table_table_ac").unwrap();
    let (mut found, mut tried) = (Vec::new(), 0);
    for dialect in DIALECTS {
        let abilities = &dialect.abilities;
        let length_offset = TOOL.length_offset.filter(|_| abilities.length_offsets.is_some());
        let tool = Tool { length_offset, ..TOOL };
        let program = Program {
            work_offset: abilities.work_offsets.get(1).copied(),
            safe_home: *abilities.safe_homes.last().unwrap(),
            number: 12,
            ..Program::plain(MM)
        };
        let coolant = abilities.coolants.iter().find(|own| **own == Coolant::Flood);
        let cutting = Cutting { coolant: coolant.copied().unwrap_or_default(), ..cutting() };
        let upright = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
        let path = if abilities.has_dwells { sample() } else { without_dwells() };
        let mut judge = |toolpath: &Toolpath, job: ProgramJob| {
            let own = survivors(&[Operation { name: None, toolpath, job }], &mut tried);
            found.extend(own.into_iter().map(|own| (dialect.name, own)));
        };
        judge(&path, upright);
        for output in dialect.five_axes.outputs() {
            let allowed = Straying { tip_mm: 1.0, axis: 1.0 };
            let five_axes =
                Some(FiveAxes { output, machine: Some(&table), allowed, speeds: [f64::INFINITY; 5] });
            judge(&leaning(), ProgramJob { five_axes, ..upright });
        }
    }
    assert!(found.is_empty(), "{} of {tried}: {found:#?}", found.len());
    assert!(tried > 5000, "{tried}");
}

fn without_dwells() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(1.0, 2.0, 45.0));
    path.rapid(Point3::new(0.0, 0.0, 12.0)).unwrap();
    path.line(Point3::new(0.0, 0.0, 0.0), feed(400.0), Role::Plunge).unwrap();
    path.line(Point3::new(10.0, 2.0, 0.0), feed(800.0), Role::Cut).unwrap();
    path.rapid(Point3::new(0.0, 0.0, 12.0)).unwrap();
    path.finish().unwrap()
}

#[test]
fn a_line_that_is_left_out_is_found() {
    let (program, cutting) =
        (Program { work_offset: Some(54), safe_home: SafeHome::G53, ..Program::plain(MM) }, cutting());
    for dialect in [&LINUXCNC, &FANUC, &MACH4] {
        let job = ProgramJob { tool: Some(&TOOL), ..ProgramJob::plain(&program, &cutting, dialect) };
        let text = write(&sample(), &job, &Budget::unlimited()).unwrap().text;
        let centers = (dialect.name == MACH4.name).then_some("G91.1");
        for line in
            ["G54", "T3 M6", "S12000 M3", "M8", "M5", "M9", "G53 G0 Z0.000"].into_iter().chain(centers)
        {
            let line = format!("\n{line}\n");
            assert!(text.contains(&line), "{line}");
            // The first of these lines, and the last.
            let (head, tail) = text.rsplit_once(&line).unwrap();
            for wrong in [text.replacen(&line, "\n", 1), format!("{head}\n{tail}")] {
                let read = check_text(&wrong, &sample(), &job);
                let is_found = matches!(read, Err(WriteError::Differs { .. } | WriteError::Unreadable(_)));
                assert!(is_found, "{line}: {read:?}");
            }
        }
    }
}
