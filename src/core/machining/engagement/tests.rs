use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Point2;

use super::{Enough, Swept, straight_angle};
use crate::budget::Budget;
use crate::geometry::segment::Segment;

const RADIUS_MM: f64 = 5.0;

/// How much a bound may be above the angle, radians: two degrees.
const LOOSE: f64 = 0.035;

fn line(from: [f64; 2], to: [f64; 2]) -> Segment {
    Segment::Line { start: from.into(), end: to.into() }
}

/// A circle about the origin to the left, from the right.
fn circle(radius: f64) -> [Segment; 2] {
    let place = |x: f64| Point2::new(x, 0.0);
    let half = |start, end| Segment::about(Point2::origin(), radius, [start, end], PI);
    [half(place(radius), place(-radius)), half(place(-radius), place(radius))]
}

/// The largest angle along elements that are followed one after the other.
fn largest(swept: &mut Swept, elements: &[Segment]) -> f64 {
    let mut largest = 0.0f64;
    for element in elements {
        let stretches = swept.follow(element, Enough::Angle(0.0), &Budget::unlimited()).unwrap();
        largest = stretches.iter().map(|stretch| stretch.angle).fold(largest, f64::max);
    }
    largest
}

#[test]
fn a_first_pass_is_a_slot_and_the_same_pass_again_is_clear() {
    let mut swept = Swept::new(RADIUS_MM);
    let pass = line([0.0, 0.0], [40.0, 0.0]);
    assert!((largest(&mut swept, &[pass]) - PI).abs() < 1e-9);
    assert_eq!(largest(&mut swept, &[pass.part(0.0, 0.9)]), 0.0);
}

#[test]
fn a_straight_pass_beside_another_has_the_angle_of_the_stepover() {
    for stepover in [0.5, 3.0, 5.0, 8.0] {
        let mut swept = Swept::new(RADIUS_MM);
        largest(&mut swept, &[line([-20.0, 0.0], [60.0, 0.0])]);
        let angle = largest(&mut swept, &[line([0.0, stepover], [40.0, stepover])]);
        let exact = straight_angle(RADIUS_MM, stepover);
        // Behind the start of the pass everything beside it stands too, but the leading half does not see it.
        assert!((exact..exact + LOOSE).contains(&(angle + 1e-9)), "{stepover}: {angle} {exact}");
    }
}

/// Where everything within p + R of a centre is free, a cutter on a circle of radius D about it has the angle
/// f with cos f = ((p + R)^2 - D^2 - R^2) / (2 D R).
#[test]
fn a_circle_about_a_cleared_disc_has_the_angle_of_the_closed_form() {
    for (inner, step) in [(4.0, 1.0), (4.0, 2.0), (20.0, 3.0)] {
        let mut swept = Swept::new(RADIUS_MM);
        for radius in 0..=(inner / 2.0) as usize {
            largest(&mut swept, &circle(2.0 * radius as f64 + 1e-3));
        }
        largest(&mut swept, &circle(inner));
        let around = inner + step;
        let free = (inner + RADIUS_MM).powi(2) - around * around - RADIUS_MM * RADIUS_MM;
        let exact = (free / (2.0 * around * RADIUS_MM)).acos();
        let angle = largest(&mut swept, &circle(around)[..1]);
        assert!((exact..exact + 2.0 * LOOSE).contains(&angle), "{inner} {step}: {angle} {exact}");
    }
}

/// Into an inner corner a pass meets what stands before it too.
#[test]
fn a_pass_into_a_corner_has_a_right_angle_more() {
    let mut swept = Swept::new(RADIUS_MM);
    largest(&mut swept, &[line([0.0, 0.0], [40.0, 0.0]), line([40.0, 0.0], [40.0, 40.0])]);
    // Three millimetres outside of both.
    let angle = largest(&mut swept, &[line([0.0, -3.0], [43.0, -3.0])]);
    let exact = straight_angle(RADIUS_MM, 3.0) + FRAC_PI_2;
    assert!((exact..exact + LOOSE).contains(&angle), "{angle} {exact}");
}

#[test]
fn a_narrow_ridge_between_two_passes_is_found() {
    let mut swept = Swept::new(RADIUS_MM);
    for y in [0.0, 10.02] {
        largest(&mut swept, &[line([-20.0, y], [60.0, y])]);
    }
    let across = line([20.0, 0.0], [20.0, 10.02]);
    // Head on, the ridge is as wide as a chord of the cutter at its height.
    assert!(!swept.is_clear(&across, &Budget::unlimited()).unwrap());
    assert!(!swept.is_free(Point2::new(20.0, 5.01), 0.004));
    let along = line([0.0, 5.01], [40.0, 5.01]);
    let stretches = swept.survey(&along, Enough::Angle(0.0), &Budget::unlimited()).unwrap();
    assert!(!stretches.is_empty());
    assert!(stretches.iter().all(|stretch| (0.003..0.02).contains(&stretch.angle)), "{stretches:?}");
}

#[test]
fn a_disc_is_free_where_passes_cover_it_and_not_beside_them() {
    let mut swept = Swept::new(RADIUS_MM);
    for y in [0.0, 3.0, 6.0] {
        largest(&mut swept, &[line([-20.0, y], [60.0, y])]);
    }
    for (y, is_free) in [(0.0, true), (3.7, true), (6.0, true), (6.01, true), (6.2, false), (-0.2, false)] {
        assert_eq!(swept.is_free(Point2::new(20.0, y), 0.05), is_free, "{y}");
    }
}

/// Along a stretch the bound is never below the angle at a place in it.
#[test]
fn no_angle_inside_a_stretch_is_above_its_bound() {
    let mut swept = Swept::new(RADIUS_MM);
    for k in 0..12 {
        let turn = TAU * f64::from(k) / 12.0 * 1.7;
        let (x, y) = (15.0 * turn.cos(), 11.0 * turn.sin());
        largest(&mut swept, &[line([x, y], [1.3 * y, 0.7 * x])]);
    }
    let arc = Segment::bulging(Point2::new(-25.0, -6.0), Point2::new(24.0, 9.0), 0.4);
    for motion in [arc, line([-25.0, 3.0], [25.0, -4.0])] {
        let stretches = swept.survey(&motion, Enough::Angle(0.0), &Budget::unlimited()).unwrap();
        assert!(!stretches.is_empty());
        for stretch in stretches {
            for k in 0..=10 {
                let t = stretch.from + (stretch.to - stretch.from) * f64::from(k) / 10.0;
                let angle = swept.angle_at(motion.at(t), motion.direction(t));
                // The history has chords for arcs in both figures.
                assert!(angle <= stretch.angle + 1e-9, "{angle} in {stretch:?}");
            }
        }
    }
}
