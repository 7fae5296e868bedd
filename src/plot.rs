//! Pictures of toolpaths and surfaces: the plan view as SVG, z towards the reader.

use std::fmt::Write;

use nalgebra::Point3;

use crate::geometry::curve::Curve;
use crate::toolpath::flatten::flatten;
use crate::toolpath::{Move, Toolpath};

/// What a chord of the picture may leave an arc by, mm.
const CHORD_TOLERANCE_MM: f64 = 0.05;

/// Most points that one arc is drawn with.
const MAX_ARC_POINTS: usize = 1000;

/// Room around the drawing, as a part of its extent.
const MARGIN: f64 = 0.05;

/// What is drawn.
pub struct Scene<'a> {
    pub title: &'a str,
    pub notes: &'a [String],
    pub toolpath: Option<&'a Toolpath>,
    /// Curves on a surface, mm.
    pub surface: &'a [Vec<Point3<f64>>],
}

/// Draws `scene` as an SVG document.
pub fn svg(scene: &Scene) -> String {
    let feeds = scene.toolpath.into_iter().flat_map(Toolpath::moves).filter_map(feed_points);
    let mut lines: Vec<(&str, Vec<Point3<f64>>)> =
        scene.surface.iter().map(|wire| ("#999", wire.clone())).collect();
    lines.extend(feeds.map(|points| ("#06c", points)));

    let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
    for point in lines.iter().flat_map(|(_, points)| points) {
        for axis in 0..2 {
            low[axis] = low[axis].min(point[axis]);
            high[axis] = high[axis].max(point[axis]);
        }
    }
    if lines.is_empty() {
        (low, high) = ([0.0; 2], [1.0; 2]);
    }
    let extent = (high[0] - low[0]).max(high[1] - low[1]).max(1.0);
    let margin = MARGIN * extent;
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"{:.3} {:.3} {:.3} {:.3}\" fill=\"none\" stroke-width=\"{:.4}\">",
        low[0] - margin,
        -high[1] - margin,
        high[0] - low[0] + 2.0 * margin,
        high[1] - low[1] + 2.0 * margin,
        extent / 500.0,
    );
    let _ = write!(text, "<title>{}</title><desc>", escaped(scene.title));
    for note in scene.notes {
        let _ = writeln!(text, "{}", escaped(note));
    }
    text.push_str("</desc>");
    for (color, points) in &lines {
        let _ = write!(text, "<polyline stroke=\"{color}\" points=\"");
        for point in points {
            let _ = write!(text, "{:.3},{:.3} ", point.x, -point.y);
        }
        text.push_str("\"/>");
    }
    text.push_str("</svg>\n");
    text
}

fn feed_points(step: &Move) -> Option<Vec<Point3<f64>>> {
    let Move::Feed { along, .. } = step else { return None };
    let ends = match along {
        Curve::Line(line) => vec![line.start, line.end],
        Curve::Arc(arc) => vec![arc.start(), arc.end()],
    };
    Some(flatten(along, CHORD_TOLERANCE_MM, MAX_ARC_POINTS).unwrap_or(ends))
}

/// Text between tags; what XML cannot hold is left out.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {}
            c => escaped.push(c),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wire_is_drawn_with_y_up_and_text_cannot_end_its_element() {
        let wire = vec![Point3::new(0.0, 0.0, 5.0), Point3::new(10.0, 20.0, 5.0)];
        let notes = ["<b>\u{1}".to_owned()];
        let text = svg(&Scene { title: "a</title>", notes: &notes, toolpath: None, surface: &[wire] });
        assert!(text.contains("viewBox=\"-1.000 -21.000 12.000 22.000\""), "{text}");
        assert!(text.contains("points=\"0.000,-0.000 10.000,-20.000 \""), "{text}");
        assert!(text.contains("<title>a&lt;/title&gt;</title><desc>&lt;b&gt;\n</desc>"), "{text}");
    }
}
