//! Languages in which parts are described: expressions in x, and section curves.

pub mod section_curve;
