//! The README is short, and its table of endpoints matches the contract.

use std::collections::{BTreeMap, BTreeSet};

use serde_json::Value;

use super::operations::{contract, operations};
use super::page::{blocks, read};

/// Most words of the README, as `wc -w` counts them.
const MOST_WORDS: usize = 1000;

/// The media types of answers, each with its word in the table.
const FORMS: &[(&str, &str)] = &[
    ("application/json", "JSON"),
    ("text/x-gcode", "NC text"),
    ("image/svg+xml", "SVG"),
    ("text/html", "HTML"),
    ("model/gltf-binary", "glTF"),
    ("model/stl", "STL"),
    ("text/event-stream", "events"),
    ("text/plain", "text"),
    ("application/openmetrics-text", "text"),
];

/// Endpoints that the README lists and the contract does not hold.
const PAGES: &[&str] = &["GET /docs", "GET /"];

#[test]
fn the_readme_has_at_most_a_thousand_words() {
    let words = read("README.md").split_whitespace().count();
    assert!(words <= MOST_WORDS, "README.md has {words} words, at most {MOST_WORDS} are allowed");
}

#[test]
fn the_first_commands_of_the_readme_are_cargo_run_and_cargo_test() {
    let blocks = blocks(&read("README.md"));
    let commands = blocks[0].text.lines().map(|line| line.split('#').next().unwrap_or(line).trim());
    assert_eq!(commands.collect::<Vec<_>>(), ["cargo run --release", "cargo test"]);
}

#[test]
fn the_readme_lists_every_endpoint_with_every_form_of_its_answer() {
    let readme = read("README.md");
    let mut listed = BTreeMap::new();
    for line in readme.lines().filter(|line| line.starts_with("| `")) {
        let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
        let (endpoint, forms) = (cells[0], cells[cells.len() - 1].trim_end_matches('|').trim());
        for name in endpoint.split(", ").map(|name| name.trim_matches('`')) {
            let forms: BTreeSet<&str> = forms.split(", ").collect();
            assert_eq!(listed.insert(name.to_owned(), forms), None, "{name} is listed twice");
        }
    }
    PAGES.iter().for_each(|name| assert!(listed.remove(*name).is_some(), "{name} is not listed"));
    let document = contract();
    let offered: BTreeMap<String, BTreeSet<&str>> = operations(&document)
        .map(|(method, path, operation)| (format!("{method} {path}"), forms(operation)))
        .collect();
    assert_eq!(listed, offered, "the README lists other endpoints or forms than the contract");
}

/// The forms of the answer with status 200, by their words in the table.
fn forms(operation: &Value) -> BTreeSet<&'static str> {
    let content = operation["responses"]["200"]["content"].as_object().expect("forms");
    let has_nc = content.contains_key("text/x-gcode");
    // These are other names of the media type for programs; the table shows only one.
    let is_other_name =
        |name: &str| has_nc && ["text/plain", "text/x.gcode", "application/x-gcode"].contains(&name);
    let names = content.keys().filter(|name| !is_other_name(name));
    names
        .map(|name| {
            FORMS
                .iter()
                .find(|(media_type, _)| media_type == name)
                .unwrap_or_else(|| panic!("{name} has no word in the table"))
                .1
        })
        .collect()
}
