//! The border of an area that consists of many pieces. The pieces may overlap.
//!
//! # Method
//! The edges of every piece run around the piece in the same direction of rotation. Where two pieces lie side
//! by side, their common edge occurs once in each direction, and both occurrences are removed. The remaining
//! edges form closed chains. The SVG fill rule `nonzero` fills the area within these chains.

use nalgebra::Point2;

use crate::pen::Pen;

/// A place in thousandths of a millimetre of paper. That is finer than coordinates are written, and makes
/// equal places equal numbers.
type Spot = [i32; 2];

/// Edges from the lesser to the greater spot, each with the number of its uses; uses in the opposite
/// direction count as -1.
#[derive(Debug, Clone, Default)]
pub struct Border {
    edges: Vec<([Spot; 2], i32)>,
}

impl Border {
    /// Adds a piece whose corners turn in the direction `sense`: 1 for clockwise on paper, -1 for
    /// counterclockwise.
    pub fn add(&mut self, sense: i32, corners: impl Iterator<Item = Point2<f64>> + Clone) {
        let spots = corners.map(|p| [p.x, p.y].map(|mm| (mm * 1000.0).round() as i32));
        let nexts = spots.clone().cycle().skip(1);
        for (from, to) in spots.zip(nexts) {
            if from != to {
                let edge = if from < to { ([from, to], sense) } else { ([to, from], -sense) };
                self.edges.push(edge);
            }
        }
    }

    pub fn merge(&mut self, other: Border) {
        self.edges.extend(other.edges);
    }

    /// The same border without edges that cancel.
    pub fn settled(mut self) -> Self {
        self.edges.sort_unstable();
        self.edges.dedup_by(|next, kept| {
            let is_same = next.0 == kept.0;
            if is_same {
                kept.1 += next.1;
            }
            is_same
        });
        self.edges.retain(|(_, times)| *times != 0);
        self
    }

    /// Path data of closed chains. Around a place of the area they turn as many times as there are pieces
    /// over it. So the fill rule `nonzero` fills the place, in whichever order the edges are joined.
    pub fn data(&self) -> String {
        let mut ways: Vec<[Spot; 2]> = Vec::with_capacity(self.edges.len());
        for ([low, high], times) in &self.edges {
            let way = if *times > 0 { [*low, *high] } else { [*high, *low] };
            ways.extend(std::iter::repeat_n(way, times.unsigned_abs() as usize));
        }
        ways.sort_unstable();
        let starts: Vec<usize> =
            ways.iter().map(|way| ways.partition_point(|other| other[0] < way[0])).collect();
        // For the first edge from each spot, the number of edges from that spot that are drawn.
        let mut taken = vec![0; ways.len()];
        let mut pen = Pen::new(None);
        for first in 0..ways.len() {
            let mut at = ways[first][0];
            let mut start = starts[first];
            while let Some([_, to]) = ways.get(start + taken[start]).filter(|way| way[0] == at) {
                taken[start] += 1;
                pen.line(paper(at), paper(*to));
                at = *to;
                start = ways.partition_point(|way| way[0] < at);
                if start == ways.len() {
                    break;
                }
            }
        }
        pen.finish()
    }
}

fn paper(spot: Spot) -> Point2<f64> {
    Point2::from(spot.map(|thousandths| f64::from(thousandths) / 1000.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(left: f64, top: f64, sense: i32) -> Border {
        let mut border = Border::default();
        let mut corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        if sense < 0 {
            corners.reverse();
        }
        border.add(sense, corners.map(|[x, y]| Point2::new(left + x, top + y)).into_iter());
        border
    }

    fn of(squares: impl IntoIterator<Item = Border>) -> String {
        let mut all = Border::default();
        squares.into_iter().for_each(|square| all.merge(square));
        all.settled().data()
    }

    #[test]
    fn shared_edges_vanish_and_the_border_of_a_hole_stays() {
        assert_eq!(of([square(0.0, 0.0, 1), square(1.0, 0.0, -1)]), "M0 0L2 0L2 1L0 1L0 0");
        let ring = (0..9).filter(|k| *k != 4).map(|k| square(f64::from(k % 3), f64::from(k / 3), 1));
        assert_eq!(of(ring), "M0 0L3 0L3 3L0 3L0 0M1 1L1 2L2 2L2 1L1 1");
        assert_eq!(of([]), "");
    }

    #[test]
    fn pieces_over_each_other_do_not_cancel() {
        // A square and the same square turned over do not cancel.
        let data = of([square(0.0, 0.0, 1), square(0.0, 0.0, -1)]);
        assert_eq!(data.matches('L').count(), 8, "{data}");
    }
}
