//! The parameters of a point of a surface: closed forms where there are some, else a search.

use std::cell::{Cell, OnceCell};

use nalgebra::{Point3, Vector3};

use super::curve::Curve;
use super::frame::Frame;
use super::surface::Surface;

/// A search that begins near its end is repeated from all seeds if it ends farther from the point, mm.
const NEAR_MM: f64 = 1e-4;

/// The most of the distance of edges from their surface that is expected again, mm.
const MOST_KNOWN_MISS_MM: f64 = 0.1;

/// From how many seeds the search begins anew.
const BEST_SEEDS: usize = 5;

/// Steps of the search for the parameter of a curve.
const STEPS: usize = 30;

/// Finds parameters of points of one surface.
pub struct ParameterSearch<'a> {
    pub surface: &'a Surface,
    seeds: OnceCell<Vec<([f64; 2], Point3<f64>)>>,
    /// The distance of the last point for which a search began at all seeds, mm.
    known_miss: Cell<f64>,
}

impl<'a> ParameterSearch<'a> {
    pub fn new(surface: &'a Surface) -> Self {
        Self { surface, seeds: OnceCell::new(), known_miss: Cell::new(0.0) }
    }

    /// The parameters of the surface's point nearest to `point`; for splines a search that begins at `near`.
    pub fn of(&self, point: &Point3<f64>, near: Option<[f64; 2]>) -> [f64; 2] {
        match self.surface {
            Surface::Plane { frame } => {
                let local = frame.local(point);
                [local.x, local.y]
            }
            Surface::Cylinder { frame, .. } => {
                let local = frame.local(point);
                [local.y.atan2(local.x), local.z]
            }
            Surface::Cone { frame, radius_mm, half_angle_rad } => {
                let local = frame.local(point);
                let side = if radius_mm + local.z * half_angle_rad.tan() < 0.0 { -1.0 } else { 1.0 };
                [(side * local.y).atan2(side * local.x), local.z]
            }
            Surface::Sphere { frame, .. } => {
                let local = frame.local(point);
                [local.y.atan2(local.x), local.z.atan2(local.xy().norm())]
            }
            Surface::Torus { frame, major_radius_mm, minor_radius_mm, is_inner } => {
                let local = frame.local(point);
                let is_turned = *is_inner && minor_radius_mm >= major_radius_mm;
                let side = if is_turned { -1.0 } else { 1.0 };
                let out = side * local.xy().norm() - major_radius_mm;
                let v = local.z.atan2(out);
                let v = if is_turned { v.rem_euclid(std::f64::consts::TAU) } else { v };
                [(side * local.y).atan2(side * local.x), v]
            }
            Surface::Extrusion { curve, along } => {
                let u = across(curve, along, point, near.map(|[u, _]| u));
                [u, (point - curve.point(u)).dot(along)]
            }
            Surface::Revolution { curve, frame, .. } => {
                let v = around(curve, frame, point, near.map(|[_, v]| v));
                let (at, local) = (frame.local(&curve.point(v)), frame.local(point));
                [local.y.atan2(local.x) - at.y.atan2(at.x), v]
            }
            Surface::Spline(spline) => {
                if let Some(near) = near {
                    let (at, miss) = spline.descend(point, near);
                    if miss <= NEAR_MM + 2.0 * self.known_miss.get() {
                        return at;
                    }
                }
                let seeds = self.seeds.get_or_init(|| spline.seeds());
                let mut order: Vec<(f64, [f64; 2])> =
                    seeds.iter().map(|(at, seed)| ((seed - point).norm_squared(), *at)).collect();
                let most = BEST_SEEDS.min(order.len() - 1);
                order.select_nth_unstable_by(most, |a, b| a.0.total_cmp(&b.0));
                let found = order[..=most]
                    .iter()
                    .map(|(_, at)| spline.descend(point, *at))
                    .chain(near.map(|near| spline.descend(point, near)));
                let (at, miss) = found.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or(([0.0; 2], 0.0));
                // Edges of some kernels are off their surface by 0.01 mm all the way.
                self.known_miss.set(miss.min(MOST_KNOWN_MISS_MM));
                at
            }
        }
    }

    /// The distance of a point from the surface's point with these parameters, mm.
    pub fn miss(&self, point: &Point3<f64>, at: [f64; 2]) -> f64 {
        (self.surface.point(at) - point).norm()
    }
}

/// The parameter of the curve whose line along `along` is nearest to `point`.
fn across(curve: &Curve, along: &Vector3<f64>, point: &Point3<f64>, near: Option<f64>) -> f64 {
    let flat = |v: Vector3<f64>| v - along * v.dot(along);
    let distance = |p: &Point3<f64>| flat(p - point).norm_squared();
    let step = |t: f64| {
        let (at, slope) = curve.jet(t);
        let slope = flat(slope);
        flat(point - at).dot(&slope) / slope.norm_squared()
    };
    nearest(curve, distance, step, near)
}

/// The parameter of the curve whose circle about the axis is nearest to `point`.
fn around(curve: &Curve, frame: &Frame, point: &Point3<f64>, near: Option<f64>) -> f64 {
    let profile = |p: &Point3<f64>| {
        let local = frame.local(p);
        [local.xy().norm(), local.z]
    };
    let [radius, height] = profile(point);
    let distance = |p: &Point3<f64>| {
        let [r, h] = profile(p);
        (r - radius).powi(2) + (h - height).powi(2)
    };
    let step = |t: f64| {
        let (at, slope) = curve.jet(t);
        let (at, slope) = (frame.local(&at), frame.local(&(frame.origin + slope)));
        let r = at.xy().norm();
        let dr = if r > 0.0 { at.xy().dot(&slope.xy()) / r } else { slope.xy().norm() };
        ((radius - r) * dr + (height - at.z) * slope.z) / (dr * dr + slope.z * slope.z)
    };
    nearest(curve, distance, step, near)
}

/// The parameter of least distance that steps lead to, from `near` or from samples.
fn nearest(
    curve: &Curve,
    distance: impl Fn(&Point3<f64>) -> f64,
    step: impl Fn(f64) -> f64,
    near: Option<f64>,
) -> f64 {
    let bounds = if curve.period().is_none() { curve.domain() } else { None };
    let refine = |start: f64| {
        let (mut t, mut here) = (start, distance(&curve.point(start)));
        for _ in 0..STEPS {
            let change = step(t);
            let mut share = 1.0;
            let next = loop {
                let next = t + change * share;
                let next = bounds.map_or(next, |[from, to]| next.clamp(from, to));
                let there = distance(&curve.point(next));
                if there <= here || share < 1e-4 || !there.is_finite() {
                    break (next, there);
                }
                share *= 0.5;
            };
            let is_done = (next.0 - t).abs() <= 1e-15 * t.abs().max(1e-3);
            if next.1.is_nan() || next.1 > here {
                break;
            }
            (t, here) = next;
            if is_done {
                break;
            }
        }
        t
    };
    if let Some(t) = near.map(&refine).filter(|t| distance(&curve.point(*t)) <= NEAR_MM * NEAR_MM) {
        return t;
    }
    match curve {
        Curve::Line { .. } | Curve::Hyperbola { .. } | Curve::Parabola { .. } => {
            let starts = (-20..=20).map(|k| f64::from(k) * 0.25).chain(near);
            let found = starts.map(&refine).map(|t| (distance(&curve.point(t)), t));
            found.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, t)| t)
        }
        _ => curve.nearest_of(&distance, refine),
    }
}
