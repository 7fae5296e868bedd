//! What all sweeps share: a drive curve is carried along a basic curve, and each pair of a piece of the basic
//! curve and a piece of the drive curve makes a patch.
//!
//! At its parameter u, the basic curve gives an origin o(u) and three vectors a(u), b(u), c(u). They move the
//! point (x, y, z) of the drive curve to the point o(u) + a(u) x + b(u) y + c(u) z of the surface.
//!
//! On one piece of the basic curve, o, a, b and c are rational Bezier curves of one degree. Their control
//! points o_i, a_i, b_i and c_i share the weight w_i. The drive curve has control points (x_j, y_j, z_j) with
//! the weights v_j. So the patch has the control points o_i + a_i x_j + b_i y_j + c_i z_j with the weights
//! w_i v_j.

use nalgebra::{Point3, Vector3};

use super::any_surface::{AnySurface, PATCH_LIMIT};
use super::patch::raise::raised;
use super::{BezierSurface, RationalPatch};
use crate::geometry::profile::{ControlPoint, Profile};

/// A control point of the basic curve: the origin and the axes for the coordinates of the drive curve there.
#[derive(Debug, Clone, Copy)]
pub(super) struct Station {
    pub(super) origin: Point3<f64>,
    pub(super) axes: [Vector3<f64>; 3],
    pub(super) weight: f64,
}

/// The stations of one piece of the basic curve. Their number is the degree of the piece (at most 3) plus
/// one.
pub(super) type SweepRail = Vec<Station>;

/// The number of patches that the surface would need, above [`PATCH_LIMIT`].
pub(super) struct TooManyPatches(pub(super) usize);

/// The surface with one patch for each pair of a rail and a piece of the drive curve. Both lists have at
/// least one entry.
pub(super) fn surface(rails: &[SweepRail], drive: &Profile<3>) -> Result<AnySurface, TooManyPatches> {
    let drive: Vec<Vec<ControlPoint<3>>> =
        drive.pieces().iter().map(|piece| piece.shape.control_points()).collect();
    let spans = [rails.len(), drive.len()];
    let patches = rails.len().saturating_mul(drive.len());
    if patches > PATCH_LIMIT {
        return Err(TooManyPatches(patches));
    }
    let patch = |i: usize, j: usize| patch(&rails[i], &drive[j]);
    let weights = rails.iter().flatten().map(|s| s.weight).chain(drive.iter().flatten().map(|(_, w)| *w));
    Ok(of_weights(spans, weights, patch))
}

/// The surface of these patches of degree up to 3. It is bicubic if all `weights` are 1, and rational
/// otherwise.
pub(super) fn of_weights(
    spans: [usize; 2],
    mut weights: impl Iterator<Item = f64>,
    patch: impl Fn(usize, usize) -> RationalPatch<4>,
) -> AnySurface {
    if weights.all(|weight| weight == 1.0) {
        AnySurface::Bicubic(BezierSurface::from_fn(spans, |i, j| raised(&patch(i, j))))
    } else {
        AnySurface::Rational(BezierSurface::from_fn(spans, patch))
    }
}

fn patch(rail: &[Station], drive: &[ControlPoint<3>]) -> RationalPatch<4> {
    RationalPatch::from_fn([rail.len() - 1, drive.len() - 1], |a, b| {
        let (Station { origin, axes, weight }, (p, by)) = (&rail[a], &drive[b]);
        let weight = weight * by;
        let point = origin.coords + axes[0] * p.x + axes[1] * p.y + axes[2] * p.z;
        (point * weight).push(weight)
    })
}
