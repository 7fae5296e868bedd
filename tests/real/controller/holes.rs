//! Random canned cycles: the control drills the holes that the reader reads.

use std::path::Path;

use nalgebra::{Point2, Point3};
use toolpathd_core::budget::Budget;
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::cutting::CuttingRequest;
use toolpathd_core::toolpath::cycle::{CycleKind, Hole, ReturnTo};
use toolpathd_core::toolpath::program::{Program, Resolution, Units};
use toolpathd_core::toolpath::tool::Tool;
use toolpathd_post::ProgramJob;

use crate::random::Random;
use crate::{canon, compare, dialects};

/// Programs in each dialect.
const PROGRAMS: usize = 20;

pub fn check(directory: &Path) -> Result<compare::Figures, String> {
    let mut figures = compare::Figures::default();
    for dialect in dialects().into_iter().filter(|dialect| !dialect.abilities.cycles.is_empty()) {
        for seed in 0..PROGRAMS {
            let mut random = Random::new(seed as u64);
            let toolpath = cycles(&mut random).map_err(|error| error.to_string())?;
            let resolution = match seed % 4 {
                3 => Resolution { units: Units::Inch, decimals: 4 },
                _ => Resolution { units: Units::Mm, decimals: 3 },
            };
            let (program, tool) = (Program::plain(resolution), Tool { number: Some(1), ..Tool::ball(3.0) });
            let cutting = CuttingRequest::at_feed(random.feed()).at_heights(random.within(0.0, 60.0), 0.0);
            let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
            let name = format!("holes{seed}-{}", dialect.name);
            let found = toolpathd_post::write(&toolpath, &job, &Budget::unlimited())
                .map_err(|error| error.to_string())
                .and_then(|written| {
                    let text = canon::translated(&written.text, dialect);
                    let motions = canon::interpret(&text, directory, &name)?;
                    compare::with_text(&written.text, dialect, &motions)
                })
                .map_err(|error| format!("{name}: {error}"))?;
            figures = figures.and(found);
        }
    }
    Ok(figures)
}

/// A toolpath of several cycles, with rapids between them.
fn cycles(random: &mut Random) -> Result<Toolpath, toolpathd_core::toolpath::PathError> {
    let mut path = Toolpath::builder(Point3::from(random.vector(50.0)));
    for _ in 0..2 + random.below(6) {
        let kind = CycleKind::ALL[random.below(4)];
        let top_z_mm = random.within(-20.0, 20.0);
        let hole = Hole {
            kind,
            top_z_mm,
            retract_z_mm: top_z_mm + random.within(0.5, 5.0),
            bottom_z_mm: top_z_mm - random.within(0.1, 40.0),
            peck_mm: kind.pecks().then(|| random.within(1.0, 15.0)),
            dwell_s: if kind.pecks() || random.unit() < 0.5 { 0.0 } else { random.within(0.01, 3.0) },
            rate: random.feed(),
            return_to: if random.unit() < 0.5 { ReturnTo::Start } else { ReturnTo::RetractPlane },
        };
        let at = path.at();
        let above = if random.unit() < 0.2 { 0.0 } else { random.within(0.0, 30.0) };
        path.rapid(Point3::new(at.x, at.y, hole.retract_z_mm + above))?;
        let places = (0..1 + random.below(6)).map(|_| Point2::from(random.vector(80.0).xy())).collect();
        path.cycle(hole, places)?;
        if random.unit() < 0.5 {
            let at = path.at();
            path.line(
                Point3::new(at.x + 5.0, at.y, at.z),
                random.feed(),
                toolpathd_core::toolpath::Role::Cut,
            )?;
        }
    }
    path.finish()
}
