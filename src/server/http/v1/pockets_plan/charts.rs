//! Times of the patterns of a pocket as charts: on each level, and summed over all levels, as in figures 8
//! and 9 of the paper by Ryu, Kang and Jeon.

use std::collections::BTreeSet;

use toolpathd_core::operations::pocketing::{Candidate, ChooseBy, LevelReport, Pattern, Report};
use toolpathd_plot::bars::{Bar, BarChart, Kind};

/// The groups of charts that share a scale.
const SUM: usize = 0;
const LEVELS: usize = 1;

/// The charts of all levels that are cut; first their sum, if there are several.
pub fn charts(report: &Report, choose_by: ChooseBy) -> Vec<BarChart> {
    let (n_levels, n_pockets) = (report.levels.len(), n_pockets(report));
    let cut: Vec<(usize, &LevelReport)> =
        report.levels.iter().enumerate().filter(|(_, level)| level.chosen.is_some()).collect();
    let mut charts = Vec::new();
    if cut.len() > 1 {
        charts.push(sum(&cut, choose_by));
    }
    charts.extend(cut.iter().map(|(k, level)| BarChart {
        name: format!(
            "Level {} of {n_levels}{}, floor at Z {:.3} mm",
            k + 1,
            of_regions(level, n_pockets, ", "),
            level.z_mm + 0.0
        ),
        axis: axis(choose_by).to_owned(),
        bars: level.candidates.iter().map(|candidate| bar(candidate, level.chosen, choose_by)).collect(),
        group: LEVELS,
    }));
    charts
}

/// The name of a pattern in words.
pub fn words(pattern: Pattern) -> String {
    let name = serde_json::to_value(pattern).ok();
    name.as_ref().and_then(|name| name.as_str()).unwrap_or_default().replace('_', " ")
}

/// The number of pockets that are cut apart: of regions, or of regions that are cut as one.
pub fn n_pockets(report: &Report) -> usize {
    report.levels.iter().map(|level| level.regions.as_deref()).collect::<BTreeSet<_>>().len()
}

/// The regions of a level behind a separator, by their indices in the request; nothing for the only pocket.
pub fn of_regions(level: &LevelReport, n_pockets: usize, separator: &str) -> String {
    match level.regions.as_deref().filter(|_| n_pockets > 1) {
        None | Some([]) => String::new(),
        Some([only]) => format!("{separator}region {only}"),
        Some([first, others @ ..]) => format!("{separator}region {first} and {} more", others.len()),
    }
}

fn axis(choose_by: ChooseBy) -> &'static str {
    match choose_by {
        ChooseBy::Time => "time, s",
        ChooseBy::PaperTime => "the paper's time, s",
        ChooseBy::TimeWithAcceleration => "time with acceleration, s",
    }
}

/// The times of cutting and of the rest, s; none without a path. Only time at the feeds is told in two parts.
fn times(candidate: &Candidate, choose_by: ChooseBy) -> Option<[f64; 2]> {
    let whole_s = candidate.figure(choose_by);
    let other_s = match choose_by {
        ChooseBy::Time => candidate.non_cutting_time_s?.min(whole_s),
        ChooseBy::PaperTime | ChooseBy::TimeWithAcceleration => 0.0,
    };
    whole_s.is_finite().then_some([whole_s - other_s, other_s])
}

fn bar(candidate: &Candidate, chosen: Option<Pattern>, choose_by: ChooseBy) -> Bar {
    let (kind, remark) = match &candidate.invalid_because {
        Some(because) => (Kind::Invalid, format!("not valid: {because}")),
        None if chosen == Some(candidate.pattern) => (Kind::Chosen, "chosen".to_owned()),
        None => (Kind::Usual, String::new()),
    };
    Bar { name: words(candidate.pattern), times_s: times(candidate, choose_by), remark, kind }
}

/// The sum over all levels: of each pattern alone, and of the patterns that are chosen.
fn sum(levels: &[(usize, &LevelReport)], choose_by: ChooseBy) -> BarChart {
    let n_levels = levels.len();
    let patterns = levels.iter().flat_map(|(_, level)| &level.candidates).map(|candidate| candidate.pattern);
    let mut bars: Vec<Bar> = Vec::new();
    for pattern in Pattern::ALL.into_iter().filter(|pattern| patterns.clone().any(|own| own == *pattern)) {
        let valid: Vec<[f64; 2]> =
            levels.iter().filter_map(|(_, level)| valid(level, pattern, choose_by)).collect();
        let n_invalid = n_levels - valid.len();
        let is_valid = n_invalid == 0;
        bars.push(Bar {
            name: words(pattern),
            times_s: is_valid.then(|| total(&valid)),
            remark: if is_valid {
                String::new()
            } else {
                format!("not valid on {n_invalid} of {n_levels} levels")
            },
            kind: if is_valid { Kind::Usual } else { Kind::Invalid },
        });
    }
    let chosen = levels.iter().filter_map(|(_, level)| valid(level, level.chosen?, choose_by));
    bars.push(Bar {
        name: "as chosen".to_owned(),
        times_s: Some(total(&chosen.collect::<Vec<_>>())),
        remark: "this program".to_owned(),
        kind: Kind::Chosen,
    });
    let name = format!("All {n_levels} levels with one pattern each");
    BarChart { name, axis: axis(choose_by).to_owned(), bars, group: SUM }
}

/// The times of a pattern on a level; none where it is not valid.
fn valid(level: &LevelReport, pattern: Pattern, choose_by: ChooseBy) -> Option<[f64; 2]> {
    let candidate = level.candidates.iter().find(|candidate| candidate.pattern == pattern)?;
    times(candidate, choose_by).filter(|_| candidate.valid)
}

fn total(times: &[[f64; 2]]) -> [f64; 2] {
    [0, 1].map(|part| times.iter().map(|times| times[part]).sum())
}
