//! Blocks, where they are placed, and layers.

use std::f64::consts::PI;

use super::*;

fn block(name: &str, base: [f64; 2], entities: &str) -> String {
    format!("0 BLOCK\n8 0\n2 {name}\n70 0\n10 {}\n20 {}\n{entities}0 ENDBLK\n8 0\n", base[0], base[1])
}

fn insert(name: &str, at: [f64; 2], rest: &str) -> String {
    format!("0 INSERT\n8 parts\n2 {name}\n10 {}\n20 {}\n{rest}", at[0], at[1])
}

/// An L with sides of 4 and 2, whose area is 5 and whose corner is at the origin.
fn ell() -> String {
    let corners = [[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
    polygon(&corners.map(|[x, y]| [x, y, 0.0]))
}

fn corners(outline: &Loop) -> Vec<[f64; 2]> {
    outline.vertices.iter().map(|v| [v[0], v[1]]).collect()
}

#[test]
fn a_block_moves_from_its_base_and_turns_by_quarters_exactly() {
    let blocks = block("L", [0.1, 0.2], &ell());
    let moved = drawing(&file_with("", &blocks, &insert("l", [0.1, 0.2], "")));
    assert_eq!(only(&moved).vertices, only(&drawing(&file(&ell()))).vertices);
    let blocks = block("L", [0.0, 0.0], &ell());
    let turned = drawing(&file_with("", &blocks, &insert("L", [10.0, 0.0], "50 90\n")));
    assert_eq!(corners(only(&turned))[1], [10.0, 4.0]);
    assert!(corners(only(&turned)).contains(&[8.0, 1.0]));
}

#[test]
fn mirrored_nested_blocks_keep_areas_and_arcs() {
    // An arc from (0, -1) to (0, 1) to the right, closed by a line: half a disc.
    let half = arc([0.0, 0.0], 1.0, 270.0, 90.0) + &line([0.0, 1.0], [0.0, -1.0]);
    let blocks = block("HALF", [0.0, 0.0], &half)
        + &block("PAIR", [0.0, 0.0], &insert("HALF", [5.0, 0.0], "41 -2\n42 2\n50 180\n"));
    let text = file_with("", &blocks, &insert("PAIR", [0.0, 7.0], "41 3\n42 -3\n50 90\n"));
    let drawing = drawing(&text);
    let outline = only(&drawing);
    assert_near(outline.area_mm2, 36.0 * PI / 2.0);
    assert_near(outline.length_mm, 6.0 * (PI + 2.0));
    // (1, 0) of HALF goes to (7, 0), then to (21, 0), then to (0, 28).
    let middles = bulge_middles(outline);
    assert!(middles.iter().any(|m| (m[0]).abs() < 1e-12 && (m[1] - 28.0).abs() < 1e-12), "{middles:?}");
    assert_eq!((drawing.deviation_max_mm, drawing.layers[0].name.as_str()), (0.0, "parts"));
}

/// The middle of each element.
fn bulge_middles(outline: &Loop) -> Vec<[f64; 2]> {
    let v = &outline.vertices;
    (0..v.len())
        .map(|k| {
            let (a, b) = (v[k], v[(k + 1) % v.len()]);
            // An arc with a bulge above zero lies to the right of its chord.
            let [x, y] = [0.5 * (b[0] - a[0]), 0.5 * (b[1] - a[1])];
            [a[0] + x + a[2] * y, a[1] + y - a[2] * x]
        })
        .collect()
}

#[test]
fn arcs_under_an_uneven_scale_become_parts_of_ellipses() {
    let rounded = polygon(&[[-1.0, -1.0, 0.0], [1.0, -1.0, 1.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 1.0]]);
    let shapes = circle([0.0, 0.0], 1.0) + &rounded;
    let text =
        file_with("", &block("B", [0.0, 0.0], &shapes), &insert("B", [3.0, 3.0], "41 10\n42 5\n50 30\n"));
    let drawing = drawing(&text);
    let [outer, inner] = &drawing.loops[..] else { panic!("{drawing:?}") };
    assert!(drawing.deviation_max_mm > 0.0 && drawing.deviation_max_mm <= 0.001);
    let slack = drawing.deviation_max_mm * outer.length_mm;
    assert!((outer.area_mm2 - 50.0 * (4.0 + PI)).abs() < slack, "{outer:?}");
    assert!((inner.area_mm2 - 50.0 * PI).abs() < slack && inner.parent == Some(0));
}

#[test]
fn rows_and_columns_turn_with_the_block() {
    let blocks = block("HOLE", [0.0, 0.0], &circle([0.0, 0.0], 1.0));
    let rest = "50 90\n70 3\n71 2\n44 10\n45 20\n";
    let drawing = drawing(&file_with("", &blocks, &insert("HOLE", [0.0, 0.0], rest)));
    let centers: Vec<[f64; 2]> = drawing
        .loops
        .iter()
        .map(|one| [0, 1].map(|k| 0.5 * (one.vertices[0][k] + one.vertices[1][k])))
        .collect();
    let expected = [[0.0, 0.0], [0.0, 10.0], [0.0, 20.0], [-20.0, 0.0], [-20.0, 10.0], [-20.0, 20.0]];
    assert_eq!(centers, expected);
}

#[test]
fn a_block_seen_from_below_is_mirrored_at_the_y_axis() {
    let blocks = block("L", [0.0, 0.0], &ell());
    let text = file_with("", &blocks, &insert("L", [10.0, 5.0], "210 0\n220 0\n230 -1\n"));
    assert!(corners(only(&drawing(&text))).contains(&[-14.0, 5.0]));
}

#[test]
fn blocks_that_hold_themselves_are_refused_and_absent_ones_left_out() {
    let blocks = block("A", [0.0, 0.0], &insert("B", [0.0, 0.0], ""))
        + &block("B", [0.0, 0.0], &insert("A", [0.0, 0.0], ""));
    let fault = fault(&file_with("", &blocks, &insert("A", [0.0, 0.0], "")));
    assert!(fault.ends_with("the block \"A\" holds itself") && fault.starts_with("line "), "{fault}");
    let external = "0 BLOCK\n2 X\n70 4\n10 0\n20 0\n0 ENDBLK\n";
    let inserts = [insert("NONE", [0.0; 2], ""), insert("X", [0.0; 2], ""), insert("X", [0.0; 2], "41 0\n")];
    let drawing = drawing(&file_with("", external, &inserts.concat()));
    let expected = [
        ("INSERT", "the file has no block of its name", 1),
        ("INSERT", "its block is in another file", 1),
        ("INSERT", "its scale is zero", 1),
    ];
    assert_eq!(left_out(&drawing), expected);
}

#[test]
fn deep_and_many_blocks_are_refused() {
    let chain = |n: usize| -> String {
        let inner =
            (1..n).map(|k| block(&format!("B{k}"), [0.0; 2], &insert(&format!("B{}", k + 1), [0.0; 2], "")));
        inner.collect::<String>() + &block(&format!("B{n}"), [0.0; 2], &circle([0.0; 2], 1.0))
    };
    let sixteen = file_with("", &chain(16), &insert("B1", [0.0; 2], ""));
    assert_near(only(&drawing(&sixteen)).area_mm2, PI);
    let seventeen = fault(&file_with("", &chain(17), &insert("B1", [0.0; 2], "")));
    assert!(seventeen.ends_with("blocks lie more than 16 deep in each other"), "{seventeen}");
    let empty = block("E", [0.0; 2], "");
    let many = fault(&file_with("", &empty, &insert("E", [0.0; 2], "70 32000\n71 32000\n")));
    assert!(many.ends_with("there are more than 800000 copies of blocks"), "{many}");
    let holes = block("H", [0.0; 2], &circle([0.0; 2], 1.0));
    let many = fault(&file_with("", &holes, &insert("H", [0.0; 2], "70 32000\n71 32000\n")));
    assert!(many.ends_with("there are more than 200000 curves"), "{many}");
}

fn on_layer(name: &str, shape: &str) -> String {
    shape.replace("8 0\n", &format!("8 {name}\n"))
}

#[test]
fn layers_are_chosen_without_regard_to_capital_letters() {
    let shapes = on_layer("Außen", &circle([0.0; 2], 9.0)) + &on_layer("Innen", &circle([0.0; 2], 3.0));
    let layers = Some(vec!["AUSSEN".to_owned(), "innen".to_owned()]);
    let chosen =
        |layers| read(file(&shapes).as_bytes(), &DxfOptions { layers, ..options() }, &Budget::unlimited());
    assert_eq!(chosen(layers).unwrap().loops.len(), 2);
    let outer = chosen(Some(vec!["außen".to_owned()])).unwrap();
    assert_eq!(only(&outer).layer, "Außen");
    assert_eq!(outer.layers.iter().map(|layer| layer.n_curves).collect::<Vec<_>>(), [1, 1]);
    assert_eq!(left_out(&outer), [("CIRCLE", "its layer is not among the layers that are asked for", 1)]);
    let wrong = chosen(Some(vec!["aussen2".to_owned()])).unwrap_err().to_string();
    let expected = "the file: no curve is on the layer \"aussen2\"; curves are on \"Außen\", \"Innen\"";
    assert_eq!(wrong, expected);
}

#[test]
fn hidden_layers_are_left_out_unless_they_are_asked_for() {
    let tables = lines("0 LAYER\n2 COLD\n70 1\n62 7\n0 LAYER\n2 DARK\n70 0\n62 -7\n");
    let head = format!("0\nSECTION\n2\nTABLES\n0\nTABLE\n2\nLAYER\n{tables}0\nENDTAB\n0\nENDSEC\n");
    let blocks = block("B", [0.0; 2], &(circle([0.0; 2], 1.0) + &on_layer("own", &circle([0.0; 2], 2.0))));
    let shapes = on_layer("cold", &circle([9.0, 0.0], 1.0))
        + &on_layer("dark", &circle([9.0, 0.0], 2.0))
        + &insert("B", [0.0; 2], "").replace("parts", "cold")
        + &insert("B", [0.0; 2], "").replace("parts", "dark");
    let text = head + &file_with("", &blocks, &shapes);
    let shown = drawing(&text);
    assert_eq!((only(&shown).layer.as_str(), only(&shown).vertices[0][0]), ("own", 2.0));
    let expected = [
        ("CIRCLE", "its layer is frozen", 1),
        ("CIRCLE", "its layer is off", 2),
        ("INSERT", "its layer is frozen", 1),
    ];
    assert_eq!(left_out(&shown), expected);
    let options = DxfOptions { layers: Some(vec!["Cold".to_owned()]), ..options() };
    let cold = read(text.as_bytes(), &options, &Budget::unlimited()).unwrap();
    // The circle on the layer, and the one of the block that is put on it.
    let firsts: Vec<f64> = cold.loops.iter().map(|outline| outline.vertices[0][0]).collect();
    assert_eq!(firsts, [10.0, 1.0]);
}

#[test]
fn a_block_on_a_frozen_layer_is_read_if_the_layer_is_asked_for() {
    let layers = "0\nSECTION\n2\nTABLES\n0\nLAYER\n2\nparts\n70\n1\n62\n7\n0\nENDSEC\n";
    let blocks = block("L", [0.0, 0.0], &ell());
    let text = layers.to_owned()
        + &file_with("", &blocks, &(insert("L", [0.0, 0.0], "") + &circle([9.0, 9.0], 1.0)));
    let asked = DxfOptions { layers: Some(vec!["Parts".to_owned()]), ..options() };
    let part = read(text.as_bytes(), &asked, &Budget::unlimited()).unwrap();
    assert_near(only(&part).area_mm2, 5.0);
    assert_eq!(left_out(&drawing(&text)), [("INSERT", "its layer is frozen", 1)]);
}
