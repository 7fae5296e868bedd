//! Triangles of faces against closed forms.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::Vector3;
use toolpathd_core::budget::{Budget, Stopped};

use super::shapes::{level, ring, sphere, wall};
use super::triangles::{area, beyond, corners, miss, open_sides, reach, volume};
use super::writer::{Length, UP, Writer, read_text};
use crate::step::Model;
use crate::step::tessellation::{FaceTriangles, Untessellated, triangles};

const MOST: usize = 1_000_000;

/// Rounding of points of some 10 mm.
const ROUNDING: f64 = 1e-9;

const X: [f64; 3] = [1.0, 0.0, 0.0];

fn made(model: &Model, chord_mm: f64) -> FaceTriangles {
    assert_eq!(model.left_out, []);
    let all: Vec<usize> = (0..model.faces.len()).collect();
    let made = triangles(model, &all, chord_mm, MOST, &Budget::unlimited()).unwrap();
    assert!(made.chord_mm <= chord_mm + 3.0 * made.edge_gap_max_mm, "{} of {chord_mm}", made.chord_mm);
    assert_eq!(made.triangles.len(), made.face_of.len());
    made
}

/// A solid cylinder about the z axis with its three faces: wall, top and bottom.
fn cylinder(w: &mut Writer, radius: f64, height: f64) -> Vec<usize> {
    let rings = [ring(w, radius, 0.0), ring(w, radius, height)];
    let side = wall(w, radius, rings, false);
    let bound = w.bound(&[(rings[1], true)]);
    let top = level(w, &[bound], height);
    let bound = w.bound(&[(rings[0], false)]);
    let frame = w.upright([0.0; 3]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    vec![side, top, w.face(&[bound], plane, false)]
}

#[test]
fn a_cylinder_is_closed_and_near_both_ways() {
    for chord in [1.0, 0.1, 0.001] {
        let mut w = Writer::new(Length::Millimetre);
        let faces = cylinder(&mut w, 3.0, 5.0);
        let made = made(&w.model(&faces), chord);
        assert_eq!(open_sides(&made), 0);
        let (exact, inside) = (PI * 45.0, volume(&made));
        assert!(inside < exact && inside > exact - TAU * 15.0 * chord, "{inside} of {exact}");
        let limit = made.chord_mm + ROUNDING;
        let on_wall = |a: f64, b: f64| Some([3.0 * (TAU * a).cos(), 3.0 * (TAU * a).sin(), 5.0 * b]);
        assert!(reach(&made, 0, on_wall) <= limit);
        assert!(miss(&made, 0, |p| (p.xy().norm() - 3.0).abs().hypot(beyond(p.z, [0.0, 5.0]))) <= limit);
        let on_disc = |a: f64, b: f64| {
            let r = 3.0 * b.sqrt();
            Some([r * (TAU * a).cos(), r * (TAU * a).sin(), 5.0])
        };
        assert!(reach(&made, 1, on_disc) <= limit);
        assert!(miss(&made, 1, |p| beyond(p.xy().norm(), [0.0, 3.0]).hypot(p.z - 5.0)) <= limit);
    }
}

#[test]
fn a_long_cylinder_has_no_vertices_between_its_ends() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = cylinder(&mut w, 1.0, 1000.0);
    let made = made(&w.model(&faces), 0.001);
    assert!(made.vertices.iter().all(|p| p[2] == 0.0 || p[2] == 1000.0));
    // A side of a polygon in a circle spans the angle of the sagitta 0.0004 mm at the least.
    let n = (PI / (1.0_f64 - 0.0004).acos()).ceil() as usize;
    assert!(made.triangles.len() <= 4 * (n + 4), "{} for {n} sides", made.triangles.len());
}

/// A block of 18 by 18 by 10 mm about the z axis with a hole of radius 3, whose faces share their edges: the
/// wall of the hole, the top, the bottom and four sides.
fn block(w: &mut Writer) -> Vec<usize> {
    let at = |k: usize, z: f64| {
        let [x, y] = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]][k % 4];
        [x, y, z]
    };
    let heights = [0.0, 10.0];
    let corners: Vec<[usize; 2]> = (0..4).map(|k| heights.map(|z| w.vertex(at(k, z)))).collect();
    let ring_of = |w: &mut Writer, level: usize| -> Vec<usize> {
        let z = heights[level];
        let side = |w: &mut Writer, k: usize| {
            let line = w.line(at(k, z), at(k + 1, z));
            w.edge([corners[k][level], corners[(k + 1) % 4][level]], line)
        };
        (0..4).map(|k| side(w, k)).collect()
    };
    let sides = [ring_of(w, 0), ring_of(w, 1)];
    let posts: Vec<usize> = (0..4)
        .map(|k| {
            let line = w.line(at(k, 0.0), at(k, 10.0));
            w.edge(corners[k], line)
        })
        .collect();
    let rings = heights.map(|z| ring(w, 3.0, z));
    let mut faces = vec![wall(w, 3.0, rings, true)];
    for (level, is_up) in [(1, true), (0, false)] {
        let mut outer: Vec<(usize, bool)> = sides[level].iter().map(|edge| (*edge, is_up)).collect();
        if !is_up {
            outer.reverse();
        }
        let bounds = [w.bound(&outer), w.bound(&[(rings[level], !is_up)])];
        let frame = w.upright([0.0, 0.0, heights[level]]);
        let plane = w.add(format!("PLANE('',#{frame})"));
        faces.push(w.face(&bounds, plane, is_up));
    }
    for k in 0..4 {
        let next = (k + 1) % 4;
        let bound =
            w.bound(&[(sides[0][k], true), (posts[next], true), (sides[1][k], false), (posts[k], false)]);
        let ([ax, ay, _], [bx, by, _]) = (at(k, 0.0), at(next, 0.0));
        let frame = w.frame(at(k, 0.0), [by - ay, ax - bx, 0.0], UP);
        let plane = w.add(format!("PLANE('',#{frame})"));
        faces.push(w.face(&[bound], plane, true));
    }
    faces
}

#[test]
fn a_block_with_a_hole_is_closed_and_near_both_ways() {
    for chord in [0.5, 0.01] {
        let mut w = Writer::new(Length::Millimetre);
        let faces = block(&mut w);
        let made = made(&w.model(&faces), chord);
        assert_eq!(open_sides(&made), 0);
        let (exact, inside) = (3240.0 - 90.0 * PI, volume(&made));
        assert!(inside > exact && inside < exact + 60.0 * PI * chord, "{inside} of {exact}");
        let limit = made.chord_mm + ROUNDING;
        let on_top = |a: f64, b: f64| {
            let [x, y] = [a, b].map(|s| 18.0 * s - 9.0);
            (x.hypot(y) >= 3.0).then_some([x, y, 10.0])
        };
        assert!(reach(&made, 1, on_top) <= limit);
        let off_top = |p: Vector3<f64>| {
            let out = beyond(p.x, [-9.0, 9.0]).hypot(beyond(p.y, [-9.0, 9.0]));
            out.max(3.0 - p.xy().norm()).hypot(p.z - 10.0)
        };
        assert!(miss(&made, 1, off_top) <= limit);
        // Four sides of two triangles.
        assert_eq!(made.face_of.iter().filter(|face| **face > 2).count(), 8);
    }
}

#[test]
fn a_vertex_that_is_moved_is_found() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = block(&mut w);
    let mut made = made(&w.model(&faces), 0.01);
    let off_wall = |p: Vector3<f64>| (p.xy().norm() - 3.0).abs();
    let on_wall = |a: f64, b: f64| Some([3.0 * (TAU * a).cos(), 3.0 * (TAU * a).sin(), 10.0 * b]);
    assert!(miss(&made, 0, off_wall) <= 0.01 && reach(&made, 0, on_wall) <= 0.01);
    let moved = made.triangles[made.face_of.iter().position(|face| *face == 0).unwrap()][0] as usize;
    made.vertices[moved][0] *= 1.02;
    made.vertices[moved][1] *= 1.02;
    assert!(miss(&made, 0, off_wall) > 0.01 && reach(&made, 0, on_wall) > 0.01);
    // A triangle that is left out is found, too.
    made.triangles.swap_remove(0);
    made.face_of.swap_remove(0);
    assert!(open_sides(&made) > 0);
}

#[test]
fn a_cone_ends_in_one_vertex() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let cone = w.add(format!("CONICAL_SURFACE('',#{frame},2.,{:?})", PI / 4.0));
    let top = ring(&mut w, 2.0, 0.0);
    let bound = w.bound(&[(top, false)]);
    let side = w.face(&[bound], cone, true);
    let bound = w.bound(&[(top, true)]);
    let lid = level(&mut w, &[bound], 0.0);
    let made = made(&w.model(&[side, lid]), 0.01);
    assert_eq!(open_sides(&made), 0);
    assert_eq!(made.vertices.iter().filter(|p| p[2] < -1.999_999).count(), 1);
    let exact = PI * 4.0 * 2.0 / 3.0;
    assert!(volume(&made) < exact && volume(&made) > exact - 0.01 * area(&made));
    let limit = made.chord_mm + ROUNDING;
    let on_side =
        |a: f64, b: f64| Some([2.0 * b * (TAU * a).cos(), 2.0 * b * (TAU * a).sin(), 2.0 * b - 2.0]);
    assert!(reach(&made, 0, on_side) <= limit);
    assert!(miss(&made, 0, |p| (p.xy().norm() - p.z - 2.0).abs() / 2.0_f64.sqrt()) <= limit);
}

#[test]
fn whole_spheres_and_tori_are_closed_and_near_both_ways() {
    for chord in [0.3, 0.02] {
        let mut w = Writer::new(Length::Millimetre);
        let surface = sphere(&mut w, 3.0);
        let face = w.face(&[], surface, true);
        let of_sphere = made(&w.model(&[face]), chord);
        assert_eq!(open_sides(&of_sphere), 0);
        let exact = 36.0 * PI;
        assert!(volume(&of_sphere) < exact && volume(&of_sphere) > exact - 36.0 * PI * chord);
        let limit = of_sphere.chord_mm + ROUNDING;
        let at = |a: f64, b: f64| {
            let (r, z) = ((1.0 - (2.0 * b - 1.0_f64).powi(2)).sqrt(), 2.0 * b - 1.0);
            Some([3.0 * r * (TAU * a).cos(), 3.0 * r * (TAU * a).sin(), 3.0 * z])
        };
        assert!(reach(&of_sphere, 0, at) <= limit);
        assert!(miss(&of_sphere, 0, |p| (p.norm() - 3.0).abs()) <= limit);

        let mut w = Writer::new(Length::Millimetre);
        let frame = w.upright([0.0; 3]);
        let surface = w.add(format!("TOROIDAL_SURFACE('',#{frame},5.,2.)"));
        let face = w.face(&[], surface, true);
        let of_torus = made(&w.model(&[face]), chord);
        assert_eq!(open_sides(&of_torus), 0);
        let (exact, skin) = (TAU * 5.0 * PI * 4.0, TAU * 5.0 * TAU * 2.0);
        assert!((volume(&of_torus) - exact).abs() < skin * chord);
        let limit = of_torus.chord_mm + ROUNDING;
        let at = |a: f64, b: f64| {
            let r = 5.0 + 2.0 * (TAU * b).cos();
            Some([r * (TAU * a).cos(), r * (TAU * a).sin(), 2.0 * (TAU * b).sin()])
        };
        assert!(reach(&of_torus, 0, at) <= limit);
        assert!(miss(&of_torus, 0, |p| ((p.xy().norm() - 5.0).hypot(p.z) - 2.0).abs()) <= limit);
    }
}

#[test]
fn a_part_of_a_sphere_is_closed_with_its_plane() {
    // The cap above z = 1, and the rest below, of a sphere of radius 3.
    for is_cap in [true, false] {
        let mut w = Writer::new(Length::Millimetre);
        let surface = sphere(&mut w, 3.0);
        let edge = ring(&mut w, 8.0_f64.sqrt(), 1.0);
        let bound = w.bound(&[(edge, is_cap)]);
        let round = w.face(&[bound], surface, true);
        let bound = w.bound(&[(edge, !is_cap)]);
        let frame = w.upright([0.0, 0.0, 1.0]);
        let plane = w.add(format!("PLANE('',#{frame})"));
        let flat = w.face(&[bound], plane, !is_cap);
        let made = made(&w.model(&[round, flat]), 0.02);
        assert_eq!(open_sides(&made), 0);
        let cap = PI * 4.0 * (9.0 - 2.0) / 3.0;
        let exact = if is_cap { cap } else { 36.0 * PI - cap };
        assert!((volume(&made) - exact).abs() < 0.02 * area(&made), "{} of {exact}", volume(&made));
        let heights = if is_cap { [1.0, 3.0] } else { [-3.0, 1.0] };
        let at = |a: f64, b: f64| {
            let z = heights[0] + (heights[1] - heights[0]) * b;
            let r = (9.0 - z * z).max(0.0).sqrt();
            Some([r * (TAU * a).cos(), r * (TAU * a).sin(), z])
        };
        let limit = made.chord_mm + ROUNDING;
        assert!(reach(&made, 0, at) <= limit);
        // The nearest point of the sphere, taken along the meridian to the edge if it is beyond.
        let off = |p: Vector3<f64>| {
            let latitude = (p.z / p.norm()).asin();
            let edge = (1.0_f64 / 3.0).asin();
            let range = if is_cap { [edge, FRAC_PI_2] } else { [-FRAC_PI_2, edge] };
            (p.norm() - 3.0).abs() + 3.0 * beyond(latitude, range)
        };
        assert!(miss(&made, 0, off) <= 2.0 * limit);
    }
}

/// The control points of `z = (x^2 + y^2) / 20` over 20 by 20 mm about the origin as a surface of degree 2.
fn paraboloid(w: &mut Writer, knots: &str) -> usize {
    let places = [-10.0, 0.0, 10.0];
    // The square of x has the control values 100, -100, 100.
    let squares = [100.0, -100.0, 100.0];
    let row = |w: &mut Writer, i: usize| {
        let points: Vec<String> = (0..3)
            .map(|j| format!("#{}", w.point([places[i], places[j], (squares[i] + squares[j]) / 20.0])))
            .collect();
        format!("({})", points.join(","))
    };
    let rows: Vec<String> = (0..3).map(|i| row(w, i)).collect();
    w.add(format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',2,2,({}),.UNSPECIFIED.,.F.,.F.,.F.,(3,3),(3,3),{knots},{knots},.UNSPECIFIED.)",
        rows.join(",")
    ))
}

#[test]
fn a_spline_with_a_hole_is_near_both_ways() {
    for chord in [0.2, 0.005] {
        let mut w = Writer::new(Length::Millimetre);
        let surface = paraboloid(&mut w, "(0.,4.)");
        let bounds = [8.0, 3.0].map(|r| ring(&mut w, r, r * r / 20.0));
        let bounds = [w.bound(&[(bounds[0], true)]), w.bound(&[(bounds[1], false)])];
        let face = w.face(&bounds, surface, true);
        let made = made(&w.model(&[face]), chord);
        let limit = made.chord_mm + ROUNDING;
        let at = |a: f64, b: f64| {
            let r = 3.0 + 5.0 * b;
            Some([r * (TAU * a).cos(), r * (TAU * a).sin(), r * r / 20.0])
        };
        assert!(reach(&made, 0, at) <= limit);
        let off = |p: Vector3<f64>| {
            let r = p.xy().norm().clamp(3.0, 8.0);
            (p.xy().norm() - r).hypot(p.z - r * r / 20.0)
        };
        assert!(miss(&made, 0, off) <= 1.3 * limit);
        // The normal is up.
        let [a, b, c] = corners(&made, 0);
        assert!((b - a).cross(&(c - a)).z > 0.0);
        assert!((area(&made) / made_area() - 1.0).abs() < chord);
    }
}

/// The area of the ring of the paraboloid.
fn made_area() -> f64 {
    let of = |r: f64| (1.0 + r * r / 100.0).powf(1.5) * TAU * 100.0 / 3.0;
    of(8.0) - of(3.0)
}

#[test]
fn the_triangles_of_a_copy_face_as_its_surface_does() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = cylinder(&mut w, 3.0, 5.0);
    let solid = w.solid(&faces);
    let shape = w.representation(&[solid]);
    let origin = w.upright([0.0; 3]);
    let map = w.add(format!("REPRESENTATION_MAP(#{origin},#{shape})"));
    let places = [w.upright([10.0, 0.0, 0.0]), w.frame([0.0, 20.0, 0.0], X, UP)];
    let items: Vec<String> = places
        .iter()
        .map(|place| format!("#{}", w.add(format!("MAPPED_ITEM('',#{map},#{place})"))))
        .collect();
    w.add(format!("SHAPE_REPRESENTATION('',({}),#9)", items.join(",")));
    let model = read_text(&w.text()).unwrap();
    let made = made(&model, 0.05);
    assert_eq!((model.bodies.len(), open_sides(&made)), (model.bodies.len(), 0));
    let exact = 45.0 * PI * model.bodies.len() as f64;
    assert!(volume(&made) < exact && volume(&made) > exact * 0.97, "{} of {exact}", volume(&made));
}

#[test]
fn a_mirrored_model_has_its_triangles_outside() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = block(&mut w);
    let mut model = w.model(&faces);
    let mut mirror = crate::step::frame::Placement::identity();
    mirror.turn[(0, 0)] = -1.0;
    for face in &mut model.faces {
        *face = crate::step::face_building::placed(face, &mirror, 0);
    }
    let made = made(&model, 0.05);
    assert_eq!(open_sides(&made), 0);
    assert!((volume(&made) / (3240.0 - 90.0 * PI) - 1.0).abs() < 0.01);
}

#[test]
fn what_cannot_be_made_is_an_error() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = cylinder(&mut w, 3.0, 5.0);
    let model = w.model(&faces);
    let of = |chord_mm, most, budget: &Budget| triangles(&model, &[0, 1, 2], chord_mm, most, budget);
    let budget = Budget::unlimited();
    assert_eq!(of(0.1, 20, &budget), Err(Untessellated::TooMany { most: 20 }));
    assert_eq!(of(1e-300, MOST, &budget), Err(Untessellated::TooMany { most: MOST }));
    assert_eq!(of(0.0, MOST, &budget), Err(Untessellated::BadChord { chord_mm: 0.0 }));
    assert!(matches!(of(f64::NAN, MOST, &budget), Err(Untessellated::BadChord { .. })));
    assert_eq!(triangles(&model, &[3], 0.1, MOST, &budget), Err(Untessellated::NoFace { face: 3 }));
    budget.cancel();
    assert_eq!(of(0.1, MOST, &budget), Err(Untessellated::Stopped(Stopped::Cancelled)));
}

#[test]
fn bounds_that_cross_are_an_error_with_the_face() {
    // Two circles in one plane that cut each other.
    let mut w = Writer::new(Length::Millimetre);
    let outer = ring(&mut w, 3.0, 0.0);
    let frame = w.upright([2.0, 0.0, 0.0]);
    let inner = w.circle(frame, 2.0, [4.0, 0.0, 0.0]);
    let bounds = [w.bound(&[(outer, true)]), w.bound(&[(inner, false)])];
    let face = level(&mut w, &bounds, 0.0);
    let model = w.model(&[face]);
    let error = triangles(&model, &[0], 0.01, MOST, &Budget::unlimited()).unwrap_err();
    assert!(matches!(error, Untessellated::Face { face: 0, entity, .. } if entity == face as u64), "{error}");
}

#[test]
fn a_thin_ring_keeps_its_two_bounds_apart() {
    // The ring is thinner than the chord.
    let mut w = Writer::new(Length::Millimetre);
    let bounds = [5.0, 4.99].map(|r| ring(&mut w, r, 0.0));
    let bounds = [w.bound(&[(bounds[0], true)]), w.bound(&[(bounds[1], false)])];
    let face = level(&mut w, &bounds, 0.0);
    let made = made(&w.model(&[face]), 0.1);
    let exact = PI * (25.0 - 4.99 * 4.99);
    assert!(area(&made) > 0.5 * exact && area(&made) < 2.0 * exact);
}

#[test]
fn a_part_of_a_disc_is_not_lost_below_a_coarse_chord() {
    // Between an arc of 1 rad and its chord, much flatter than the chord of the triangles.
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let ends = [[2.0, 0.0, 0.0], [2.0 * 1.0_f64.cos(), 2.0 * 1.0_f64.sin(), 0.0]];
    let vertices = ends.map(|p| w.vertex(p));
    let arc = w.add(format!("CIRCLE('',#{frame},2.)"));
    let arc = w.edge(vertices, arc);
    let line = w.line(ends[1], ends[0]);
    let line = w.edge([vertices[1], vertices[0]], line);
    let bound = w.bound(&[(arc, true), (line, true)]);
    let face = level(&mut w, &[bound], 0.0);
    let model = w.model(&[face]);
    let exact = 2.0 * (1.0 - 1.0_f64.sin());
    let of_coarse = area(&made(&model, 100.0));
    assert!(of_coarse > 0.5 * exact && of_coarse < exact, "{of_coarse} of {exact}");
}
