//! Material with upright walls and a level top: how deep a cutter enters it, and how near a tool comes to it.
//!
//! Seen from the axis of an upright tool, the material is a quadrant in the half plane through the axis and
//! the nearest place of the material in plan: all that lies beyond the distance of this place, below the top.
//! What a quadrant does to a tool of revolution depends on two numbers alone, the distance in plan and the
//! height of the tip, and never grows with either. So the least distance and the lowest tip along a piece of
//! the path bound what happens on the piece.
//!
//! # Method
//! 1. Divide the path into pieces that are lines or arcs in plan, with a height that changes evenly.
//! 2. Bound each piece by its least distance from the material in plan and its lowest place. Compare with the
//!    value at the middle of the piece.
//! 3. Halve the piece with the largest bound until the bound exceeds the largest value by at most a gap.
//!
//! # Guarantees
//! * A bound holds for every place of the path, with what the control may leave it, and with rounding.
//!
//! # Cost
//! One search of the outline for each piece. Level pieces beside a straight wall are not halved.

use nalgebra::{Point2, Point3};

use super::assembly::Assembly;
use super::cutter::Cutter;
use super::gouge::solid::Solid;
use crate::budget::{Budget, Stopped};
use crate::geometry::best_first::BestFirst;
use crate::geometry::curve::{Curve, Direction};
use crate::geometry::flatten::flatten;
use crate::geometry::plane::Plane;
use crate::geometry::region::{Containment, Region};
use crate::geometry::segment::Segment;

/// How far the boundary of a region may lie from the outline that was given, mm.
const SNAP_MM: f64 = 2e-5;

/// The most halvings of the pieces of one curve. At this limit the bound may exceed the largest value by more
/// than the gap.
const MOST_HALVINGS: usize = 20_000;

/// The most chords of one curve.
const MOST_CHORDS: usize = 100_000;

/// The height of chords, as a share of the gap.
const CHORD: f64 = 0.25;

/// Pieces between two checks of the budget.
const PIECES_BETWEEN_CHECKS: usize = 256;

/// How deep the deepest point below a level floor lies in a cutter with its tip at the height `z`, mm; below
/// zero where the cutter stays above the floor.
pub fn depth_in_floor(cutter: &Cutter, floor_mm: f64, z: f64) -> f64 {
    Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() }.depth_at(0.0, floor_mm - z)
}

/// Which side of the outlines is material.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Material {
    Inside,
    Outside,
}

/// Material on one side of the outlines of a region, from far below up to a level top.
#[derive(Debug, Clone)]
pub struct Prism {
    pub region: Region,
    pub material: Material,
    pub top_mm: f64,
}

/// The largest value along a path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Largest {
    /// Proved upper bound.
    pub bound: f64,
    /// The largest value found on the path itself.
    pub found: f64,
    /// The place of the tip with the value found.
    pub at: Option<Point3<f64>>,
}

/// How far the control may leave a path, and how precise a bound along the path has to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asked {
    /// How far the control may leave the path, mm.
    pub slack_mm: f64,
    /// By how much a bound may exceed the value that is found, mm.
    pub gap_mm: f64,
    /// A bound at or below this is good enough, mm.
    pub enough_mm: f64,
}

/// A part of the path: a line or an arc in plan, along which the height of the tip changes evenly.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlanPiece {
    pub(super) plan: Segment,
    heights: [f64; 2],
}

impl Prism {
    /// How deep the deepest point of the material lies in the cutter, mm, while its tip follows `tip`; below
    /// zero where the cutter stays away. The cutter's shank counts.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn depth(
        &self,
        cutter: &Cutter,
        tip: &Curve,
        asked: Asked,
        budget: &Budget,
    ) -> Result<Largest, Stopped> {
        let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
        self.largest(tip, asked, |away, z| solid.depth_at(away, self.top_mm - z), budget)
    }

    /// How near cutter, shank and holder come to the material, as the negative of the distance, mm; above
    /// zero where the cutter enters the material, zero where a section does.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn nearness(
        &self,
        assembly: &Assembly,
        tip: &Curve,
        asked: Asked,
        budget: &Budget,
    ) -> Result<Largest, Stopped> {
        let cutter = &assembly.cutter;
        let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
        let near = |away: f64, z: f64| {
            let top = self.top_mm - z;
            solid.depth_at(away, top).max(-assembly.clearance(away, top))
        };
        self.largest(tip, asked, near, budget)
    }

    /// As [`Prism::nearness`], of shank and holder alone.
    ///
    /// # Errors
    /// Only the budget's stop.
    pub fn nearness_of_sections(
        &self,
        assembly: &Assembly,
        tip: &Curve,
        asked: Asked,
        budget: &Budget,
    ) -> Result<Largest, Stopped> {
        self.largest(tip, asked, |away, z| -assembly.clearance(away, self.top_mm - z), budget)
    }

    /// The largest value of a function of the distance in plan and of the height of the tip, which grows
    /// with neither.
    fn largest(
        &self,
        tip: &Curve,
        asked: Asked,
        value: impl Fn(f64, f64) -> f64,
        budget: &Budget,
    ) -> Result<Largest, Stopped> {
        let Asked { slack_mm, gap_mm, enough_mm } = asked;
        let (pieces, chord_mm) = pieces(tip, CHORD * gap_mm);
        let off = slack_mm + chord_mm + SNAP_MM;
        let mut largest = Largest { bound: f64::NEG_INFINITY, found: f64::NEG_INFINITY, at: None };
        let mut open = BestFirst::default();
        let add = |piece: PlanPiece, largest: &mut Largest, open: &mut BestFirst<PlanPiece>| {
            for t in [0.0, 0.5, 1.0] {
                let (p, z) = (piece.plan.at(t), piece.height(t));
                let found = value(self.away(p), z);
                if found > largest.found {
                    (largest.found, largest.at) = (found, Some(Point3::new(p.x, p.y, z)));
                }
            }
            let away = (self.least_away(&piece.plan) - off).max(0.0);
            open.push(value(away, piece.heights[0].min(piece.heights[1]) - off), piece);
        };
        for (k, piece) in pieces.into_iter().enumerate() {
            if k % PIECES_BETWEEN_CHECKS == 0 {
                budget.check()?;
            }
            add(piece, &mut largest, &mut open);
        }
        // Halving does not bring a bound below what the slack and the chords add to it.
        let gap_mm = gap_mm + 2.0 * off;
        for k in 0..MOST_HALVINGS {
            if k % PIECES_BETWEEN_CHECKS == PIECES_BETWEEN_CHECKS - 1 {
                budget.check()?;
            }
            let Some((bound, piece)) = open.pop() else { return Ok(largest) };
            largest.bound = bound;
            if bound <= enough_mm.max(largest.found + gap_mm) || piece.is_short(gap_mm) {
                return Ok(largest);
            }
            for half in piece.halves() {
                add(half, &mut largest, &mut open);
            }
        }
        if let Some((bound, _)) = open.pop() {
            largest.bound = bound;
        }
        Ok(largest)
    }

    /// The distance of a place in plan from the material, mm; zero in it.
    fn away(&self, p: Point2<f64>) -> f64 {
        if self.holds(p) { 0.0 } else { self.region.distance_to_boundary(p) }
    }

    fn holds(&self, p: Point2<f64>) -> bool {
        let free = match self.material {
            Material::Inside => Containment::Outside,
            Material::Outside => Containment::Inside,
        };
        self.region.place(p, 0.0) != free
    }

    /// The least distance of a line or an arc in plan from the material, mm.
    fn least_away(&self, plan: &Segment) -> f64 {
        if self.holds(plan.start()) {
            return 0.0;
        }
        let of_middle = self.region.distance_to_boundary(plan.at(0.5));
        self.region.clearance(plan, of_middle)
    }
}

impl PlanPiece {
    /// The height of the tip at a fraction of the length, mm.
    pub(super) fn height(&self, t: f64) -> f64 {
        self.heights[0] + (self.heights[1] - self.heights[0]) * t
    }

    fn halves(&self) -> [Self; 2] {
        let middle = self.height(0.5);
        let [low, high] = self.heights;
        [
            Self { plan: self.plan.part(0.0, 0.5), heights: [low, middle] },
            Self { plan: self.plan.part(0.5, 1.0), heights: [middle, high] },
        ]
    }

    fn is_short(&self, length_mm: f64) -> bool {
        self.plan.length().hypot(self.heights[1] - self.heights[0]) < length_mm
    }
}

/// The pieces of a curve, and how far they may lie from it, mm.
pub(super) fn pieces(tip: &Curve, mut chord_mm: f64) -> (Vec<PlanPiece>, f64) {
    let (start, end) = (tip.start(), tip.end());
    let heights = [start.z, end.z];
    match tip {
        Curve::Line(_) => {
            return (
                vec![PlanPiece { plan: Segment::Line { start: start.xy(), end: end.xy() }, heights }],
                0.0,
            );
        }
        Curve::Arc(arc) if arc.plane() == Plane::Xy => {
            let turn = match arc.direction() {
                Direction::Ccw => arc.sweep(),
                Direction::Cw => -arc.sweep(),
            };
            let plan = Segment::about(arc.center().xy(), arc.radius(), [start.xy(), end.xy()], turn);
            return (vec![PlanPiece { plan, heights }], 0.0);
        }
        Curve::Arc(_) | Curve::Parabola(_) => {}
    }
    loop {
        if let Ok(points) = flatten(tip, chord_mm, MOST_CHORDS) {
            let chord = |ends: &[Point3<f64>]| PlanPiece {
                plan: Segment::Line { start: ends[0].xy(), end: ends[1].xy() },
                heights: [ends[0].z, ends[1].z],
            };
            return (points.windows(2).map(chord).collect(), chord_mm);
        }
        chord_mm *= 2.0;
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::curve::{Arc, Line};
    use crate::geometry::region::Outline;
    use crate::machining::assembly::Frustum;

    const ASKED: Asked = Asked { slack_mm: 0.0, gap_mm: 1e-3, enough_mm: f64::NEG_INFINITY };

    fn square(side: f64) -> Region {
        let corner = [[0.0, 0.0], [side, 0.0], [side, side], [0.0, side]].map(Point2::from);
        let sides = [0, 1, 2, 3].map(|k| Segment::Line { start: corner[k], end: corner[(k + 1) % 4] });
        let budget = Budget::unlimited();
        Region::new(&[Outline::new(&sides, &budget).unwrap()], &[], &budget).unwrap()
    }

    fn line(from: [f64; 3], to: [f64; 3]) -> Curve {
        Curve::Line(Line { start: Point3::from(from), end: Point3::from(to) })
    }

    fn depth(prism: &Prism, cutter: Cutter, tip: &Curve) -> Largest {
        prism.depth(&cutter, tip, ASKED, &Budget::unlimited()).unwrap()
    }

    #[test]
    fn a_flat_end_beside_a_wall_enters_it_by_what_it_is_too_near() {
        let pocket = Prism { region: square(50.0), material: Material::Outside, top_mm: 0.0 };
        let flat = Cutter::bull_nose(5.0, 0.0);
        let beside = depth(&pocket, flat, &line([5.0, 10.0, -3.0], [5.0, 40.0, -3.0]));
        assert!(beside.bound.abs() < 1e-4 && beside.found.abs() < 1e-9, "{beside:?}");
        let near = depth(&pocket, flat, &line([5.0, 10.0, -3.0], [4.99, 40.0, -3.0]));
        assert!(near.found > 0.0099 && near.bound >= 0.01 && near.bound < 0.0115, "{near:?}");
        assert!((near.at.unwrap() - Point3::new(4.99, 40.0, -3.0)).norm() < 1e-6);
        // Above the wall there is no depth, and the clearance is the height.
        let above = depth(&pocket, flat, &line([5.0, 10.0, 2.0], [-20.0, 40.0, 2.0]));
        assert!((above.bound + 2.0).abs() < 2e-3, "{above:?}");
    }

    #[test]
    fn a_circle_in_a_square_is_nearest_at_four_places() {
        let pocket = Prism { region: square(50.0), material: Material::Outside, top_mm: 0.0 };
        let (at, center) = (Point3::new(44.0, 25.0, -3.0), Point3::new(25.0, 25.0, -3.0));
        let circle = Curve::Arc(Arc::new(Plane::Xy, Direction::Ccw, at, at, center).unwrap());
        let found = depth(&pocket, Cutter::bull_nose(6.5, 0.0), &circle);
        assert!(found.found > 0.499 && found.bound >= 0.5 && found.bound < 0.502, "{found:?}");
    }

    #[test]
    fn a_holder_is_as_near_as_its_corner() {
        let clamp = Prism { region: square(20.0), material: Material::Inside, top_mm: 30.0 };
        let holder = Frustum { bottom_mm: 40.0, top_mm: 80.0, bottom_radius_mm: 25.0, top_radius_mm: 25.0 };
        let tool = Assembly { cutter: Cutter::bull_nose(5.0, 0.0), sections: vec![holder] };
        // Beside the clamp and over it: 3 mm over its top, and 3 mm or -2 mm from its side.
        for (x, distance) in [(48.0, 18.0f64.sqrt()), (43.0, 3.0)] {
            let tip = line([x, 10.0, -7.0], [x, 15.0, -7.0]);
            let near = clamp.nearness(&tool, &tip, ASKED, &Budget::unlimited()).unwrap();
            assert!((near.found + distance).abs() < 1e-9, "{near:?}");
            assert!(near.bound >= near.found && near.bound < near.found + 1e-3, "{near:?}");
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn no_place_of_the_path_exceeds_the_bound(
            ends in prop::array::uniform6(-20.0f64..60.0), corner in 0.0f64..=1.0, t in 0.0f64..=1.0,
            is_inside in any::<bool>(),
        ) {
            let [a, b, c, d, e, f] = ends;
            let material = if is_inside { Material::Inside } else { Material::Outside };
            let prism = Prism { region: square(40.0), material, top_mm: 5.0 };
            let tip = line([a, b, 0.2 * c], [d, e, 0.2 * f]);
            let cutter = Cutter::bull_nose(4.0, 4.0 * corner);
            let largest = depth(&prism, cutter, &tip);
            let p = tip.point_at(t);
            let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
            let own = solid.depth_at(prism.away(p.xy()), prism.top_mm - p.z);
            prop_assert!(own <= largest.bound + 1e-12, "{own} {largest:?}");
            prop_assert!(largest.bound <= largest.found + 2e-3, "{largest:?}");
        }
    }
}
