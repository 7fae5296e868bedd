//! Joins the sections of a closed surface across its seams.
//!
//! A seam has two sides in the rectangle of parameters, so that a section that crosses it is traced in two
//! parts. Each part ends at one of the two sides, at the same place. A plane that contains a stretch of a
//! seam is traced a little beside the seam: there the section crosses the seam, or runs along it on one side.

use nalgebra::Point3;

use super::boundary::BoundaryPoint;
use super::{Chain, INSET_MM, PlaneAt, SectionError, Sections, Spacing};
use crate::budget::Budget;
use crate::geometry::surface::Surface;
use crate::geometry::surface::topology::{CLOSED_MM, KINK_LIMIT, Seam, Topology};

/// How far beside its plane a section is traced, in units of [`INSET_MM`], until every part that ends at a
/// seam finds the part that goes on.
const BESIDE: [f64; 7] = [0.0, 1.0, -1.0, 2.0, -2.0, 4.0, -4.0];

/// The share of [`INSET_MM`] within which a stretch of a seam counts as in the plane. Rounding decides then
/// where the plane crosses the seam.
const IN_PLANE: f64 = 0.25;

/// The largest distance at which parts are joined, in units of the distance that the topology allows.
const ROOM: f64 = 2.0;

/// A section from boundary to boundary, with the places where it starts and ends; `None` where it ended for
/// the shortness of its steps.
pub(super) struct Traced {
    pub(super) chain: Chain,
    pub(super) ends: [Option<BoundaryPoint>; 2],
}

/// The directions in which sections go on across a seam.
pub(super) struct Seams {
    /// Whether sections are joined where u, and where v, starts again.
    joined: [bool; 2],
    /// The largest distance between the offsets of both sides, mm.
    apart_mm: f64,
}

impl Seams {
    /// The offset of a surface with a kink along its seam has a gap there, or crosses itself.
    pub(super) fn of(surface: &dyn Surface, radius: f64) -> Self {
        let goes_on = |seam: &Seam| radius == 0.0 || seam.is_smooth();
        let joined = Topology::of(surface).seams().map(|seam| seam.as_ref().is_some_and(goes_on));
        Self { joined, apart_mm: ROOM * (CLOSED_MM + radius * KINK_LIMIT) }
    }

    pub(super) fn is_none(&self) -> bool {
        self.joined == [false; 2]
    }
}

/// An end of a part: the index of the part, and 0 for its start or 1 for its end.
type End = [usize; 2];

impl Sections<'_> {
    /// The sections with `plane`, joined across seams.
    pub(super) fn across_seams(
        &self,
        plane: PlaneAt,
        spacing: Spacing,
        budget: &Budget,
    ) -> Result<Vec<Chain>, SectionError> {
        // The sections with the fewest ends that do not go on.
        let mut best: Option<(usize, Vec<Chain>)> = None;
        let mut lost = None;
        for by in BESIDE {
            let plane = PlaneAt { traced_at: plane.traced_at + by * INSET_MM, ..plane };
            let lies_at =
                |across: &usize| self.boundary.lies_at(*across, plane.traced_at, IN_PLANE * INSET_MM);
            if [0, 1].iter().filter(|across| self.seams.joined[**across]).any(lies_at) {
                continue;
            }
            match self.traced(plane, spacing, budget) {
                Ok(parts) => {
                    let mates = self.mates(&parts);
                    let n_alone = self.n_alone(&parts, &mates);
                    if best.as_ref().is_none_or(|(least, _)| n_alone < *least) {
                        best = Some((n_alone, joined(parts, mates)));
                    }
                    if n_alone == 0 {
                        break;
                    }
                }
                Err(SectionError::Lost { at }) => lost = Some(SectionError::Lost { at }),
                Err(error) => return Err(error),
            }
        }
        match (best, lost) {
            (Some((_, chains)), _) => Ok(chains),
            (None, Some(lost)) => Err(lost),
            (None, None) => Ok(Vec::new()),
        }
    }

    /// The ends of parts at seams, with the side: across u or v, and whether at its least value.
    fn ends_at_seams(&self, parts: &[Traced]) -> Vec<(End, (usize, bool))> {
        let ends = parts.iter().enumerate().flat_map(|(k, part)| {
            [0, 1].into_iter().filter_map(move |end| Some(([k, end], part.ends[end]?.side())))
        });
        ends.filter(|(_, (across, _))| self.seams.joined[*across]).collect()
    }

    /// The end at which each end of a part goes on, if any: nearest pairs first.
    fn mates(&self, parts: &[Traced]) -> Vec<[Option<End>; 2]> {
        let ends = self.ends_at_seams(parts);
        let mut pairs = Vec::new();
        for (n, (one, (across, is_low))) in ends.iter().enumerate() {
            for (other, side) in &ends[n + 1..] {
                if *side == (*across, !is_low) {
                    let distance = (parts[one[0]].end(one[1]) - parts[other[0]].end(other[1])).norm();
                    if distance <= self.seams.apart_mm {
                        pairs.push((distance, *one, *other));
                    }
                }
            }
        }
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut mates = vec![[None; 2]; parts.len()];
        for (_, one, other) in pairs {
            if mates[one[0]][one[1]].is_none() && mates[other[0]][other[1]].is_none() {
                mates[one[0]][one[1]] = Some(other);
                mates[other[0]][other[1]] = Some(one);
            }
        }
        mates
    }

    /// How many parts end at a seam and do not go on.
    fn n_alone(&self, parts: &[Traced], mates: &[[Option<End>; 2]]) -> usize {
        self.ends_at_seams(parts).iter().filter(|([part, end], _)| mates[*part][*end].is_none()).count()
    }
}

impl Traced {
    fn end(&self, end: usize) -> Point3<f64> {
        if end == 0 { self.chain.points[0] } else { self.chain.points[self.chain.points.len() - 1] }
    }
}

/// The chains of parts that go on at their mates.
fn joined(parts: Vec<Traced>, mates: Vec<[Option<End>; 2]>) -> Vec<Chain> {
    let mut parts: Vec<Option<Chain>> = parts.into_iter().map(|part| Some(part.chain)).collect();
    let mut chains = Vec::new();
    // Chains with two ends first; what is left is closed.
    let begins = (0..parts.len()).flat_map(|k| [[k, 0], [k, 1]]);
    let (ends, rest): (Vec<End>, Vec<End>) = begins.partition(|[k, end]| mates[*k][*end].is_none());
    for begin in ends.into_iter().chain(rest) {
        let mut chain: Option<Chain> = None;
        let mut next = Some(begin);
        while let Some([k, end]) = next {
            let Some(mut part) = parts[k].take() else { break };
            if end == 1 {
                part.points.reverse();
            }
            match &mut chain {
                None => chain = Some(part),
                Some(chain) => {
                    // The last point and the first point of the next part are one place.
                    chain.points.extend(part.points.drain(1..));
                    chain.chord_height_mm = chain.chord_height_mm.max(part.chord_height_mm);
                }
            }
            next = mates[k][1 - end];
        }
        chains.extend(chain);
    }
    chains
}
