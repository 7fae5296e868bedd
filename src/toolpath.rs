//! The toolpath: what every operation makes and every output takes.
//!
//! # Promises
//! * Every coordinate is finite.
//! * A toolpath is continuous: a move stores where it ends, and starts where the last one ended.
//! * The radii at both ends of an arc agree.
//! * A rapid has no feed. A feed move has a feed, or states that none was chosen. Without a feed it has no
//!   time, and no program can be made of its toolpath.
//! * Nothing is modal and nothing is text. Both belong to `post` alone.

pub mod contour;
pub mod cutting;
pub mod flatten;
pub mod linking;
pub mod measure;
pub mod motion_time;
pub mod near_arc;
pub mod path;
pub mod program;
pub mod quantize;
pub mod tool;
pub mod units;

pub use path::{Builder, Move, Pass, PathError, Role, Toolpath};
