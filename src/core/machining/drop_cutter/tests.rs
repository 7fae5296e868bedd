use std::cell::Cell;

use proptest::prelude::*;

use super::chord_proof::ChordVerdict;
use super::drop::Drop;
use super::lift_bound::{AxisMove, Threshold};
use super::round::RoundBodies;
use super::*;
use crate::geometry::surface::BicubicPatch;

/// A surface of one patch z = f over a rectangle. f is a polynomial of degree at most 3 each way.
fn graph(low: [f64; 2], high: [f64; 2], f: impl Fn(f64, f64) -> f64) -> BezierSurface {
    // Control values of a cubic from its values at thirds.
    let control = |y: [f64; 4]| {
        [
            y[0],
            (-5.0 * y[0] + 18.0 * y[1] - 9.0 * y[2] + 2.0 * y[3]) / 6.0,
            (2.0 * y[0] - 9.0 * y[1] + 18.0 * y[2] - 5.0 * y[3]) / 6.0,
            y[3],
        ]
    };
    let at = |k: usize, axis: usize| low[axis] + (high[axis] - low[axis]) * k as f64 / 3.0;
    let rows: [[f64; 4]; 4] =
        std::array::from_fn(|a| control(std::array::from_fn(|b| f(at(a, 0), at(b, 1)))));
    let columns: [[f64; 4]; 4] = std::array::from_fn(|b| control(std::array::from_fn(|a| rows[a][b])));
    BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| Vector3::new(at(a, 0), at(b, 1), columns[b][a]))
        }),
    })
}

fn tip(surface: &BezierSurface, cutter: Cutter, x: f64, y: f64) -> f64 {
    let budget = Budget::unlimited();
    let contacts = Contacts::new(surface, cutter, &budget).unwrap();
    let contact = contacts.drop(Vector2::new(x, y), None, &budget).unwrap().unwrap();
    // The rotational bowl is touched all around at once.
    assert!(contact.gap_mm <= 1e-6, "{contact:?}");
    contact.tip.z
}

#[test]
fn a_plane_is_touched_as_the_closed_form_says() {
    for slope in [0.0f64, 0.3, 1.0, 5.0, 19.0] {
        let plane = graph([-40.0, -40.0], [40.0, 40.0], |x, y| slope * (0.6 * x + 0.8 * y));
        let cos = 1.0 / slope.hypot(1.0);
        let (x, y) = (1.3, -2.2);
        let z = slope * (0.6 * x + 0.8 * y);
        for (cutter, expected) in [
            (Cutter::ball(5.0), z + 5.0 / cos - 5.0),
            (Cutter::bull_nose(5.0, 0.0), z + 5.0 * slope),
            (Cutter::bull_nose(5.0, 2.0), z + 3.0 * slope + 2.0 / cos - 2.0),
        ] {
            let got = tip(&plane, cutter, x, y);
            assert!((got - expected).abs() < 1e-8, "{slope} {cutter:?} {got} {expected}");
        }
    }
}

/// The largest value of a linear function in a disc of a radius about a place, and the square from 0 to 10.
fn highest_in_disc(gradient: Vector2<f64>, at: Vector2<f64>, radius: f64) -> Option<f64> {
    let is_in = |p: &Vector2<f64>| {
        (p - at).norm() <= radius + 1e-12 && p.iter().all(|x| (-1e-12..=10.0 + 1e-12).contains(x))
    };
    let mut candidates = vec![at + gradient.normalize() * radius];
    for axis in 0..2 {
        for side in [0.0, 10.0] {
            let half = (radius * radius - (side - at[axis]).powi(2)).sqrt();
            for other in [at[1 - axis] - half, at[1 - axis] + half, 0.0, 10.0] {
                let mut p = Vector2::repeat(side);
                p[1 - axis] = other;
                candidates.push(p);
            }
        }
    }
    candidates.iter().filter(|p| is_in(p)).map(|p| gradient.dot(p)).reduce(f64::max)
}

#[test]
fn a_flat_end_touches_edges_and_corners_with_its_rim() {
    for gradient in [[0.5, 0.0], [0.3, -0.8], [4.0, 3.0], [-0.02, 0.01]].map(Vector2::from) {
        let plane = graph([0.0, 0.0], [10.0, 10.0], |x, y| gradient.dot(&Vector2::new(x, y)));
        let budget = Budget::unlimited();
        let contacts = Contacts::new(&plane, Cutter::bull_nose(2.0, 0.0), &budget).unwrap();
        for k in 0..31 * 31 {
            let at = Vector2::new(-2.43 + 0.493 * f64::from(k % 31), -2.37 + 0.487 * f64::from(k / 31));
            let found = contacts.drop(at, None, &budget).unwrap();
            let expected = highest_in_disc(gradient, at, 2.0);
            let is_right = match (found, expected) {
                (Some(found), Some(expected)) => (found.tip.z - expected).abs() < 1e-8,
                (found, expected) => found.is_none() && expected.is_none(),
            };
            assert!(is_right, "{at} {gradient}: {found:?} {expected:?}");
        }
    }
}

#[test]
fn a_bowl_that_is_too_tight_holds_the_cutter_up() {
    let bowl = graph([-4.0, -4.0], [4.0, 4.0], |x, y| 0.4 * (x * x + y * y));
    assert!((tip(&bowl, Cutter::ball(2.5), 0.0, 0.0) - 0.625).abs() < 1e-8);
    assert!((tip(&bowl, Cutter::bull_nose(2.5, 0.0), 0.0, 0.0) - 2.5).abs() < 1e-8);
    let trough = graph([-4.0, -4.0], [4.0, 4.0], |x, _| 0.4 * x * x);
    assert!((tip(&trough, Cutter::ball(2.5), 0.0, 0.0) - 0.625).abs() < 1e-8);
    assert!((tip(&trough, Cutter::bull_nose(2.5, 0.0), 0.0, 0.7) - 2.5).abs() < 1e-8);
}

#[test]
fn an_edge_and_a_corner_are_touched() {
    let square = graph([0.0, 0.0], [10.0, 10.0], |_, _| 3.0);
    assert!((tip(&square, Cutter::ball(5.0), -3.0, 5.0) - (3.0 - 1.0)).abs() < 1e-8);
    assert!((tip(&square, Cutter::ball(5.0), -3.0, -2.0) - (3.0 - (5.0 - 12f64.sqrt()))).abs() < 1e-8);
    assert!((tip(&square, Cutter::bull_nose(5.0, 0.0), -3.0, -2.0) - 3.0).abs() < 1e-8);
}

#[test]
fn random_bumps_are_touched_where_a_dense_search_says() {
    let mut seed = 7u64;
    let mut random = || {
        seed = seed.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    for case in 0..30 {
        let net: [[f64; 4]; 4] = std::array::from_fn(|_| std::array::from_fn(|_| 12.0 * random()));
        let surface = BezierSurface::from_fn([1, 1], |_, _| BicubicPatch {
            net: std::array::from_fn(|a| {
                std::array::from_fn(|b| Vector3::new(8.0 * a as f64, 8.0 * b as f64, net[a][b]))
            }),
        });
        for cutter in [Cutter::ball(3.0), Cutter::bull_nose(3.0, 0.0), Cutter::bull_nose(3.0, 1.0)] {
            let (x, y) = (28.0 * random() - 2.0, 28.0 * random() - 2.0);
            let got = tip(&surface, cutter, x, y);
            let n = 400;
            let mut sampled = f64::NEG_INFINITY;
            for i in 0..=n {
                for j in 0..=n {
                    let p = surface.jet(f64::from(i) / f64::from(n), f64::from(j) / f64::from(n)).point;
                    sampled = sampled.max(p.z - cutter.height((p.x - x).hypot(p.y - y)));
                }
            }
            assert!(got >= sampled - 1e-9, "{case} {cutter:?} {got} {sampled}");
            assert!(got <= sampled + 0.1, "{case} {cutter:?} {got} {sampled}");
        }
    }
}

#[test]
fn chords_are_confirmed_only_where_tips_keep_to_them() {
    let budget = Budget::unlimited();
    let square = graph([0.0, 0.0], [10.0, 10.0], |_, _| 3.0);
    let contacts = Contacts::new(&square, Cutter::ball(5.0), &budget).unwrap();
    let at = |x: f64| contacts.drop(Vector2::new(x, 5.0), None, &budget).unwrap().unwrap();
    assert_eq!(contacts.stretch(&at(3.0), &at(7.0), [1e-6; 2]), ChordVerdict::Within);
    // The height of an arc of radius 5 over a chord.
    let (from, to) = (at(-2.0), at(-1.6));
    let chord = (to.tip - from.tip).norm();
    let sagitta = 5.0 - (25.0 - 0.25 * chord * chord).sqrt();
    assert_ne!(contacts.stretch(&from, &to, [0.9 * sagitta; 2]), ChordVerdict::Within);
    assert_eq!(contacts.stretch(&from, &to, [1.3 * sagitta; 2]), ChordVerdict::Within);
}

#[test]
fn parts_that_round_bodies_keep_below_lift_no_higher() {
    // Parts found below round bodies, by the shape of the cutter.
    let found = [const { Cell::new(0) }; 3];
    proptest!(ProptestConfig::with_cases(120), |(
        bends in prop::array::uniform6(-0.08f64..0.08),
        (corner, shape) in (0.0f64..1.0, 0usize..3),
        (x, y) in (-6.0f64..6.0, -6.0f64..6.0),
        (angle, reach, slope, over) in (0.0f64..6.3, 0.0f64..0.5, -0.5f64..0.5, -0.2f64..0.2),
    )| {
        let [xx, xy, yy, z_x, z_y, xxx] = bends;
        let surface = graph([-8.0, -8.0], [8.0, 8.0], |x, y| {
            xx * x * x + xy * x * y + yy * y * y + 5.0 * (z_x * x + z_y * y) + 0.1 * xxx * x * x * x
        });
        let cutter = match shape {
            0 => Cutter::ball(3.0),
            1 => Cutter::bull_nose(3.0, 0.0),
            _ => Cutter::bull_nose(3.0, 0.2 + 2.6 * corner),
        };
        let budget = Budget::unlimited();
        let contacts = Contacts::new(&surface, cutter, &budget).unwrap();
        let mut drop = Drop::new(&contacts, Vector2::new(x, y), None, 1e-9);
        contacts.tree.visit(&mut drop);
        let Some(best) = drop.best() else { return Ok(()) };
        let round = RoundBodies::around(&contacts.cutter, &best.lower, &best.jet);
        let way = Vector2::new(angle.cos(), angle.sin()) * reach;
        let at = Vector2::new(x, y);
        let level = Threshold { level: best.height + over, slope };
        for track in [AxisMove::point(at), AxisMove::between(at - way, at + way)] {
            let kept = contacts.tree.parts.iter().filter(|part| round.keep_below(part, &track, &level));
            for part in kept {
                found[shape].set(found[shape].get() + 1);
                for k in 0..=10 * 10 * 4 {
                    let t = (k / 100) as f64 / 2.0 - 1.0;
                    let jet = part.patch.jet((k % 10) as f64 / 9.0, (k / 10 % 10) as f64 / 9.0);
                    let axis = track.center + track.way * (t * track.reach);
                    let lift = jet.point.z - contacts.cutter.height((jet.point.coords.xy() - axis).norm());
                    let highest = level.level + t * track.reach * level.slope;
                    prop_assert!(lift <= highest + 1e-9, "{lift} over {highest}");
                }
            }
        }
    });
    let counts = found.map(|count| count.get());
    assert!(counts.iter().all(|&count| count >= 1000), "only {counts:?} parts were found below round bodies");
}
