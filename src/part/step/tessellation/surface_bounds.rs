//! How far flat triangles leave a surface.
//!
//! # Method
//! A triangle with its corners on the surface is the linear interpolant of the surface over the triangle of
//! its parameters. With du and dv the extent of the triangle, the interpolant is within
//! `(|S_uu| du^2 + 2 |S_uv| du dv + |S_vv| dv^2) / 8` of the surface: Taylor's formula about a place q with
//! barycentric coordinates leaves half the sum of the coordinates times the squared distances of the corners,
//! and the variance of values within du is at most du^2 / 4. A first derivative that jumps by j across a
//! knot adds `j du / 4`.
//!
//! Other points of round surfaces are closer than the point of the same parameters:
//! * A point of the triangle has the radius of the cone at its height times at least the cosine of du / 2.
//! * About the axis of a torus or a revolution, a point of the triangle has the mean radius and height of the
//!   corners, but for a factor of at least this cosine. The means leave the profile by its own bend alone.
//!   `S_uv`, which is along the surface, does not count.
//! * The point of the triangle nearest to the centre of the sphere is the centre of its circumscribed circle,
//!   or the middle of its longest side where an angle is obtuse.

use std::f64::consts::PI;

use nalgebra::Point3;
use toolpathd_core::budget::{Budget, Stopped};

use super::curve_bounds::CurveBounds;
use super::spline_bounds::SplineBounds;
use crate::step::curve::Curve;
use crate::step::frame::Frame;
use crate::step::surface::Surface;

/// The least number of steps round a pole.
const POLE_STEPS: f64 = 24.0;

/// The part of the allowed deviation that a step along a pole may cause.
const POLE_SHARE: f64 = 0.25;

/// The least part of the sine between the derivatives that must be left where they change.
const LEAST_PART: f64 = 0.25;

/// A point within this part of its distance from the axis is on a plane with the axis.
const ON_PLANE: f64 = 1e-9;

/// Bounds of the distance of triangles from one surface.
pub struct SurfaceBounds<'a> {
    pub surface: &'a Surface,
    form: Form,
}

enum Form {
    Closed,
    /// Of the curve of an extrusion or a revolution.
    Curve(CurveBounds),
    /// Of the curve of a revolution, in a plane with the axis.
    Profile(CurveBounds),
    Spline(SplineBounds),
}

/// A rectangle of parameters: ranges of u and v.
pub type Rectangle = [[f64; 2]; 2];

impl<'a> SurfaceBounds<'a> {
    /// # Errors
    /// The budget has ended.
    pub fn new(surface: &'a Surface, budget: &Budget) -> Result<Self, Stopped> {
        let form = match surface {
            Surface::Revolution { curve, frame, .. } if is_meridian(curve, frame) => {
                Form::Profile(CurveBounds::new(curve))
            }
            Surface::Extrusion { curve, .. } | Surface::Revolution { curve, .. } => {
                Form::Curve(CurveBounds::new(curve))
            }
            Surface::Spline(spline) => Form::Spline(SplineBounds::new(spline, budget)?),
            _ => Form::Closed,
        };
        Ok(Self { surface, form })
    }

    /// The most that a triangle leaves the surface, mm. Its corners are given as parameters and as points of
    /// the surface.
    pub fn of_triangle(&self, at: [[f64; 2]; 3], points: [Point3<f64>; 3]) -> f64 {
        match self.surface {
            Surface::Plane { .. } => 0.0,
            Surface::Cylinder { .. } | Surface::Cone { .. } => self.of_round(rectangle(&at)),
            Surface::Sphere { radius_mm, .. } => of_ball(*radius_mm, reach(points)),
            _ => self.of_interpolant(rectangle(&at)),
        }
    }

    /// The most that the chord of two points of the surface leaves it, mm.
    pub fn of_chord(&self, at: [[f64; 2]; 2], points: [Point3<f64>; 2]) -> f64 {
        match self.surface {
            Surface::Plane { .. } => 0.0,
            Surface::Cylinder { .. } | Surface::Cone { .. } => self.of_round(rectangle(&at)),
            Surface::Sphere { radius_mm, .. } => of_ball(*radius_mm, (points[1] - points[0]).norm() / 2.0),
            _ => self.of_interpolant(rectangle(&at)),
        }
    }

    /// The most that triangles with corners at the corners of a rectangle leave the surface, mm: the parts
    /// that the extents along u and v cause.
    pub fn of_rectangle(&self, ranges: Rectangle) -> [f64; 2] {
        let [du, dv] = extents(ranges);
        match self.surface {
            Surface::Plane { .. } => [0.0, 0.0],
            Surface::Cylinder { .. } | Surface::Cone { .. } => [self.of_round(ranges), 0.0],
            Surface::Sphere { radius_mm, .. } => {
                let squares = [(widest_cosine(ranges[1]) * du / 2.0).powi(2), (dv / 2.0).powi(2)];
                squares.map(|square| radius_mm * square / 2.0)
            }
            _ => {
                let ([uu, uv, vv], [kinks_u, kinks_v]) = (self.bends(ranges), self.jumps(ranges));
                let mixed = uv * du * dv / 8.0;
                [
                    uu * du * du / 8.0 + mixed + kinks_u * du / 4.0,
                    vv * dv * dv / 8.0 + mixed + kinks_v * dv / 4.0,
                ]
            }
        }
    }

    /// The most by which the surface leaves the line through two of its points, mm. The points are in a
    /// rectangle, and their parameters differ by the step.
    pub fn of_step(&self, ranges: Rectangle, step: [f64; 2]) -> f64 {
        bent(self.seconds(ranges), self.jumps(ranges), step)
    }

    /// How far u and v of two places of the surface are apart at most, if one of them is in a rectangle, the
    /// points are within `distance_mm`, and the places are joined by a line of such places. `None` where the
    /// derivatives change too much over the rectangle.
    ///
    /// The derivatives differ from those at the middle by their second derivatives times the distance. The
    /// difference of the points is at least the sine between the derivatives times the longer part, without
    /// what they differ by.
    pub fn widths(&self, ranges: Rectangle, distance_mm: f64) -> Option<[f64; 2]> {
        let (_, along_u, along_v) = self.surface.jet(ranges.map(|[low, high]| (low + high) / 2.0));
        let speeds = [along_u.norm(), along_v.norm()];
        let sine = along_u.cross(&along_v).norm() / (speeds[0] * speeds[1]);
        let widths = speeds.map(|speed| distance_mm / (LEAST_PART * sine * speed));
        let wider = [0, 1].map(|k| [ranges[k][0] - widths[k], ranges[k][1] + widths[k]]);
        let [half_u, half_v] = extents(wider).map(|extent| extent / 2.0);
        let ([uu, uv, vv], [jump_u, jump_v]) = (self.seconds(wider), self.jumps(wider));
        let change_u = (uu * half_u + uv * half_v + jump_u) / speeds[0];
        let change_v = (uv * half_u + vv * half_v + jump_v) / speeds[1];
        (sine - change_u - change_v >= LEAST_PART * sine).then_some(widths)
    }

    /// Extents of u and v over which a triangle leaves the surface by about `allowed_mm`.
    pub fn steps(&self, ranges: Rectangle, allowed_mm: f64) -> [f64; 2] {
        let whole = extents(ranges);
        let step =
            |second: f64, k: usize| (3.0 * allowed_mm / second.max(f64::MIN_POSITIVE)).sqrt().min(whole[k]);
        match self.surface {
            Surface::Plane { .. } => [1.0, 1.0],
            Surface::Cylinder { .. } | Surface::Cone { .. } => [step(self.seconds(ranges)[0], 0), whole[1]],
            Surface::Sphere { radius_mm, .. } => {
                let [low, high] = ranges[1];
                let cosine = ((low + high) / 2.0).cos().max(0.3);
                [step(radius_mm * cosine * cosine, 0), step(*radius_mm, 1)]
            }
            _ => {
                let [uu, uv, vv] = self.bends(ranges);
                let [u, v] = [step(uu, 0), step(vv, 1)];
                let share = (allowed_mm / (uv * u * v).max(f64::MIN_POSITIVE)).sqrt().min(1.0);
                [u * share, v * share]
            }
        }
    }

    /// The longest step along a pole of a face within `ranges`, so that a triangle with a side at the pole is
    /// near: the side has no length, but the surface beside it has.
    pub fn step_at_pole(&self, ranges: Rectangle, along: usize, at: f64, allowed_mm: f64) -> f64 {
        let round = std::f64::consts::TAU / POLE_STEPS;
        if matches!(self.surface, Surface::Cone { .. } | Surface::Sphere { .. }) {
            return round;
        }
        let height = self.steps(ranges, allowed_mm)[along];
        let mut beside = ranges;
        beside[along] = [(at - height).max(ranges[along][0]), (at + height).min(ranges[along][1])];
        let second = self.bends(beside)[if along == 1 { 0 } else { 2 }];
        let [low, high] = ranges[1 - along];
        (POLE_SHARE * 8.0 * allowed_mm / second.max(f64::MIN_POSITIVE)).sqrt().min((high - low) / POLE_STEPS)
    }

    /// The jumps of the first derivative strictly within a rectangle, along u and v.
    pub fn kinks(&self, ranges: Rectangle) -> [Vec<(f64, f64)>; 2] {
        match (&self.form, self.surface) {
            (Form::Closed, _) => [Vec::new(), Vec::new()],
            (Form::Curve(curve), Surface::Extrusion { .. }) => [curve.kinks(ranges[0]).collect(), Vec::new()],
            (Form::Curve(curve) | Form::Profile(curve), _) => [Vec::new(), curve.kinks(ranges[1]).collect()],
            (Form::Spline(spline), _) => [spline.kinks(0, ranges[0]), spline.kinks(1, ranges[1])],
        }
    }

    /// Bounds of the second derivatives along uu, uv and vv over a rectangle, apart from kinks.
    fn seconds(&self, ranges: Rectangle) -> [f64; 3] {
        let [_, vs] = ranges;
        match (self.surface, &self.form) {
            (Surface::Cylinder { radius_mm, .. }, _) => [*radius_mm, 0.0, 0.0],
            (Surface::Cone { radius_mm, half_angle_rad, .. }, _) => {
                let slope = half_angle_rad.tan();
                let radius = |v: f64| (radius_mm + v * slope).abs();
                [radius(vs[0]).max(radius(vs[1])), slope.abs(), 0.0]
            }
            (Surface::Sphere { radius_mm, .. }, _) => [radius_mm * widest_cosine(vs), *radius_mm, *radius_mm],
            (Surface::Torus { major_radius_mm, minor_radius_mm: r, .. }, _) => {
                let cosines = [largest_cosine(vs), -largest_cosine(vs.map(|v| v + PI))];
                let radii = cosines.map(|cosine| (major_radius_mm + r * cosine).abs());
                [radii[0].max(radii[1]), *r, *r]
            }
            (Surface::Extrusion { .. }, Form::Curve(curve)) => [curve.over(ranges[0])[1], 0.0, 0.0],
            (Surface::Revolution { curve, frame, .. }, Form::Curve(bounds) | Form::Profile(bounds)) => {
                let [first, second] = bounds.over(vs);
                let ends = vs.map(|v| frame.local(&curve.point(v)).xy().norm());
                [ends[0].max(ends[1]) + first * (vs[1] - vs[0]) / 2.0, first, second]
            }
            (_, Form::Spline(spline)) => spline.over(ranges),
            _ => [0.0; 3],
        }
    }

    /// The sums of the jumps of the first derivative strictly within a rectangle, along u and v.
    fn jumps(&self, ranges: Rectangle) -> [f64; 2] {
        self.kinks(ranges).map(|kinks| kinks.iter().map(|(_, jump)| jump).sum())
    }

    /// The second derivatives that take triangles away from the surface.
    fn bends(&self, ranges: Rectangle) -> [f64; 3] {
        let [uu, uv, vv] = self.seconds(ranges);
        let is_round = matches!(self.surface, Surface::Torus { .. }) || matches!(self.form, Form::Profile(_));
        [uu, if is_round { 0.0 } else { uv }, vv]
    }

    fn of_interpolant(&self, ranges: Rectangle) -> f64 {
        bent(self.bends(ranges), self.jumps(ranges), extents(ranges))
    }

    /// The most that a triangle or chord leaves a cylinder or cone.
    fn of_round(&self, ranges: Rectangle) -> f64 {
        let [du, _] = extents(ranges);
        if du >= PI {
            return f64::INFINITY;
        }
        let cosine = match self.surface {
            Surface::Cone { half_angle_rad, .. } => half_angle_rad.cos(),
            _ => 1.0,
        };
        2.0 * self.seconds(ranges)[0] * (du / 4.0).sin().powi(2) * cosine
    }
}

/// How far a surface of these second derivatives and jumps leaves its linear interpolant over extents.
fn bent([uu, uv, vv]: [f64; 3], jumps: [f64; 2], [du, dv]: [f64; 2]) -> f64 {
    (uu * du * du + 2.0 * uv * du * dv + vv * dv * dv) / 8.0 + (jumps[0] * du + jumps[1] * dv) / 4.0
}

/// Whether a curve lies in a plane with the z axis of a frame.
fn is_meridian(curve: &Curve, frame: &Frame) -> bool {
    let points = match curve {
        Curve::Line { origin, along } => vec![*origin, origin + along],
        Curve::Circle { frame: own, .. }
        | Curve::Ellipse { frame: own, .. }
        | Curve::Hyperbola { frame: own, .. }
        | Curve::Parabola { frame: own, .. } => vec![own.origin, own.origin + own.x, own.origin + own.y],
        Curve::Spline(spline) => spline.control_points.clone(),
        Curve::Polyline(points) => points.clone(),
    };
    let flat: Vec<_> = points.iter().map(|point| frame.local(point).xy()).collect();
    let Some(farthest) = flat.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())) else { return false };
    flat.iter().all(|point| farthest.perp(point).abs() <= ON_PLANE * farthest.norm_squared())
}

/// The ranges of u and v of places.
pub fn rectangle(places: &[[f64; 2]]) -> Rectangle {
    [0, 1].map(|k| {
        let values = places.iter().map(|at| at[k]);
        values.fold([f64::MAX, f64::MIN], |[low, high], value| [low.min(value), high.max(value)])
    })
}

fn extents(ranges: Rectangle) -> [f64; 2] {
    ranges.map(|[low, high]| high - low)
}

/// The largest cosine over a range.
fn largest_cosine([low, high]: [f64; 2]) -> f64 {
    let turn = (low / (2.0 * PI)).ceil() * 2.0 * PI;
    if turn <= high { 1.0 } else { low.cos().max(high.cos()) }
}

/// The largest cosine over a range of latitudes.
fn widest_cosine(range: [f64; 2]) -> f64 {
    largest_cosine(range).abs()
}

/// The most that a flat triangle leaves the sphere, with the distance of its farthest place from the foot of
/// the centre.
fn of_ball(radius: f64, reach: f64) -> f64 {
    if reach >= radius { radius } else { reach * reach / (radius + (radius * radius - reach * reach).sqrt()) }
}

/// Half the longest side of a triangle with an obtuse angle; else the radius of its circumscribed circle.
fn reach([a, b, c]: [Point3<f64>; 3]) -> f64 {
    let mut sides = [(b - a).norm(), (c - b).norm(), (a - c).norm()];
    sides.sort_by(f64::total_cmp);
    let [x, y, z] = sides;
    if x * x + y * y <= z * z {
        return z / 2.0;
    }
    let area = (b - a).cross(&(c - a)).norm() / 2.0;
    // Rounding makes the circle of a needle too large, never too small.
    (x * y * z / (4.0 * area)).max(z / 2.0)
}
