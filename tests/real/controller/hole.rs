//! A hole of a canned cycle as the reader reads it, against the motions that the control makes of its block.

use std::iter::Peekable;

use nalgebra::Point3;
use toolpathd_core::toolpath::cycle::CycleKind;
use toolpathd_post::read::Hole;

use crate::canon::Motion;
use crate::compare::Run;

/// How far LinuxCNC goes back, mm, between two pecks: ten thousandths of an inch.
const BACK_MM: f64 = 0.254;

/// Takes the motions of the hole: rapids there, the hole, and the way back. Returns how far they are from what
/// the reader says, mm.
pub fn take(
    hole: &Hole,
    first: Run,
    runs: &mut Peekable<impl Iterator<Item = Run>>,
    printed: f64,
) -> Result<f64, String> {
    let cycle = &hole.cycle;
    let mut found = Found { apart: 0.0, depth: cycle.retract_mm, pecks: 0, waited_s: 0.0, fed_out: false };
    let mut run = first;
    loop {
        found.add(hole, &run, printed)?;
        let end = run.end();
        let is_down = (found.depth - cycle.bottom_mm).abs() <= printed;
        let is_back = is_down && (end.z - hole.returns_mm).abs() <= printed;
        let goes_on = cycle.kind == CycleKind::Ream && !found.fed_out;
        if is_back && !goes_on {
            break;
        }
        run = runs.next().ok_or("the control stops in a hole")?;
    }
    // It ends a hole with a rapid even where the tool is there already.
    let stays = |run: &Run| matches!(run.motion, Motion::Rapid { .. }) && run.start == run.end();
    while runs.next_if(stays).is_some() {}
    let pecks = cycle.peck_mm.map_or(1.0, |peck| ((cycle.retract_mm - cycle.bottom_mm) / peck - 1e-6).ceil());
    if f64::from(found.pecks) != pecks {
        return Err(format!("{} pecks instead of {pecks}", found.pecks));
    }
    if (found.waited_s - cycle.dwell_s).abs() > 1e-3 {
        return Err(format!("a pause of {} s instead of {} s", found.waited_s, cycle.dwell_s));
    }
    Ok(found.apart)
}

struct Found {
    apart: f64,
    /// The lowest place that was drilled.
    depth: f64,
    pecks: u32,
    waited_s: f64,
    fed_out: bool,
}

impl Found {
    fn add(&mut self, hole: &Hole, run: &Run, printed: f64) -> Result<(), String> {
        let cycle = &hole.cycle;
        let (start, end) = (run.start, run.end());
        let across = |p: &Point3<f64>| (p.x - hole.to[0]).abs().max((p.y - hole.to[1]).abs());
        match run.motion {
            Motion::Rapid { .. } => {
                // Down to R, or down the hole to where it was drilled before.
                let free = if self.pecks == 0 { cycle.retract_mm } else { self.depth + BACK_MM };
                if end.z < free - printed {
                    return Err(format!("a rapid down to z = {} where {free} is free", end.z));
                }
            }
            Motion::Line { rate, .. } => {
                if (rate - cycle.rate.mm_per_min()).abs() > 1e-4 * 25.4 {
                    return Err("another feed".into());
                }
                self.apart = self.apart.max(across(&start)).max(across(&end));
                if end.z > start.z {
                    self.fed_out = true;
                    self.apart = self.apart.max((cycle.bottom_mm - start.z).abs());
                } else {
                    self.pecks += 1;
                    self.depth = self.depth.min(end.z);
                }
            }
            Motion::Dwell { seconds } => self.waited_s += seconds,
            Motion::Arc { .. } | Motion::Parabola { .. } => return Err("a curve in a hole".into()),
        }
        self.apart = self.apart.max(across(&end).min(if self.pecks == 0 { 0.0 } else { f64::INFINITY }));
        if self.depth < cycle.bottom_mm - printed {
            return Err("too deep".into());
        }
        if self.fed_out && cycle.kind != CycleKind::Ream {
            return Err("the tool leaves at feed".into());
        }
        Ok(())
    }
}
