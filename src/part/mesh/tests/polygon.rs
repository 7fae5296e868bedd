//! Faces of more than three corners.

use std::fmt::Write as _;

use proptest::prelude::*;

use super::*;

/// A file with one face of these corners.
fn face(points: &[[f64; 3]]) -> String {
    let mut text = String::new();
    for [x, y, z] in points {
        writeln!(text, "v {x} {y} {z}").unwrap();
    }
    let numbers: Vec<String> = (1..=points.len()).map(|k| k.to_string()).collect();
    writeln!(text, "f {}", numbers.join(" ")).unwrap();
    text
}

fn read_face(points: &[[f64; 3]]) -> MeshFile {
    read_whole(MeshFormat::Obj, face(points).as_bytes())
}

/// Twice the area of a triangle as seen from above; negative where it is seen from below.
fn area_in_plan(mesh: &MeshFile, triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = mesh.corners(triangle);
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

const DART: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 4.0, 0.0]];

#[test]
fn a_face_with_a_corner_that_turns_inward_is_cut_within_itself() {
    for shift in 0..4 {
        let mut points = DART;
        points.rotate_left(shift);
        let mesh = read_face(&points);
        assert_eq!(mesh.triangles.len(), 2);
        assert_eq!(figures_of(&mesh).area, 4.0, "{shift}");
        assert!(mesh.triangles.iter().all(|own| area_in_plan(&mesh, own) > 0.0), "{shift}");
    }
}

#[test]
fn a_face_is_cut_in_every_plane_and_from_both_sides() {
    for turn in 0..3 {
        for is_reversed in [false, true] {
            let mut points = DART.map(|[x, y, z]| {
                let mut point = [x, y, z + 2.0 * x - 3.0 * y];
                point.rotate_left(turn);
                point
            });
            if is_reversed {
                points.reverse();
            }
            let mesh = read_face(&points);
            let expected = 4.0 * 14.0_f64.sqrt();
            let found = figures_of(&mesh).area;
            assert!((found - expected).abs() < 1e-12, "{turn} {is_reversed}: {found}");
            assert!(mesh.off_plane_max < 1e-14);
            let normals: Vec<_> = mesh
                .triangles
                .iter()
                .map(|own| {
                    let [a, b, c] = mesh.corners(own);
                    crate::mesh::welding::cross(
                        crate::mesh::welding::sub(b, a),
                        crate::mesh::welding::sub(c, a),
                    )
                })
                .collect();
            let agree = crate::mesh::welding::dot(normals[0], normals[1]) > 0.0;
            let side = normals[0][(2 + 3 - turn) % 3] > 0.0;
            assert!(agree && side != is_reversed, "{turn} {is_reversed}: {normals:?}");
        }
    }
}

#[test]
fn corners_on_straight_edges_get_triangles_with_an_area() {
    let square =
        [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0], [0.0, 1.0]];
    for shift in 0..8 {
        let mut points = square.map(|[x, y]| [x, y, 0.0]);
        points.rotate_left(shift);
        let mesh = read_face(&points);
        assert_eq!((mesh.triangles.len(), mesh.slivers.len(), mesh.n_degenerate), (6, 0, 0), "{shift}");
        assert_eq!(figures_of(&mesh).area, 4.0);
    }
}

#[test]
fn a_face_with_a_hole_and_a_seam_to_it_is_cut_around_the_hole() {
    // A square ring: the seam from the outer corner to the inner one goes there and back.
    let ring = [
        [0.0, 0.0],
        [3.0, 0.0],
        [3.0, 3.0],
        [0.0, 3.0],
        [0.0, 0.0],
        [1.0, 1.0],
        [1.0, 2.0],
        [2.0, 2.0],
        [2.0, 1.0],
        [1.0, 1.0],
    ];
    let mesh = read_face(&ring.map(|[x, y]| [x, y, 0.0]));
    assert_eq!(figures_of(&mesh).area, 8.0);
    assert_eq!(mesh.triangles.len(), 8);
}

#[test]
fn the_distance_of_a_bent_face_from_its_plane_is_told() {
    let mesh = read_face(&[[0.0, 0.0, 1.0], [2.0, 0.0, -1.0], [2.0, 2.0, 1.0], [0.0, 2.0, -1.0]]);
    assert_eq!((mesh.triangles.len(), mesh.n_polygons), (2, 1));
    assert!((mesh.off_plane_max - 1.0).abs() < 1e-15, "{}", mesh.off_plane_max);
}

#[test]
fn faces_that_are_none_are_listed() {
    let whole = "v 9 0 0\nv 9 1 0\nv 9 0 1\nf 1 2 3\n";
    for (text, reason) in [
        ("f 1\n", "it has fewer than three corners"),
        ("f\n", "it has fewer than three corners"),
        ("f 1 1 2 2\n", "its area is 0"),
        ("f 1 2 1 2\n", "its area is 0"),
    ] {
        let mesh = read_whole(MeshFormat::Obj, (whole.to_owned() + text).as_bytes());
        let found: Vec<_> =
            mesh.left_out.iter().map(|own| (own.kind.as_str(), own.reason.as_str())).collect();
        assert_eq!(found, [("face", reason)], "{text}");
    }
    // A bow that is larger on one side.
    let bow = "v 0 0 0\nv 3 0 0\nv 1 2 0\nv 3 3 0\nf 4 5 6 7\n";
    let mesh = read_whole(MeshFormat::Obj, (whole.to_owned() + bow).as_bytes());
    assert_eq!(mesh.left_out[0].reason, "its edges cross each other");
}

#[test]
fn a_face_that_goes_round_twice_is_no_convex_face() {
    // A star of five corners turns left at each of them.
    let star: Vec<_> = (0..5)
        .map(|k| (f64::from(k) * 0.8 * std::f64::consts::PI).sin_cos())
        .map(|(sin, cos)| [cos, sin, 0.0])
        .collect();
    let text = "v 9 0 0\nv 9 1 0\nv 9 0 1\nf 1 2 3\n".to_owned()
        + &star.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect::<String>()
        + "f 4 5 6 7 8\n";
    let mesh = read_whole(MeshFormat::Obj, text.as_bytes());
    assert_eq!((mesh.triangles.len(), mesh.left_out[0].reason.as_str()), (1, "its edges cross each other"));
}

#[test]
fn a_large_face_is_read_if_it_is_convex() {
    let circle = |n: usize, inner: f64| -> Vec<[f64; 3]> {
        let radius = |k: usize| if k == 7 { inner } else { 1.0 };
        (0..n)
            .map(|k| (radius(k), (k as f64 / n as f64 * std::f64::consts::TAU).sin_cos()))
            .map(|(radius, (sin, cos))| [radius * cos, radius * sin, 0.0])
            .collect()
    };
    assert_eq!(read_face(&circle(6000, 1.0)).triangles.len(), 5998);
    let found = fault(MeshFormat::Obj, face(&circle(6000, 0.5)).as_bytes());
    assert_eq!(found, "line 6001: a face that is not convex has 6000 corners; at most 5000 are read");
    let many = "v 0 0 0\nf".to_owned() + &" 1".repeat(100_001);
    let found = fault(MeshFormat::Obj, many.as_bytes());
    assert_eq!(found, "line 2: a face has 100001 corners; at most 100000 are read");
}

proptest! {
    /// A star of any corners around a point is a simple chain; its triangles tile it.
    #[test]
    fn the_triangles_of_a_star_tile_it(radii in prop::collection::vec(0.1..10.0_f64, 5..60)) {
        let n = radii.len() as f64;
        let points: Vec<[f64; 3]> = radii
            .iter()
            .zip(0..)
            .map(|(radius, k)| (radius, (f64::from(k) / n * std::f64::consts::TAU).sin_cos()))
            .map(|(radius, (sin, cos))| [radius * cos, radius * sin, 0.0])
            .collect();
        let mesh = read_face(&points);
        let areas: Vec<f64> = mesh.triangles.iter().map(|own| area_in_plan(&mesh, own)).collect();
        prop_assert_eq!(mesh.triangles.len() + 2, points.len());
        prop_assert!(areas.iter().all(|area| *area > 0.0));
        let next = points.iter().cycle().skip(1);
        let expected: f64 = points.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum();
        prop_assert!((areas.iter().sum::<f64>() - expected).abs() < 1e-9 * expected);
    }
}
