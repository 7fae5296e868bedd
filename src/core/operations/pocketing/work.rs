//! The work of a pattern: how often the cutter is compared with earlier cuts beside it, to know its angle in
//! the material. Nearly all of the time of a fine stepover is spent on this.
//!
//! # Cost
//! A path is about as long as the area of the pocket divided by the stepover. The comparisons were measured
//! to grow with the area divided by the square of the stepover, and for `engagement` by its cube.

use super::PocketError;
use super::conditions::Conditions;
use super::job::Pattern;

const WHAT: &str = "comparisons of the cutter with earlier cuts";

/// An estimate of the comparisons of a pattern for each stepover of the length of its path. It is no bound:
/// each figure is below the least that was measured on a rectangle, a comb, a noisy outline and a pocket with
/// a hundred islands. `in_radius` is the number of stepovers in a radius.
fn least_per_stepover(pattern: Pattern, in_radius: f64) -> f64 {
    match pattern {
        Pattern::ZigzagOffset | Pattern::ContinuousOffset | Pattern::ContinuousStockOffset => 3.0,
        Pattern::ZigzagStockOffset => 1.5,
        Pattern::IslandStockOffset => 8.0,
        Pattern::IslandOffset => 100.0,
        Pattern::Engagement => 70.0 * in_radius.max(1.0),
    }
}

/// Refuses a pattern for a shape if an estimate of its comparisons is above the limit, before they are made.
/// A path that clears the shape is about `path_length_mm` long.
pub fn check(pattern: Pattern, path_length_mm: f64, conditions: &Conditions) -> Result<(), PocketError> {
    let stepover = conditions.stepover_mm;
    let needed = least_per_stepover(pattern, conditions.radius_mm / stepover) * path_length_mm / stepover;
    if needed > conditions.most_comparisons as f64 { Err(too_much(conditions)) } else { Ok(()) }
}

pub fn too_much(conditions: &Conditions) -> PocketError {
    PocketError::TooMuchWork { what: WHAT, limit: conditions.most_comparisons as usize }
}
