//! Points, directions and placements of a file, in mm.

use nalgebra::{Point3, Vector3};
use toolpathd_core::budget::Budget;

use super::frame::{Frame, Similarity};
use super::instance::{Instance, Source};
use super::units::Units;
use crate::fault::Unreadable;

/// Reads geometry in the units of one representation.
#[derive(Clone, Copy)]
pub struct Geometry<'a> {
    pub source: &'a Source<'a>,
    pub units: Units,
    pub budget: &'a Budget,
}

impl Geometry<'_> {
    /// A point, mm. A point of two coordinates lies at z = 0.
    ///
    /// # Errors
    /// As for every function here: an instance is missing, broken or of another kind.
    pub fn point(&self, number: u32) -> Result<Point3<f64>, Unreadable> {
        let instance = self.source.get(number)?;
        let part = instance.part("CARTESIAN_POINT")?;
        let list = part.reals(part.len().saturating_sub(1))?;
        match list.as_slice() {
            [x, y] => Ok(Point3::new(*x, *y, 0.0) * self.units.mm),
            [x, y, z] => Ok(Point3::new(*x, *y, *z) * self.units.mm),
            _ => Err(instance.fault("a point has 2 or 3 coordinates")),
        }
    }

    pub fn points(&self, numbers: &[u32]) -> Result<Vec<Point3<f64>>, Unreadable> {
        numbers.iter().map(|number| self.point(*number)).collect()
    }

    /// A direction, as the file has it.
    pub fn direction(&self, number: u32) -> Result<Vector3<f64>, Unreadable> {
        let instance = self.source.get(number)?;
        let part = instance.part("DIRECTION")?;
        let list = part.reals(part.len().saturating_sub(1))?;
        let direction = match list.as_slice() {
            [x, y] => Vector3::new(*x, *y, 0.0),
            [x, y, z] => Vector3::new(*x, *y, *z),
            _ => return Err(instance.fault("a direction has 2 or 3 numbers")),
        };
        let unit = direction.try_normalize(f64::MIN_POSITIVE);
        unit.filter(|v| v.iter().all(|x| x.is_finite()))
            .ok_or_else(|| instance.fault("a direction has no length"))
    }

    /// The unit direction of a vector.
    pub fn vector(&self, number: u32) -> Result<Vector3<f64>, Unreadable> {
        let instance = self.source.get(number)?;
        let part = instance.part("VECTOR")?;
        self.direction(part.reference(1)?)
    }

    fn optional_direction(&self, number: Option<u32>) -> Result<Option<Vector3<f64>>, Unreadable> {
        number.map(|number| self.direction(number)).transpose()
    }

    /// The frame of a placement or of an axis.
    pub fn frame(&self, number: u32) -> Result<Frame, Unreadable> {
        let instance = self.source.get(number)?;
        let part = instance.attributes();
        let (z, x) = match instance.kind() {
            "AXIS2_PLACEMENT_3D" => (part.optional_reference(2)?, part.optional_reference(3)?),
            "AXIS1_PLACEMENT" => (part.optional_reference(2)?, None),
            "AXIS2_PLACEMENT_2D" => (None, part.optional_reference(2)?),
            _ => return Err(instance.fault(format!("a placement is expected, not {}", instance.name()))),
        };
        let origin = self.point(part.reference(1)?)?;
        let z = self.optional_direction(z)?.unwrap_or_else(Vector3::z);
        let frame = Frame::from_axis(origin, z, self.optional_direction(x)?);
        frame.ok_or_else(|| instance.fault("the axis of the placement has no direction"))
    }

    /// The frame of a placement or of a transformation operator, whether it mirrors by its own third axis,
    /// and its scale.
    pub fn target(&self, number: u32) -> Result<(Frame, f64), Unreadable> {
        let instance = self.source.get(number)?;
        if !instance.has("CARTESIAN_TRANSFORMATION_OPERATOR_3D") {
            return Ok((self.frame(number)?, 1.0));
        }
        self.operator(&instance)
    }

    fn operator(&self, instance: &Instance) -> Result<(Frame, f64), Unreadable> {
        // The attributes axis1, axis2, local_origin and scale, and axis3 of the subtype.
        let [axes, third] = if instance.is_complex() {
            let base = instance.part("CARTESIAN_TRANSFORMATION_OPERATOR")?;
            [(base, 0), (instance.part("CARTESIAN_TRANSFORMATION_OPERATOR_3D")?, 0)]
        } else {
            // A name comes first; some writers add a name and a description of the second supertype.
            let part = instance.attributes();
            let first = if part.len() > 6 { 3 } else { 1 };
            [(part, first), (part, first + 4)]
        };
        let (part, first) = axes;
        let direction = |k: usize| self.optional_direction(part.optional_reference(first + k)?);
        let z = self.optional_direction(third.0.optional_reference(third.1)?)?.unwrap_or_else(Vector3::z);
        let (x, y) = (direction(0)?, direction(1)?);
        let origin = self.point(part.reference(first + 2)?)?;
        let scale = if part.is_unset(first + 3) { 1.0 } else { part.real(first + 3)? };
        if !(scale > 0.0 && scale.is_finite()) {
            return Err(instance.fault("the scale is not above zero"));
        }
        let mut frame = Frame::from_axis(origin, z, x)
            .ok_or_else(|| instance.fault("the axis of the operator has no direction"))?;
        if y.is_some_and(|y| y.dot(&frame.y) < 0.0) {
            frame.y = -frame.y;
        }
        Ok((frame, scale))
    }

    /// The similarity from a mapping's origin to its target.
    pub fn mapping(&self, origin: &Frame, target: u32) -> Result<Similarity, Unreadable> {
        let (target, scale) = self.target(target)?;
        Ok(Similarity::between(origin, &target, scale))
    }
}
