//! What is to be interpolated, and how.

/// What elements a curve is interpolated by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    Linear,
    Parabolic,
    /// Lines where they stay within the band, else parabolas.
    Mixed,
    /// Arcs, and lines where they would be too flat.
    Arc,
}
