//! A few hundred of the faults of `tests/real/faults`: verification finds each one, and passes good programs.

#[path = "../real/faults/block.rs"]
mod block;
#[path = "../real/faults/fault.rs"]
mod fault;
#[path = "../real/faults/judge.rs"]
mod judge;
#[path = "../real/faults/pocket.rs"]
mod pocket;
#[path = "../real/faults/random.rs"]
mod random;
#[path = "../real/faults/scene.rs"]
mod scene;
#[path = "../real/faults/sheet.rs"]
mod sheet;
#[path = "../real/faults/trial.rs"]
mod trial;

use std::collections::BTreeSet;

use toolpathd_core::operations::verification::Verdict;

use fault::{FAULTS, Fault};
use trial::{Outcome, trial};

/// Good programs, each with a fault of every kind that it has a place for.
const PROGRAMS: u64 = 16;

#[test]
fn no_fault_is_missed_and_no_good_program_is_refused() {
    let mut kinds = BTreeSet::new();
    let mut made = 0;
    for trial in (0..PROGRAMS).map(trial) {
        assert!(trial.is_clean, "{:?}", trial.told);
        assert_eq!(trial.verdict, Some(Verdict::Pass), "{:?}", trial.told);
        for (fault, outcome) in &trial.faults {
            // A straight rapid past the clamp is no fault: the dog-leg alone meets it.
            // What is left on a floor is told at the nearest move.
            let expected: &[Outcome] = match fault {
                Fault::DogLegThroughClamp => &[Outcome::Undecided],
                Fault::FloorNotCut => &[Outcome::OnBlock, Outcome::Elsewhere],
                _ => &[Outcome::OnBlock],
            };
            assert!(expected.contains(outcome), "{fault:?}: {outcome:?} {:?}", trial.told);
            kinds.insert(*fault);
        }
        made += trial.faults.len();
    }
    assert!(made > 200 && kinds.len() == FAULTS.len(), "{made} faults, {kinds:?}");
}
