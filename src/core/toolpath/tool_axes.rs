//! The tool axis along the moves of a pass. The axis points from the tip to the spindle.

use nalgebra::{UnitVector3, Vector3};

/// Axes at a larger angle are opposite, radians: the great circle between them is not certain.
pub const OPPOSITE: f64 = std::f64::consts::PI - 1e-3;

/// The tool axis along a pass.
#[derive(Debug, Clone, PartialEq)]
pub enum ToolAxes {
    /// The same axis throughout.
    Fixed(UnitVector3<f64>),
    /// The axis at the start of the pass and at the end of each of its moves. During a move the axis turns on
    /// the great circle, in step with the length of the way.
    Turning { start: UnitVector3<f64>, ends: Vec<UnitVector3<f64>> },
}

impl ToolAxes {
    /// Straight up throughout, as on a machine with three axes.
    pub fn up() -> Self {
        Self::Fixed(Vector3::z_axis())
    }

    pub fn is_up(&self) -> bool {
        *self == Self::up()
    }

    /// The axis at the start of the pass.
    pub fn start(&self) -> UnitVector3<f64> {
        match self {
            Self::Fixed(axis) | Self::Turning { start: axis, .. } => *axis,
        }
    }

    /// The axis at the end of the move `k`.
    pub fn after(&self, k: usize) -> UnitVector3<f64> {
        match self {
            Self::Fixed(axis) => *axis,
            Self::Turning { start, ends } => ends.get(k).copied().unwrap_or(*start),
        }
    }

    /// Adds the axis at the end of the next move, of which there are `count` before it.
    pub(super) fn push(&mut self, count: usize, axis: UnitVector3<f64>) {
        match self {
            Self::Fixed(fixed) if *fixed == axis => {}
            Self::Fixed(fixed) => {
                let mut ends = vec![*fixed; count];
                ends.push(axis);
                *self = Self::Turning { start: *fixed, ends };
            }
            Self::Turning { ends, .. } => ends.push(axis),
        }
    }
}

/// The angle between two vectors, radians; accurate for small angles too.
pub fn angle_between(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.cross(b).norm().atan2(a.dot(b))
}

/// The least sine of the angle between axes at which places between them are found by angles. Below it, the
/// weights of both axes are nearly 0 by 0, and the mean differs from the great circle by less than rounding.
const LEAST_SINE: f64 = 1e-9;

/// Whether the great circle between two axes is not certain.
pub fn are_opposite(a: &UnitVector3<f64>, b: &UnitVector3<f64>) -> bool {
    angle_between(a, b) >= OPPOSITE
}

/// The axis at a part of the great circle from `a` to `b`, from 0 to 1.
pub fn between(a: &UnitVector3<f64>, b: &UnitVector3<f64>, part: f64) -> UnitVector3<f64> {
    let (sine, cosine) = (a.cross(b).norm(), a.dot(b));
    let angle = sine.atan2(cosine);
    let weights = if sine > LEAST_SINE {
        [((1.0 - part) * angle).sin(), (part * angle).sin()]
    } else {
        [1.0 - part, part]
    };
    UnitVector3::new_normalize(a.into_inner() * weights[0] + b.into_inner() * weights[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pass_remembers_the_axis_after_every_move() {
        let mut axes = ToolAxes::up();
        axes.push(0, Vector3::z_axis());
        assert!(axes.is_up());
        axes.push(1, Vector3::x_axis());
        axes.push(2, Vector3::y_axis());
        assert_eq!(axes.start(), Vector3::z_axis());
        assert_eq!(
            [0, 1, 2].map(|k| axes.after(k)),
            [Vector3::z_axis(), Vector3::x_axis(), Vector3::y_axis()]
        );
    }

    #[test]
    fn the_axis_between_two_axes_turns_evenly() {
        let (a, b) = (Vector3::z_axis(), Vector3::x_axis());
        for k in 0..=10 {
            let part = f64::from(k) / 10.0;
            let angle = a.dot(&between(&a, &b, part)).acos();
            assert!((angle - part * std::f64::consts::FRAC_PI_2).abs() < 1e-7);
        }
        assert_eq!(between(&a, &a, 0.3), a);
        assert!(are_opposite(&a, &-a) && !are_opposite(&a, &b));
    }
}
