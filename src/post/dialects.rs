//! The dialects, one a file.

pub mod fanuc;
pub mod linuxcnc;
