//! The zone in front of some elements of an outline: the places outside from which a disc can come in over
//! these elements, and to which it can go out.
//!
//! # Method
//! 1. An element of the outline is open or closed. In front of an open one lies a strip at a right angle to
//!    it: a rectangle, or a part of a ring.
//! 2. Where two open elements meet at a corner that points outward, a sector about the corner joins their
//!    strips.
//! 3. At a corner of less than a right angle between an open and a closed element, the zone goes on up to the
//!    straight continuation of the closed one. So a disc that follows the closed element comes as far as the
//!    corner, and stays on the same side of it.
//! 4. What lies behind closed elements, as far as the strips are wide, is taken out.
//!
//! # Guarantees
//! The zone and the inside of the outline have no place in common. No place of the zone is nearer to a closed
//! element than to the outside of the strip behind it.

use nalgebra::{Point2, Vector2};

use super::{Outline, OutlineError, Region, RegionError};
use crate::budget::Budget;
use crate::geometry::offset::tree::Tree;
use crate::geometry::segment::{Segment, left};

/// An element is on a stretch if its middle is nearer to it, mm: more than the rounding of vertices.
const ON_MM: f64 = 5e-5;

/// Sectors that open less are left out, as a part of their radius: strips join there.
const NARROWEST: f64 = 1e-7;

/// Stretches of outlines.
#[derive(Debug)]
pub struct Stretches {
    elements: Tree,
}

impl Stretches {
    pub fn new(elements: &[Segment]) -> Self {
        Self { elements: Tree::new(elements.to_vec()) }
    }

    /// Whether an element of an outline lies on one of the stretches.
    pub fn has(&self, element: &Segment) -> bool {
        self.elements.nearest(element.at(0.5), ON_MM) < ON_MM
    }
}

impl Outline {
    /// The zone outside the outline in front of its open elements, `width_mm` wide.
    ///
    /// # Errors
    /// One of [`RegionError`].
    pub fn front(
        &self,
        is_open: impl Fn(&Segment) -> bool,
        width_mm: f64,
        budget: &Budget,
    ) -> Result<Region, RegionError> {
        let are_open: Vec<bool> = self.elements().iter().map(is_open).collect();
        if !are_open.contains(&true) {
            return Ok(Region::empty());
        }
        let inside = Region::new(std::slice::from_ref(self), &[], budget)?;
        if !are_open.contains(&false) {
            return inside.offset_outward(width_mm, budget)?.difference(&inside, budget);
        }
        let (mut front, mut behind) = (Vec::new(), Vec::new());
        let next = self.elements().iter().zip(&are_open).cycle().skip(1);
        for ((element, is_open), (after, is_next_open)) in self.elements().iter().zip(&are_open).zip(next) {
            budget.check()?;
            let own = if *is_open { &mut front } else { &mut behind };
            own.extend(outline(&strip(element, width_mm), budget)?);
            let sector = sector([element, after], [*is_open, *is_next_open], width_mm);
            let joined = if *is_open || *is_next_open { &mut front } else { &mut behind };
            joined.extend(outline(&sector, budget)?);
        }
        let front = Region::new(&front, &[], budget)?;
        let behind = Region::new(&behind, &[], budget)?;
        front.difference(&behind, budget)?.difference(&inside, budget)
    }
}

/// An outline of elements; none of no elements, or where they enclose no more than rounding.
fn outline(elements: &[Segment], budget: &Budget) -> Result<Option<Outline>, RegionError> {
    match Outline::new(elements, budget) {
        Ok(outline) => Ok(Some(outline)),
        Err(OutlineError::Stopped(stopped)) => Err(stopped.into()),
        Err(OutlineError::Empty | OutlineError::NoArea) => Ok(None),
        Err(_) => Err(RegionError::Tangled { at: elements[0].start() }),
    }
}

/// The edges of the strip on the right of an element.
fn strip(element: &Segment, width_mm: f64) -> Vec<Segment> {
    let (start, end) = (element.start(), element.end());
    let line = |start, end| Segment::Line { start, end };
    match element {
        Segment::Line { .. } => {
            let aside = -left(element.direction(0.0)) * width_mm;
            let [far_start, far_end] = [start + aside, end + aside];
            vec![*element, line(end, far_end), line(far_end, far_start), line(far_start, start)]
        }
        Segment::Arc(arc) => {
            let (center, radius) = (arc.center(), arc.radius());
            let far = if arc.turn() > 0.0 { radius + width_mm } else { radius - width_mm };
            if far <= 0.0 {
                return vec![*element, line(end, center), line(center, start)];
            }
            let [far_start, far_end] = [start, end].map(|p| center + (p - center) * (far / radius));
            let back = Segment::about(center, far, [far_end, far_start], -arc.turn());
            vec![*element, line(end, far_end), back, line(far_start, start)]
        }
    }
}

/// The edges of the sector about the corner between two elements that lies in front of both, or goes on along
/// the closed one of them; none where the strips leave no gap that counts.
fn sector(
    [before, after]: [&Segment; 2],
    [is_open, is_next_open]: [bool; 2],
    radius_mm: f64,
) -> Vec<Segment> {
    let corner = before.end();
    let (along, onward) = (before.direction(1.0), after.direction(0.0));
    let (from, to) = match (is_open, is_next_open) {
        (true, false) => (-left(along), -onward),
        (false, true) => (along, -left(onward)),
        _ => (-left(along), -left(onward)),
    };
    // The corner points outward where the outline turns to the left.
    let turn = from.perp(&to).atan2(from.dot(&to));
    let is_outward = along.perp(&onward) > 0.0;
    if !is_outward || turn <= NARROWEST {
        return Vec::new();
    }
    let ends = [from, to].map(|side: Vector2<f64>| corner + side * radius_mm);
    let line = |start: Point2<f64>, end: Point2<f64>| Segment::Line { start, end };
    vec![line(corner, ends[0]), Segment::about(corner, radius_mm, ends, turn), line(ends[1], corner)]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::geometry::region::Containment;

    fn polygon(corners: &[[f64; 2]]) -> Outline {
        let at = |k: usize| Point2::from(corners[k % corners.len()]);
        let sides: Vec<Segment> =
            (0..corners.len()).map(|k| Segment::Line { start: at(k), end: at(k + 1) }).collect();
        Outline::new(&sides, &Budget::unlimited()).unwrap()
    }

    fn front(outline: &Outline, open: &[usize], width_mm: f64) -> Region {
        let open: Vec<Segment> = open.iter().map(|k| outline.elements()[*k]).collect();
        let stretches = Stretches::new(&open);
        outline.front(|element| stretches.has(element), width_mm, &Budget::unlimited()).unwrap()
    }

    const RECTANGLE: [[f64; 2]; 4] = [[0.0, 0.0], [60.0, 0.0], [60.0, 40.0], [0.0, 40.0]];

    #[test]
    fn one_open_side_has_a_strip_in_front_and_two_have_a_sector_between() {
        let outline = polygon(&RECTANGLE);
        assert!((front(&outline, &[1], 10.0).area() - 400.0).abs() < 1e-6);
        let two = front(&outline, &[0, 1], 10.0);
        assert!((two.area() - (600.0 + 400.0 + 25.0 * PI)).abs() < 1e-3, "{}", two.area());
        assert_eq!(two.faces().len(), 1);
        let all = front(&outline, &[0, 1, 2, 3], 10.0);
        assert!((all.area() - (2000.0 + 100.0 * PI)).abs() < 1e-3);
        assert!(front(&outline, &[], 10.0).is_empty());
    }

    #[test]
    fn an_acute_corner_goes_on_along_the_closed_side() {
        // A right-angled triangle with 45 degrees at (0, 0) and at (40, 40).
        let outline = polygon(&[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0]]);
        for (open, place) in [(1, [45.0, 44.0]), (0, [-4.0, -5.0])] {
            let zone = front(&outline, &[open], 10.0);
            // A strip of 40 by 10, and an eighth of a circle at the acute corner.
            assert!((zone.area() - (400.0 + 100.0 * PI / 8.0)).abs() < 1e-3, "{}", zone.area());
            assert_eq!(zone.place(place.into(), 0.0), Containment::Inside);
        }
    }

    #[test]
    fn what_lies_behind_a_closed_side_is_not_in_the_zone() {
        // A wall of 4 mm between two arms: the inner sides of the notch are open and closed.
        let outline = polygon(&[
            [0.0, 0.0],
            [50.0, 0.0],
            [50.0, 30.0],
            [30.0, 30.0],
            [30.0, 20.0],
            [26.0, 20.0],
            [26.0, 30.0],
            [0.0, 30.0],
        ]);
        let zone = front(&outline, &[5], 10.0);
        for [x, y] in [[27.0, 25.0], [29.0, 29.0], [33.0, 25.0]] {
            assert_eq!(zone.place(Point2::new(x, y), 0.0), Containment::Outside, "{x} {y}");
        }
    }

    #[test]
    fn an_open_arc_has_a_part_of_a_ring_in_front_and_no_more_than_its_middle() {
        let corners = [[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0]].map(Point2::from);
        let side = |k: usize| Segment::Line { start: corners[k], end: corners[(k + 1) % 4] };
        for bulge in [-0.5, 0.5] {
            let arc = Segment::bulging(corners[1], corners[2], bulge);
            let outline = Outline::new(&[side(0), arc, side(2), side(3)], &Budget::unlimited()).unwrap();
            let turn = outline.elements()[1].turn();
            // The radius of an arc with this bulge over 40 mm is 25 mm.
            for width in [10.0, 30.0] {
                let zone = front(&outline, &[1], width);
                let far = if turn > 0.0 { 25.0 + width } else { (25.0_f64 - width).max(0.0) };
                let ring = 0.5 * turn.abs() * (far * far - 625.0).abs();
                // At most a quarter of a circle is added at each end.
                let most = ring + 0.5 * PI * width * width;
                assert!(zone.area() >= ring - 1e-3 && zone.area() <= most, "{bulge} {width}");
            }
        }
    }
}
