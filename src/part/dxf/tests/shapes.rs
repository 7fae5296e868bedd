//! Each kind of entity.

use std::f64::consts::PI;

use super::*;

#[test]
fn a_plate_of_lines_and_arcs_is_one_loop_with_its_closed_form() {
    // 100 x 60 with corners of radius 10 and a hole of radius 5. Each corner is exact.
    let text = file(
        &[
            line([10.0, 0.0], [90.0, 0.0]),
            arc([90.0, 10.0], 10.0, 270.0, 0.0),
            line([100.0, 50.0], [100.0, 10.0]),
            arc([90.0, 50.0], 10.0, 0.0, 90.0),
            line([90.0, 60.0], [10.0, 60.0]),
            arc([10.0, 50.0], 10.0, 90.0, 180.0),
            circle([50.0, 30.0], 5.0),
            line([0.0, 10.0], [0.0, 50.0]),
            arc([10.0, 10.0], 10.0, 180.0, 270.0),
        ]
        .concat(),
    );
    let drawing = drawing(&text);
    assert_eq!((drawing.loops.len(), drawing.open.len(), drawing.unit), (2, 0, None));
    let [plate, hole] = &drawing.loops[..] else { panic!() };
    assert_eq!((plate.vertices.len(), plate.depth, plate.parent), (8, 0, None));
    assert_near(plate.area_mm2, 6000.0 - (4.0 - PI) * 100.0);
    assert_near(plate.length_mm, 2.0 * (80.0 + 40.0) + 20.0 * PI);
    assert_eq!((hole.depth, hole.parent), (1, Some(0)));
    assert_eq!(hole.vertices, [[55.0, 30.0, 1.0], [45.0, 30.0, 1.0]]);
    assert_near(hole.area_mm2, 25.0 * PI);
    assert_eq!((drawing.bridged_max_mm, drawing.deviation_max_mm), (0.0, 0.0));
    assert!(drawing.left_out.is_empty() && drawing.branches.is_empty());
    assert_eq!(drawing.layers, [Layer { name: "0".to_owned(), n_curves: 9 }]);
}

#[test]
fn vertices_of_polylines_keep_their_numbers() {
    let vertices = [[0.1, 0.2, 0.3], [10.7, -0.30000000000000004, 0.0], [1e-3, 7.0, -1.7], [-3.3, 5.0, 0.0]];
    assert_eq!(only(&drawing(&file(&polygon(&vertices)))).vertices, vertices);
    // Vertices without a bulge start lines, and inches are rounded once.
    let text = "0 LWPOLYLINE\n90 3\n70 1\n10 1\n20 2\n10 3.3\n20 2\n42 1\n10 3\n20 4\n";
    let drawing = drawing(&file_with("9 $INSUNITS\n70 1\n", "", text));
    assert_eq!(drawing.unit, Some(Unit::Inch));
    let expected = [[25.4, 50.8, 0.0], [3.3 * 25.4, 50.8, 1.0], [3.0 * 25.4, 101.6, 0.0]];
    assert_eq!(only(&drawing).vertices, expected);
}

#[test]
fn pieces_without_length_are_dropped() {
    let doubled = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.7], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0], [0.0, 0.0, 0.5]];
    let drawing = drawing(&file(&polygon(&doubled)));
    assert_eq!(only(&drawing).vertices, [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 4.0, 0.0]]);
    assert!(drawing.left_out.is_empty());
}

#[test]
fn old_polylines_keep_bulges_and_leave_out_control_frames_and_meshes() {
    let vertex = |x: f64, y: f64, rest: &str| format!("0 VERTEX\n8 0\n10 {x}\n20 {y}\n30 0\n{rest}");
    let slot = [
        "0 POLYLINE\n66 1\n10 0\n20 0\n30 0\n70 1\n".to_owned(),
        vertex(0.0, 0.0, ""),
        vertex(99.0, 99.0, "70 16\n"),
        vertex(10.0, 0.0, "42 1\n"),
        vertex(10.0, 4.0, ""),
        vertex(0.0, 4.0, "42 1\n"),
        "0 SEQEND\n0 POLYLINE\n70 64\n".to_owned(),
        vertex(1.0, 1.0, "70 192\n"),
        "0 SEQEND\n".to_owned(),
    ];
    let drawing = drawing(&file(&slot.concat()));
    assert_near(only(&drawing).area_mm2, 40.0 + 4.0 * PI);
    assert_eq!(left_out(&drawing), [("POLYLINE", "meshes are no outlines", 1)]);
}

#[test]
fn polylines_in_space_are_read_if_they_are_flat() {
    let in_space = |z: f64| {
        let vertex = |x: f64, y: f64, z: f64| format!("0 VERTEX\n10 {x}\n20 {y}\n30 {z}\n70 32\n");
        let vertices = [vertex(0.0, 0.0, 7.0), vertex(5.0, 0.0, 7.0), vertex(0.0, 4.0, z)];
        format!("0 POLYLINE\n70 9\n{}0 SEQEND\n", vertices.concat())
    };
    assert_eq!(only(&drawing(&file(&in_space(7.0)))).area_mm2, 10.0);
    let drawing = drawing(&file(&(in_space(8.0) + "0 LINE\n10 0\n20 0\n11 9\n21 0\n31 1\n")));
    let reason = "its height changes, so that it is no curve in the plane";
    assert_eq!(left_out(&drawing), [("POLYLINE", reason, 1), ("LINE", reason, 1)]);
}

#[test]
fn entities_seen_from_below_are_mirrored_and_tilted_ones_left_out() {
    let below = "210 0\n220 0\n230 -1\n";
    let slanted = "210 0\n220 0.6\n230 0.8\n";
    let shapes = [
        circle([-7.0, 3.0], 2.0) + below,
        arc([10.0, 0.0], 5.0, 0.0, 90.0) + below,
        polygon(&[[-20.0, 0.0, 0.5], [-24.0, 0.0, 0.0], [-24.0, 6.0, 0.0]]) + below,
        circle([0.0, 0.0], 1.0) + slanted,
    ];
    let drawing = drawing(&file(&shapes.concat()));
    assert_eq!(left_out(&drawing), [("CIRCLE", "its plane is not parallel to that of the drawing", 1)]);
    let [circle, triangle] = &drawing.loops[..] else { panic!("{drawing:?}") };
    assert_near(circle.area_mm2, 4.0 * PI);
    assert!(circle.vertices.iter().all(|v| (v[0] - 7.0).abs() == 2.0 && v[1] == 3.0));
    // The bulge bends out of the triangle before and after it is mirrored.
    let beside = 0.5 * (2.5f64 * 2.5) * (4.0 * 0.5f64.atan() - (4.0 * 0.5f64.atan()).sin());
    assert_near(triangle.area_mm2, 12.0 - beside);
    // The arc runs from 180 to 90 degrees about (-10, 0).
    let [from, to] = drawing.open[0].vertices[..] else { panic!() };
    assert_eq!((from[..2].to_vec(), to[..2].to_vec()), (vec![-15.0, 0.0], vec![-10.0, 5.0]));
    assert_near(from[2], -(PI / 8.0).tan());
}

#[test]
fn an_arc_of_more_than_half_a_turn_has_a_vertex_in_its_middle() {
    let drawing = drawing(&file(&arc([0.0, 0.0], 10.0, 45.0, 315.0)));
    let open = &drawing.open[0];
    assert_eq!((open.vertices.len(), open.vertices[1]), (3, [-10.0, 0.0, (0.75 * PI / 4.0).tan()]));
    assert_near(open.gap_mm, 200f64.sqrt());
}

#[test]
fn ellipses_become_arcs_within_the_tolerance() {
    let ellipse = "0 ELLIPSE\n10 5\n20 -5\n30 0\n11 0\n21 30\n31 0\n40 0.5\n41 0\n42 6.283185307179586\n";
    let mut counts = Vec::new();
    for tolerance_mm in [0.1, 0.01, 0.001] {
        let options = DxfOptions { tolerance_mm, ..options() };
        let drawing = read(file(ellipse).as_bytes(), &options, &Budget::unlimited()).unwrap();
        let outline = only(&drawing);
        counts.push(outline.vertices.len());
        assert!(drawing.deviation_max_mm <= tolerance_mm && drawing.deviation_max_mm > 0.0);
        // An outline within d of the ellipse differs in area by its length times d at most.
        assert!((outline.area_mm2 - PI * 450.0).abs() < drawing.deviation_max_mm * 150.0);
        for v in &outline.vertices {
            assert_near(((v[0] - 5.0) / 15.0).powi(2) + ((v[1] + 5.0) / 30.0).powi(2), 1.0);
        }
    }
    assert!(counts[0] < 16 && counts[2] < 60 && counts[1] < counts[2], "{counts:?}");
}

#[test]
fn an_ellipse_with_equal_axes_is_a_circle_and_its_parts_are_arcs() {
    let ellipse = |start: f64, end: f64| {
        format!("0 ELLIPSE\n10 0\n20 0\n30 0\n11 3\n21 4\n31 0\n40 1\n41 {start}\n42 {end}\n")
    };
    let drawing = drawing(&file(&(ellipse(0.0, 2.0 * PI) + &ellipse(0.5, 2.5))));
    assert_eq!((drawing.loops[0].vertices.len(), drawing.deviation_max_mm), (2, 0.0));
    assert_near(drawing.loops[0].area_mm2, 25.0 * PI);
    assert_eq!(drawing.open[0].vertices.len(), 2);
    assert_near(drawing.open[0].vertices[0][2], 0.5f64.tan());
}

/// The knots of a clamped cubic.
const CUBIC: &str = "0 SPLINE\n70 8\n71 3\n72 8\n73 4\n40 0\n40 0\n40 0\n40 0\n40 1\n40 1\n40 1\n40 1\n";

#[test]
fn a_spline_is_within_the_tolerance_of_its_arcs_and_keeps_its_ends() {
    let points = "10 0\n20 0\n10 0\n20 30\n10 30\n20 30\n10 30\n20 0\n";
    let text = file(&(CUBIC.to_owned() + points + &line([0.0, 0.0], [30.0, 0.0])));
    let drawing = drawing(&text);
    let outline = only(&drawing);
    assert!(drawing.deviation_max_mm <= 0.001 && drawing.bridged_max_mm == 0.0);
    // The area under x = 90 t^2 - 60 t^3, y = 90 t (1 - t) is that of 90 * 180 * t^2 (1 - t)^2.
    assert!((outline.area_mm2 - 90.0 * 180.0 / 30.0).abs() < 0.001 * outline.length_mm);
    assert!(outline.vertices.len() < 60, "{}", outline.vertices.len());
}

#[test]
fn control_points_win_over_fit_points_and_fit_points_serve_without() {
    let points = "10 0\n20 0\n30 0\n10 10\n20 0\n30 0\n10 20\n20 0\n30 0\n10 30\n20 0\n30 0\n";
    let both = drawing(&file(&(CUBIC.to_owned() + points + "11 0\n21 0\n11 99\n21 99\n")));
    assert_eq!(both.open[0].vertices, [[0.0, 0.0, 0.0], [30.0, 0.0, 0.0]]);
    let fit = "0 SPLINE\n70 8\n71 3\n74 3\n11 0\n21 0\n11 3\n21 4\n11 3\n21 4\n11 3\n21 6\n";
    let fit = drawing(&file(fit));
    let vertices = &fit.open[0].vertices;
    assert_eq!((vertices[0][..2].to_vec(), vertices[vertices.len() - 1]), (vec![0.0; 2], [3.0, 6.0, 0.0]));
    assert!(vertices.len() > 3 && fit.deviation_max_mm <= 0.001);
}

#[test]
fn fit_points_obey_tangents_and_closed_ones_have_no_kink() {
    // Both tangents point along y, and the middle is at (5, 0).
    let given = drawing(&file("0 SPLINE\n70 8\n71 3\n11 0\n21 0\n11 10\n21 0\n12 0\n22 2\n13 0\n23 5\n"));
    let vertices = &given.open[0].vertices;
    // y = 10 u (1 - u) (1 - 2 u) has its largest value at u = (3 - sqrt 3) / 6.
    let highest = vertices.iter().map(|v| v[1]).fold(0.0, f64::max);
    assert!((highest - 10.0 / (6.0 * 3f64.sqrt())).abs() < 0.02, "{highest}");
    let square = "0 SPLINE\n70 9\n71 3\n11 10\n21 0\n11 0\n21 10\n11 -10\n21 0\n11 0\n21 -10\n";
    let closed = drawing(&file(square));
    let outline = only(&closed);
    // By symmetry the curve is normal to the x axis at (10, 0), where it is farthest to the right.
    let farthest = outline.vertices.iter().map(|v| v[0]).fold(0.0, f64::max);
    assert!((farthest - 10.0).abs() < 0.002, "{farthest}");
    assert!((outline.area_mm2 - 100.0 * PI).abs() < 10.0);
}

#[test]
fn kinks_of_splines_stay_corners() {
    // Two parabolas that meet with a right angle at (10, 0), and a degree of 1.
    let knots = "40 0\n40 0\n40 0\n40 1\n40 1\n40 2\n40 2\n40 2\n";
    let points = "10 0\n20 0\n10 5\n20 5\n10 10\n20 0\n10 15\n20 5\n10 20\n20 0\n";
    let curved = drawing(&file(&format!("0 SPLINE\n71 2\n72 8\n73 5\n{knots}{points}")));
    assert!(curved.open[0].vertices.iter().any(|v| v[..2] == [10.0, 0.0]));
    let knots = "40 0\n40 0\n40 1\n40 2\n40 3\n40 4\n40 4\n";
    let polyline = drawing(&file(&format!("0 SPLINE\n71 1\n72 7\n73 5\n{knots}{points}")));
    let found: Vec<_> = polyline.open[0].vertices.iter().map(|v| [v[0], v[1]]).collect();
    assert_eq!(found, [[0.0, 0.0], [5.0, 5.0], [10.0, 0.0], [15.0, 5.0], [20.0, 0.0]]);
}

#[test]
fn doubled_ends_and_rounded_knots_of_splines_do_no_harm() {
    let points = "10 0\n20 0\n10 0\n20 0\n10 30\n20 30\n10 30\n20 0\n10 30\n20 0\n";
    let knots = "40 0\n40 0\n40 0\n40 0\n40 0.5\n40 1\n40 0.9999999999999\n40 1\n40 1\n";
    let drawing = drawing(&file(&format!("0 SPLINE\n71 3\n72 9\n73 5\n{knots}{points}")));
    let vertices = &drawing.open[0].vertices;
    assert_eq!((vertices[0][0], vertices[vertices.len() - 1][..2].to_vec()), (0.0, vec![30.0, 0.0]));
    assert!(drawing.deviation_max_mm <= 0.001);
}

#[test]
fn a_circle_as_a_rational_spline_is_closed_and_has_few_arcs() {
    let w = 0.5f64.sqrt();
    let corner = [[5, 0], [5, 5], [0, 5], [-5, 5], [-5, 0], [-5, -5], [0, -5], [5, -5], [5, 0]];
    let points: String = corner.iter().map(|[x, y]| format!("10 {x}\n20 {y}\n30 0\n")).collect();
    let weights: String = (0..9).map(|k| format!("41 {}\n", if k % 2 == 0 { 1.0 } else { w })).collect();
    let knots: String = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4].iter().map(|k| format!("40 {k}\n")).collect();
    let drawing = drawing(&file(&format!("0 SPLINE\n70 12\n71 2\n72 12\n73 9\n{knots}{weights}{points}")));
    let outline = only(&drawing);
    assert!(outline.vertices.len() <= 4 && drawing.deviation_max_mm < 1e-6, "{drawing:?}");
    assert!((outline.area_mm2 - 25.0 * PI).abs() < 1e-9);
}

#[test]
fn a_spline_may_stand_still_between_two_knots() {
    // Three cubics: a line, a piece whose control points are equal, and a line.
    let knots: String =
        [0, 0, 0, 0, 1, 1, 1, 2, 2, 2, 3, 3, 3, 3].iter().map(|k| format!("40 {k}\n")).collect();
    let x = [0, 1, 2, 3, 3, 3, 3, 3, 3, 3];
    let y = [0, 0, 0, 0, 0, 0, 0, 1, 2, 3];
    let points: String = x.iter().zip(y).map(|(x, y)| format!("10 {x}\n20 {y}\n")).collect();
    let drawing = drawing(&file(&format!("0 SPLINE\n71 3\n72 14\n73 10\n{knots}{points}")));
    assert_eq!(drawing.open[0].vertices, [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 3.0, 0.0]]);
}

#[test]
fn a_cusp_is_drawn_within_the_tolerance() {
    let points = "10 0\n20 0\n10 30\n20 30\n10 0\n20 30\n10 30\n20 0\n";
    let drawing = drawing(&file(&(CUBIC.to_owned() + points)));
    assert!(drawing.deviation_max_mm <= 0.001 && drawing.open[0].vertices.len() < 100);
}

#[test]
fn what_is_no_outline_is_left_out_with_its_reason() {
    let others =
        "0 TEXT\n1 words\n0 MTEXT\n1 more\n0 POINT\n10 1\n20 2\n0 HATCH\n2 SOLID\n0 TEXT\n1 end\n0 FOO\n";
    let more = [circle([0.0, 0.0], 0.0), line([1.0, 1.0], [1.0, 1.0]), line([0.0, 0.0], [2e9, 0.0])];
    let hidden = "0 LINE\n67 1\n10 0\n20 0\n11 1\n21 0\n0 LINE\n60 1\n10 0\n20 0\n11 1\n21 0\n";
    let drawing = drawing(&file(&(others.to_owned() + &more.concat() + hidden)));
    let expected = [
        ("TEXT", "texts are no outlines", 2),
        ("MTEXT", "texts are no outlines", 1),
        ("POINT", "points are no outlines", 1),
        ("HATCH", "hatches are no outlines", 1),
        ("FOO", "entities of this kind are not supported", 1),
        ("CIRCLE", "it has no radius above zero", 1),
        ("LINE", "it has no length", 1),
        ("LINE", "it lies more than 1e9 mm from the origin", 1),
        ("LINE", "it is drawn in paper space", 1),
        ("LINE", "it is invisible", 1),
    ];
    assert_eq!(left_out(&drawing), expected);
}

#[test]
fn a_fit_spline_that_is_not_marked_closed_keeps_its_tangents() {
    // From the origin to the right, and back to it from above.
    let points = "11 0\n21 0\n11 10\n21 0\n11 10\n21 10\n11 0\n21 0\n";
    let spline = |flag: i32| format!("0 SPLINE\n8 0\n70 {flag}\n12 1\n22 0\n13 0\n23 -1\n{points}");
    let area = |flag: i32| only(&drawing(&file(&spline(flag)))).area_mm2;
    let plain = format!("0 SPLINE\n8 0\n70 9\n{points}");
    assert_near(area(9), only(&drawing(&file(&plain))).area_mm2);
    assert!((area(8) - area(9)).abs() > 1.0, "{} {}", area(8), area(9));
}

#[test]
fn the_last_bulge_of_an_open_polyline_means_nothing() {
    let open = |bulge: f64| format!("0 LWPOLYLINE\n8 0\n90 2\n70 0\n10 0\n20 0\n10 5\n20 1\n42 {bulge}\n");
    let drawing = drawing(&file(&(open(0.5) + &open(0.0))));
    assert_eq!((drawing.open.len(), left_out(&drawing)), (1, vec![("LWPOLYLINE", "drawn twice", 1)]));
}
