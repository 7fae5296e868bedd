mod compensation;
mod cycles;
mod flow;
mod motion;
mod placing;
mod refusals;
mod trace;

use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::measure::{Measures, measure};
use toolpathd_core::toolpath::units::FeedRate;

use super::control::Control;
use super::fault::{Fault, Refusal};
use super::machine::{Correction, Cutter};
use super::notes::Note;
use super::{ReadError, ReadJob, ReadProgram, read};

fn job<'a>(dialect: &str, text: &'a str) -> ReadJob<'a> {
    ReadJob { most_moves: 100_000, ..ReadJob::plain(text.as_bytes(), Control::named(dialect).unwrap()) }
}

fn reading(job: &ReadJob<'_>) -> ReadProgram {
    let text = String::from_utf8_lossy(job.text).into_owned();
    read(job, &Budget::unlimited()).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The reading of a program that is read.
fn of(dialect: &str, text: &str) -> ReadProgram {
    reading(&job(dialect, text))
}

fn measures(reading: &ReadProgram) -> Measures {
    measure(&reading.toolpath, FeedRate::DEFAULT_RAPID)
}

/// The lengths of cuts and rapids, mm.
fn lengths(dialect: &str, text: &str) -> [f64; 2] {
    let measures = measures(&of(dialect, text));
    [measures.cutting_length_mm, measures.rapid_length_mm]
}

fn refused(job: &ReadJob<'_>) -> Vec<Refusal> {
    match read(job, &Budget::unlimited()) {
        Err(ReadError::Refused(refusals)) => refusals,
        other => panic!("{other:?}\n{}", String::from_utf8_lossy(job.text)),
    }
}

/// The faults of a program, with line and word.
fn faults(dialect: &str, text: &str) -> Vec<(usize, String, Fault)> {
    refused(&job(dialect, text)).into_iter().map(|r| (r.line, r.word, r.fault)).collect()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{found:?} {expected:?}");
    }
}
