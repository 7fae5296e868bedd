//! The JSON of requests, and of those parts of answers that are no report of the core.
//!
//! A request has types here where it is checked or where its units are converted. Its plain enums, and the
//! reports of answers, are the core's own types.

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
pub mod file;
pub mod five_axis;
pub mod holder;
pub mod inspection;
pub mod interpolation;
pub mod machine_abilities;
pub mod meta;
pub mod milling;
pub mod modelling;
pub mod moves;
pub mod outline;
pub mod pocketing;
pub mod point;
pub mod point_faults;
pub mod program;
pub mod program_reading;
pub mod program_writing;
pub mod schema;
pub mod sent_toolpath;
pub mod setup;
pub mod strategy;
pub mod surface;
pub mod tool;
pub mod toolpath;
pub mod verification;

pub use super::decode::check;
