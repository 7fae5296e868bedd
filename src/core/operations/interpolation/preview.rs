//! What a picture shows beside the toolpath: the curve, the edges of its band, and the joints of its
//! elements. All are given as points.

use nalgebra::{Point2, Vector2};

use super::ReportedElement;
use super::band::BandAlong;
use crate::geometry::deviation::Measure;
use crate::geometry::plane_curve::PlaneCurve;

/// About how many points of the curve a picture has, and the least and the most for one element.
const POINTS: usize = 20_000;
const POINTS_AN_ELEMENT: (usize, usize) = (2, 64);

/// Polylines and points in the plane, mm.
#[derive(Debug, Clone, PartialEq)]
pub struct Sketch {
    pub curve: Vec<Point2<f64>>,
    /// The lower edge and the upper edge.
    pub band: [Vec<Point2<f64>>; 2],
    pub joints: Vec<Point2<f64>>,
}

/// Samples the curve along its elements.
pub fn sketch(curve: &impl PlaneCurve, band: &BandAlong, elements: &[ReportedElement]) -> Sketch {
    let (least, most) = POINTS_AN_ELEMENT;
    let each = (POINTS / elements.len().max(1)).clamp(least, most);
    let mut sketch = Sketch { curve: Vec::new(), band: [Vec::new(), Vec::new()], joints: Vec::new() };
    let mut take = |t: f64| {
        let point = curve.point(t);
        let across = match band.widest.measure {
            Measure::Vertical => Vector2::y(),
            Measure::Normal => {
                let along = curve.derivative(t);
                Vector2::new(-along.y, along.x).try_normalize(0.0).unwrap_or_default()
            }
        };
        let [below, above] = band.at(t);
        sketch.curve.push(point);
        for (edge, offset) in sketch.band.iter_mut().zip([-below, above]) {
            edge.push(point + across * offset);
        }
    };
    for element in elements {
        let [from, to] = element.domain;
        (0..each).for_each(|k| take(from + (to - from) * (k as f64 / each as f64)));
    }
    if let Some(last) = elements.last() {
        take(last.domain[1]);
        sketch.joints = elements.iter().map(|element| element.element.start()).collect();
        sketch.joints.push(last.element.end());
    }
    sketch
}
