//! Compares written programs with LinuxCNC's interpreter: the control must move as the toolpath says.
//!
//! * 1,000 random toolpaths in three planes, in mm and inches, in each dialect of plain words in turn. The
//!   control's path and the toolpath lie within 1.5 units of the last decimal of each other, in order.
//!   Lengths and times agree with `measure`.
//! * A curve interpolated by parabolas. Every point of the control's path lies within the band of the curve,
//!   widened by the rounding.
//! * Random canned cycles, in each dialect of plain words that has them. The reader reads the place of each
//!   hole, its retract plane, its bottom, the depth of its pecks, its pause, its feed and the height at which
//!   it ends. The control makes the motions that its manual gives for such a hole.
//! * Programs of G1 blocks, rewritten with arcs. The control's paths before and after lie within the
//!   tolerance of each other.
//! * Every program in the directories given as arguments. The control makes the motions that the reader of
//!   this package reads.
//!
//! For spline blocks the check compares the curve that the interpreter computes. The control then replaces
//! the curve by arcs; `toolpath/quantize/biarcs` bounds how far these arcs leave the curve.
//!
//! Where the variable `GVALIDATE` names the parser of GRBL (`gvalidate` of grbl-sim), that parser has to
//! accept every program in the dialect of GRBL.
//!
//! A program in the dialect of another control is translated where LinuxCNC reads the same words differently.

mod arcs;
mod canon;
mod compare;
mod curve;
mod hole;
mod holes;
mod random;

use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::{env, fs, process, thread};

use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cutting::{Coolant, Cutting};
use toolpathd_core::toolpath::program::{Program, Resolution, SafeHome, Units};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_post::{DIALECTS, Dialect, ProgramJob};

/// Number of random toolpaths, unless the variable `CONTROLLER_TOOLPATHS` says another.
const TOOLPATHS: usize = 1_000;
/// Threads that check random toolpaths.
const WORKERS: usize = 2;

/// One in this many toolpaths is also written with G28 and with G53.
const HOMED: usize = 10;

fn main() -> ExitCode {
    let directory = env::temp_dir().join(format!("toolpathd-controller-{}", process::id()));
    let result = run(&directory);
    // After a failure the files stay, so that people can look at them.
    if result.is_ok() && fs::remove_dir_all(&directory).is_err() {
        eprintln!("{} is left", directory.display());
    }
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(fault) => {
            eprintln!("controller: {fault}\nsee {}", directory.display());
            ExitCode::FAILURE
        }
    }
}

fn run(directory: &Path) -> Result<(), String> {
    fs::create_dir_all(directory).map_err(|error| error.to_string())?;
    let mut programs = Vec::new();
    for argument in env::args().skip(1) {
        programs.extend(programs_in(Path::new(&argument))?);
    }
    for path in &programs {
        let text = fs::read_to_string(path).map_err(|error| error.to_string())?;
        let dialect = dialect_of(path).ok_or("no dialect")?;
        let text = without_homes(&text);
        let figures = canon::interpret(&canon::translated(&text, dialect), directory, "example")
            .and_then(|motions| compare::with_text(&text, dialect, &motions))
            .map_err(|e| format!("{}: {e}", path.display()))?;
        println!("{}: {figures}", path.display());
    }
    println!("a curve: {}", curve::check(directory)?);
    println!("rewritten: {}", arcs::check(directory)?);
    println!("canned cycles: {}", holes::check(directory)?);
    let next = AtomicUsize::new(0);
    let all: Result<Vec<compare::Figures>, String> = thread::scope(|scope| {
        let workers: Vec<_> = (0..WORKERS).map(|_| scope.spawn(|| check_random(directory, &next))).collect();
        workers.into_iter().map(|worker| worker.join().map_err(|_| "a worker stopped".to_string())?).collect()
    });
    let figures = all?.into_iter().fold(compare::Figures::default(), compare::Figures::and);
    println!("{} random toolpaths: {figures}", toolpaths());
    Ok(())
}

fn check_random(directory: &Path, next: &AtomicUsize) -> Result<compare::Figures, String> {
    let mut figures = compare::Figures::default();
    loop {
        let seed = next.fetch_add(1, Ordering::Relaxed);
        if seed >= toolpaths() {
            return Ok(figures);
        }
        let case = random::case(seed as u64);
        // Every fifth program is in inches, where the printed decimals of the interpreter are coarser.
        let resolution = if seed % 5 == 3 {
            Resolution { units: Units::Inch, decimals: 4 }
        } else {
            Resolution { units: Units::Mm, decimals: 3 }
        };
        let program = Program {
            name: Some(format!("random {seed}")),
            block_numbers: seed.is_multiple_of(7),
            work_offset: seed.is_multiple_of(3).then_some(54),
            ..Program::plain(resolution)
        };
        let dialect = dialects()[seed % dialects().len()];
        let can = dialect.abilities;
        let length_offset = case.tool.length_offset.filter(|_| can.length_offsets.is_some());
        let tool = Tool { length_offset, ..case.tool };
        let coolant = Some(case.cutting.coolant).filter(|coolant| can.coolants.contains(coolant));
        let cutting = Cutting { coolant: coolant.unwrap_or(Coolant::Off), ..case.cutting };
        let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
        let name = format!("random{seed}-{}", dialect.name);
        let found = toolpathd_post::write(&case.toolpath, &job, &Budget::unlimited())
            .map_err(|error| error.to_string())
            .and_then(|written| {
                if dialect.name == "grbl" {
                    accepted_by_grbl(&written.text, directory, &name)?;
                }
                let motions = canon::interpret(&canon::translated(&written.text, dialect), directory, &name)?;
                for safe_home in [SafeHome::G28, SafeHome::G53] {
                    if seed.is_multiple_of(HOMED) {
                        cuts_alike_from_home(&case.toolpath, &job, safe_home, directory, &motions)?;
                    }
                }
                let text = compare::with_text(&written.text, dialect, &motions)?;
                let path = compare::with_toolpath(&case.toolpath, &motions, resolution, &dialect.curves)?;
                Ok(text.and(path))
            })
            .map_err(|error| format!("{name}: {error}"))?;
        figures = figures.and(found);
    }
}

/// Number of random toolpaths.
fn toolpaths() -> usize {
    env::var("CONTROLLER_TOOLPATHS").ok().and_then(|count| count.parse().ok()).unwrap_or(TOOLPATHS)
}

/// Checks that GRBL's parser accepts a program, where one is named.
fn accepted_by_grbl(text: &str, directory: &Path, name: &str) -> Result<(), String> {
    let Ok(parser) = env::var("GVALIDATE") else { return Ok(()) };
    let file = directory.join(format!("{name}.gcode"));
    let fault = |error: std::io::Error| error.to_string();
    fs::write(&file, text).map_err(fault)?;
    let output = process::Command::new(parser).arg(&file).output().map_err(fault)?;
    if !output.status.success() {
        return Err(format!("GRBL: {}", String::from_utf8_lossy(&output.stdout)));
    }
    fs::remove_file(&file).map_err(fault)
}

/// Checks that with `safe_home` the control makes more rapids and the same other motions.
fn cuts_alike_from_home(
    toolpath: &Toolpath,
    job: &ProgramJob,
    safe_home: SafeHome,
    directory: &Path,
    motions: &[canon::Motion],
) -> Result<(), String> {
    let program = Program { safe_home, ..job.program.clone() };
    let job = ProgramJob { program: &program, ..*job };
    let written =
        toolpathd_post::write(toolpath, &job, &Budget::unlimited()).map_err(|error| error.to_string())?;
    let text = canon::translated(&written.text, job.dialect);
    let name = format!("{}-home", program.name.as_deref().unwrap_or_default().replace(' ', ""));
    let homed = canon::interpret(&text, directory, &name)?;
    let cuts = |motions: &[canon::Motion]| -> Vec<String> {
        let cuts = motions.iter().filter(|motion| !matches!(motion, canon::Motion::Rapid { .. }));
        cuts.map(|motion| format!("{motion:?}")).collect()
    };
    let rapids = |motions: &[canon::Motion]| motions.len() - cuts(motions).len();
    if cuts(&homed) != cuts(motions) || rapids(&homed) <= rapids(motions) {
        return Err(format!("{safe_home:?}: the control cuts something else, or does not go home"));
    }
    Ok(())
}

/// A program without the blocks that move to the machine's end of Z, whose place the text does not state.
/// Random toolpaths check these blocks.
fn without_homes(text: &str) -> String {
    let is_home =
        |line: &str| !line.starts_with('(') && line.split(' ').any(|word| ["G28", "G53"].contains(&word));
    text.lines().filter(|line| !is_home(line)).map(|line| format!("{line}\n")).collect()
}

/// The dialects that LinuxCNC reads, a few words translated.
fn dialects() -> Vec<&'static Dialect> {
    DIALECTS.iter().copied().filter(|dialect| dialect.has_plain_words()).collect()
}

/// The dialect of a file called `name.dialect.extension`.
fn dialect_of(path: &Path) -> Option<&'static Dialect> {
    let name = Path::new(path.file_stem()?).extension()?.to_str()?;
    toolpathd_post::dialect(name)
}

/// The paths of the programs in `directory`, sorted. An error where there are none.
fn programs_in(directory: &Path) -> Result<Vec<PathBuf>, String> {
    let entries = fs::read_dir(directory).map_err(|error| format!("{}: {error}", directory.display()))?;
    let mut programs: Vec<_> = entries
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| dialect_of(path).is_some())
        .collect();
    programs.sort();
    if programs.is_empty() { Err(format!("no programs in {}", directory.display())) } else { Ok(programs) }
}
