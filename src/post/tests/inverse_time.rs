//! The F words of blocks under G93: none is beyond what the control reads.

use super::posed::{leaning, text_of};
use super::*;
use crate::dialects::iso::ISO;
use crate::dialects::mach4::MACH4;
use crate::dialects::siemens::SIEMENS;
use crate::read::PosedFeed;
use nalgebra::{Unit, UnitVector3};
use toolpathd_core::machine::{Straying, named};

const ALLOWED: Straying = Straying { tip_mm: 0.01, axis: 0.01 };

/// The largest F that the manual of each control names, with a dialect that states positions.
const DIALECTS: [(&Dialect, f64); 5] =
    [(&FANUC, 9999.999), (&ISO, 9999.999), (&MACH4, 9999.999), (&SIEMENS, 99_999.99), (&LINUXCNC, 600_000.0)];

/// A leaning tool that goes along X in steps.
fn along(step_mm: f64, steps: u32, mm_per_min: f64) -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 12.0));
    let axis: UnitVector3<f64> = Unit::new_normalize(Vector3::new(0.0, 0.6, 0.8));
    path.begin_leaning_pass(None, axis);
    for k in 1..=steps {
        let to = Point3::new(step_mm * f64::from(k), 0.0, 12.0);
        path.line(to, feed(mm_per_min), Role::Cut).unwrap();
    }
    path.finish().unwrap()
}

/// The seconds of the blocks of a program, as its control reads them.
fn seconds(dialect: &Dialect, path: &Toolpath) -> (NcProgram, Vec<f64>) {
    let table = named::by_name("table_table_ac").unwrap();
    let program = text_of(dialect, path, AxisOutput::Machine, Some(&table), ALLOWED).unwrap();
    let read = Reader::new(&program.text, dialect, 0.0015).filter_map(|placed| match placed.unwrap().step {
        Step::Posed(read::Posed { feed: PosedFeed::Seconds(seconds), .. }) => Some(seconds),
        _ => None,
    });
    let read = read.collect();
    (program, read)
}

#[test]
fn a_block_too_short_for_the_control_takes_longer_and_the_program_says_so() {
    // A fiftieth of a millimetre at 6 m by the minute: 0.2 ms.
    let path = along(0.02, 50, 6000.0);
    for (dialect, most) in DIALECTS {
        let (program, read) = seconds(dialect, &path);
        assert_eq!(read.len(), 50);
        assert!(read.iter().all(|seconds| 60.0 / seconds <= most), "{}", program.text);
        let (took_s, asked_s): (f64, f64) = (read.iter().sum(), 50.0 * 2e-4);
        assert!((took_s - asked_s - program.slowed.by_s).abs() < 1e-6, "{took_s} s\n{}", program.text);
        let is_slowed = most < 600_000.0;
        assert_eq!(program.slowed.blocks, if is_slowed { 50 } else { 0 }, "{}", dialect.name);
        assert_eq!(program.text.contains("50 BLOCKS ARE TOO SHORT"), is_slowed, "{}", program.text);
    }
}

#[test]
fn a_block_that_the_control_can_time_keeps_its_time() {
    for (dialect, _) in DIALECTS {
        let (program, read) = seconds(dialect, &along(1.0, 20, 6000.0));
        assert_eq!(program.slowed, Slowed::default());
        assert!(read.iter().all(|seconds| (seconds - 0.01).abs() < 1e-6), "{read:?}");
    }
}

#[test]
fn a_block_too_long_for_the_least_feed_is_divided_into_equal_parts() {
    // 100,000 minutes: an F of 0.00001, where the controls read 0.001 and more.
    for (dialect, _) in DIALECTS {
        let (program, read) = seconds(dialect, &along(400.0, 1, 0.004));
        assert_eq!(read.len(), 128, "{}", program.text);
        assert!(read.iter().all(|seconds| 60.0 / seconds >= 0.001 && seconds == &read[0]), "{read:?}");
        let took_s: f64 = read.iter().sum();
        assert!((took_s / 6e6 - 1.0).abs() < 1e-3, "{took_s} s");
    }
}

#[test]
fn a_feed_beyond_the_control_is_refused_by_the_reader() {
    let coarse = Straying { tip_mm: 1.0, axis: 1.0 };
    let table = named::by_name("table_table_ac").unwrap();
    for (dialect, text, wrong) in [(&FANUC, "F120.", "F10000."), (&SIEMENS, "F120", "F100000")] {
        let program = text_of(dialect, &leaning(), AxisOutput::Angles, Some(&table), coarse).unwrap();
        let spoiled = program.text.replace(text, wrong);
        assert_ne!(spoiled, program.text);
        assert!(Reader::new(&spoiled, dialect, 0.0015).any(|placed| placed.is_err()), "{spoiled}");
    }
}
