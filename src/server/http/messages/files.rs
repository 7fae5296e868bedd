//! Sentences about files of parts.

use toolpathd_part::left_out::LeftOut;
use toolpathd_part::points::grid::NoGrid;

/// The most kinds that a sentence lists.
const MOST_KINDS: usize = 6;

/// The sentence about what was left out of a file; `None` where nothing was.
pub fn left_out(name: &str, all: &[LeftOut]) -> Option<String> {
    let total: usize = all.iter().map(|one| one.count).sum();
    if total == 0 {
        return None;
    }
    let one = |LeftOut { kind, reason, count, first }: &LeftOut| match count {
        1 => format!("{kind} at {first} ({reason})"),
        count => format!("{count} {kind}, the first at {first} ({reason})"),
    };
    let listed: Vec<String> = all.iter().take(MOST_KINDS).map(one).collect();
    let more = all.len().saturating_sub(MOST_KINDS);
    let more = if more > 0 { format!("; and {more} more kinds") } else { String::new() };
    Some(format!("left out of `{name}`: {}{more}", listed.join("; ")))
}

/// Why points are no grid. `lines` has the line of each point.
pub fn no_grid(fault: &NoGrid, lines: &[u32]) -> String {
    let line = |point: &usize| lines.get(*point).copied().unwrap_or_default();
    let advice = "send the points as `point_grid`, or leave out what does not belong to the grid";
    match fault {
        NoGrid::TooFew { count } => {
            format!("{count} points make no rows and columns; a grid has at least two of each")
        }
        NoGrid::Doubled { point } => {
            format!("the point in line {} has x and y of another point: leave one out", line(point))
        }
        NoGrid::Ragged { most, count, point } => format!(
            "the points are no grid: the row or column of the point in line {} has {count} points, and most have {most}; {advice}",
            line(point)
        ),
        NoGrid::Off { off, within, point } => format!(
            "the points are no grid: the point in line {} is {off:.4} mm off its row or column, and {within:.4} mm are allowed; send a larger `grid_within_mm`",
            line(point)
        ),
        NoGrid::Stopped(stopped) => stopped.to_string(),
    }
}
