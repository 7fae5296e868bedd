use nalgebra::Point3;

use super::*;
use toolpathd_core::geometry::surface::BezierSurface;
use toolpathd_core::geometry::surface::point_grid::{Ends, PointGrid, Twist};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Role, Toolpath};

fn sheet(drawing: &Drawing, toolpath: Option<&Toolpath>) -> String {
    svg(&Scene { title: "Part", notes: &[], warnings: &[], toolpath, drawing })
}

fn wire(from: [f64; 3], to: [f64; 3]) -> Vec<Point3<f64>> {
    vec![from.into(), to.into()]
}

/// The path data of a class.
fn data<'a>(sheet: &'a str, class: &str) -> Option<&'a str> {
    let (_, rest) = sheet.split_once(&format!("<path class=\"{class}\" d=\""))?;
    rest.split_once('"').map(|(data, _)| data)
}

fn numbers(data: &str) -> Vec<f64> {
    data.split(['M', 'L', ' ']).filter_map(|number| number.parse().ok()).collect()
}

/// A ridge along y: 40 x 40 mm, 20 mm high.
fn ridge() -> BezierSurface {
    let points = (0..=8).map(|i| {
        let x = 5.0 * f64::from(i);
        let z = 20.0 * (std::f64::consts::PI * x / 40.0).sin();
        (0..=4).map(|j| Point3::new(x, 10.0 * f64::from(j), z)).collect()
    });
    PointGrid { points: points.collect(), twist: Twist::Spline, ends: Ends::Natural }.surface().unwrap()
}

#[test]
fn lengths_along_the_axes_are_drawn_to_scale_at_30_and_90_degrees() {
    for (to, expected) in [
        ([40.0, 0.0, 0.0], [40.0 * 0.75f64.sqrt(), -20.0]),
        ([0.0, 40.0, 0.0], [-40.0 * 0.75f64.sqrt(), -20.0]),
        ([0.0, 0.0, 40.0], [0.0, -40.0]),
    ] {
        let drawing = Drawing::of_surface(vec![wire([0.0; 3], to), wire([0.0; 3], [80.0; 3])]);
        let sheet = sheet(&drawing, None);
        assert!(sheet.contains(">Scale 1:1<"), "{sheet}");
        let found = numbers(data(&sheet, "wire").unwrap());
        let way = [found[2] - found[0], found[3] - found[1]];
        assert!(way.iter().zip(expected).all(|(a, b)| (a - b).abs() < 0.011), "{way:?} {expected:?}");
    }
}

#[test]
fn what_is_behind_the_surface_is_not_drawn() {
    let drawn = |points: Vec<Point3<f64>>| {
        let drawing = Drawing { curve: vec![points], ..Drawing::of_relief(&ridge(), Vec::new()) };
        data(&sheet(&drawing, None), "curve").is_some()
    };
    // The reader stands towards -x, -y and +z.
    assert!(drawn(wire([5.0, 10.0, 15.0], [5.0, 30.0, 15.0])));
    assert!(!drawn(wire([38.0, 20.0, 4.0], [38.0, 30.0, 4.0])));
    assert!(!drawn(wire([15.0, 15.0, 2.0], [15.0, 25.0, 2.0])));
    // On the surface, before and behind the ridge, too far from its open end to be seen from below.
    let on = |x: f64| [x, 25.0, 20.0 * (std::f64::consts::PI * x / 40.0).sin()];
    let along = |x: f64| wire(on(x), [x, 35.0, on(x)[2]]);
    assert!(drawn(along(10.0)) && !drawn(along(37.0)));
}

#[test]
fn every_part_of_the_picture_is_inside_its_area() {
    for [x, y, z] in
        [[100.0, 3.0, 1.0], [3.0, 500.0, 20.0], [1.0, 1.0, 80.0], [0.01, 0.02, 0.0], [7e5, 7e5, 10.0]]
    {
        let corners = Drawing::of_surface(vec![wire([0.0; 3], [x, y, z]), wire([0.0, y, 0.0], [x, 0.0, z])]);
        let found = numbers(data(&sheet(&corners, None), "wire").unwrap());
        for place in found.chunks_exact(2) {
            assert!((20.0..=210.0).contains(&place[0]) && (20.0..=192.0).contains(&place[1]), "{place:?}");
        }
    }
}

#[test]
fn a_toolpath_has_its_moves_and_its_ends() {
    let feed = FeedRate::from_mm_per_min(500.0).unwrap();
    let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 10.0));
    builder.line(Point3::origin(), feed, Role::Plunge).unwrap();
    builder.line(Point3::new(30.0, 20.0, 5.0), feed, Role::Cut).unwrap();
    let toolpath = builder.finish().unwrap();
    let sheet = sheet(&Drawing::default(), Some(&toolpath));
    assert!(data(&sheet, "cut").is_some() && data(&sheet, "entry").is_some());
    assert!(sheet.contains("class=\"start\"") && sheet.contains("class=\"end\""));
    assert!(!sheet.contains("direction of the cut") && !sheet.contains("first angle"));
    assert!(
        super::svg(&Scene {
            title: "",
            notes: &[],
            warnings: &[],
            toolpath: None,
            drawing: &Drawing::default()
        })
        .contains("nothing to draw")
    );
}
