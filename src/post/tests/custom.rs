//! A shop's own lines in programs.

use super::*;
use crate::custom::{CustomFault, Refused, own_work_offset, refused};
use crate::dialects::{grbl::GRBL, heidenhain::HEIDENHAIN, siemens::SIEMENS};
use toolpathd_core::toolpath::program::Custom;

fn lines(lines: &[&str]) -> Vec<String> {
    lines.iter().map(|&line| line.to_owned()).collect()
}

fn with(dialect: &Dialect, custom: Custom) -> Result<String, WriteError> {
    let tool = Tool { length_offset: None, ..TOOL };
    let decimals = dialect.default_decimals_mm;
    let program =
        Program { custom, block_numbers: true, ..Program::plain(Resolution { units: Units::Mm, decimals }) };
    let cutting = Cutting { coolant: Coolant::Off, ..cutting() };
    let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
    let mut path = Toolpath::builder(Point3::new(0.0, 0.0, 45.0));
    path.line(Point3::new(0.0, 0.0, -1.0), feed(400.0), Role::Plunge).unwrap();
    path.line(Point3::new(10.5, 0.0, -1.0), feed(800.0), Role::Cut).unwrap();
    path.rapid(Point3::new(10.5, 0.0, 45.0)).unwrap();
    write(&path.finish().unwrap(), &job, &Budget::unlimited()).map(|program| program.text)
}

#[test]
fn own_lines_stand_in_their_places_and_the_modes_are_set_again() {
    let custom = Custom {
        header: lines(&["G91 G28 Z0.", "(SHOP 7 - 3-AXIS)", "G90"]),
        tool_change: lines(&["G65 P9000 T3 X1.5", "T3 M6"]),
        footer: lines(&["M98 P8000", "M1"]),
    };
    let text = with(&FANUC, custom).unwrap();
    let body: Vec<&str> = text.lines().skip_while(|line| !line.contains("G28")).collect();
    assert_eq!(
        body,
        [
            "N80 G91 G28 Z0.",
            "N90 (SHOP 7 - 3-AXIS)",
            "N100 G90",
            "N110 G21",
            "N120 G17 G90 G40 G49 G80 G94",
            "N130 G65 P9000 T3 X1.5",
            "N140 T3 M6",
            "N150 G21",
            "N160 G17 G90 G40 G49 G80 G94",
            "N170 S12000 M3",
            "N180 G0 X0.000 Y0.000",
            "N190 G43 H3 Z45.000",
            "N200 G1 Z-1.000 F400.",
            "N210 X10.500 F800.",
            "N220 G0 Z45.000",
            "N230 M5",
            "N240 M9",
            "N250 M98 P8000",
            "N260 M1",
            "N270 M30",
            "%",
        ]
    );
}

#[test]
fn klartext_and_siemens_have_lines_of_their_own_kind() {
    let custom = Custom {
        header: lines(&["CYCL DEF 247 DATUM SETTING Q339=+1", "L Z+0 R0 FMAX M91"]),
        tool_change: lines(&["TOOL CALL 3 Z", "M27"]),
        footer: lines(&["CALL PGM TNC:\\END.H", "; DONE"]),
    };
    let text = with(&HEIDENHAIN, custom).unwrap();
    assert!(text.contains(" TOOL CALL 3 Z\n") && text.contains(" TOOL CALL Z S12000\n"), "{text}");
    assert!(text.contains(" CALL PGM TNC:\\END.H\n"), "{text}");
    let custom = Custom {
        header: lines(&["CYCLE800()", "G0 SUPA Z0 D0 ; up", "MSG(\"SHOP 7\")"]),
        tool_change: lines(&["T=\"BALL 10\"", "M6", "L9000"]),
        footer: lines(&["M1"]),
    };
    let text = with(&SIEMENS, custom).unwrap();
    assert!(text.contains(" T=\"BALL 10\"\n") && text.contains("D1\n"), "{text}");
}

#[test]
fn lines_that_break_the_program_are_refused() {
    let cases: [(&Dialect, &[&str]); 4] = [
        (
            &FANUC,
            &[
                "",
                " ",
                "M30",
                "M2",
                "M02",
                "M99",
                "M97 P1",
                "%",
                "O1234",
                "N10 M1",
                "G20",
                "G68 X0 Y0 R45",
                "G92 X0",
                "G52 X1",
                "G10 L2 P1 X0",
                "G41 D1",
                "G51 X0 P2",
                "G1 Z-50 F100",
                "X5",
                "#500=1",
                "GOTO 10",
                "/M1",
                "IF [#1 EQ 1] GOTO 2",
                "(OPEN",
                "M1 ; G0 Z-9",
                "(A) G0 Z-9",
                "(MSG, X)",
                "( PROBEOPEN X)",
                "G90.1",
                "M72",
                "M1\nM30",
                "Ü",
                "G43.4 H1",
                "T3 M6 Z",
                "(A:O1)",
                "(A(B)",
            ],
        ),
        (&GRBL, &["G0 X5", "$H", "!", "~", "?"]),
        (
            &SIEMENS,
            &[
                "M17",
                "RET",
                "GOTOF A",
                "A: G0",
                "IF R1==1",
                "TRANS X5",
                "ROT Z45",
                "$P_UIFR[1]=0",
                "G58 X1",
                "MSG(\"A)",
                "T=\"A",
                "CYCLE832(0.01",
                "STOPRE GOTOB X",
                "R1=5",
                "CYCLE800(1,\"TABLE\",0)",
                "CYCLE800",
                "G0 G53 Z0",
                "G28 Z0",
            ],
        ),
        (
            &HEIDENHAIN,
            &[
                "M30",
                "M99",
                "L X+5 R0 FMAX",
                "LBL 1",
                "CALL LBL 1",
                "END PGM 1 MM",
                "BEGIN PGM 1 MM",
                "FN 0: Q1 = +5",
                "CYCL DEF 7.1 X+5",
                "; A ~",
                "M3 M30",
                "M2.0",
                "L Z+0 R0 FMAX M91 M30",
                "M002",
                "M128",
                "L X+0 M128",
                "M94",
                "M107",
            ],
        ),
    ];
    for (dialect, refusals) in cases {
        for line in refusals {
            for k in 0..3 {
                let mut custom = Custom::default();
                [&mut custom.header, &mut custom.tool_change, &mut custom.footer][k].push((*line).to_owned());
                let error = with(dialect, custom);
                assert!(matches!(error, Err(WriteError::Custom(_))), "{} {line:?} {error:?}", dialect.name);
            }
        }
    }
    let deckel = crate::dialect("deckel").unwrap();
    assert_eq!(refused(deckel, &Custom { header: lines(&["M1"]), ..Custom::default() }).len(), 1);
}

/// The program selects its work offset before the tool change: a line there must not select another.
#[test]
fn only_lines_before_the_work_offset_may_select_another() {
    for (dialect, line) in [
        (&FANUC, "G55"),
        (&FANUC, "G54.1 P12"),
        (&LINUXCNC, "T3 M6 G59.3"),
        (&SIEMENS, "G505"),
        (&SIEMENS, "G500"),
        (&HEIDENHAIN, "CYCL DEF 247 Q339=+5"),
    ] {
        let header = Custom { header: lines(&[line]), ..Custom::default() };
        assert!(with(dialect, header).is_ok(), "{} {line}", dialect.name);
        let error = with(dialect, Custom { tool_change: lines(&[line]), ..Custom::default() }).unwrap_err();
        let WriteError::Custom(Refused { fault: CustomFault::WorkOffset(_), .. }) = error else {
            panic!("{} {line}: {error}", dialect.name)
        };
        assert!(error.to_string().starts_with("line 1 of the tool change is refused"), "{error}");
    }
}

#[test]
fn a_work_offset_is_found_only_in_lines_that_are_not_refused() {
    let found = |dialect: &Dialect, header: &[&str]| {
        own_work_offset(dialect, &Custom { header: lines(header), ..Custom::default() })
            .map(|own| (own.index, own.word))
    };
    assert_eq!(found(&FANUC, &["G90", "G54"]), Some((1, "G54".to_owned())));
    for dialect in [&FANUC, &SIEMENS, &HEIDENHAIN] {
        // Letters of several bytes, alone and beside words.
        for line in ["\u{e4}G54", "G54 \u{10887}", "\u{b5}", "(\u{e4}) G54", "", ";\u{e4}"] {
            assert_eq!(found(dialect, &[line]), None, "{line:?}");
        }
    }
}

#[test]
fn a_dialect_without_a_tool_change_has_no_lines_for_it() {
    let custom = Custom { tool_change: lines(&["M0"]), ..Custom::default() };
    let error = with(&GRBL, custom).unwrap_err().to_string();
    assert!(error.contains("the dialect has no tool change"), "{error}");
}

proptest! {
    // Most lines are refused.
    #![proptest_config(ProptestConfig {
        failure_persistence: None, max_global_rejects: 65_536, ..ProptestConfig::default()
    })]

    /// Lines are refused, or they are lines of the program, and all other lines are as without them.
    #[test]
    fn own_lines_are_refused_or_stand_as_they_are(
        header in prop::collection::vec(line(), 0..3), tool_change in prop::collection::vec(line(), 0..3),
        footer in prop::collection::vec(line(), 0..3), dialect in prop::sample::select(DIALECTS),
    ) {
        // What the moves of the toolpath are told by, below.
        let has_move = |line: &str| line.contains("10.5") || line.contains("-1.0");
        let own = || header.iter().chain(&tool_change).chain(&footer);
        prop_assume!(!own().any(|line| has_move(line)));
        let custom = Custom { header, tool_change, footer };
        let Ok(text) = with(dialect, custom.clone()) else { return Err(TestCaseError::reject("refused")) };
        let plain = with(dialect, Custom::default()).unwrap();
        let count = |text: &str| text.split(['\n', '\r', '\u{b}', '\u{c}', '\u{85}', '\u{2028}']).count();
        prop_assert_eq!(count(&text), text.lines().count() + 1);
        prop_assert!(text.is_ascii());
        for own in [&custom.header, &custom.tool_change, &custom.footer].into_iter().flatten() {
            prop_assert!(text.lines().any(|line| line.ends_with(own.as_str())), "{own:?}");
        }
        prop_assert_eq!(text.matches('%').count(), plain.matches('%').count());
        // Both end with the same block, and move alike.
        let bare = |line: &str| line.trim_start_matches(|c: char| c == 'N' || c.is_ascii_digit()).trim().to_owned();
        let last = |text: &str| text.lines().rev().take(2).map(bare).collect::<Vec<_>>();
        let has_end = |line: &String| line.contains("M30") || line.contains("M2") || line.contains("END PGM");
        prop_assert!(last(&text).iter().any(has_end), "{text}");
        let cuts = |text: &str| -> Vec<String> {
            text.lines().map(bare).filter(|line| has_move(line)).collect()
        };
        prop_assert_eq!(cuts(&text), cuts(&plain));
    }
}

/// Words, comments and noise in any order.
fn line() -> impl Strategy<Value = String> {
    let word = prop_oneof![
        8 => "[A-Z]-?[0-9]{1,2}[.]?[0-9]? ?",
        4 => prop::sample::select(vec!["M1", "M0 ", "G65 ", "P9000 ", "T3 M6", "G28", "G53 ", "(SHOP)", "; x", "M30", "M6 "])
            .prop_map(str::to_owned),
        2 => prop::sample::select(vec!["CALL PGM A", "L Z+0 FMAX M91", "STOP", "MSG(\"A\")", "SUPA ", "END PGM 1 MM", "%\n"])
            .prop_map(str::to_owned),
        1 => "(?s).{0,4}",
    ];
    prop::collection::vec(word, 1..4).prop_map(|words| words.concat())
}
