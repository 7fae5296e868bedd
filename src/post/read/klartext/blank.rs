//! The raw part: `BLK FORM 0.1 Z` with its lowest corner, and right behind it `BLK FORM 0.2` with its
//! highest. The control draws it and moves nothing.

use nalgebra::Point3;

use super::words::{self, Words};
use super::{Expected, Reader};
use crate::nc::{Fault, WordFault};

/// The form of both blocks.
pub const LOW: &str = "n BLK FORM 0.1 Z X+0 Y+0 Z-10";
pub const HIGH: &str = "n BLK FORM 0.2 X+50 Y+40 Z+0";

impl Reader<'_> {
    /// # Errors
    /// Behind a tool call, or twice: a program has one raw part, and states it first.
    pub(super) fn low_corner(&mut self, block: &str) -> Result<(), Fault> {
        let tail = block.strip_prefix("BLK FORM 0.1 Z ").ok_or(Fault::Frame(LOW))?;
        if self.has_tool || self.low_corner.is_some() {
            return Err(Fault::Frame(LOW));
        }
        self.low_corner = Some(self.corner(tail)?);
        self.expects = Expected::HighCorner;
        Ok(())
    }

    /// # Errors
    /// When the box has no volume.
    pub(super) fn high_corner(&mut self, block: &str) -> Result<(), Fault> {
        let tail = block.strip_prefix("BLK FORM 0.2 ").ok_or(Fault::Frame(HIGH))?;
        let high = self.corner(tail)?;
        if self.low_corner.is_none_or(|low| (0..3).any(|axis| low[axis] >= high[axis])) {
            return Err(Fault::Word("BLK FORM", WordFault::Range));
        }
        self.high_corner = Some(high);
        self.expects = Expected::Block;
        Ok(())
    }

    fn corner(&self, tail: &str) -> Result<Point3<f64>, Fault> {
        let words = Words::of(tail, words::CORNER, &self.limits())?;
        match words.three(["X", "Y", "Z"]) {
            [Some(x), Some(y), Some(z)] => Ok(Point3::new(x, y, z) * self.units.mm()),
            _ => Err(Fault::Word("BLK FORM", WordFault::Missing)),
        }
    }
}
