//! Divides lengths into equal spaces.

/// The part of a space by which a quotient may be above a whole number and still count as that number. The
/// rounding of quotients up to a million is smaller. Without this part, 80 mm at 2 mm could become 41 spaces.
/// Spaces exceed `longest` by at most this part of it.
const ROUNDING: f64 = 1e-9;

/// The least number of equal spaces over `length` that are no longer than `longest`; at least one.
pub fn spaces(length: f64, longest: f64) -> f64 {
    (length / longest - ROUNDING).ceil().max(1.0)
}
