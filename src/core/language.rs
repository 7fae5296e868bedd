//! The languages in which users describe parts: expressions y(x), and section curves.

pub mod expression;
pub mod graph;
pub mod section_curve;
