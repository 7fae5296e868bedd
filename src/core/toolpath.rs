//! The toolpath: the moves of a tool. Operations make it; programs, pictures and JSON are made from it.
//!
//! # Guarantees
//! * Every coordinate is finite.
//! * A toolpath is continuous: a move stores where it ends, and starts where the previous move ends.
//! * The radii at both ends of an arc agree, up to rounding.
//! * The tool axis is known at both ends of every move. Between them it turns on a great circle.
//! * A rapid has no feed. A feed move has a feed, or states that no feed was chosen. A feed move without a
//!   feed has no duration, and a toolpath with such a move cannot become a program.
//! * A toolpath holds no modal state and no NC text. Both belong to `post` alone.

pub mod arc_rule;
pub mod contour;
pub mod cutting;
pub mod cycle;
pub mod flattened;
pub mod linking;
pub mod measure;
pub mod motion_time;
pub mod near_arc;
pub mod path;
pub mod pose;
pub mod program;
pub mod quantize;
pub mod rail;
pub mod tool;
pub mod tool_axes;
pub mod tool_body;
pub mod units;

pub use path::{Builder, Move, Pass, PathError, Role, RotaryPositions, Toolpath};
