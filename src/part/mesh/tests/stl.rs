//! STL as text and binary, and its faults.

use super::solids::Triangles;
use super::writing::{stl_binary, stl_text};
use super::*;

fn cube() -> Triangles {
    Triangles::cuboid([0.0; 3], [1.0; 3])
}

fn read_stl(bytes: &[u8]) -> MeshFile {
    read_whole(MeshFormat::Stl, bytes)
}

#[test]
fn a_binary_file_may_begin_with_the_word_solid() {
    for header in ["solid", "SOLID a facet", "solid a\nfacet", "binary", ""] {
        assert_eq!(read_stl(&stl_binary(&cube(), header)).triangles.len(), 12, "{header}");
    }
}

#[test]
fn bytes_behind_the_last_triangle_are_counted() {
    let mut bytes = stl_binary(&cube(), "solid");
    bytes.extend([7; 49]);
    let mesh = read_stl(&bytes);
    assert_eq!(mesh.triangles.len(), 12);
    assert_eq!(left_out(&mesh), [("byte", 49, "byte 684".to_owned())]);
}

#[test]
fn attributes_of_triangles_are_counted() {
    let mut bytes = stl_binary(&cube(), "");
    bytes[84 + 50 + 48] = 1;
    bytes[84 + 150 + 49] = 1;
    assert_eq!(left_out(&read_stl(&bytes)), [("attribute", 2, "byte 134".to_owned())]);
}

#[test]
fn every_way_of_writing_a_text_gives_the_same_mesh() {
    let text = stl_text(&cube());
    let expected = read_stl(text.as_bytes());
    for text in [
        text.replace('\n', "\r\n"),
        text.replace('\n', "\r"),
        text.to_uppercase(),
        text.replace('\n', "\n\n\t "),
        text.replace("outer loop\n", "outer loop "),
        text.replace("solid a part", "solid"),
        text.replace("solid a part", "solid facet normal"),
        format!("\u{feff}{text}"),
        format!("\n  {text}  \n"),
        text.replace(" 1 ", " +1.0E0 "),
        text.replace("normal 0 0 0", "normal nan -nan(ind) -1.#IND"),
    ] {
        assert_eq!(read_stl(text.as_bytes()), expected, "{text}");
    }
}

#[test]
fn all_solids_of_a_text_are_one_mesh() {
    let far = Triangles::cuboid([2.0; 3], [3.0; 3]);
    let text = stl_text(&cube()) + "\n\n" + &stl_text(&far);
    let mesh = read_stl(text.as_bytes());
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (16, 24));
    assert_eq!(figures_of(&mesh).n_bodies, 2);
}

#[test]
fn equal_points_are_one_vertex_and_minus_zero_is_zero() {
    let text = stl_text(&cube()).replacen("vertex 0 0 0", "vertex -0 0.0 -0e5", 2);
    let mesh = read_stl(text.as_bytes());
    assert_eq!(mesh.vertices.len(), 8);
    assert!(mesh.vertices.iter().flatten().all(|x| x.is_sign_positive()));
    let moved = stl_text(&cube()).replacen("vertex 1 1 1", "vertex 1 1 1.0000000000000002", 1);
    assert_eq!(read_stl(moved.as_bytes()).vertices.len(), 9);
}

#[test]
fn triangles_without_area_are_counted() {
    let mut mesh = cube();
    // On one edge of the cube: a point in its middle, and the edge itself.
    mesh.points.push([0.5, 0.0, 0.0]);
    mesh.triangles.extend([[0, 8, 1], [0, 0, 1], [3, 3, 3]]);
    let read = read_stl(stl_text(&mesh).as_bytes());
    assert_eq!((read.triangles.len(), read.slivers.len(), read.n_degenerate), (12, 1, 3));
    let expected = [("triangle", 1, "line 86".to_owned()), ("triangle", 2, "line 93".to_owned())];
    assert_eq!(left_out(&read), expected);
}

#[test]
fn a_normal_that_contradicts_the_order_of_the_corners_is_counted() {
    let text = "solid\nfacet normal 0 0 -1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n\
                endloop\nendfacet\nendsolid";
    assert_eq!(left_out(&read_stl(text.as_bytes())), [("normal", 1, "line 2".to_owned())]);
    assert_eq!(left_out(&read_stl(text.replace("-1", "1").as_bytes())), []);
}

#[test]
fn a_broken_text_is_refused_with_its_line() {
    let text = stl_text(&cube());
    for (from, to, expected) in [
        ("vertex 1 1 1", "vertex 1 nan 1", "line 20: NaN is no coordinate"),
        ("vertex 1 1 1", "vertex 1 inf 1", "line 20: inf is no coordinate"),
        ("vertex 1 1 1", "vertex 1 2e9 1", "line 20: 2e9 is no coordinate"),
        ("vertex 1 1 1", "vertex 1 1", "line 21: \"endloop\" stands in the place of a number"),
        ("vertex 1 1 1", "vertex 1,1,1", "line 20: \"1,1,1\" stands in the place of a number"),
        ("endloop", "vertex 1 2 3\nendloop", "line 7: \"vertex\" stands in the place of endloop"),
        ("endfacet", "", "line 9: \"facet\" stands in the place of endfacet"),
        ("endsolid a part\n", "", "line 86: the text ends in the place of facet or endsolid"),
        ("endsolid a part\n", "endsolid a\nrest", "line 87: \"rest\" stands in the place of solid"),
    ] {
        let broken = text.replacen(from, to, 1);
        let found = fault(MeshFormat::Stl, broken.as_bytes());
        assert_eq!(found, expected, "{from} -> {to}");
    }
}

#[test]
fn a_count_that_is_not_there_is_refused() {
    let mut bytes = vec![0; 84];
    bytes[80..].fill(255);
    let found = fault(MeshFormat::Stl, &bytes);
    assert_eq!(found, "byte 84: 4294967295 triangles were to follow byte 84; the file has 0");
    let found = fault(MeshFormat::Stl, b"no mesh at all");
    assert_eq!(found, "the file: it is neither a text of solids, nor long enough for a binary STL file");
    assert_eq!(fault(MeshFormat::Stl, &[0; 84]), "the file: there is no triangle in it");
    assert_eq!(fault(MeshFormat::Stl, b"solid a\nendsolid a"), "the file: there is no triangle in it");
}

#[test]
fn numbers_that_are_none_are_refused_in_a_binary_file() {
    for wrong in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 1.5e9] {
        let mut bytes = stl_binary(&cube(), "");
        bytes[84 + 50 + 12..][..4].copy_from_slice(&wrong.to_le_bytes());
        let found = fault(MeshFormat::Stl, &bytes);
        assert!(found.starts_with("byte 134: ") && found.ends_with("is no coordinate"), "{found}");
    }
}
