//! The tables of words tell what the readers do: the example of each row is read, left alone or refused.

use super::table::{Row, Treatment};
use super::{PathFault, PathText, PathTextError, ReadSettings, cl, nc};
use toolpathd_core::machine::Straying;
use toolpathd_core::machine::named::by_name;

fn reading() -> ReadSettings {
    ReadSettings { feed: None, limit: 1000, chords: Straying { tip_mm: 0.001, axis: 1e-4 } }
}

/// Each word of a row in place of the first word of its example.
fn examples(row: &Row) -> impl Iterator<Item = (&'static str, String)> {
    let first = row.each().next().unwrap_or_default();
    let first = first.strip_suffix(" X").unwrap_or(first);
    assert!(row.example.contains(first), "{first} is not in its example");
    row.each()
        .map(move |word| (word, row.example.replacen(first, word.strip_suffix(" X").unwrap_or(word), 1)))
}

/// What is wrong with how a reader treats the word of a line.
fn wrong(
    row: &Row,
    word: &str,
    line: usize,
    read: Result<PathText, PathTextError>,
    text: &str,
) -> Option<String> {
    let is_right = match (row.treatment, &read) {
        (Treatment::Read, Ok(read)) => read.left_alone.iter().all(|left| left.word != word),
        (Treatment::LeftAlone, Ok(read)) => {
            let own = read.left_alone.iter().find(|left| left.word == word);
            own.is_some_and(|own| (own.count, own.line) == (1, line))
        }
        (Treatment::Refused, Err(error)) => {
            let is_named = matches!(error.fault, PathFault::Refused { advice, .. } if advice == row.says);
            error.line == line && is_named
        }
        _ => false,
    };
    (!is_right).then(|| format!("{word} is not {} in {text:?}: {read:?}", row.treatment.name()))
}

#[test]
fn each_word_of_cl_data_is_treated_as_its_row_tells() {
    let mut all = Vec::new();
    for row in cl::WORDS {
        for (word, example) in examples(row) {
            let text =
                format!("FEDRAT/500\nSPINDL/1000,RPM\nGOTO/0,0,50\nGOTO/0,0,0\nINDIRV/0,1,0\n{example}\n");
            // The first point is no cut, so that a speed or a tool may follow.
            let text = if ["SPINDL", "COOLNT", "FROM"].contains(&word)
                || word.contains("TOOL")
                || word == "LOADTL"
            {
                format!("\n\n\n\n\n{example}\n")
            } else {
                text
            };
            all.extend(wrong(row, word, 6, cl::read(&text, reading()), &text));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn each_word_of_nc_programs_is_treated_as_its_row_tells() {
    let machine = by_name("table_table_ac");
    let mut all = Vec::new();
    for row in nc::TABLES.iter().flat_map(|(_, rows)| rows.iter()) {
        for (word, example) in examples(row) {
            // Letters of axes that this machine lacks are tested beside others.
            if word == "B" {
                continue;
            }
            let is_klartext = ["L ", "LN", "CC", "TOOL", "BLK", "CYCL ", "FUNC", "BEGIN", "PLANE R", "STOP"]
                .iter()
                .any(|start| example.starts_with(start));
            let start = if is_klartext { "BEGIN PGM 1 MM" } else { "G21 G90 G94" };
            let mode = if ["I", "J", "K"].contains(&word) { "G43.5" } else { "" };
            let text = format!("{start}\nF500\nT1\nG0 X0 Y0 Z0 A0 C0\n{mode}\n{example}\n");
            let text = match word {
                "T" | "M6" | "G54" | "G55" | "G56" | "G57" | "G58" | "G59" | "O" => {
                    format!("\n\n\n\n\n{example}\n")
                }
                "G54.1" | "G59.1" | "G59.2" | "G59.3" | "G500" => format!("\n\n\n\n\n{example}\n"),
                "I" | "J" | "K" => "F500\nG0 X0 Y0 Z0\n\n\n\nG2 X2 Y0 I1 J0 K0\n".to_owned(),
                _ => text,
            };
            all.extend(wrong(row, word, 6, nc::read(&text, machine.as_ref(), 50.0, reading()), &text));
        }
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn no_word_stands_in_two_rows() {
    let tables = nc::TABLES.iter().map(|(_, rows)| *rows);
    for rows in [vec![cl::WORDS], tables.collect()] {
        let mut words: Vec<_> = rows.into_iter().flatten().flat_map(Row::each).collect();
        let count = words.len();
        words.sort_unstable();
        words.dedup();
        assert_eq!(words.len(), count);
    }
}
