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

/// Whether the slot feed holds, from one fraction of the length to another.
type Range = (f64, f64, bool);

pub fn parts(step: &Step, conditions: &Conditions) -> Vec<Part> {
    if step.purpose == Purpose::Link {
        return vec![Part {
            element: step.element,
            feed: conditions.cutting.feed_of(Role::Link),
            role: Role::Link,
        }];
    }
    let mut ranges: Vec<Range> = Vec::new();
    for stretch in &step.angles {
        let is_slot =
            stretch.angle > conditions.slot_angle && conditions.slot_feed != conditions.cutting.feed;
        match ranges.last_mut() {
            Some(last) if last.2 == is_slot => last.1 = stretch.to,
            _ => ranges.push((stretch.from, stretch.to, is_slot)),
        }
    }
    // A short part between slots is cut as a slot too.
    let shortest = SHORTEST * conditions.radius_mm / step.element.length();
    for range in &mut ranges {
        range.2 |= range.1 - range.0 < shortest;
    }
    let mut merged: Vec<Range> = Vec::new();
    for range in ranges {
        match merged.last_mut() {
            Some(last) if last.2 == range.2 => last.1 = range.1,
            _ => merged.push(range),
        }
    }
    let part = |(from, to, is_slot): Range| Part {
        element: if (from, to) == (0.0, 1.0) { step.element } else { step.element.part(from, to) },
        feed: if is_slot { conditions.slot_feed } else { conditions.cutting.feed },
        role: Role::Cut,
    };
    merged.into_iter().map(part).collect()
}
