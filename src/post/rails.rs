//! Rails as words: the ends of two polynomials, and the coefficients of their higher powers.
//!
//! # Method
//! A control that runs polynomials is told where the tip and a second point of the tool end, and the
//! coefficients of the powers 2 to 5 of a parameter from 0 to 1. Where they start it knows, and the
//! coefficient of the first power follows. The second point is written relative to the tip as it is written,
//! so that rounding the tip turns no axis.
//!
//! # Guarantees
//! The written tip is within [`Rounded::tip_mm`] of the rail at equal parameters, and the written axis
//! within [`Rounded::axis`].

use nalgebra::{Point3, Vector3};

use super::WriteError;
use super::words::FeedWord;
use toolpathd_core::toolpath::quantize::Grid;
use toolpathd_core::toolpath::rail::Rail;

/// Decimals of coefficients and of the second point.
pub const RAIL_DECIMALS: u8 = 6;

/// One rail as it is written, in units of the last decimal.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RailWords {
    pub to: [i64; 3],
    /// The second point at the end.
    pub second: [i64; 3],
    /// The coefficients of the powers 2 to 5, of the tip and of the second point.
    pub powers: [[[i64; 3]; 4]; 2],
    pub feed: FeedWord,
}

/// A rail as words, with bounds of what rounding has moved.
pub struct Rounded {
    pub words: RailWords,
    /// Of the tip, mm.
    pub tip_mm: f64,
    /// Of the axis, radians.
    pub axis: f64,
}

/// The numbers of coefficients and second points, in the units of the program.
pub struct FineGrid {
    unit_mm: f64,
}

impl FineGrid {
    pub fn new(grid: &Grid) -> Self {
        Self { unit_mm: grid.unit_mm() }
    }

    fn scale(&self) -> f64 {
        10f64.powi(i32::from(RAIL_DECIMALS)) / self.unit_mm
    }

    pub fn mm(&self, units: i64) -> f64 {
        units as f64 / self.scale()
    }

    fn round(&self, v: Vector3<f64>) -> Result<[i64; 3], WriteError> {
        let scaled = v * self.scale();
        // Beyond this, an f64 holds no units.
        if scaled.amax() > 1e15 {
            return Err(
                toolpathd_core::toolpath::quantize::QuantizeError::OutOfRange { value_mm: v.amax() }.into()
            );
        }
        Ok([0, 1, 2].map(|k| scaled[k].round() as i64))
    }

    /// The second point of a tip as it is written.
    pub fn second(&self, tip: Point3<f64>, to_second: Vector3<f64>) -> Result<[i64; 3], WriteError> {
        self.round(tip.coords + to_second)
    }

    /// Half of a unit in each coordinate, as a distance, mm.
    fn half_mm(&self) -> f64 {
        0.5 * 3f64.sqrt() / self.scale()
    }
}

/// The words of a rail that begins at `from`, as it was written.
///
/// # Errors
/// When a number has no place on the grid.
pub fn round(rail: &Rail, from: [i64; 3], feed: FeedWord, grid: &Grid) -> Result<Rounded, WriteError> {
    let fine = FineGrid::new(grid);
    let to = grid.round(&rail.tip[5])?;
    let second = fine.second(grid.point(to), rail.to_second[5])?;
    let mut powers = [[[0; 3]; 4]; 2];
    for (written, wanted) in powers.iter_mut().zip(rail.higher_powers()) {
        for (written, wanted) in written.iter_mut().zip(wanted) {
            *written = fine.round(wanted)?;
        }
    }
    // The powers 2 to 5 of the parameter, less the parameter itself, are below 1.
    let of_powers = 4.0 * fine.half_mm();
    let at_ends = (grid.point(from) - rail.tip[0]).norm().max((grid.point(to) - rail.tip[5]).norm());
    let of_vector = 2.0 * of_powers + fine.half_mm();
    let height = rail.height_mm();
    if height <= 2.0 * of_vector {
        return Err(WriteError::SecondPointTooNear);
    }
    let words = RailWords { to, second, powers, feed };
    Ok(Rounded { words, tip_mm: at_ends + of_powers, axis: (of_vector / height).asin() })
}
