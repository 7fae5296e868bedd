//! Verifies good programs and programs with faults, and compares the verdicts with the judge's.

use nalgebra::Point3;
use toolpathd_core::budget::Budget;
use toolpathd_core::operations::verification::{Certainty, Kind, Report, Verdict, verify};
use toolpathd_nc::control::Control;
use toolpathd_nc::{ReadJob, read};

use super::block::{text, ways};
use super::fault::{FAULTS, Fault, Faulty, put};
use super::judge::{OF_STOCK, left_on_sheet, offences};
use super::random::Numbers;
use super::scene::{Scene, Shape};
use super::{pocket, sheet};

/// What became of one fault.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Outcome {
    /// A certain finding of the right kind on the block of the fault.
    OnBlock,
    /// A certain finding elsewhere, or of another kind.
    Elsewhere,
    /// A possible finding alone.
    Undecided,
    Missed,
}

/// One program with its faults.
#[derive(Debug, Default)]
pub struct Trial {
    /// Whether the judge finds the good program good.
    pub is_clean: bool,
    /// The verdict on the good program.
    pub verdict: Option<Verdict>,
    pub faults: Vec<(Fault, Outcome)>,
    /// Faults that the judge does not confirm.
    pub n_not_confirmed: usize,
    /// What a reader has to see of faults that were missed, and of false alarms.
    pub told: Vec<String>,
}

/// A program with the line of each of its moves.
struct Verified {
    report: Report,
    lines: Vec<u32>,
}

fn verified(scene: &Scene) -> Verified {
    let text = text(&scene.blocks, scene.start);
    let control = Control::named("linuxcnc").expect("a control");
    let offsets = [(1, [0.0; 3]), (2, scene.zero)];
    let start = scene.start.map(Some);
    let job = ReadJob { start, offsets: &offsets, ..ReadJob::plain(text.as_bytes(), control) };
    let program = read(&job, &Budget::unlimited()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let mut tool_of_pass = vec![0; program.toolpath.passes().len()];
    for used in &program.tools {
        let own = scene.tools.iter().position(|tool| Some(tool.number) == used.number).unwrap_or(0);
        tool_of_pass[used.first_pass..used.first_pass + used.n_passes].fill(own);
    }
    let job = scene.job(program.toolpath, tool_of_pass);
    let report = verify(&job, &Budget::unlimited()).unwrap_or_else(|error| panic!("{error}\n{text}"));
    Verified { report, lines: program.lines }
}

/// The good program of a seed.
pub fn good(seed: u64) -> Scene {
    let mut numbers = Numbers::new(seed);
    if !seed.is_multiple_of(3) {
        return pocket::scene(&mut numbers);
    }
    let mut scene = sheet::scene(&mut numbers);
    let own = scene.clone();
    if let Shape::Sheet(sheet) = &own.shape {
        let left = left_on_sheet(sheet, &own, &ways(&own.blocks, own.start, own.zero, 0.1));
        scene.allowed = 1.25 * left + 0.01;
    }
    scene
}

/// Verifies the good program of a seed, and the program with each fault that it has a place for.
pub fn trial(seed: u64) -> Trial {
    let scene = good(seed);
    let offences_of_good = offences(&scene, &OF_STOCK);
    let mut trial = Trial { is_clean: offences_of_good.0.is_empty(), ..Trial::default() };
    if !trial.is_clean {
        trial.told.push(format!("seed {seed}: the program is not good: {:?}", offences_of_good.0));
        return trial;
    }
    let Verified { report, lines } = verified(&scene);
    trial.verdict = Some(report.verdict);
    if report.verdict != Verdict::Pass {
        trial.told.push(format!("seed {seed}: false alarm\n{}", told(&scene, &report, &lines)));
    }
    let mut numbers = Numbers::new(seed ^ 0xfa017);
    for (fault, name) in FAULTS {
        let Some(faulty) = put(fault, &scene, &mut numbers) else { continue };
        match outcome(&faulty) {
            None => trial.n_not_confirmed += 1,
            Some((outcome, verified)) => {
                trial.faults.push((fault, outcome));
                let by_design = fault == Fault::DogLegThroughClamp && outcome == Outcome::Undecided;
                if matches!(outcome, Outcome::Missed | Outcome::Undecided) && !by_design {
                    let shown = told(&faulty.scene, &verified.report, &verified.lines);
                    trial
                        .told
                        .push(format!("seed {seed}, {name}: {outcome:?}, lines {:?}\n{shown}", faulty.lines));
                }
            }
        }
    }
    trial
}

/// What verification makes of a fault. `None` where the judge does not confirm it.
fn outcome(faulty: &Faulty) -> Option<(Outcome, Verified)> {
    let judged = offences(&faulty.scene, &faulty.kinds);
    let own: Vec<_> = judged.0.iter().filter(|offence| faulty.kinds.contains(&offence.kind)).collect();
    if own.is_empty() {
        return None;
    }
    // What is left behind has no line for the judge, unless a wall names it.
    let lines: Vec<u32> = if faulty.lines.is_empty() {
        own.iter().map(|offence| offence.line).collect()
    } else {
        faulty.lines.clone()
    };
    let verified = verified(&faulty.scene);
    let Verified { report, lines: of_moves } = &verified;
    let is_left = faulty.kinds.contains(&Kind::MaterialLeft) && faulty.lines.is_empty();
    let on_block = report.findings.listed.iter().any(|finding| {
        finding.certainty == Certainty::Certain
            && faulty.kinds.contains(&finding.kind)
            && (is_left || of_moves.get(finding.place.number).is_some_and(|line| lines.contains(line)))
    });
    let outcome = match report.verdict {
        Verdict::Fail if on_block => Outcome::OnBlock,
        Verdict::Fail => Outcome::Elsewhere,
        Verdict::Undecided => Outcome::Undecided,
        Verdict::Pass => Outcome::Missed,
    };
    Some((outcome, verified))
}

fn told(scene: &Scene, report: &Report, lines: &[u32]) -> String {
    let place =
        |p: Option<Point3<f64>>| p.map_or_else(String::new, |p| format!("{:.3} {:.3} {:.3}", p.x, p.y, p.z));
    let findings = report.findings.listed.iter().take(6).map(|finding| {
        let line = lines.get(finding.place.number).copied().unwrap_or(0);
        format!(
            "  line {line}: {:?} {:?} found {:?} bound {} at {}\n",
            finding.kind,
            finding.certainty,
            finding.found_mm,
            finding.bound_mm,
            place(finding.at)
        )
    });
    let findings: String = findings.collect();
    format!(
        "{findings}  walls {:?} excess {:?}\n  {:?} {:?} {:?}",
        report.wall_excess, report.excess, scene.shape, scene.tools, scene.stock
    )
}
