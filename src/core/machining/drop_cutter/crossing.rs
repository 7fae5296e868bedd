//! Finds where the cutter changes from one contact to another: as it moves from one position to another, the
//! contact followed from the first position sinks below the contact followed from the second.
//!
//! Between such a crossing and either position, the tip follows a single contact. So chords are proved on
//! both sides of it at once, where bisection would have to come near the crossing step by step.

use nalgebra::Vector2;

use super::{ACCURACY_MM, Contact, Contacts};
use crate::geometry::surface::patch::Patch;

/// Largest number of steps of the search. A search by false position needs some five.
const STEPS: usize = 24;

/// Share of the distance of the two positions by which a crossing is clear of both of them. A crossing nearer
/// to one of them helps no more than a halving.
const CLEAR_SHARE: f64 = 1e-3;

/// Distance in parameters up to which two places are the same contact.
const SAME_PLACE: f64 = 1e-6;

impl<P: Patch> Contacts<'_, P> {
    /// The two contacts at a position between two others at which both lift the tip equally high, to within
    /// `ACCURACY_MM`: the one followed from `from`, and the one followed from `to`. `None` where no such
    /// position is found. Other places may lift the cutter more, so the gaps are infinite.
    pub(super) fn crossing(&self, from: &Contact, to: &Contact) -> Option<[Contact; 2]> {
        let ends = [from, to].map(|contact| contact.tip.xy().coords);
        let at = |t: f64| ends[0] + (ends[1] - ends[0]) * t;
        let is_same = |a: &Contact, b: &Contact| (0..2).all(|k| (a.place[k] - b.place[k]).abs() < SAME_PLACE);
        let first_at = |at: Vector2<f64>, place: [f64; 2]| self.near(at, place).filter(|c| !c.is_rolling);
        let beyond = first_at(ends[1], from.place)?;
        if is_same(&beyond, to) || beyond.tip.z >= to.tip.z - ACCURACY_MM {
            return None;
        }
        let before = first_at(ends[0], to.place)?;
        if is_same(&before, from) || before.tip.z >= from.tip.z - ACCURACY_MM {
            return None;
        }
        // How far the first contact lies over the second, at two positions; positive at the first of them.
        let mut known = [(0.0, from.tip.z - before.tip.z), (1.0, beyond.tip.z - to.tip.z)];
        let mut places = [from.place, to.place];
        for k in 0..STEPS {
            let [(low, over), (high, under)] = known;
            // Every third step halves the range: false position alone may keep one end for ever.
            let t = if k % 3 == 2 { 0.5 * (low + high) } else { low + (high - low) * over / (over - under) };
            let first = first_at(at(t), places[0])?;
            let second = first_at(at(t), places[1])?;
            if is_same(&first, &second) {
                return None;
            }
            let apart = first.tip.z - second.tip.z;
            if apart.abs() <= ACCURACY_MM {
                let is_clear = (CLEAR_SHARE..=1.0 - CLEAR_SHARE).contains(&t);
                return is_clear.then_some([first, Contact { tip: first.tip, ..second }]);
            }
            if apart > 0.0 {
                (known[0], places[0]) = ((t, apart), first.place);
            } else {
                (known[1], places[1]) = ((t, apart), second.place);
            }
        }
        None
    }
}
