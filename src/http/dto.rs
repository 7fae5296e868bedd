//! Wire types: the JSON of requests and answers.
//!
//! The types of the other layers are separate. If a type gets a field on one side only, the conversion
//! between the two does not compile.

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
