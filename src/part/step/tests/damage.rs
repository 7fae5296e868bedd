//! Broken files end in an error or in what can be read, and never in a panic.

use std::time::Duration;

use toolpathd_core::budget::{Budget, Stopped};

use super::shapes::{level, ring, sphere, square, wall};
use super::writer::{Length, Writer, read_text};
use crate::fault::{Place, Unreadable};
use crate::step::{Model, read};

/// A file with faces of several kinds.
fn file() -> String {
    let mut w = Writer::new(Length::Inch);
    let rings = [ring(&mut w, 3.0, 0.0), ring(&mut w, 3.0, 5.0)];
    let ball = sphere(&mut w, 2.0);
    let faces = [square(&mut w, 2.0, 1.0), wall(&mut w, 3.0, rings, true), w.face(&[], ball, true)];
    let points: Vec<String> =
        (0..6).map(|k| format!("#{}", w.point([f64::from(k), 0.0, f64::from(k % 3)]))).collect();
    let net = format!("(({}),({}))", points[..3].join(","), points[3..].join(","));
    let spline = w.add(format!(
        "B_SPLINE_SURFACE_WITH_KNOTS('',1,2,{net},.UNSPECIFIED.,.F.,.F.,.F.,(2,2),(3,3),(0.,1.),(0.,1.),.UNSPECIFIED.)"
    ));
    let curve = w.add(format!(
        "B_SPLINE_CURVE_WITH_KNOTS('',2,({}),.UNSPECIFIED.,.F.,.F.,(3,3),(0.,1.),.UNSPECIFIED.)",
        points[..3].join(",")
    ));
    let ends = [w.vertex([0.0; 3]), w.vertex([2.0, 0.0, 2.0])];
    let line = w.line([2.0, 0.0, 2.0], [0.0; 3]);
    let edges = [w.edge(ends, curve), w.edge([ends[1], ends[0]], line)];
    let bound = w.bound(&[(edges[0], true), (edges[1], true)]);
    let strip = w.face(&[bound], spline, true);
    w.of_faces(&[faces[0], faces[1], faces[2], strip])
}

/// A number from 0 to `below`, and the next state.
fn random(state: &mut u64, below: usize) -> usize {
    *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*state >> 33) as usize % below
}

/// All numbers of the faces are finite.
fn check(model: &Model) {
    for face in &model.faces {
        assert!(face.area_mm2 > 0.0 && face.area_mm2.is_finite());
        let points = face.nurbs.control_points.iter().flatten().chain(&face.bounds_mm);
        assert!(points.flat_map(|point| point.iter()).all(|x| x.is_finite()), "{face:?}");
    }
}

#[test]
fn the_file_is_sound() {
    assert_eq!(read_text(&file()).unwrap().left_out.iter().map(|one| one.count).sum::<usize>(), 1);
}

#[test]
fn every_part_of_a_file_is_refused() {
    let text = file();
    let end = text.find("END-ISO").unwrap();
    for cut in (0..end).step_by(7) {
        assert!(read_text(&text[..cut]).is_err(), "{cut}");
    }
}

#[test]
fn damaged_bytes_do_no_harm() {
    let text = file();
    let mut state = 1;
    let letters = b"#()',;.*$0123456789E+-AFT/\"\\\n\0\xFF";
    for _ in 0..3000 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..1 + random(&mut state, 4) {
            let at = random(&mut state, bytes.len());
            match random(&mut state, 3) {
                0 => bytes[at] = letters[random(&mut state, letters.len())],
                1 => drop(bytes.remove(at)),
                _ => bytes.insert(at, letters[random(&mut state, letters.len())]),
            }
        }
        if let Ok(model) = read(&bytes, &Budget::unlimited()) {
            check(&model);
        }
    }
}

#[test]
fn other_values_and_references_do_no_harm() {
    let text = file();
    let lines: Vec<&str> = text.lines().collect();
    let mut state = 7;
    let values = [
        "0.",
        "-1.",
        "1.E300",
        "-1.E300",
        "1.E-300",
        "$",
        "*",
        "()",
        "#10",
        "#77",
        "'x'",
        ".T.",
        "1000000000",
    ];
    for _ in 0..3000 {
        let mut lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        for _ in 0..1 + random(&mut state, 3) {
            let k = 7 + random(&mut state, lines.len() - 9);
            let starts: Vec<usize> = lines[k].match_indices([',', '(']).map(|(at, _)| at + 1).collect();
            let Some(start) = starts.get(random(&mut state, starts.len().max(1))) else { continue };
            let length = lines[k][*start..].find([',', ')']).unwrap_or(0);
            let value = values[random(&mut state, values.len())];
            lines[k].replace_range(*start..start + length, value);
        }
        if let Ok(model) = read_text(&lines.join("\n")) {
            check(&model);
        }
    }
}

#[test]
fn noise_behind_the_head_of_a_file_does_no_harm() {
    let mut state = 3;
    for n in 0..300 {
        let mut bytes = b"ISO-10303-21;HEADER;ENDSEC;DATA;#1=".to_vec();
        bytes.extend((0..n).map(|_| random(&mut state, 256) as u8));
        assert!(read(&bytes, &Budget::unlimited()).is_err());
    }
}

/// The place and the text of the refusal of a file with one solid of a face on a surface.
fn refusal(make: impl Fn(&mut Writer) -> usize) -> (Place, String) {
    let mut w = Writer::new(Length::Millimetre);
    let surface = make(&mut w);
    let edge = ring(&mut w, 2.0, 0.0);
    let bound = w.bound(&[(edge, true)]);
    let face = w.face(&[bound], surface, true);
    match read_text(&w.of_faces(&[face])) {
        Err(Unreadable::Broken { place, detail }) => (place, detail),
        other => panic!("{other:?}"),
    }
}

#[test]
fn wrong_instances_are_named() {
    let (place, detail) = refusal(|w| w.add("PLANE('',#999)"));
    assert_eq!(place, Place::Entity(999));
    assert!(detail.contains("does not have it"), "{detail}");
    let (_, detail) = refusal(|w| {
        let point = w.point([0.0; 3]);
        w.add(format!("PLANE('',#{point})"))
    });
    assert!(detail.contains("a placement is expected, not CARTESIAN_POINT"), "{detail}");
    let (_, detail) = refusal(|w| {
        let frame = w.upright([0.0; 3]);
        w.add(format!("SPHERICAL_SURFACE('',#{frame},-1.)"))
    });
    assert!(detail.contains("above zero"), "{detail}");
    let (_, detail) = refusal(|w| {
        let (point, direction) = (w.point([0.0; 3]), w.direction([0.0; 3]));
        let frame = w.add(format!("AXIS2_PLACEMENT_3D('',#{point},#{direction},$)"));
        w.add(format!("PLANE('',#{frame})"))
    });
    assert!(detail.contains("no length"), "{detail}");
}

#[test]
fn huge_counts_are_refused_before_memory_is_taken() {
    for counts in
        ["(4000000000000000000,4)", "(9223372036854775807,9223372036854775807)", "(-1,9)", "(2,2,2)"]
    {
        let (_, detail) = refusal(|w| {
            let points: Vec<String> =
                (0..4).map(|k| format!("#{}", w.point([f64::from(k), 1.0, 2.0]))).collect();
            let net = format!("(({}),({}))", points[..2].join(","), points[2..].join(","));
            w.add(format!(
                "B_SPLINE_SURFACE_WITH_KNOTS('',1,1,{net},.U.,.F.,.F.,.F.,{counts},(2,2),(0.,1.),(0.,1.),.U.)"
            ))
        });
        assert!(detail.contains("the counts of the knots"), "{detail}");
    }
}

#[test]
fn curves_and_surfaces_that_contain_themselves_are_refused() {
    let (_, detail) = refusal(|w| {
        let next = w.point([0.0; 3]) + 1;
        w.add(format!("RECTANGULAR_TRIMMED_SURFACE('',#{next},0.,1.,0.,1.,.T.,.T.)"))
    });
    assert!(detail.contains("in a circle"), "{detail}");
    let (_, detail) = refusal(|w| {
        let direction = w.direction([0.0, 0.0, 1.0]);
        let vector = w.add(format!("VECTOR('',#{direction},1.)"));
        let curve = w.add(format!("TRIMMED_CURVE('',#{},$,$,.T.,.U.)", vector + 1));
        w.add(format!("SURFACE_OF_LINEAR_EXTRUSION('',#{curve},#{vector})"))
    });
    assert!(detail.contains("in a circle"), "{detail}");
}

#[test]
fn edges_that_do_not_meet_leave_the_face_out() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let plane = w.add(format!("PLANE('',#{frame})"));
    let (a, b) = (w.vertex([0.0; 3]), w.vertex([5.0, 0.0, 0.0]));
    let line = w.line([0.0; 3], [5.0, 0.0, 0.0]);
    let edge = w.edge([a, b], line);
    let bound = w.bound(&[(edge, true)]);
    let face = w.face(&[bound], plane, true);
    let model = w.model(&[face]);
    assert_eq!(model.faces, []);
    assert_eq!(model.left_out[0].reason, "the edges of a bound do not meet");
}

#[test]
fn a_stopped_budget_ends_the_reading() {
    let budget = Budget::unlimited();
    budget.cancel();
    assert_eq!(read(file().as_bytes(), &budget), Err(Unreadable::Stopped(Stopped::Cancelled)));
}

/// A face of many edges, each of which is a curve of many control points.
#[test]
fn a_stop_from_outside_ends_the_reading_of_one_face() {
    let mut w = Writer::new(Length::Millimetre);
    let points: Vec<String> =
        (0..20_000).map(|k| format!("#{}", w.point([f64::from(k), f64::from(k % 2), 0.0]))).collect();
    let curve = w.add(format!("BEZIER_CURVE('',1,({}),.UNSPECIFIED.,.F.,.F.)", points.join(",")));
    let ends = [w.vertex([0.0; 3]), w.vertex([19_999.0, 1.0, 0.0])];
    let edge = w.edge(ends, curve);
    let edges: Vec<(usize, bool)> = (0..20_000).map(|k| (edge, k % 2 == 0)).collect();
    let bound = w.bound(&edges);
    let face = level(&mut w, &[bound], 0.0);
    let text = w.of_faces(&[face]);
    let budget = Budget::unlimited();
    let clone = budget.clone();
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_millis(200));
        clone.cancel();
    });
    assert_eq!(read(text.as_bytes(), &budget), Err(Unreadable::Stopped(Stopped::Cancelled)));
}
