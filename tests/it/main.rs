//! The integration tests, one binary.

mod api;
mod laws;
mod openapi;
mod surface_milling;
