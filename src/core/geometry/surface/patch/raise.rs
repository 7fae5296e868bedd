//! Turns polynomial patches of degree up to 3 into bicubic patches. The surface stays the same, up to
//! rounding.

use nalgebra::Vector4;

use super::{BicubicPatch, RationalPatch};

/// A polynomial patch of degree up to 3 with equal weights, with its degree raised to 3 each way.
pub fn raised(patch: &RationalPatch<4>) -> BicubicPatch {
    /// Matrices by degree; rows are the cubic control points, columns the control points of the lower degree.
    const RAISES: [[[f64; 4]; 4]; 3] = {
        const T: f64 = 1.0 / 3.0;
        [
            [[1.0, 0.0, 0.0, 0.0], [2.0 * T, T, 0.0, 0.0], [T, 2.0 * T, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0]],
            [[1.0, 0.0, 0.0, 0.0], [T, 2.0 * T, 0.0, 0.0], [0.0, 2.0 * T, T, 0.0], [0.0, 0.0, 1.0, 0.0]],
            [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]],
        ]
    };
    let [p, q] = patch.degree();
    let net = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let mut sum = Vector4::zeros();
            for (k, by_u) in RAISES[p - 1][a].iter().enumerate().take(p + 1) {
                for (l, by_v) in RAISES[q - 1][b].iter().enumerate().take(q + 1) {
                    sum += patch.homogeneous(k, l) * (by_u * by_v);
                }
            }
            sum.xyz() / sum.w
        })
    });
    BicubicPatch { net }
}
