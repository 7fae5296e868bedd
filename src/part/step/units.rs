//! The units of a representation: how long its unit of length is, and how large its unit of plane angle.

use super::instance::{Attributes, Instance, Source};
use crate::fault::Unreadable;
use crate::unit::Unit;

/// The units of a representation, as factors.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Units {
    /// mm in a unit of length; 1 if the file states no unit.
    pub mm: f64,
    /// Radians in a unit of plane angle; 1 if the file states no unit.
    pub radians: f64,
    /// Whether the file states a unit of length.
    pub has_length: bool,
}

/// How deep units are defined by other units.
const DEEPEST: usize = 4;

impl Units {
    /// The units of a file that states none.
    pub fn unstated() -> Self {
        Self { mm: 1.0, radians: 1.0, has_length: false }
    }

    /// The unit of length by name, if it has one.
    pub fn length(&self) -> Option<Unit> {
        self.named(1e-6).filter(|_| self.has_length)
    }

    /// The unit whose length differs by less than a part of it.
    fn named(&self, share: f64) -> Option<Unit> {
        use Unit::{Centimetre, Foot, Inch, Metre, Micrometre, Millimetre};
        let units = [Micrometre, Millimetre, Centimetre, Metre, Inch, Foot];
        let is_same = |unit: &Unit| (unit.mm() / self.mm - 1.0).abs() < share;
        units.into_iter().find(is_same)
    }

    /// The units of a representation by the number of its second half, where units are assigned.
    ///
    /// # Errors
    /// An instance is missing or broken, or a unit is not above zero.
    pub fn of(source: &Source, assigned: u32) -> Result<Self, Unreadable> {
        let instance = source.get(assigned)?;
        let mut units = Self::unstated();
        if !instance.has("GLOBAL_UNIT_ASSIGNED_CONTEXT") {
            return Ok(units);
        }
        let part = instance.part("GLOBAL_UNIT_ASSIGNED_CONTEXT")?;
        let first = if instance.is_complex() { 0 } else { 2 };
        for number in part.references(first)? {
            let unit = source.get(number)?;
            let factor = |base| size(source, &unit, base, 0);
            if unit.has("LENGTH_UNIT") {
                // The base unit is the metre.
                units.mm = 1000.0 * factor("METRE")?;
                units.has_length = true;
            } else if unit.has("PLANE_ANGLE_UNIT") {
                units.radians = factor("RADIAN")?;
            }
        }
        // 0.0254 m is 25.4 mm, without the rounding of the product.
        if let Some(unit) = units.named(1e-12) {
            units.mm = unit.mm();
        }
        Ok(units)
    }
}

/// How many of the base unit a unit is.
fn size(source: &Source, unit: &Instance, base: &str, depth: usize) -> Result<f64, Unreadable> {
    if depth > DEEPEST {
        return Err(unit.fault("the unit is defined by itself"));
    }
    if unit.has("SI_UNIT") {
        let part = unit.part("SI_UNIT")?;
        // Without other parts the dimensions come first.
        let first = part.len().saturating_sub(2);
        return match part.enumeration(first + 1) {
            Some(name) if name == base => prefix(unit, part, first),
            _ => Err(unit.fault(format!("the unit is not a {base}"))),
        };
    }
    if !unit.has("CONVERSION_BASED_UNIT") {
        return Err(unit.fault("the unit is neither an SI unit nor defined by one"));
    }
    let part = unit.part("CONVERSION_BASED_UNIT")?;
    let factor = source.get(part.reference(part.len().saturating_sub(1))?)?;
    let of = factor.attributes();
    let (value, inner) = (of.real(0)?, source.get(of.reference(1)?)?);
    let size = value * size(source, &inner, base, depth + 1)?;
    if size > 0.0 && size.is_finite() { Ok(size) } else { Err(factor.fault("a unit must be above zero")) }
}

/// The factor of the prefix of an SI unit.
fn prefix(unit: &Instance, part: Attributes, k: usize) -> Result<f64, Unreadable> {
    if part.is_unset(k) {
        return Ok(1.0);
    }
    Ok(match part.enumeration(k) {
        Some("KILO") => 1e3,
        Some("HECTO") => 1e2,
        Some("DECA") => 1e1,
        Some("DECI") => 1e-1,
        Some("CENTI") => 1e-2,
        Some("MILLI") => 1e-3,
        Some("MICRO") => 1e-6,
        Some("NANO") => 1e-9,
        _ => return Err(unit.fault("the prefix of the unit is unknown")),
    })
}
