//! Why a file is not read.

use toolpathd_core::budget::Stopped;

/// Why a file is not read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Unreadable {
    /// The file breaks its format, or has more than the reader takes.
    #[error("{place}: {detail}")]
    Broken { place: Place, detail: String },
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

impl Unreadable {
    pub fn at(place: Place, detail: impl Into<String>) -> Self {
        Self::Broken { place, detail: detail.into() }
    }
}

/// A place in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// The file as a whole.
    File,
    /// A line, counted from 1.
    Line(u64),
    /// A byte, counted from 0.
    Byte(u64),
    /// An entity by the number that the file gives it.
    Entity(u64),
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File => f.write_str("the file"),
            Self::Line(line) => write!(f, "line {line}"),
            Self::Byte(byte) => write!(f, "byte {byte}"),
            Self::Entity(number) => write!(f, "#{number}"),
        }
    }
}
