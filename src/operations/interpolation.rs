//! x
pub mod job;
pub mod fit;
mod bisection;
mod corridor;
mod least;
mod lower_bound;
use nalgebra::Point2;
use crate::budget::Stopped;
pub use bisection::bisect;
pub use least::fewest;

pub const ELEMENT_LIMIT: usize = 1_000_000;

#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum Error {
    #[error(transparent)]
    Stopped(#[from] Stopped),
    #[error("more than {limit} elements are needed")]
    TooManyElements { limit: usize },
    #[error("no element stays within the band near {at}, however short")]
    BandInfeasible { at: Point2<f64> },
}

#[cfg(test)]
mod tests;
