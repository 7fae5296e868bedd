//! Uniform bicubic B-splines over the unit cells of a grid, and the roughness of a cell.

/// The control points along u and v that act on a cell.
pub const WIDTH: usize = 4;

/// Entries of the matrix of a cell: the pairs of its 16 control points.
pub type CellMatrix = [[f64; 16]; 16];

/// A grid of cells. Cell (i, j) covers the parameters i..=i+1, j..=j+1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Net {
    pub cells: [usize; 2],
}

impl Net {
    /// Numbers of control points along u and v.
    pub fn size(&self) -> [usize; 2] {
        self.cells.map(|n| n + WIDTH - 1)
    }

    pub fn n_control_points(&self) -> usize {
        self.size().iter().product()
    }
}

/// The four basis functions of a cell at `t` from 0 to 1.
pub fn basis(t: f64) -> [f64; WIDTH] {
    let s = 1.0 - t;
    let inner = |t: f64| (t * t * (3.0 * t - 6.0) + 4.0) / 6.0;
    [s * s * s / 6.0, inner(t), inner(s), t * t * t / 6.0]
}

/// Their first derivatives.
fn slopes(t: f64) -> [f64; WIDTH] {
    let s = 1.0 - t;
    let inner = |t: f64| t * (1.5 * t - 2.0);
    [-0.5 * s * s, inner(t), -inner(s), 0.5 * t * t]
}

/// Their second derivatives.
fn bends(t: f64) -> [f64; WIDTH] {
    let s = 1.0 - t;
    [s, 3.0 * t - 2.0, 3.0 * s - 2.0, t]
}

/// The integral over a cell with sides `steps` of s_xx^2 + 2 s_xy^2 + s_yy^2, as a quadratic form of the
/// control points; entry a * 4 + b belongs to control point a along u and b along v. The energy of a thin
/// plate is the sum over all cells.
pub fn roughness([hu, hv]: [f64; 2]) -> CellMatrix {
    let [values, slopes, bends] = [gram(basis), gram(slopes), gram(bends)];
    let area = hu * hv;
    let (uu, uv, vv) = (area / hu.powi(4), 2.0 * area / (hu * hv).powi(2), area / hv.powi(4));
    let mut matrix = [[0.0; 16]; 16];
    for (k, row) in matrix.iter_mut().enumerate() {
        for (l, entry) in row.iter_mut().enumerate() {
            let [a, b, c, d] = [k / WIDTH, k % WIDTH, l / WIDTH, l % WIDTH];
            *entry = uu * bends[a][c] * values[b][d]
                + uv * slopes[a][c] * slopes[b][d]
                + vv * values[a][c] * bends[b][d];
        }
    }
    matrix
}

/// The integrals of the products of functions from 0 to 1, by Gauss's rule of four points, which is exact for
/// these products.
fn gram(functions: impl Fn(f64) -> [f64; WIDTH]) -> [[f64; WIDTH]; WIDTH] {
    let root = (6.0f64 / 5.0).sqrt();
    let (near, far) = ((3.0 - 2.0 * root) / 7.0, (3.0 + 2.0 * root) / 7.0);
    let thirty = 30.0f64.sqrt();
    let (heavy, light) = ((18.0 + thirty) / 72.0, (18.0 - thirty) / 72.0);
    let mut gram = [[0.0; WIDTH]; WIDTH];
    for (square, weight) in [(near, heavy), (far, light)] {
        for place in [0.5 - 0.5 * f64::sqrt(square), 0.5 + 0.5 * f64::sqrt(square)] {
            let values = functions(place);
            for a in 0..WIDTH {
                (0..WIDTH).for_each(|b| gram[a][b] += weight * values[a] * values[b]);
            }
        }
    }
    gram
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_basis_sums_to_one_and_its_derivatives_are_its_differences() {
        for t in [0.0, 0.3, 0.77, 1.0] {
            assert!((basis(t).iter().sum::<f64>() - 1.0).abs() < 1e-15);
            // The control points k - 1 make the line t.
            let line: f64 = basis(t).iter().enumerate().map(|(k, b)| (k as f64 - 1.0) * b).sum();
            assert!((line - t).abs() < 1e-15);
            for k in 0..WIDTH {
                let step = 1e-5;
                let slope = (basis(t + step)[k] - basis(t - step)[k]) / (2.0 * step);
                assert!((slope - slopes(t)[k]).abs() < 1e-9, "{t} {k}");
                let bend = (slopes(t + step)[k] - slopes(t - step)[k]) / (2.0 * step);
                assert!((bend - bends(t)[k]).abs() < 1e-9, "{t} {k}");
            }
        }
    }

    /// The control points of u^2, u v and v^2 on a cell: polar forms at the knots.
    #[test]
    fn the_roughness_of_quadratic_heights_is_their_integral() {
        let steps = [0.5, 0.2];
        let energy = |value: &dyn Fn(f64, f64) -> f64| {
            let matrix = roughness(steps);
            let net: Vec<f64> = (0..16).map(|k| value((k / 4) as f64 - 1.0, (k % 4) as f64 - 1.0)).collect();
            let rows = matrix.iter().zip(&net);
            rows.map(|(row, x)| x * row.iter().zip(&net).map(|(m, y)| m * y).sum::<f64>()).sum::<f64>()
        };
        // u^2 has the control points k^2 - 1/3. x = 0.5 u and y = 0.2 v.
        let x_squared = |a: f64, _: f64| 0.25 * (a * a - 1.0 / 3.0);
        let y_squared = |_: f64, b: f64| 0.04 * (b * b - 1.0 / 3.0);
        let twist = |a: f64, b: f64| 0.1 * a * b;
        let area = 0.1;
        assert!((energy(&x_squared) - 4.0 * area).abs() < 1e-12);
        assert!((energy(&y_squared) - 4.0 * area).abs() < 1e-12);
        assert!((energy(&twist) - 2.0 * area).abs() < 1e-12);
        assert!(energy(&|a, b| 3.0 - 2.0 * a + 5.0 * b).abs() < 1e-9);
    }
}
