//! Surfaces: what they are made from and how they are evaluated.

pub mod point_grid;
