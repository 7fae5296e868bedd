//! Compares random rational NURBS surfaces with their definition: points, first and second derivatives.
//!
//! The definition is the recursion of Cox and de Boor. The product rule carries the first two derivatives of
//! each basis function through the recursion. A point is the sum over all control points, divided by the sum
//! of the weights; the quotient rule gives its derivatives.

use nalgebra::{Point3, Vector3, Vector4};
use proptest::prelude::*;
use toolpathd_core::geometry::surface::Surface;
use toolpathd_core::geometry::surface::nurbs::Nurbs;

/// A clamped knot vector whose inner knots are given steps apart; a step of zero repeats a knot.
fn knots(degree: usize, steps: &[u8]) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    let mut knot = 0.0;
    let mut repeated = 0;
    for step in steps {
        repeated = if *step == 0 { repeated + 1 } else { 0 };
        // A knot repeats at most `degree` times, so that the surface is continuous everywhere.
        knot += if repeated >= degree { 1.0 } else { 0.25 * f64::from(*step) };
        if knot == 0.0 {
            knot = 1.0;
        }
        knots.push(knot);
    }
    knots.extend(vec![knot + 1.0; degree + 1]);
    knots
}

fn any_surface() -> impl Strategy<Value = Nurbs> {
    let inner = || prop::collection::vec(0u8..5, 0..4);
    let entries = prop::collection::vec((-0.4f64..0.4, -0.4f64..0.4, -1.0f64..1.0, 0.2f64..4.0), 144);
    (1usize..=7, 1usize..=7, inner(), inner(), entries).prop_map(|(p, q, steps_u, steps_v, entries)| {
        let size = [p + 1 + steps_u.len(), q + 1 + steps_v.len()];
        let entry = |i: usize, j: usize| entries[i * 12 + j];
        let point = |i: usize, j: usize| {
            let (dx, dy, z, _) = entry(i, j);
            Point3::new(10.0 * (i as f64 + dx), 10.0 * (j as f64 + dy), 10.0 * z)
        };
        Nurbs {
            degree: [p, q],
            knots: [knots(p, &steps_u), knots(q, &steps_v)],
            control_points: (0..size[0]).map(|i| (0..size[1]).map(|j| point(i, j)).collect()).collect(),
            weights: Some((0..size[0]).map(|i| (0..size[1]).map(|j| entry(i, j).3).collect()).collect()),
        }
    })
}

/// A value with its first and second derivative.
type Jet = [f64; 3];

/// The basis function number `i` of a degree at the parameter `u`, with its derivatives. The knot interval
/// number `interval` holds `u`.
fn basis(knots: &[f64], degree: usize, i: usize, interval: usize, u: f64) -> Jet {
    if degree == 0 {
        return [f64::from(i == interval), 0.0, 0.0];
    }
    // If the two knots coincide, the basis function of the lower degree is zero, and so is its term.
    let term = |zero: f64, one: f64, below: usize| {
        if zero == one {
            return [0.0; 3];
        }
        let (factor, slope) = ((u - zero) / (one - zero), 1.0 / (one - zero));
        let [n, dn, ddn] = basis(knots, degree - 1, below, interval, u);
        [factor * n, slope * n + factor * dn, 2.0 * slope * dn + factor * ddn]
    };
    let rising = term(knots[i], knots[i + degree], i);
    let falling = term(knots[i + degree + 1], knots[i + 1], i + 1);
    [0, 1, 2].map(|k| rising[k] + falling[k])
}

/// The point of a surface and its derivatives, by orders in u and v: (0, 0), (1, 0), (0, 1), (2, 0), (1, 1),
/// (0, 2).
fn by_definition(nurbs: &Nurbs, [u, v]: [f64; 2]) -> [Vector3<f64>; 6] {
    let weights = nurbs.weights.as_ref().unwrap();
    let along = |k: usize, at: f64| -> Vec<Jet> {
        let (knots, degree) = (&nurbs.knots[k], nurbs.degree[k]);
        let interval = knots.iter().rposition(|knot| *knot <= at).unwrap();
        (0..knots.len() - degree - 1).map(|i| basis(knots, degree, i, interval, at)).collect()
    };
    let (in_u, in_v) = (along(0, u), along(1, v));
    let homogeneous = |du: usize, dv: usize| {
        let mut sum = Vector4::zeros();
        for (i, row) in nurbs.control_points.iter().enumerate() {
            for (j, p) in row.iter().enumerate() {
                sum += Vector4::new(p.x, p.y, p.z, 1.0) * (weights[i][j] * in_u[i][du] * in_v[j][dv]);
            }
        }
        (sum.xyz(), sum.w)
    };
    let [(a, w), (au, wu), (av, wv), (auu, wuu), (auv, wuv), (avv, wvv)] =
        [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)].map(|(du, dv)| homogeneous(du, dv));
    let s = a / w;
    let (su, sv) = ((au - s * wu) / w, (av - s * wv) / w);
    let suu = (auu - su * (2.0 * wu) - s * wuu) / w;
    let suv = (auv - su * wv - sv * wu - s * wuv) / w;
    let svv = (avv - sv * (2.0 * wv) - s * wvv) / w;
    [s, su, sv, suu, suv, svv]
}

/// The knot span at the share `t` (0 to 1) of all spans that have a length. Returns its number, the place in
/// it (0 to 1), its start and its length.
fn span(knots: &[f64], t: f64) -> (usize, f64, f64, f64) {
    let mut distinct = knots.to_vec();
    distinct.dedup();
    let spans = distinct.len() - 1;
    let k = ((t * spans as f64) as usize).min(spans - 1);
    (k, t * spans as f64 - k as f64, distinct[k], distinct[k + 1] - distinct[k])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(500))]

    #[test]
    fn nurbs_surfaces_have_the_points_and_derivatives_of_their_definition(
        nurbs in any_surface(), s in 0.001f64..0.999, t in 0.001f64..0.999,
    ) {
        let surface = nurbs.surface().unwrap();
        let (i, a, u0, du) = span(&nurbs.knots[0], s);
        let (j, b, v0, dv) = span(&nurbs.knots[1], t);
        let jet = surface.jet(i as f64 + a, j as f64 + b);
        let expected = by_definition(&nurbs, [u0 + a * du, v0 + b * dv]);
        // The surface counts its parameters in knot spans, the definition in knots.
        let steps = [1.0, du, dv, du * du, du * dv, dv * dv];
        let found = [jet.point.coords, jet.du, jet.dv, jet.duu, jet.duv, jet.dvv];
        let size = 100.0f64;
        for k in 0..6 {
            let (found, expected) = (found[k] / steps[k], expected[k]);
            // A short span magnifies the rounding of the parameter.
            let scale = size.max(expected.norm()) * (1.0 / steps[k]).max(1.0);
            let off = (found - expected).norm() / scale;
            prop_assert!(off < 1e-12, "derivative {k}: {found}, expected {expected}, relative error {off:e}");
        }
    }
}
