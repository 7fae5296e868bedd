//! The middle of a region, along which it is opened, so that all of its walls are reached at about the same
//! time: from there on passes run around and around, and none has to be begun anew.

use super::super::PocketError;
use super::super::conditions::Conditions;
use crate::budget::Budget;
use crate::geometry::region::Region;

/// Half the width of the middle, in stepovers: its passes to and fro are a stepover apart.
const HALF_WIDTH: f64 = 0.5;

/// The radius of the inner corners of the middle, as a part of half its width.
const ROUND: f64 = 0.9;

/// How many widths are tried, and the widest, in radii of the cutter: the passes on the edge of the middle
/// leave nothing inside.
const TRIALS: usize = 5;
const WIDEST: f64 = 0.9;

/// How far from the middle a place may be, in distances of the middle from the walls: a right-angled corner
/// is 1.41 of them away.
const FAR: f64 = 1.6;

/// The largest part of a region that may be farther away.
const LEFT_PART: f64 = 0.04;

/// The middle of a region whose deepest place is `deep_mm` from its edge; `None` where no middle of a
/// channel leads to nearly all places.
pub fn of(
    region: &Region,
    deep_mm: f64,
    conditions: &Conditions,
    budget: &Budget,
) -> Result<Option<Region>, PocketError> {
    let narrowest = HALF_WIDTH * conditions.stepover_mm;
    let widest = (WIDEST * conditions.radius_mm).max(narrowest);
    for trial in 0..TRIALS {
        let half = narrowest + (widest - narrowest) * trial as f64 / (TRIALS - 1) as f64;
        let distance = deep_mm - half;
        if distance < narrowest {
            return Ok(None);
        }
        // The inner corners stay as far from the walls, and are round.
        let round = ROUND * narrowest;
        let sharp = region.offset_inward(distance + round, budget)?;
        if sharp.is_empty() {
            continue;
        }
        let core = sharp.offset_outward(round, budget)?;
        let far = region.difference(&core.offset_outward(FAR * distance, budget)?, budget)?;
        if far.area() <= LEFT_PART * region.area() {
            return Ok(Some(core));
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use nalgebra::Point2;

    use super::*;
    use crate::geometry::region::Outline;
    use crate::geometry::segment::Segment;
    use crate::operations::pocketing::conditions::tests::conditions;

    fn polygon(corners: &[[f64; 2]]) -> Region {
        let at = |k: usize| Point2::from(corners[k % corners.len()]);
        let sides: Vec<Segment> =
            (0..corners.len()).map(|k| Segment::Line { start: at(k), end: at(k + 1) }).collect();
        let budget = Budget::unlimited();
        Region::new(&[Outline::new(&sides, &budget).unwrap()], &[], &budget).unwrap()
    }

    #[test]
    fn the_middle_of_a_rectangle_is_as_far_from_its_short_sides_as_from_its_long_ones() {
        let (conditions, budget) = (conditions(5.0, 3.0), Budget::unlimited());
        let region = polygon(&[[0.0, 0.0], [90.0, 0.0], [90.0, 50.0], [0.0, 50.0]]);
        let core = of(&region, 25.0, &conditions, &budget).unwrap().unwrap();
        let [low, high] = core.bounding_box().unwrap();
        let distance = 25.0 - 0.5 * 3.0;
        assert!((low - Point2::new(distance, distance)).norm() < 1e-3, "{low}");
        assert!((high - Point2::new(90.0 - distance, 50.0 - distance)).norm() < 1e-3, "{high}");
    }

    #[test]
    fn two_rooms_of_different_width_have_no_common_middle() {
        let (conditions, budget) = (conditions(5.0, 3.0), Budget::unlimited());
        let corners = [[0.0, 0.0], [60.0, 0.0], [60.0, 20.0], [160.0, 20.0], [160.0, 40.0], [60.0, 40.0]];
        let region = polygon(&[&corners[..], &[[60.0, 60.0], [0.0, 60.0]]].concat());
        assert!(of(&region, 30.0, &conditions, &budget).unwrap().is_none());
    }
}
