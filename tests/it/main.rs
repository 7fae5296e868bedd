//! The integration tests, one binary.

mod api;
mod laws;
mod openapi;
