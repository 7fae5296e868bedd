//! Cutters and surfaces: where a cutter touches a surface, how deep it cuts into it, and which curves its tip
//! or its centre follows. No module here names feeds, programs or wire formats.

pub mod cutter;
pub mod drop_cutter;
pub mod gouge;
pub mod offset_section;
pub mod regularity;
pub mod upper_envelope;
pub mod wire_model;
