//! Whole programs as a machinist reads them, and the refusal of numbers that a control does not read.

use super::*;

#[test]
fn a_linuxcnc_program_reads_as_a_machinist_expects() {
    let program =
        Program { name: Some("die 7 (rev. B)".into()), work_offset: Some(54), ..Program::plain(MM) };
    let program = written(&sample(), &program, &cutting(), &["part_id: 4711".into()]).unwrap();
    let expected = "(PROGRAM: DIE 7 REV. B)\n(NOTE: PART_ID 4711)\n\
        (WRITTEN: FOR LINUXCNC - MM - 3 DECIMALS - WORK OFFSET G54)\n(TOOL: T3 H4 BALL DIAMETER 10.000 MM)\n\
        (FEED: CUT 333.33 TO 800 PLUNGE 400 LINK 800 MM PER MIN)\n(SPINDLE: 12000 RPM - COOLANT FLOOD)\n\
        (RANGE: X 0.000 TO 10.000 Y 0.000 TO 4.000 Z 0.000 TO 45.000 MM)\n\
        (TIME: 6 S - WITH ACCELERATION 6 S)\n(ROUNDING: WITHIN 0.0001 MM OF THE TOOLPATH)\n\
        (WARNING: LENGTH_OFFSET_DIFFERS - TOOL 3 IS CUT WITH THE LENGTH OFFSET 4, WHICH IS THAT OF ANOTHER PLACE OF)\n\
        (WARNING: THE TABLE - TOOL.LENGTH_OFFSET)\n\
        G17 G21 G90 G40 G49 G80 G94\nG64 P0.001 Q0\nG54\nT3 M6\nG43 H4\nS12000 M3\nM8\n\
        G0 X1.000 Y2.000\nZ45.000\nX0.000 Y0.000\nZ12.000\nG1 Z0.000 F400\n\
        G18 G3 X10.000 Z0.000 I5.000 K0.000 F800\nG1 Y2.000\nG4 P0.250\n\
        G17 G2 X10.000 Y2.000 I-2.000 J0.000 F333.33\nG0 Z12.000\nX0.000 Y0.000\nZ45.000\n\
        M5\nM9\nM30\n";
    assert_eq!(program.text, expected);
    assert_eq!(program.blocks, 12);
    assert_eq!(program.max_radius_mismatch_mm, 0.0);
}

#[test]
fn a_fanuc_program_reads_as_a_machinist_expects() {
    let program =
        Program { name: Some("die 7".into()), number: 501, work_offset: Some(55), ..Program::plain(MM) };
    let text = written_in(&FANUC, &sample(), &program, &cutting(), &[]).unwrap().text;
    let expected = "%\nO0501 (DIE 7)\n(WRITTEN = FOR FANUC - MM - 3 DECIMALS - WORK OFFSET G55)\n\
        (TOOL = T3 H4 BALL DIAMETER 10.000 MM)\n\
        (FEED = CUT 333.33 TO 800 PLUNGE 400 LINK 800 MM PER MIN)\n(SPINDLE = 12000 RPM - COOLANT FLOOD)\n\
        (RANGE = X 0.000 TO 10.000 Y 0.000 TO 4.000 Z 0.000 TO 45.000 MM)\n\
        (TIME = 6 S - WITH ACCELERATION 6 S)\n(ROUNDING = WITHIN 0.0001 MM OF THE TOOLPATH)\n\
        (WARNING = LENGTH_OFFSET_DIFFERS - TOOL 3 IS CUT WITH THE LENGTH OFFSET 4, WHICH IS THAT OF ANOTHER PLACE)\n\
        (WARNING = OF THE TABLE - TOOL.LENGTH_OFFSET)\n\
        G21\nG17 G90 G40 G49 G80 G94\nG55\nT3 M6\nS12000 M3\nM8\n\
        G0 X1.000 Y2.000\nG43 H4 Z45.000\nX0.000 Y0.000\nZ12.000\nG1 Z0.000 F400.\n\
        G18 G3 X10.000 Z0.000 I5.000 K0.000 F800.\nG1 Y2.000\nG4 P250\n\
        G17 G2 X10.000 Y2.000 I-2.000 J0.000 F333.33\nG0 Z12.000\nX0.000 Y0.000\nZ45.000\n\
        M5\nM9\nM30\n%\n";
    assert_eq!(text, expected);
}

#[test]
fn the_tool_goes_home_along_z_before_it_is_changed_and_at_the_end() {
    for (safe_home, z, words) in
        [(SafeHome::G28, "Z0.000", "G91 G28 Z0.000\nG90\n"), (SafeHome::G53, "Z0.000", "G53 G0 Z0.000\n")]
    {
        let program = Program { safe_home, work_offset: Some(54), ..Program::plain(MM) };
        for dialect in WORDS {
            let text = written_in(dialect, &sample(), &program, &cutting(), &[]).unwrap().text;
            assert!(text.contains(&format!("G54\n{words}T3 M6\n")), "{text}");
            assert!(text.contains(&format!("Z45.000\n{words}M5\n")), "{text}");
            // A program that goes on in steps, or comes down instead, is not understood.
            for spoiled in [text.replace("\nG90\n", "\n"), text.replacen(z, "Z-5.000", 1)] {
                let read: Result<Vec<_>, _> = Reader::new(&spoiled, dialect, 0.0015).collect();
                assert_eq!(read.is_err(), spoiled != text, "{spoiled}");
            }
        }
    }
}

#[test]
fn fanuc_refuses_numbers_that_its_control_does_not_read() {
    let refused = |path: &Toolpath, program: &Program, cutting: &Cutting| {
        written_in(&FANUC, path, program, cutting, &[]).unwrap_err()
    };
    for number in [0, 10_000] {
        let error = refused(&sample(), &Program { number, ..Program::plain(MM) }, &cutting());
        assert_eq!(error, WriteError::ProgramNumber { number, max: 9999 });
    }
    let fast = Cutting { spindle_rpm: Some(100_000.0), ..cutting() };
    assert_eq!(refused(&sample(), &Program::plain(MM), &fast), WriteError::SpindleSpeed { rpm: 100_000.0 });
    // 99999.999 mm has eight digits, 100 m has nine.
    let reach = |x: f64| {
        let mut path = Toolpath::builder(Point3::origin());
        path.line(Point3::new(x, 0.0, 0.0), feed(100.0), Role::Cut).unwrap();
        path.finish().unwrap()
    };
    assert_eq!(
        refused(&reach(-100_000.0), &Program::plain(MM), &cutting()),
        WriteError::TooManyDigits { limit: 8 }
    );
    assert!(written_in(&FANUC, &reach(-99_999.999), &Program::plain(MM), &cutting(), &[]).is_ok());
    let error = refused(&sample(), &Program::plain(Resolution { units: Units::Mm, decimals: 5 }), &cutting());
    assert_eq!(error, WriteError::Decimals { decimals: 5, max: 4 });
}

#[test]
fn a_header_is_in_the_units_of_the_program_and_a_page_at_most() {
    let bull_nose = Tool { shape: Shape::BullNose { corner_radius_mm: 1.27 }, radius_mm: 6.35, ..TOOL };
    let notes: Vec<String> = (0..100).map(|k| format!("note {k} {}", "x".repeat(1000))).collect();
    for dialect in WORDS {
        let (program, cutting) = (Program::plain(INCH), cutting());
        let job = ProgramJob {
            tool: Some(&bull_nose),
            comments: &notes,
            ..ProgramJob::plain(&program, &cutting, dialect)
        };
        let text = write(&sample(), &job, &Budget::unlimited()).unwrap().text;
        let header: Vec<&str> = text.lines().filter(|line| line.starts_with('(')).collect();
        assert!(header.len() <= 60 && header.iter().all(|line| line.len() <= 120));
        assert!(text.contains("T3 H4 BULL NOSE DIAMETER 0.5000 CORNER RADIUS 0.0500 INCH)"));
        assert!(text.contains("Y 0.0000 TO 0.1575 Z 0.0000 TO 1.7717 INCH)"));
        assert!(text.contains("CUT 13.123 TO 31.496"));
        assert!(text.contains("60 MORE ARE LEFT OUT)"));
        let job = ProgramJob { tool: None, comments: &[], ..job };
        let text = write(&sample(), &job, &Budget::unlimited()).unwrap().text;
        assert!(!text.contains("(TOOL") && text.contains("\nT1 M6\n") && text.contains("G43 H1"));
    }
}
