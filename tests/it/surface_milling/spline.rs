//! The cubic spline surface through a grid of points, computed from the second derivatives at the points,
//! called moments.
//!
//! A dense linear system gives the moments along each direction. The surface needs the moments along u, the
//! moments along v, and the moments along v of the moments along u. No code is shared with the library.

use nalgebra::{DMatrix, Point3, Vector3};
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};

/// Values (0, 1) and moments (2, 3) at the two ends of a cell, along u and along v.
type Cell = [[Vector3<f64>; 4]; 4];

/// `S(u, v)` with u in 0..=rows - 1 and v in 0..=columns - 1.
pub struct Spline {
    size: [usize; 2],
    cells: Vec<Cell>,
}

/// A point of the surface with its derivatives up to the second order.
pub struct Jet {
    pub point: Point3<f64>,
    pub u: Vector3<f64>,
    pub v: Vector3<f64>,
    pub uu: Vector3<f64>,
    pub uv: Vector3<f64>,
    pub vv: Vector3<f64>,
}

/// The tip of a ball cutter that touches the surface at a parameter, with its first derivatives.
pub struct Tip {
    pub point: Point3<f64>,
    pub u: Vector3<f64>,
    pub v: Vector3<f64>,
}

impl Spline {
    pub fn through(grid: &PointGrid) -> Self {
        assert_eq!(grid.twist, Twist::Spline);
        let (rows, columns) = (grid.points.len(), grid.points[0].len());
        let (along_u, along_v) = (moments(rows, &grid.ends), moments(columns, &grid.ends));
        // For each coordinate: values, moments along u, moments along v, moments along both.
        let layers: Vec<[DMatrix<f64>; 4]> = (0..3)
            .map(|k| {
                let values = DMatrix::from_fn(rows, columns, |i, j| grid.points[i][j][k]);
                let u = &along_u * &values;
                let v = &values * along_v.transpose();
                let uv = &u * along_v.transpose();
                [values, u, v, uv]
            })
            .collect();
        let size = [rows - 1, columns - 1];
        let cell = |i: usize, j: usize| {
            std::array::from_fn(|p| {
                std::array::from_fn(|q| {
                    let layer = p / 2 + 2 * (q / 2);
                    let at = (i + p % 2, j + q % 2);
                    Vector3::from_fn(|k, _| layers[k][layer][at])
                })
            })
        };
        let cells = (0..size[0]).flat_map(|i| (0..size[1]).map(move |j| (i, j))).map(|(i, j)| cell(i, j));
        Self { size, cells: cells.collect() }
    }

    /// The largest values of u and v.
    pub fn size(&self) -> [f64; 2] {
        self.size.map(|n| n as f64)
    }

    pub fn jet(&self, at: [f64; 2]) -> Jet {
        let [i, j] = std::array::from_fn(|k| (at[k].max(0.0) as usize).min(self.size[k] - 1));
        let cell = &self.cells[i * self.size[1] + j];
        let (a, b) = (weights(at[0] - i as f64), weights(at[1] - j as f64));
        let mut sums = [[Vector3::zeros(); 4]; 3];
        for (order, sum) in sums.iter_mut().enumerate() {
            for (q, part) in sum.iter_mut().enumerate() {
                *part = (0..4).fold(Vector3::zeros(), |s, p| s + cell[p][q] * a[order][p]);
            }
        }
        let take = |ou: usize, ov: usize| (0..4).fold(Vector3::zeros(), |s, q| s + sums[ou][q] * b[ov][q]);
        Jet {
            point: take(0, 0).into(),
            u: take(1, 0),
            v: take(0, 1),
            uu: take(2, 0),
            uv: take(1, 1),
            vv: take(0, 2),
        }
    }

    /// The tip of a ball cutter of `radius` (mm) that touches the surface from above at the parameters `at`.
    pub fn tip(&self, at: [f64; 2], radius: f64) -> Tip {
        let jet = self.jet(at);
        let across = jet.u.cross(&jet.v);
        let length = across.norm().copysign(across.z);
        let normal = across / length;
        let turned = |change: Vector3<f64>| (change - normal * normal.dot(&change)) * (radius / length);
        Tip {
            point: jet.point + (normal - Vector3::z()) * radius,
            u: jet.u + turned(jet.uu.cross(&jet.v) + jet.u.cross(&jet.uv)),
            v: jet.v + turned(jet.uv.cross(&jet.v) + jet.u.cross(&jet.vv)),
        }
    }
}

impl Jet {
    /// The largest principal curvature, 1/mm; positive where the surface is concave from above.
    pub fn hollow(&self) -> f64 {
        let across = self.u.cross(&self.v);
        let normal = across / across.norm().copysign(across.z);
        let (e, f, g) = (self.u.norm_squared(), self.u.dot(&self.v), self.v.norm_squared());
        let (l, m, n) = (normal.dot(&self.uu), normal.dot(&self.uv), normal.dot(&self.vv));
        let area = e * g - f * f;
        let mean = (e * n - 2.0 * f * m + g * l) / (2.0 * area);
        let product = (l * n - m * m) / area;
        mean + (mean * mean - product).max(0.0).sqrt()
    }
}

/// Weights of the values and moments at the ends of a unit interval, for the value and its first two
/// derivatives.
fn weights(s: f64) -> [[f64; 4]; 3] {
    let r = 1.0 - s;
    [
        [r, s, (r * r * r - r) / 6.0, (s * s * s - s) / 6.0],
        [-1.0, 1.0, (1.0 - 3.0 * r * r) / 6.0, (3.0 * s * s - 1.0) / 6.0],
        [0.0, 0.0, r, s],
    ]
}

/// The matrix that turns `n` values at distance one into their moments.
fn moments(n: usize, ends: &Ends) -> DMatrix<f64> {
    assert!(n >= 4);
    let mut left = DMatrix::zeros(n, n);
    let mut right = DMatrix::zeros(n, n);
    for i in 1..n - 1 {
        for (k, (l, r)) in [(1.0, 6.0), (4.0, -12.0), (1.0, 6.0)].into_iter().enumerate() {
            left[(i, i + k - 1)] = l;
            right[(i, i + k - 1)] = r;
        }
    }
    let end: &[f64] = match ends {
        Ends::Natural => &[1.0],
        // The third derivative does not change at the second knot: M0 - 2 M1 + M2 = 0.
        Ends::NotAKnot => &[1.0, -2.0, 1.0],
        other => panic!("{other:?}"),
    };
    for (k, &weight) in end.iter().enumerate() {
        left[(0, k)] = weight;
        left[(n - 1, n - 1 - k)] = weight;
    }
    left.lu().solve(&right).unwrap()
}

fn grid(n: [usize; 2], ends: Ends, at: impl Fn(f64, f64) -> Point3<f64>) -> PointGrid {
    let row = |i: usize| (0..n[1]).map(|j| at(i as f64, j as f64)).collect();
    PointGrid { points: (0..n[0]).map(row).collect(), twist: Twist::Spline, ends }
}

#[test]
fn the_spline_passes_through_its_points_and_is_twice_differentiable() {
    let bumps = |u: f64, v: f64| Point3::new(2.0 * u + (v * 1.3).sin(), v - 0.2 * u, (u * v).cos());
    for ends in [Ends::Natural, Ends::NotAKnot] {
        let grid = grid([6, 4], ends.clone(), bumps);
        let spline = Spline::through(&grid);
        for (i, row) in grid.points.iter().enumerate() {
            for (j, point) in row.iter().enumerate() {
                assert!((spline.jet([i as f64, j as f64]).point - point).norm() < 1e-12);
            }
        }
        for i in 1..5 {
            let [before, after] = [-1e-9, 1e-9].map(|e| spline.jet([f64::from(i) + e, 1.4]));
            for (a, b) in [(before.u, after.u), (before.uu, after.uu), (before.uv, after.uv)] {
                assert!((a - b).norm() < 1e-6, "a derivative jumps at u = {i}: {a} {b}");
            }
        }
        if ends == Ends::Natural {
            assert!(spline.jet([0.0, 1.7]).uu.norm() < 1e-12 && spline.jet([2.2, 3.0]).vv.norm() < 1e-12);
        }
    }
}

#[test]
fn not_a_knot_reproduces_bicubic_polynomials_with_their_derivatives() {
    let f = |u: f64, v: f64| (u * u * u - 4.0 * u * u + u) * (0.5 - v + 0.3 * v * v - 0.2 * v * v * v);
    let spline = Spline::through(&grid([5, 4], Ends::NotAKnot, |u, v| Point3::new(u, v, f(u, v))));
    for k in 0..200 {
        let (u, v) = (4.0 * f64::from(k % 20) / 19.0, 3.0 * f64::from(k / 20) / 9.0);
        let jet = spline.jet([u, v]);
        let (a, da) = (u * u * u - 4.0 * u * u + u, 3.0 * u * u - 8.0 * u + 1.0);
        let (b, db) = (0.5 - v + 0.3 * v * v - 0.2 * v * v * v, -1.0 + 0.6 * v - 0.6 * v * v);
        let expected = [a * b, da * b, a * db, (6.0 * u - 8.0) * b, da * db, a * (0.6 - 1.2 * v)];
        let found = [jet.point.z, jet.u.z, jet.v.z, jet.uu.z, jet.uv.z, jet.vv.z];
        for (e, f) in expected.into_iter().zip(found) {
            assert!((e - f).abs() < 1e-11, "at {u}, {v}: expected {expected:?}, found {found:?}");
        }
    }
}

#[test]
fn the_derivatives_of_the_tip_equal_its_finite_differences() {
    let spline = Spline::through(&grid([4, 5], Ends::Natural, |u, v| Point3::new(u, v, (u + v * v).sin())));
    for at in [[0.3, 0.4], [1.7, 2.2], [2.9, 3.9]] {
        let tip = spline.tip(at, 0.3);
        let h = 1e-6;
        let du = spline.tip([at[0] + h, at[1]], 0.3).point - spline.tip([at[0] - h, at[1]], 0.3).point;
        let dv = spline.tip([at[0], at[1] + h], 0.3).point - spline.tip([at[0], at[1] - h], 0.3).point;
        assert!((du / (2.0 * h) - tip.u).norm() < 1e-7 && (dv / (2.0 * h) - tip.v).norm() < 1e-7);
    }
}

#[test]
fn the_hollow_of_a_saddle_is_its_largest_principal_curvature() {
    let spline = Spline::through(&grid([4, 4], Ends::NotAKnot, |u, v| {
        Point3::new(u - 1.0, 1.0 - v, 0.4 * (u - 1.0) * (u - 1.0) - (v - 1.0) * (v - 1.0))
    }));
    assert!((spline.jet([1.0, 1.0]).hollow() - 0.8).abs() < 1e-12);
    // Along y = 0 the curvature is 0.8 / (1 + (0.8 x)^2)^1.5.
    assert!((spline.jet([2.0, 1.0]).hollow() - 0.8 / 1.64f64.powf(1.5)).abs() < 1e-12);
}
