//! Rows that are as short as they can be: the rows of `zigzag_stock_offset`.
//!
//! # Method
//! 1. A pass along walls and islands frees everything within the cutter's radius R of it. What is left to the
//!    rows is the region N of the places farther than R from the edge of the centres' region.
//! 2. N is divided into strips, at most a stepover s wide. Each connected part of N in a strip gets a row in
//!    the middle of the strip. The row ends h = sqrt(R^2 - s^2 / 4) before the ends of the part. If the part
//!    is shorter than 2 h, its row is one place.
//! 3. Rows of neighbouring parts are joined: straight if there is room, else along one row, across where the
//!    two parts meet, and along the other row.
//!
//! # Guarantees
//! Every place of N is within s / 2 of its row across the strip and within h along it, so within R. A disc
//! of radius R about a place of N lies in the centres' region, so rows and joints lie in it too.

use nalgebra::{Point2, Rotation2};

use super::PocketError;
use super::chain::ROUNDING_MM;
use super::crossings::{Crossings, Frame};
use crate::budget::Budget;
use crate::geometry::region::Region;
use crate::geometry::segment::Segment;
use crate::geometry::spacing::spaces;

/// How near to the edge of the centres' region a joint may come, mm: above the rounding of offsets.
const BESIDE_MM: f64 = 2e-6;

/// A connected part of the region in a strip, from `left` to `right`.
#[derive(Debug, Clone)]
struct Part {
    strip: usize,
    left: f64,
    right: f64,
    /// Parts in the strips above and below, with the common range of x.
    neighbours: Vec<(usize, [f64; 2])>,
}

/// Chains of rows for `needed` in the direction of `frame`.
pub fn chains(
    needed: &Region,
    centers: &Region,
    radius_mm: f64,
    stepover_mm: f64,
    frame: Frame,
    budget: &Budget,
) -> Result<Vec<Vec<Segment>>, PocketError> {
    let outlines = frame.outlines(needed);
    let Some([low, high]) = Crossings::range(&outlines) else { return Ok(Vec::new()) };
    let count = spaces(high - low, stepover_mm);
    let width = (high - low) / count;
    let count = Crossings::checked(count)?;
    let edges: Vec<f64> = (1..count).map(|k| low + width * k as f64).collect();
    let crossings = Crossings::new(&outlines, &edges, budget)?;
    let mut parts = parts(&outlines, &edges, &crossings);
    let short = (radius_mm * radius_mm - 0.25 * width * width).max(0.0).sqrt();
    for part in &mut parts {
        let middle = 0.5 * (part.left + part.right);
        (part.left, part.right) = (f64::min(part.left + short, middle), f64::max(part.right - short, middle));
    }
    let y = |strip: usize| low + width * (strip as f64 + 0.5);
    let rows = Rows { parts: &parts, y: &y, centers, rotation: frame.rotation };
    Ok(rows.chains())
}

/// The parts of all strips.
fn parts(outlines: &[Vec<Segment>], edges: &[f64], crossings: &Crossings) -> Vec<Part> {
    // Each range of an outline between two crossings is in one strip. Ranges that meet the same part of an
    // edge bound the same part of the strip.
    let all = &crossings.all;
    let mut group: Vec<usize> = (0..2 * all.len()).collect();
    // Every crossing has a side above and a side below.
    let side = |k: usize, is_above: bool| 2 * k + usize::from(is_above);
    for (k, crossing) in all.iter().enumerate() {
        for is_above in [false, true] {
            join(&mut group, side(k, is_above), side(crossing.other, is_above));
        }
        join(&mut group, side(k, crossing.is_up), side(crossing.after, !all[crossing.after].is_up));
    }
    let mut extents: Vec<[f64; 2]> = vec![[f64::INFINITY, f64::NEG_INFINITY]; group.len()];
    for (k, crossing) in all.iter().enumerate() {
        let root = find(&mut group, side(k, crossing.is_up));
        for element in crossings.between(outlines, k, crossing.after) {
            let [left, right] = Crossings::width(&element);
            extents[root] = [extents[root][0].min(left), extents[root][1].max(right)];
        }
    }
    let mut parts: Vec<Part> = Vec::new();
    let mut part_of = vec![usize::MAX; group.len()];
    for (k, crossing) in all.iter().enumerate() {
        for is_above in [false, true] {
            let root = find(&mut group, side(k, is_above));
            if part_of[root] == usize::MAX {
                part_of[root] = parts.len();
                let [left, right] = extents[root];
                parts.push(Part {
                    strip: crossing.row + usize::from(is_above),
                    left,
                    right,
                    neighbours: Vec::new(),
                });
            }
        }
    }
    for left in &crossings.lefts {
        let range = [all[*left].x, all[all[*left].other].x];
        let [below, above] = [false, true].map(|is_above| part_of[find(&mut group, side(*left, is_above))]);
        parts[below].neighbours.push((above, range));
        parts[above].neighbours.push((below, range));
    }
    // Outer outlines that meet no edge; islands that meet none are inside a part.
    for outline in outlines {
        if crossings.is_untouched(outlines, outline) && Crossings::turns_left(outline) {
            let y = outline[0].start().y;
            let widths = outline.iter().map(Crossings::width);
            let [left, right] =
                widths.fold([f64::INFINITY, f64::NEG_INFINITY], |a, b| [a[0].min(b[0]), a[1].max(b[1])]);
            parts.push(Part {
                strip: edges.partition_point(|edge| *edge <= y),
                left,
                right,
                neighbours: Vec::new(),
            });
        }
    }
    parts
}

fn find(group: &mut [usize], mut k: usize) -> usize {
    while group[k] != k {
        group[k] = group[group[k]];
        k = group[k];
    }
    k
}

fn join(group: &mut [usize], a: usize, b: usize) {
    let (a, b) = (find(group, a), find(group, b));
    group[a.max(b)] = a.min(b);
}

struct Rows<'a> {
    parts: &'a [Part],
    y: &'a dyn Fn(usize) -> f64,
    centers: &'a Region,
    rotation: Rotation2<f64>,
}

impl Rows<'_> {
    fn chains(&self) -> Vec<Vec<Segment>> {
        let mut is_done = vec![false; self.parts.len()];
        let mut order: Vec<usize> = (0..self.parts.len()).collect();
        order.sort_by(|a, b| {
            let (a, b) = (&self.parts[*a], &self.parts[*b]);
            a.strip.cmp(&b.strip).then(a.left.total_cmp(&b.left))
        });
        let mut chains = Vec::new();
        for first in order {
            if is_done[first] {
                continue;
            }
            is_done[first] = true;
            let part = &self.parts[first];
            let mut way = vec![self.place(first, part.left), self.place(first, part.right)];
            let (mut at, mut x) = (first, part.right);
            while let Some((next, across, start)) = self.next(at, x, &is_done) {
                is_done[next] = true;
                let part = &self.parts[next];
                let end = part.left + part.right - start;
                let straight = [self.place(at, x), self.place(next, start)];
                if !self.is_free(straight) {
                    way.extend([self.place(at, across), self.place(next, across)]);
                }
                way.extend([self.place(next, start), self.place(next, end)]);
                (at, x) = (next, end);
            }
            chains.push(self.elements(&way));
        }
        chains
    }

    /// The next part, where to cross to it, and the end at which its row begins.
    fn next(&self, at: usize, x: f64, is_done: &[bool]) -> Option<(usize, f64, f64)> {
        let mut best: Option<(f64, (usize, f64, f64))> = None;
        for &(next, [from, to]) in &self.parts[at].neighbours {
            if is_done[next] {
                continue;
            }
            let across = x.clamp(from, to);
            let part = &self.parts[next];
            let start = if (part.left - across).abs() <= (part.right - across).abs() {
                part.left
            } else {
                part.right
            };
            let way = (across - x).abs() + (start - across).abs();
            if best.is_none_or(|(least, _)| way < least) {
                best = Some((way, (next, across, start)));
            }
        }
        best.map(|(_, next)| next)
    }

    fn place(&self, part: usize, x: f64) -> Point2<f64> {
        self.rotation * Point2::new(x, (self.y)(self.parts[part].strip))
    }

    fn is_free(&self, [start, end]: [Point2<f64>; 2]) -> bool {
        self.centers.contains(&Segment::Line { start, end }, BESIDE_MM)
    }

    fn elements(&self, way: &[Point2<f64>]) -> Vec<Segment> {
        let mut elements: Vec<Segment> = Vec::new();
        for pair in way.windows(2).filter(|pair| (pair[1] - pair[0]).norm() > ROUNDING_MM) {
            elements.push(Segment::Line { start: pair[0], end: pair[1] });
        }
        // A single place.
        if elements.is_empty()
            && let Some(place) = way.first()
        {
            elements.push(Segment::Line { start: *place, end: *place });
        }
        elements
    }
}
