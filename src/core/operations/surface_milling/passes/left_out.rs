//! The pieces of sections that are too short for a pass of their own.

use nalgebra::Point3;

use crate::machining::offset_section::Chain;

/// The pieces left out: how many, the length of the longest, and a place of it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(in crate::operations::surface_milling) struct LeftOut {
    pub(in crate::operations::surface_milling) count: usize,
    pub(in crate::operations::surface_milling) longest_mm: f64,
    pub(in crate::operations::surface_milling) at: Point3<f64>,
}

impl LeftOut {
    pub(super) fn and(self, more: Self) -> Self {
        let longer = if more.longest_mm > self.longest_mm { more } else { self };
        Self { count: self.count + more.count, ..longer }
    }

    pub(super) fn of(length: f64, at: Point3<f64>) -> Self {
        Self { count: 1, longest_mm: length, at }
    }
}

/// Removes the chains shorter than `shortest` mm. If all chains are shorter, none is removed.
pub(super) fn leave_out_short(chains: &mut Vec<Chain>, shortest: f64) -> LeftOut {
    let mut left_out = LeftOut::default();
    if chains.iter().any(|chain| chain.length() >= shortest) {
        chains.retain(|chain| {
            let length = chain.length();
            if length < shortest {
                left_out = left_out.and(LeftOut::of(length, chain.points[0]));
            }
            length >= shortest
        });
    }
    left_out
}
