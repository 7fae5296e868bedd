//! Whole and trimmed faces of planes and of surfaces of revolution.

use std::f64::consts::{PI, TAU};

use super::shapes::{check, check_box, circle, level, ring, sphere, square, wall};
use super::writer::{Length, UP, Writer, read_text};
use crate::step::model::Face;
use crate::unit::Unit;

const X: [f64; 3] = [1.0, 0.0, 0.0];

/// The only face of a file.
fn one(w: Writer, face: usize) -> Face {
    let mut model = w.model(&[face]);
    assert_eq!(model.left_out, []);
    assert_eq!(model.faces.len(), 1);
    model.faces.remove(0)
}

#[test]
fn a_square_has_its_area_in_every_unit() {
    let units =
        [(Length::Millimetre, 1.0), (Length::Metre, 1000.0), (Length::Inch, 25.4), (Length::None, 1.0)];
    let names = [Some(Unit::Millimetre), Some(Unit::Metre), Some(Unit::Inch), None];
    for ((length, mm), name) in units.into_iter().zip(names) {
        let mut w = Writer::new(length);
        let face = square(&mut w, 3.0, 2.0);
        let model = w.model(&[face]);
        let face = &model.faces[0];
        check(face, 9.0 * mm * mm);
        check_box(face, [0.0, 0.0, 2.0 * mm], [3.0 * mm, 3.0 * mm, 2.0 * mm]);
        assert!(face.is_untrimmed);
        assert_eq!((model.unit, model.is_unit_stated), (name, name.is_some()));
        assert_eq!(model.mm_per_unit, mm);
    }
}

#[test]
fn a_plane_with_four_straight_sides_is_a_patch_whatever_its_frame() {
    let mut w = Writer::new(Length::Millimetre);
    // A side in two parts, and a frame that is turned against the sides.
    let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [4.0, 0.0, 0.0], [5.0, 3.0, 0.0], [1.0, 2.0, 0.0]];
    let bound = w.polygon(&corners);
    let frame = w.frame([7.0, 8.0, 0.0], UP, [0.6, 0.8, 0.0]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    let face = w.face(&[bound], plane, true);
    let face = one(w, face);
    assert!(face.is_untrimmed);
    check(&face, 9.5);
    assert_eq!(face.nurbs.control_points.concat().len(), 4);
}

#[test]
fn a_triangle_and_a_plane_with_a_round_hole_are_trimmed() {
    let mut w = Writer::new(Length::Millimetre);
    let bound = w.polygon(&[[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [0.0, 3.0, 0.0]]);
    let face = level(&mut w, &[bound], 0.0);
    let face = one(w, face);
    assert!(!face.is_untrimmed);
    check(&face, 6.0);

    let mut w = Writer::new(Length::Millimetre);
    let outer = w.polygon(&[[-5.0, -5.0, 1.0], [5.0, -5.0, 1.0], [5.0, 5.0, 1.0], [-5.0, 5.0, 1.0]]);
    let hole = ring(&mut w, 2.0, 1.0);
    for is_forward in [false, true] {
        let mut w = w.copy();
        // The wrong direction of a hole in a plane does no harm.
        let inner = w.bound(&[(hole, is_forward)]);
        let face = level(&mut w, &[inner, outer], 1.0);
        let face = one(w, face);
        assert!(!face.is_untrimmed);
        check(&face, 100.0 - 4.0 * PI);
        assert_eq!(face.trim.len(), 2);
    }
}

#[test]
fn a_whole_cylinder_is_one_untrimmed_face_with_and_without_a_seam() {
    for has_seam in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let face = if has_seam {
            let [low, high] = [0.0, 5.0].map(|z| w.vertex([3.0, 0.0, z]));
            let frames = [0.0, 5.0].map(|z| w.upright([0.0, 0.0, z]));
            let circles = frames.map(|frame| w.add(format!("CIRCLE('',#{frame},3.)")));
            let rings = [w.edge([low, low], circles[0]), w.edge([high, high], circles[1])];
            let line = w.line([3.0, 0.0, 0.0], [3.0, 0.0, 5.0]);
            let seam = w.edge([low, high], line);
            let bound = w.bound(&[(rings[0], true), (seam, true), (rings[1], false), (seam, false)]);
            let cylinder = w.add(format!("CYLINDRICAL_SURFACE('',#{},3.)", frames[0]));
            w.face(&[bound], cylinder, true)
        } else {
            let rings = [ring(&mut w, 3.0, 0.0), ring(&mut w, 3.0, 5.0)];
            wall(&mut w, 3.0, rings, false)
        };
        let face = one(w, face);
        check(&face, TAU * 15.0);
        check_box(&face, [-3.0, -3.0, 0.0], [3.0, 3.0, 5.0]);
        assert!(face.is_untrimmed, "{has_seam}");
        assert!((face.domain[0][1] - face.domain[0][0] - TAU).abs() < 1e-12);
    }
}

#[test]
fn a_cone_ends_at_its_apex_with_and_without_a_bound_there() {
    for has_point in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let frame = w.upright([0.0; 3]);
        // Half the angle is 45 degrees: the apex is 2 mm below the circle.
        let cone = w.add(format!("CONICAL_SURFACE('',#{frame},2.,{:?})", PI / 4.0));
        let top = ring(&mut w, 2.0, 0.0);
        let mut bounds = vec![w.bound(&[(top, false)])];
        if has_point {
            bounds.push(w.point_bound([0.0, 0.0, -2.0]));
        }
        let face = w.face(&bounds, cone, true);
        let face = one(w, face);
        check(&face, PI * 2.0 * 8.0_f64.sqrt());
        check_box(&face, [-2.0, -2.0, -2.0], [2.0, 2.0, 0.0]);
        assert!(face.is_untrimmed);
    }
}

#[test]
fn a_cone_in_degrees_has_its_angle() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let cone = w.add(format!("CONICAL_SURFACE('',#{frame},2.,30.)"));
    let rings = [ring(&mut w, 2.0, 0.0), ring(&mut w, 2.0 + 30.0_f64.to_radians().tan(), 1.0)];
    let bounds = [w.bound(&[(rings[0], true)]), w.bound(&[(rings[1], false)])];
    let face = w.face(&bounds, cone, true);
    let text = w.of_faces(&[face]).replace(
        "#2=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));",
        "#2=(CONVERSION_BASED_UNIT('DEGREE',#3)NAMED_UNIT(#5)PLANE_ANGLE_UNIT());\n\
         #3=PLANE_ANGLE_MEASURE_WITH_UNIT(PLANE_ANGLE_MEASURE(0.0174532925199433),#7);\n\
         #7=(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.));",
    );
    let model = read_text(&text).unwrap();
    let (r, slant) = (30.0_f64.to_radians().tan(), 1.0 / 30.0_f64.to_radians().cos());
    let area = PI * (4.0 + r) * slant;
    assert!((model.faces[0].area_mm2 / area - 1.0).abs() < 1e-9);
}

#[test]
fn a_sphere_without_edges_is_whole() {
    for has_point in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let surface = sphere(&mut w, 3.0);
        let bounds = if has_point { vec![w.point_bound([0.0, 0.0, 3.0])] } else { Vec::new() };
        let face = w.face(&bounds, surface, true);
        let face = one(w, face);
        check(&face, 36.0 * PI);
        check_box(&face, [-3.0; 3], [3.0; 3]);
        assert!(face.is_untrimmed);
    }
}

#[test]
fn a_circle_cuts_a_sphere_into_the_part_to_its_left() {
    // A circle at height 1 of a sphere of radius 3; seen from above it goes counterclockwise.
    for (is_forward, same_sense, area) in [
        (true, true, TAU * 3.0 * 2.0),
        (false, true, TAU * 3.0 * 4.0),
        // A face whose normal points inwards lies on the other side of its bound.
        (true, false, TAU * 3.0 * 4.0),
        (false, false, TAU * 3.0 * 2.0),
    ] {
        let mut w = Writer::new(Length::Millimetre);
        let surface = sphere(&mut w, 3.0);
        let edge = ring(&mut w, 8.0_f64.sqrt(), 1.0);
        let bound = w.bound(&[(edge, is_forward)]);
        let face = w.face(&[bound], surface, same_sense);
        let face = one(w, face);
        check(&face, area);
        assert!(face.is_untrimmed);
    }
}

#[test]
fn a_circle_through_both_poles_of_a_sphere_bounds_half_of_it() {
    let mut w = Writer::new(Length::Millimetre);
    let surface = sphere(&mut w, 3.0);
    // In the plane y = 0; counterclockwise seen from +y.
    let edge = circle(&mut w, [0.0; 3], [0.0, 1.0, 0.0], [0.6, 0.0, 0.8], 3.0);
    let bound = w.bound(&[(edge, true)]);
    let face = w.face(&[bound], surface, true);
    let face = one(w, face);
    check(&face, 18.0 * PI);
    check_box(&face, [-3.0, 0.0, -3.0], [3.0, 3.0, 3.0]);
}

#[test]
fn a_small_hole_in_a_sphere_leaves_the_rest() {
    let mut w = Writer::new(Length::Millimetre);
    let surface = sphere(&mut w, 3.0);
    // About the x axis at x = 2; clockwise seen from +x.
    let edge = circle(&mut w, [2.0, 0.0, 0.0], X, [0.0, 1.0, 0.0], 5.0_f64.sqrt());
    let bound = w.bound(&[(edge, false)]);
    let face = w.face(&[bound], surface, true);
    let face = one(w, face);
    check(&face, TAU * 3.0 * 5.0);
    check_box(&face, [-3.0, -3.0, -3.0], [2.0, 3.0, 3.0]);
    assert!(!face.is_untrimmed);
}

fn torus(w: &mut Writer, major: f64, minor: f64) -> usize {
    let frame = w.upright([0.0; 3]);
    w.add(format!("TOROIDAL_SURFACE('',#{frame},{major:?},{minor:?})"))
}

#[test]
fn a_torus_without_edges_is_whole() {
    let mut w = Writer::new(Length::Millimetre);
    let surface = torus(&mut w, 5.0, 2.0);
    let face = w.face(&[], surface, true);
    let face = one(w, face);
    check(&face, TAU * 5.0 * TAU * 2.0);
    check_box(&face, [-7.0, -7.0, -2.0], [7.0, 7.0, 2.0]);
    assert!(face.is_untrimmed);
}

#[test]
fn two_circles_across_a_torus_bound_an_elbow() {
    // From u = 0 to a quarter turn; the face lies to the left of both circles.
    let mut w = Writer::new(Length::Millimetre);
    let surface = torus(&mut w, 5.0, 2.0);
    let first = circle(&mut w, [5.0, 0.0, 0.0], [0.0, -1.0, 0.0], X, 2.0);
    let second = circle(&mut w, [0.0, 5.0, 0.0], X, [0.0, 1.0, 0.0], 2.0);
    for swapped in [false, true] {
        let mut w = w.copy();
        let bounds = [w.bound(&[(first, swapped)]), w.bound(&[(second, !swapped)])];
        let face = w.face(&bounds, surface, true);
        let face = one(w, face);
        let turn = if swapped { 0.75 * TAU } else { 0.25 * TAU };
        check(&face, turn * 5.0 * TAU * 2.0);
        assert!(face.is_untrimmed);
    }
}

#[test]
fn a_torus_that_cuts_itself_has_an_outer_and_an_inner_part() {
    let half = (-0.4_f64).acos();
    for (is_outer, range, centre) in [("T", half, 2.0), ("F", PI - half, -2.0)] {
        let mut w = Writer::new(Length::Millimetre);
        let frame = w.upright([0.0; 3]);
        let surface = w.add(format!("DEGENERATE_TOROIDAL_SURFACE('',#{frame},2.,5.,.{is_outer}.)"));
        let face = w.face(&[], surface, true);
        let face = one(w, face);
        // The integral of the radius over the arc, about the axis.
        check(&face, TAU * 5.0 * (2.0 * range * centre + 10.0 * range.sin()));
        assert!(face.is_untrimmed);
    }
}

/// The area of a half disc below the x axis, or above it.
#[test]
fn an_edge_against_its_curve_takes_the_other_way() {
    for (sense, low, high) in [("T", 0.0, 2.0), ("F", -2.0, 0.0)] {
        let mut w = Writer::new(Length::Millimetre);
        let frame = w.upright([0.0; 3]);
        let ends = [[2.0, 0.0, 0.0], [-2.0, 0.0, 0.0]];
        let vertices = ends.map(|p| w.vertex(p));
        let arc = w.add(format!("CIRCLE('',#{frame},2.)"));
        let arc = w.add(format!("EDGE_CURVE('',#{},#{},#{arc},.{sense}.)", vertices[0], vertices[1]));
        let line = w.line(ends[1], ends[0]);
        let line = w.edge([vertices[1], vertices[0]], line);
        let bound = w.bound(&[(arc, true), (line, true)]);
        let face = level(&mut w, &[bound], 0.0);
        let face = one(w, face);
        check(&face, TAU);
        check_box(&face, [-2.0, low, 0.0], [2.0, high, 0.0]);
    }
}

#[test]
fn polygons_bound_facets_with_and_without_a_surface() {
    let mut w = Writer::new(Length::Millimetre);
    let corners = [[0.0; 3], [4.0, 0.0, 0.0], [4.0, 3.0, 1.0], [0.0, 3.0, 1.0]].map(|p| w.point(p));
    let corners = corners.map(|number| format!("#{number}")).join(",");
    let polygon = w.add(format!("POLY_LOOP('',({corners}))"));
    let bound = w.add(format!("FACE_OUTER_BOUND('',#{polygon},.T.)"));
    let frame = w.frame([0.0; 3], [0.0, -1.0, 3.0], X);
    let plane = w.add(format!("PLANE('',#{frame})"));
    let faces =
        [w.add(format!("FACE('',(#{bound}))")), w.add(format!("FACE_SURFACE('',(#{bound}),#{plane},.T.)"))];
    let shell = w.add(format!("CLOSED_SHELL('',(#{},#{}))", faces[0], faces[1]));
    let solid = w.add(format!("FACETED_BREP('',#{shell})"));
    w.representation(&[solid]);
    let model = read_text(&w.text()).unwrap();
    assert_eq!(model.faces.len(), 2);
    for face in &model.faces {
        check(face, 4.0 * 10.0_f64.sqrt());
        assert!(face.is_untrimmed && face.normal([1.0, 1.0]).unwrap().z > 0.0);
    }
}

#[test]
fn a_polyline_and_a_closed_spline_are_edges() {
    // A square as one closed polyline, and a curve of degree 1 over the same corners.
    let corners = [[0.0; 3], [2.0, 0.0, 0.0], [2.0, 2.0, 0.0], [0.0, 2.0, 0.0], [0.0; 3]];
    for is_spline in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let points = corners.map(|p| format!("#{}", w.point(p))).join(",");
        let curve = if is_spline {
            w.add(format!(
                "B_SPLINE_CURVE_WITH_KNOTS('',1,({points}),.UNSPECIFIED.,.T.,.F.,(2,1,1,1,2),(0.,1.,2.,3.,4.),.U.)"
            ))
        } else {
            w.add(format!("POLYLINE('',({points}))"))
        };
        // The edge begins in the middle of a side, and passes the joint of the curve.
        let vertex = w.vertex([1.0, 0.0, 0.0]);
        let edge = w.edge([vertex, vertex], curve);
        let bound = w.bound(&[(edge, true)]);
        let face = level(&mut w, &[bound], 0.0);
        let face = one(w, face);
        check(&face, 4.0);
        check_box(&face, [0.0; 3], [2.0, 2.0, 0.0]);
    }
}

#[test]
fn a_seam_between_loops_that_begin_apart_passes_no_hole() {
    // The upper circle begins on the other side than the lower one, where a hole is.
    let mut w = Writer::new(Length::Millimetre);
    let low = ring(&mut w, 3.0, 0.0);
    let high = circle(&mut w, [0.0, 0.0, 5.0], UP, [-1.0, 0.0, 0.0], 3.0);
    let mut whole = w.copy();
    let face = wall(&mut whole, 3.0, [low, high], false);
    let face = one(whole, face);
    check(&face, TAU * 15.0);
    assert!(face.is_untrimmed);

    // A hole about x: the part of the cylinder in a square of parameters, as four edges.
    let (s, c) = 0.5_f64.sin_cos();
    let corners = [
        [3.0 * c, -3.0 * s, 2.0],
        [3.0 * c, 3.0 * s, 2.0],
        [3.0 * c, 3.0 * s, 3.0],
        [3.0 * c, -3.0 * s, 3.0],
    ];
    let vertices = corners.map(|p| w.vertex(p));
    let arcs = [2.0, 3.0].map(|z| {
        let frame = w.upright([0.0, 0.0, z]);
        w.add(format!("CIRCLE('',#{frame},3.)"))
    });
    let arcs = [w.edge([vertices[0], vertices[1]], arcs[0]), w.edge([vertices[3], vertices[2]], arcs[1])];
    let sides = [w.line(corners[1], corners[2]), w.line(corners[0], corners[3])];
    let sides = [w.edge([vertices[1], vertices[2]], sides[0]), w.edge([vertices[0], vertices[3]], sides[1])];
    let hole = w.bound(&[(sides[1], true), (arcs[1], true), (sides[0], false), (arcs[0], false)]);
    let bounds = [w.bound(&[(low, true)]), w.bound(&[(high, false)]), hole];
    let frame = w.upright([0.0; 3]);
    let cylinder = w.add(format!("CYLINDRICAL_SURFACE('',#{frame},3.)"));
    let face = w.face(&bounds, cylinder, true);
    let face = one(w, face);
    check(&face, TAU * 15.0 - 3.0);
    assert!(!face.is_untrimmed);
    // The trim is one turn wide, with the hole inside.
    let [from, to] = face.domain[0];
    assert!((to - from - TAU).abs() < 1e-9);
    assert!(face.trim[1].iter().all(|place| place[0] > from && place[0] < to));
    check_box(&face, [-3.0, -3.0, 0.0], [3.0, 3.0, 5.0]);
}

#[test]
fn loops_that_begin_where_the_angle_jumps_are_joined() {
    // Circles that begin at half a turn, where the angle of the start is half a turn up or down.
    for (x, z) in
        [(X, UP), (X, [0.0, 0.0, -1.0]), ([-1.0, 0.0, 0.0], UP), ([-1.0, 0.0, 0.0], [0.0, 0.0, -1.0])]
    {
        for y in [0.0, 1e-16, -1e-16] {
            let mut w = Writer::new(Length::Millimetre);
            let rings = [0.0, 5.0].map(|h| {
                let frame = w.frame([0.0, 0.0, h], z, x);
                let (curve, vertex) = (w.add(format!("CIRCLE('',#{frame},3.)")), w.vertex([-3.0, y, h]));
                w.edge([vertex, vertex], curve)
            });
            let face = wall(&mut w, 3.0, rings, z[2] < 0.0);
            let face = one(w, face);
            check(&face, TAU * 15.0);
            assert!(face.is_untrimmed && face.edge_deviation_mm < 1e-9);
        }
    }
}

#[test]
fn edges_beside_a_surface_bound_what_is_nearest_to_them() {
    // Quarter circles of radius 3.02 about the axis of a cylinder of radius 3, at heights 0 and 5.
    let mut w = Writer::new(Length::Millimetre);
    let corners = [[3.02, 0.0, 0.0], [0.0, 3.02, 0.0], [0.0, 3.02, 5.0], [3.02, 0.0, 5.0]];
    let vertices = corners.map(|p| w.vertex(p));
    let arcs = [0.0, 5.0].map(|z| {
        let frame = w.upright([0.0, 0.0, z]);
        w.add(format!("CIRCLE('',#{frame},3.02)"))
    });
    let arcs = [w.edge([vertices[0], vertices[1]], arcs[0]), w.edge([vertices[3], vertices[2]], arcs[1])];
    let sides = [w.line(corners[1], corners[2]), w.line(corners[3], corners[0])];
    let sides = [w.edge([vertices[1], vertices[2]], sides[0]), w.edge([vertices[3], vertices[0]], sides[1])];
    let bound = w.bound(&[(arcs[0], true), (sides[0], true), (arcs[1], false), (sides[1], true)]);
    let frame = w.upright([0.0; 3]);
    let cylinder = w.add(format!("CYLINDRICAL_SURFACE('',#{frame},3.)"));
    let face = w.face(&[bound], cylinder, true);
    let face = one(w, face);
    assert!((face.edge_deviation_mm - 0.02).abs() < 1e-9);
    assert!((face.area_mm2 / (7.5 * PI) - 1.0).abs() < 1e-9, "{}", face.area_mm2);
    assert!(face.is_untrimmed);
}
