//! The integration tests. They form one binary.

mod api;
mod arc_fitting;
mod dnc;
mod docs;
mod faults;
mod fixed_point;
mod interpolation;
mod laws;
mod nurbs;
mod openapi;
mod pocketing;
mod surface_milling;
mod wires;
