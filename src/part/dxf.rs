//! Drawings in DXF.
use crate::{
    drawing::Drawing,
    fault::{Place, Unreadable},
    unit::Unit,
};
pub struct DxfOptions {
    pub layers: Option<Vec<String>>,
    pub gap_mm: f64,
    pub tolerance_mm: f64,
    pub unit: Option<Unit>,
    pub curve_limit: usize,
    pub vertex_limit: usize,
}
pub fn read(_: &[u8], _: &DxfOptions, _: &toolpathd_core::budget::Budget) -> Result<Drawing, Unreadable> {
    Err(Unreadable::at(Place::File, "todo"))
}
