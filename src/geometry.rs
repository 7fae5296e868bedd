//! Geometry: planes, curves, surfaces, sections and certified bounds. It knows nothing of machines or wire formats.

pub mod curve;
pub mod plane;
pub mod surface;
