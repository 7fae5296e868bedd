//! The endpoints of version 1, each in a file of its own.

pub mod arcs_fit;
pub mod curves_interpolate;
pub mod dialects;
pub mod dnc;
pub mod five_axis_smooth;
pub mod limits;
pub mod machines;
pub mod parts_inspect;
pub mod pockets_plan;
pub mod programs_read;
pub mod programs_verify;
pub mod programs_write;
pub mod surfaces_drop;
pub mod surfaces_mill;
pub mod surfaces_model;
