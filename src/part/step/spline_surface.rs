//! B-spline surfaces: their points, and the parameters of a point.

use nalgebra::{Matrix2, Point3, Vector2, Vector3, Vector4};
use toolpathd_core::geometry::surface::nurbs::Nurbs;

use super::basis::{breaks, functions, span};

/// Steps of the search for the nearest point. It squares the error at each step near a point of the surface.
const STEPS: usize = 40;

/// The search ends with a step of at most this part of the domain.
const LAST_STEP: f64 = 1e-10;

/// A valid B-spline surface, with what is asked of it often.
#[derive(Debug, Clone, PartialEq)]
pub struct SplineSurface {
    pub nurbs: Nurbs,
    /// Whether the two ends along u and along v meet.
    pub is_closed: [bool; 2],
}

impl SplineSurface {
    /// A surface of valid knots. It is closed where the control points of its ends meet within 1e-7 of the
    /// size.
    pub fn new(nurbs: Nurbs) -> Self {
        let mut surface = Self { nurbs, is_closed: [false; 2] };
        surface.is_closed = [0, 1].map(|along| {
            let [from, to] = surface.domain()[along];
            let other = surface.breaks(1 - along);
            let samples = other
                .windows(2)
                .flat_map(|pair| [0.0, 0.37, 0.71].map(|s| pair[0] + s * (pair[1] - pair[0])));
            let at = |t: f64, s: f64| if along == 0 { [t, s] } else { [s, t] };
            let gap = |s: f64| (surface.jet(at(to, s)).0 - surface.jet(at(from, s)).0).norm();
            samples.map(gap).fold(0.0, f64::max) <= 1e-7 * surface.size()
        });
        surface
    }

    /// The first and the last parameter along u and v.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        let counts = [self.nurbs.control_points.len(), self.nurbs.control_points[0].len()];
        [0, 1].map(|k| [self.nurbs.knots[k][self.nurbs.degree[k]], self.nurbs.knots[k][counts[k]]])
    }

    /// The diagonal of the box of the control points, mm.
    pub fn size(&self) -> f64 {
        let points = self.nurbs.control_points.iter().flatten();
        let (low, high) = points
            .fold((Vector3::repeat(f64::MAX), Vector3::repeat(f64::MIN)), |(low, high), p| {
                (low.inf(&p.coords), high.sup(&p.coords))
            });
        (high - low).norm()
    }

    /// The distinct knots of the domain along u (0) or v (1).
    pub fn breaks(&self, along: usize) -> Vec<f64> {
        breaks(self.nurbs.degree[along], &self.nurbs.knots[along])
    }

    /// The control point times its weight, followed by the weight.
    pub fn lifted(&self, i: usize, j: usize) -> Vector4<f64> {
        let weight = self.nurbs.weights.as_ref().map_or(1.0, |weights| weights[i][j]);
        (self.nurbs.control_points[i][j].coords * weight).push(weight)
    }

    /// The parameter of the domain that stands for `t`: taken round if closed, else the nearer end.
    fn inside(&self, along: usize, t: f64) -> f64 {
        let [from, to] = self.domain()[along];
        if (from..=to).contains(&t) {
            t
        } else if self.is_closed[along] {
            from + (t - from).rem_euclid(to - from).min(to - from)
        } else {
            t.clamp(from, to)
        }
    }

    /// The point (mm) and the derivatives along u and v (mm per unit of parameter).
    pub fn jet(&self, at: [f64; 2]) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        let Nurbs { degree, knots, .. } = &self.nurbs;
        let at = [0, 1].map(|k| self.inside(k, at[k]));
        let spans = [0, 1].map(|k| span(degree[k], &knots[k], at[k]));
        let (u, du) = functions(degree[0], &knots[0], spans[0], at[0]);
        let (v, dv) = functions(degree[1], &knots[1], spans[1], at[1]);
        let mut sums = [Vector4::zeros(); 3];
        for a in 0..=degree[0] {
            let (mut row, mut slope) = (Vector4::zeros(), Vector4::zeros());
            for b in 0..=degree[1] {
                let point = self.lifted(spans[0] - degree[0] + a, spans[1] - degree[1] + b);
                row += point * v[b];
                slope += point * dv[b];
            }
            sums[0] += row * u[a];
            sums[1] += row * du[a];
            sums[2] += slope * u[a];
        }
        let [value, along_u, along_v] = sums;
        let point = value.xyz() / value.w;
        let derivative = |d: Vector4<f64>| (d.xyz() - point * d.w) / value.w;
        (Point3::from(point), derivative(along_u), derivative(along_v))
    }

    /// Parameters with their points, from which searches start: several in each span.
    pub fn seeds(&self) -> Vec<([f64; 2], Point3<f64>)> {
        let [us, vs] = [0, 1].map(|along| -> Vec<f64> {
            let breaks = self.breaks(along);
            let n = if self.nurbs.degree[along] == 1 { 1 } else { 3 };
            let inner = breaks.windows(2).flat_map(|pair| {
                (0..n).map(move |k| pair[0] + (pair[1] - pair[0]) * f64::from(k) / f64::from(n))
            });
            inner.chain(breaks.last().copied()).collect()
        });
        us.iter().flat_map(|u| vs.iter().map(|v| ([*u, *v], self.jet([*u, *v]).0))).collect()
    }

    /// Parameters of a point near `start` where the surface is nearest to `point`, with the distance, mm.
    pub fn descend(&self, point: &Point3<f64>, start: [f64; 2]) -> ([f64; 2], f64) {
        let domain = self.domain();
        let mut at = [0, 1].map(|k| self.inside(k, start[k]));
        let (mut here, mut du, mut dv) = self.jet(at);
        for _ in 0..STEPS {
            let miss = point - here;
            let step = newton_step(&du, &dv, &miss);
            let parts = [0, 1].map(|k| step[k].abs() / (domain[k][1] - domain[k][0]));
            if parts.iter().all(|part| *part <= LAST_STEP) {
                // The error after this step is far below rounding.
                at = [0, 1].map(|k| self.inside(k, at[k] + step[k]));
                here = self.jet(at).0;
                break;
            }
            let mut share = 1.0;
            let next = loop {
                let next = [0, 1].map(|k| self.inside(k, at[k] + step[k] * share));
                let jet = self.jet(next);
                if (point - jet.0).norm_squared() <= miss.norm_squared() || share < 1e-4 {
                    break (next, jet);
                }
                share *= 0.5;
            };
            let is_stuck = next.0 == at;
            if (point - next.1.0).norm_squared() > miss.norm_squared() {
                break;
            }
            at = next.0;
            (here, du, dv) = next.1;
            if is_stuck {
                break;
            }
        }
        (at, (point - here).norm())
    }
}

/// The step of parameters that brings the tangent plane's point nearest to `miss`. Where the derivatives are
/// dependent, as at a pole, the longer of them alone counts.
pub fn newton_step(du: &Vector3<f64>, dv: &Vector3<f64>, miss: &Vector3<f64>) -> [f64; 2] {
    let normal = Matrix2::new(du.norm_squared(), du.dot(dv), du.dot(dv), dv.norm_squared());
    let right = Vector2::new(du.dot(miss), dv.dot(miss));
    let is_regular = normal.determinant() > 1e-14 * normal[(0, 0)] * normal[(1, 1)];
    match normal.try_inverse().filter(|_| is_regular) {
        Some(inverse) => (inverse * right).into(),
        None if normal[(0, 0)] > normal[(1, 1)] => [right.x / normal[(0, 0)], 0.0],
        None if normal[(1, 1)] > 0.0 => [0.0, right.y / normal[(1, 1)]],
        None => [0.0, 0.0],
    }
}
