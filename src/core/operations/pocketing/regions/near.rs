//! Which part of what earlier tools have emptied is near an area.

use nalgebra::{Point2, Vector2};

use super::super::chain::from_above;
use super::super::job::Emptied;
use crate::geometry::curve::Curve;
use crate::geometry::segment::Segment;

/// Emptied places that are farther from an area are left out, mm. They have nothing in common with it, also
/// if they grow by the thin layer beside them that counts as emptied too.
const FAR_MM: f64 = 0.1;

/// The lowest and the highest coordinates, or more.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    low: Point2<f64>,
    high: Point2<f64>,
}

impl Bounds {
    /// A box around a chain. It may be larger than needed around arcs.
    pub fn of(chain: &[Segment]) -> Self {
        let (low, high) = (f64::INFINITY, f64::NEG_INFINITY);
        let none = Self { low: Point2::new(low, low), high: Point2::new(high, high) };
        chain
            .iter()
            .map(Self::of_element)
            .fold(none, |all, own| Self { low: all.low.inf(&own.low), high: all.high.sup(&own.high) })
    }

    fn of_element(element: &Segment) -> Self {
        match element {
            Segment::Line { start, end } => Self { low: start.inf(end), high: start.sup(end) },
            Segment::Arc(_) => {
                let (middle, reach) = element.disc();
                Self { low: middle, high: middle }.grown(reach)
            }
        }
    }

    /// The box with a margin.
    pub fn grown(&self, by_mm: f64) -> Self {
        let margin = Vector2::new(by_mm, by_mm);
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// Whether two boxes have a point in common.
    pub fn meets(&self, other: &Self) -> bool {
        let is_below = |a: Point2<f64>, b: Point2<f64>| a.x <= b.x && a.y <= b.y;
        is_below(self.low, other.high) && is_below(other.low, self.high)
    }
}

/// An emptied place with its boxes: that of a region, or those of what the cutter sweeps along each curve.
pub struct Surroundings<'a> {
    place: &'a Emptied,
    bounds: Vec<Bounds>,
}

impl<'a> Surroundings<'a> {
    pub fn new(place: &'a Emptied) -> Self {
        let bounds = match place {
            Emptied::Region(area) => vec![Bounds::of(&area.boundary)],
            Emptied::Path { along, radius_mm } => {
                along.iter().map(|curve| Bounds::of(&[from_above(curve)]).grown(*radius_mm)).collect()
            }
        };
        Self { place, bounds }
    }

    /// What of the place is near the area inside a wall; none if nothing is.
    pub fn near(&self, wall: &[Segment]) -> Option<Emptied> {
        let around = Bounds::of(wall).grown(FAR_MM);
        let is_near = |bounds: &Bounds| bounds.meets(&around);
        match self.place {
            Emptied::Region(_) => self.bounds.iter().any(is_near).then(|| self.place.clone()),
            Emptied::Path { along, radius_mm } => {
                let near = along.iter().zip(&self.bounds).filter(|(_, bounds)| is_near(bounds));
                let along: Vec<Curve> = near.map(|(curve, _)| *curve).collect();
                (!along.is_empty()).then_some(Emptied::Path { along, radius_mm: *radius_mm })
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::Point3;

    use super::*;
    use crate::geometry::curve::Line;

    fn square(x: f64) -> Vec<Segment> {
        let corner = [[x, 0.0], [x + 10.0, 0.0], [x + 10.0, 10.0], [x, 10.0]].map(Point2::from);
        (0..4).map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] }).collect()
    }

    #[test]
    fn only_the_curves_whose_sweep_meets_the_area_are_near() {
        let at = |x: f64| Point3::new(x, 5.0, -1.0);
        let curve = |from: f64, to: f64| Curve::Line(Line { start: at(from), end: at(to) });
        let along = vec![curve(-30.0, -20.0), curve(-20.0, -2.9), curve(-2.9, -20.0), curve(40.0, 50.0)];
        let path = Emptied::Path { along: along.clone(), radius_mm: 3.0 };
        let near = Surroundings::new(&path).near(&square(0.0));
        assert_eq!(near, Some(Emptied::Path { along: along[1..3].to_vec(), radius_mm: 3.0 }));
        assert_eq!(Surroundings::new(&path).near(&square(100.0)), None);
    }

    #[test]
    fn the_box_around_an_arc_holds_its_farthest_place() {
        let [a, b] = [Point2::new(0.0, -1.0), Point2::new(0.0, 1.0)];
        let half = Segment::about(Point2::origin(), 1.0, [a, b], std::f64::consts::PI);
        let at = |x: f64| Bounds { low: Point2::new(x, 0.0), high: Point2::new(x, 0.0) };
        assert!(Bounds::of(&[half]).meets(&at(1.0)) && !Bounds::of(&[half]).meets(&at(3.0)));
    }
}
