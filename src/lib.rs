//! toolpathd turns part data into CNC toolpaths. This library holds the settings, the computations and the
//! HTTP service; the binary (`main.rs`) starts them.

pub mod budget;
pub mod config;
pub mod dnc;
pub mod geometry;
pub mod http;
pub mod language;
pub mod machine;
pub mod machining;
pub mod operations;
pub mod parallel;
pub mod plot;
pub mod post;
pub mod toolpath;
