use super::grid::{NoGrid, grid};
use super::*;

fn read_text(text: &str) -> Result<PointText, Unreadable> {
    read(text.as_bytes(), 1_000_000, &Budget::unlimited())
}

fn points_of(text: &str) -> Vec<[f64; 3]> {
    read_text(text).unwrap_or_else(|fault| panic!("{fault}")).points
}

#[test]
fn every_way_of_writing_gives_the_same_points() {
    let expected = vec![[1.5, -2.0, 0.25], [2.0, 3.5, -1e-3]];
    for text in [
        "1.5 -2 0.25\n2 3.5 -1e-3\n",
        "1.5,-2,0.25\r\n2,3.5,-1e-3\r\n",
        "1.5, -2, 0.25\n2, 3.5, -0.001",
        "1,5;-2;0,25\n2;3,5;-0,001\n",
        "1.5;-2;0.25;\n2;3.5;-0.001;\n",
        "1,5\t-2\t0,25\n2\t3,5\t-1E-3\n",
        "1,5 -2,0 0,25\n2,0 3,5 -0,001\n",
        "  1.5   -2.  .25  \n\n# a remark\n2 3.5 -1D-3\n",
        "\u{feff}x;y;z\n1,5;-2;0,25\n2;3,5;-0,001\n",
        "1.5 , -2 , 0.25\n2 ,3.5 ,-0.001\n",
        "z,y,x\nmm,mm,mm\n---,---,---\n0.25,-2,1.5\n-0.001,3.5,2\n",
        "z y x\n0.25 -2 1.5\n-0.001 3.5 2\n",
        "1 1.5 -2 0.25\n2 2 3.5 -0.001\n",
        "\"Number\",\"X [mm]\",\"Y [mm]\",\"Z [mm]\"\n7,1.5,-2,0.25\n9,2,3.5,-0.001\n",
    ] {
        assert_eq!(points_of(text), expected, "{text}");
    }
}

#[test]
fn headers_state_the_unit() {
    for (head, unit) in [
        ("x [mm];y [mm];z [mm]", Some(Unit::Millimetre)),
        ("x_inch y_inch z_inch", Some(Unit::Inch)),
        ("# units: inch", Some(Unit::Inch)),
        ("# Unit = µm", Some(Unit::Micrometre)),
        ("X (m), Y (m), Z (m)", Some(Unit::Metre)),
        ("x y z", None),
        ("measured in room m", None),
        ("# all units in mm", Some(Unit::Millimetre)),
        ("Einheiten in mm", Some(Unit::Millimetre)),
        ("x (in mm);y (in mm);z (in mm)", Some(Unit::Millimetre)),
        ("# Operator (M. Smith), units: mm", Some(Unit::Millimetre)),
        ("# unit: in", Some(Unit::Inch)),
        ("x [in] y [in] z [in]", Some(Unit::Inch)),
    ] {
        let text = read_text(&format!("{head}\n1 2 3\n")).unwrap_or_else(|fault| panic!("{head}: {fault}"));
        assert_eq!(text.unit, unit, "{head}");
    }
}

#[test]
fn what_is_no_point_is_refused_with_its_line() {
    for (text, line) in [
        ("1 2 3\n1 2\n", 2),
        ("1 2 3\n4 5 nan\n", 2),
        ("1;2;3\n4;;6\n", 2),
        ("1 2 3\n\n4 5 x\n", 3),
        ("1 2 3\n4 5 inf\n", 2),
        ("1 2 3\n4 5 1e999\n", 2),
        ("1 2 3\n4 5 1e12\n", 2),
        ("0 0 nan\n1 2 3\n", 1),
        ("x;y;z\n0;;0\n1;2;3\n", 2),
        ("nan nan nan\n1 2 3\n", 1),
        ("1,5;2;3\n1.5;2;3\n", 2),
    ] {
        let fault = read_text(text).expect_err(text);
        assert!(fault.to_string().starts_with(&format!("line {line}:")), "{text}: {fault}");
    }
    assert!(read_text("").is_err());
    assert!(read_text("only words\nand more\n").is_err());
    assert!(read(b"1 2 3\n4 5 6\n", 1, &Budget::unlimited()).is_err());
}

#[test]
fn other_columns_and_repeated_points_are_listed() {
    let text = read_text("1 2 3 200 100 50\n1 2 3 200 100 50\n4 5 6 1 1 1\n").expect("legal");
    assert_eq!(text.points.len(), 2);
    let kinds: Vec<&str> = text.left_out.iter().map(|one| one.kind.as_str()).collect();
    assert_eq!(kinds, ["column 4", "column 5", "column 6", "point"]);
}

/// A grid of n x m points, turned, in a scattered order, with scatter of a given size.
fn lattice(n: usize, m: usize, angle: f64, scatter: f64) -> Vec<[f64; 3]> {
    let (sin, cos) = f64::sin_cos(angle);
    let noise = |k: usize| scatter * ((k as f64 * 12.9898).sin() * 43758.5453).fract();
    let mut points: Vec<[f64; 3]> = (0..n * m)
        .map(|k| {
            // The spacing grows along the rows.
            let (i, j) = ((k % n) as f64, (k / n) as f64);
            let (u, v) = (i + 0.002 * i * i + noise(k), 1.5 * j + noise(k + 1));
            [100.0 + u * cos - v * sin, u * sin + v * cos, k as f64]
        })
        .collect();
    let count = points.len();
    for k in 0..count {
        points.swap(k, (k * 7919 + 13) % count);
    }
    points
}

#[test]
fn a_grid_is_found_in_any_order_turned_and_scattered() {
    for (n, m) in [(2, 2), (3, 40), (57, 31), (400, 100)] {
        for angle in [0.0, 0.3, -0.7, 0.78] {
            for scatter in [0.0, 0.002] {
                let points = lattice(n, m, angle, scatter);
                let found = grid(&points, Some(0.01), &Budget::unlimited())
                    .unwrap_or_else(|fault| panic!("{n} x {m}, {angle}, {scatter}: {fault}"));
                assert_eq!((found.rows.len(), found.rows[0].len()), (m, n), "{angle}");
                for (j, row) in found.rows.iter().enumerate() {
                    for (i, &k) in row.iter().enumerate() {
                        assert_eq!(points[k][2], (j * n + i) as f64, "{n} x {m}, {angle}, {scatter}");
                    }
                }
                assert!((found.angle - angle).abs() < 0.01);
            }
        }
    }
}

#[test]
fn what_is_no_grid_is_refused_with_a_point() {
    let budget = Budget::unlimited();
    let mut points = lattice(20, 10, 0.2, 0.0);
    let removed = points.pop();
    assert!(matches!(grid(&points, None, &budget), Err(NoGrid::Ragged { .. })));
    points.extend(removed);
    points[7][0] += 0.3;
    assert!(matches!(grid(&points, None, &budget), Err(NoGrid::Off { point: 7, .. })));
    points[7] = points[8];
    assert!(grid(&points, None, &budget).is_err());
    let line: Vec<[f64; 3]> = (0..50).map(|k| [f64::from(k), 0.0, 0.0]).collect();
    assert!(matches!(grid(&line, None, &budget), Err(NoGrid::TooFew { .. })));
    let same = vec![[1.0, 1.0, 0.0]; 9];
    assert!(grid(&same, None, &budget).is_err());
    let scattered: Vec<[f64; 3]> =
        (0..400).map(|k| [(f64::from(k) * 0.618).fract(), (f64::from(k) * 0.7548).fract(), 0.0]).collect();
    assert!(grid(&scattered, None, &budget).is_err());
}

#[test]
fn headers_with_several_units_are_refused() {
    for head in ["x [mm];y [mm];z [\u{b5}m]", "# unit: mm\n# unit: inch"] {
        assert!(read_text(&format!("{head}\n1;2;3\n")).is_err(), "{head}");
    }
}

#[test]
fn whole_numbers_leave_the_decimal_sign_open() {
    assert_eq!(points_of("0;0;0\n1;2;3\n1,5;2;3\n")[2], [1.5, 2.0, 3.0]);
    assert_eq!(points_of("1, 2, 3\n1.5, 2, 3\n")[1], [1.5, 2.0, 3.0]);
    assert_eq!(points_of("10 ,20 ,30\n1 ,2 ,3\n")[0], [10.0, 20.0, 30.0]);
}

#[test]
fn a_point_far_away_from_many_does_not_make_the_search_slow() {
    let mut points = lattice(300, 300, 0.0, 0.0);
    points.push([1e8, 1e8, 0.0]);
    assert!(matches!(grid(&points, None, &Budget::unlimited()), Err(NoGrid::Ragged { .. })));
}
