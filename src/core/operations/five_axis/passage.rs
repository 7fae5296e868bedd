//! Spans that begin or end on a pole of the machine and go straight through it.
//!
//! There the part of the tool axis across the pole is the parameter from the pole on, times a polynomial that
//! does not vanish. With this polynomial the axes of the machine have values and derivatives on the pole.

use nalgebra::{UnitVector3, Vector3};

use super::rail::{Point6, Span, join, top};
use crate::machine::{Machine, Through};

/// An axis at most this far from the pole is on it, radians: rounding. Other axes are not brought so near.
const ON_POLE: f64 = 1e-11;

/// A span that leaves the pole by less does not go through it, radians.
const LEAVES: f64 = 1e-8;

/// How a span passes a pole at one of its ends.
#[derive(Debug, Clone)]
pub struct Passage {
    /// The parameter of the pole.
    at: f64,
    /// The part of the top across the pole, divided by the parameter from the pole on; in place of the top.
    across: Span,
}

impl Passage {
    pub fn of(span: &Span, machine: &Machine) -> Option<Self> {
        machine.poles().find_map(|pole| Self::at_pole(span, &pole))
    }

    fn at_pole(span: &Span, pole: &UnitVector3<f64>) -> Option<Self> {
        let height = top(&span.start()).norm();
        let across = span.control.map(|p| top(&p) - pole.into_inner() * top(&p).dot(pole));
        let faces = |p: &Point6| top(p).dot(pole) > 0.0;
        let is_on = |k: usize| faces(&span.control[k]) && across[k].norm() <= ON_POLE * height;
        let h = span.length();
        // A polynomial of degree 5 that vanishes at an end is the parameter from there on times one of degree
        // 4, whose Bernstein coefficients these are.
        let (at, quotient): (f64, [Vector3<f64>; 5]) = if is_on(0) {
            (span.from, std::array::from_fn(|k| across[k + 1] * (5.0 / ((k + 1) as f64 * h))))
        } else if is_on(5) {
            (span.to, std::array::from_fn(|k| across[k] * (-5.0 / ((5 - k) as f64 * h))))
        } else {
            return None;
        };
        if across.iter().all(|v| v.norm() <= LEAVES * height) {
            return None;
        }
        let raised = |k: usize| {
            let before = if k > 0 { quotient[k - 1] * (k as f64 / 5.0) } else { Vector3::zeros() };
            let own = if k < 5 { quotient[k] * (1.0 - k as f64 / 5.0) } else { Vector3::zeros() };
            join(Vector3::zeros(), before + own)
        };
        let across = Span { from: span.from, to: span.to, control: std::array::from_fn(raised) };
        Some(Self { at, across })
    }

    /// The value and the derivatives at a parameter.
    pub fn jet(&self, u: f64) -> Through<[Vector3<f64>; 4]> {
        Through { across: self.across.jet(u).map(|p| top(&p)), way: u - self.at }
    }

    /// The Taylor coefficients at a parameter, by the coordinates, and the way to it from the pole.
    pub fn taylor(&self, u: f64) -> ([[f64; 6]; 3], f64) {
        let about = self.across.taylor(u);
        ([3, 4, 5].map(|k| about.map(|c| c[k])), u - self.at)
    }
}

/// How each span of a piece passes a pole.
pub fn passages(spans: &[Span], machine: Option<&Machine>) -> Vec<Option<Passage>> {
    spans.iter().map(|span| machine.and_then(|machine| Passage::of(span, machine))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::named;

    #[test]
    fn the_part_across_is_the_way_times_the_quotient() {
        let table = named::by_name("table_table_ac").unwrap();
        let upright = join(Vector3::x(), Vector3::z() * 50.0);
        let leaning = |x: f64, y: f64| join(Vector3::zeros(), Vector3::new(x, y, 49.0));
        let mut control = [
            upright,
            leaning(1.0, 0.5),
            leaning(2.0, 0.0),
            leaning(3.0, 1.0),
            leaning(4.0, 1.0),
            leaning(5.0, 2.0),
        ];
        for is_reversed in [false, true] {
            if is_reversed {
                control.reverse();
            }
            let span = Span { from: 1.0, to: 4.0, control };
            let passage = Passage::of(&span, &table).unwrap();
            for u in [1.0, 1.3, 2.5, 4.0] {
                let Through { across, way } = passage.jet(u);
                let axis = top(&span.jet(u)[0]);
                assert!((across[0] * way - Vector3::new(axis.x, axis.y, 0.0)).norm() < 1e-12);
            }
        }
        control[5] = leaning(0.1, 0.0);
        assert!(Passage::of(&Span { from: 0.0, to: 1.0, control }, &table).is_none());
    }
}
