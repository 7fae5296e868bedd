//! Writes triangles in each format.

use flate2::{Compress, Compression, Crc, FlushCompress};

use super::super::MeshFormat;
use super::solids::Triangles;

/// Every way in which the tests write a mesh, with its format.
pub fn all(mesh: &Triangles) -> Vec<(&'static str, MeshFormat, Vec<u8>)> {
    vec![
        ("text STL", MeshFormat::Stl, stl_text(mesh).into_bytes()),
        ("binary STL", MeshFormat::Stl, stl_binary(mesh, "solid made by a program")),
        ("OBJ", MeshFormat::Obj, obj(mesh).into_bytes()),
        ("text PLY", MeshFormat::Ply, ply_text(mesh).into_bytes()),
        ("little-endian PLY", MeshFormat::Ply, ply_binary(mesh, true)),
        ("big-endian PLY", MeshFormat::Ply, ply_binary(mesh, false)),
        ("3MF", MeshFormat::ThreeMf, three_mf(&model(mesh), true)),
        ("stored 3MF", MeshFormat::ThreeMf, three_mf(&model(mesh), false)),
    ]
}

pub fn stl_text(mesh: &Triangles) -> String {
    let mut text = String::from("solid a part\n");
    for corners in &mesh.triangles {
        text += "facet normal 0 0 0\nouter loop\n";
        for [x, y, z] in corners.map(|corner| mesh.points[corner]) {
            text += &format!("vertex {x} {y} {z}\n");
        }
        text += "endloop\nendfacet\n";
    }
    text + "endsolid a part\n"
}

pub fn stl_binary(mesh: &Triangles, header: &str) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.resize(80, b' ');
    bytes.extend((mesh.triangles.len() as u32).to_le_bytes());
    for corners in &mesh.triangles {
        bytes.extend([0; 12]);
        for corner in corners {
            mesh.points[*corner].iter().for_each(|x| bytes.extend((*x as f32).to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

pub fn obj(mesh: &Triangles) -> String {
    let points = mesh.points.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n"));
    let faces = mesh.triangles.iter().map(|[a, b, c]| format!("f {} {} {}\n", a + 1, b + 1, c + 1));
    points.chain(faces).collect()
}

fn ply_header(mesh: &Triangles, format: &str, number: &str) -> String {
    let Triangles { points, triangles } = mesh;
    format!(
        "ply\nformat {format} 1.0\ncomment of a test\nelement vertex {}\nproperty {number} x\n\
         property {number} y\nproperty {number} z\nelement face {}\n\
         property list uchar int vertex_indices\nend_header\n",
        points.len(),
        triangles.len()
    )
}

pub fn ply_text(mesh: &Triangles) -> String {
    let points = mesh.points.iter().map(|[x, y, z]| format!("{x} {y} {z}\n"));
    let faces = mesh.triangles.iter().map(|[a, b, c]| format!("3 {a} {b} {c}\n"));
    ply_header(mesh, "ascii", "double") + &points.chain(faces).collect::<String>()
}

pub fn ply_binary(mesh: &Triangles, is_little: bool) -> Vec<u8> {
    let format = if is_little { "binary_little_endian" } else { "binary_big_endian" };
    let mut bytes = ply_header(mesh, format, "float").into_bytes();
    for x in mesh.points.iter().flatten().map(|x| *x as f32) {
        bytes.extend(if is_little { x.to_le_bytes() } else { x.to_be_bytes() });
    }
    for corners in &mesh.triangles {
        bytes.push(3);
        for corner in corners.map(|corner| corner as i32) {
            bytes.extend(if is_little { corner.to_le_bytes() } else { corner.to_be_bytes() });
        }
    }
    bytes
}

/// The mesh of an object, as 3MF writes it.
pub fn xml(mesh: &Triangles) -> String {
    let points = mesh.points.iter().map(|[x, y, z]| format!("<vertex x=\"{x}\" y=\"{y}\" z=\"{z}\"/>"));
    let faces =
        mesh.triangles.iter().map(|[a, b, c]| format!("<triangle v1=\"{a}\" v2=\"{b}\" v3=\"{c}\" />"));
    format!(
        "<mesh><vertices>{}</vertices><triangles>{}</triangles></mesh>",
        points.collect::<String>(),
        faces.collect::<String>()
    )
}

/// A model with these resources and items.
pub fn model_of(attributes: &str, resources: &str, items: &str) -> String {
    format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<model {attributes} \
         xmlns=\"http://schemas.microsoft.com/3dmanufacturing/core/2015/02\" \
         xmlns:p=\"http://schemas.microsoft.com/3dmanufacturing/production/2015/06\">\
         <resources>{resources}</resources><build>{items}</build></model>"
    )
}

/// A model of one object.
pub fn model(mesh: &Triangles) -> String {
    let object = format!("<object id=\"1\" type=\"model\">{}</object>", xml(mesh));
    model_of("unit=\"millimeter\"", &object, "<item objectid=\"1\"/>")
}

const RELATIONSHIPS: &str = "<Relationships xmlns=\"http://schemas.openxmlformats.org/package/2006/relationships\">\
    <Relationship Target=\"/3D/part.model\" Id=\"rel0\" \
    Type=\"http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel\"/></Relationships>";

/// A file with a model.
pub fn three_mf(model: &str, is_packed: bool) -> Vec<u8> {
    archive(&[("_rels/.rels", RELATIONSHIPS.as_bytes()), ("3D/part.model", model.as_bytes())], is_packed)
}

/// A file with a model, and further parts.
pub fn three_mf_with(model: &str, others: &[(&str, &[u8])]) -> Vec<u8> {
    let mut parts = vec![("_rels/.rels", RELATIONSHIPS.as_bytes()), ("3D/part.model", model.as_bytes())];
    parts.extend(others);
    archive(&parts, true)
}

/// A ZIP archive.
pub fn archive(parts: &[(&str, &[u8])], is_packed: bool) -> Vec<u8> {
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (name, part) in parts {
        let mut sum = Crc::new();
        sum.update(part);
        let packed = if is_packed { deflate(part) } else { part.to_vec() };
        let method: u16 = if is_packed { 8 } else { 0 };
        let mut record = vec![20, 0, 0, 0];
        record.extend(method.to_le_bytes());
        record.extend([0; 4]);
        record.extend(sum.sum().to_le_bytes());
        record.extend((packed.len() as u32).to_le_bytes());
        record.extend((part.len() as u32).to_le_bytes());
        record.extend((name.len() as u16).to_le_bytes());
        record.extend([0; 2]);
        directory.extend(b"PK\x01\x02\x14\0");
        directory.extend(&record);
        directory.extend([0; 10]);
        directory.extend((bytes.len() as u32).to_le_bytes());
        directory.extend(name.as_bytes());
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&record);
        bytes.extend(name.as_bytes());
        bytes.extend(packed);
    }
    let start = bytes.len() as u32;
    bytes.extend(&directory);
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    bytes.extend((parts.len() as u16).to_le_bytes());
    bytes.extend((parts.len() as u16).to_le_bytes());
    bytes.extend((directory.len() as u32).to_le_bytes());
    bytes.extend(start.to_le_bytes());
    bytes.extend([0; 2]);
    bytes
}

fn deflate(bytes: &[u8]) -> Vec<u8> {
    let mut compress = Compress::new(Compression::best(), false);
    let mut packed = Vec::with_capacity(bytes.len() + 1000);
    compress.compress_vec(bytes, &mut packed, FlushCompress::Finish).unwrap();
    assert_eq!(compress.total_in(), bytes.len() as u64);
    packed
}
