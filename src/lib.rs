//! toolpathd turns part data into CNC toolpaths. This library holds all of the code; the binary reads the
//! settings and starts the HTTP service.

pub mod budget;
pub mod config;
pub mod geometry;
pub mod http;
pub mod language;
pub mod machining;
pub mod operations;
pub mod parallel;
pub mod plot;
pub mod post;
pub mod toolpath;
