//! Directions of the tool axis in requests and answers.

use nalgebra::{Unit, UnitVector3, Vector3};

use super::check::{Range, Violations};
use super::point::Coordinates;
use super::schema::{array_of, number, schema_of};
use crate::http::error::FieldCode;
use crate::http::pointer::Pointer;

/// The components of a direction.
const COMPONENT: Range = Range { min: -1e6, max: 1e6 };
/// A direction that is shorter is none: nothing is left of it but rounding.
const SHORTEST_DIRECTION: f64 = 1e-6;
/// The fault of such a direction.
const NO_DIRECTION: &str = "a direction of no length; send for example [0, 0, 1]";

schema_of!(AxisDirection, "A direction `[i, j, k]`: three plain numbers without a unit.", {
    array_of(number(COMPONENT), 3, 3)
});

/// The unit vector along a sent direction. Adds violations to `violations`.
pub fn unit(
    Coordinates(sent): Coordinates<3>,
    at: &Pointer,
    violations: &mut Violations,
) -> Option<UnitVector3<f64>> {
    let before = violations.total();
    for (k, component) in sent.into_iter().enumerate() {
        violations.number(&at.index(k), component, COMPONENT, "");
    }
    let unit = Unit::try_new(Vector3::from(sent), SHORTEST_DIRECTION);
    if unit.is_none() {
        violations.add(at, FieldCode::OutOfRange, NO_DIRECTION);
    }
    unit.filter(|_| violations.total() == before)
}

/// The components of a direction.
pub fn components(axis: &UnitVector3<f64>) -> Coordinates<3> {
    Coordinates(axis.into_inner().into())
}
