//! A cutter, with its numbers in the tables of the control.

use crate::machining::cutter::Cutter;

/// The form of a cutter below its cylindrical shank of the same radius. The tip is its lowest point on the
/// axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// A hemisphere.
    Ball,
    /// A flat end.
    Flat,
    /// A flat end whose edge is rounded: a quarter of a torus.
    BullNose { corner_radius_mm: f64 },
    /// A cone with this angle between opposite sides, degrees, and a flat of this diameter at its tip.
    V { tip_angle_deg: f64, tip_diameter_mm: f64 },
    /// A cone with this angle between a side and the axis, degrees, and a flat of this diameter at its tip.
    Cone { taper_angle_deg: f64, tip_diameter_mm: f64 },
    /// A drill with this angle between opposite edges of its point, degrees, if one was given.
    Drill { point_angle_deg: Option<f64> },
}

/// A cutter and its places in the control's tables.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tool {
    pub shape: Shape,
    /// Radius, mm.
    pub radius_mm: f64,
    /// Number in the tool table, if one was given.
    pub number: Option<u32>,
    /// Number of the length offset; the tool's own number if absent.
    pub length_offset: Option<u32>,
}

/// The number of the tool that is called if none was given.
pub const DEFAULT_NUMBER: u32 = 1;

impl Tool {
    /// Its geometry; for a pointed shape, that of the flat end around it.
    pub fn cutter(&self) -> Cutter {
        match self.shape {
            Shape::Ball => Cutter::ball(self.radius_mm),
            Shape::Flat | Shape::V { .. } | Shape::Cone { .. } | Shape::Drill { .. } => {
                Cutter::bull_nose(self.radius_mm, 0.0)
            }
            Shape::BullNose { corner_radius_mm } => Cutter::bull_nose(self.radius_mm, corner_radius_mm),
        }
    }

    /// The most that a turn of the tool about its tip moves its cut, mm per radian: the distance between the
    /// tip and the centre of the rounded corner.
    pub fn swing_mm(&self) -> f64 {
        let corner_mm = match self.shape {
            Shape::Ball => self.radius_mm,
            Shape::Flat | Shape::V { .. } | Shape::Cone { .. } | Shape::Drill { .. } => 0.0,
            Shape::BullNose { corner_radius_mm } => corner_radius_mm,
        };
        corner_mm.hypot(self.radius_mm - corner_mm)
    }

    /// A ball cutter without numbers in the control's tables.
    pub fn ball(radius_mm: f64) -> Self {
        Self { shape: Shape::Ball, radius_mm, number: None, length_offset: None }
    }

    /// The numbers of the tool and of its length offset, as they are written.
    pub fn places(&self) -> (u32, u32) {
        let number = self.number.unwrap_or(DEFAULT_NUMBER);
        (number, self.length_offset.unwrap_or(number))
    }
}
