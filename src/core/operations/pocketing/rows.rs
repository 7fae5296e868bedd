//! Rows: parallel lines across the pocket, joined along walls and islands. The patterns `zigzag_offset`,
//! `continuous_offset` and `continuous_stock_offset`.

use nalgebra::Point2;

use super::PocketError;
use super::crossings::{Crossing, Crossings, Frame};
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;
use crate::geometry::spacing::spaces;

/// What a row does at an island.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AtIsland {
    /// It turns back along the island's edge.
    Turn,
    /// It goes around the island and on.
    Around,
}

/// Where rows run and how far apart they are.
#[derive(Debug, Clone)]
pub struct Layout<'a> {
    /// Rows end on its boundary.
    pub area: &'a Region,
    /// Every place in it is at most half a spacing beside a row.
    pub needed: &'a Region,
    pub stepover_mm: f64,
    pub at_island: AtIsland,
}

/// The chains of rows in the direction of a frame.
pub fn chains(layout: &Layout, frame: Frame, budget: &Budget) -> Result<Vec<Vec<Segment>>, PocketError> {
    Ok(Rows::new(layout, frame, budget)?.chains(layout.at_island))
}

struct Rows {
    frame: Frame,
    outlines: Vec<Vec<Segment>>,
    is_island: Vec<bool>,
    ys: Vec<f64>,
    crossings: Crossings,
}

impl Rows {
    fn new(layout: &Layout, frame: Frame, budget: &Budget) -> Result<Self, PocketError> {
        let is_island = layout
            .area
            .faces()
            .iter()
            .flat_map(|face| std::iter::once(false).chain(face.islands.iter().map(|_| true)))
            .collect();
        let outlines = frame.outlines(layout.area);
        let mut ys = Vec::new();
        if let Some([low, high]) = Crossings::range(&frame.outlines(layout.needed)) {
            let count = spaces(high - low, layout.stepover_mm);
            let spacing = (high - low) / count;
            ys = (0..Crossings::checked(count)?).map(|k| low + spacing * (k as f64 + 0.5)).collect();
        }
        let crossings = Crossings::new(&outlines, &ys, budget)?;
        Ok(Self { frame, outlines, is_island, ys, crossings })
    }

    fn chains(&self, at_island: AtIsland) -> Vec<Vec<Segment>> {
        let mut is_done = vec![false; self.crossings.all.len()];
        let mut chains = Vec::new();
        for first in &self.crossings.lefts {
            if is_done[*first] {
                continue;
            }
            let mut chain = Vec::new();
            let mut from = *first;
            loop {
                // Along the row, in one direction or the other.
                let mut to = self.cross(from, &mut chain, &mut is_done);
                if at_island == AtIsland::Around {
                    while let Some((next, is_forward)) =
                        self.beyond(to, self.crossings.all[from].x < self.crossings.all[to].x, &is_done)
                    {
                        self.walk(to, next, is_forward, &mut chain);
                        from = next;
                        to = self.cross(from, &mut chain, &mut is_done);
                    }
                }
                let row = self.crossings.all[to].row;
                let Crossing { before, after, .. } = self.crossings.all[to];
                let mut onward: Option<(f64, usize, Vec<Segment>)> = None;
                for (next, is_forward) in [(after, true), (before, false)] {
                    if self.crossings.all[next].row == row + 1 && !is_done[next] {
                        let mut way = Vec::new();
                        self.walk(to, next, is_forward, &mut way);
                        let length = way.iter().map(Segment::length).sum();
                        if onward.as_ref().is_none_or(|(least, ..)| length < *least) {
                            onward = Some((length, next, way));
                        }
                    }
                }
                let Some((_, next, way)) = onward else { break };
                chain.extend(way);
                from = next;
            }
            chains.push(self.frame.in_workpiece(&chain));
        }
        chains
    }

    /// Goes along the row to the other end of its part.
    fn cross(&self, from: usize, chain: &mut Vec<Segment>, is_done: &mut [bool]) -> usize {
        let to = self.crossings.all[from].other;
        is_done[from] = true;
        is_done[to] = true;
        chain.push(Segment::Line { start: self.place(from), end: self.place(to) });
        to
    }

    /// Where the row goes on beyond the island at which it ends, and whether the shorter way around is along
    /// the outline.
    fn beyond(&self, at: usize, is_rightward: bool, is_done: &[bool]) -> Option<(usize, bool)> {
        let here = &self.crossings.all[at];
        if !self.is_island[here.outline] {
            return None;
        }
        let is_beyond = |other: &Crossing| {
            other.row == here.row && other.outline == here.outline && (other.x > here.x) == is_rightward
        };
        let next = (0..self.crossings.all.len())
            .filter(|k| is_beyond(&self.crossings.all[*k]) && !is_done[*k])
            .min_by(|a, b| {
                (self.crossings.all[*a].x - here.x)
                    .abs()
                    .total_cmp(&(self.crossings.all[*b].x - here.x).abs())
            })?;
        let length = |is_forward: bool| {
            let mut way = Vec::new();
            self.walk(at, next, is_forward, &mut way);
            way.iter().map(Segment::length).sum::<f64>()
        };
        Some((next, length(true) <= length(false)))
    }

    fn place(&self, k: usize) -> Point2<f64> {
        let Crossing { outline, element, t, row, .. } = self.crossings.all[k];
        Point2::new(self.outlines[outline][element].at(t).x, self.ys[row])
    }

    /// Follows the outline from one crossing to another.
    fn walk(&self, from: usize, to: usize, is_forward: bool, chain: &mut Vec<Segment>) {
        if is_forward {
            chain.extend(self.crossings.between(&self.outlines, from, to));
        } else {
            let way = self.crossings.between(&self.outlines, to, from);
            chain.extend(way.iter().rev().map(Segment::reversed));
        }
    }
}
