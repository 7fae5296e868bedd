//! A hole of a canned cycle as the reader reads it, against the motions that the control makes of its block.

use std::iter::Peekable;

use nalgebra::Point3;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_post::read::Hole;

use crate::canon::Motion;
use crate::compare::Run;

/// How far LinuxCNC stays above the last depth when it comes back after a peck, mm: ten thousandths of an
/// inch.
const BACK_MM: f64 = 0.254;

/// A last peck of less than this is the rounding of a sum, mm.
const LEAST_PECK_MM: f64 = 1e-6;

/// Takes the motions of the hole, one by one as LinuxCNC's manual has them. Returns how far they are from
/// what the reader says, mm.
pub fn take(
    hole: &Hole,
    first: Run,
    runs: &mut Peekable<impl Iterator<Item = Run>>,
    printed: f64,
) -> Result<f64, String> {
    // The control makes rapids even where the tool is there already.
    let stays = |run: &Run| matches!(run.motion, Motion::Rapid { .. }) && run.start == run.end();
    let (mut at, mut apart, mut next) = (Point3::from(hole.from), 0f64, Some(first));
    for wanted in motions(hole) {
        if matches!(wanted, Motion::Rapid { to } if (to - at).norm() <= printed) {
            continue;
        }
        let run = loop {
            let run = next.take().or_else(|| runs.next()).ok_or("the control stops in a hole")?;
            if !stays(&run) {
                break run;
            }
        };
        let fault = || format!("{:?} instead of {wanted:?}", run.motion);
        match (wanted, run.motion) {
            (Motion::Rapid { to }, Motion::Rapid { .. }) => at = to,
            (Motion::Line { to, rate }, Motion::Line { rate: run_rate, .. }) => {
                if (rate - run_rate).abs() > 1e-4 * 25.4 {
                    return Err(fault());
                }
                at = to;
            }
            (Motion::Dwell { seconds }, Motion::Dwell { seconds: waited }) => {
                if (seconds - waited).abs() > 1e-3 {
                    return Err(fault());
                }
            }
            _ => return Err(fault()),
        }
        apart = apart.max((run.end() - at).norm());
        if apart > printed {
            return Err(fault());
        }
    }
    while runs.next_if(stays).is_some() {}
    Ok(apart)
}

/// What LinuxCNC does for the hole.
fn motions(hole: &Hole) -> Vec<Motion> {
    let cycle = &hole.cycle;
    let at = |z: f64| Point3::new(hole.to[0], hole.to[1], z);
    let rapid = |z: f64| Motion::Rapid { to: at(z) };
    let feed = |z: f64| Motion::Line { to: at(z), rate: cycle.rate.mm_per_min() };
    let mut motions = vec![rapid(hole.from[2]), rapid(cycle.retract_mm)];
    if let Some(peck) = cycle.peck_mm {
        let mut depth = cycle.retract_mm - peck;
        while depth > cycle.bottom_mm + LEAST_PECK_MM {
            motions.push(feed(depth));
            if cycle.kind == CycleKind::Peck {
                motions.push(rapid(cycle.retract_mm));
            }
            motions.push(rapid(depth + BACK_MM));
            depth -= peck;
        }
    }
    motions.push(feed(cycle.bottom_mm));
    if cycle.dwell_s > 0.0 {
        motions.push(Motion::Dwell { seconds: cycle.dwell_s });
    }
    if cycle.kind == CycleKind::Ream {
        // G89 keeps the feed up to where the hole ends, G85 up to R.
        motions.push(feed(if cycle.dwell_s > 0.0 { cycle.returns_mm } else { cycle.retract_mm }));
    }
    motions.push(rapid(cycle.returns_mm));
    motions
}
