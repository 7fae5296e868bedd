//! Tests of the relief: the band that is drawn at a place of the plan, and that the sheet is small enough and
//! valid for any surface.

use nalgebra::Vector3;
use roxmltree::Document;

use super::super::relief::MAX_BYTES;
use super::super::{Drawing, Scene, svg};
use super::reading::{self, strokes};
use toolpathd_core::geometry::surface::{BezierSurface, BicubicPatch, Surface};
use toolpathd_core::machining::wire_model::sketch;

/// `n` by `n` patches over unit squares, whose control points are `at` thirds of the squares.
fn patches(n: usize, at: impl Fn(f64, f64) -> [f64; 3]) -> BezierSurface {
    BezierSurface::from_fn([n, n], |i, j| BicubicPatch {
        net: std::array::from_fn(|a| {
            std::array::from_fn(|b| Vector3::from(at(i as f64 + a as f64 / 3.0, j as f64 + b as f64 / 3.0)))
        }),
    })
}

fn drawn(surface: &dyn Surface) -> String {
    let drawing = Drawing::of_relief(surface, sketch(surface));
    svg(&Scene { title: "Part", notes: &[], warnings: &[], toolpath: None, drawing: &drawing })
}

/// The bands at a place of the plan, in the order of painting.
fn bands_at(picture: &str, [x, y]: [f64; 2]) -> Vec<usize> {
    let document = Document::parse(picture).unwrap();
    let is_plan = |node: &roxmltree::Node| node.attribute("id") == Some("plan");
    let plan = document.descendants().find(is_plan).unwrap();
    let relief = plan.children().find(|node| node.attribute("class") == Some("relief")).unwrap();
    let areas = relief.children().filter_map(|node| {
        let band = node.attribute("class")?.strip_prefix("contour h")?.parse().unwrap();
        let winding: i32 = strokes(node.attribute("d")?).iter().map(|s| crossing([x, y], *s)).sum();
        (winding != 0).then_some(band)
    });
    areas.collect()
}

/// How a stroke crosses the ray to the right of a place: 1 downward, -1 upward, 0 for no crossing.
fn crossing([x, y]: [f64; 2], [a, b]: [[f64; 2]; 2]) -> i32 {
    let across = a[0] + (b[0] - a[0]) * (y - a[1]) / (b[1] - a[1]);
    match (a[1] <= y, b[1] <= y) {
        (true, false) if across > x => 1,
        (false, true) if across > x => -1,
        _ => 0,
    }
}

fn relief_bytes(picture: &str) -> usize {
    let parts = picture.split("<g class=\"relief\">").skip(1);
    parts.map(|part| part.find("</g>").unwrap()).sum()
}

#[test]
fn bands_end_at_the_heights_of_their_levels() {
    // z = x / 4 rises from 0 to 12, so the levels are 1 apart.
    let picture = drawn(&patches(1, |u, v| [48.0 * u, 30.0 * v, 12.0 * u]));
    let drawing = reading::Drawing::read(&picture);
    for band in 1..12 {
        for (side, top) in [(-0.1, band - 1), (0.1, band)] {
            let place = drawing.at("plan", [4.0 * band as f64 + side, 17.3]);
            let bands = bands_at(&picture, place);
            assert_eq!(bands, (0..=top).collect::<Vec<_>>(), "{band} {side}");
        }
    }
    assert_eq!(bands_at(&picture, drawing.at("plan", [20.0, 30.2])), [0; 0]);
    assert!(drawing.texts.iter().any(|text| text == "height z of the surface, mm"));
    assert!(picture.contains("heights-front") && picture.contains("heights-left-side"));
}

#[test]
fn the_higher_part_covers_the_lower_one_in_any_order() {
    // A strip that folds back over itself, 12 mm higher; and the same strip from its other end.
    let fold = |u: f64, v: f64| [40.0 * (1.0 - (2.0 * u - 1.0).powi(2)), 30.0 * v, 12.0 * u];
    let net = |u: f64| {
        // Control points of a parabola, raised to degree three.
        [0.0, 160.0 / 3.0, 160.0 / 3.0, 0.0][(3.0 * u).round() as usize]
    };
    for turned in [false, true] {
        let surface = patches(1, |u, v| {
            let u = if turned { 1.0 - u } else { u };
            [net(u), 30.0 * v, 12.0 * u]
        });
        let picture = drawn(&surface);
        let drawing = reading::Drawing::read(&picture);
        for u in [0.55, 0.7, 0.96] {
            let [x, y, z] = fold(u, 0.4);
            let top = bands_at(&picture, drawing.at("plan", [x, y])).pop();
            assert_eq!(top, Some(z as usize), "{u} {turned}");
        }
    }
}

#[test]
fn any_surface_is_a_legal_sheet_of_bounded_size() {
    let noise = |k: f64| (k * 12.9898).sin() * 43_758.547 % 1.0;
    let surfaces: [(&str, BezierSurface); 9] = [
        ("level", patches(1, |u, v| [9.0 * u, 9.0 * v, 5.0])),
        ("a point", patches(1, |_, _| [1.0, 2.0, 3.0])),
        ("upright", patches(1, |u, v| [9.0 * u, 0.0, 9.0 * v])),
        ("a pole", patches(2, |u, v| [u * (3.0 - v), u * v, 2.0 * u])),
        ("tiny", patches(2, |u, v| [1e-6 * u, 1e-6 * v, 1e-6 * (u * v).sin()])),
        ("huge", patches(2, |u, v| [4e8 * u, 4e8 * v, 1e8 * (u * v).sin()])),
        ("far away", patches(2, |u, v| [9e8 + u, v - 9e8, 9e8 + u])),
        ("needles", patches(60, |u, v| [u, v, 30.0 * noise(u + 61.0 * v)])),
        (
            "tangle",
            patches(60, |u, v| [60.0 * noise(u + 7.0 * v), 60.0 * noise(3.0 * u + v), 60.0 * noise(u * v)]),
        ),
    ];
    for (name, surface) in surfaces {
        let picture = drawn(&surface);
        assert_eq!(picture, drawn(&surface), "{name}");
        reading::Drawing::read(&picture);
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{name}");
        assert!(relief_bytes(&picture) <= MAX_BYTES, "{name}: {}", relief_bytes(&picture));
        assert!(picture.contains("height z of the surface, mm"), "{name}");
    }
}
