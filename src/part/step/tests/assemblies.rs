//! Placed copies of bodies.

use super::shapes::{check_box, square};
use super::writer::{Length, UP, Writer, read_text};
use crate::fault::{Place, Unreadable};

const X: [f64; 3] = [1.0, 0.0, 0.0];

/// A representation of an assembly with a placement of its own.
fn assembly(w: &mut Writer, items: &[usize]) -> usize {
    let items: Vec<String> = items.iter().map(|item| format!("#{item}")).collect();
    w.add(format!("SHAPE_REPRESENTATION('',({}),#9)", items.join(",")))
}

/// Places `part` in `whole`, from the frame of one to the frame of the other. Returns the relation.
fn relate(w: &mut Writer, [part, whole]: [usize; 2], [from, to]: [usize; 2]) -> usize {
    let by = w.add(format!("ITEM_DEFINED_TRANSFORMATION('','',#{from},#{to})"));
    w.add(format!(
        "(REPRESENTATION_RELATIONSHIP('','',#{part},#{whole})\
         REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION(#{by})SHAPE_REPRESENTATION_RELATIONSHIP())"
    ))
}

#[test]
fn a_part_occurs_once_for_each_place_in_an_assembly() {
    let mut w = Writer::new(Length::Millimetre);
    let face = square(&mut w, 2.0, 1.0);
    let solid = w.solid(&[face]);
    let shape = w.representation(&[solid]);
    let origin = w.upright([0.0; 3]);
    let part = assembly(&mut w, &[origin]);
    // The representation with the solid is the same shape as the one that is placed.
    w.add(format!("SHAPE_REPRESENTATION_RELATIONSHIP('','',#{part},#{shape})"));
    // One copy is moved by 10 along x, the other stands on its side: its z is the x of the assembly.
    let places = [w.upright([10.0, 0.0, 0.0]), w.frame([0.0, 20.0, 0.0], X, UP)];
    let whole = assembly(&mut w, &places);
    for place in places {
        relate(&mut w, [part, whole], [origin, place]);
    }
    let model = read_text(&w.text()).unwrap();
    assert_eq!(model.faces.len(), 2);
    assert_eq!(model.bodies.len(), 2);
    check_box(&model.faces[0], [10.0, 0.0, 1.0], [12.0, 2.0, 1.0]);
    // x of the part is up, and y of the part is against y: z x x.
    check_box(&model.faces[1], [1.0, 18.0, 0.0], [1.0, 20.0, 2.0]);
    assert!(model.faces.iter().all(|face| (face.area_mm2 - 4.0).abs() < 1e-9 && face.is_untrimmed));
}

#[test]
fn a_relation_in_the_other_order_is_turned_round_by_its_use() {
    let mut w = Writer::new(Length::Millimetre);
    let face = square(&mut w, 2.0, 1.0);
    let solid = w.solid(&[face]);
    let part = w.representation(&[solid]);
    let frames = [w.upright([0.0; 3]), w.upright([10.0, 0.0, 0.0])];
    let whole = assembly(&mut w, &frames);
    let relation = relate(&mut w, [whole, part], [frames[1], frames[0]]);
    let products = [0, 1].map(|_| w.add("PRODUCT_DEFINITION('','',$,$)"));
    for (product, shape) in [(products[0], whole), (products[1], part)] {
        let of = w.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{product})"));
        w.add(format!("SHAPE_DEFINITION_REPRESENTATION(#{of},#{shape})"));
    }
    let usage =
        w.add(format!("NEXT_ASSEMBLY_USAGE_OCCURRENCE('','','',#{},#{},$)", products[0], products[1]));
    let of = w.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{usage})"));
    w.add(format!("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION(#{relation},#{of})"));
    let model = read_text(&w.text()).unwrap();
    assert_eq!(model.faces.len(), 1);
    check_box(&model.faces[0], [10.0, 0.0, 1.0], [12.0, 2.0, 1.0]);
}

#[test]
fn a_part_in_another_file_is_left_out_at_each_place() {
    let mut w = Writer::new(Length::Millimetre);
    let places = [w.upright([0.0; 3]), w.upright([10.0, 0.0, 0.0])];
    let part = assembly(&mut w, &places[..1]);
    let whole = assembly(&mut w, &places);
    for place in places {
        relate(&mut w, [part, whole], [places[0], place]);
    }
    let model = read_text(&w.text()).unwrap();
    assert_eq!(model.faces, []);
    assert_eq!((model.left_out[0].kind.as_str(), model.left_out[0].count), ("SHAPE_REPRESENTATION", 2));
}

#[test]
fn mapped_items_scale_and_mirror() {
    let mut w = Writer::new(Length::Millimetre);
    let face = square(&mut w, 2.0, 1.0);
    let solid = w.solid(&[face]);
    let part = w.representation(&[solid]);
    let origin = w.upright([0.0; 3]);
    let map = w.add(format!("REPRESENTATION_MAP(#{origin},#{part})"));
    let (x, y, z) = (w.direction(X), w.direction([0.0, -1.0, 0.0]), w.direction(UP));
    let shift = w.point([0.0, 0.0, 5.0]);
    let target = w.add(format!("CARTESIAN_TRANSFORMATION_OPERATOR_3D('',#{x},#{y},#{shift},3.,#{z})"));
    let item = w.add(format!("MAPPED_ITEM('',#{map},#{target})"));
    assembly(&mut w, &[item]);
    let model = read_text(&w.text()).unwrap();
    assert_eq!(model.faces.len(), 1);
    let face = &model.faces[0];
    check_box(face, [0.0, -6.0, 8.0], [6.0, 0.0, 8.0]);
    assert!((face.area_mm2 - 36.0).abs() < 1e-9);
    // The material is still below: a mirror keeps the sides apart.
    assert!(face.normal([1.0, 1.0]).unwrap().z > 0.999);
    assert!(model.levels[0].is_up);
}

#[test]
fn assemblies_that_contain_themselves_are_refused() {
    for is_direct in [false, true] {
        let mut w = Writer::new(Length::Millimetre);
        let frame = w.upright([0.0; 3]);
        let (a, b) = (assembly(&mut w, &[frame]), assembly(&mut w, &[frame]));
        relate(&mut w, [a, b], [frame, frame]);
        relate(&mut w, if is_direct { [a, a] } else { [b, a] }, [frame, frame]);
        match read_text(&w.text()) {
            Err(Unreadable::Broken { place: Place::Entity(_), detail }) => {
                assert!(detail.contains("contains itself"), "{detail}");
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn doubling_assemblies_end_by_a_limit() {
    let mut w = Writer::new(Length::Millimetre);
    let frame = w.upright([0.0; 3]);
    let mut last = assembly(&mut w, &[frame]);
    for _ in 0..40 {
        let whole = assembly(&mut w, &[frame]);
        relate(&mut w, [last, whole], [frame, frame]);
        relate(&mut w, [last, whole], [frame, frame]);
        last = whole;
    }
    assert!(read_text(&w.text()).unwrap_err().to_string().contains("placed items"));
}

#[test]
fn a_solid_that_a_note_repeats_occurs_once() {
    let mut w = Writer::new(Length::Millimetre);
    let face = square(&mut w, 2.0, 1.0);
    let solid = w.solid(&[face]);
    let shape = w.representation(&[solid]);
    assembly(&mut w, &[solid, face]);
    let product = w.add("PRODUCT_DEFINITION('','',$,$)");
    let of = w.add(format!("PRODUCT_DEFINITION_SHAPE('','',#{product})"));
    w.add(format!("SHAPE_DEFINITION_REPRESENTATION(#{of},#{shape})"));
    let model = read_text(&w.text()).unwrap();
    assert_eq!((model.faces.len(), model.left_out.len()), (1, 0));
}

#[test]
fn sheets_and_voids_are_bodies() {
    let mut w = Writer::new(Length::Millimetre);
    let faces = [square(&mut w, 2.0, 1.0), square(&mut w, 1.0, 0.0), square(&mut w, 3.0, 4.0)];
    let open = w.add(format!("OPEN_SHELL('',(#{}))", faces[0]));
    let sheet = w.add(format!("SHELL_BASED_SURFACE_MODEL('',(#{open}))"));
    let outer = w.add(format!("CLOSED_SHELL('',(#{}))", faces[1]));
    let inner = w.add(format!("CLOSED_SHELL('',(#{}))", faces[2]));
    let void = w.add(format!("ORIENTED_CLOSED_SHELL('',*,#{inner},.F.)"));
    let solid = w.add(format!("BREP_WITH_VOIDS('',#{outer},(#{void}))"));
    w.representation(&[sheet, solid]);
    let model = read_text(&w.text()).unwrap();
    let bodies: Vec<(bool, usize)> =
        model.bodies.iter().map(|body| (body.is_solid, body.faces.len())).collect();
    assert_eq!(bodies, [(false, 1), (true, 2)]);
    // The shell of the void is turned inside out.
    let up: Vec<bool> = model.faces.iter().map(|face| face.normal([0.5, 0.5]).unwrap().z > 0.0).collect();
    assert_eq!(up, [true, true, false]);
}
