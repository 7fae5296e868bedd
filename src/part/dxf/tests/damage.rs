//! Files that are broken: each is an error with its place, or a drawing, and no panic.

use proptest::prelude::*;

use super::*;

/// One entity of each kind that is read.
fn sample() -> String {
    let blocks = "0 BLOCK\n2 B\n70 0\n10 1\n20 1\n".to_owned() + &circle([1.0, 1.0], 0.5) + "0 ENDBLK\n";
    let spline = "0 SPLINE\n8 0\n70 8\n71 2\n72 6\n73 3\n74 0\n40 0\n40 0\n40 0\n40 1\n40 1\n40 1\n"
        .to_owned()
        + "41 1\n41 0.5\n41 1\n10 0\n20 20\n30 0\n10 5\n20 30\n30 0\n10 10\n20 20\n30 0\n";
    let old = "0 POLYLINE\n66 1\n70 1\n0 VERTEX\n10 1\n20 1\n42 1\n0 VERTEX\n10 2\n20 2\n0 SEQEND\n";
    let ellipse = "0 ELLIPSE\n10 0\n20 0\n30 0\n11 3\n21 4\n31 0\n40 0.3\n41 0\n42 4\n";
    let shapes = polygon(&[[0.0, 0.0, 0.25], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]])
        + &arc([20.0, 0.0], 2.5, 12.5, 170.25)
        + "0 INSERT\n8 0\n2 B\n10 4\n20 1\n41 2\n42 -3\n50 30\n70 2\n71 3\n44 1.5\n45 2\n"
        + &spline
        + old
        + ellipse
        + &line([0.0, 20.0], [10.0, 20.0])
        + "0 TEXT\n8 0\n10 0\n20 0\n40 3\n1 words\n";
    file_with("9 $INSUNITS\n70 4\n", &blocks, &shapes)
}

/// Limits that keep a damaged file short.
fn small() -> DxfOptions {
    DxfOptions { curve_limit: 2000, vertex_limit: 500, ..options() }
}

#[test]
fn a_file_that_breaks_off_is_an_error_with_its_line() {
    let text = sample();
    for end in (0..text.len()).step_by(7) {
        let result = read(&text.as_bytes()[..end], &small(), &Budget::unlimited());
        match result {
            Err(Unreadable::Broken { place, .. }) => {
                assert!(matches!(place, Place::Line(_) | Place::File), "{place}");
            }
            // Only the end of the file is absent.
            Ok(drawing) => assert!(drawing.left_out.iter().any(|one| one.kind == "EOF"), "{end}"),
            Err(other) => panic!("{other}"),
        }
    }
}

#[test]
fn faults_name_their_lines() {
    let one = |entity: &str| fault(&file(entity));
    // The header and the blocks take 12 lines, the head of the entities 4.
    assert_eq!(one("0 CIRCLE\n10 x\n"), "line 20: group 10 is \"x\" instead of a number");
    assert_eq!(one("0 CIRCLE\n10 nan\n20 0\n"), "line 20: group 10 is \"nan\" instead of a number");
    assert_eq!(one("0 CIRCLE\n10 1e999\n20 0\n"), "line 20: group 10 is \"1e999\" instead of a number");
    assert_eq!(one("0 CIRCLE\n10 1\n20 0\n"), "line 18: this CIRCLE lacks the group 40");
    assert_eq!(one("0 LINE\n10 1\n20 0\n67 a\n"), "line 18: this LINE lacks the group 11");
    assert_eq!(one("0 LWPOLYLINE\n90 3\n10 0\n20 0\n"), "line 18: a polyline of 3 vertices has only 1");
    assert_eq!(one("0 LWPOLYLINE\n90 1\n10 0\n10 1\n20 0\n"), "line 22: a vertex has no y");
    assert_eq!(one("0 LWPOLYLINE\n42 1\n"), "line 20: the group 42 has no vertex before it");
    assert_eq!(one("0 SPLINE\n71 3\n72 99999999\n"), "line 18: a spline of 99999999 knots has only 0");
    assert_eq!(one("0 POLYLINE\n0 LINE\n"), "line 20: SEQEND is expected");
    assert_eq!(one("0 ENDBLK\n"), "line 18: ENDSEC is expected");
    assert_eq!(one("x 1\n"), "line 17: \"x\" stands where a group code is expected");
    assert_eq!(
        one("0 INSERT\n2 B\n10 0\n20 0\n70 99999999999\n"),
        "line 18: 99999999999 copies of a block are too many"
    );
    assert_eq!(fault(""), "the file: the file has no section ENTITIES");
    assert_eq!(fault("0\nEOF\n"), "the file: the file has no section ENTITIES");
    assert_eq!(fault("solid cube\n"), "line 1: \"solid cube\" stands where a group code is expected");
    assert_eq!(fault("1\nx\n"), "line 2: this is no DXF file: it does not begin with a section");
    let without_end = "0\nSECTION\n2\nENTITIES\n0\nLINE\n";
    assert_eq!(fault(without_end), "line 7: the file ends within a section");
    assert_eq!(fault("0\nSECTION\n2\nENTITIES\n0"), "line 6: the file ends after the group code 0");
    let limits =
        [DxfOptions { gap_mm: -1.0, ..options() }, DxfOptions { tolerance_mm: f64::NAN, ..options() }];
    for limits in limits {
        assert!(read(sample().as_bytes(), &limits, &Budget::unlimited()).is_err());
    }
}

#[test]
fn limits_of_curves_and_vertices_hold() {
    let circles: String = (0..20).map(|k| circle([f64::from(k), 0.0], 0.1)).collect();
    let read_with = |curve_limit: usize, vertex_limit: usize| {
        let options = DxfOptions { curve_limit, vertex_limit, ..options() };
        read(file(&circles).as_bytes(), &options, &Budget::unlimited()).map_err(|fault| fault.to_string())
    };
    assert_eq!(read_with(20, 40).unwrap().loops.len(), 20);
    assert!(read_with(19, 40).unwrap_err().ends_with("there are more than 19 curves"));
    assert!(read_with(20, 39).unwrap_err().ends_with("there are more than 39 vertices"));
    let ellipse = "0 ELLIPSE\n10 0\n20 0\n11 1e8\n21 0\n40 0.3\n";
    let many = read(file(ellipse).as_bytes(), &small(), &Budget::unlimited()).unwrap_err().to_string();
    assert_eq!(many, "line 18: the curves need more than 500 arcs; use a larger tolerance");
}

#[test]
fn splines_that_are_no_curves_are_left_out() {
    let spline = |head: &str, knots: &[f64]| {
        let knots: String = knots.iter().map(|knot| format!("40 {knot}\n")).collect();
        format!("0 SPLINE\n{head}{knots}10 0\n20 0\n10 5\n20 30\n10 9\n20 0\n")
    };
    let shapes = [
        spline("71 2\n", &[0.0, 0.0, 0.0, 1.0, 1.0]),
        spline("71 2\n", &[1.0; 6]),
        spline("71 2\n", &[2.0, 2.0, 2.0, 1.0, 1.0, 1.0]),
        spline("71 0\n", &[0.0, 1.0, 2.0, 3.0]),
        spline("71 2\n41 0\n41 1\n41 1\n", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
        spline("71 -2\n", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
        spline("71 9\n", &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0]),
        "0 SPLINE\n71 3\n".to_owned(),
    ];
    let drawing = drawing(&file(&shapes.concat()));
    let expected = [
        ("SPLINE", "its degree, knots, points and weights make no curve", 6),
        ("SPLINE", "splines of a degree above 7 are not supported", 1),
        ("SPLINE", "it has too few points", 1),
    ];
    assert_eq!(left_out(&drawing), expected);
}

#[test]
fn a_passed_deadline_ends_reading() {
    let lines: String = (0..300).map(|k| line([f64::from(k), 0.0], [0.0, 1.0])).collect();
    let budget = Budget::unlimited();
    budget.cancel();
    assert!(matches!(read(file(&lines).as_bytes(), &options(), &budget), Err(Unreadable::Stopped(_))));
}

#[test]
fn many_ends_in_one_place_and_many_kinds_are_told_in_short() {
    let rays: String = (0..2000).map(|k| line([0.0, 0.0], [f64::from(k), 1.0])).collect();
    let kinds: String = (0..2000).map(|k| format!("0 KIND{k}\n")).collect();
    let drawing = drawing(&file(&(rays + &kinds)));
    assert_eq!((drawing.open.len(), drawing.branches.len()), (2000, 1));
    assert_eq!(drawing.left_out.len(), 201);
    let dense: String = (0..2000).map(|k| line([1e-7 * f64::from(k), 0.0], [f64::from(k), 5.0])).collect();
    let options = DxfOptions { gap_mm: 10.0, ..options() };
    let dense = read(file(&dense).as_bytes(), &options, &Budget::unlimited()).unwrap_err().to_string();
    assert!(dense.ends_with("pairs of ends lie within the gap of 10 mm; use a smaller gap"), "{dense}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    #[test]
    fn noise_does_not_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..8),
        dropped in prop::option::of(any::<prop::sample::Index>()),
    ) {
        let mut bytes = sample().into_bytes();
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        if let Some(at) = dropped {
            bytes.remove(at.index(bytes.len()));
        }
        let _ = read(&bytes, &small(), &Budget::unlimited());
    }

    #[test]
    fn numbers_of_any_size_do_not_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), prop::sample::select(vec![
            "0", "-1", "1e300", "-1e300", "1e-300", "1e9", "255", "65536", "-0", "1e17", "3.5", "16", "2",
        ])), 1..6),
    ) {
        let text = sample();
        let mut lines: Vec<&str> = text.lines().collect();
        for (at, value) in changes {
            // Values are on every second line.
            let at = 2 * at.index(lines.len() / 2) + 1;
            if lines[at].parse::<f64>().is_ok() {
                lines[at] = value;
            }
        }
        if let Ok(drawing) = read(lines.join("\n").as_bytes(), &small(), &Budget::unlimited()) {
            for one in &drawing.loops {
                prop_assert!(one.area_mm2 > 0.0 && one.area_mm2.is_finite() && one.length_mm.is_finite());
            }
        }
    }
}

#[test]
fn entities_that_are_left_out_alike_are_counted_and_take_no_room() {
    let options = DxfOptions { curve_limit: 2, ..options() };
    let text = |entities: &str| file(&(entities.to_owned() + &circle([0.0, 0.0], 1.0)));
    let many = read(text(&"0 A\n0 B\n".repeat(500)).as_bytes(), &options, &Budget::unlimited()).unwrap();
    let reason = "entities of this kind are not supported";
    assert_eq!(left_out(&many), [("A", reason, 500), ("B", reason, 500)]);
    let on_paper = circle([0.0, 0.0], 1.0) + "67 1\n";
    let many = read(text(&on_paper.repeat(500)).as_bytes(), &options, &Budget::unlimited()).unwrap();
    assert_eq!(left_out(&many), [("CIRCLE", "it is drawn in paper space", 500)]);
}

#[test]
fn more_entities_than_four_a_curve_are_refused_with_their_line() {
    let options = DxfOptions { curve_limit: 2, ..options() };
    let block = "0 BLOCK\n2 B\n".to_owned() + &circle([0.0, 0.0], 1.0).repeat(9) + "0 ENDBLK\n";
    let text = file_with("", &block, &circle([0.0, 0.0], 1.0));
    let fault = read(text.as_bytes(), &options, &Budget::unlimited()).unwrap_err().to_string();
    assert_eq!(fault, "line 96: there are more than 8 entities");
}

#[test]
fn a_spline_of_more_points_than_vertices_are_allowed_is_refused() {
    let options = DxfOptions { vertex_limit: 3, ..options() };
    let spline = "0 SPLINE\n70 8\n11 0\n21 0\n11 1\n21 0\n11 2\n21 0\n11 3\n21 0\n";
    let fault = read(file(spline).as_bytes(), &options, &Budget::unlimited()).unwrap_err().to_string();
    assert_eq!(fault, "line 18: a spline has more than 3 points");
}
