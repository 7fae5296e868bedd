//! The integration tests, one binary.

mod api;
mod interpolation;
mod laws;
mod nurbs;
mod openapi;
mod surface_milling;
