//! The border of an area that is made of many pieces.
//!
//! # Method
//! Every piece is a closed chain of edges in one sense. Where two pieces meet, their edges run against each
//! other and cancel; what is left is closed again, and winds about every place of the area as often as pieces
//! lie over it. Joined in any way, it fills the area by the rule `nonzero`.

use nalgebra::Point2;

use crate::plot::pen::Pen;

/// A place in thousandths of a millimetre of paper: finer than it is written, so that equal places are equal.
type Spot = [i32; 2];

/// Edges from the lesser to the greater spot, with how often they are run so; below zero for the other way.
#[derive(Debug, Clone, Default)]
pub struct Border {
    edges: Vec<([Spot; 2], i32)>,
}

impl Border {
    /// Adds a piece whose corners turn in this sense, 1 or -1.
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

    /// The same border with edges that cancel left out.
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

    /// Path data of closed curves.
    pub fn data(&self) -> String {
        let mut ways: Vec<[Spot; 2]> = Vec::with_capacity(self.edges.len());
        for ([low, high], times) in &self.edges {
            let way = if *times > 0 { [*low, *high] } else { [*high, *low] };
            ways.extend(std::iter::repeat_n(way, times.unsigned_abs() as usize));
        }
        ways.sort_unstable();
        let starts: Vec<usize> =
            ways.iter().map(|way| ways.partition_point(|other| other[0] < way[0])).collect();
        // How many of the ways from a spot are taken, at the first of them.
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
    fn what_pieces_share_goes_and_what_encloses_a_hole_stays() {
        assert_eq!(of([square(0.0, 0.0, 1), square(1.0, 0.0, -1)]), "M0 0L2 0L2 1L0 1L0 0");
        let ring = (0..9).filter(|k| *k != 4).map(|k| square(f64::from(k % 3), f64::from(k / 3), 1));
        assert_eq!(of(ring), "M0 0L3 0L3 3L0 3L0 0M1 1L1 2L2 2L2 1L1 1");
        assert_eq!(of([]), "");
    }

    #[test]
    fn pieces_over_each_other_wind_in_one_sense() {
        // The same square from both sides does not vanish.
        let data = of([square(0.0, 0.0, 1), square(0.0, 0.0, -1)]);
        assert_eq!(data.matches('L').count(), 8, "{data}");
    }
}
