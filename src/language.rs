//! Languages in which parts are described: expressions in x, and section curves.

pub mod expression;
pub mod graph;
pub mod section_curve;
