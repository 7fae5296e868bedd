//! Wire types: the JSON of requests and answers. They are separate from the types of the core. Conversions
//! destructure exhaustively, so a field that is added on one side does not compile until the other side
//! handles it.

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
