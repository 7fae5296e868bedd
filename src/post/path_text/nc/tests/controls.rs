//! Words whose meaning differs between controls, and our own programs.

use super::*;

#[test]
fn with_tip_control_angles_turn_in_step() {
    let machine = by_name("table_table_ac").unwrap();
    for (begins, end, c) in [
        ("G43.4 H1", "C90", 90.0),
        ("M428", "C360", 360.0),
        ("TRAORI\nORIWKS\nORIAXES", "C=180", 180.0),
        ("M128", "C-540", -540.0),
    ] {
        let path = path_of(&format!("G21 G90 G94 F100\n{begins}\nG0 X0 Y0 Z0 A-30 C0\nG1 X20 {end}\n"));
        let turn = f64::to_radians(c);
        assert!(path.len() as f64 > turn.abs() / 0.5, "{begins}: {} poses", path.len());
        for at in &path[1..] {
            let part = at.pose.tip.x / 20.0;
            let rotary = [-30f64.to_radians(), turn * part];
            let cone = machine.forward(&AxisPositions { linear_mm: [0.0; 3], rotary });
            assert!(at.pose.axis.angle(&cone.axis) < 1e-7 && at.pose.tip.y == 0.0, "{begins}: {at:?}");
        }
    }
    let klartext = |path: &str| {
        let text = format!(
            "0 BEGIN PGM A MM\n1 L X+0 Y+0 Z+0 A-30 C+0 FMAX\n2 FUNCTION TCPM F TCP AXIS {path}\n3 L X+0 Y+0 Z+0 FMAX\n4 L X+20 C+90 F100\n"
        );
        text_of(&text).map(|text| text.path.len())
    };
    assert!(klartext("POS PATHCTRL AXIS").unwrap() > 10);
    assert_eq!(klartext("POS PATHCTRL VECTOR"), Ok(2));
    let spatial = klartext("SPAT PATHCTRL VECTOR").unwrap_err();
    let is_angle = |word: &str| word == "an angle under AXIS SPAT";
    assert!(matches!(spatial.fault, PathFault::Refused { ref word, .. } if is_angle(word)));
}

#[test]
fn a_second_length_offset_is_refused_and_a_lone_h_is_told() {
    let start = "G21 G90 G94 F100\nG43.4 H1\nG0 X0 Y0 Z0 A0 C0\nG1 X5\n";
    for line in ["H2", "G43 H2 Z0", "G43.4 H2", "H2 X9"] {
        let fault = fault(&format!("{start}{line}\n"));
        assert!(matches!(fault, (5, PathFault::Refused { ref word, .. }) if word == "H2"), "{fault:?}");
    }
    assert_eq!(text_of(&format!("{start}H1 X9\n")).unwrap().left_alone, []);
    let lone = text_of("TRAORI\nH5\nG0 X0 Y0 Z0 A0 C0\nG1 X5 F100\n").unwrap();
    assert_eq!(lone.left_alone, [LeftWord { word: "H".into(), count: 1, line: 2 }]);
}

#[test]
fn words_of_siemens_name_their_spindle_and_their_tool() {
    let first = text_of("T=\"3\" M6\nS1=5000 M1=3\nG0 X0 Y0 Z0\nG1 X5 F100\nM1=5\nM30\n").unwrap();
    assert_eq!(first.tool, Some(Said { value: 3, line: 1 }));
    assert_eq!(first.spindle_rpm, Some(Said { value: 5000.0, line: 2 }));
    assert_eq!(first.path.len(), 2);
    let other = fault("S1=5000 M1=3\nM2=3\nG0 X0 Y0 Z0\n");
    assert!(matches!(other, (2, PathFault::Refused { ref word, .. }) if word == "M2=3"), "{other:?}");
    let named = text_of("T=\"MILL 6\"\nM6\nG0 X0 Y0 Z0\nG1 X5 F100\n").unwrap();
    assert_eq!((named.tool, named.path.len()), (None, 2));
    let second = fault("T=\"A\"\nM6\nG0 X0 Y0 Z0\nG1 X5 F100\nT=\"B\"\nM6\nG0 X0 Y0 Z0\n");
    assert!(matches!(second, (6, PathFault::Refused { .. })), "{second:?}");
}

#[test]
fn a_program_that_begins_with_a_cut_begins_at_its_feed() {
    assert_eq!(path_of("G21 G90 G94\nG1 X0 Y0 Z0 F100\nX5\n")[0].pace, feed(100.0));
    assert_eq!(fault("G93 G1 X0 Y0 Z0 F100\n"), (1, PathFault::NoStart));
}

#[test]
fn the_tolerance_cycle_of_our_own_programs_is_left_alone() {
    let text = "0 BEGIN PGM A MM\n1 CYCL DEF 32.0 TOLERANCE\n2 CYCL DEF 32.1 T0.01\n3 CYCL DEF 32.2 HSC-MODE:0 TA0.1\n4 L X+0 Y+0 Z+0 FMAX\n5 L X+5 F100\n6 END PGM A MM\n";
    let text = text_of(text).unwrap();
    assert_eq!(text.left_alone, [LeftWord { word: "CYCL DEF 32".into(), count: 3, line: 2 }]);
}
