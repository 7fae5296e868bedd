//! SINUMERIK programs against closed forms.

mod cycles;
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

fn job(text: &str) -> ReadJob<'_> {
    ReadJob { most_moves: 200_000, ..ReadJob::plain(text.as_bytes(), Control::named("siemens").unwrap()) }
}

fn of(text: &str) -> ReadProgram {
    read(&job(text), &Budget::unlimited()).unwrap_or_else(|error| panic!("{error:?}\n{text}"))
}

fn measures(text: &str) -> Measures {
    measure(&of(text).toolpath, FeedRate::DEFAULT_RAPID)
}

/// A program that begins at the zero with a feed of 600 mm/min.
fn framed(lines: &str) -> String {
    format!("G17 G710 G90 G94 G54\nG0 X0 Y0 Z0 D1\nF600 S1000 M3\n{lines}\nM30\n")
}

/// The lengths of cuts and rapids of a framed program, mm.
fn lengths(lines: &str) -> [f64; 2] {
    let measures = measures(&framed(lines));
    [measures.cutting_length_mm, measures.rapid_length_mm]
}

fn cut(lines: &str) -> f64 {
    lengths(lines)[0]
}

fn end(lines: &str) -> [f64; 3] {
    of(&framed(lines)).end.map(|place| place.unwrap_or(f64::NAN))
}

/// The faults of a program, with line and word.
fn faults(text: &str) -> Vec<(usize, String, Fault)> {
    match read(&job(text), &Budget::unlimited()) {
        Err(ReadError::Refused(refusals)) => {
            refusals.into_iter().map(|r| (r.line, r.word, r.fault)).collect()
        }
        other => panic!("{other:?}\n{text}"),
    }
}

/// The faults of a framed program; its lines are numbered from 1.
fn framed_faults(lines: &str) -> Vec<(usize, String, Fault)> {
    faults(&framed(lines)).into_iter().map(|(line, word, fault)| (line - 3, word, fault)).collect()
}

fn close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    for (a, b) in found.iter().zip(expected) {
        assert!((a - b).abs() <= 1e-9 * (1.0 + b.abs()), "{found:?} {expected:?}");
    }
}
