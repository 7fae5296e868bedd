//! Drawings as texts, read by the reader. Expected numbers are closed forms.

mod blocks;
mod damage;
mod forms;
mod joints;
mod shapes;

use super::*;
use crate::drawing::Loop;

/// A file with entities and without a unit. A group is a line with its code and its value.
fn file(entities: &str) -> String {
    file_with("", "", entities)
}

/// A file with the groups of a header, blocks and entities.
fn file_with(header: &str, blocks: &str, entities: &str) -> String {
    let mut text = String::new();
    for (name, groups) in [("HEADER", header), ("BLOCKS", blocks), ("ENTITIES", entities)] {
        text.push_str(&format!("0\nSECTION\n2\n{name}\n{}0\nENDSEC\n", lines(groups)));
    }
    text + "0\nEOF\n"
}

/// The two lines of each group.
fn lines(groups: &str) -> String {
    let groups = groups.lines().map(str::trim).filter(|group| !group.is_empty());
    groups
        .map(|group| {
            let (code, value) = group.split_once(' ').unwrap_or((group, ""));
            format!("{code}\n{value}\n")
        })
        .collect()
}

fn line(from: [f64; 2], to: [f64; 2]) -> String {
    format!("0 LINE\n8 0\n10 {}\n20 {}\n11 {}\n21 {}\n", from[0], from[1], to[0], to[1])
}

fn circle(center: [f64; 2], radius: f64) -> String {
    format!("0 CIRCLE\n8 0\n10 {}\n20 {}\n40 {radius}\n", center[0], center[1])
}

fn arc(center: [f64; 2], radius: f64, start: f64, end: f64) -> String {
    format!("0 ARC\n8 0\n10 {}\n20 {}\n40 {radius}\n50 {start}\n51 {end}\n", center[0], center[1])
}

/// A closed polyline.
fn polygon(vertices: &[[f64; 3]]) -> String {
    let head = format!("0 LWPOLYLINE\n8 0\n90 {}\n70 1\n", vertices.len());
    let vertex = |[x, y, bulge]: &[f64; 3]| format!("10 {x}\n20 {y}\n42 {bulge}\n");
    head + &vertices.iter().map(vertex).collect::<String>()
}

fn rectangle(from: [f64; 2], to: [f64; 2]) -> String {
    polygon(&[[from[0], from[1], 0.0], [to[0], from[1], 0.0], [to[0], to[1], 0.0], [from[0], to[1], 0.0]])
}

fn options() -> DxfOptions {
    DxfOptions::default()
}

fn drawing(text: &str) -> Drawing {
    read(text.as_bytes(), &options(), &Budget::unlimited()).unwrap()
}

fn fault(text: &str) -> String {
    read(text.as_bytes(), &options(), &Budget::unlimited()).unwrap_err().to_string()
}

/// The only loop.
fn only(drawing: &Drawing) -> &Loop {
    assert_eq!((drawing.loops.len(), drawing.open.len()), (1, 0), "{drawing:?}");
    &drawing.loops[0]
}

/// Kinds and reasons with their numbers.
fn left_out(drawing: &Drawing) -> Vec<(&str, &str, usize)> {
    drawing.left_out.iter().map(|one| (one.kind.as_str(), one.reason.as_str(), one.count)).collect()
}

fn assert_near(found: f64, expected: f64) {
    assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{found} is not {expected}");
}
