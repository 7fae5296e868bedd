//! Wire types, apart from the core's own: each converts by exhaustive destructuring, so that a field added to
//! one side does not compile until it is handled on the other.

pub mod answer;
pub mod approach;
pub mod arc_fitting;
pub mod check;
pub mod curve;
pub mod cutting;
pub mod dialect;
pub mod dropping;
pub mod interpolation;
pub mod meta;
pub mod milling;
pub mod modelling;
pub mod moves;
mod names;
pub mod point;
pub mod program;
pub mod program_writing;
pub mod schema;
pub mod sent_toolpath;
pub mod setup;
pub mod strategy;
pub mod surface;
pub mod tool;
pub mod toolpath;
