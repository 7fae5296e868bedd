//! Headers, types and orders of bytes of PLY, and its faults.

use super::solids::Triangles;
use super::writing::{ply_binary, ply_text};
use super::*;

const HEADER: &str = "ply\nformat ascii 1.0\n";

fn read_ply(text: &str) -> MeshFile {
    read_whole(MeshFormat::Ply, text.as_bytes())
}

fn tetrahedron() -> Triangles {
    Triangles::tetrahedron([1.0, 2.0, 3.0])
}

/// The types of numbers, with how each is written.
type Number = (&'static str, fn(f64) -> Vec<u8>);

const NUMBERS: [Number; 16] = [
    ("char", |x| (x as i8).to_be_bytes().into()),
    ("int8", |x| (x as i8).to_be_bytes().into()),
    ("uchar", |x| (x as u8).to_be_bytes().into()),
    ("uint8", |x| (x as u8).to_be_bytes().into()),
    ("short", |x| (x as i16).to_be_bytes().into()),
    ("int16", |x| (x as i16).to_be_bytes().into()),
    ("ushort", |x| (x as u16).to_be_bytes().into()),
    ("uint16", |x| (x as u16).to_be_bytes().into()),
    ("int", |x| (x as i32).to_be_bytes().into()),
    ("int32", |x| (x as i32).to_be_bytes().into()),
    ("uint", |x| (x as u32).to_be_bytes().into()),
    ("uint32", |x| (x as u32).to_be_bytes().into()),
    ("float", |x| (x as f32).to_be_bytes().into()),
    ("float32", |x| (x as f32).to_be_bytes().into()),
    ("double", |x| x.to_be_bytes().into()),
    ("float64", |x| x.to_be_bytes().into()),
];

/// A tetrahedron with extra properties, in these types, with the least byte of each number first or last.
fn written(numbers: [Number; 3], is_little: bool) -> Vec<u8> {
    let [(count, write_count), (index, write_index), (coordinate, write_coordinate)] = numbers;
    let order = if is_little { "little" } else { "big" };
    let mut bytes = format!(
        "ply\r\nformat binary_{order}_endian 1.0\r\nelement vertex 4\r\nproperty list {count} short tags\r\n\
         property {coordinate} z\r\nproperty uchar red\r\nproperty {coordinate} x\r\nproperty {coordinate} y\r\n\
         element face 4\r\nproperty list {count} {index} vertex_index\r\nproperty float quality\r\nend_header\r\n"
    )
    .into_bytes();
    let mut push = |mut number: Vec<u8>| {
        if is_little {
            number.reverse();
        }
        bytes.extend(number);
    };
    let mesh = tetrahedron();
    for [x, y, z] in mesh.points {
        push(write_count(1.0));
        push(7_i16.to_be_bytes().into());
        push(write_coordinate(z));
        push(vec![255]);
        push(write_coordinate(x));
        push(write_coordinate(y));
    }
    for corners in mesh.triangles {
        push(write_count(3.0));
        corners.iter().for_each(|corner| push(write_index(*corner as f64)));
        push(0.5_f32.to_be_bytes().into());
    }
    bytes
}

#[test]
fn every_type_of_counts_numbers_and_coordinates_is_read_in_both_orders() {
    for kind in NUMBERS {
        for numbers in
            [[kind, NUMBERS[8], NUMBERS[12]], [NUMBERS[2], kind, NUMBERS[12]], [NUMBERS[2], NUMBERS[8], kind]]
        {
            for is_little in [true, false] {
                let mesh = read_whole(MeshFormat::Ply, &written(numbers, is_little));
                assert_eq!(figures_of(&mesh).solid.unwrap().volume, 1.0, "{} {is_little}", kind.0);
                let found: Vec<_> = mesh.left_out.iter().map(|own| (own.kind.as_str(), own.count)).collect();
                assert_eq!(found, [("vertex tags", 4), ("vertex red", 4), ("face quality", 4)]);
            }
        }
    }
}

#[test]
fn other_elements_are_passed_over_and_listed() {
    let text = format!(
        "{HEADER}comment any text\nobj_info any text\nelement material 2\nproperty list int float data\n\
         element empty 4000000000\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         element face 1\nproperty list uchar int vertex_indices\nelement edge 1\nproperty int a\n\
         property int b\nend_header\n2 1 2\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n0 1\nand more\n"
    );
    let mesh = read_ply(&text);
    assert_eq!(figures_of(&mesh).area, 0.5);
    let expected = [
        ("material", 2, "line 5".to_owned()),
        ("empty", 4_000_000_000, "line 7".to_owned()),
        ("edge", 1, "line 14".to_owned()),
        ("byte", 9, "line 25".to_owned()),
    ];
    let found: Vec<_> = left_out(&mesh).into_iter().filter(|(kind, ..)| !kind.contains(' ')).collect();
    assert_eq!(found, expected);
}

#[test]
fn faces_may_stand_before_vertices() {
    let text = format!(
        "{HEADER}element face 1\nproperty list uchar int vertex_indices\nelement vertex 4\n\
         property float x\nproperty float y\nproperty float z\nend_header\n\
         4 0 1 2 3\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    );
    let mesh = read_ply(&text);
    assert_eq!((figures_of(&mesh).area, mesh.triangles.len(), mesh.n_polygons), (1.0, 2, 1));
}

#[test]
fn every_end_of_lines_gives_the_same_mesh() {
    let mesh = tetrahedron();
    let text = ply_text(&mesh);
    for end in ["\r\n", "\r"] {
        assert_eq!(read_ply(&text.replace('\n', end)), read_ply(&text));
    }
    // The first coordinate of a binary file begins with the byte of an end of line.
    let odd =
        Triangles { points: vec![[f64::from(f32::from_bits(0x3f80_000a)), 0.0, 0.0]; 1], ..mesh.clone() };
    let odd = Triangles { points: [odd.points, mesh.points[1..].to_vec()].concat(), ..mesh };
    let bytes = ply_binary(&odd, true);
    let start = bytes.windows(11).position(|window| window == b"end_header\n").unwrap() + 11;
    let mut header = String::from_utf8(bytes[..start].to_vec()).unwrap().replace('\n', "\r").into_bytes();
    header.extend(&bytes[start..]);
    assert_eq!(read_whole(MeshFormat::Ply, &header), read_whole(MeshFormat::Ply, &bytes));
}

#[test]
fn a_broken_header_is_refused_with_its_line() {
    for (text, expected) in [
        ("plywood", "line 1: the file ends within its header"),
        ("plywood\n", "line 1: a PLY file begins with a line \"ply\""),
        ("ply\nformat ascii 2.0\n", "line 2: \"format ascii 2.0\" is no line of a header of PLY 1.0"),
        ("ply\nformat text 1.0\n", "line 2: \"text\" is no format of PLY"),
        ("ply\nproperty int a\n", "line 2: a property stands before the first element"),
        ("ply\nelement vertex -1\n", "line 2: \"-1\" is no number of elements"),
        (
            "ply\nelement vertex 18446744073709551616\n",
            "line 2: \"18446744073709551616\" is no number of elements",
        ),
        ("ply\nelement vertex 1\nproperty long x\n", "line 3: \"long\" is no type of PLY"),
        ("ply\nelement vertex 1\nproperty x\n", "line 3: a property has a type and a name"),
        ("ply\nelement a 1\nelement a 1\n", "line 3: the element \"a\" stands twice"),
        ("ply\nend_header\n", "the file: its header states no format"),
        ("ply\nformat ascii 1.0\nend_header\n", "the file: there is no triangle in it"),
        (
            "ply\nformat ascii 1.0\nelement vertex 1\nend_header\n",
            "line 3: the element vertex has no property x",
        ),
    ] {
        assert_eq!(fault(MeshFormat::Ply, text.as_bytes()), expected, "{text}");
    }
}

#[test]
fn broken_values_are_refused_with_their_line() {
    let text = ply_text(&tetrahedron());
    for (from, to, expected) in [
        ("3 0 1 3", "3 0 1 4", "line 16: there is no vertex 4; the file has 4, counted from 0"),
        ("3 0 1 3", "3 0 1 -1", "line 16: there is no vertex -1; the file has 4, counted from 0"),
        ("3 0 1 3", "3 0 1 0.5", "line 16: there is no vertex 0.5; the file has 4, counted from 0"),
        ("3 0 1 3", "3 0 1 nan", "line 16: there is no vertex NaN; the file has 4, counted from 0"),
        ("3 0 1 3", "4 0 1 3", "line 16: the line has fewer values than its element"),
        ("3 0 1 3", "2 0 1 3", "line 16: the line has more values than the element face"),
        ("3 0 1 3", "-1 0 1 3", "line 16: a list cannot have -1 values"),
        ("3 0 1 3", "nan 0 1 3", "line 16: a list cannot have NaN values"),
        ("1 0 0\n", "1 0\n", "line 12: the line has fewer values than its element"),
        ("1 0 0\n", "1 0 nan\n", "line 12: NaN is no coordinate"),
        ("1 0 0\n", "1 0 x\n", "line 12: \"x\" stands in the place of a number"),
        ("vertex 4", "vertex 4000000000", "line 15: the line has more values than the element vertex"),
    ] {
        let broken = text.replacen(from, to, 1);
        assert_ne!(broken, text);
        assert_eq!(fault(MeshFormat::Ply, broken.as_bytes()), expected, "{from} -> {to}");
    }
}

#[test]
fn counts_that_are_not_there_are_refused() {
    for (from, to) in [("vertex 4", "vertex 4000000000"), ("face 4", "face 18446744073709551615")] {
        let bytes = ply_binary(&tetrahedron(), true);
        let at = bytes.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let broken = [&bytes[..at], to.as_bytes(), &bytes[at + from.len()..]].concat();
        let found = fault(MeshFormat::Ply, &broken);
        assert!(found.starts_with(&format!("byte {}: the file ends here", broken.len())), "{found}");
    }
}
