//! Faces of splines, extrusions and revolutions.

use std::f64::consts::{PI, TAU};

use super::shapes::{check, check_box, circle, level, ring};
use super::writer::{Length, UP, Writer, read_text};
use crate::step::model::Face;

const X: [f64; 3] = [1.0, 0.0, 0.0];

fn one(w: Writer, face: usize) -> Face {
    let mut model = w.model(&[face]);
    assert_eq!(model.left_out, []);
    model.faces.remove(0)
}

/// The control points of a surface, by rows of u.
fn net(w: &mut Writer, rows: &[Vec<[f64; 3]>]) -> String {
    let row = |w: &mut Writer, row: &[[f64; 3]]| {
        let points: Vec<String> = row.iter().map(|p| format!("#{}", w.point(*p))).collect();
        format!("({})", points.join(","))
    };
    let rows: Vec<String> = rows.iter().map(|points| row(w, points)).collect();
    format!("({})", rows.join(","))
}

/// A plane of 10 by 10 mm as a bicubic spline of two by one spans with an uneven net.
fn flat_spline(w: &mut Writer) -> usize {
    let places = [0.0, 1.0, 3.0, 8.0, 10.0];
    let rows: Vec<Vec<[f64; 3]>> =
        places.iter().map(|x| [0.0, 2.0, 5.0, 10.0].iter().map(|y| [*x, *y, 1.0]).collect()).collect();
    let net = net(w, &rows);
    w.add(format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',3,3,{net},.UNSPECIFIED.,.F.,.F.,.F.,(4,1,4),(4,4),(0.,0.4,1.),(2.,3.),.UNSPECIFIED.)"
    ))
}

#[test]
fn a_spline_within_its_sides_is_untrimmed() {
    let mut w = Writer::new(Length::Millimetre);
    let surface = flat_spline(&mut w);
    let bound = w.polygon(&[[0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [10.0, 10.0, 1.0], [0.0, 10.0, 1.0]]);
    let face = w.face(&[bound], surface, true);
    let face = one(w, face);
    check(&face, 100.0);
    check_box(&face, [0.0, 0.0, 1.0], [10.0, 10.0, 1.0]);
    assert!(face.is_untrimmed);
    assert_eq!(face.domain, [[0.0, 1.0], [2.0, 3.0]]);
}

#[test]
fn a_circle_trims_a_spline() {
    for is_hole in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let surface = flat_spline(&mut w);
        let edge = circle(&mut w, [5.0, 5.0, 1.0], UP, X, 3.0);
        let mut bounds = vec![w.bound(&[(edge, !is_hole)])];
        if is_hole {
            bounds.push(w.polygon(&[[0.0, 0.0, 1.0], [10.0, 0.0, 1.0], [10.0, 10.0, 1.0], [0.0, 10.0, 1.0]]));
        }
        let face = w.face(&bounds, surface, true);
        let face = one(w, face);
        let area = if is_hole { 100.0 - 9.0 * PI } else { 9.0 * PI };
        assert!((face.area_mm2 / area - 1.0).abs() < 1e-7, "{}", face.area_mm2 / area - 1.0);
        assert!(!face.is_untrimmed);
        let low = if is_hole { 0.0 } else { 2.0 };
        check_box(&face, [low, low, 1.0], [10.0 - low, 10.0 - low, 1.0]);
    }
}

#[test]
fn a_rational_spline_in_several_parts_is_a_quarter_of_a_cylinder() {
    let mut w = Writer::new(Length::Millimetre);
    let rows = [[3.0, 0.0], [3.0, 3.0], [0.0, 3.0]].map(|[x, y]| vec![[x, y, 0.0], [x, y, 5.0]]);
    let net = net(&mut w, &rows);
    let weight = 0.5_f64.sqrt();
    let surface = w.add(format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,{net},.UNSPECIFIED.,.F.,.F.,.F.)\
         B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)GEOMETRIC_REPRESENTATION_ITEM()\
         RATIONAL_B_SPLINE_SURFACE(((1.,1.),({weight:?},{weight:?}),(1.,1.)))REPRESENTATION_ITEM('')SURFACE())"
    ));
    let corners = [[3.0, 0.0, 0.0], [0.0, 3.0, 0.0], [0.0, 3.0, 5.0], [3.0, 0.0, 5.0]];
    let vertices = corners.map(|p| w.vertex(p));
    let arcs = [0.0, 5.0].map(|z| {
        let frame = w.upright([0.0, 0.0, z]);
        w.add(format!("CIRCLE('',#{frame},3.)"))
    });
    let low = w.edge([vertices[0], vertices[1]], arcs[0]);
    let high = w.edge([vertices[3], vertices[2]], arcs[1]);
    let sides = [w.line(corners[1], corners[2]), w.line(corners[3], corners[0])];
    let sides = [w.edge([vertices[1], vertices[2]], sides[0]), w.edge([vertices[3], vertices[0]], sides[1])];
    let bound = w.bound(&[(low, true), (sides[0], true), (high, false), (sides[1], true)]);
    let face = w.face(&[bound], surface, true);
    let face = one(w, face);
    check(&face, 7.5 * PI);
    assert!(face.is_untrimmed);
}

/// A whole sphere of radius 3 as one rational spline: closed along u, with poles along v.
#[test]
fn a_closed_spline_with_poles_needs_no_bounds() {
    let mut w = Writer::new(Length::Millimetre);
    let round = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let profile = [[0, -1], [1, -1], [1, 0], [1, 1], [0, 1]];
    let rows: Vec<Vec<[f64; 3]>> = round
        .iter()
        .map(|c| {
            profile.iter().map(|p| [c[0] * p[0], c[1] * p[0], p[1]].map(|x| 3.0 * f64::from(x))).collect()
        })
        .collect();
    let net = net(&mut w, &rows);
    let weight = |k: usize| if k.is_multiple_of(2) { 1.0 } else { 0.5_f64.sqrt() };
    let row = |i: usize| {
        let weights: Vec<String> = (0..5).map(|j| format!("{:?}", weight(i) * weight(j))).collect();
        format!("({})", weights.join(","))
    };
    let weights: Vec<String> = (0..9).map(row).collect();
    let surface = w.add(format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,2,{net},.UNSPECIFIED.,.T.,.F.,.F.)\
         B_SPLINE_SURFACE_WITH_KNOTS((3,2,2,2,3),(3,2,3),(0.,1.,2.,3.,4.),(0.,1.,2.),.UNSPECIFIED.)\
         RATIONAL_B_SPLINE_SURFACE(({}))SURFACE())",
        weights.join(",")
    ));
    let equator = ring(&mut w, 3.0, 0.0);
    let mut half = w.copy();
    let face = w.face(&[], surface, true);
    let whole = one(w, face);
    check(&whole, 36.0 * PI);
    assert!(whole.is_untrimmed);

    let bound = half.bound(&[(equator, true)]);
    let face = half.face(&[bound], surface, true);
    let half = one(half, face);
    check(&half, 18.0 * PI);
    check_box(&half, [-3.0, -3.0, 0.0], [3.0, 3.0, 3.0]);
}

#[test]
fn bezier_and_quasi_uniform_splines_have_knots_of_their_own() {
    for kind in ["BEZIER_SURFACE", "QUASI_UNIFORM_SURFACE"] {
        let mut w = Writer::new(Length::Millimetre);
        let rows: Vec<Vec<[f64; 3]>> =
            [0.0, 5.0, 10.0].iter().map(|x| [0.0, 4.0].iter().map(|y| [*x, *y, 0.0]).collect()).collect();
        let net = net(&mut w, &rows);
        let surface = w.add(format!("{kind}('',2,1,{net},.UNSPECIFIED.,.F.,.F.,.F.)"));
        let bound = w.polygon(&[[0.0; 3], [10.0, 0.0, 0.0], [10.0, 4.0, 0.0], [0.0, 4.0, 0.0]]);
        let face = w.face(&[bound], surface, true);
        let face = one(w, face);
        check(&face, 40.0);
        assert!(face.is_untrimmed, "{kind}");
    }
}

/// y = x^2 / 4 from x = -2 to 2, as a parabola and as a spline, moved along z by 3.
#[test]
fn a_parabola_makes_an_extrusion_of_its_length() {
    for is_spline in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let ends = [[-2.0, 1.0, 0.0], [2.0, 1.0, 0.0]];
        let curve = |w: &mut Writer, z: f64| {
            if is_spline {
                let points =
                    [[-2.0, 1.0, z], [0.0, -1.0, z], [2.0, 1.0, z]].map(|p| format!("#{}", w.point(p)));
                w.add(format!(
                    "B_SPLINE_CURVE_WITH_KNOTS('',2,({}),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.)",
                    points.join(",")
                ))
            } else {
                let frame = w.frame([0.0, 0.0, z], UP, [0.0, 1.0, 0.0]);
                w.add(format!("PARABOLA('',#{frame},1.)"))
            }
        };
        let curves = [curve(&mut w, 0.0), curve(&mut w, 3.0)];
        let direction = w.direction(UP);
        let vector = w.add(format!("VECTOR('',#{direction},7.)"));
        let surface = w.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{},#{vector})", curves[0]));
        let low = ends.map(|p| w.vertex(p));
        let high = ends.map(|[x, y, _]| w.vertex([x, y, 3.0]));
        // The parameter of the parabola grows against x.
        let edges = if is_spline {
            [w.edge(low, curves[0]), w.edge(high, curves[1])]
        } else {
            [w.edge([low[1], low[0]], curves[0]), w.edge([high[1], high[0]], curves[1])]
        };
        let sides = [0, 1].map(|k| w.line(ends[k], [ends[k][0], ends[k][1], 3.0]));
        let sides = [w.edge([low[0], high[0]], sides[0]), w.edge([low[1], high[1]], sides[1])];
        let bound =
            w.bound(&[(edges[0], is_spline), (sides[1], true), (edges[1], !is_spline), (sides[0], false)]);
        let face = w.face(&[bound], surface, is_spline);
        let face = one(w, face);
        let length = 2.0 * (2.0_f64.sqrt() + (1.0 + 2.0_f64.sqrt()).ln());
        check(&face, 3.0 * length);
        check_box(&face, [-2.0, 0.0, 0.0], [2.0, 1.0, 3.0]);
        assert!(face.is_untrimmed);
    }
}

#[test]
fn a_turned_line_is_a_cone_and_a_turned_ellipse_a_ring() {
    let mut w = Writer::new(Length::Millimetre);
    let origin = w.point([0.0; 3]);
    let z = w.direction(UP);
    let axis = w.add(format!("AXIS1_PLACEMENT('',#{origin},#{z})"));
    let mut ellipse = w.copy();

    let line = w.line([3.0, 0.0, 0.0], [1.0, 0.0, 2.0]);
    let surface = w.add(format!("SURFACE_OF_REVOLUTION('',#{line},#{axis})"));
    let rings = [ring(&mut w, 3.0, 0.0), ring(&mut w, 1.0, 2.0)];
    let bounds = [w.bound(&[(rings[0], true)]), w.bound(&[(rings[1], false)])];
    let face = w.face(&bounds, surface, true);
    let cone = one(w, face);
    check(&cone, PI * 4.0 * 8.0_f64.sqrt());
    assert!(cone.is_untrimmed);

    let frame = ellipse.frame([6.0, 0.0, 0.0], [0.0, -1.0, 0.0], X);
    let curve = ellipse.add(format!("ELLIPSE('',#{frame},2.,1.)"));
    let surface = ellipse.add(format!("SURFACE_OF_REVOLUTION('',#{curve},#{axis})"));
    let face = ellipse.face(&[], surface, true);
    let face = one(ellipse, face);
    // Pappus: the length of the ellipse times the way of its middle.
    let length: f64 = (0..64)
        .map(|k| f64::from(k) * TAU / 64.0)
        .map(|t| f64::hypot(2.0 * t.sin(), t.cos()) * TAU / 64.0)
        .sum();
    check(&face, length * TAU * 6.0);
    check_box(&face, [-8.0, -8.0, -1.0], [8.0, 8.0, 1.0]);
}

#[test]
fn curves_behind_others_are_found() {
    // An edge whose curve is a trimmed curve of a surface curve.
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let circle = w.add(format!("CIRCLE('',#{frame},2.)"));
    let surface = w.add(format!("SURFACE_CURVE('',#{circle},(),.CURVE_3D.)"));
    let trimmed = w.add(format!(
        "TRIMMED_CURVE('',#{surface},(PARAMETER_VALUE(0.)),(PARAMETER_VALUE(1.)),.T.,.PARAMETER.)"
    ));
    let vertex = w.vertex([2.0, 0.0, 0.0]);
    let edge = w.edge([vertex, vertex], trimmed);
    let bound = w.bound(&[(edge, true)]);
    let face = level(&mut w, &[bound], 0.0);
    check(&one(w, face), 4.0 * PI);
}

#[test]
fn offsets_are_left_out_with_the_reason_and_the_rest_is_read() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    let offset = w.add(format!("OFFSET_SURFACE('',#{plane},1.,.F.)"));
    let edge = ring(&mut w, 2.0, 0.0);
    let bound = w.bound(&[(edge, true)]);
    let faces = [w.face(&[bound], offset, true), w.face(&[bound], plane, true)];
    let solid = w.solid(&faces);
    let set = w.add("GEOMETRIC_CURVE_SET('',())");
    w.representation(&[solid, set]);
    let model = read_text(&w.text()).unwrap();
    assert_eq!(model.faces.len(), 1);
    let kinds: Vec<&str> = model.left_out.iter().map(|one| one.kind.as_str()).collect();
    assert_eq!(kinds, ["GEOMETRIC_CURVE_SET", "OFFSET_SURFACE"]);
}
