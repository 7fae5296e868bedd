//! Parts of moves for the estimate of time. Each part has a length, the directions at its two ends, and one
//! largest speed. A line or an arc is one part.

use nalgebra::Vector3;

use super::JUNCTION_DEVIATION_MM;
use crate::geometry::curve::{Arc, Curve, Parabola};
use crate::toolpath::units::FeedRate;

/// A move, or a part of one, with one largest speed.
#[derive(Clone, Copy)]
pub struct SpeedStretch {
    pub length_mm: f64,
    /// The square of the largest speed, mm2/s2.
    pub most: f64,
    /// Unit vectors at both ends.
    pub from: Vector3<f64>,
    pub to: Vector3<f64>,
}

/// Appends the stretches of `curve`; none where it has no length.
pub fn push(stretches: &mut Vec<SpeedStretch>, curve: &Curve, rate: FeedRate, acceleration: f64) {
    let mut add = |length_mm: f64, [from, to]: [Vector3<f64>; 2], curvature: f64| {
        let most = rate.mm_per_s().powi(2).min(acceleration / curvature);
        if let (Some(from), Some(to)) = (from.try_normalize(0.0), to.try_normalize(0.0)) {
            stretches.push(SpeedStretch { length_mm, most, from, to });
        }
    };
    match curve {
        Curve::Line(line) => add(line.length(), line.tangents(), 0.0),
        Curve::Arc(arc) => add(arc.length(), arc.tangents(), curvature(arc)),
        Curve::Parabola(parabola) => {
            for part in parts(parabola) {
                match part {
                    ParabolaPart::Even(part) => add(part.length(), part.tangents(), part.largest_curvature()),
                    ParabolaPart::Corner(part) => add(part.length(), [part.end() - part.start(); 2], 0.0),
                }
            }
        }
    }
}

/// A part of a parabola.
enum ParabolaPart {
    /// Its curvature varies little: by no more than a factor of eight.
    Even(Parabola),
    /// One end is curved sharply, but the part is so short that it is a corner to the machine.
    Corner(Parabola),
}

/// The parts of a parabola, in order. Away from the place of largest curvature, each part covers twice the
/// parameter range of the part before. Over such a part the derivative's length no more than doubles, and the
/// curvature falls with its cube.
fn parts(parabola: &Parabola) -> Vec<ParabolaPart> {
    let slowest = parabola.slowest();
    let mut parts = Vec::new();
    towards(parabola, slowest, 0.0, &mut parts);
    parts.reverse();
    towards(parabola, slowest, 1.0, &mut parts);
    parts
}

/// The parts from the parameter `slowest` to the end at `far`, in this order.
fn towards(parabola: &Parabola, slowest: f64, far: f64, parts: &mut Vec<ParabolaPart>) {
    let speed = |t: f64| parabola.velocity(t).norm();
    let between = |s: f64, t: f64| parabola.part(s.min(t), s.max(t));
    let mut ends = vec![far];
    let mut end = far;
    while end != slowest {
        let first = between(slowest, end);
        if speed(end) <= 2.0 * speed(slowest) {
            parts.push(ParabolaPart::Even(first));
            break;
        }
        if first.length() <= JUNCTION_DEVIATION_MM {
            parts.push(ParabolaPart::Corner(first));
            break;
        }
        end = slowest + (end - slowest) / 2.0;
        ends.push(end);
    }
    parts.extend(ends.windows(2).rev().map(|pair| ParabolaPart::Even(between(pair[1], pair[0]))));
}

/// Curvature of an arc or a helix, 1/mm.
fn curvature(arc: &Arc) -> f64 {
    let (r, rise) = (arc.radius(), arc.rise() / arc.sweep());
    r / (r * r + rise * rise)
}
