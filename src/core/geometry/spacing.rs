//! Divides lengths into equal spaces.

/// A quotient this little above a whole number counts as that number. The rounding of quotients up to a
/// million is smaller. Without this, 4.2 mm at 0.3 mm would become 15 spaces. So a space may be longer than
/// `longest`, by at most this part of it.
const ROUNDING: f64 = 1e-9;

/// The least number of equal spaces over `length`, at least one. None is longer than `longest`, but for
/// rounding.
pub fn spaces(length: f64, longest: f64) -> f64 {
    (length / longest - ROUNDING).ceil().max(1.0)
}
