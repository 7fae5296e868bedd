//! The outline of a surface seen from above, and the parts of sections over which a cutter stays inside it.

use nalgebra::{Point3, Vector2};

use crate::budget::{Budget, Stopped};
use crate::geometry::section::Chain;
use crate::geometry::surface::{BezierSurface, Patch, Surface};

/// Chords of one side of one patch at most.
const CHORD_LIMIT: f64 = 1000.0;

/// Halvings in the search for the place where a section leaves the inside: to the last bit.
const HALVINGS: usize = 60;

/// The four sides of a surface in plan, as chords.
pub(super) struct Outline {
    corners: Vec<Vector2<f64>>,
    /// The sides leave their chords by no more than this, mm.
    chord_height_mm: f64,
}

impl Outline {
    /// With chords that leave the sides by about `accuracy` mm.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub(super) fn new(
        surface: &BezierSurface<impl Patch>,
        accuracy: f64,
        budget: &Budget,
    ) -> Result<Self, Stopped> {
        let [nu, nv] = surface.spans();
        let mut outline = Self { corners: Vec::new(), chord_height_mm: 0.0 };
        // Round the domain: along v = 0, u = nu, v = nv and u = 0.
        for i in 0..nu {
            outline.add(surface.patch(i, 0), |t| [t, 0.0], accuracy);
        }
        budget.check()?;
        for j in 0..nv {
            outline.add(surface.patch(nu - 1, j), |t| [1.0, t], accuracy);
        }
        for i in (0..nu).rev() {
            outline.add(surface.patch(i, nv - 1), |t| [1.0 - t, 1.0], accuracy);
        }
        budget.check()?;
        for j in (0..nv).rev() {
            outline.add(surface.patch(0, j), |t| [0.0, 1.0 - t], accuracy);
        }
        Ok(outline)
    }

    fn add(&mut self, patch: &impl Patch, place: impl Fn(f64) -> [f64; 2], accuracy: f64) {
        let derivatives = patch.derivatives();
        let [from, to] = [place(0.0), place(1.0)];
        let bend = if from[0] != to[0] { derivatives.duu } else { derivatives.dvv };
        // A chord over a parameter step d leaves the curve by d^2 / 8 times the second derivative.
        let bend = bend.reach() / 8.0;
        let chords = (bend / accuracy).sqrt().ceil().clamp(1.0, CHORD_LIMIT);
        self.chord_height_mm = self.chord_height_mm.max(bend / (chords * chords));
        self.corners.extend((0..chords as usize).map(|k| {
            let [u, v] = place(k as f64 / chords);
            patch.jet(u, v).point.coords.xy()
        }));
    }

    /// Distance of a place from the outline, mm: positive inside. It changes no faster than the place moves.
    fn depth(&self, p: &Vector2<f64>) -> f64 {
        let mut squared = f64::INFINITY;
        let mut is_inside = false;
        let mut from = self.corners[self.corners.len() - 1];
        for to in &self.corners {
            let (along, d) = (to - from, p - from);
            let length = along.norm_squared();
            let t = if length > 0.0 { (along.dot(&d) / length).clamp(0.0, 1.0) } else { 0.0 };
            squared = squared.min((d - along * t).norm_squared());
            if (from.y > p.y) != (to.y > p.y) && (along.perp(&d) > 0.0) == (to.y > from.y) {
                is_inside = !is_inside;
            }
            from = *to;
        }
        if is_inside { squared.sqrt() } else { -squared.sqrt() }
    }

    /// The parts of `chain` at least `margin` mm inside the sides.
    pub(super) fn clipped(&self, chain: &Chain, margin: f64) -> Vec<Chain> {
        let margin = margin + self.chord_height_mm;
        let depth = |p: &Point3<f64>| self.depth(&p.coords.xy()) - margin;
        let mut parts = Vec::new();
        let mut part: Vec<Point3<f64>> = Vec::new();
        // What the last look says of the points that follow it: how far on the answer stays the same.
        let mut known = 0.0f64;
        let mut previous: Option<(Point3<f64>, bool)> = None;
        for &point in &chain.points {
            if let Some((before, _)) = previous {
                known = (known.abs() - (point - before).norm()).max(0.0).copysign(known);
            }
            if known == 0.0 {
                known = depth(&point);
            }
            let is_inside = known > 0.0 || (known == 0.0 && depth(&point) >= 0.0);
            if let Some((before, was_inside)) = previous
                && was_inside != is_inside
            {
                part.push(crossing(before, point, was_inside, &depth));
            }
            match is_inside {
                true => part.push(point),
                false if !part.is_empty() => parts.push(std::mem::take(&mut part)),
                false => {}
            }
            previous = Some((point, is_inside));
        }
        parts.push(part);
        parts.retain(|points| points.len() >= 2);
        let chord_height_mm = chain.chord_height_mm;
        parts.into_iter().map(|points| Chain { points, chord_height_mm }).collect()
    }
}

/// The place on the chord from `a` to `b` nearest to the outline that is still inside.
fn crossing(
    a: Point3<f64>,
    b: Point3<f64>,
    starts_inside: bool,
    depth: &impl Fn(&Point3<f64>) -> f64,
) -> Point3<f64> {
    let (mut inside, mut outside) = if starts_inside { (a, b) } else { (b, a) };
    for _ in 0..HALVINGS {
        let middle = nalgebra::center(&inside, &outside);
        if depth(&middle) >= 0.0 {
            inside = middle;
        } else {
            outside = middle;
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use nalgebra::Vector3;

    use super::*;
    use crate::geometry::surface::BicubicPatch;

    /// A flat patch of 30 by 12 mm.
    fn outline() -> Outline {
        let surface = BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
            net: std::array::from_fn(|a| {
                std::array::from_fn(|b| Vector3::new(10.0 * a as f64, 4.0 * b as f64, 0.0))
            }),
        });
        Outline::new(&surface, 1e-3, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn depth_is_the_distance_to_the_nearest_side() {
        let outline = outline();
        for (x, y, expected) in [(15.0, 6.0, 6.0), (1.0, 3.0, 1.0), (-2.0, 5.0, -2.0), (33.0, 16.0, -5.0)] {
            assert!((outline.depth(&Vector2::new(x, y)) - expected).abs() < 1e-9, "{x} {y}");
        }
    }

    #[test]
    fn chains_end_where_the_margin_does() {
        let chain = |points: Vec<Point3<f64>>| Chain { points, chord_height_mm: 0.5 };
        let across = chain((0..=200).map(|k| Point3::new(-5.0 + 0.2 * f64::from(k), 6.0, 1.0)).collect());
        let parts = outline().clipped(&across, 2.0);
        let [part] = parts.as_slice() else { panic!("{} parts", parts.len()) };
        let (first, last) = (part.points[0], part.points[part.points.len() - 1]);
        assert!((first.x - 2.0).abs() < 1e-6 && (last.x - 28.0).abs() < 1e-6, "{first} {last}");
        assert_eq!(part.chord_height_mm, 0.5);
        let edge = chain((0..=20).map(|k| Point3::new(f64::from(k), 1.0, 0.0)).collect());
        assert!(outline().clipped(&edge, 2.0).is_empty());
        // Out and in again: two parts.
        let bow = [(10.0, 6.0), (12.0, 6.0), (14.0, 11.5), (16.0, 6.0), (18.0, 6.0)];
        let bow = chain(bow.iter().map(|(x, y)| Point3::new(*x, *y, 0.0)).collect());
        assert_eq!(outline().clipped(&bow, 2.0).len(), 2);
    }
}
