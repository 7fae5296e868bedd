//! Which parts of a step are cut at which feed.

use super::conditions::Conditions;
use super::router::{Purpose, Step};
use crate::geometry::segment::Segment;
use crate::toolpath::path::Role;
use crate::toolpath::units::FeedRate;

/// Two parts of different feeds are no shorter than this part of the cutter's radius, unless the step is.
const SHORTEST: f64 = 0.1;

/// A part of a step with one feed.
#[derive(Debug, Clone, Copy)]
pub struct Part {
    pub element: Segment,
    pub feed: FeedRate,
    pub role: Role,
}

/// How many steps the feed goes down, from one fraction of the length to another.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Range {
    from: f64,
    to: f64,
    steps: u8,
}

pub fn parts(step: &Step, conditions: &Conditions) -> Vec<Part> {
    let role = match step.purpose {
        Purpose::Link => Role::Link,
        Purpose::LeadOut => Role::LeadOut,
        Purpose::LeadIn => Role::LeadIn,
        Purpose::Cut => Role::Cut,
    };
    let feed = conditions.cutting.feed_of(role);
    if step.purpose == Purpose::Link {
        return vec![Part { element: step.element, feed, role }];
    }
    let ranges = step.angles.iter().map(|stretch| Range {
        from: stretch.from,
        to: stretch.to,
        steps: conditions.steps_down(stretch.angle),
    });
    let ranges = lengthened(&joined(ranges), SHORTEST * conditions.radius_mm / step.element.length());
    let part = |range: Range| Part {
        element: if (range.from, range.to) == (0.0, 1.0) {
            step.element
        } else {
            step.element.part(range.from, range.to)
        },
        feed: conditions.stepped_down(feed, range.steps),
        role,
    };
    joined(ranges.into_iter()).into_iter().map(part).collect()
}

/// Neighbours with the same feed as one.
fn joined(ranges: impl Iterator<Item = Range>) -> Vec<Range> {
    let mut all: Vec<Range> = Vec::new();
    for range in ranges {
        match all.last_mut() {
            Some(last) if last.steps == range.steps => last.to = range.to,
            _ => all.push(range),
        }
    }
    all
}

/// Short ranges with the slowest feed of their neighbours, if that is slower.
fn lengthened(ranges: &[Range], shortest: f64) -> Vec<Range> {
    let slowed = |k: usize| {
        let range = ranges[k];
        if range.to - range.from >= shortest {
            return range;
        }
        let near = &ranges[k.saturating_sub(1)..(k + 2).min(ranges.len())];
        Range { steps: near.iter().map(|near| near.steps).max().unwrap_or(range.steps), ..range }
    };
    (0..ranges.len()).map(slowed).collect()
}
