//! Wire types: the JSON of requests and answers.
//!
//! Computations have types of their own. If a field is added to a wire type or to its counterpart, but not to
//! both, the conversion between them does not compile.

pub mod answer;
pub mod approach;
pub mod arc_fitting;
pub mod axis;
pub mod axis_output;
pub mod capabilities;
pub mod curve;
pub mod cutting;
pub mod dialect;
pub mod dnc;
pub mod dropping;
pub mod five_axis;
pub mod interpolation;
pub mod meta;
pub mod milling;
pub mod modelling;
pub mod moves;
mod names;
pub mod outline;
pub mod pocketing;
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

pub use super::decode::check;
