//! The moves of a toolpath in the checker's own terms.

use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::{Move, Role, Toolpath};

use super::plane::{P, Piece};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Rapid,
    Feed(Role),
}

/// One straight or round motion of the tip, or a helix, or a vertical motion, which has no length in the
/// plane.
#[derive(Debug, Clone, Copy)]
pub struct Motion {
    pub kind: Kind,
    pub piece: Piece,
    /// The heights at the start and the end, mm.
    pub z: [f64; 2],
    /// mm/min; none for rapids.
    pub feed: Option<f64>,
    pub level: Option<u32>,
    pub pass: usize,
}

impl Motion {
    pub fn low(&self) -> f64 {
        self.z[0].min(self.z[1])
    }

    pub fn is_level(&self) -> bool {
        self.z[0] == self.z[1]
    }

    pub fn is_vertical(&self) -> bool {
        self.piece.length() == 0.0
    }

    pub fn length(&self) -> f64 {
        self.piece.length().hypot(self.z[1] - self.z[0])
    }

    /// Whether this motion runs over the same arc or line as another.
    pub fn retraces(&self, other: &Self) -> bool {
        let near = |t: f64| super::plane::apart(self.piece.at(t), other.piece.at(t)) < 1e-6;
        near(0.0) && near(0.5) && near(1.0)
    }
}

pub fn motions(toolpath: &Toolpath) -> Vec<Motion> {
    let mut found = Vec::new();
    for (pass, moves) in toolpath.passes().iter().enumerate() {
        for step in moves.moves() {
            let (kind, curve, feed) = match step {
                Move::Rapid { line } => (Kind::Rapid, Curve::Line(*line), None),
                Move::Feed { along, rate, role } => {
                    (Kind::Feed(*role), *along, rate.map(|rate| rate.mm_per_min()))
                }
                Move::Turn { .. } | Move::Dwell { .. } => panic!("pockets neither dwell nor lean the tool"),
            };
            let z = [curve.start().z, curve.end().z];
            found.push(Motion { kind, piece: piece(&curve), z, feed, level: moves.level(), pass });
        }
    }
    found
}

fn piece(curve: &Curve) -> Piece {
    let [a, b]: [P; 2] = [curve.start(), curve.end()].map(|p| [p.x, p.y]);
    match curve {
        Curve::Line(_) => Piece::Line { a, b },
        Curve::Arc(arc) => {
            assert_eq!(arc.plane(), Plane::Xy, "an arc stands upright");
            let center = [arc.center().x, arc.center().y];
            Piece::arc(a, b, center, arc.direction() == Direction::Ccw)
        }
        Curve::Parabola(_) => panic!("pockets have no parabolas"),
    }
}
