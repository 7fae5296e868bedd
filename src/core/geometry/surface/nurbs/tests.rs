use proptest::prelude::*;

use super::*;
use crate::geometry::surface::Surface;

/// A B-spline basis function by its definition (Cox and de Boor), on half-open spans.
fn basis(knots: &[f64], k: usize, degree: usize, t: f64) -> f64 {
    if degree == 0 {
        return if knots[k] <= t && t < knots[k + 1] { 1.0 } else { 0.0 };
    }
    let part = |above: f64, below: f64, value: f64| if below > 0.0 { above / below * value } else { 0.0 };
    part(t - knots[k], knots[k + degree] - knots[k], basis(knots, k, degree - 1, t))
        + part(
            knots[k + degree + 1] - t,
            knots[k + degree + 1] - knots[k + 1],
            basis(knots, k + 1, degree - 1, t),
        )
}

fn by_definition(nurbs: &Nurbs, t: [f64; 2]) -> Point3<f64> {
    let mut sum = Vector4::zeros();
    for i in 0..nurbs.control_points.len() {
        for j in 0..nurbs.control_points[0].len() {
            let share = basis(&nurbs.knots[0], i, nurbs.degree[0], t[0])
                * basis(&nurbs.knots[1], j, nurbs.degree[1], t[1]);
            sum += nurbs.homogeneous(i, j) * share;
        }
    }
    Point3::from(sum.xyz() / sum.w)
}

/// A knot vector whose steps come from a list. A zero step repeats a knot, so the ends are clamped only if
/// the list makes them so. The first and the last span have a length, so that every control point has an
/// effect.
fn knots(steps: &[u8], degree: usize, points: usize) -> Vec<f64> {
    let mut knot = -1.0;
    let mut run = 0;
    let knots = (0..points + degree + 1).map(|k| {
        let step = f64::from(steps[k % steps.len()] % 4);
        let step = if k == degree + 1 || k == points { step.max(1.0) } else { step };
        run = if step == 0.0 { run + 1 } else { 0 };
        knot += if run >= degree { 1.0 } else { step };
        run = if run >= degree { 0 } else { run };
        knot
    });
    knots.collect()
}

fn any_nurbs() -> impl Strategy<Value = Nurbs> {
    let sizes = (1usize..=7, 1usize..=7, 1usize..5, 1usize..5);
    let steps = prop::collection::vec(0u8..8, 16);
    let entries = prop::collection::vec((-0.4f64..0.4, -0.4f64..0.4, -1.0f64..1.0, 0.2f64..4.0), 144);
    (sizes, steps.clone(), steps, entries, any::<bool>()).prop_map(
        |((p, q, m, n), steps_u, steps_v, entries, is_rational)| {
            let size = [p + m, q + n];
            let grid = |f: &dyn Fn(usize, usize) -> [f64; 4]| -> Vec<Vec<[f64; 4]>> {
                (0..size[0]).map(|i| (0..size[1]).map(|j| f(i, j)).collect()).collect()
            };
            let grid = grid(&|i, j| {
                let (dx, dy, z, w) = entries[i * 12 + j];
                [i as f64 + dx, j as f64 + dy, z, w]
            });
            let map = |row: &Vec<[f64; 4]>| row.iter().map(|[x, y, z, _]| Point3::new(*x, *y, *z)).collect();
            Nurbs {
                degree: [p, q],
                knots: [knots(&steps_u, p, size[0]), knots(&steps_v, q, size[1])],
                control_points: grid.iter().map(map).collect(),
                weights: is_rational
                    .then(|| grid.iter().map(|row| row.iter().map(|entry| entry[3]).collect()).collect()),
            }
        },
    )
}

/// The knot parameter at `t`, where `t` counts the spans that have a length.
fn place(knots: &[f64], degree: usize, points: usize, t: f64) -> f64 {
    let spans: Vec<_> = (degree..points).filter(|&i| knots[i + 1] > knots[i]).collect();
    let k = (t as usize).min(spans.len() - 1);
    knots[spans[k]] + (knots[spans[k] + 1] - knots[spans[k]]) * (t - k as f64)
}

proptest! {
    #[test]
    fn patches_agree_with_the_definition(nurbs in any_nurbs(), s in 0.0f64..0.999, t in 0.0f64..0.999) {
        let surface = match nurbs.surface() {
            Ok(surface) => surface,
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
        };
        let size = [nurbs.control_points.len(), nurbs.control_points[0].len()];
        let [nu, nv] = surface.spans();
        let (u, v) = (s * nu as f64, t * nv as f64);
        let at = [u, v];
        let at = [0, 1].map(|c| place(&nurbs.knots[c], nurbs.degree[c], size[c], at[c]));
        let distance = (surface.jet(u, v).point - by_definition(&nurbs, at)).norm();
        prop_assert!(distance < 1e-12, "{distance}");
    }
}

fn plate(degree: usize, knots: Vec<f64>, points: usize) -> Nurbs {
    let row = |i: usize| (0..2).map(|j| Point3::new(i as f64, j as f64, 0.0)).collect();
    Nurbs {
        degree: [degree, 1],
        knots: [knots, vec![0.0, 0.0, 1.0, 1.0]],
        control_points: (0..points).map(row).collect(),
        weights: None,
    }
}

#[test]
fn equal_weights_of_low_degree_make_bicubic_patches() {
    let mut nurbs = plate(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 3);
    nurbs.weights = Some(vec![vec![2.5; 2]; 3]);
    assert!(matches!(nurbs.surface(), Ok(AnySurface::Bicubic(_))));
    nurbs.weights = Some(vec![vec![2.5, 2.5], vec![2.0, 2.5], vec![2.5, 2.5]]);
    assert!(matches!(nurbs.surface(), Ok(AnySurface::Rational(_))));
}

#[test]
fn joints_are_loose_where_a_knot_has_the_multiplicity_of_the_degree() {
    let nurbs = plate(2, vec![0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 3.0, 3.0, 3.0], 6);
    assert_eq!(nurbs.loose_joints(), [vec![2], vec![]]);
    assert_eq!(nurbs.surface().unwrap().spans(), [3, 1]);
}

#[test]
fn broken_data_are_refused_with_the_place_of_the_fault() {
    let clamped = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let fault = |nurbs: Nurbs| nurbs.surface().map(|_| ()).unwrap_err();
    let degree = fault(plate(8, clamped.clone(), 3));
    assert_eq!(degree, NurbsError::Degree { along: 0, degree: 8 });
    let few = fault(plate(3, clamped.clone(), 3));
    assert_eq!(few, NurbsError::TooFewPoints { along: 0, points: 3, degree: 3 });
    let count = fault(plate(2, vec![0.0; 5], 3));
    assert_eq!(count, NurbsError::KnotCount { along: 0, found: 5, points: 3, degree: 2 });
    let falling = fault(plate(2, vec![0.0, 0.0, 0.0, 1.0, 0.5, 1.0], 3));
    assert_eq!(falling, NurbsError::KnotsDecrease { along: 0, index: 4 });
    assert_eq!(fault(plate(2, vec![0.0; 6], 3)), NurbsError::EmptyDomain { along: 0 });
    let close = fault(plate(2, vec![0.0, 0.0, 0.0, 1e-12, 1.0, 1.0, 1.0], 4));
    assert_eq!(close, NurbsError::SpanTooShort { along: 0, index: 3 });
    let torn = fault(plate(1, vec![0.0, 0.0, 0.5, 0.5, 1.0, 1.0], 4));
    assert_eq!(torn, NurbsError::KnotMultiplicity { along: 0, index: 2, multiplicity: 2, degree: 1 });
    let mut nurbs = plate(2, clamped, 3);
    nurbs.weights = Some(vec![vec![1.0; 2]; 2]);
    assert_eq!(fault(nurbs.clone()), NurbsError::WeightRows { found: 2, expected: 3 });
    nurbs.weights = Some(vec![vec![1.0; 2], vec![1.0; 2], vec![1.0]]);
    assert_eq!(fault(nurbs.clone()), NurbsError::WeightColumns { row: 2, found: 1, expected: 2 });
    nurbs.weights = Some(vec![vec![1.0; 2], vec![1.0, -1.0], vec![1.0; 2]]);
    assert_eq!(fault(nurbs.clone()), NurbsError::Weight { i: 1, j: 1, weight: -1.0 });
    nurbs.weights = Some(vec![vec![1.0; 2], vec![1.0, 1e-7], vec![1.0; 2]]);
    assert_eq!(fault(nurbs.clone()), NurbsError::WeightRatio { i: 1, j: 1, weight: 1e-7, largest: 1.0 });
    nurbs.control_points[1].pop();
    assert_eq!(fault(nurbs.clone()), NurbsError::Ragged { row: 1, found: 1, expected: 2 });
    nurbs.control_points[0][1].x = f64::NAN;
    assert_eq!(fault(nurbs), NurbsError::PointNotFinite { i: 0, j: 1 });
}

#[test]
fn a_control_point_without_effect_is_refused_by_its_place() {
    let fault = |nurbs: Nurbs| nurbs.surface().map(|_| ()).unwrap_err();
    let often = fault(plate(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0], 4));
    assert!(matches!(often, NurbsError::KnotWithoutEffect { along: 0, index: 4, .. }), "{often}");
    let mut along_v = plate(2, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 3);
    along_v.knots[1] = vec![0.0, 0.0, 1.0, 1.0, 1.0];
    for row in &mut along_v.control_points {
        row.push(Point3::new(0.0, 2.0, 0.0));
    }
    let often = fault(along_v);
    assert!(matches!(often, NurbsError::KnotWithoutEffect { along: 1, index: 3, .. }), "{often}");
    let far = plate(4, vec![-1e5, -1e5, -1e5, -1e5, 0.0, 1.0, 2.0, 3.0, 4.0, 5.0], 5);
    assert_eq!(fault(far), NurbsError::PointWithoutEffect { i: 0, j: 0 });
    // 1e-8 by the knots and 1e-6 by the weights.
    let mut far = plate(3, vec![-1e4, -1e4, -1e4, 0.0, 1.0, 2.0, 3.0, 4.0], 4);
    assert!(far.surface().is_ok());
    far.weights = Some(vec![vec![1.0, 1e-6], vec![1.0; 2], vec![1.0; 2], vec![1.0; 2]]);
    assert_eq!(fault(far.clone()), NurbsError::PointWithoutEffect { i: 0, j: 1 });
    far.weights = Some(vec![vec![1e-6; 2]; 4]);
    assert!(far.surface().is_ok());
}
