//! `docs/api.md` has a section for every operation of the committed contract.

use serde_json::Value;

use super::page::read;

const PAGE: &str = "docs/api.md";

pub fn contract() -> Value {
    serde_json::from_str(&read("openapi/openapi.json")).expect("the contract is JSON")
}

#[test]
fn every_operation_has_a_section_with_a_curl_command() {
    let (page, document) = (read(PAGE), contract());
    for (method, path, _) in operations(&document) {
        let title = format!("## `{method} {path}`\n");
        let start =
            page.find(&title).unwrap_or_else(|| panic!("{PAGE} lacks the section `{}`", title.trim()));
        let section = &page[start + title.len()..];
        let section = section.split("\n## ").next().unwrap_or(section);
        assert!(section.contains("curl "), "{PAGE}: the section of {method} {path} shows no curl command");
    }
}

/// The method, the path and the description of each operation.
pub fn operations(document: &Value) -> impl Iterator<Item = (String, &String, &Value)> {
    let paths = document["paths"].as_object().expect("paths").iter();
    paths.flat_map(|(path, item)| {
        let operations = item.as_object().expect("operations").iter();
        operations.map(move |(method, operation)| (method.to_uppercase(), path, operation))
    })
}
