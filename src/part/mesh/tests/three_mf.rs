//! Models, places and archives of 3MF, and their faults.

use super::solids::Triangles;
use super::writing::{archive, model, model_of, three_mf, three_mf_with, xml};
use super::*;

fn read_model(model: &str) -> MeshFile {
    read_whole(MeshFormat::ThreeMf, &three_mf(model, true))
}

fn fault_of(model: &str) -> String {
    fault(MeshFormat::ThreeMf, &three_mf(model, true))
}

fn cube() -> Triangles {
    Triangles::cuboid([0.0; 3], [1.0; 3])
}

/// An object with the mesh of a cube.
fn cube_object(id: u32) -> String {
    format!("<object id=\"{id}\">{}</object>", xml(&cube()))
}

#[test]
fn the_unit_is_that_of_the_model_and_the_millimetre_by_default() {
    for (attribute, unit) in [
        ("", Unit::Millimetre),
        ("unit=\"micron\"", Unit::Micrometre),
        ("unit=\"millimeter\"", Unit::Millimetre),
        ("unit='centimeter'", Unit::Centimetre),
        ("unit=\"inch\"", Unit::Inch),
        ("unit=\"foot\"", Unit::Foot),
        ("unit=\"meter\"", Unit::Metre),
    ] {
        let model = model_of(attribute, &cube_object(1), "<item objectid=\"1\"/>");
        assert_eq!(read_model(&model).unit, Some(unit), "{attribute}");
    }
    let found = fault_of(&model_of("unit=\"mile\"", &cube_object(1), "<item objectid=\"1\"/>"));
    assert!(found.ends_with("of 3d/part.model: \"mile\" is no unit of 3MF"), "{found}");
}

#[test]
fn items_and_components_are_placed_one_within_the_other() {
    // The component is twice as long in x and moved; the item is turned by a right angle about z and moved.
    let resources = cube_object(1)
        + "<object id=\"2\"><components>\
           <component objectid=\"1\" transform=\"2 0 0 0 1 0 0 0 1 10 0 0\"/></components></object>";
    let items = "<item objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 100 7\"/>";
    let mesh = read_model(&model_of("", &resources, items));
    let found = figures_of(&mesh);
    assert_eq!(found.bounds, [[-1.0, 110.0, 7.0], [0.0, 112.0, 8.0]]);
    assert_eq!(found.solid.unwrap().volume, 2.0);
}

#[test]
fn a_mirrored_object_keeps_its_outside() {
    let items = "<item objectid=\"1\" transform=\"-1 0 0 0 1 0 0 0 1 0 0 0\"/>";
    let mesh = read_model(&model_of("", &cube_object(1), items));
    let found = figures_of(&mesh);
    assert_eq!(found.bounds, [[-1.0, 0.0, 0.0], [0.0, 1.0, 1.0]]);
    assert!(found.solid.unwrap().is_outward);
}

#[test]
fn objects_that_touch_keep_vertices_of_their_own() {
    let items = "<item objectid=\"1\"/><item objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 1 0 0\"/>";
    let mesh = read_model(&model_of("", &cube_object(1), items));
    let found = figures_of(&mesh);
    assert_eq!((mesh.vertices.len(), found.n_bodies), (16, 2));
    assert_eq!(found.solid.unwrap().volume, 2.0);
}

#[test]
fn objects_of_other_models_are_read() {
    let resources = "<object id=\"2\"><components>\
        <component objectid=\"7\" p:path=\"/3D/Objects/Cube.model\" transform=\"1 0 0 0 1 0 0 0 1 5 0 0\"/>\
        </components></object>";
    let main = model_of("requiredextensions=\"p\"", resources, "<item objectid=\"2\"/>");
    let other = model_of("", &cube_object(7), "");
    let file = three_mf_with(&main, &[("3D/Objects/cube.model", other.as_bytes()), ("Metadata/a.png", b"x")]);
    let mesh = read_whole(MeshFormat::ThreeMf, &file);
    assert_eq!(figures_of(&mesh).bounds, [[5.0, 0.0, 0.0], [6.0, 1.0, 1.0]]);
    assert_eq!(left_out(&mesh), [("part of the archive", 1, "the file".to_owned())]);
    let other = model_of("unit=\"inch\"", &cube_object(7), "");
    let found =
        fault(MeshFormat::ThreeMf, &three_mf_with(&main, &[("3D/Objects/cube.model", other.as_bytes())]));
    assert_eq!(found, "the file: 3d/objects/cube.model has another unit than 3d/part.model");
    assert_eq!(fault_of(&main), "the file: the archive has no part 3d/objects/cube.model");
}

#[test]
fn prefixes_of_the_core_specification_are_read() {
    let plain = model(&cube());
    let mut prefixed = plain.replace("xmlns=", "xmlns:c=").replace("</", "</c:");
    for name in [
        "model",
        "resources",
        "object",
        "mesh",
        "vertices",
        "vertex",
        "triangles",
        "triangle",
        "build",
        "item",
    ] {
        prefixed = prefixed.replace(&format!("<{name} "), &format!("<c:{name} "));
        prefixed = prefixed.replace(&format!("<{name}>"), &format!("<c:{name}>"));
    }
    assert_eq!(read_model(&prefixed), read_model(&plain));
    // Both ways in one file.
    let core = "http://schemas.microsoft.com/3dmanufacturing/core/2015/02";
    let both = plain.replace("<model ", &format!("<model xmlns:c=\"{core}\" "));
    let both = both.replace("<build>", "<c:build>").replace("</build>", "</c:build>");
    assert_eq!(read_model(&both), read_model(&plain));
}

#[test]
fn what_is_not_read_is_listed() {
    let resources = "<basematerials id=\"9\"><base name=\"a\"/></basematerials>".to_owned()
        + &cube_object(1)
        + &cube_object(2)
        + &cube_object(3).replace("<object ", "<object type=\"support\" ");
    let items = "<item objectid=\"1\"/><item objectid=\"3\"/>";
    let model =
        model_of("", &resources, items).replace("<resources>", "<metadata>text</metadata><resources>");
    let found = read_model(&model);
    assert_eq!(found.triangles.len(), 12);
    let found: Vec<_> =
        found.left_out.iter().map(|own| (own.kind.as_str(), own.reason.as_str(), own.count)).collect();
    let expected = [
        ("metadata", "elements of its name are not read", 1),
        ("basematerials", "elements of its name are not read", 1),
        ("object", "it supports a part that is printed", 1),
        ("object", "the build does not use it", 1),
    ];
    assert_eq!(found, expected);
}

#[test]
fn a_model_that_requires_an_unknown_extension_is_refused() {
    let attributes = "xmlns:b=\"http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02\" \
                      requiredextensions=\"p b\"";
    let found = fault_of(&model_of(attributes, &cube_object(1), "<item objectid=\"1\"/>"));
    let expected = "the model requires the extension \
                    http://schemas.microsoft.com/3dmanufacturing/beamlattice/2017/02, which is not read";
    assert!(found.ends_with(expected), "{found}");
    let found = fault_of(&model_of("requiredextensions=\"z\"", &cube_object(1), "<item objectid=\"1\"/>"));
    assert!(found.ends_with("requires the extension z, which is not read"), "{found}");
}

#[test]
fn objects_that_contain_themselves_are_refused() {
    for (a, b) in [(1, 1), (2, 1), (1, 2)] {
        let resources = format!(
            "<object id=\"1\"><components><component objectid=\"{a}\"/></components></object>\
             <object id=\"2\"><components><component objectid=\"{b}\"/></components></object>"
        );
        let found = fault_of(&model_of("", &resources, "<item objectid=\"1\"/>"));
        let is_circle = (a, b) != (2, 2);
        assert!(is_circle && found.ends_with("objects stand more than 64 deep within each other"), "{found}");
    }
}

#[test]
fn assemblies_that_double_again_and_again_are_refused() {
    for leaf in ["<object id=\"1\"><mesh/></object>".to_owned(), cube_object(1)] {
        let doubles = (2..60).map(|id| {
            let own = format!("<component objectid=\"{}\"/>", id - 1);
            format!("<object id=\"{id}\"><components>{own}{own}</components></object>")
        });
        let resources = leaf + &doubles.collect::<String>();
        let found = fault_of(&model_of("", &resources, "<item objectid=\"59\"/>"));
        let is_told =
            found.contains("more than 1000000 objects") || found.contains("more than 100000 triangles");
        assert!(is_told, "{found}");
    }
}

#[test]
fn vertices_that_no_triangle_uses_take_no_memory_in_copies() {
    let mut object = Triangles::tetrahedron([1.0; 3]);
    object.points.extend((0..1000).map(|k| [f64::from(k), 2.0, 2.0]));
    let resources = format!("<object id=\"1\">{}</object>", xml(&object));
    let items = "<item objectid=\"1\"/>".repeat(1000);
    let mesh = read_model(&model_of("", &resources, &items));
    assert_eq!((mesh.vertices.len(), mesh.triangles.len()), (4000, 4000));
    assert_eq!(left_out(&mesh)[0].1, 1_000_000);
}

#[test]
fn a_broken_model_is_refused_with_its_byte() {
    let whole = model(&cube());
    for (from, to, expected) in [
        ("v1=\"0\"", "v1=\"8\"", "a corner of a triangle is none of the 8 vertices before it"),
        ("v1=\"0\"", "v1=\"-1\"", "a corner of a triangle is none of the 8 vertices before it"),
        ("v1=\"0\"", "v1=\"4294967296\"", "a corner of a triangle is none of the 8 vertices before it"),
        ("v1=\"0\"", "", "a corner of a triangle is none of the 8 vertices before it"),
        ("x=\"0\"", "x=\"nan\"", "a vertex lacks a coordinate"),
        ("x=\"0\"", "x=\"1e10\"", "a vertex lacks a coordinate"),
        ("x=\"0\"", "x=\"&a;\"", "unrecognized entity"),
        ("x=\"0\"", "y=\"0\"", "a vertex lacks a coordinate"),
        ("objectid=\"1\"", "objectid=\"2\"", "there is no object 2"),
        ("objectid=\"1\"", "", "it names no object"),
        (
            "objectid=\"1\"",
            "objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 1 0 0\"",
            "a place has twelve numbers",
        ),
        ("objectid=\"1\"", "objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 0 0 0 0\"", "makes nothing flat"),
        ("objectid=\"1\"", "objectid=\"1\" transform=\"1 0 0 0 1 0 0 0 nan 0 0 0\"", "a place has twelve"),
        ("objectid=\"1\"", "objectid=\"1\" transform=\"1e9 0 0 0 1 0 0 0 1 5e8 0 0\"", "is no coordinate"),
        ("id=\"1\" type", "type", "an object has no number"),
        ("core/2015/02", "core/2011/01", "it is no model of the core specification of 3MF"),
        ("<resources>", "<!DOCTYPE a [<!ENTITY a \"b\">]><resources>", "3MF allows no document type"),
        ("<resources>", "<resource>", "expected"),
        ("</model>", "", "the text ends before its last element does"),
    ] {
        let broken = whole.replacen(from, to, 1);
        assert_ne!(broken, whole, "{from}");
        let found = fault_of(&broken);
        assert!(found.contains(expected) && found.starts_with("byte "), "{from} -> {to}: {found}");
        assert!(found.contains("of 3d/part.model: ") || found.contains("is no coordinate"), "{found}");
    }
}

#[test]
fn a_file_without_a_model_or_a_build_is_refused() {
    let found = fault(MeshFormat::ThreeMf, &archive(&[("a.txt", b"text")], true));
    assert_eq!(found, "the file: the ZIP archive holds no model of 3MF");
    let found = fault(MeshFormat::ThreeMf, b"PK\x03\x04 and no more");
    assert_eq!(found, "the file: the end of the ZIP archive is missing");
    let found = fault_of(&model_of("", &cube_object(1), ""));
    assert_eq!(found, "the file: the build of the model has no item");
    let usual = archive(&[("3D/3dmodel.model", model(&cube()).as_bytes())], true);
    assert_eq!(read_whole(MeshFormat::ThreeMf, &usual).triangles.len(), 12);
}

#[test]
fn a_small_file_does_not_become_large() {
    // A gigabyte of blanks is a megabyte when packed; 30 MB show the same.
    let text = model(&cube()).replace("<resources>", &(" ".repeat(30 << 20) + "<resources>"));
    let file = three_mf(&text, true);
    assert!(file.len() < 1 << 17, "{}", file.len());
    let found = fault_of(&text);
    assert!(found.contains("bytes when unpacked; at most"), "{found}");
    // The size that the archive states is not believed either: the directory says 1000 bytes.
    let mut file = file;
    let at = file.windows(4).rposition(|window| window == b"PK\x01\x02").unwrap();
    file[at + 24..at + 28].copy_from_slice(&1000_u32.to_le_bytes());
    let found = fault(MeshFormat::ThreeMf, &file);
    assert!(found.ends_with("3D/part.model is damaged"), "{found}");
}

#[test]
fn a_damaged_archive_is_refused() {
    let text = model(&cube());
    let whole = three_mf(&text, true);
    let entry = whole.windows(4).rposition(|window| window == b"PK\x01\x02").unwrap();
    let local = whole.windows(4).rposition(|window| window == b"PK\x03\x04").unwrap();
    for (at, value, expected) in [
        (entry + 8, 1, "is encrypted"),
        (entry + 10, 12, "is packed by the method 12; only deflate is read"),
        (entry + 16, 0, "its sum differs from the one that the archive states"),
        (entry + 23, 1, "is longer than the file"),
        (entry + 45, 1, "points to byte"),
        (entry, 0, "no record begins here"),
        (local, 0, "no record begins here"),
        (whole.len() - 3, 1, "points to byte"),
        (whole.len() - 12, 3, "no record begins here"),
    ] {
        let mut broken = whole.clone();
        assert_ne!(broken[at], value);
        broken[at] = value;
        let found = fault(MeshFormat::ThreeMf, &broken);
        assert!(found.contains(expected), "{at}: {found}");
    }
}

#[test]
fn an_archive_with_64_bit_sizes_is_read() {
    let whole = three_mf(&model(&cube()), true);
    let end = whole.len() - 22;
    let start = u64::from(u32::from_le_bytes(whole[end + 16..end + 20].try_into().unwrap()));
    let mut wide = whole[..end].to_vec();
    let end_64 = wide.len() as u64;
    wide.extend(b"PK\x06\x06");
    wide.extend(44_u64.to_le_bytes());
    wide.extend([0; 12]);
    wide.extend(2_u64.to_le_bytes());
    wide.extend(2_u64.to_le_bytes());
    wide.extend((end_64 - start).to_le_bytes());
    wide.extend(start.to_le_bytes());
    wide.extend(b"PK\x06\x07\0\0\0\0");
    wide.extend(end_64.to_le_bytes());
    wide.extend([1, 0, 0, 0]);
    wide.extend(b"PK\x05\x06\0\0\0\0");
    wide.extend([255; 12]);
    wide.extend([0; 2]);
    assert_eq!(read_whole(MeshFormat::ThreeMf, &wide), read_whole(MeshFormat::ThreeMf, &whole));
}
