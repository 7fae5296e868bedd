//! Files are read back by a small reader of their own.

use std::f64::consts::PI;

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::*;
use crate::solid;
use toolpathd_core::geometry::curve::Direction;
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::path::Role;
use toolpathd_core::toolpath::tool::Shape;
use toolpathd_core::toolpath::tool_body::HolderSection;

/// A file as its description and its buffer.
struct File {
    json: Value,
    bytes: Vec<u8>,
}

impl File {
    fn read(file: &[u8]) -> Self {
        let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().unwrap()) as usize;
        assert_eq!((&file[..4], number(4), number(8)), (b"glTF".as_slice(), 2, file.len()));
        assert_eq!((number(12) % 4, &file[16..20]), (0, b"JSON".as_slice()));
        let end = 20 + number(12);
        let json = serde_json::from_slice(&file[20..end]).unwrap();
        let bytes = if end == file.len() { Vec::new() } else { file[end + 8..].to_vec() };
        Self { json, bytes }
    }

    /// The numbers of an accessor of floats.
    fn floats(&self, accessor: &Value) -> Vec<f32> {
        let accessor = &self.json["accessors"][accessor.as_u64().unwrap() as usize];
        assert_eq!(accessor["componentType"], 5126);
        let view = &self.json["bufferViews"][accessor["bufferView"].as_u64().unwrap() as usize];
        let width = if accessor["type"] == "VEC3" { 3 } else { 1 };
        let first = view["byteOffset"].as_u64().unwrap() + accessor["byteOffset"].as_u64().unwrap();
        let count = accessor["count"].as_u64().unwrap() * width;
        let at = |k: u64| (first + 4 * k) as usize;
        (0..count).map(|k| f32::from_le_bytes(self.bytes[at(k)..at(k) + 4].try_into().unwrap())).collect()
    }

    fn node(&self, name: &str) -> &Value {
        let mut nodes = self.json["nodes"].as_array().unwrap().iter();
        nodes.find(|node| node["name"] == name).unwrap_or_else(|| panic!("{name}: {}", self.json["nodes"]))
    }

    /// An attribute of the mesh of a node.
    fn attribute(&self, node: &str, attribute: &str) -> Vec<f32> {
        let mesh = self.node(node)["mesh"].as_u64().unwrap() as usize;
        self.floats(&self.json["meshes"][mesh]["primitives"][0]["attributes"][attribute])
    }

    /// The places of a node, mm.
    fn places(&self, node: &str) -> Vec<Vector3<f64>> {
        let metres = self.attribute(node, "POSITION");
        metres.chunks(3).map(|p| Vector3::new(p[0], p[1], p[2]).map(f64::from) / container::METRES).collect()
    }
}

fn feed(mm_per_min: f64) -> FeedRate {
    FeedRate::from_mm_per_min(mm_per_min).unwrap()
}

/// A rapid, a plunge, half a circle of 10 mm, a pause and a rapid; on a level.
fn path() -> Toolpath {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 50.0));
    path.begin_pass(Some(3));
    path.rapid(Point3::new(0.0, 0.0, 2.0)).unwrap();
    path.line(Point3::new(0.0, 0.0, -1.0), feed(60.0), Role::Plunge).unwrap();
    let (to, center) = (Point3::new(20.0, 0.0, -1.0), Point3::new(10.0, 0.0, -1.0));
    path.arc(to, center, (Plane::Xy, Direction::Ccw), feed(600.0), Role::Cut).unwrap();
    path.dwell(1.5).unwrap();
    path.rapid(Point3::new(20.0, 0.0, 50.0)).unwrap();
    path.finish().unwrap()
}

fn content(toolpath: Option<&Toolpath>) -> Content<'_> {
    Content {
        title: "part",
        toolpath,
        rapid_feed: feed(4800.0),
        lines: &[],
        deviations_mm: &[],
        names: &[],
        part: None,
        part_chord_mm: None,
        stock: None,
        tool: None,
        diagrams: &[],
        diagram_ends_s: &[],
        chord_mm: CHORD_MM,
    }
}

#[test]
fn a_strip_has_the_places_times_kinds_feeds_and_lines_of_its_moves() {
    let path = path();
    let names = [(0, "level 1 of 1".to_owned())];
    let file =
        File::read(&glb(&Content { lines: &[7, 8, 9, 10, 11], names: &names, ..content(Some(&path)) }));
    let strip = "pass 1, level 1 of 1";
    assert_eq!(file.node(strip)["extras"]["level"], 3);
    let places = file.places(strip);
    let length: f64 = places.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
    assert!((length - (48.0 + 3.0 + 10.0 * PI + 51.0)).abs() < 2e-3, "{length}");
    for place in &places {
        let is_on_arc = (place - Vector3::new(10.0, 0.0, -1.0)).norm() - 10.0;
        assert!(place.z > -1.0 + 1e-6 || is_on_arc.abs() < 1e-5, "{place}");
    }
    let (times, kinds) = (file.attribute(strip, "_TIME"), file.attribute(strip, "_KIND"));
    let (feeds, lines) = (file.attribute(strip, "_FEED"), file.attribute(strip, "_BLOCK"));
    let total = 0.6 + 3.0 + PI + 1.5 + 51.0 / 80.0;
    assert!((f64::from(times[times.len() - 1]) - total).abs() < 1e-5);
    assert!(times.windows(2).all(|pair| pair[0] <= pair[1]));
    let expected = [(0.0, 0.0, 7.0), (2.0, 60.0, 8.0), (1.0, 600.0, 9.0), (7.0, 0.0, 10.0), (0.0, 0.0, 11.0)];
    let mut found: Vec<(f32, f32, f32)> =
        kinds.iter().zip(&feeds).zip(&lines).map(|((k, f), l)| (*k, *f, *l)).collect();
    found[0].2 = 7.0;
    found.dedup();
    assert_eq!(found, expected);
    assert_eq!(file.node("part")["extras"]["chord_mm"], CHORD_MM);
}

#[test]
fn the_box_of_a_strip_is_that_of_its_numbers() {
    let path = path();
    let file = File::read(&glb(&content(Some(&path))));
    for accessor in file.json["accessors"].as_array().unwrap().iter().filter(|one| one.get("min").is_some()) {
        let places = file.places("pass 1");
        for axis in 0..3 {
            let least = places.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
            assert!((accessor["min"][axis].as_f64().unwrap() / container::METRES - least).abs() < 1e-9);
        }
    }
    let bounds = measure(&path, feed(4800.0)).bounds;
    let places = file.places("pass 1");
    let most = places.iter().fold(places[0], |most, p| most.sup(p));
    let least = places.iter().fold(places[0], |least, p| least.inf(p));
    assert!((most - bounds.max.coords).amax() < 1e-3 && (least - bounds.min.coords).amax() < 1e-3);
}

#[test]
fn a_part_far_from_the_origin_keeps_its_precision() {
    let at = 400_000.0;
    let mut path = Toolpath::builder(Point3::new(at, 0.0, 0.0));
    path.begin_pass(None);
    for k in 1..50 {
        path.line(Point3::new(at + 0.1 * f64::from(k), 0.0, 0.0), feed(100.0), Role::Cut).unwrap();
    }
    let path = path.finish().unwrap();
    let file = File::read(&glb(&content(Some(&path))));
    let moved = &file.node("part")["translation"];
    let origin =
        Vector3::new(moved[0].as_f64().unwrap(), -moved[2].as_f64().unwrap(), moved[1].as_f64().unwrap());
    // The cutter stays about its own tip.
    let tool = Tool::ball(5.0);
    let body = ToolBody::default();
    let far = File::read(&glb(&Content { tool: Some((&tool, &body)), ..content(Some(&path)) }));
    assert!(far.places("cutter").iter().all(|p| p.xy().norm() < 5.0 + 1e-6 && p.z > -1e-6));
    for (k, place) in file.places("pass 1").iter().enumerate() {
        let place = place + origin / container::METRES;
        assert!((place - Vector3::new(at + 0.1 * k as f64, 0.0, 0.0)).norm() < 1e-5, "{k}: {place}");
    }
}

#[test]
fn every_cutter_is_as_wide_and_as_long_as_told_and_its_normals_point_away() {
    let holder = vec![HolderSection { length_mm: 30.0, diameters_mm: [20.0, 32.0] }];
    let body = ToolBody { length_mm: Some(40.0), holder, ..ToolBody::default() };
    for shape in [
        Shape::Ball,
        Shape::Flat,
        Shape::BullNose { corner_radius_mm: 1.0 },
        Shape::V { tip_angle_deg: 90.0, tip_diameter_mm: 0.5 },
        Shape::Cone { taper_angle_deg: 10.0, tip_diameter_mm: 2.0 },
        Shape::Drill { point_angle_deg: None },
    ] {
        let tool = Tool { shape, ..Tool::ball(5.0) };
        let mesh = turned::cutter(&tool, &body);
        let (mut most, mut top, mut volume) = (0.0_f64, 0.0_f64, 0.0);
        for triangle in &mesh.triangles {
            let [a, b, c] = triangle.map(|k| mesh.points[k as usize]);
            let outward = (b - a).cross(&(c - a));
            assert!(outward.norm() > 0.0, "{shape:?}: a triangle without area");
            for k in triangle {
                let normal = mesh.normals[*k as usize];
                assert!((normal.norm() - 1.0).abs() < 1e-12 && normal.dot(&outward) > 0.0, "{shape:?}");
            }
            volume += a.coords.dot(&b.coords.cross(&c.coords)) / 6.0;
            for p in [a, b, c] {
                (most, top) = (most.max(p.xy().coords.norm()), top.max(p.z));
            }
        }
        assert!((most - 16.0).abs() < 1e-9 && (top - 70.0).abs() < 1e-9, "{shape:?}");
        let shank = PI * 25.0 * 40.0;
        let cone = PI * 30.0 / 3.0 * (10.0 * 10.0 + 10.0 * 16.0 + 16.0 * 16.0);
        assert!(volume > 0.9 * cone && volume < shank + cone, "{shape:?}: the surface is closed, {volume}");
    }
}

#[test]
fn nothing_is_a_legal_file_and_the_same_content_gives_the_same_bytes() {
    let file = File::read(&glb(&content(None)));
    assert!(file.bytes.is_empty() && file.json.get("buffers").is_none());
    let empty = Toolpath::empty();
    let file = File::read(&glb(&content(Some(&empty))));
    assert!(file.json.get("meshes").is_none());
    let path = path();
    assert_eq!(glb(&content(Some(&path))), glb(&content(Some(&path))));
}

#[test]
fn too_many_vertices_make_the_chord_wider_and_the_file_says_so() {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 0.0));
    path.begin_pass(None);
    for _ in 0..600 {
        let about = (Plane::Xy, Direction::Ccw);
        path.arc(Point3::origin(), Point3::new(20_000.0, 0.0, 0.0), about, feed(900.0), Role::Cut).unwrap();
    }
    let path = path.finish().unwrap();
    let file = File::read(&glb(&content(Some(&path))));
    let chord_mm = file.node("part")["extras"]["chord_mm"].as_f64().unwrap();
    assert!(chord_mm > CHORD_MM && chord_mm <= 1.0, "{chord_mm}");
    assert!(file.places("pass 1").len() <= MOST_VERTICES + 601);
}

#[test]
fn passes_beyond_the_nodes_share_strips_with_ways_that_are_not_known() {
    let mut path = Toolpath::builder(Point3::origin());
    for k in 0..3000 {
        let x = f64::from(k);
        path.begin_pass_apart(Point3::new(x, 10.0, 0.0));
        path.line(Point3::new(x, 20.0, 0.0), feed(100.0), Role::Cut).unwrap();
    }
    let path = path.finish().unwrap();
    let file = File::read(&glb(&content(Some(&path))));
    let strips = file.json["meshes"].as_array().unwrap().len();
    assert_eq!(strips, 1500);
    // Two passes of a strip, with the way between them.
    assert_eq!(file.attribute("pass 1", "_KIND"), [1.0, 1.0, 9.0, 9.0, 1.0, 1.0]);
    let places = file.places("pass 2999");
    assert!((places[3] - places[0] - Vector3::x()).norm() < 1e-3, "{places:?}");
}

#[test]
fn deviations_belong_to_the_cutting_moves_and_are_absent_where_none_is_known() {
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 5.0));
    path.line(Point3::origin(), feed(60.0), Role::Plunge).unwrap();
    path.line(Point3::new(1.0, 0.0, 0.0), feed(60.0), Role::Cut).unwrap();
    path.line(Point3::new(2.0, 0.0, 0.0), feed(60.0), Role::Cut).unwrap();
    path.line(Point3::new(3.0, 0.0, 0.0), feed(60.0), Role::Cut).unwrap();
    path.rapid(Point3::new(3.0, 0.0, 5.0)).unwrap();
    let path = path.finish().unwrap();
    let told = Content { deviations_mm: &[0.25, 0.5, f64::NAN], ..content(Some(&path)) };
    let found = File::read(&glb(&told)).attribute("pass 1", "_DEVIATION");
    // The vertices twice at one place are those where the kind changes.
    assert_eq!(found, [-1.0, -1.0, 0.25, 0.25, 0.5, -1.0, -1.0, -1.0]);
    let plain = File::read(&glb(&content(Some(&path))));
    assert!(plain.json["meshes"][0]["primitives"][0]["attributes"].get("_DEVIATION").is_none());
}

#[test]
fn diagrams_tell_the_time_of_the_path_at_which_their_clock_starts() {
    let path = path();
    let diagrams = [Diagram { name: "feed".into(), before: Vec::new(), after: vec![[0.0, 1.0], [6.0, 1.0]] }];
    // The rapid and the plunge are the way in, and the rapid at the end is the way out.
    let ends_s = [0.0, 0.0, 4.0, 6.0, 6.0];
    let told = Content { diagrams: &diagrams, diagram_ends_s: &ends_s, ..content(Some(&path)) };
    let file = File::read(&glb(&told));
    let about = &file.node("part")["extras"];
    let starts_at_s = about["diagrams"][0]["starts_at_s"].as_f64().unwrap();
    assert!((starts_at_s - 3.6).abs() < 1e-9, "{starts_at_s}");
    let clock = about["clock"].as_array().unwrap();
    let times: Vec<[f64; 2]> = clock.iter().map(|pair| [0, 1].map(|k| pair[k].as_f64().unwrap())).collect();
    let expected = [[0.0, 3.6], [4.0, 3.6 + PI], [6.0, 5.1 + PI]];
    let differs = |(found, told): (&[f64; 2], &[f64; 2])| (0..2).any(|k| (found[k] - told[k]).abs() > 1e-9);
    assert!(times.len() == 3 && !times.iter().zip(&expected).any(differs), "{times:?}");
    let plain = File::read(&glb(&Content { diagram_ends_s: &[], ..told }));
    let about = &plain.node("part")["extras"];
    assert!(about.get("clock").is_none() && about["diagrams"][0].get("starts_at_s").is_none());
}

#[test]
fn diagrams_are_thinned_and_keep_their_extremes_and_an_assumed_stock_is_told() {
    let course: Vec<[f64; 2]> =
        (0..50_000).map(|k| [f64::from(k), if k == 31_234 { 9.0 } else { 0.5 }]).collect();
    let diagrams = [Diagram { name: "feed, mm/min".into(), before: Vec::new(), after: course }];
    let stock = Stock { triangles: solid::block([0.0; 3].into(), [1.0; 3].into()), is_assumed: true };
    let content = Content { diagrams: &diagrams, stock: Some(&stock), ..content(None) };
    let file = File::read(&glb(&content));
    let about = &file.node("part")["extras"];
    let after = about["diagrams"][0]["after"].as_array().unwrap();
    assert!(after.len() <= 2 * MOST_COLUMNS + 2 && after.contains(&json!([31_234.0, 9.0])));
    assert_eq!((&about["stock_is_assumed"], &about["diagrams"][0]["before"]), (&json!(true), &json!([])));
    assert_eq!(file.places("stock").len(), 24);
}
