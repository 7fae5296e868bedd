//! Surfaces as the file states them: their points, and how their parameters close.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Point3, Vector3};

use super::curve::Curve;
use super::frame::{Frame, Placement};
use super::spline_surface::SplineSurface;

/// A point of a curve of revolution lies on the axis within this distance, mm. Kernels round to 1e-7 mm or
/// better.
const ON_AXIS_MM: f64 = 1e-6;

/// A surface with the parameters u and v of ISO 10303-42. Angles are radians, other parameters mm. The normal
/// is the derivative along u times the derivative along v.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// `origin + u x + v y`.
    Plane {
        frame: Frame,
    },
    /// `origin + radius (cos u x + sin u y) + v z`.
    Cylinder {
        frame: Frame,
        radius_mm: f64,
    },
    /// `origin + (radius + v tan a) (cos u x + sin u y) + v z`, with half the angle at the apex a.
    Cone {
        frame: Frame,
        radius_mm: f64,
        half_angle_rad: f64,
    },
    /// `origin + radius (cos v (cos u x + sin u y) + sin v z)`.
    Sphere {
        frame: Frame,
        radius_mm: f64,
    },
    /// `origin + (major + minor cos v) (cos u x + sin u y) + minor sin v z`. A torus whose minor radius is
    /// the larger one cuts itself: `is_inner` tells which part is meant.
    Torus {
        frame: Frame,
        major_radius_mm: f64,
        minor_radius_mm: f64,
        is_inner: bool,
    },
    /// `curve(u) + v along`, with `along` of unit length.
    Extrusion {
        curve: Curve,
        along: Vector3<f64>,
    },
    /// `curve(v)`, turned by u about z of the frame. The file may state the range of v.
    Revolution {
        curve: Curve,
        frame: Frame,
        range: Option<[f64; 2]>,
    },
    Spline(SplineSurface),
}

/// A side of the parameters that is one point: the parameter `along` (0 for u, 1 for v) has the value `at`
/// there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PolarSide {
    pub along: usize,
    pub at: f64,
    pub point: Point3<f64>,
}

impl Surface {
    /// The kind in one word.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::Extrusion { .. } => "extrusion",
            Self::Revolution { .. } => "revolution",
            Self::Spline(_) => "spline",
        }
    }

    /// The point (mm) and the derivatives along u and v (mm per unit of parameter).
    pub fn jet(&self, [u, v]: [f64; 2]) -> (Point3<f64>, Vector3<f64>, Vector3<f64>) {
        // A circle of radius r at height h about z, with the changes of r and h along v.
        let round = |frame: &Frame, [r, h]: [f64; 2], [dr, dh]: [f64; 2]| {
            let (out, along) = (frame.radial(u), frame.radial(u + FRAC_PI_2));
            (frame.origin + out * r + frame.z * h, along * r, out * dr + frame.z * dh)
        };
        match self {
            Self::Plane { frame } => (frame.origin + frame.x * u + frame.y * v, frame.x, frame.y),
            Self::Cylinder { frame, radius_mm } => round(frame, [*radius_mm, v], [0.0, 1.0]),
            Self::Cone { frame, radius_mm, half_angle_rad } => {
                let slope = half_angle_rad.tan();
                round(frame, [radius_mm + v * slope, v], [slope, 1.0])
            }
            Self::Sphere { frame, radius_mm: r } => {
                let (sin, cos) = v.sin_cos();
                round(frame, [r * cos, r * sin], [-r * sin, r * cos])
            }
            Self::Torus { frame, major_radius_mm, minor_radius_mm: r, .. } => {
                let (sin, cos) = v.sin_cos();
                round(frame, [major_radius_mm + r * cos, r * sin], [-r * sin, r * cos])
            }
            Self::Extrusion { curve, along } => {
                let (point, slope) = curve.jet(u);
                (point + along * v, slope, *along)
            }
            Self::Revolution { curve, frame, .. } => {
                let (point, slope) = curve.jet(v);
                let (sin, cos) = u.sin_cos();
                let turn = |w: Vector3<f64>| Vector3::new(cos * w.x - sin * w.y, sin * w.x + cos * w.y, w.z);
                let at = turn(frame.local(&point));
                let slope = turn(frame.local(&(frame.origin + slope)));
                (frame.point(&at), frame.vector(&Vector3::new(-at.y, at.x, 0.0)), frame.vector(&slope))
            }
            Self::Spline(spline) => spline.jet([u, v]),
        }
    }

    pub fn point(&self, at: [f64; 2]) -> Point3<f64> {
        self.jet(at).0
    }

    /// The periods of u and v.
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane { .. } => [None, None],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [Some(TAU), None],
            Self::Torus { .. } if self.is_lemon() => [Some(TAU), None],
            Self::Torus { .. } => [Some(TAU), Some(TAU)],
            Self::Extrusion { curve, .. } => [curve.period(), None],
            Self::Revolution { curve, .. } => [Some(TAU), curve.period()],
            Self::Spline(spline) => {
                let domain = spline.domain();
                [0, 1].map(|k| spline.is_closed[k].then(|| domain[k][1] - domain[k][0]))
            }
        }
    }

    /// Whether this is a torus that cuts itself.
    fn is_lemon(&self) -> bool {
        matches!(self, Self::Torus { major_radius_mm, minor_radius_mm, .. } if minor_radius_mm >= major_radius_mm)
    }

    /// The sides that are one point.
    pub fn poles(&self) -> Vec<PolarSide> {
        let across_v = |values: Vec<f64>| -> Vec<PolarSide> {
            values.into_iter().map(|at| PolarSide { along: 1, at, point: self.point([0.0, at]) }).collect()
        };
        match self {
            Self::Plane { .. } | Self::Cylinder { .. } | Self::Extrusion { .. } => Vec::new(),
            Self::Cone { radius_mm, half_angle_rad, .. } => across_v(vec![-radius_mm / half_angle_rad.tan()]),
            Self::Sphere { .. } => across_v(vec![-FRAC_PI_2, FRAC_PI_2]),
            Self::Torus { .. } => self.lemon_range().map_or(Vec::new(), |range| across_v(range.to_vec())),
            Self::Revolution { curve, frame, .. } => across_v(axis_crossings(curve, frame)),
            Self::Spline(spline) => spline_poles(spline),
        }
    }

    /// The range of v of a torus that cuts itself.
    fn lemon_range(&self) -> Option<[f64; 2]> {
        let Self::Torus { major_radius_mm, minor_radius_mm, is_inner, .. } = self else { return None };
        if !self.is_lemon() {
            return None;
        }
        let half = (-major_radius_mm / minor_radius_mm).acos();
        Some(if *is_inner { [half, TAU - half] } else { [-half, half] })
    }

    /// The ranges of u and v of a surface that is closed, as a sphere or a torus.
    pub fn closed_domain(&self) -> Option<[[f64; 2]; 2]> {
        match self {
            Self::Sphere { .. } => Some([[0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]]),
            Self::Torus { .. } => Some([[0.0, TAU], self.lemon_range().unwrap_or([0.0, TAU])]),
            Self::Revolution { range: Some(range), .. } => Some([[0.0, TAU], *range]),
            Self::Revolution { curve, frame, range: None } => {
                let crossings = axis_crossings(curve, frame);
                let range = match (crossings.as_slice(), curve.period(), curve.domain()) {
                    ([], Some(period), domain) => domain.unwrap_or([0.0, period]),
                    ([low, high], None, _) => [*low, *high],
                    // A circle that cuts the axis means its larger part.
                    ([low, high], Some(period), _) => {
                        let radius = |t: f64| frame.local(&curve.point(t)).xy().norm();
                        let parts = [[*low, *high], [*high, low + period]];
                        let [inner, outer] = parts.map(|[from, to]| radius((from + to) / 2.0));
                        parts[usize::from(outer > inner)]
                    }
                    _ => return None,
                };
                Some([[0.0, TAU], range])
            }
            Self::Spline(spline) => {
                let poles = spline_poles(spline);
                let is_closed = |k: usize| {
                    spline.is_closed[k] || poles.iter().filter(|pole| pole.along == k).count() == 2
                };
                (is_closed(0) && is_closed(1)).then(|| spline.domain())
            }
            _ => None,
        }
    }

    /// The surface moved by a placement, with the same parameters.
    pub fn placed(&self, by: &Placement) -> Self {
        let mut placed = self.clone();
        match &mut placed {
            Self::Plane { frame }
            | Self::Cylinder { frame, .. }
            | Self::Cone { frame, .. }
            | Self::Sphere { frame, .. }
            | Self::Torus { frame, .. } => *frame = by.frame(frame),
            Self::Extrusion { curve, along } => (*curve, *along) = (curve.placed(by), by.vector(along)),
            Self::Revolution { curve, frame, .. } => {
                (*curve, *frame) = (curve.placed(by), by.frame(frame));
            }
            Self::Spline(spline) => {
                let points = spline.nurbs.control_points.iter_mut().flatten();
                points.for_each(|point| *point = by.point(point));
            }
        }
        placed
    }
}

/// The parameters where a curve meets the z axis of a frame, growing.
fn axis_crossings(curve: &Curve, frame: &Frame) -> Vec<f64> {
    let radius = |t: f64| frame.local(&curve.point(t)).xy().norm();
    let mut found: Vec<f64> = match curve {
        Curve::Line { origin, along } => {
            let (at, step) = (frame.local(origin).xy(), frame.local(&(frame.origin + along)).xy());
            let t = -at.dot(&step) / step.norm_squared();
            if t.is_finite() { vec![t] } else { Vec::new() }
        }
        Curve::Circle { .. } | Curve::Ellipse { .. } => {
            let step = TAU / 64.0;
            let is_low = |t: &f64| radius(*t) <= radius(t - step) && radius(*t) <= radius(t + step);
            let low = (0..64).map(|k| f64::from(k) * step - PI).filter(is_low);
            low.map(|t| lowest(&radius, t - step, t + step)).collect()
        }
        _ => curve.domain().map_or(Vec::new(), |ends| ends.to_vec()),
    };
    found.retain(|t| radius(*t) <= ON_AXIS_MM);
    found.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    found
}

/// The place of the lowest value between two places, by thirds.
fn lowest(value: &impl Fn(f64) -> f64, mut low: f64, mut high: f64) -> f64 {
    for _ in 0..100 {
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if value(a) <= value(b) { high = b } else { low = a }
    }
    (low + high) / 2.0
}

/// The sides of a spline surface whose control points are one point, within 1e-7 of the size.
fn spline_poles(spline: &SplineSurface) -> Vec<PolarSide> {
    let (domain, size) = (spline.domain(), spline.size());
    let mut poles = Vec::new();
    for along in [0, 1] {
        let [from, to] = domain[1 - along];
        for at in domain[along] {
            let point = |k: usize| {
                let other = from + (to - from) * k as f64 / 16.0;
                spline.jet(if along == 0 { [at, other] } else { [other, at] }).0
            };
            let first = point(0);
            if (1..=16).all(|k| (point(k) - first).norm() <= 1e-7 * size) {
                poles.push(PolarSide { along, at, point: first });
            }
        }
    }
    poles
}
