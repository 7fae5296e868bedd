//! Klartext programs against closed forms.

mod approach;
mod cycles;
mod datum;
mod flow;
mod motion;
mod programs;
mod random;
mod refusals;

use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::measure::{Measures, measure};
use toolpathd_core::toolpath::units::FeedRate;

use crate::control::Control;
use crate::fault::Fault;
use crate::{ReadError, ReadJob, ReadProgram, read};

/// A program that stands at the zero with a feed of 100 mm/min, and then runs these lines from line 4 on.
fn framed(lines: &str) -> String {
    let head = "0 BEGIN PGM T MM\n1 TOOL CALL 1 Z S1000 F100\n2 L X+0 Y+0 Z+0 R0 FMAX M3";
    format!("{head}\n{lines}\n99 END PGM T MM\n")
}

fn job(text: &str) -> ReadJob<'_> {
    ReadJob { most_moves: 100_000, ..ReadJob::plain(text.as_bytes(), Control::named("heidenhain").unwrap()) }
}

/// The reading of a whole program that is read.
fn whole(text: &str) -> ReadProgram {
    read(&job(text), &Budget::unlimited()).unwrap_or_else(|error| match error {
        ReadError::Refused(refusals) => panic!("{refusals:?}\n{text}"),
        error => panic!("{error}\n{text}"),
    })
}

/// The reading of lines that are read.
fn of(lines: &str) -> ReadProgram {
    whole(&framed(lines))
}

fn measures(reading: &ReadProgram) -> Measures {
    measure(&reading.toolpath, FeedRate::DEFAULT_RAPID)
}

/// The length of the cuts of these lines, mm.
fn cut(lines: &str) -> f64 {
    measures(&of(lines)).cutting_length_mm
}

/// The lengths of cuts and rapids, mm.
fn lengths(lines: &str) -> [f64; 2] {
    let measures = measures(&of(lines));
    [measures.cutting_length_mm, measures.rapid_length_mm]
}

/// Where the tool stands behind these lines.
fn end(lines: &str) -> [f64; 3] {
    of(lines).end.map(|place| place.expect("known"))
}

/// What is refused of a whole program: line, word and fault.
fn faults_of(text: &str) -> Vec<(usize, String, Fault)> {
    match read(&job(text), &Budget::unlimited()) {
        Err(ReadError::Refused(refusals)) => {
            refusals.into_iter().map(|refusal| (refusal.line, refusal.word, refusal.fault)).collect()
        }
        other => panic!("{other:?}\n{text}"),
    }
}

fn faults(lines: &str) -> Vec<(usize, String, Fault)> {
    faults_of(&framed(lines))
}

#[track_caller]
fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{found:?} {expected:?}");
    }
}
