//! Puts faults into random good programs, and counts those that verification finds.
//!
//! * Good programs: pockets with rounded and sharp corners and with islands, in two levels by two tools, with
//!   helices, arcs in three planes and cycles; surfaces in rows by balls, bull noses and flat ends. Each has
//!   a stock, a clamp, a holder, flutes and a travel.
//! * Each good program gets one fault of each kind for which it has a place.
//! * A dense check with formulas of its own (`judge`) confirms that each good program is good and each fault
//!   is one. What it does not confirm does not count.
//!
//! Fails where a fault is missed, or more than 1 % of the faults are undecided.

mod block;
mod fault;
mod judge;
mod pocket;
mod random;
mod scene;
mod sheet;
mod trial;

use std::process::ExitCode;
use std::{env, thread};

use fault::{FAULTS, Fault};
use toolpathd_core::operations::verification::Verdict;
use trial::{Outcome, Trial, trial};

/// Number of faults, unless the variable `FAULTS` says another.
const COUNT: usize = 20_000;

/// Programs that run between two looks at the sum.
const BATCH: u64 = 64;

/// The most texts on what went wrong.
const MOST_TOLD: usize = 12;

/// The largest share of faults that may stay undecided.
const UNDECIDED: f64 = 0.01;

fn main() -> ExitCode {
    let count = env::var("FAULTS").ok().and_then(|text| text.parse().ok()).unwrap_or(COUNT);
    let mut done: Vec<Trial> = Vec::new();
    let mut seed = 0;
    while done.iter().map(|trial| trial.faults.len()).sum::<usize>() < count {
        done.extend(batch(seed));
        seed += BATCH;
    }
    tell(&done)
}

/// Trials of some seeds, in their order, on all cores.
fn batch(first: u64) -> Vec<Trial> {
    let n = thread::available_parallelism().map_or(1, usize::from) as u64;
    let seeds = |k: u64| (first..first + BATCH).filter(move |seed| seed % n == k);
    let mut all: Vec<(u64, Trial)> = thread::scope(|scope| {
        let run = |k: u64| scope.spawn(move || seeds(k).map(|seed| (seed, trial(seed))).collect::<Vec<_>>());
        let threads: Vec<_> = (0..n).map(run).collect();
        threads.into_iter().flat_map(|thread| thread.join().expect("no panic")).collect()
    });
    all.sort_by_key(|(seed, _)| *seed);
    all.into_iter().map(|(_, trial)| trial).collect()
}

/// Prints the table. Fails where a fault is missed or too many are undecided.
fn tell(done: &[Trial]) -> ExitCode {
    for text in done.iter().flat_map(|trial| &trial.told).take(MOST_TOLD) {
        eprintln!("{text}\n");
    }
    let outcomes = |fault: Option<Fault>| {
        let all = done.iter().flat_map(|trial| &trial.faults);
        all.filter(move |(own, _)| fault.is_none_or(|fault| fault == *own)).map(|(_, outcome)| *outcome)
    };
    let row = |name: &str, fault: Option<Fault>| {
        let of = |outcome: Outcome| outcomes(fault).filter(|own| *own == outcome).count();
        println!(
            "| {name} | {} | {} | {} | {} | {} |",
            outcomes(fault).count(),
            of(Outcome::OnBlock),
            of(Outcome::Elsewhere),
            of(Outcome::Undecided),
            of(Outcome::Missed)
        );
    };
    println!("| fault | made | found on its block | found elsewhere | undecided | missed |");
    println!("|---|---|---|---|---|---|");
    for (fault, name) in FAULTS {
        row(name, Some(fault));
    }
    row("all", None);
    let clean = done.iter().filter(|trial| trial.is_clean);
    let verdicts = |verdict: Verdict| done.iter().filter(|trial| trial.verdict == Some(verdict)).count();
    println!(
        "\n{} good programs: {} pass, {} undecided, {} fail. {} programs and {} faults are not confirmed by the check.",
        clean.count(),
        verdicts(Verdict::Pass),
        verdicts(Verdict::Undecided),
        verdicts(Verdict::Fail),
        done.iter().filter(|trial| !trial.is_clean).count(),
        done.iter().map(|trial| trial.n_not_confirmed).sum::<usize>()
    );
    let total = outcomes(None).count();
    let missed = outcomes(None).filter(|own| *own == Outcome::Missed).count();
    // A straight rapid past the clamp is no fault, so that a dog-leg through it is never certain.
    let decided = done.iter().flat_map(|trial| &trial.faults);
    let undecided = decided
        .filter(|(fault, own)| *own == Outcome::Undecided && *fault != Fault::DogLegThroughClamp)
        .count();
    let is_good = missed == 0 && undecided as f64 <= UNDECIDED * total as f64;
    if is_good { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
