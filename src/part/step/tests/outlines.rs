//! Outlines of level faces, and what stands around them.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use toolpathd_core::budget::Budget;

use super::shapes::{level, ring, wall};
use super::writer::{Length, Writer};
use crate::step::Model;
use crate::step::outline::{Outline, OutlineLoop, Walled, outlines};

const TOLERANCE_MM: f64 = 1e-3;

/// A solid of plane faces that share their edges.
struct Polyhedron {
    w: Writer,
    vertices: BTreeMap<[u64; 3], usize>,
    edges: BTreeMap<[[u64; 3]; 2], usize>,
    faces: Vec<usize>,
}

/// A rectangle, counterclockwise.
fn rectangle([left, right]: [f64; 2], [front, back]: [f64; 2]) -> Vec<[f64; 2]> {
    vec![[left, front], [right, front], [right, back], [left, back]]
}

/// A polygon at a height.
fn at(polygon: &[[f64; 2]], z: f64) -> Vec<[f64; 3]> {
    polygon.iter().map(|[x, y]| [*x, *y, z]).collect()
}

fn back(mut points: Vec<[f64; 3]>) -> Vec<[f64; 3]> {
    points.reverse();
    points
}

impl Polyhedron {
    fn new() -> Self {
        let w = Writer::new(Length::Millimetre);
        Self { w, vertices: BTreeMap::new(), edges: BTreeMap::new(), faces: Vec::new() }
    }

    /// Adds a face whose first loop goes counterclockwise about its normal.
    fn face(&mut self, loops: &[Vec<[f64; 3]>]) {
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [0, 1, 2].map(|k| a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3])
        };
        let outer = &loops[0];
        let mut normal = [0.0; 3];
        for (k, from) in outer.iter().enumerate() {
            let found = cross(*from, outer[(k + 1) % outer.len()]);
            normal = [0, 1, 2].map(|k| normal[k] + found[k]);
        }
        let x = [0, 1, 2].map(|k| outer[1][k] - outer[0][k]);
        let frame = self.w.frame(outer[0], normal, x);
        let plane = self.w.add(format!("PLANE('',#{frame})"));
        let bounds: Vec<usize> = loops.iter().map(|points| self.bound(points)).collect();
        let face = self.w.face(&bounds, plane, true);
        self.faces.push(face);
    }

    fn bound(&mut self, points: &[[f64; 3]]) -> usize {
        let n = points.len();
        let edges: Vec<(usize, bool)> = (0..n).map(|k| self.edge(points[k], points[(k + 1) % n])).collect();
        self.w.bound(&edges)
    }

    /// The edge between two points, and whether it leads from the first to the second.
    fn edge(&mut self, from: [f64; 3], to: [f64; 3]) -> (usize, bool) {
        let bits = |point: [f64; 3]| point.map(f64::to_bits);
        let is_forward = bits(from) < bits(to);
        let ends = if is_forward { [from, to] } else { [to, from] };
        if let Some(known) = self.edges.get(&ends.map(bits)) {
            return (*known, is_forward);
        }
        let vertices = ends.map(|end| *self.vertices.entry(bits(end)).or_insert_with(|| self.w.vertex(end)));
        let line = self.w.line(ends[0], ends[1]);
        let edge = self.w.edge(vertices, line);
        self.edges.insert(ends.map(bits), edge);
        (edge, is_forward)
    }

    /// Adds the upright walls around a polygon, seen from outside, or from inside if it is a hole.
    fn walls(&mut self, polygon: &[[f64; 2]], [low, high]: [f64; 2], is_hole: bool) {
        let n = polygon.len();
        for k in 0..n {
            let ([ax, ay], [bx, by]) = (polygon[k], polygon[(k + 1) % n]);
            let side = vec![[ax, ay, low], [bx, by, low], [bx, by, high], [ax, ay, high]];
            self.face(&[if is_hole { back(side) } else { side }]);
        }
    }

    fn model(self) -> Model {
        self.w.model(&self.faces)
    }
}

/// The outlines at a height that look up.
fn at_level(model: &Model, height_mm: f64, is_up: bool) -> Vec<Outline> {
    let found = outlines(model, TOLERANCE_MM, &Budget::unlimited()).expect("no limit");
    assert_eq!(found.left_out, []);
    let place = model.levels.iter().position(|level| level.height_mm == height_mm && level.is_up == is_up);
    found.by_level[place.expect("a level")].clone()
}

fn has_area(ring: &OutlineLoop, expected: f64) -> bool {
    (ring.area_mm2 / expected - 1.0).abs() < 1e-12
}

/// A block with a pocket whose floor is of two faces, with an island lower than the block, and a square hole
/// in the floor.
fn block() -> Model {
    let mut solid = Polyhedron::new();
    let outside = rectangle([0.0, 40.0], [0.0, 30.0]);
    let pocket = rectangle([10.0, 30.0], [5.0, 25.0]);
    let island = rectangle([12.0, 17.0], [10.0, 15.0]);
    let hole = rectangle([24.0, 27.0], [10.0, 14.0]);
    solid.walls(&outside, [0.0, 20.0], false);
    solid.face(&[at(&outside, 20.0), back(at(&pocket, 20.0))]);
    solid.face(&[back(at(&outside, 0.0)), at(&hole, 0.0)]);
    // The floor is divided at x = 20; so are the edges at its ends.
    let divided = [[10.0, 5.0], [20.0, 5.0], [30.0, 5.0], [30.0, 25.0], [20.0, 25.0], [10.0, 25.0]];
    let left = [divided[0], divided[1], divided[4], divided[5]];
    let right = [divided[1], divided[2], divided[3], divided[4]];
    solid.face(&[at(&left, 12.0), back(at(&island, 12.0))]);
    solid.face(&[at(&right, 12.0), back(at(&hole, 12.0))]);
    solid.walls(&island, [12.0, 17.0], false);
    solid.face(&[at(&island, 17.0)]);
    solid.walls(&hole, [0.0, 12.0], true);
    let low = at(&divided, 12.0);
    let high = at(&pocket, 20.0);
    solid.face(&[back(vec![low[0], low[1], low[2], high[1], high[0]])]);
    solid.face(&[back(vec![low[2], low[3], high[2], high[1]])]);
    solid.face(&[back(vec![low[3], low[4], low[5], high[3], high[2]])]);
    solid.face(&[back(vec![low[5], low[0], high[0], high[3]])]);
    solid.model()
}

#[test]
fn the_floor_of_a_pocket_is_one_outline_with_what_stands_and_opens_in_it() {
    let model = block();
    let floors = at_level(&model, 12.0, true);
    assert_eq!(floors.len(), 1, "{floors:?}");
    let floor = &floors[0];
    assert_eq!((floor.faces.len(), floor.is_covered, floor.deviation_max_mm), (2, false, 0.0));
    assert_eq!((floor.outer.walled(), floor.outer.top_mm), (Walled::All, Some(20.0)));
    assert!(has_area(&floor.outer, 400.0), "{}", floor.outer.area_mm2);
    assert!((floor.area_mm2 - (400.0 - 25.0 - 12.0)).abs() < 1e-9);
    assert_eq!(floor.outer.open(), [[0usize; 2]; 0]);
    let [island, hole] = &floor.inner[..] else { panic!("{:?}", floor.inner) };
    assert_eq!((island.walled(), island.top_mm), (Walled::All, Some(17.0)));
    assert_eq!((hole.walled(), hole.top_mm), (Walled::None, None));
    assert!(has_area(island, 25.0) && has_area(hole, 12.0));

    let top = &at_level(&model, 20.0, true)[0];
    assert_eq!((top.outer.walled(), top.inner[0].walled()), (Walled::None, Walled::None));
    assert!(top.outer.open().is_empty() && !top.is_covered);
    assert!((top.area_mm2 - 800.0).abs() < 1e-9);
    // Nothing stands on a face that looks down.
    let bottom = &at_level(&model, 0.0, false)[0];
    assert_eq!((bottom.outer.walled(), bottom.outer.top_mm), (Walled::None, None));
    assert!((bottom.area_mm2 - 1188.0).abs() < 1e-9);
}

/// A solid whose section, of x and z and counterclockwise, is the same from y = 0 to y = 30.
fn bar(section: &[[f64; 2]]) -> Model {
    let mut solid = Polyhedron::new();
    let n = section.len();
    let end = |y: f64| -> Vec<[f64; 3]> { section.iter().map(|[x, z]| [*x, y, *z]).collect() };
    let (front, rear) = (end(0.0), end(30.0));
    for k in 0..n {
        let next = (k + 1) % n;
        solid.face(&[vec![front[next], front[k], rear[k], rear[next]]]);
    }
    solid.face(&[front]);
    solid.face(&[back(rear)]);
    solid.model()
}

#[test]
fn a_step_is_open_where_no_wall_goes_up() {
    // The wall of the step is at x = 20.
    let model = bar(&[[0.0, 0.0], [40.0, 0.0], [40.0, 12.0], [20.0, 12.0], [20.0, 20.0], [0.0, 20.0]]);
    let step = &at_level(&model, 12.0, true)[0];
    assert_eq!((step.outer.walled(), step.outer.top_mm), (Walled::Some, Some(20.0)));
    let vertices = &step.outer.vertices;
    let [[from, to]] = step.outer.open()[..] else { panic!("{:?}", step.outer.open()) };
    // The open edges lead from one end of the wall, about the step, to the other.
    assert_eq!([vertices[from][..2].to_vec(), vertices[to][..2].to_vec()], [[20.0, 0.0], [20.0, 30.0]]);
    assert_eq!(step.outer.has_wall.iter().filter(|has_wall| **has_wall).count(), 1);
    assert_eq!((at_level(&model, 20.0, true)[0].outer.walled(), step.is_covered), (Walled::None, false));
}

#[test]
fn walls_that_end_at_two_heights_have_no_common_top() {
    let walls = |right: f64| {
        let section = [
            [0.0, 0.0],
            [40.0, 0.0],
            [40.0, right],
            [30.0, right],
            [30.0, 12.0],
            [10.0, 12.0],
            [10.0, 20.0],
            [0.0, 20.0],
        ];
        let floor = at_level(&bar(&section), 12.0, true).remove(0);
        assert_eq!(floor.outer.walled(), Walled::Some);
        assert_eq!(floor.outer.open().len(), 2);
        floor.outer.top_mm
    };
    assert_eq!((walls(20.0), walls(17.0)), (Some(20.0), None));
}

#[test]
fn a_wall_with_a_chamfer_ends_at_the_top_of_the_chamfer() {
    let section = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 20.0],
        [31.0, 20.0],
        [30.0, 19.0],
        [30.0, 12.0],
        [10.0, 12.0],
        [10.0, 19.0],
        [9.0, 20.0],
        [0.0, 20.0],
    ];
    assert_eq!(at_level(&bar(&section), 12.0, true)[0].outer.top_mm, Some(20.0));
    // A slope down to one side has no single end.
    let mut solid = Polyhedron::new();
    let pocket = rectangle([0.0, 20.0], [0.0, 10.0]);
    let low = at(&pocket, 0.0);
    let high = [[0.0, 0.0, 5.0], [20.0, 0.0, 8.0], [20.0, 10.0, 8.0], [0.0, 10.0, 5.0]];
    solid.face(std::slice::from_ref(&low));
    for k in 0..4 {
        let next = (k + 1) % 4;
        solid.face(&[back(vec![low[k], low[next], high[next], high[k]])]);
    }
    assert_eq!(at_level(&solid.model(), 0.0, true)[0].outer.top_mm, None);
}

#[test]
fn the_floor_of_a_slot_under_a_ledge_is_covered() {
    // A slot of 10 mm over one of 20 mm, and a dovetail.
    let slot = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 20.0],
        [25.0, 20.0],
        [25.0, 10.0],
        [30.0, 10.0],
        [30.0, 5.0],
        [10.0, 5.0],
        [10.0, 10.0],
        [15.0, 10.0],
        [15.0, 20.0],
        [0.0, 20.0],
    ];
    let dovetail = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 20.0],
        [25.0, 20.0],
        [30.0, 5.0],
        [10.0, 5.0],
        [15.0, 20.0],
        [0.0, 20.0],
    ];
    let draft = [
        [0.0, 0.0],
        [40.0, 0.0],
        [40.0, 20.0],
        [32.0, 20.0],
        [30.0, 5.0],
        [10.0, 5.0],
        [8.0, 20.0],
        [0.0, 20.0],
    ];
    for (section, is_covered) in [(&slot[..], true), (&dovetail[..], true), (&draft[..], false)] {
        let model = bar(section);
        assert_eq!(at_level(&model, 5.0, true)[0].is_covered, is_covered, "{section:?}");
        assert!(!at_level(&model, 20.0, true)[0].is_covered);
    }
}

#[test]
fn circles_are_two_arcs_from_above_and_from_below() {
    let mut w = Writer::new(Length::Millimetre);
    let rings = [ring(&mut w, 6.0, 3.0), ring(&mut w, 6.0, 10.0)];
    let bound = w.bound(&[(rings[0], true)]);
    let floor = level(&mut w, &[bound], 3.0);
    let frame = w.frame([20.0, 0.0, 3.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]);
    let edge = w.circle(frame, 2.0, [22.0, 0.0, 3.0]);
    let bound = w.bound(&[(edge, true)]);
    let other = level(&mut w, &[bound], 3.0);
    let side = wall(&mut w, 6.0, rings, true);
    let found = at_level(&w.model(&[floor, side, other]), 3.0, true);
    assert_eq!(found.len(), 2);
    for (outline, radius, walled) in [(&found[0], 6.0, Walled::All), (&found[1], 2.0, Walled::None)] {
        assert!(has_area(&outline.outer, PI * radius * radius), "{outline:?}");
        assert_eq!(outline.outer.vertices.len(), 2);
        assert!(outline.outer.vertices.iter().all(|vertex| vertex[2] == 1.0), "{outline:?}");
        assert_eq!((outline.outer.walled(), outline.deviation_max_mm), (walled, 0.0));
    }
    assert_eq!(found[0].outer.top_mm, Some(10.0));
}

#[test]
fn ellipses_and_splines_become_arcs_within_the_tolerance() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0, 0.0, 1.0]);
    let curve = w.add(format!("ELLIPSE('',#{frame},20.,8.)"));
    let vertex = w.vertex([20.0, 0.0, 1.0]);
    let edge = w.edge([vertex, vertex], curve);
    let bound = w.bound(&[(edge, false)]);
    let ellipse = level(&mut w, &[bound], 1.0);
    // A parabola y = 10 - x^2 / 10 over the x axis, as a Bezier curve.
    let points = [[-10.0, 50.0], [0.0, 70.0], [10.0, 50.0]].map(|[x, y]| w.point([x, y, 1.0]));
    let curve = w.add(format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',2,(#{},#{},#{}),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.)",
        points[0], points[1], points[2]
    ));
    let ends = [[-10.0, 50.0, 1.0], [10.0, 50.0, 1.0]];
    let vertices = ends.map(|end| w.vertex(end));
    let line = w.line(ends[0], ends[1]);
    let (arch, chord) = (w.edge(vertices, curve), w.edge(vertices, line));
    let bound = w.bound(&[(chord, true), (arch, false)]);
    let cap = level(&mut w, &[bound], 1.0);
    let found = at_level(&w.model(&[ellipse, cap]), 1.0, true);
    for (outline, area, length) in [(&found[0], PI * 160.0, 92.0), (&found[1], 400.0 / 3.0, 50.0)] {
        assert!(outline.deviation_max_mm > 0.0 && outline.deviation_max_mm <= TOLERANCE_MM);
        assert!((outline.area_mm2 - area).abs() < outline.deviation_max_mm * length, "{outline:?}");
        assert!(outline.outer.vertices.len() > 4, "{outline:?}");
    }
}

#[test]
fn a_face_that_occurs_twice_stays_two_outlines() {
    let mut w = Writer::new(Length::Millimetre);
    let edge = ring(&mut w, 5.0, 0.0);
    let faces = [0, 1].map(|_| {
        let bound = w.bound(&[(edge, true)]);
        level(&mut w, &[bound], 0.0)
    });
    assert_eq!(at_level(&w.model(&faces), 0.0, true).len(), 2);
}

#[test]
fn facets_that_meet_along_a_line_are_one_outline() {
    let mut w = Writer::new(Length::Millimetre);
    let corners = [[0.1, 0.2], [7.3, 0.1], [7.7, 5.9], [0.3, 6.1]];
    let points = corners.map(|[x, y]| w.point([x, y, 2.0]));
    // The second facet is written clockwise, and its bound turns it round.
    let faces = [([0, 1, 2], 'T'), ([3, 2, 0], 'F')].map(|(order, sense)| {
        let [a, b, c] = order.map(|k| points[k]);
        let polygon = w.add(format!("POLY_LOOP('',(#{a},#{b},#{c}))"));
        let bound = w.add(format!("FACE_BOUND('',#{polygon},.{sense}.)"));
        level(&mut w, &[bound], 2.0)
    });
    let found = at_level(&w.model(&faces), 2.0, true);
    let [outline] = &found[..] else { panic!("{found:?}") };
    assert_eq!((outline.faces.len(), outline.outer.vertices.len()), (2, 4));
    let mut places: Vec<[f64; 2]> = outline.outer.vertices.iter().map(|[x, y, _]| [*x, *y]).collect();
    places.sort_by(|a, b| a[0].total_cmp(&b[0]));
    for (place, corner) in places.iter().zip([corners[0], corners[3], corners[1], corners[2]]) {
        assert!((place[0] - corner[0]).abs() + (place[1] - corner[1]).abs() < 1e-12, "{place:?}");
    }
}
