//! toolpathd turns part data into CNC toolpaths. The library is the whole of it; the binary serves it over
//! HTTP.

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
