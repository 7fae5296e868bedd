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

/// The largest bound for a cutter with a flat, as a multiple of the deepest surface point found. The bound
/// covers how far the rim lies below the tangent planes of the surface. Below an endless plane, this is up to
/// sqrt(2) times the depth. Beside an end of the surface, or where the surface bends, it is more. A bound of
/// more than 1 / 0.6 times the depth of the same place gives way to that depth.
const MOST_BELOW: f64 = 1.0 / 0.6;

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
        let most = if cutter.flat_radius() > 0.0 { MOST_BELOW } else { 1.0 } * found.found_mm + 1.01 * GAP;
        prop_assert!(found.found_mm > 0.5 || found.bound_mm <= most, "{:?}", found);
    }
}
