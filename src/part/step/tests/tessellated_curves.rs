//! Triangles of faces whose surfaces come from curves, against closed forms.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

use nalgebra::Vector3;
use toolpathd_core::budget::Budget;

use super::shapes::{circle, ring};
use super::triangles::{area, beyond, miss, open_sides, reach, volume};
use super::writer::{Length, UP, Writer, read_text};
use crate::step::Model;
use crate::step::tessellation::{FaceTriangles, triangles};

const X: [f64; 3] = [1.0, 0.0, 0.0];

/// Rounding of points of some 10 mm.
const ROUNDING: f64 = 1e-9;

fn made(model: &Model, chord_mm: f64) -> FaceTriangles {
    assert_eq!(model.left_out, []);
    let all: Vec<usize> = (0..model.faces.len()).collect();
    let made = triangles(model, &all, chord_mm, 1_000_000, &Budget::unlimited()).unwrap();
    assert!(made.chord_mm <= chord_mm + 3.0 * made.edge_gap_max_mm, "{} of {chord_mm}", made.chord_mm);
    made
}

#[test]
fn polygons_share_their_corners() {
    // A box of 4 by 3 by 2 mm whose faces are polygons.
    let mut w = Writer::new(Length::Millimetre);
    let corners: Vec<usize> =
        (0..8).map(|k| w.point([[0.0, 4.0][k & 1], [0.0, 3.0][k >> 1 & 1], [0.0, 2.0][k >> 2]])).collect();
    let sides = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    for is_forward in ["T", "F"] {
        let mut w = w.copy();
        let mut faces = Vec::new();
        for mut side in sides {
            if is_forward == "F" {
                side.reverse();
            }
            let points: Vec<String> = side.iter().map(|k| format!("#{}", corners[*k])).collect();
            let polygon = w.add(format!("POLY_LOOP('',({}))", points.join(",")));
            let bound = w.add(format!("FACE_OUTER_BOUND('',#{polygon},.{is_forward}.)"));
            faces.push(format!("#{}", w.add(format!("FACE('',(#{bound}))"))));
        }
        let shell = w.add(format!("CLOSED_SHELL('',({}))", faces.join(",")));
        let solid = w.add(format!("FACETED_BREP('',#{shell})"));
        w.representation(&[solid]);
        let made = made(&read_text(&w.text()).unwrap(), 0.1);
        assert_eq!((open_sides(&made), made.triangles.len()), (0, 12));
        assert!((volume(&made) - 24.0).abs() < ROUNDING);
    }
}

#[test]
fn an_extrusion_with_a_kink_has_vertices_along_it() {
    // A line of two sides and a roof over it: a curve of degree 1 with a corner at x = 2, moved along y.
    let mut w = Writer::new(Length::Millimetre);
    let points = [[0.0, 0.0, 0.0], [2.0, 0.0, 3.0], [4.0, 0.0, 0.0]];
    let spline = |w: &mut Writer, y: f64| {
        let points = points.map(|[x, _, z]| format!("#{}", w.point([x, y, z]))).join(",");
        w.add(format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',1,({points}),.UNSPECIFIED.,.F.,.F.,(2,1,2),(0.,1.,2.),.U.)"
        ))
    };
    let curves = [spline(&mut w, 0.0), spline(&mut w, 5.0)];
    let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 5.0, 0.0], [0.0, 5.0, 0.0]].map(|p| w.vertex(p));
    let along = [w.edge([corners[0], corners[1]], curves[0]), w.edge([corners[3], corners[2]], curves[1])];
    let lines = [w.line([4.0, 0.0, 0.0], [4.0, 5.0, 0.0]), w.line([0.0, 0.0, 0.0], [0.0, 5.0, 0.0])];
    let across = [w.edge([corners[1], corners[2]], lines[0]), w.edge([corners[0], corners[3]], lines[1])];
    let bound = w.bound(&[(along[0], true), (across[0], true), (along[1], false), (across[1], false)]);
    let direction = w.direction([0.0, 1.0, 0.0]);
    let vector = w.add(format!("VECTOR('',#{direction},1.)"));
    let surface = w.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{},#{vector})", curves[0]));
    let face = w.face(&[bound], surface, true);
    let made = made(&w.model(&[face]), 0.001);
    let exact = 2.0 * 13.0_f64.sqrt() * 5.0;
    assert!((area(&made) - exact).abs() < 0.01, "{} of {exact}", area(&made));
    let off = |p: Vector3<f64>| (p.z - (3.0 - (p.x - 2.0).abs() * 1.5)).abs();
    assert!(miss(&made, 0, off) <= 0.002 && made.triangles.len() < 40, "{}", made.triangles.len());
}

#[test]
fn a_revolution_is_near_both_ways() {
    // The parabola r = 4 - z^2 / 4 from z = -2 to 2 about z: its control points are those of degree 2.
    for chord in [0.1, 0.005] {
        let mut w = Writer::new(Length::Millimetre);
        let points = [[3.0, 0.0, -2.0], [5.0, 0.0, 0.0], [3.0, 0.0, 2.0]];
        let points = points.map(|p| format!("#{}", w.point(p))).join(",");
        let curve = w.add(format!(
            "B_SPLINE_CURVE_WITH_KNOTS('',2,({points}),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.U.)"
        ));
        let (point, direction) = (w.point([0.0; 3]), w.direction(UP));
        let axis = w.add(format!("AXIS1_PLACEMENT('',#{point},#{direction})"));
        let surface = w.add(format!("SURFACE_OF_REVOLUTION('',#{curve},#{axis})"));
        let rings = [-2.0, 2.0].map(|z| ring(&mut w, 3.0, z));
        let bounds = [w.bound(&[(rings[0], true)]), w.bound(&[(rings[1], false)])];
        let face = w.face(&bounds, surface, true);
        let made = made(&w.model(&[face]), chord);
        let limit = made.chord_mm + ROUNDING;
        let at = |a: f64, b: f64| {
            let z = 4.0 * b - 2.0;
            let r = 4.0 - z * z / 4.0;
            Some([r * (TAU * a).cos(), r * (TAU * a).sin(), z])
        };
        assert!(reach(&made, 0, at) <= limit);
        // The slope of the profile is at most 1: the distance along the radius is at most sqrt(2) times the
        // least distance.
        let off = |p: Vector3<f64>| (p.xy().norm() - 4.0 + p.z * p.z / 4.0).abs();
        assert!(miss(&made, 0, off) <= 2.0_f64.sqrt() * limit);
    }
}

#[test]
fn an_elbow_of_a_torus_is_near_both_ways() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let surface = w.add(format!("TOROIDAL_SURFACE('',#{frame},5.,2.)"));
    let first = circle(&mut w, [5.0, 0.0, 0.0], [0.0, -1.0, 0.0], X, 2.0);
    let second = circle(&mut w, [0.0, 5.0, 0.0], X, [0.0, 1.0, 0.0], 2.0);
    let bounds = [w.bound(&[(first, false)]), w.bound(&[(second, true)])];
    let face = w.face(&bounds, surface, true);
    let made = made(&w.model(&[face]), 0.01);
    let limit = made.chord_mm + ROUNDING;
    let at = |a: f64, b: f64| {
        let r = 5.0 + 2.0 * (TAU * b).cos();
        Some([r * (FRAC_PI_2 * a).cos(), r * (FRAC_PI_2 * a).sin(), 2.0 * (TAU * b).sin()])
    };
    assert!(reach(&made, 0, at) <= limit);
    let off = |p: Vector3<f64>| {
        let out = beyond(p.x, [0.0, 9.0]).hypot(beyond(p.y, [0.0, 9.0]));
        out.hypot((p.xy().norm() - 5.0).hypot(p.z) - 2.0)
    };
    assert!(miss(&made, 0, off) <= limit);
    assert!((area(&made) / (FRAC_PI_2 * 5.0 * TAU * 2.0) - 1.0).abs() < 0.01);
}

#[test]
fn a_rational_spline_has_no_more_triangles_than_its_bend_needs() {
    // A quarter of a cylinder of radius 10 and length 100 about z.
    let chord = 0.01;
    let mut w = Writer::new(Length::Millimetre);
    let net: Vec<String> = [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]]
        .iter()
        .map(|[x, y]| format!("(#{},#{})", w.point([*x, *y, 0.0]), w.point([*x, *y, 100.0])))
        .collect();
    let half = FRAC_PI_4.cos();
    let surface = w.add(format!(
        "(BOUNDED_SURFACE()B_SPLINE_SURFACE(2,1,({}),.UNSPECIFIED.,.F.,.F.,.F.)\
         B_SPLINE_SURFACE_WITH_KNOTS((3,3),(2,2),(0.,1.),(0.,1.),.UNSPECIFIED.)\
         GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_SURFACE(((1.,1.),({half:?},{half:?}),(1.,1.)))\
         REPRESENTATION_ITEM('')SURFACE())",
        net.join(",")
    ));
    let corners = [[10.0, 0.0, 0.0], [0.0, 10.0, 0.0], [0.0, 10.0, 100.0], [10.0, 0.0, 100.0]];
    let vertices = corners.map(|p| w.vertex(p));
    let circles = [0.0, 100.0].map(|z| {
        let frame = w.upright([0.0, 0.0, z]);
        w.add(format!("CIRCLE('',#{frame},10.)"))
    });
    let arcs =
        [w.edge([vertices[0], vertices[1]], circles[0]), w.edge([vertices[3], vertices[2]], circles[1])];
    let lines = [w.line(corners[1], corners[2]), w.line(corners[0], corners[3])];
    let sides = [w.edge([vertices[1], vertices[2]], lines[0]), w.edge([vertices[0], vertices[3]], lines[1])];
    let bound = w.bound(&[(arcs[0], true), (sides[0], true), (arcs[1], false), (sides[1], false)]);
    let face = w.face(&[bound], surface, true);
    let made = made(&w.model(&[face]), chord);
    let limit = made.chord_mm + ROUNDING;
    let at = |a: f64, b: f64| Some([10.0 * (FRAC_PI_2 * a).cos(), 10.0 * (FRAC_PI_2 * a).sin(), 100.0 * b]);
    assert!(reach(&made, 0, at) <= limit);
    assert!(miss(&made, 0, |p| (p.xy().norm() - 10.0).abs()) <= limit);
    // The angle of the sagitta is 0.09 rad; the bound may be three times too large.
    let n = PI / 2.0 / (2.0 * (1.0_f64 - chord / 10.0).acos());
    assert!((made.triangles.len() as f64) < 12.0 * n, "{} for {n} sides", made.triangles.len());
}
