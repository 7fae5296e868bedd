//! The operations. Each operation takes a job and a budget. It returns a plan, or an error of a type of its
//! own.

pub mod arc_fitting;
pub mod cutter_location;
pub mod five_axis;
pub mod interpolation;
pub mod pocketing;
pub mod surface_milling;
pub mod surface_model;
pub mod verification;
