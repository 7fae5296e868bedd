//! Statements of OBJ, and its faults.

use super::solids::Triangles;
use super::writing::obj;
use super::*;

fn cube() -> String {
    obj(&Triangles::cuboid([0.0; 3], [1.0; 3]))
}

fn read_obj(text: &str) -> MeshFile {
    read_whole(MeshFormat::Obj, text.as_bytes())
}

/// A pyramid over a square, whose faces are written as given.
fn pyramid(faces: &str) -> String {
    format!("v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 1 3\nvt 0 0\nvn 0 0 1\n{faces}\n")
}

#[test]
fn every_way_of_naming_a_corner_gives_the_same_pyramid() {
    for faces in [
        "f 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5",
        "f 4/1 3/1 2/1 1/1\nf 1/1 2/1 5/1\nf 2/1 3/1 5/1\nf 3/1 4/1 5/1\nf 4/1 1/1 5/1",
        "f 4//1 3//1 2//1 1//1\nf 1//1 2//1 5//1\nf 2//1 3//1 5//1\nf 3//1 4//1 5//1\nf 4//1 1//1 5//1",
        "f -2 -3 -4 -5\nf 1/1/1 2/1/1 -1/1/1\nf 2 3 -1\nf 3 4 -1\nf -2 -5 -1",
        "f 4 3 2 \\\n 1\nf 1 \\\r\n2 \\\n5\nf 2 3 5\t\n  f 3 4 5 # a remark\nf 4 1 5",
        "fo 4 3 2 1\nf 1 2 5\nf 2 3 5\nf 3 4 5\nf 4 1 5",
    ] {
        for text in [pyramid(faces), pyramid(faces).replace("\r\n", "\n").replace('\n', "\r\n")] {
            let mesh = read_obj(&text);
            let figures = figures_of(&mesh);
            assert_eq!((mesh.triangles.len(), mesh.n_polygons, mesh.off_plane_max), (6, 1, 0.0), "{text}");
            assert_eq!(figures.solid.unwrap().volume, 4.0, "{text}");
        }
    }
}

/// A backslash at the end of a comment, or on a line of its own, joins no lines.
#[test]
fn a_comment_that_ends_with_a_backslash_swallows_nothing() {
    let faces = "f 4 3 2 1\nf 1 2 5\n# from C:\\parts\\\nf 2 3 5\nf 3 4 5\nf 4 1 5";
    assert_eq!(read_obj(&pyramid(faces)).triangles.len(), 6);
}

#[test]
fn a_face_may_stand_before_its_vertices() {
    let text = cube();
    let faces: String =
        text.lines().filter(|line| line.starts_with('f')).flat_map(|own| [own, "\n"]).collect();
    let vertices: String =
        text.lines().filter(|line| line.starts_with('v')).flat_map(|own| [own, "\n"]).collect();
    assert_eq!(read_obj(&(faces + &vertices)), read_obj(&text));
}

#[test]
fn negative_numbers_count_from_the_last_vertex_before_the_face() {
    let text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 5\nv 1 0 5\nv 0 1 5\nf -3 -2 -1\n";
    let mesh = read_obj(text);
    assert_eq!(figures_of(&mesh).bounds, [[0.0; 3], [1.0, 1.0, 5.0]]);
    assert_eq!(figures_of(&mesh).area, 1.0);
}

#[test]
fn all_that_is_no_face_is_listed() {
    let text = "mtllib a.mtl\no part\ng side\nusemtl steel\ns off\nvt 0 0\nvn 0 0 1\nl 1 2\nl 2 3\np 1\n\
                cstype bezier\nwhatever 1\nso 2\nv 9 9 9\n";
    let mesh = read_obj(&(cube() + text));
    let found: Vec<_> = mesh.left_out.iter().map(|own| (own.kind.as_str(), own.count)).collect();
    let expected = [
        ("mtllib", 1),
        ("o", 1),
        ("g", 1),
        ("usemtl", 1),
        ("s", 1),
        ("vt", 1),
        ("vn", 1),
        ("l", 2),
        ("p", 1),
        ("cstype", 1),
        ("statement", 2),
        ("vertex", 1),
    ];
    assert_eq!(found, expected);
    assert_eq!(mesh.left_out[0].first, Place::Line(21));
}

#[test]
fn colours_and_weights_of_vertices_are_listed() {
    let colours = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nf 1 2 3";
    assert_eq!(left_out(&read_obj(colours)), [("v", 3, "line 1".to_owned())]);
    let weights = "v 0 0 0\nv 1 0 0 1\nv 0 1 0 0.5\nf 1 2 3";
    assert_eq!(left_out(&read_obj(weights)), [("v", 2, "line 2".to_owned())]);
}

#[test]
fn a_broken_file_is_refused_with_its_line() {
    for (text, expected) in [
        ("v 0 0 0\nv 1 0\n", "line 2: a vertex has three coordinates"),
        ("v 0 0 0\nv 1 0 a\n", "line 2: \"a\" is no coordinate"),
        ("v 0 0 0\nv 1 nan 0\n", "line 2: NaN is no coordinate"),
        ("v 0 0 0\nf 1 2 3\n", "line 2: there is no vertex 2; the file has 1"),
        ("v 0 0 0\nf 0 1 1\n", "line 2: there is no vertex 0; the file has 1"),
        ("v 0 0 0\nf -2 1 1\n", "line 2: there is no vertex -2; the file has 1"),
        ("v 0 0 0\nf 1 1 4294967297\n", "line 2: there is no vertex 4294967297; the file has 1"),
        (
            "v 0 0 0\nf -9223372036854775808 1 1\n",
            "line 2: there is no vertex -9223372036854775808; the file has 1",
        ),
        ("v 0 0 0\nf 9223372036854775808 1 1\n", "line 2: \"9223372036854775808\" is no number of a vertex"),
        ("v 0 0 0\nf 1.5 1 1\n", "line 2: \"1.5\" is no number of a vertex"),
        ("v 0 0 0\nf /1 1 1\n", "line 2: \"/1\" is no number of a vertex"),
        ("v 0 0 0\nl 1 1\n", "the file: there is no triangle in it"),
        ("", "the file: there is no triangle in it"),
    ] {
        assert_eq!(fault(MeshFormat::Obj, text.as_bytes()), expected, "{text}");
    }
}
