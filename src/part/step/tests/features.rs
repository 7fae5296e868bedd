//! Holes and levels.

use super::shapes::{level, ring, square, wall};
use super::writer::{Length, Writer};
use crate::step::Hole;

/// The only hole of a file.
fn hole(w: Writer, faces: &[usize]) -> Hole {
    let mut model = w.model(faces);
    assert_eq!(model.holes.len(), 1, "{:?}", model.holes);
    model.holes.remove(0)
}

/// A plane with a round hole whose edge is given; its normal is up or down.
fn plate(w: &mut Writer, edge: usize, height: f64, is_up: bool) -> usize {
    let mut corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]].map(|[x, y]| [x, y, height]);
    if !is_up {
        corners.reverse();
    }
    let frame = w.upright([0.0, 0.0, height]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    let bounds = [w.polygon(&corners), w.bound(&[(edge, !is_up)])];
    w.face(&bounds, plane, is_up)
}

/// The wall of a hole of radius 3 from height 0 to 10 below a plate, with the edge of its lower end.
fn bore(w: &mut Writer) -> (Vec<usize>, usize) {
    let rings = [ring(w, 3.0, 0.0), ring(w, 3.0, 10.0)];
    (vec![wall(w, 3.0, rings, true), plate(w, rings[1], 10.0, true)], rings[0])
}

#[test]
fn a_hole_through_two_plates_is_through() {
    let mut w = Writer::new(Length::Millimetre);
    let (mut faces, edge) = bore(&mut w);
    faces.push(plate(&mut w, edge, 0.0, false));
    let hole = hole(w, &faces);
    assert!(hole.is_through);
    assert_eq!((hole.diameter_mm, hole.depth_mm, hole.faces.clone()), (6.0, 10.0, vec![0]));
    // From above.
    assert!((hole.start.z - 10.0).abs() < 1e-9 && (hole.axis.z + 1.0).abs() < 1e-12);
}

#[test]
fn a_hole_with_a_flat_end_is_blind() {
    let mut w = Writer::new(Length::Millimetre);
    let (mut faces, edge) = bore(&mut w);
    let bound = w.bound(&[(edge, true)]);
    faces.push(level(&mut w, &[bound], 0.0));
    assert!(!hole(w, &faces).is_through);
}

#[test]
fn a_hole_with_a_pointed_or_a_round_end_is_blind() {
    for is_round in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let (mut faces, edge) = bore(&mut w);
        let frame = w.upright([0.0; 3]);
        let end = if is_round {
            w.add(format!("SPHERICAL_SURFACE('',#{frame},3.)"))
        } else {
            w.add(format!("CONICAL_SURFACE('',#{frame},3.,1.)"))
        };
        let bound = w.bound(&[(edge, true)]);
        faces.push(w.face(&[bound], end, false));
        let hole = hole(w, &faces);
        assert!(!hole.is_through, "{is_round}");
        assert!((hole.start.z - 10.0).abs() < 1e-9 && (hole.axis.z + 1.0).abs() < 1e-12);
    }
}

#[test]
fn a_hole_that_ends_in_a_smaller_hole_is_through() {
    let mut w = Writer::new(Length::Millimetre);
    let (mut faces, edge) = bore(&mut w);
    let rings = [ring(&mut w, 1.0, -5.0), ring(&mut w, 1.0, 0.0)];
    let bounds = [w.bound(&[(edge, true)]), w.bound(&[(rings[1], false)])];
    faces.push(level(&mut w, &bounds, 0.0));
    faces.push(wall(&mut w, 1.0, rings, true));
    let model = w.model(&faces);
    let found: Vec<(f64, bool)> =
        model.holes.iter().map(|hole| (hole.diameter_mm, hole.is_through)).collect();
    assert_eq!(found, [(6.0, true), (2.0, true)]);
}

/// The half of a wall of radius 3 from x to -x, or back.
fn half(w: &mut Writer, is_back: bool, is_hole: bool) -> usize {
    let sign = if is_back { -1.0 } else { 1.0 };
    let corners = [[sign * 3.0, 0.0, 0.0], [-sign * 3.0, 0.0, 0.0]];
    let low = corners.map(|p| w.vertex(p));
    let high = corners.map(|[x, y, _]| w.vertex([x, y, 4.0]));
    let frames = [0.0, 4.0].map(|z| w.frame([0.0, 0.0, z], [0.0, 0.0, 1.0], [sign, 0.0, 0.0]));
    let arcs = frames.map(|frame| w.add(format!("CIRCLE('',#{frame},3.)")));
    let arcs = [w.edge(low, arcs[0]), w.edge(high, arcs[1])];
    let sides = corners.map(|p| w.line(p, [p[0], p[1], 4.0]));
    let sides = [w.edge([low[0], high[0]], sides[0]), w.edge([low[1], high[1]], sides[1])];
    let mut edges = vec![(arcs[0], true), (sides[1], true), (arcs[1], false), (sides[0], false)];
    if is_hole {
        edges.reverse();
        edges.iter_mut().for_each(|(_, forward)| *forward = !*forward);
    }
    let bound = w.bound(&edges);
    let cylinder = w.add(format!("CYLINDRICAL_SURFACE('',#{},3.)", frames[0]));
    w.face(&[bound], cylinder, !is_hole)
}

#[test]
fn two_half_walls_are_one_hole_and_one_half_is_none() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = [half(&mut w, false, true), half(&mut w, true, true)];
    let mut alone = w.copy();
    let found = hole(w, &faces);
    assert_eq!(found.faces, [0, 1]);
    assert!((found.depth_mm - 4.0).abs() < 1e-9);

    assert_eq!(alone.copy().model(&faces[..1]).holes, []);
    // A shaft is no hole.
    let shaft = [half(&mut alone, false, false), half(&mut alone, true, false)];
    assert_eq!(alone.model(&shaft).holes, []);
}

#[test]
fn two_holes_in_line_are_two() {
    let mut w = Writer::new(Length::Millimetre);
    let rings = [0.0, 4.0, 20.0, 26.0].map(|z| ring(&mut w, 3.0, z));
    let faces =
        [wall(&mut w, 3.0, [rings[2], rings[3]], true), wall(&mut w, 3.0, [rings[0], rings[1]], true)];
    let model = w.model(&faces);
    let depths: Vec<f64> = model.holes.iter().map(|hole| hole.depth_mm).collect();
    assert_eq!(depths, [6.0, 4.0]);
}

#[test]
fn levels_gather_faces_of_one_height_from_the_top_down() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = [square(&mut w, 2.0, 1.0), square(&mut w, 3.0, 5.0), square(&mut w, 1.0, 1.0)];
    let frame = w.upright([0.0; 3]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    let bound = w.polygon(&[[0.0; 3], [0.0, 7.0, 0.0], [7.0, 7.0, 0.0], [7.0, 0.0, 0.0]]);
    let bottom = w.face(&[bound], plane, false);
    let model = w.model(&[faces[0], faces[1], faces[2], bottom]);
    let found: Vec<(f64, bool, f64)> =
        model.levels.iter().map(|level| (level.height_mm, level.is_up, level.area_mm2.round())).collect();
    assert_eq!(found, [(5.0, true, 9.0), (1.0, true, 5.0), (0.0, false, 49.0)]);
    assert_eq!(model.levels[1].faces, [0, 2]);
}
