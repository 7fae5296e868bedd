//! The computations of toolpathd, without input or output: geometry, cutters, machines, toolpaths, and one
//! module for each operation. Each operation has a function `plan(&job, &budget)`. With the feature `wire`,
//! reports, enums and plain settings are JSON by serde, and have schemas by utoipa.

pub mod budget;
pub mod geometry;
pub mod language;
pub mod machine;
pub mod machining;
pub mod operations;
pub mod parallel;
pub mod toolpath;
#[cfg(feature = "wire")]
pub mod wire;
