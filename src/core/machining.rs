//! Cutters on surfaces: where a cutter touches a surface, how deep the cutter cuts into the surface, and
//! which curves the tip or the centre of the cutter follows. These modules know nothing of feeds, programs or
//! JSON.

pub mod cutter;
pub mod drop_cutter;
pub mod engagement;
pub mod gouge;
pub mod offset_section;
pub mod regularity;
pub mod upper_envelope;
pub mod wire_model;
