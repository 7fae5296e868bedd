//! Texts with other line ends and letters, and binary files.

use super::*;

/// A file with a layer with a letter beyond ASCII, an arc, a polyline, a block and a spline.
fn sample() -> String {
    let blocks = "0 BLOCK\n2 B\n70 0\n10 1\n20 1\n".to_owned() + &circle([1.0, 1.0], 0.5) + "0 ENDBLK\n";
    let spline = "0 SPLINE\n8 0\n70 8\n71 2\n72 6\n73 3\n40 0\n40 0\n40 0\n40 1\n40 1\n40 1\n".to_owned()
        + "10 0\n20 20\n30 0\n10 5\n20 30\n30 0\n10 10\n20 20\n30 0\n";
    let shapes = polygon(&[[0.0, 0.0, 0.25], [10.0, 0.0, 0.0], [10.0, 10.0, 0.0]])
        + &arc([20.0, 0.0], 2.5, 12.5, 170.25)
        + "0 INSERT\n8 Au\u{df}en\n2 B\n10 4\n20 1\n50 30\n70 2\n44 1.5\n102 {ACAD\n40 7\n102 }\n"
        + &spline
        + &line([0.0, 20.0], [10.0, 20.0])
        + "0 TEXT\n8 0\n10 0\n20 0\n40 3\n1 0\n1001 APP\n1040 3.5\n1070 7\n";
    file_with("9 $ACADVER\n1 AC1015\n9 $INSUNITS\n70 5\n9 $TDCREATE\n40 2.5\n", &blocks, &shapes)
}

#[test]
fn line_ends_blanks_comments_and_marks_do_not_matter() {
    let text = sample();
    let expected = drawing(&text);
    assert_eq!((expected.loops.len(), expected.open.len(), expected.unit), (4, 1, Some(Unit::Centimetre)));
    assert_eq!(expected.layers[1].name, "Außen");
    let others = [
        text.replace('\n', "\r\n"),
        format!("999\nwritten by hand\n{text}"),
        format!("\u{feff}{text}\n  \n\u{1a}"),
        text.lines().map(|line| format!("{line}  \n")).collect(),
        text.lines()
            .enumerate()
            .map(|(k, line)| if k % 2 == 0 { format!("{line:>3}\n") } else { format!("{line}\n") })
            .collect(),
        text.replace("Außen", "Au\\U+00DFen"),
    ];
    for other in others {
        let mut found = drawing(&other);
        for one in &mut found.left_out {
            // A comment moves the lines.
            one.first = expected.left_out[0].first;
        }
        assert_eq!(found, expected);
    }
    let latin: Vec<u8> = text.chars().map(|c| u32::from(c) as u8).collect();
    assert_eq!(read(&latin, &options(), &Budget::unlimited()).unwrap(), expected);
}

/// The binary twin of a text: all codes of the sample are known here.
fn binary(text: &str, has_long_codes: bool) -> Vec<u8> {
    let mut bytes = b"AutoCAD Binary DXF\r\n\x1a\0".to_vec();
    let mut lines = text.lines();
    while let (Some(code), Some(value)) = (lines.next(), lines.next()) {
        let code: u16 = code.parse().unwrap();
        match code {
            _ if has_long_codes => bytes.extend(code.to_le_bytes()),
            0..255 => bytes.push(code as u8),
            _ => {
                bytes.push(255);
                bytes.extend(code.to_le_bytes());
            }
        }
        match code {
            10..=59 | 1040 => bytes.extend(value.parse::<f64>().unwrap().to_le_bytes()),
            60..=79 | 1070 => bytes.extend(value.parse::<i16>().unwrap().to_le_bytes()),
            90..=99 => bytes.extend(value.parse::<i32>().unwrap().to_le_bytes()),
            _ => {
                bytes.extend(value.as_bytes());
                bytes.push(0);
            }
        }
    }
    bytes
}

#[test]
fn a_binary_file_is_its_text() {
    let expected = drawing(&sample());
    for has_long_codes in [false, true] {
        let bytes = binary(&sample(), has_long_codes);
        let mut found = read(&bytes, &options(), &Budget::unlimited()).unwrap();
        assert!(matches!(found.left_out[0].first, Place::Byte(_)));
        found.left_out[0].first = expected.left_out[0].first;
        assert_eq!(found, expected);
        for end in 0..bytes.len() - 1 {
            // Without the group EOF the drawing is whole.
            let cut = read(&bytes[..end], &options(), &Budget::unlimited());
            let is_whole = cut.is_ok_and(|drawing| drawing.left_out.iter().any(|one| one.kind == "EOF"));
            assert!(!is_whole || end + 8 > bytes.len(), "{end} of {}", bytes.len());
        }
    }
}

#[test]
fn the_unit_is_that_of_the_file_or_of_the_options() {
    let square = rectangle([0.0, 0.0], [1.0, 1.0]);
    let area = |header: &str, unit: Option<Unit>| {
        let options = DxfOptions { unit, ..options() };
        let text = file_with(header, "", &square);
        read(text.as_bytes(), &options, &Budget::unlimited())
            .map(|drawing| (drawing.unit, only(&drawing).area_mm2))
            .map_err(|fault| fault.to_string())
    };
    let stated = |code: u8| format!("9 $INSUNITS\n70 {code}\n");
    assert_eq!(area(&stated(4), None), Ok((Some(Unit::Millimetre), 1.0)));
    assert_eq!(area(&stated(2), Some(Unit::Foot)), Ok((Some(Unit::Foot), 304.8 * 304.8)));
    assert_eq!(area(&stated(0), None), Ok((None, 1.0)));
    assert_eq!(area("", Some(Unit::Centimetre)), Ok((None, 100.0)));
    // The caller's word counts, and the file's stays known.
    assert_eq!(area(&stated(1), Some(Unit::Millimetre)), Ok((Some(Unit::Inch), 1.0)));
    assert_eq!(area(&stated(3), Some(Unit::Centimetre)), Ok((None, 100.0)));
    let miles =
        "line 8: the unit 3 of $INSUNITS is not supported; use mm, cm, m, micrometres, inches or feet";
    assert_eq!(area(&stated(3), None), Err(miles.to_owned()));
}

#[test]
fn what_follows_the_end_is_told_and_so_is_an_absent_end() {
    let text = file(&circle([0.0; 2], 1.0));
    let more = drawing(&format!("{text}0\nSECTION\n"));
    assert_eq!(left_out(&more), [("EOF", "bytes behind the end of the drawing are ignored", 1)]);
    assert_eq!(more.loops.len(), 1);
    let less = drawing(text.strip_suffix("0\nEOF\n").unwrap());
    assert_eq!(left_out(&less), [("EOF", "the file ends without it", 1)]);
}

#[test]
fn a_unit_that_is_not_known_is_told_where_the_options_state_one() {
    let told = |code: i32| {
        let text = file_with(&format!("9 $INSUNITS\n70 {code}\n"), "", &circle([0.0, 0.0], 1.0));
        let options = DxfOptions { unit: Some(Unit::Millimetre), ..options() };
        read(text.as_bytes(), &options, &Budget::unlimited()).unwrap().unknown_unit
    };
    assert_eq!([0, 1, 4, 7].map(told), [false, false, false, true]);
}
