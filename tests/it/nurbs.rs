//! NURBS surfaces against another implementation: random rational ones, points and derivatives to second order.

use curvo::prelude::NurbsSurface3D;
use nalgebra::{Point3, Point4, Vector3};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use toolpathd::geometry::surface::Surface;
use toolpathd::geometry::surface::nurbs::Nurbs;

/// A clamped knot vector whose inner knots are given steps apart; a step of zero repeats a knot.
fn knots(degree: usize, steps: &[u8]) -> Vec<f64> {
    let mut knots = vec![0.0; degree + 1];
    let mut knot = 0.0;
    let mut repeated = 0;
    for step in steps {
        repeated = if *step == 0 { repeated + 1 } else { 0 };
        // Often enough that the surface stays twice differentiable, or breaks there but for its position.
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

/// The same surface in the other implementation, which takes points multiplied by their weights.
fn other(nurbs: &Nurbs) -> NurbsSurface3D<f64> {
    let weights = nurbs.weights.as_ref().unwrap();
    let rows = nurbs.control_points.iter().zip(weights);
    let points = rows.map(|(points, weights)| {
        let homogeneous = |(p, w): (&Point3<f64>, &f64)| Point4::new(p.x * w, p.y * w, p.z * w, *w);
        points.iter().zip(weights).map(homogeneous).collect()
    });
    let [u, v] = nurbs.knots.clone();
    NurbsSurface3D::new(nurbs.degree[0], nurbs.degree[1], u, v, points.collect())
}

/// The knot span that holds the share `t` of all spans with a length: its number, the place in it, its start and length.
fn span(knots: &[f64], t: f64) -> (usize, f64, f64, f64) {
    let mut distinct = knots.to_vec();
    distinct.dedup();
    let spans = distinct.len() - 1;
    let k = ((t * spans as f64) as usize).min(spans - 1);
    (k, t * spans as f64 - k as f64, distinct[k], distinct[k + 1] - distinct[k])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, rng_seed: RngSeed::Fixed(7), ..ProptestConfig::default() })]

    #[test]
    fn random_rational_surfaces_agree(nurbs in any_surface(), s in 0.001f64..0.999, t in 0.001f64..0.999) {
        let surface = nurbs.surface().unwrap();
        let (i, a, u0, du) = span(&nurbs.knots[0], s);
        let (j, b, v0, dv) = span(&nurbs.knots[1], t);
        let jet = surface.jet(i as f64 + a, j as f64 + b);
        let expected = other(&nurbs).rational_derivatives(u0 + a * du, v0 + b * dv, 2);
        // By unit of the whole span here, by unit of the knots there.
        let pairs: [(Vector3<f64>, Vector3<f64>); 6] = [
            (jet.point.coords, expected[0][0]),
            (jet.du / du, expected[1][0]),
            (jet.dv / dv, expected[0][1]),
            (jet.duu / (du * du), expected[2][0]),
            (jet.duv / (du * dv), expected[1][1]),
            (jet.dvv / (dv * dv), expected[0][2]),
        ];
        let size = 100.0f64;
        for (k, (ours, theirs)) in pairs.into_iter().enumerate() {
            // A short span magnifies what the parameter itself is rounded by.
            let scale = size.max(theirs.norm()) * [1.0, 1.0 / du, 1.0 / dv, 1.0 / (du * du), 1.0 / (du * dv), 1.0 / (dv * dv)][k].max(1.0);
            let off = (ours - theirs).norm() / scale;
            prop_assert!(off < 1e-12, "derivative {k}: {ours} {theirs}, off by {off:e}");
        }
    }
}
