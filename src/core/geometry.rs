//! Geometry: planes, curves, surfaces, regions and proved bounds. These modules know nothing of machines, and
//! nothing of the formats of files and messages.

pub mod arc_fit;
pub mod bernstein;
pub mod best_first;
pub mod bounding_tree;
pub mod bspline;
pub mod curve;
pub mod deviation;
pub mod facets;
pub mod flatten;
pub mod following;
pub mod height_field;
pub mod interval;
pub mod mesh;
pub mod offset;
pub mod plane;
pub mod plane_curve;
pub mod point_judge;
pub mod polyline;
pub mod profile;
pub mod region;
pub mod segment;
pub mod solve;
pub mod spacing;
pub mod spline;
pub mod surface;
