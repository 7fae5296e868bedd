//! The motions of the tip in a toolpath and in the NC text written from it. Angles and radii are computed
//! here, not by the library.

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;
use toolpathd_core::geometry::curve::{Curve, Direction};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::operations::surface_milling::{Job, Plan};
use toolpathd_core::toolpath::program::Program;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Move, Role};
use toolpathd_post::ProgramJob;
use toolpathd_post::read::{Reader, Step};

/// One motion of the tip.
#[derive(Debug, Clone, Copy)]
pub enum Motion {
    Straight { from: Point3<f64>, to: Point3<f64> },
    Turn(Turn),
}

/// A turn in the plane of two axes. Its radius changes evenly with the angle, from the first to the second.
#[derive(Debug, Clone, Copy)]
pub struct Turn {
    axes: [usize; 2],
    pub center: Point3<f64>,
    pub radii: [f64; 2],
    angle: f64,
    sweep: f64,
}

impl Motion {
    pub fn of(curve: &Curve) -> Self {
        match curve {
            Curve::Line(line) => Self::Straight { from: line.start, to: line.end },
            Curve::Arc(arc) => {
                Self::turn(arc.plane(), arc.direction(), [arc.start(), arc.end()], arc.center())
            }
            Curve::Parabola(_) => panic!("milling makes no parabolas"),
        }
    }

    fn turn(plane: Plane, direction: Direction, ends: [Point3<f64>; 2], center: Point3<f64>) -> Self {
        // The second axis is a quarter turn counterclockwise from the first.
        let axes = match plane {
            Plane::Xy => [0, 1],
            Plane::Zx => [2, 0],
            Plane::Yz => [1, 2],
        };
        let [from, to] = ends.map(|p| {
            let d = p - center;
            (d[axes[1]].atan2(d[axes[0]]), d[axes[0]].hypot(d[axes[1]]))
        });
        let counterclockwise = (to.0 - from.0).rem_euclid(std::f64::consts::TAU);
        let sweep = match direction {
            Direction::Ccw => counterclockwise,
            Direction::Cw => counterclockwise - std::f64::consts::TAU,
        };
        Self::Turn(Turn { axes, center, radii: [from.1, to.1], angle: from.0, sweep })
    }

    pub fn length(&self) -> f64 {
        match self {
            Self::Straight { from, to } => (to - from).norm(),
            Self::Turn(turn) => turn.sweep.abs() * turn.radii[0].max(turn.radii[1]),
        }
    }

    pub fn at(&self, t: f64) -> Point3<f64> {
        match self {
            Self::Straight { from, to } => from + (to - from) * t,
            Self::Turn(turn) => turn.at(t),
        }
    }

    /// The distance to a point, mm.
    pub fn distance(&self, p: &Point3<f64>) -> f64 {
        match self {
            Self::Straight { from, to } => {
                let along = to - from;
                let t = (p - from).dot(&along) / along.norm_squared().max(f64::MIN_POSITIVE);
                (p - self.at(t.clamp(0.0, 1.0))).norm()
            }
            Self::Turn(turn) => {
                let d = p - turn.center;
                let angle = d[turn.axes[1]].atan2(d[turn.axes[0]]) - turn.angle;
                let t = (angle * turn.sweep.signum()).rem_euclid(std::f64::consts::TAU) / turn.sweep.abs();
                let inner = if t <= 1.0 { (p - turn.at(t)).norm() } else { f64::INFINITY };
                inner.min((p - turn.at(0.0)).norm()).min((p - turn.at(1.0)).norm())
            }
        }
    }

    /// For a turn, two turns of constant radius: one with the first radius and one with the second. A control
    /// may take either.
    pub fn extremes(&self) -> Vec<Self> {
        match self {
            Self::Straight { .. } => vec![*self],
            Self::Turn(turn) => turn.radii.map(|r| Self::Turn(Turn { radii: [r, r], ..*turn })).to_vec(),
        }
    }

    pub fn radius_mismatch(&self) -> f64 {
        match self {
            Self::Straight { .. } => 0.0,
            Self::Turn(turn) => (turn.radii[0] - turn.radii[1]).abs(),
        }
    }
}

impl Turn {
    fn at(&self, t: f64) -> Point3<f64> {
        let (sin, cos) = (self.angle + t * self.sweep).sin_cos();
        let radius = self.radii[0] + (self.radii[1] - self.radii[0]) * t;
        let mut around = Vector3::zeros();
        around[self.axes[0]] = radius * cos;
        around[self.axes[1]] = radius * sin;
        self.center + around
    }
}

/// The purpose of a motion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Rapid,
    Plunge,
    Link,
    Cut,
    /// A ramp, or an arc into or out of a pass.
    Lead,
}

/// The motions of the toolpath, pass by pass.
pub fn planned(plan: &Plan) -> Vec<Vec<(Kind, Motion)>> {
    let motion = |step: &Move| match step {
        Move::Rapid { line } => (Kind::Rapid, Motion::Straight { from: line.start, to: line.end }),
        Move::Feed { along, role, .. } => {
            let kind = match role {
                Role::Plunge => Kind::Plunge,
                Role::Link => Kind::Link,
                Role::Cut => Kind::Cut,
                Role::Ramp | Role::LeadIn | Role::LeadOut => Kind::Lead,
            };
            (kind, Motion::of(along))
        }
        Move::Turn { .. } | Move::Dwell { .. } => panic!("milling neither dwells nor leans the tool"),
    };
    plan.toolpath.passes().iter().map(|pass| pass.moves().iter().map(motion).collect()).collect()
}

/// The motions of the NC text of a plan, without those that start at an unknown place.
///
/// A motion at the plunge feed is a plunge. A motion that equals a link or a lead of the plan is of that
/// kind. Every other feed motion is a cut.
pub fn written(job: &Job, plan: &Plan) -> Vec<(Kind, Motion)> {
    let program = Program::plain(job.resolution);
    let dialect = toolpathd_post::dialect("linuxcnc").unwrap();
    let target = ProgramJob { tool: Some(&job.tool), ..ProgramJob::plain(&program, &plan.cutting, dialect) };
    let text = toolpathd_post::write(&plan.toolpath, &target, &Budget::unlimited()).unwrap().text;
    let step = job.resolution.step_mm();
    let beside: Vec<(Kind, Motion)> =
        planned(plan).into_iter().flatten().filter(|m| matches!(m.0, Kind::Link | Kind::Lead)).collect();
    let is_same = |a: &Motion, b: &Motion| [0.0, 1.0].iter().all(|&t| (a.at(t) - b.at(t)).amax() <= step);
    let kind_of = |motion: &Motion| beside.iter().find(|m| is_same(&m.1, motion)).map_or(Kind::Cut, |m| m.0);
    let plunge = plan.cutting.plunge_feed.mm_per_min();
    let is_plunge = |rate: FeedRate| (rate.mm_per_min() - plunge).abs() < 0.01 * plunge;
    Reader::new(&text, dialect, 1.5 * step + 1e-9)
        .filter_map(|placed| match placed.unwrap().step {
            Step::Rapid { from, to } => {
                let [from, to] = [from, to].map(|at| Some(Point3::new(at[0]?, at[1]?, at[2]?)));
                Some((Kind::Rapid, Motion::Straight { from: from?, to: to? }))
            }
            Step::Feed { along: Curve::Line(line), rate, .. } => {
                let motion = Motion::of(&Curve::Line(line));
                Some((if is_plunge(rate) { Kind::Plunge } else { kind_of(&motion) }, motion))
            }
            Step::Feed { along: Curve::Parabola(_), .. } => panic!("milling makes no parabolas"),
            Step::Feed { along: Curve::Arc(arc), center, .. } => {
                let turn = (arc.plane(), arc.direction());
                let motion = Motion::turn(turn.0, turn.1, [arc.start(), arc.end()], center.unwrap());
                Some((kind_of(&motion), motion))
            }
            Step::Posed(_) | Step::Rail(_) | Step::Hole(_) | Step::Dwell { .. } => {
                panic!("milling neither dwells nor leans the tool")
            }
        })
        .collect()
}
