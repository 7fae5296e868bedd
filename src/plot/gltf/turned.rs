//! The cutter with its shank and its holder, turned about its axis. Its tip is at the origin, and its axis
//! is z.

use std::f64::consts::{FRAC_PI_2, TAU};

use nalgebra::{Point3, Vector3};

use super::Triangles;
use toolpathd_core::toolpath::tool::{Shape, Tool};
use toolpathd_core::toolpath::tool_body::ToolBody;

/// Steps about the axis, and along a rounded part of the profile.
const STEPS_ABOUT: u32 = 48;
const STEPS_ALONG: usize = 12;

/// The length of a tool of which no length is told, in diameters.
const USUAL_LENGTH: f64 = 5.0;

/// The angle of the point of a drill of which no angle is told, degrees.
const USUAL_POINT_DEG: f64 = 118.0;

/// A place of the profile, with the direction away from the tool there: distance from the axis and height.
#[derive(Debug, Clone, Copy)]
struct Corner {
    at: [f64; 2],
    outward: [f64; 2],
}

/// The triangles of a cutter.
pub fn cutter(tool: &Tool, body: &ToolBody) -> Triangles {
    let mut triangles = Triangles::default();
    for pair in profile(tool, body) {
        turn(&mut triangles, pair);
    }
    triangles
}

/// The parts of the profile from the tip upwards.
fn profile(tool: &Tool, body: &ToolBody) -> Vec<[Corner; 2]> {
    let radius = tool.radius_mm;
    let mut parts = Vec::new();
    let mut at = [0.0, 0.0];
    match tool.shape {
        Shape::Flat => at = straight(&mut parts, at, [radius, 0.0]),
        Shape::Ball => at = rounded(&mut parts, at, radius),
        Shape::BullNose { corner_radius_mm } => {
            at = straight(&mut parts, at, [radius - corner_radius_mm, 0.0]);
            at = rounded(&mut parts, at, corner_radius_mm);
        }
        Shape::V { tip_angle_deg, tip_diameter_mm } => {
            at = pointed(&mut parts, 0.5 * tip_diameter_mm, radius, 0.5 * tip_angle_deg);
        }
        Shape::Cone { taper_angle_deg, tip_diameter_mm } => {
            at = pointed(&mut parts, 0.5 * tip_diameter_mm, radius, taper_angle_deg);
        }
        Shape::Drill { point_angle_deg } => {
            at = pointed(&mut parts, 0.0, radius, 0.5 * point_angle_deg.unwrap_or(USUAL_POINT_DEG));
        }
    }
    let least = body.flute_length_mm.unwrap_or(2.0 * USUAL_LENGTH * radius);
    let length = body.length_mm.unwrap_or(least).max(at[1]);
    at = straight(&mut parts, at, [radius, length]);
    for section in &body.holder {
        let [below, above] = section.diameters_mm.map(|diameter| 0.5 * diameter);
        at = straight(&mut parts, at, [below, at[1]]);
        at = straight(&mut parts, at, [above, at[1] + section.length_mm]);
    }
    straight(&mut parts, at, [0.0, at[1]]);
    parts
}

/// A straight part of the profile. Returns its end.
fn straight(parts: &mut Vec<[Corner; 2]>, from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let along = [to[0] - from[0], to[1] - from[1]];
    let length = along[0].hypot(along[1]);
    if length > 0.0 {
        let outward = [along[1] / length, -along[0] / length];
        parts.push([from, to].map(|at| Corner { at, outward }));
    }
    to
}

/// A quarter of a circle from horizontal to upright.
fn rounded(parts: &mut Vec<[Corner; 2]>, from: [f64; 2], radius: f64) -> [f64; 2] {
    let corner = |k: usize| {
        let (sin, cos) = (FRAC_PI_2 * k as f64 / STEPS_ALONG as f64).sin_cos();
        Corner { at: [from[0] + radius * sin, from[1] + radius * (1.0 - cos)], outward: [sin, -cos] }
    };
    if radius > 0.0 {
        parts.extend((0..STEPS_ALONG).map(|k| [corner(k), corner(k + 1)]));
    }
    [from[0] + radius, from[1] + radius]
}

/// A flat tip and a cone up to `radius`, whose side is at an angle to the axis, degrees.
fn pointed(parts: &mut Vec<[Corner; 2]>, tip: f64, radius: f64, side_deg: f64) -> [f64; 2] {
    let at = straight(parts, [0.0, 0.0], [tip.min(radius), 0.0]);
    let height = (radius - at[0]) / side_deg.to_radians().tan();
    straight(parts, at, [radius, height])
}

/// Adds the surface that a part of the profile sweeps about the axis.
fn turn(triangles: &mut Triangles, pair: [Corner; 2]) {
    let first = u32::try_from(triangles.points.len()).unwrap_or(u32::MAX);
    for step in 0..STEPS_ABOUT {
        let (sin, cos) = (TAU * f64::from(step) / f64::from(STEPS_ABOUT)).sin_cos();
        for Corner { at: [r, z], outward: [out, up] } in pair {
            triangles.points.push(Point3::new(r * cos, r * sin, z));
            triangles.normals.push(Vector3::new(out * cos, out * sin, up).normalize());
        }
    }
    for step in 0..STEPS_ABOUT {
        let next = (step + 1) % STEPS_ABOUT;
        let [low, high] = [0, 1].map(|k| first + 2 * step + k);
        let [low_next, high_next] = [0, 1].map(|k| first + 2 * next + k);
        // A corner on the axis makes one triangle of two.
        if pair[0].at[0] > 0.0 {
            triangles.triangles.push([low, low_next, high]);
        }
        if pair[1].at[0] > 0.0 {
            triangles.triangles.push([low_next, high_next, high]);
        }
    }
}
