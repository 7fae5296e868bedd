//! The operations. Each one takes a job and a budget and returns a plan or its own error.

pub mod arc_fitting;
pub mod cutter_location;
pub mod interpolation;
pub mod surface_milling;
pub mod surface_model;
