//! Two toolpaths as one.

use nalgebra::{Point3, Vector3};

use super::{Move, Pass, ToolAxes, Toolpath};
use crate::geometry::curve::Line;

impl Toolpath {
    /// Where the tip stands after the last move.
    pub fn end(&self) -> Point3<f64> {
        let end = |step: &Move| match step {
            Move::Rapid { line } => Some(line.end),
            Move::Feed { along, .. } => Some(along.end()),
            Move::Turn { at, .. } => Some(*at),
            Move::Dwell { .. } => None,
        };
        let last = self.passes.iter().rev().find_map(|pass| {
            let moved = pass.moves.iter().rev().find_map(end);
            moved.or(pass.start)
        });
        last.unwrap_or(self.start)
    }

    /// This toolpath, then rapids up to `height_mm` at least, across and down, then the next toolpath. Both
    /// have the tool straight up.
    #[must_use]
    pub fn then(mut self, next: Self, height_mm: f64) -> Self {
        let (from, to) = (self.end(), next.start);
        let top = height_mm.max(from.z).max(to.z);
        let over = |p: Point3<f64>| Point3::new(p.x, p.y, top);
        let places = [from, over(from), over(to), to];
        let ways = places.windows(2).filter(|pair| pair[0] != pair[1]);
        let moves = ways.map(|pair| Move::Rapid { line: Line { start: pair[0], end: pair[1] } }).collect();
        let axes = ToolAxes::Fixed(Vector3::z_axis());
        let (rails, cycles) = (Vec::new(), Vec::new());
        self.passes.push(Pass { level: None, start: None, moves, axes, rails, cycles, rotary: None });
        self.passes.extend(next.passes);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::toolpath::Role;
    use crate::toolpath::units::FeedRate;

    /// A plunge, a cut and a pause.
    fn cut(x: f64) -> Toolpath {
        let feed = FeedRate::from_mm_per_min(100.0).unwrap();
        let mut path = Toolpath::builder(Point3::new(x, 0.0, 5.0));
        path.line(Point3::new(x, 0.0, -1.0), feed, Role::Plunge).unwrap();
        path.line(Point3::new(x + 2.0, 3.0, -1.0), feed, Role::Cut).unwrap();
        path.dwell(1.0).unwrap();
        path.finish().unwrap()
    }

    #[test]
    fn the_tool_goes_up_across_and_down_between_two_toolpaths() {
        let joined = cut(0.0).then(cut(10.0), 20.0);
        assert_eq!((joined.start(), joined.end()), (cut(0.0).start(), cut(10.0).end()));
        let rapids: Vec<Point3<f64>> = joined
            .moves()
            .filter_map(|step| if let Move::Rapid { line } = step { Some(line.end) } else { None })
            .collect();
        let expected = [[2.0, 3.0, 20.0], [10.0, 0.0, 20.0], [10.0, 0.0, 5.0]];
        assert_eq!(rapids, expected.map(Point3::from));
        assert_eq!(joined.moves().count(), 9);
        // Each move starts where the one before ends.
        let mut at = joined.start();
        for step in joined.moves() {
            let ends = match step {
                Move::Rapid { line } => Some([line.start, line.end]),
                Move::Feed { along, .. } => Some([along.start(), along.end()]),
                Move::Turn { .. } | Move::Dwell { .. } => None,
            };
            if let Some([start, end]) = ends {
                assert_eq!(start, at);
                at = end;
            }
        }
    }

    #[test]
    fn a_toolpath_without_moves_ends_where_it_starts() {
        let start = Point3::new(1.0, 2.0, 3.0);
        let empty = Toolpath::builder(start).finish().unwrap();
        assert_eq!(empty.end(), start);
        assert_eq!(empty.then(cut(0.0), 1.0).moves().count(), 5);
    }
}
