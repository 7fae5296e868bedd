//! The control's own smoothing: its words in each dialect, and the shop's own lines that choose it.

use super::*;
use crate::dialects::{haas::HAAS, heidenhain::HEIDENHAIN, siemens::SIEMENS};
use toolpathd_core::toolpath::program::{Custom, Smoothing, SmoothingMode};

const FINISHING: Option<SmoothingMode> = Some(SmoothingMode::Finishing);
const ROUGHING: Option<SmoothingMode> = Some(SmoothingMode::Roughing);

fn smoothing(
    tolerance_mm: Option<f64>,
    tolerance_deg: Option<f64>,
    mode: Option<SmoothingMode>,
) -> Smoothing {
    Smoothing { tolerance_mm, tolerance_deg, mode }
}

fn with(dialect: &Dialect, program: &Program) -> Result<NcProgram, WriteError> {
    let cutting = cutting();
    let tool = Tool { length_offset: None, ..TOOL };
    let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(program, &cutting, dialect) };
    write(&sample(), &job, &Budget::unlimited())
}

fn smoothed(dialect: &Dialect, asked: Smoothing) -> Result<String, WriteError> {
    let program = Program { smoothing: Some(asked), ..Program::plain(MM) };
    with(dialect, &program).map(|program| program.text)
}

/// Each dialect that has words, what is asked for, and the lines that say so.
pub fn cases() -> Vec<(&'static Dialect, Smoothing, Vec<&'static str>)> {
    vec![
        (&LINUXCNC, smoothing(Some(0.02), None, None), vec!["G64 P0.020 Q0"]),
        (&LINUXCNC, smoothing(Some(0.00025), None, None), vec!["G64 P0.00025 Q0"]),
        (&SIEMENS, smoothing(Some(0.01), None, None), vec!["CYCLE832(0.010,_FINISH,1)", "CYCLE832()"]),
        (
            &SIEMENS,
            smoothing(Some(0.05), Some(0.5), ROUGHING),
            vec!["CYCLE832(0.050,_ORI_ROUGH,0.5)", "CYCLE832()"],
        ),
        (&FANUC, smoothing(None, None, None), vec!["G5.1 Q1", "G5.1 Q0"]),
        (&FANUC, smoothing(None, None, FINISHING), vec!["G5.1 Q1 R10", "G5.1 Q0"]),
        (&HAAS, smoothing(None, None, ROUGHING), vec!["G187 P1"]),
        (&HAAS, smoothing(Some(0.025), None, FINISHING), vec!["G187 P3 E0.025"]),
        (
            &HEIDENHAIN,
            smoothing(Some(0.01), None, None),
            vec!["CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.1 T0.010"],
        ),
        (
            &HEIDENHAIN,
            smoothing(Some(0.05), Some(0.5), ROUGHING),
            vec!["CYCL DEF 32.0 TOLERANCE", "CYCL DEF 32.1 T0.050", "CYCL DEF 32.2 HSC-MODE:1 TA0.5"],
        ),
    ]
}

/// The text of a line without a block number of Klartext.
fn bare(line: &str) -> &str {
    line.trim_start_matches(|c: char| c.is_ascii_digit()).trim_start()
}

#[test]
fn each_control_smooths_in_its_own_words() {
    for (dialect, asked, lines) in cases() {
        let text = smoothed(dialect, asked).unwrap();
        let is_one = |line: &&str| {
            ["G64", "CYCLE832", "G5.1", "G187", "CYCL DEF 32"].iter().any(|word| line.starts_with(word))
        };
        let found: Vec<&str> = text.lines().map(bare).filter(is_one).collect();
        assert_eq!(found, lines, "{text}");
        assert!(!text.contains("G641"), "{text}");
        let place = |wanted: &str| text.find(wanted);
        assert!(
            place(lines[0]) < place("800").map(|_| text.rfind("F800").or(text.rfind("F 800")).unwrap()),
            "{text}"
        );
    }
}

#[test]
fn a_changed_word_of_smoothing_fails_the_check() {
    for (dialect, asked, lines) in cases() {
        let program = Program { smoothing: Some(asked), ..Program::plain(MM) };
        let (cutting, tool) = (cutting(), Tool { length_offset: None, ..TOOL });
        let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
        let text = write(&sample(), &job, &Budget::unlimited()).unwrap().text;
        let read = |text: &str| check_text(text, &sample(), &job);
        assert!(read(&text).is_ok());
        // Each line is spoiled in its digits, and the first is left out.
        for line in lines {
            let digits = line.char_indices().filter(|(k, c)| *k > 3 && c.is_ascii_digit());
            for (k, digit) in digits {
                let other = if digit == '7' { "6" } else { "7" };
                let spoiled = text.replacen(line, &[&line[..k], other, &line[k + 1..]].concat(), 1);
                assert_ne!(spoiled, text);
                assert!(read(&spoiled).is_err(), "{} {line:?} {k}\n{spoiled}", dialect.name);
            }
            if dialect.name != "heidenhain" {
                let spoiled = text.replacen(&format!("{line}\n"), "", 1);
                assert!(read(&spoiled).is_err(), "{} without {line:?}", dialect.name);
            }
        }
    }
}

/// Without a word about smoothing, LinuxCNC and Siemens keep the path to a unit of the last decimal.
#[test]
fn a_changed_usual_distance_fails_the_check() {
    for (dialect, from, to) in [
        (&LINUXCNC, "G64 P0.001", "G64 P0.002"),
        (&SIEMENS, "ADIS=0.001", "ADIS=0.002"),
        (&LINUXCNC, "G64 P0.001 Q0\n", ""),
    ] {
        let (program, cutting, tool) = (Program::plain(MM), cutting(), Tool { length_offset: None, ..TOOL });
        let job = ProgramJob { tool: Some(&tool), ..ProgramJob::plain(&program, &cutting, dialect) };
        let text = write(&sample(), &job, &Budget::unlimited()).unwrap().text.replacen(from, to, 1);
        let error = check_text(&text, &sample(), &job).unwrap_err();
        assert!(matches!(error, WriteError::Differs { what: "smoothing", .. }), "{error}");
    }
}

#[test]
fn what_a_control_has_no_word_for_is_refused() {
    use crate::dialects::{deckel::DECKEL, grbl::GRBL, iso::ISO, mach4::MACH4, mazak::MAZAK, okuma::OKUMA};
    for dialect in [&DECKEL, &GRBL, &ISO, &MACH4, &MAZAK, &OKUMA] {
        let error =
            with(dialect, &Program { smoothing: Some(smoothing(None, None, None)), ..Program::plain(MM) });
        let Err(WriteError::Missing(missing)) = error else { panic!("{}", dialect.name) };
        assert!(
            [
                Missing::Smoothing { dialect: dialect.name },
                Missing::Coolant { dialect: dialect.name, has: &[Coolant::Off] }
            ]
            .contains(&missing),
            "{missing}"
        );
    }
    for (dialect, asked) in [
        (&LINUXCNC, smoothing(None, None, None)),
        (&LINUXCNC, smoothing(Some(0.01), None, FINISHING)),
        (&LINUXCNC, smoothing(Some(0.01), Some(0.1), None)),
        (&SIEMENS, smoothing(None, None, FINISHING)),
        (&FANUC, smoothing(Some(0.01), None, None)),
        (&HAAS, smoothing(Some(0.01), Some(0.1), None)),
        (&HEIDENHAIN, smoothing(None, None, FINISHING)),
        (&HEIDENHAIN, smoothing(Some(0.01), None, Some(SmoothingMode::SemiFinishing))),
    ] {
        let error = smoothed(dialect, asked).unwrap_err();
        assert!(matches!(error, WriteError::Missing(_)), "{} {asked:?} {error}", dialect.name);
    }
    let error = smoothed(&LINUXCNC, smoothing(Some(1e-9), None, None)).unwrap_err();
    assert!(matches!(error, WriteError::SmallTolerance { .. }), "{error}");
}

#[test]
fn the_lines_of_a_shop_that_smooth_are_not_overridden() {
    for (dialect, line, words) in [
        (&LINUXCNC, "G64 P0.05", "G64 P0.001"),
        (&LINUXCNC, "G61.1", "G64"),
        (&SIEMENS, "CYCLE832(0.05,_ROUGH,1)", "G641"),
        (&SIEMENS, "CYCLE832(0.05,1,1) ; fast", "G641"),
        (&SIEMENS, "G642", "G641"),
        (&FANUC, "G5.1 Q1 R3", "G5.1 Q0"),
        (&HAAS, "G187 P1", "G187 P3"),
        (&HEIDENHAIN, "CYCL DEF 32.1 T0.05", "CYCL DEF 32.0"),
    ] {
        for part in [CustomPart::Header, CustomPart::ToolChange] {
            let lines = vec![line.to_owned()];
            let custom = match part {
                CustomPart::Header => Custom { header: lines, ..Custom::default() },
                _ => Custom { tool_change: lines, ..Custom::default() },
            };
            let program = Program { custom, ..Program::plain(MM) };
            let text = with(dialect, &program).unwrap().text;
            assert!(text.contains(line) && !text.contains(words), "{} {line}\n{text}", dialect.name);
            let (_, asked, _) = cases().into_iter().find(|(other, ..)| *other == dialect).unwrap();
            let error = with(dialect, &Program { smoothing: Some(asked), ..program }).unwrap_err();
            let WriteError::SmoothedTwice(own) = &error else { panic!("{error}") };
            assert_eq!((own.part, own.index, own.line.as_str()), (part, 0, line));
            assert!(error.to_string().contains(line), "{error}");
        }
    }
}

/// Comments and texts choose nothing, and behind the last motion no line does.
#[test]
fn other_lines_leave_the_smoothing_to_the_program() {
    for (dialect, line, words) in [
        (&LINUXCNC, "(G64 P0.05)", "G64 P0.001"),
        (&SIEMENS, "MSG(\"CYCLE832\") ; G642", "G641 ADIS=0.001"),
        (&FANUC, "(G5.1 Q1)", "G17"),
    ] {
        let header = vec![line.to_owned()];
        let custom = Custom { header, footer: vec!["M1".to_owned()], ..Custom::default() };
        let text = with(dialect, &Program { custom, ..Program::plain(MM) }).unwrap().text;
        assert!(text.contains(words), "{text}");
    }
}
