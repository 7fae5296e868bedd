//! Five-axis machines: three linear axes and two rotary axes of any directions, and the motion of the five
//! axes along a path of poses.
//!
//! # Method
//! The machine frame is fixed. At the zero position of all axes the frame of the workpiece equals the machine
//! frame, the tool tip is at the origin and the tool axis is +Z.
//! * A rotary axis of a *table* carries the workpiece. A rotary axis of a *head* carries the tool. A positive
//!   angle turns what the axis carries, right-handed about [`RotaryAxis::direction`]. With
//!   [`RotaryAxis::is_mirrored`] it turns the other way. ISO 841 counts the axes of a table by the motion of
//!   the tool relative to the workpiece: such an axis is mirrored here.
//! * The first rotary axis carries the second one in [`Kind::TableTable`] and [`Kind::HeadHead`]. So the
//!   first one is next to the frame of the machine, and the second one is next to the workpiece or the tool.
//!   In [`Kind::HeadTable`] the first axis belongs to the head, and the second axis belongs to the table.
//! * The linear axes X, Y and Z follow the machine frame. They state where the tool tip is when all rotary
//!   axes *of the head* are at zero.
//!
//! Forward: the tip is the linear position, plus the shift of the tip by the head, turned back by the table.
//! Inverse: the two rotary angles follow from the tool axis alone (`orientation`), and then the linear axes
//! follow from the tip. One generic function serves numbers and Taylor series (`series`), so that derivatives
//! belong to the same solution (`along`). `follow` chooses the solutions along a path.
//!
//! # Guarantees
//! * The pose of an inverse differs from the given pose by less than 1e-10, in mm for the tip (within 1000
//!   mm) and as a difference of unit vectors for the axis.
//! * [`Machine::inverse`] ignores travel. [`Machine::follow`] keeps it.
//!
//! # Degenerate input
//! * At the pole the tool axis is parallel to the rotary axis that is next to the workpiece: the angle of
//!   this axis is free. For heads, the axis next to the workpiece is the first one.
//! * Rotary axes that are almost parallel are refused. So is an axis next to the tool that is almost parallel
//!   to the tool at zero.
//!
//! # Cost
//! Constant for each pose.
//!
//! # Reference
//! R. M. Murray, Z. Li, S. S. Sastry, *A Mathematical Introduction to Robotic Manipulation*, CRC Press, 1994,
//! chapter 3: products of exponentials and the Paden-Kahan subproblems.

mod along;
mod ball;
mod follow;
pub mod named;
mod orientation;
mod rotary_axis;
mod scalar;
mod series;
mod straying;
#[cfg(test)]
mod tests;

use std::f64::consts::TAU;

use nalgebra::{Point3, UnitVector3, Vector3};

use crate::toolpath::pose::Pose;
pub use along::Through;
pub use ball::Ball;
pub use follow::FollowError;
use orientation::{Orientation, RotaryPair};
pub use rotary_axis::{Kind, RotaryAxis};
use rotary_axis::{Line, is_within};
use scalar::{Scalar, add, constant, rotate, subtract};
pub use straying::Straying;

/// The positions of the five axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AxisPositions {
    /// X, Y and Z, mm.
    pub linear_mm: [f64; 3],
    /// The two rotary axes, radians.
    pub rotary: [f64; 2],
}

/// The positions for a pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Inverse {
    /// Two solutions, with angles in (-pi, pi]. The branch is the place in the array. At the end of reach
    /// both are equal.
    Two([AxisPositions; 2]),
    /// The angle of the axis [`Machine::free_axis`] is free. `fixed` is the angle of the other one, radians,
    /// in (-pi, pi]. [`Machine::at`] gives the linear axes for a chosen angle.
    Pole { fixed: f64 },
    /// No angles reach the tool axis, or the pose is not finite.
    Unreachable,
}

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MachineError {
    #[error("a number of the machine is not finite, or a direction has no length")]
    NotFinite,
    #[error(
        "the rotary axes {first} and {second} are less than 6 degrees apart; give two different directions"
    )]
    ParallelAxes { first: char, second: char },
    #[error(
        "the rotary axis {axis} is next to the tool and less than 6 degrees from it, so it cannot tilt the tool; exchange the rotary axes"
    )]
    ParallelToTool { axis: char },
    #[error("the axes need five different names; {axis} is there twice")]
    SameName { axis: char },
    #[error("the travel of the axis {axis} ends before it starts; give the lower end first")]
    EmptyTravel { axis: char },
    #[error("the travel of the axis {axis} goes beyond 100,000 radians; leave it out if the axis has no end")]
    LongTravel { axis: char },
    #[error("the axis {axis} turns without end and has a travel; leave out the travel or the wrapping")]
    WrappedWithTravel { axis: char },
    #[error("a pivot length belongs to heads; leave it out for a table that carries both rotary axes")]
    PivotWithoutHead,
}

/// Least sine of the angle between the rotary axes, and between the axis next to the tool and the tool.
/// Errors of the inverse grow by one over this sine. At 0.1 (6 degrees) they stay below 1e-10, and a machine
/// with a smaller angle could hardly tilt the tool.
const LEAST_SINE: f64 = 0.1;

/// Largest angle (radians) of a travel or of a start: 16,000 turns. Rounding of larger angles turns the tool
/// axis by more than 1e-11.
const LARGEST_ANGLE: f64 = 1e5;

/// The names of the linear axes.
const LINEAR: [char; 3] = ['X', 'Y', 'Z'];

/// A machine with three linear and two rotary axes.
///
/// # Example
/// A table that turns about X brings a tool axis that leans 30 degrees in the plane of y and z upright.
///
/// ```
/// use nalgebra::{Point3, UnitVector3, Vector3};
/// use toolpathd_core::machine::{Inverse, named};
/// use toolpathd_core::toolpath::pose::Pose;
///
/// let machine = named::by_name("table_table_ac").unwrap();
/// let lean = 30_f64.to_radians();
/// let axis = UnitVector3::new_normalize(Vector3::new(0.0, lean.sin(), lean.cos()));
/// let pose = Pose { tip: Point3::new(10.0, 20.0, 30.0), axis };
/// let Inverse::Two(both) = machine.inverse(&pose) else { panic!("two ways to lean the table") };
/// for positions in both {
///     assert!((positions.rotary[0].abs() - lean).abs() < 1e-12);
///     assert!((machine.forward(&positions).tip - pose.tip).norm() < 1e-10);
/// }
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Machine {
    name: String,
    kind: Kind,
    rotary: [RotaryAxis; 2],
    travel_mm: [Option<[f64; 2]>; 3],
    pivot_mm: f64,
    lines: [Line; 2],
    pair: RotaryPair,
}

impl Machine {
    /// A machine. The module's documentation states the order of the rotary axes. `travel_mm` holds the least
    /// and largest position of X, Y and Z. `pivot_mm` is the distance from the tool tip to the rotary centre
    /// of the head, along the tool axis.
    ///
    /// # Errors
    /// When the axes cannot tilt the tool in two ways, names repeat, or a number is not usable.
    pub fn new(
        name: impl Into<String>,
        kind: Kind,
        rotary: [RotaryAxis; 2],
        travel_mm: [Option<[f64; 2]>; 3],
        pivot_mm: f64,
    ) -> Result<Self, MachineError> {
        let [x, y, z] = travel_mm;
        let travels = [x, y, z, rotary[0].travel, rotary[1].travel];
        let names = [LINEAR[0], LINEAR[1], LINEAR[2], rotary[0].name, rotary[1].name];
        let points = rotary.iter().flat_map(|axis| axis.point_mm.coords.data.0[0]);
        let mut numbers = points.chain(travels.iter().flatten().flatten().copied()).chain([pivot_mm]);
        if !numbers.all(f64::is_finite) {
            return Err(MachineError::NotFinite);
        }
        for (k, &axis) in names.iter().enumerate() {
            if names[..k].contains(&axis) {
                return Err(MachineError::SameName { axis });
            }
            if travels[k].is_some_and(|[low, high]| low > high) {
                return Err(MachineError::EmptyTravel { axis });
            }
        }
        let is_long = |axis: &&RotaryAxis| {
            axis.travel.is_some_and(|ends| ends.iter().any(|end| end.abs() > LARGEST_ANGLE))
        };
        if let Some(axis) = rotary.iter().find(is_long) {
            return Err(MachineError::LongTravel { axis: axis.name });
        }
        if let Some(axis) = rotary.iter().find(|axis| axis.is_wrapped && axis.travel.is_some()) {
            return Err(MachineError::WrappedWithTravel { axis: axis.name });
        }
        if pivot_mm != 0.0 && kind == Kind::TableTable {
            return Err(MachineError::PivotWithoutHead);
        }
        let heads = kind.heads();
        let line = |k: usize| {
            let axis = &rotary[k];
            let length = axis.direction.norm();
            (length.is_finite() && length > 0.0).then(|| Line {
                point: axis.point_mm.coords + if heads[k] { pivot_mm } else { 0.0 } * Vector3::z(),
                direction: axis.direction.into_inner() / if axis.is_mirrored { -length } else { length },
            })
        };
        let lines = match (line(0), line(1)) {
            (Some(first), Some(second)) => [first, second],
            _ => return Err(MachineError::NotFinite),
        };
        let [first, second] = lines.map(|line| line.direction);
        if first.cross(&second).norm() < LEAST_SINE {
            return Err(MachineError::ParallelAxes { first: rotary[0].name, second: rotary[1].name });
        }
        let next_to_tool = if kind == Kind::HeadHead { 1 } else { 0 };
        if lines[next_to_tool].direction.xy().norm() < LEAST_SINE {
            return Err(MachineError::ParallelToTool { axis: rotary[next_to_tool].name });
        }
        // Turning the tool by an angle is turning the workpiece back by the same angle.
        let relative = [0, 1].map(|k| if heads[k] { -1.0 } else { 1.0 } * lines[k].direction);
        let pair = RotaryPair::new(relative[next_to_tool], relative[1 - next_to_tool]);
        Ok(Self { name: name.into(), kind, rotary, travel_mm, pivot_mm, lines, pair })
    }

    pub fn name(&self) -> &str {
        &self.name
    }

    pub fn kind(&self) -> Kind {
        self.kind
    }

    pub fn rotary(&self) -> &[RotaryAxis; 2] {
        &self.rotary
    }

    /// The least and largest position of X, Y and Z, mm; `None` if the axis has no end.
    pub fn travel_mm(&self) -> [Option<[f64; 2]>; 3] {
        self.travel_mm
    }

    pub fn pivot_mm(&self) -> f64 {
        self.pivot_mm
    }

    /// The rotary axis whose angle is free at the pole: the one next to the workpiece.
    pub fn free_axis(&self) -> usize {
        if self.kind == Kind::HeadHead { 0 } else { 1 }
    }

    /// The letters of the five axes, in the order of [`Machine::derivatives`].
    pub fn axis_names(&self) -> [char; 5] {
        let [x, y, z] = LINEAR;
        [x, y, z, self.rotary[0].name, self.rotary[1].name]
    }

    /// The pose of the tool at the given positions.
    pub fn forward(&self, joints: &AxisPositions) -> Pose {
        let mut tip = add(joints.linear_mm, self.head_shift(joints.rotary));
        for ((line, angle), is_head) in self.lines.iter().zip(joints.rotary).zip(self.kind.heads()) {
            if !is_head {
                tip = line.turn(-angle, tip);
            }
        }
        Pose { tip: Point3::from(tip), axis: self.tool_axis(joints.rotary) }
    }

    /// The positions for a pose. Travel is ignored.
    pub fn inverse(&self, pose: &Pose) -> Inverse {
        let tip = [pose.tip.x, pose.tip.y, pose.tip.z];
        if !tip.iter().all(|x| x.is_finite()) {
            return Inverse::Unreachable;
        }
        let joints = |angles| self.at(&pose.tip, self.in_order(angles));
        match self.pair.solve([pose.axis.x, pose.axis.y, pose.axis.z]) {
            Orientation::Two(both) => Inverse::Two(both.map(joints)),
            Orientation::Touch(angles) => Inverse::Two([joints(angles); 2]),
            Orientation::Pole { alpha } => Inverse::Pole { fixed: alpha },
            Orientation::Unreachable => Inverse::Unreachable,
        }
    }

    /// The positions for a pose whose angles are nearest to given ones; the given angles where the machine
    /// does not reach the tool axis.
    pub fn nearest(&self, pose: &Pose, near: [f64; 2]) -> AxisPositions {
        let rotary = match self.inverse(pose) {
            Inverse::Two(both) => nearer(both.map(|joints| joints.rotary), near),
            Inverse::Pole { fixed } => {
                let mut rotary = near;
                rotary[1 - self.free_axis()] = fixed;
                turned(rotary, near)
            }
            Inverse::Unreachable => near,
        };
        self.at(&pose.tip, rotary)
    }

    /// The positions that bring the tip to its place with the given angles of the rotary axes, radians.
    pub fn at(&self, tip: &Point3<f64>, rotary: [f64; 2]) -> AxisPositions {
        AxisPositions { linear_mm: self.linear([tip.x, tip.y, tip.z], rotary), rotary }
    }

    /// The directions of the tool axis at the poles that the machine reaches, in the workpiece frame.
    pub fn poles(&self) -> impl Iterator<Item = UnitVector3<f64>> + use<> {
        self.pair.poles().map(UnitVector3::new_normalize)
    }

    /// The direction of the tool axis in the workpiece frame.
    fn tool_axis(&self, rotary: [f64; 2]) -> UnitVector3<f64> {
        let mut axis = constant(&Vector3::z());
        let heads = self.kind.heads();
        for k in [1, 0].into_iter().filter(|&k| heads[k]) {
            axis = rotate(&self.lines[k].direction, rotary[k], axis);
        }
        for k in [0, 1].into_iter().filter(|&k| !heads[k]) {
            axis = rotate(&self.lines[k].direction, -rotary[k], axis);
        }
        UnitVector3::new_normalize(Vector3::from(axis))
    }

    /// How far the head moves the tip away from the position of the linear axes.
    fn head_shift<S: Scalar>(&self, rotary: [S; 2]) -> [S; 3] {
        let heads = self.kind.heads();
        let on_head = [1, 0].into_iter().filter(|&k| heads[k]);
        on_head.fold(constant(&Vector3::zeros()), |tip, k| self.lines[k].turn(rotary[k], tip))
    }

    /// The positions of the linear axes.
    fn linear<S: Scalar>(&self, tip: [S; 3], rotary: [S; 2]) -> [S; 3] {
        let heads = self.kind.heads();
        let on_table = [1, 0].into_iter().filter(|&k| !heads[k]);
        let turned = on_table.fold(tip, |tip, k| self.lines[k].turn(rotary[k], tip));
        subtract(turned, self.head_shift(rotary))
    }

    /// The angles of the axes next to the tool and next to the workpiece, in the order of the rotary axes.
    fn in_order<S>(&self, [tool, work]: [S; 2]) -> [S; 2] {
        if self.free_axis() == 0 { [work, tool] } else { [tool, work] }
    }

    /// The first linear axis that is out of its travel.
    fn linear_out_of_travel(&self, linear_mm: &[f64; 3]) -> Option<usize> {
        (0..3).find(|&k| !is_within(self.travel_mm[k], linear_mm[k]))
    }
}

/// The angles of the branch that is nearer to given ones, with the full turns that bring it nearest.
fn nearer<S: Scalar>(branches: [[S; 2]; 2], near: [f64; 2]) -> [S; 2] {
    let [first, second] = branches.map(|rotary| turned(rotary, near));
    let distance =
        |rotary: &[S; 2]| (rotary[0].value() - near[0]).abs() + (rotary[1].value() - near[1]).abs();
    if distance(&first) <= distance(&second) { first } else { second }
}

/// The angles with the full turns that bring them nearest to given ones.
fn turned<S: Scalar>(rotary: [S; 2], near: [f64; 2]) -> [S; 2] {
    [0, 1].map(|k| rotary[k] + S::constant(TAU * ((near[k] - rotary[k].value()) / TAU).round()))
}
