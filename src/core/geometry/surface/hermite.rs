//! Bicubic patches from points, tangents and twists (mixed second derivatives) at their corners.

use nalgebra::Vector3;

use super::bezier::BezierSurface;
use super::patch::BicubicPatch;

/// The point (mm) and the derivatives (mm per unit of parameter) at a corner.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    pub(super) point: Vector3<f64>,
    pub(super) du: Vector3<f64>,
    pub(super) dv: Vector3<f64>,
    pub(super) duv: Vector3<f64>,
}

/// The surface whose patches have these corners, over a grid of `size` points. Both sizes are at least 2.
pub(super) fn surface(size: [usize; 2], corner: impl Fn(usize, usize) -> Corner) -> BezierSurface {
    BezierSurface::from_fn([size[0] - 1, size[1] - 1], |i, j| {
        patch([[corner(i, j), corner(i, j + 1)], [corner(i + 1, j), corner(i + 1, j + 1)]])
    })
}

/// The Bezier net of the patch with the corners `corners[a][b]`, where a counts along u.
fn patch(corners: [[Corner; 2]; 2]) -> BicubicPatch {
    let inward = [0.0, 1.0 / 3.0, -1.0 / 3.0, 0.0];
    let net = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let corner = corners[a / 2][b / 2];
            let (s, t) = (inward[a], inward[b]);
            corner.point + corner.du * s + corner.dv * t + corner.duv * (s * t)
        })
    });
    BicubicPatch { net }
}
