//! The dialects, one a file.

pub mod linuxcnc;
