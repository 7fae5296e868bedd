//! Texts of points.
