//! Arcs that replace blocks keep the rules of the control.

use std::f64::consts::TAU;

use super::*;
use crate::dialects::DIALECTS;
use crate::tests::accepted_arcs::Dice;
use crate::tests::accepted_arcs::control::{Cut, cuts_of_words};

#[test]
fn every_arc_that_replaces_blocks_keeps_the_rules_of_its_control() {
    for (seed, dialect) in DIALECTS.iter().enumerate().filter(|(_, dialect)| dialect.has_plain_words()) {
        let mut dice = Dice::new(seed as u64 + 1);
        let mut n_arcs = 0;
        for _ in 0..60 {
            let (radius, from) = (0.05 * 100f64.powf(dice.roll()), TAU * dice.roll());
            let (sweep, n) = (0.3 + 5.9 * dice.roll(), 24);
            let at = |t: f64| {
                let (sin, cos) = (from + sweep * t).sin_cos();
                format!("X{:.3} Y{:.3}\n", 20.0 + radius * cos, 30.0 + radius * sin)
            };
            let mut program = format!("G21 G17 G90 G94\nG0 Z1.\n{}G1 Z0. F500.\n", at(0.0));
            for k in 1..=n {
                program.push_str(&at(f64::from(k) / f64::from(n)));
            }
            program.push_str("G0 Z1.\nM30\n");
            let (out, _) = rewritten_as(dialect, program.as_bytes(), usize::MAX);
            let out = String::from_utf8(out).unwrap();
            for cut in cuts_of_words(&out) {
                let Cut::Arc(arc) = cut else { continue };
                assert!(arc.strain(dialect.name) < 1.0, "{} {arc:?}\n{out}", dialect.name);
                n_arcs += 1;
            }
        }
        assert!(n_arcs >= 40, "{} {n_arcs}", dialect.name);
    }
}
