//! How far elements can reach at most, and how few can be left at least: what the search need not look at.
//!
//! From a place, the circles through it that pass near the points that follow ([`Fan`]) end somewhere, and so do elements.
//! The counts follow backwards from the last point.
//!
//! # Cost
//! O(log m) discs a point for elements of m points, as the fan looks at ever fewer of them.

use super::fan::Fan;
use super::span::{Points, Rule};
use crate::budget::{Budget, Stopped};

/// What no element can do.
#[derive(Debug)]
pub struct Bounds {
    /// For each point, one that no element from it reaches.
    pub beyond: Vec<usize>,
    /// From each point to the last there are at least so many elements.
    pub left: Vec<usize>,
}

impl Bounds {
    /// For elements that meet on the points.
    pub fn on_points(points: Points, rule: &Rule, budget: &Budget) -> Result<Self, Stopped> {
        let flat = points.flat;
        let n = flat.len();
        let (mut beyond, mut left) = (vec![n; n], vec![0; n]);
        let mut fan = Fan::new(rule);
        for i in (0..n.saturating_sub(1)).rev() {
            budget.check()?;
            fan.restart(flat[i]);
            let closing = Fan::worth(i).take_while(|k| *k < n).find(|k| !fan.take(flat[*k]));
            beyond[i] = closing.map_or(n, |k| k + 1);
            left[i] = 1 + left[i + 1..beyond[i]].iter().min().copied().unwrap_or_default();
        }
        Ok(Self { beyond, left })
    }

    /// For elements that meet anywhere: nothing is known.
    pub fn unknown(n: usize) -> Self {
        Self { beyond: vec![n; n], left: (0..n).map(|k| usize::from(k + 1 < n)).collect() }
    }
}
