//! Surfaces as rational B-splines over a rectangle of their parameters.
//!
//! # Method
//! A surface of revolution turns each control point of its profile: an arc of at most a quarter turn has
//! three control points, the middle one farther out and with the cosine of half the arc as its weight.
//! Cylinders, cones, spheres and tori are surfaces of revolution; planes and extrusions move a profile along
//! a line.
//!
//! # Guarantees
//! Every point of the B-spline is a point of the surface, up to rounding.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Point3, Vector3, Vector4};
use toolpathd_core::geometry::surface::nurbs::Nurbs;

use super::basis::part;
use super::curve::Curve;
use super::frame::Frame;
use super::spline_surface::SplineSurface;
use super::surface::Surface;

/// The end of a rectangle within this part of the domain of a knot is moved to the knot: surfaces for milling
/// have no shorter spans.
pub const SNAP: f64 = 1e-6;

/// A hyperbola's arc over one unit of its parameter is one span.
const HYPERBOLIC_SPAN: f64 = 1.0;

/// A rational B-spline curve of control points that are multiplied by their weights, followed by the weights.
struct Profile {
    degree: usize,
    knots: Vec<f64>,
    points: Vec<Vector4<f64>>,
}

/// The surface over the ranges of u and v.
pub fn nurbs(surface: &Surface, domain: [[f64; 2]; 2]) -> Nurbs {
    let [us, vs] = domain;
    let line = |origin: Point3<f64>, along: Vector3<f64>| line_profile(origin, along, vs);
    match surface {
        Surface::Plane { frame } => extruded(line_profile(frame.origin, frame.x, us), frame.y, vs),
        Surface::Cylinder { frame, radius_mm } => {
            revolved(line(frame.origin + frame.x * *radius_mm, frame.z), frame, us)
        }
        Surface::Cone { frame, radius_mm, half_angle_rad } => {
            let along = frame.x * half_angle_rad.tan() + frame.z;
            revolved(line(frame.origin + frame.x * *radius_mm, along), frame, us)
        }
        Surface::Sphere { frame, radius_mm } => revolved(meridian(frame, 0.0, *radius_mm, vs), frame, us),
        Surface::Torus { frame, major_radius_mm, minor_radius_mm, .. } => {
            revolved(meridian(frame, *major_radius_mm, *minor_radius_mm, vs), frame, us)
        }
        Surface::Extrusion { curve, along } => extruded(profile(curve, us), *along, vs),
        Surface::Revolution { curve, frame, .. } => revolved(profile(curve, vs), frame, us),
        Surface::Spline(spline) => restricted(spline, domain),
    }
}

/// The ruled patch of four corners, in the order round the patch.
pub fn patch(corners: [Point3<f64>; 4]) -> Nurbs {
    let [a, b, c, d] = corners;
    let knots = vec![0.0, 0.0, 1.0, 1.0];
    let control_points = vec![vec![a, d], vec![b, c]];
    Nurbs { degree: [1, 1], knots: [knots.clone(), knots], control_points, weights: None }
}

/// The ranges of a spline, with ends near a knot moved to the knot. A range over the joint of a closed
/// surface becomes the whole domain.
pub fn snapped(spline: &SplineSurface, domain: [[f64; 2]; 2]) -> [[f64; 2]; 2] {
    let whole = spline.domain();
    [0, 1].map(|k| {
        let [start, end] = whole[k];
        let near = SNAP * (end - start);
        let breaks = spline.breaks(k);
        let snap = |t: f64| breaks.iter().copied().find(|knot| (knot - t).abs() <= near).unwrap_or(t);
        // A closed surface may be passed in any turn.
        let turn = if spline.is_closed[k] {
            ((domain[k][0] + near - start) / (end - start)).floor() * (end - start)
        } else {
            0.0
        };
        let [from, to] = domain[k].map(|t| snap(t - turn));
        let is_over_joint = from < start || to > end || from >= to;
        if is_over_joint { whole[k] } else { [from, to] }
    })
}

fn line_profile(origin: Point3<f64>, along: Vector3<f64>, [from, to]: [f64; 2]) -> Profile {
    let point = |t: f64| (origin + along * t).coords.push(1.0);
    Profile { degree: 1, knots: vec![from, from, to, to], points: vec![point(from), point(to)] }
}

/// A circle in the plane of x and z, its middle at a distance from the origin.
fn meridian(frame: &Frame, distance: f64, radius_mm: f64, range: [f64; 2]) -> Profile {
    let origin = frame.origin + frame.x * distance;
    let circle = Frame { origin, x: frame.x, y: frame.z, z: -frame.y };
    conic(range, FRAC_PI_2, |t, stretch| circle.origin + circle.radial(t) * (radius_mm * stretch), f64::cos)
}

/// The spans of an arc: `point(t, 1)` is on the arc, and `point(t, 1 / w)` is the control point before the
/// arc's place t in the middle of a span, with the weight w of half the span.
fn conic(
    [from, to]: [f64; 2],
    longest: f64,
    point: impl Fn(f64, f64) -> Point3<f64>,
    weight: impl Fn(f64) -> f64,
) -> Profile {
    let n = ((to - from) / longest - 1e-9).ceil().clamp(1.0, 1e4) as usize;
    let place = |k: usize| from + (to - from) * k as f64 / n as f64;
    let w = weight((to - from) / (2.0 * n as f64));
    let mut knots = vec![from; 3];
    let mut points = vec![point(from, 1.0).coords.push(1.0)];
    for k in 0..n {
        let (a, b) = (place(k), place(k + 1));
        points.push((point((a + b) / 2.0, 1.0 / w).coords * w).push(w));
        points.push(point(b, 1.0).coords.push(1.0));
        knots.extend(vec![b; if k + 1 == n { 3 } else { 2 }]);
    }
    Profile { degree: 2, knots, points }
}

/// A part of a curve.
fn profile(curve: &Curve, range: [f64; 2]) -> Profile {
    let [from, to] = range;
    match curve {
        Curve::Line { origin, along } => line_profile(*origin, *along, range),
        Curve::Circle { frame, radius_mm } => {
            conic(range, FRAC_PI_2, |t, s| frame.origin + frame.radial(t) * (radius_mm * s), f64::cos)
        }
        Curve::Ellipse { frame, semi_axes_mm: [a, b] } => {
            let point =
                |t: f64, s: f64| frame.origin + frame.x * (a * t.cos() * s) + frame.y * (b * t.sin() * s);
            conic(range, FRAC_PI_2, point, f64::cos)
        }
        Curve::Hyperbola { frame, semi_axes_mm: [a, b] } => {
            let point =
                |t: f64, s: f64| frame.origin + frame.x * (a * t.cosh() * s) + frame.y * (b * t.sinh() * s);
            conic(range, HYPERBOLIC_SPAN, point, f64::cosh)
        }
        Curve::Parabola { frame, focal_mm: f } => {
            // The middle control point is where the tangents at the ends meet.
            let middle = frame.origin + frame.x * (f * from * to) + frame.y * (f * (from + to));
            let points = [curve.point(from), middle, curve.point(to)].map(|point| point.coords.push(1.0));
            Profile { degree: 2, knots: vec![from, from, from, to, to, to], points: points.to_vec() }
        }
        Curve::Spline(spline) => {
            let [start, end] = spline.domain();
            let near = SNAP * (end - start);
            let snap =
                |t: f64| spline.breaks().into_iter().find(|knot| (knot - t).abs() <= near).unwrap_or(t);
            let turn = if spline.is_closed {
                ((from + near - start) / (end - start)).floor() * (end - start)
            } else {
                0.0
            };
            let mut ends = range.map(|t| snap(t - turn));
            if ends[0] < start || ends[1] > end || ends[0] >= ends[1] {
                ends = [start, end];
            }
            let (knots, points) = part(spline.degree, &spline.knots, &spline.homogeneous(), ends);
            Profile { degree: spline.degree, knots, points }
        }
        Curve::Polyline(_) => {
            let places = curve.breaks(range);
            let points = places.iter().map(|t| curve.point(*t).coords.push(1.0)).collect();
            let mut knots = places.clone();
            knots.insert(0, from);
            knots.push(to);
            Profile { degree: 1, knots, points }
        }
    }
}

/// A profile along u, moved along a unit vector for v.
fn extruded(profile: Profile, along: Vector3<f64>, [from, to]: [f64; 2]) -> Nurbs {
    let moved = |point: &Vector4<f64>, v: f64| point + (along * (v * point.w)).push(0.0);
    let rows = profile.points.iter().map(|point| vec![moved(point, from), moved(point, to)]).collect();
    from_rows([profile.degree, 1], [profile.knots, vec![from, from, to, to]], rows)
}

/// A profile along v, turned about z of the frame by u.
fn revolved(profile: Profile, frame: &Frame, range: [f64; 2]) -> Nurbs {
    let turned = |point: &Vector4<f64>| -> Profile {
        let local = frame.local(&Point3::from(point.xyz() / point.w));
        let on_arc = |u: f64, stretch: f64| {
            let (sin, cos) = u.sin_cos();
            let flat = Vector3::new(cos * local.x - sin * local.y, sin * local.x + cos * local.y, 0.0);
            frame.point(&(flat * stretch + Vector3::z() * local.z))
        };
        conic(range, FRAC_PI_2, on_arc, f64::cos)
    };
    let arcs: Vec<Profile> = profile.points.iter().map(turned).collect();
    let knots = arcs[0].knots.clone();
    let weighted =
        |i: usize| arcs.iter().zip(&profile.points).map(move |(arc, p)| arc.points[i] * p.w).collect();
    let rows = (0..arcs[0].points.len()).map(weighted).collect();
    from_rows([2, profile.degree], [knots, profile.knots], rows)
}

/// The part of a spline over a rectangle of its domain, with snapped ends.
fn restricted(spline: &SplineSurface, domain: [[f64; 2]; 2]) -> Nurbs {
    if domain == spline.domain() && spline.nurbs.knots.iter().zip(spline.nurbs.degree).all(is_clamped) {
        return spline.nurbs.clone();
    }
    let Nurbs { degree, knots, control_points, .. } = &spline.nurbs;
    let counts = [control_points.len(), control_points[0].len()];
    let mut along_u = Vec::new();
    let mut knots_u = Vec::new();
    for j in 0..counts[1] {
        let column: Vec<Vector4<f64>> = (0..counts[0]).map(|i| spline.lifted(i, j)).collect();
        let (found, points) = part(degree[0], &knots[0], &column, domain[0]);
        along_u.push(points);
        knots_u = found;
    }
    let mut rows = Vec::new();
    let mut knots_v = Vec::new();
    for i in 0..along_u[0].len() {
        let row: Vec<Vector4<f64>> = along_u.iter().map(|column| column[i]).collect();
        let (found, points) = part(degree[1], &knots[1], &row, domain[1]);
        rows.push(points);
        knots_v = found;
    }
    from_rows(*degree, [knots_u, knots_v], rows)
}

fn is_clamped((knots, degree): (&Vec<f64>, usize)) -> bool {
    knots[0] == knots[degree] && knots[knots.len() - 1] == knots[knots.len() - 1 - degree]
}

/// A surface of control points that are multiplied by their weights.
fn from_rows(degree: [usize; 2], knots: [Vec<f64>; 2], rows: Vec<Vec<Vector4<f64>>>) -> Nurbs {
    let is_rational = rows.iter().flatten().any(|point| (point.w - 1.0).abs() > 1e-15);
    let weights =
        is_rational.then(|| rows.iter().map(|row| row.iter().map(|point| point.w).collect()).collect());
    let point = |point: &Vector4<f64>| Point3::from(point.xyz() / point.w);
    let control_points = rows.iter().map(|row| row.iter().map(point).collect()).collect();
    Nurbs { degree, knots, control_points, weights }
}
