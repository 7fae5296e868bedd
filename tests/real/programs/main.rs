//! Compares the reader of programs with LinuxCNC's interpreter.
//!
//! * Random programs of lines, arcs in three planes, helices, turns, cycles, pauses, variables, loops,
//!   subroutines, saved modes and turned work offsets, in mm and inches. Lengths of cuts and of rapids,
//!   pauses and the end agree within the four decimals that the interpreter prints.
//! * Random contours with cutter compensation to the left and to the right.
//! * The same programs with one change each: a word left out, doubled, or of another value. What the
//!   interpreter refuses is refused here.
//! * Programs in the directories given as arguments: read to the same figures, or refused.

mod canon;
mod random;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::{env, fs};

use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::measure::measure;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_nc::control::Control;
use toolpathd_nc::machine::{Correction, Cutter};
use toolpathd_nc::{ReadError, ReadJob, read};

use canon::Figures;

/// Number of random programs, unless the variable `PROGRAMS` says another. A program takes some 50 ms.
const PROGRAMS: u64 = 400;

fn main() -> ExitCode {
    let count = env::var("PROGRAMS").ok().and_then(|text| text.parse().ok()).unwrap_or(PROGRAMS);
    let directory = env::temp_dir().join(format!("toolpathd-programs-{}", std::process::id()));
    fs::create_dir_all(&directory).expect("a directory");
    let mut tally = Tally::default();
    for argument in env::args().skip(1) {
        for path in programs(Path::new(&argument)) {
            let text = fs::read(&path).expect("a program");
            let told = tally.compare(&text, &directory);
            println!("{}: {told}", path.display());
        }
    }
    tally.tell("programs of others");
    for seed in 0..count {
        let text = random::program(seed);
        tally.compare(text.as_bytes(), &directory);
        tally.compare(random::changed(&text, seed).as_bytes(), &directory);
        tally.compare(random::compensated(seed).as_bytes(), &directory);
    }
    tally.tell("programs");
    for fault in tally.wrong.iter().take(10) {
        eprintln!("{fault}\n");
    }
    eprintln!("{} programs differ", tally.wrong.len());
    let _ = fs::remove_dir_all(&directory);
    if tally.wrong.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// The programs in a directory and in those within it, in the order of their names.
fn programs(directory: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(directory).expect("a directory");
    let mut paths: Vec<_> = entries.map(|entry| entry.expect("a file").path()).collect();
    paths.sort();
    let mut found = Vec::new();
    for path in paths {
        let is_program = path.extension().is_some_and(|own| own == "ngc" || own == "nc");
        if path.is_symlink() {
            continue;
        }
        if path.is_dir() {
            found.extend(programs(&path));
        } else if is_program {
            found.push(path);
        }
    }
    found
}

#[derive(Default)]
struct Tally {
    agree: usize,
    both_refuse: usize,
    only_here: usize,
    wrong: Vec<String>,
}

impl Tally {
    fn tell(&self, what: &str) {
        let Self { agree, both_refuse, only_here, .. } = self;
        println!(
            "{what}: {agree} agree, {both_refuse} are refused by both, {only_here} are refused here alone"
        );
    }

    fn compare(&mut self, text: &[u8], directory: &Path) -> String {
        let theirs = canon::interpret(text, directory);
        let ours = figures(text);
        let shown = || String::from_utf8_lossy(&text[..text.len().min(3000)]).into_owned();
        match (ours, theirs) {
            (Ok(ours), Ok(theirs)) => match ours.difference(&theirs) {
                None => {
                    self.agree += 1;
                    format!("agrees, {:.3} mm of cuts", ours.cut_mm)
                }
                Some(difference) => {
                    self.wrong.push(format!("{difference}\n{}", shown()));
                    difference
                }
            },
            (Err(_), Err(_)) => {
                self.both_refuse += 1;
                "refused by both".to_owned()
            }
            (Err(fault), Ok(_)) => {
                self.only_here += 1;
                if env::var_os("TELL").is_some() {
                    println!("refused here alone: {fault}");
                }
                format!("refused here alone: {fault}")
            }
            // Programs of the machine's own, which only its installation has.
            (Ok(_), Err(fault)) if fault.contains("Unknown m code used: M1") => {
                "has a code of one machine".to_owned()
            }
            (Ok(_), Err(fault)) => {
                self.wrong.push(format!("the interpreter refuses: {fault}\n{}", shown()));
                format!("the interpreter refuses: {fault}")
            }
        }
    }
}

/// The figures of this package's reader, which starts where the interpreter does.
fn figures(text: &[u8]) -> Result<Figures, String> {
    let control = Control::named("linuxcnc").expect("a control");
    let cutter = |number| Cutter { number: Some(number), radius_mm: canon::CUTTER_RADIUS_MM };
    let cutters: Vec<Cutter> = canon::TOOLS.map(cutter).collect();
    let correction = Correction::Computed(&cutters);
    let plain = ReadJob::plain(text, control);
    let offsets: Vec<_> = (1..=9).map(|number| (number, [0.0; 3])).collect();
    let start = [Some(0.0); 3];
    let job = ReadJob { start, offsets: &offsets, most_moves: 1_000_000, correction, ..plain };
    match read(&job, &Budget::unlimited()) {
        Ok(reading) => {
            let measures = measure(&reading.toolpath, FeedRate::DEFAULT_RAPID);
            Ok(Figures {
                cut_mm: measures.cutting_length_mm,
                cut_s: measures.cutting_time_s.unwrap_or(0.0),
                rapid_mm: measures.rapid_length_mm,
                dwell_s: measures.dwell_time_s,
                end: reading.end.map(|x| x.unwrap_or(f64::NAN)),
                moves: reading.lines.len(),
                has_unknown_rapids: reading.n_rapids_not_counted > 0,
                has_splines: false,
            })
        }
        Err(ReadError::NoMotion) => Ok(Figures { has_unknown_rapids: true, ..Figures::default() }),
        Err(error) => Err(error.to_string()),
    }
}
