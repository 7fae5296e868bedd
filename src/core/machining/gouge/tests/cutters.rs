//! Every shape of cutter: comparison with closed formulas, and with dense points for random moves over random
//! surfaces.

use nalgebra::Vector2;
use proptest::prelude::*;

use super::*;
use crate::geometry::surface::BicubicPatch;

fn cutters() -> [Cutter; 4] {
    [Cutter::ball(5.0), Cutter::bull_nose(5.0, 2.0), Cutter::bull_nose(5.0, 0.5), Cutter::bull_nose(5.0, 0.0)]
}

fn depth(surface: &BezierSurface, cutter: &Cutter, tip: Curve) -> Penetration {
    let depth = GougeProof::new(surface, cutter, 0.0).penetration(&[tip], GAP, &Budget::unlimited()).unwrap();
    assert!(depth.found_mm <= depth.bound_mm, "{cutter:?} {depth:?}");
    depth
}

#[test]
fn a_cutter_lowered_on_a_slope_is_as_deep_as_its_lowest_point_along_the_normal() {
    for slope in [0.0f64, 0.3, 1.0, 4.0] {
        let plate = grid(5, 40.0, |x, _| slope * x);
        let cos = 1.0 / (1.0 + slope * slope).sqrt();
        for cutter in cutters() {
            let contact = cutter.tangent_point(Vector2::new(slope, 0.0));
            let lift = slope * contact.place.x - contact.height;
            for deep in [0.0, 0.003, 0.1] {
                let at = |x: f64, y: f64| [x, y, slope * x + lift - deep / cos];
                for (from, to) in
                    [((-8.0, 0.0), (8.0, 0.0)), ((0.0, -7.0), (0.0, 7.0)), ((-6.0, -6.0), (5.0, 7.0))]
                {
                    let found = depth(&plate, &cutter, line(at(from.0, from.1), at(to.0, to.1)));
                    let is_right = found.bound_mm >= deep - 1e-9 && found.bound_mm <= deep + 1.1 * GAP;
                    assert!(is_right, "{cutter:?} slope {slope}: {found:?} {deep}");
                }
            }
        }
    }
}

/// A step: level at 0 for x < 0, upright at x = 0, level at 15 beyond.
fn step() -> BezierSurface {
    let profile = [[-20.0, 0.0], [0.0, 0.0], [0.0, 15.0], [20.0, 15.0]];
    BezierSurface::from_fn([3, 1], |i, _| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| {
                let at = |c: usize| profile[i][c] + (profile[i + 1][c] - profile[i][c]) * a as f64 / 3.0;
                Vector3::new(at(0), 10.0 * b as f64 - 15.0, at(1))
            })
        }),
    })
}

#[test]
fn beside_an_upright_wall_a_cutter_is_as_deep_as_it_stands_too_near() {
    for cutter in cutters() {
        let at = |x: f64| line([x, -5.0, 0.0], [x, 5.0, 0.0]);
        for too_near in [0.0, 0.002, 0.4] {
            let found = depth(&step(), &cutter, at(-5.0 + too_near));
            assert!((found.bound_mm - too_near).abs() < 1.1 * GAP, "{cutter:?} {too_near}: {found:?}");
        }
        // A plunge along the wall cuts the floor, and a move that leans into the wall cuts the wall.
        let found = depth(&step(), &cutter, line([-5.0, 0.0, 15.0], [-5.0, 0.0, -0.8]));
        assert!((found.bound_mm - 0.8).abs() < 1.1 * GAP, "{cutter:?}: {found:?}");
        let found = depth(&step(), &cutter, line([-5.0, 0.0, 0.0], [-5.0 + 0.3, 0.0, 15.0]));
        assert!(found.bound_mm > 0.2 && found.bound_mm <= 0.3 + GAP, "{cutter:?}: {found:?}");
    }
}

#[test]
fn a_flat_end_over_an_edge_is_as_deep_as_its_bottom_is_low() {
    let flat = Cutter::bull_nose(5.0, 0.0);
    for x in [-4.999, -1.0, 3.0, 20.0] {
        let found = depth(&step(), &flat, line([x, -3.0, 14.9], [x, 3.0, 14.95]));
        assert!((found.bound_mm - 0.1f64.min(x + 5.0)).abs() < 1.1 * GAP, "{x}: {found:?}");
    }
    assert!(depth(&step(), &flat, line([-5.1, -3.0, 0.0], [-5.1, 3.0, 0.0])).bound_mm < 1e-9);
}

#[test]
fn stock_to_be_left_counts_as_a_larger_cutter() {
    for cutter in cutters() {
        let step = step();
        let proof = GougeProof::new(&step, &cutter, 0.5);
        let depth =
            |from: [f64; 3], to| proof.penetration(&[line(from, to)], GAP, &Budget::unlimited()).unwrap();
        let found = depth([-12.0, 0.0, 0.5], [-5.5, 0.0, 0.5]);
        assert!(found.bound_mm <= GAP, "{cutter:?}: {found:?}");
        let found = depth([-12.0, 0.0, 0.2], [-5.3, 0.0, 0.2]);
        assert!((found.bound_mm - 0.3).abs() < 1.1 * GAP, "{cutter:?}: {found:?}");
    }
}

/// The largest depth in the cutter among a dense grid of surface points, over 61 places of the move.
fn sampled(surface: &BezierSurface, cutter: &Cutter, tip: &Curve) -> f64 {
    let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
    let (n, m) = (80, 60);
    let mut deepest = f64::NEG_INFINITY;
    for k in 0..=m {
        let center = tip.point_at(k as f64 / m as f64) + Vector3::z() * solid.corner;
        for i in 0..=n {
            for j in 0..=n {
                let [u, v] = [i, j].map(|k| 2.0 * k as f64 / n as f64);
                deepest = solid.depth(&(surface.jet(u, v).point - center)).max(deepest);
            }
        }
    }
    deepest
}

/// The largest depth in the cutter that is found by climbing from the surface point `at`, and u and v there.
fn climbed(surface: &BezierSurface, cutter: &Cutter, tip: &Curve, at: &Point3<f64>) -> (f64, [f64; 2]) {
    let solid = Solid { flat: cutter.flat_radius(), corner: cutter.corner_radius() };
    let depth = |[t, u, v]: [f64; 3]| {
        solid.depth(&(surface.jet(u, v).point - tip.point_at(t) - Vector3::z() * solid.corner))
    };
    let nearness = |[_, u, v]: [f64; 3]| -(surface.jet(u, v).point - at).norm();
    let grid = |n: usize| (0..=n).map(move |k| k as f64 / n as f64);
    let places = grid(80).flat_map(|u| grid(80).map(move |v| [0.0, 2.0 * u, 2.0 * v]));
    let by = |f: &dyn Fn([f64; 3]) -> f64, a: &[f64; 3], b: &[f64; 3]| f(*a).total_cmp(&f(*b));
    let [_, u, v] = climb(&nearness, places.max_by(|a, b| by(&nearness, a, b)).unwrap());
    // Near a sharp rim the depth has ridges, at which a single climb ends too early.
    let beside = |x: f64, k: i32| (x + 0.001 * f64::from(k)).clamp(0.0, 2.0);
    let mut starts: Vec<[f64; 3]> = (0..49)
        .map(|k| [beside(u, k % 7 - 3), beside(v, k / 7 - 3)])
        .flat_map(|[u, v]| grid(2000).map(move |t| [t, u, v]))
        .collect();
    starts.sort_by(|a, b| by(&depth, b, a));
    starts.truncate(20);
    let tops = starts.into_iter().map(|start| climb(&depth, start));
    let top = tops.max_by(|a, b| by(&depth, a, b)).unwrap();
    (depth(top), [top[1], top[2]])
}

/// How often the depth of the surface point at u, v may count below a sharp rim: up to sqrt(2) times within a
/// patch. At an end of the surface and at the folds between patches, the surface point that would be deeper
/// may be missing: up to 1 / 0.6 times.
fn most_often([u, v]: [f64; 2]) -> f64 {
    let is_at_end = [u, v].iter().any(|x| (x - x.round()).abs() < 0.002);
    if is_at_end { 1.0 / 0.6 } else { 2f64.sqrt() }
}

/// Climbs by ever shorter steps to a place near `from` where `f` is largest. The first number goes from 0 to
/// 1, the others from 0 to 2.
fn climb(f: &impl Fn([f64; 3]) -> f64, from: [f64; 3]) -> [f64; 3] {
    let (mut best, mut step) = (from, 0.02);
    while step > 1e-9 {
        let around = (0..125).map(|k| {
            let [a, b, c] = [k % 5, k / 5 % 5, k / 25].map(|k| step * (f64::from(k) - 2.0));
            [(best[0] + a).clamp(0.0, 1.0), (best[1] + b).clamp(0.0, 2.0), (best[2] + c).clamp(0.0, 2.0)]
        });
        let next = around.max_by(|a, b| f(*a).total_cmp(&f(*b))).unwrap();
        if f(next) > f(best) { best = next } else { step *= 0.5 }
    }
    best
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn random_moves_are_never_deeper_than_their_bound(
        heights in prop::array::uniform32(-6.0f64..6.0), shift in prop::array::uniform32(-1.5f64..1.5),
        ends in prop::array::uniform8(-9.0f64..9.0), k in 0usize..4, is_arc in any::<bool>(),
    ) {
        let surface = BezierSurface::from_fn([2, 2], |i, j| BicubicPatch {
            net: std::array::from_fn(|a| std::array::from_fn(|b| {
                let (row, column) = (3 * i + a, 3 * j + b);
                let mixed = (row * 7 + column) % 32;
                Vector3::new(3.0 * row as f64 - 9.0 + shift[mixed], 3.0 * column as f64 - 9.0, heights[mixed])
            })),
        });
        let cutter = cutters()[k];
        let (start, end) = (Point3::new(ends[0], ends[1], ends[2]), Point3::new(ends[3], ends[1], ends[5]));
        let center = Point3::new(
            0.5 * (start.x + end.x) + 0.7 * (end.z - start.z), ends[1], 0.5 * (start.z + end.z) - 0.7 * (end.x - start.x),
        );
        let arc = Arc::new(Plane::Zx, if ends[6] > 0.0 { Direction::Cw } else { Direction::Ccw }, start, end, center);
        let tip = match arc {
            Ok(arc) if is_arc => Curve::Arc(arc),
            _ => line(start.coords.into(), [ends[3], ends[4], ends[5]]),
        };
        let sampled = sampled(&surface, &cutter, &tip);
        let found = depth(&surface, &cutter, tip);
        prop_assert!(sampled <= found.bound_mm + 1e-9, "{} {:?}", sampled, found);
        // Deep in the part all directions give nearly the same depth, and the search may reach its limit.
        let often = if cutter.flat_radius() > 0.0 { 2f64.sqrt() } else { 1.0 };
        if found.found_mm <= 0.5 && found.bound_mm > often * found.found_mm + 1.01 * GAP {
            // The search ends as soon as the bound is certain. The deepest point may be beside the one found.
            prop_assert!(cutter.flat_radius() > 0.0, "{:?}", found);
            let (deepest, place) = climbed(&surface, &cutter, &tip, &found.at.unwrap());
            prop_assert!(deepest <= found.bound_mm + 1e-9, "{} {:?}", deepest, found);
            prop_assert!(
                found.bound_mm <= most_often(place) * deepest + 1.01 * GAP, "{} {:?} {:?}", deepest, place, found
            );
        }
    }
}
