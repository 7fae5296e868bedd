//! A toolpath whose moves have known deviations.

use super::{Cut, Product};
use crate::http::dto::answer::PathMembers;
use crate::http::request::negotiation::Form;

pub struct ProvedCut {
    pub cut: Cut,
    /// For each cutting move, in their order, its deviation, mm; empty where that is not known.
    pub deviations_mm: Vec<f64>,
}

impl Product for ProvedCut {
    type Members = PathMembers;

    const TITLE: &'static str = Cut::TITLE;

    fn cut(&self) -> Option<&Cut> {
        Some(&self.cut)
    }

    fn deviations_mm(&self) -> &[f64] {
        &self.deviations_mm
    }

    fn members(self, written: Option<String>, form: &Form) -> PathMembers {
        self.cut.members(written, form)
    }
}
