mod reading;
mod relief;

use std::f64::consts::{PI, TAU};

use nalgebra::Point3;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

use super::{Scene, svg};
use reading::{Drawing, compare};
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_core::toolpath::{Builder, Role, Toolpath};

fn feed() -> FeedRate {
    FeedRate::from_mm_per_min(500.0).unwrap()
}

fn of_path(toolpath: &Toolpath) -> String {
    svg(&Scene {
        title: "Part",
        notes: &[],
        warnings: &[],
        toolpath: Some(toolpath),
        drawing: &super::Drawing::default(),
    })
}

fn of_wires(surface: &[Vec<Point3<f64>>]) -> String {
    let drawing = super::Drawing::of_surface(surface.to_vec());
    svg(&Scene { title: "Part", notes: &[], warnings: &[], toolpath: None, drawing: &drawing })
}

/// A square of 80 mm, cut counterclockwise. Its corner at (80, 80) is rounded with 10 mm.
fn square() -> Toolpath {
    let mut builder = Toolpath::builder(Point3::origin());
    for to in [[80.0, 0.0], [80.0, 70.0]] {
        builder.line(Point3::new(to[0], to[1], 0.0), feed(), Role::Cut).unwrap();
    }
    let about = (Plane::Xy, Direction::Ccw);
    builder
        .arc(Point3::new(70.0, 80.0, 0.0), Point3::new(70.0, 70.0, 0.0), about, feed(), Role::Cut)
        .unwrap();
    for to in [[0.0, 80.0], [0.0, 0.0]] {
        builder.line(Point3::new(to[0], to[1], 0.0), feed(), Role::Cut).unwrap();
    }
    builder.finish().unwrap()
}

#[test]
fn a_square_with_a_round_corner_is_lines_and_one_arc() {
    let drawing = Drawing::read(&of_path(&square()));
    assert_eq!(drawing.scale, 1.0);
    let [x, y] = drawing.at("plan", [0.0, 0.0]);
    let lines = format!(
        "M{x} {y}L{} {y}L{} {}M{} {}L{x} {}L{x} {y}",
        x + 80.0,
        x + 80.0,
        y - 70.0,
        x + 70.0,
        y - 80.0,
        y - 80.0
    );
    assert_eq!(drawing.data("plan", "cut"), Some(lines.as_str()));
    // The SVG flag for counterclockwise on paper is 0.
    let arc = format!("M{} {}A10 10 0 0 0 {} {}", x + 80.0, y - 70.0, x + 70.0, y - 80.0);
    assert_eq!(drawing.data("plan", "cut-arc"), Some(arc.as_str()));
    let [x, z] = drawing.at("front", [0.0, 0.0]);
    assert_eq!(
        drawing.data("front", "cut-arc"),
        Some(format!("M{} {z}L{} {z}", x + 80.0, x + 70.0).as_str())
    );
}

/// In each view, the arc turns in the direction of its points.
#[test]
fn arcs_turn_as_they_are_cut_in_every_plane_and_sense() {
    for plane in Plane::ALL {
        for direction in [Direction::Cw, Direction::Ccw] {
            for (from, sweep) in [(0.3, 0.5), (1.0, 2.0), (3.0, 4.0), (5.0, 6.0), (2.0, TAU)] {
                for rise in [0.0, 12.0] {
                    let mut builder = Toolpath::builder(around(plane, 20.0, from, 0.0));
                    turn(&mut builder, (plane, direction), 20.0, from, sweep, rise);
                    compare(&builder.finish().unwrap());
                }
            }
        }
    }
}

fn around(plane: Plane, radius: f64, angle: f64, height: f64) -> Point3<f64> {
    plane.to_workpiece(&nalgebra::Vector3::new(radius * angle.cos(), radius * angle.sin(), height))
}

/// Cuts an arc about the origin.
fn turn(builder: &mut Builder, about: (Plane, Direction), radius: f64, from: f64, sweep: f64, rise: f64) {
    let signed = if about.1 == Direction::Ccw { sweep } else { -sweep };
    let to = around(about.0, radius, from + if sweep == TAU { 0.0 } else { signed }, rise);
    builder.arc(to, Point3::origin(), about, feed(), Role::Cut).unwrap();
}

#[test]
fn a_parabola_is_one_quadratic_curve_in_every_view() {
    let mut builder = Toolpath::builder(Point3::origin());
    let (control, to) = (Point3::new(40.0, 50.0, 20.0), Point3::new(80.0, 0.0, 0.0));
    builder.parabola(to, control, feed(), Role::Cut).unwrap();
    let path = builder.finish().unwrap();
    compare(&path);
    let picture = of_path(&path);
    let drawing = Drawing::read(&picture);
    for (view, [x, y]) in [("plan", [40.0, 50.0]), ("front", [40.0, 20.0]), ("left-side", [20.0, 50.0])] {
        let [fx, fy] = drawing.at(view, [0.0, 0.0]);
        let [cx, cy] = drawing.at(view, [x, y]);
        let [tx, ty] = drawing.at(view, if view == "left-side" { [0.0, 0.0] } else { [80.0, 0.0] });
        assert_eq!(
            drawing.data(view, "cut-parabola"),
            Some(format!("M{fx} {fy}Q{cx} {cy} {tx} {ty}").as_str())
        );
    }
    assert!(drawing.texts.iter().any(|text| text == "Moves: 0 rapid, 0 line, 0 arc, 1 parabola"));
    assert!(drawing.texts.iter().any(|text| text == "cut, parabola"));
    assert!(!of_path(&square()).contains(" parabola<"));
}

#[test]
fn views_share_their_axes_and_the_stated_scale_is_true() {
    let corners = [[0.0, 0.0, 0.0], [900.0, 0.0, 0.0], [900.0, 400.0, 0.0], [900.0, 400.0, 150.0]];
    let wire: Vec<Point3<f64>> = corners.map(Point3::from).to_vec();
    let drawing = Drawing::read(&of_wires(&[wire]));
    assert_eq!(drawing.scale, 0.1);
    let [left, top, width, height] = drawing.frame("plan");
    let [front_left, front_top, front_width, front_height] = drawing.frame("front");
    let [side_left, side_top, _, side_height] = drawing.frame("left-side");
    assert_eq!((front_left, front_width), (left, width));
    assert_eq!((side_top, side_height), (top, height));
    assert!(front_top + front_height < top && left + width < side_left);
    let (a, b) = (drawing.at("plan", [100.0, 100.0]), drawing.at("plan", [900.0, 400.0]));
    assert!((b[0] - a[0] - 80.0).abs() < 0.011 && (a[1] - b[1] - 30.0).abs() < 0.011, "{a:?} {b:?}");
}

#[test]
fn noise_below_the_resolution_is_thinned_and_a_reversal_is_kept() {
    let noisy: Vec<_> = (0..=10_000)
        .map(|k| Point3::new(0.01 * f64::from(k), 0.004 * f64::from(k * k % 7 % 2), 0.0))
        .chain([Point3::new(60.0, 0.0, 0.0), Point3::new(60.0, 50.0, 0.0)])
        .collect();
    let drawing = Drawing::read(&of_wires(&[noisy]));
    let [x, y] = drawing.at("plan", [0.0, 0.0]);
    let data = drawing.data("plan", "wire").unwrap();
    let expected = format!("M{x} {y}L{} {y}L{} {y}L{} {}", x + 100.0, x + 60.0, x + 60.0, y - 50.0);
    assert_eq!(data, expected);
}

#[test]
fn a_plunge_is_a_dot_in_the_plan() {
    let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 20.0));
    builder.line(Point3::origin(), feed(), Role::Plunge).unwrap();
    let drawing = Drawing::read(&of_path(&builder.finish().unwrap()));
    let [x, y] = drawing.at("plan", [0.0, 0.0]);
    assert_eq!(drawing.data("plan", "entry"), Some(format!("M{x} {y}h0").as_str()));
}

#[test]
fn a_dense_path_has_bounded_size_and_reaches_every_place() {
    // Strokes from side to side of a square of 100 mm, in an order that prevents runs.
    let mut builder = Toolpath::builder(Point3::origin());
    let n = 200_000;
    for k in 1..=n {
        let y = 100.0 * f64::from(k * 7919 % n) / f64::from(n);
        builder.line(Point3::new(100.0 * f64::from(k % 2), y, 0.01 * y), feed(), Role::Cut).unwrap();
    }
    let toolpath = builder.finish().unwrap();
    let picture = of_path(&toolpath);
    assert!(picture.len() < 2_100_000, "{}", picture.len());
    let drawing = Drawing::read(&picture);
    assert!(
        drawing.texts.iter().any(|text| text.starts_with("Strokes within 0.5 mm")),
        "{:?}",
        drawing.texts
    );
    assert!(!Drawing::read(&of_path(&square())).texts.iter().any(|text| text.starts_with("Strokes")));
    let strokes = drawing.strokes("plan", "cut");
    for (x, y) in
        (0..40).flat_map(|i| (0..40).map(move |j| (5.0 + 2.3 * f64::from(i), 5.0 + 2.3 * f64::from(j))))
    {
        let at = drawing.at("plan", [x, y]);
        let nearest = strokes.iter().map(|s| reading::distance(at, *s)).fold(f64::INFINITY, f64::min);
        assert!(nearest < 1.0, "({x}, {y}) is {nearest} mm from ink");
    }
}

#[test]
fn scenes_without_extent_or_beyond_limits_make_a_legal_sheet() {
    let point = Toolpath::builder(Point3::new(5.0, -5.0, 5.0)).finish().unwrap();
    assert_eq!(Drawing::read(&of_path(&point)).scale, 1.0);
    assert_eq!(Drawing::read(&of_wires(&[vec![Point3::origin()]])).scale, 1.0);
    for (extent, scale) in [(1e6, 1e-4), (1e-3, 1e5), (1e-7, 1e5)] {
        let wire = vec![Point3::origin(), Point3::new(extent, 0.0, 0.0)];
        assert_eq!(Drawing::read(&of_wires(&[wire])).scale, scale);
    }
    let said = |surface: &[Vec<Point3<f64>>], words: &str| {
        let picture = of_wires(surface);
        let document = roxmltree::Document::parse(&picture).unwrap();
        assert!(document.descendants().any(|node| node.text() == Some(words)), "{picture}");
    };
    said(&[], "There is nothing to draw.");
    said(&[vec![]], "There is nothing to draw.");
    for bad in [f64::NAN, f64::INFINITY, 1e300, -1e10] {
        said(
            &[vec![Point3::origin(), Point3::new(bad, 0.0, 0.0)]],
            "The coordinates are too large for a picture.",
        );
    }
}

/// Random moves of every kind within a cube of two units, at any place and size.
fn toolpath() -> impl Strategy<Value = Toolpath> {
    let unit = || (-1.0f64..1.0, -1.0f64..1.0, -1.0f64..1.0);
    let step = (0usize..13, unit(), unit());
    let size = prop_oneof![Just(1e-3), Just(0.05), Just(1.0), Just(30.0), Just(1e6)];
    let place = prop_oneof![Just(0.0), Just(1e5)];
    (size, place, prop::collection::vec(step, 1..12)).prop_map(|(size, place, steps)| {
        let mut builder = Toolpath::builder(Point3::new(place, -place, place));
        for (kind, p, q) in steps {
            let to = Point3::new(place + size * p.0, size * p.1 - place, place + size * p.2);
            let role =
                [Role::Plunge, Role::Ramp, Role::LeadIn, Role::Cut, Role::Link, Role::LeadOut][kind % 6];
            // An arc that does not fit its ends is left out.
            let _ = match kind {
                0 | 1 => builder.rapid(to),
                2..=4 => builder.line(to, feed(), role),
                10.. => {
                    let control = Point3::new(place + size * q.0, size * q.1 - place, place + size * q.2);
                    builder.parabola(to, control, feed(), role)
                }
                _ => {
                    let plane = Plane::ALL[kind % 3];
                    let direction = if q.0 < 0.0 { Direction::Cw } else { Direction::Ccw };
                    let start = plane.to_local(&builder.at());
                    let center = start + nalgebra::Vector3::new(size * p.0, size * p.1, 0.0);
                    let (sin, cos) = (PI * q.1).sin_cos();
                    let arm = start - center;
                    let rise = if q.2 < 0.0 { 0.0 } else { size * q.2 };
                    let turned =
                        nalgebra::Vector3::new(cos * arm.x - sin * arm.y, sin * arm.x + cos * arm.y, rise);
                    let [to, center] = [center + turned, center].map(|local| plane.to_workpiece(&local));
                    builder.arc(to, center, (plane, direction), feed(), role)
                }
            };
        }
        builder.finish().unwrap()
    })
}

proptest! {
    #![proptest_config(ProptestConfig {
        cases: 200,
        rng_seed: RngSeed::Fixed(1525),
        failure_persistence: None,
        ..ProptestConfig::default()
    })]

    #[test]
    fn the_sheet_shows_exactly_the_moves_of_the_path(toolpath in toolpath()) {
        compare(&toolpath);
    }

    #[test]
    fn text_is_never_markup(title in any::<String>(), notes in prop::collection::vec(any::<String>(), 0..60)) {
        let square = square();
        let draw = |title: &str, notes: &[String]| {
            svg(&Scene { title, notes, warnings: &[], toolpath: Some(&square), drawing: &super::Drawing::default() })
        };
        let told = draw(&title, &notes);
        let document = roxmltree::Document::parse(&told).map_err(|e| TestCaseError::fail(e.to_string()))?;
        let plain = draw("Part", &[]);
        let plain = roxmltree::Document::parse(&plain).unwrap();
        let others = |document: &roxmltree::Document| {
            document.descendants().filter(|n| n.is_element() && !n.has_tag_name("text")).count()
        };
        prop_assert_eq!(others(&document), others(&plain));
        for text in document.descendants().filter(|n| n.has_tag_name("text")) {
            prop_assert!(!text.children().any(|child| child.is_element()));
            let words = text.text().unwrap_or_default();
            prop_assert!(words.chars().all(|c| !c.is_control()), "{:?}", words);
            prop_assert!(words.chars().count() < 80, "{:?}", words);
        }
    }
}

/// Passes to and fro over a square of 80 mm, so far from each other.
fn passes(spacing_mm: f64) -> Toolpath {
    let mut builder = Toolpath::builder(Point3::origin());
    let count = (80.0 / spacing_mm) as usize;
    for k in 0..=count {
        let (y, ends) = (k as f64 * spacing_mm, if k % 2 == 0 { [0.0, 80.0] } else { [80.0, 0.0] });
        for x in ends {
            let _ = builder.line(Point3::new(x, y, 0.0), feed(), Role::Cut);
        }
    }
    builder.finish().unwrap()
}

#[test]
fn passes_that_would_be_a_block_are_thinned_and_others_are_all_drawn() {
    let lines = |spacing_mm: f64| {
        let text = of_path(&passes(spacing_mm));
        (Drawing::read(&text).strokes("plan", "cut").len(), text.contains("Strokes within 0.5 mm"))
    };
    let (sparse, is_thinned) = lines(1.0);
    assert!(sparse >= 81 && !is_thinned, "{sparse}");
    let (dense, is_thinned) = lines(0.05);
    assert!(dense < 400 && is_thinned, "{dense} of 1601 lines");
}

#[test]
fn the_paths_of_passes_have_the_levels_of_the_toolpath() {
    let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 5.0));
    for level in [0, 1, 0] {
        builder.begin_pass(Some(level));
        builder.line(Point3::new(20.0, 5.0 * f64::from(level), 0.0), feed(), Role::Cut).unwrap();
        builder.rapid(Point3::new(0.0, 0.0, 5.0)).unwrap();
    }
    let levels = builder.finish().unwrap();
    compare(&levels);
    let told = of_path(&levels);
    let document = roxmltree::Document::parse(&told).unwrap();
    let mut found: Vec<(&str, Option<&str>)> = document
        .descendants()
        .filter_map(|node| Some((node.attribute("id")?, node.attribute("data-level"))))
        .filter(|(id, _)| id.starts_with("plan-"))
        .collect();
    found.sort_unstable();
    let expected = ["plan-cut-0", "plan-cut-1", "plan-rapid-0", "plan-rapid-1"];
    assert_eq!(found, expected.map(|id| (id, Some(&id[id.len() - 1..]))));
    assert!(told.contains("<title>cut, line, level 2</title>"), "{told}");
    // Without levels there are none.
    assert!(!of_path(&square()).contains("data-level"));
    assert!(of_path(&square()).contains("id=\"plan-cut\""));
}

#[test]
fn warnings_are_told_whole_beside_the_notes_and_above_the_title() {
    let square = square();
    let warning = |k: usize| {
        let words = "the plunge is faster than the feed of the cutting edge allows, so choose a lower feed";
        format!("WARNING: plunge_{k} - {words}; {words} or another tool")
    };
    let notes: Vec<String> = (0..10).map(|k| format!("note {k}")).collect();
    for count in [1, 4, 7] {
        let warnings: Vec<String> = (0..count).map(warning).collect();
        let told = svg(&Scene {
            title: "Part",
            notes: &notes,
            warnings: &warnings,
            toolpath: Some(&square),
            drawing: &super::Drawing::default(),
        });
        let document = roxmltree::Document::parse(&told).unwrap();
        let texts: Vec<_> = document.descendants().filter(|node| node.has_tag_name("text")).collect();
        let words: Vec<&str> = texts.iter().filter_map(|text| text.text()).collect();
        let words = words.join(" ");
        for text in warnings.iter().chain(&notes) {
            assert!(words.contains(text.as_str()), "{count}: {text}\n{words}");
        }
        let last = texts.iter().find(|text| text.text() == Some("note 9")).unwrap();
        assert!(last.attribute("y").unwrap().parse::<f64>().unwrap() < 141.0, "{count}");
    }
}
