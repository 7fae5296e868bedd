use super::*;
use crate::geometry::curve::{Arc, Direction, Line, Parabola};
use crate::geometry::plane::Plane;
use crate::geometry::surface::BezierSurface;
use crate::geometry::surface::point_grid::{Ends, PointGrid, Twist};

mod cutters;

const GAP: f64 = 2e-5;

fn grid(n: usize, side: f64, height: impl Fn(f64, f64) -> f64) -> BezierSurface {
    oblong([n, n], [side, side], height)
}

fn oblong(n: [usize; 2], sides: [f64; 2], height: impl Fn(f64, f64) -> f64) -> BezierSurface {
    let at = |c: usize, i: usize| sides[c] * (i as f64 / (n[c] - 1) as f64 - 0.5);
    let point = |i, j| Point3::new(at(0, i), at(1, j), height(at(0, i), at(1, j)));
    let points = (0..n[0]).map(|i| (0..n[1]).map(|j| point(i, j)).collect()).collect();
    PointGrid { points, twist: Twist::Spline, ends: Ends::NotAKnot }.surface().unwrap()
}

fn deepest(surface: &BezierSurface, radius: f64, tip: Curve) -> f64 {
    let proof = GougeProof::new(surface, &Cutter::ball(radius), 0.0);
    let depth = proof.penetration(&[tip], GAP, &Budget::unlimited()).unwrap();
    assert!(depth.found_mm <= depth.bound_mm && depth.bound_mm <= depth.found_mm + 1.01 * GAP, "{depth:?}");
    depth.bound_mm
}

fn line(from: [f64; 3], to: [f64; 3]) -> Curve {
    Curve::Line(Line { start: from.into(), end: to.into() })
}

#[test]
fn a_line_below_a_plane_cuts_as_deep_as_it_lies() {
    for slope in [0.0f64, 0.5, 2.0, 5.0] {
        let plate = grid(5, 40.0, |x, _| slope * x);
        let cos = 1.0 / (1.0 + slope * slope).sqrt();
        let radius = 5.0;
        for depth in [0.0, 0.003, 0.2] {
            // The tip that touches the slope at depth zero lies R (1 / cos - 1) above it.
            let lift = radius * (1.0 / cos - 1.0) - depth / cos;
            for y in [-7.0, 0.0] {
                let at = |x: f64| [x, y, slope * x + lift];
                let bound = deepest(&plate, radius, line(at(-8.0), at(8.0)));
                assert!(bound >= depth && bound <= depth + 1.1 * GAP, "slope {slope}: {bound} {depth}");
            }
        }
    }
}

#[test]
fn the_exact_arc_over_a_sphere_cuts_nothing() {
    let (big, radius) = (40.0f64, 5.0);
    let cap = grid(61, 40.0, |x, y| (big * big - x * x - y * y).sqrt());
    for lowered in [0.0, 0.01] {
        for y in [0.0f64, 12.0] {
            let r = ((big + radius).powi(2) - y * y).sqrt();
            let center = Point3::new(0.0, y, -radius - lowered);
            let at = |angle: f64| center + Vector3::new(angle.sin(), 0.0, angle.cos()) * r;
            // In zx, from +x to -x over the top is clockwise.
            let arc = Arc::new(Plane::Zx, Direction::Cw, at(0.35), at(-0.35), center).unwrap();
            let bound = deepest(&cap, radius, Curve::Arc(arc));
            // Lowered along z, the ball's centre comes nearest to the sphere's where it is highest.
            let truth = lowered * r / (big + radius);
            assert!((bound - truth).abs() < 1e-4, "{bound} {truth}");
        }
    }
}

#[test]
fn the_exact_arc_over_a_cap_to_sixty_degrees_is_bounded_closely() {
    let (big, radius) = (40.0f64, 5.0);
    let widest = 60f64.to_radians();
    let cap = oblong([141, 21], [2.0 * big * widest.sin(), 12.0], |x, y| (big * big - x * x - y * y).sqrt());
    let center = Point3::new(0.0, 0.0, -radius);
    let at = |angle: f64| center + Vector3::new(angle.sin(), 0.0, angle.cos()) * (big + radius);
    let arc = Arc::new(Plane::Zx, Direction::Ccw, at(-widest), at(widest), center).unwrap();
    let bound = deepest(&cap, radius, Curve::Arc(arc));
    assert!(bound <= 1e-4, "{bound}");
}

#[test]
fn the_exact_arc_in_a_bowl_cuts_nothing() {
    let (big, radius) = (40.0f64, 5.0);
    let bowl = grid(61, 40.0, |x, y| -(big * big - x * x - y * y).sqrt());
    for lowered in [0.0, 0.01] {
        let r = big - radius;
        let center = Point3::new(0.0, 0.0, -radius - lowered);
        let at = |angle: f64| center + Vector3::new(0.0, angle.sin(), -angle.cos()) * r;
        let arc = Arc::new(Plane::Yz, Direction::Ccw, at(-0.35), at(0.35), center).unwrap();
        let bound = deepest(&bowl, radius, Curve::Arc(arc));
        assert!((bound - lowered).abs() < 1e-4, "{bound} {lowered}");
    }
}

#[test]
fn a_full_circle_cuts_a_plane_as_deep_as_it_is_lowered() {
    let plate = grid(4, 60.0, |_, _| 0.0);
    for depth in [0.0, 0.05] {
        let at = Point3::new(15.0, 0.0, -depth);
        let arc = Arc::new(Plane::Xy, Direction::Ccw, at, at, Point3::new(0.0, 0.0, -depth)).unwrap();
        let bound = deepest(&plate, 3.0, Curve::Arc(arc));
        assert!(bound >= depth && bound < depth + 1.1 * GAP, "{bound}");
    }
}

#[test]
fn a_helix_cuts_a_plane_as_deep_as_its_lowest_end() {
    let plate = grid(4, 60.0, |_, _| 0.0);
    let (from, to) = (Point3::new(10.0, 0.0, 6.0), Point3::new(0.0, 10.0, -0.03));
    let arc = Arc::new(Plane::Xy, Direction::Cw, from, to, Point3::new(0.0, 0.0, 6.0)).unwrap();
    let proof = GougeProof::new(&plate, &Cutter::ball(3.0), 0.0);
    let depth = proof.penetration(&[Curve::Arc(arc)], 1e-3, &Budget::unlimited()).unwrap();
    assert!(depth.bound_mm >= 0.03 && depth.bound_mm < 0.032, "{depth:?}");
}

#[test]
fn a_parabola_cuts_a_plane_as_deep_as_its_lowest_point() {
    let plate = grid(4, 60.0, |_, _| 0.0);
    let (from, control, to) =
        (Point3::new(-10.0, 0.0, 1.0), Point3::new(0.0, 8.0, -1.06), Point3::new(10.0, 0.0, 1.0));
    // Halfway it is at the mean of the control point and the middle of the ends.
    let parabola = Curve::Parabola(Parabola::new(from, control, to).unwrap());
    let proof = GougeProof::new(&plate, &Cutter::ball(3.0), 0.0);
    let depth = proof.penetration(&[parabola], 1e-3, &Budget::unlimited()).unwrap();
    assert!(depth.bound_mm >= 0.03 && depth.bound_mm < 0.032, "{depth:?}");
}

#[test]
fn the_shank_counts_beside_a_wall() {
    // A ramp of 84 degrees between two flats 20 mm apart in height; the ball runs on the lower flat.
    let ramp = grid(81, 40.0, |x, _| 10.0 + 10.0 * (10.0 * x).tanh());
    // The centre at x = -4 is 5 mm from x = 1, where the ramp has reached the upper flat 15 mm above it.
    let bound = deepest(&ramp, 5.0, line([-4.0, -5.0, 0.2], [-4.0, 5.0, 0.2]));
    assert!(bound > 0.9, "{bound}");
    // Far enough away nothing is touched.
    assert!(deepest(&ramp, 5.0, line([-6.5, -5.0, 0.2], [-6.5, 5.0, 0.2])) < 0.2);
}

#[test]
fn a_cutter_beside_or_above_the_surface_touches_nothing() {
    let plate = grid(3, 20.0, |_, _| 0.0);
    assert_eq!(deepest(&plate, 5.0, line([-30.0, 0.0, -40.0], [-30.0, 0.0, 40.0])), 0.0);
    assert_eq!(deepest(&plate, 5.0, line([-30.0, 0.0, 0.5], [30.0, 3.0, 0.5])), 0.0);
    // Plunging through the middle leaves the whole radius in the part.
    let bound = deepest(&plate, 5.0, line([0.0, 0.0, 5.0], [0.0, 0.0, -30.0]));
    assert!(bound >= 5.0 - GAP, "{bound}");
}

#[test]
fn a_cancelled_search_stops() {
    let plate = grid(3, 20.0, |_, _| 0.0);
    let budget = Budget::unlimited();
    budget.cancel();
    let proof = GougeProof::new(&plate, &Cutter::ball(5.0), 0.0);
    let path = [line([-5.0, 0.0, 0.0], [5.0, 0.0, 0.0])];
    assert_eq!(proof.penetration(&path, GAP, &budget), Err(Stopped::Cancelled));
}

/// A path with slack is as deep as its curve and the slack together, and is not searched for ever.
#[test]
fn slack_adds_to_the_bound_and_not_to_the_work() {
    let dome = grid(15, 34.4, |x, _| (37.3f64 * 37.3 - x * x).sqrt());
    let proof = GougeProof::new(&dome, &Cutter::ball(5.0), 0.0);
    let center = |y: f64| Point3::new(0.0, y, -5.0 - 0.004);
    let (gap, slack) = (2e-4, 5e-4);
    let mut deepest = Penetration::NONE;
    for k in 0..20 {
        let y = k as f64 * 0.7 - 7.0;
        let at = |angle: f64| center(y) + Vector3::new(angle.sin(), 0.0, angle.cos()) * 42.3;
        let arc = Arc::new(Plane::Zx, Direction::Ccw, at(-0.3), at(0.3), center(y)).unwrap();
        proof.penetrate(&Curve::Arc(arc), slack, gap, &mut deepest, &Budget::unlimited()).unwrap();
    }
    assert!(deepest.found_mm <= 0.0041 && deepest.found_mm >= 0.0038, "{deepest:?}");
    assert!(
        deepest.bound_mm >= 0.004 + slack && deepest.bound_mm <= deepest.found_mm + gap + slack + 1e-9,
        "{deepest:?}"
    );
}
