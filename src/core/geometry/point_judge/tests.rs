mod bad;
mod good;

use super::*;

#[test]
fn good_grids_are_not_refused_and_not_changed() {
    let mut wrong = Vec::new();
    for seed in 0..3_000 {
        let (name, rows) = good::grid(seed);
        let verdict = judge(&rows);
        if !verdict.faults.is_empty() || !verdict.changes.is_empty() {
            wrong.push(format!(
                "{seed} {name} {}x{}: {:?} {:?}",
                rows.len(),
                rows[0].len(),
                verdict.faults.first(),
                verdict.changes
            ));
        }
    }
    assert!(wrong.is_empty(), "{} of 3000:\n{}", wrong.len(), wrong.join("\n"));
}
