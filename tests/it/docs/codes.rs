//! `docs/api.md` explains every code that a caller may get, and `docs/operations.md` every setting.

use std::collections::BTreeSet;

use clap::CommandFactory;
use serde_json::Value;
use toolpathd_server::config::Cli;

use super::operations::contract;
use super::page::read;

/// The names in the first column of the table after the line `mark`.
fn first_cells(page: &str, mark: &str) -> BTreeSet<String> {
    let (_, rest) = page.split_once(mark).unwrap_or_else(|| panic!("the page lacks the mark {mark}"));
    let rows = rest.trim_start().lines().take_while(|line| line.starts_with('|')).skip(2);
    let cell = |row: &str| {
        row.split('`')
            .nth(1)
            .unwrap_or_else(|| panic!("the first cell of this row holds no name: {row}"))
            .to_owned()
    };
    rows.map(cell).collect()
}

fn names(values: &Value) -> BTreeSet<String> {
    values.as_array().expect("names").iter().map(|name| name.as_str().expect("a name").to_owned()).collect()
}

#[test]
fn the_api_page_explains_every_code() {
    let (page, document) = (read("docs/api.md"), contract());
    let schemas = &document["components"]["schemas"];
    for (mark, codes) in [
        ("<!-- codes of problems -->", &schemas["ProblemCode"]["enum"]),
        ("<!-- codes of places -->", &schemas["FieldCode"]["enum"]),
        ("<!-- codes of warnings -->", &schemas["WarningCode"]["enum"]),
    ] {
        assert_eq!(
            first_cells(&page, mark),
            names(codes),
            "the table at {mark} lists other codes than the contract"
        );
    }
}

#[test]
fn the_operations_page_explains_every_setting_with_its_default() {
    let page = read("docs/operations.md");
    let (_, rest) = page.split_once("<!-- settings -->").expect("the settings");
    let rows: Vec<&str> =
        rest.trim_start().lines().take_while(|line| line.starts_with('|')).skip(2).collect();
    let command = Cli::command();
    let flags: Vec<_> = command
        .get_arguments()
        .filter(|flag| !["help", "version"].contains(&flag.get_id().as_str()))
        .collect();
    assert_eq!(rows.len(), flags.len(), "the table has other settings than the command line");
    for flag in flags {
        let name = format!("`--{}`", flag.get_long().expect("a name"));
        let row =
            rows.iter().find(|row| row.contains(&name)).unwrap_or_else(|| panic!("{name} is not explained"));
        for default in flag.get_default_values() {
            let default = format!("| {} |", default.to_str().expect("UTF-8"));
            assert!(row.contains(&default), "the row of {name} lacks the default {default}");
        }
    }
}
