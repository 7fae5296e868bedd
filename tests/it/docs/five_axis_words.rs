//! `docs/five-axis-programs.md` shows the tables of words by which the readers of five-axis programs work.

use toolpathd_post::path_text::table::Row;
use toolpathd_post::path_text::{cl, nc};

use super::page::read;

/// A table as the page shows it.
fn shown(rows: &[Row]) -> String {
    let mut lines = vec!["| words | treatment | example | what happens, or what to do |".to_owned()];
    lines.push("|---|---|---|---|".to_owned());
    for row in rows {
        let words: Vec<String> = row.each().map(|word| format!("`{}`", word.replace('|', "\\|"))).collect();
        let treatment = row.treatment.name();
        lines.push(format!("| {} | {treatment} | `{}` | {} |", words.join(" "), row.example, row.says));
    }
    lines.join("\n")
}

#[test]
fn the_page_of_five_axis_programs_shows_the_tables_of_the_readers() {
    let page = read("docs/five-axis-programs.md");
    let mut tables = vec![("CL data", cl::WORDS)];
    tables.extend_from_slice(nc::TABLES);
    for (name, rows) in tables {
        let mark = format!("<!-- words of {name} -->");
        let (_, rest) = page.split_once(&mark).unwrap_or_else(|| panic!("the page lacks {mark}"));
        let own: Vec<&str> = rest.trim_start().lines().take_while(|line| line.starts_with('|')).collect();
        let expected = shown(rows);
        assert_eq!(own.join("\n"), expected, "the table at {mark} has to be:\n{expected}\n");
    }
}
