//! The tables of fields in `docs/api.md` match the committed contract.
//!
//! A line `<!-- request fields of Tool at tool -->` begins a table and `<!-- end -->` ends it.
//! `UPDATE_DOCS=1 cargo test docs` writes the tables instead of comparing them.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;

use serde_json::{Map, Value};

use super::page::{headings, read, root};
use super::schema::{Contract, is_tagged_union};

const PAGE: &str = "docs/api.md";
const END: &str = "<!-- end -->";

/// Beginning of the names of the schemas for answers of computations. These schemas differ in `report` alone;
/// the page shows their other members once.
const ANSWER: &str = "Answer_";

/// The meaning that the page gives for the member `report`. Each endpoint has another object there.
const REPORT: &str = "What the operation found; each endpoint has its own report.";

pub fn contract() -> Value {
    serde_json::from_str(&read("openapi/openapi.json")).expect("the contract is JSON")
}

/// The kind of table between two marks.
#[derive(Debug, PartialEq, Eq)]
enum Table<'a> {
    /// The fields of an object in a request. `at` is the path of the object in the body.
    Request { schema: &'a str, at: &'a str },
    /// The fields of an object in an answer.
    Answer { schema: &'a str, at: &'a str },
    /// The objects of a union, by their `kind`.
    Kinds { schema: &'a str },
    /// The description of a schema, as text.
    Meaning { schema: &'a str },
    /// The query parameters of an operation.
    Query { method: &'a str, path: &'a str },
}

impl<'a> Table<'a> {
    /// The table that a line of the page begins, if the line is a mark.
    fn of(line: &'a str) -> Option<Self> {
        let mark = line.strip_prefix("<!-- ")?.strip_suffix(" -->")?;
        let words: Vec<&str> = mark.split(' ').collect();
        Some(match words[..] {
            ["request", "fields", "of", schema] => Self::Request { schema, at: "" },
            ["request", "fields", "of", schema, "at", at] => Self::Request { schema, at },
            ["answer", "fields", "of", schema] => Self::Answer { schema, at: "" },
            ["answer", "fields", "of", schema, "at", at] => Self::Answer { schema, at },
            ["kinds", "of", schema] => Self::Kinds { schema },
            ["meaning", "of", schema] => Self::Meaning { schema },
            ["query", "of", method, path] => Self::Query { method, path },
            _ => return None,
        })
    }

    fn schema(&self) -> Option<&'a str> {
        match self {
            Self::Request { schema, .. }
            | Self::Answer { schema, .. }
            | Self::Kinds { schema }
            | Self::Meaning { schema } => Some(schema),
            Self::Query { .. } => None,
        }
    }
}

#[test]
fn the_field_tables_of_the_api_page_match_the_contract() {
    let (page, document) = (read(PAGE), contract());
    let written = with_tables(&page, &document);
    if std::env::var_os("UPDATE_DOCS").is_some() {
        return fs::write(root().join(PAGE), written).expect("the page can be written");
    }
    let differs = page.lines().zip(written.lines()).position(|(is, should)| is != should);
    assert!(
        page == written,
        "{PAGE}:{}: the table differs from the contract; run `UPDATE_DOCS=1 cargo test --test it docs`",
        differs.map_or(0, |index| index + 1)
    );
}

#[test]
fn every_object_of_requests_and_answers_has_a_table_in_the_api_page() {
    let (page, document) = (read(PAGE), contract());
    let contract = of_page(&page, &document);
    let mut open = BTreeSet::new();
    for (_, _, operation) in operations(&document) {
        gather(&operation["requestBody"], &mut open);
        gather(&operation["responses"], &mut open);
    }
    let mut reached = BTreeSet::new();
    while let Some(name) = open.pop_first() {
        if reached.insert(name.clone()) {
            gather(contract.component(&name), &mut open);
        }
    }
    let needs_table = |name: &String| {
        let schema = contract.component(name);
        let is_answer = name.starts_with(ANSWER) && name != "Answer_MillReport";
        !is_answer
            && (schema.get("properties").is_some() || (is_tagged_union(schema) && !is_any_report(schema)))
    };
    let missing: Vec<_> =
        reached.iter().filter(|name| needs_table(name) && !contract.headings.contains_key(*name)).collect();
    assert!(missing.is_empty(), "{PAGE} has no table for {missing:?}");
    let reports: Vec<_> = contract.schemas.keys().filter(|name| name.ends_with("Report")).collect();
    let untold = |name: &&&String| !name.starts_with("Any") && !name.starts_with(ANSWER);
    let untold: Vec<_> =
        reports.iter().filter(untold).filter(|name| !contract.headings.contains_key(**name)).collect();
    assert!(untold.is_empty(), "{PAGE} has no table for {untold:?}");
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

#[test]
fn the_table_of_answers_has_every_member_of_every_answer() {
    let document = contract();
    let answers = document["components"]["schemas"].as_object().expect("schemas");
    let members = |schema: &Value| {
        let mut members = schema["properties"].as_object().expect("members").clone();
        members.remove("report");
        members
    };
    let answers: Vec<_> = answers.iter().filter(|(name, _)| name.starts_with(ANSWER)).collect();
    assert!(answers.len() >= 6, "only {} schemas of answers were found", answers.len());
    let in_table = members(&document["components"]["schemas"]["Answer_MillReport"]);
    let page = read(PAGE);
    for (name, schema) in &answers {
        for (member, meaning) in members(schema) {
            // A list that one operation alone answers has a table in the section of the operation.
            if page.contains(&format!(" at {member}[] -->")) && !in_table.contains_key(&member) {
                continue;
            }
            assert_eq!(
                Some(&meaning),
                in_table.get(&member),
                "{name}.{member} differs from the table or is not in it"
            );
        }
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

/// Whether a schema is a choice of reports. These objects have no `kind`.
fn is_any_report(schema: &Value) -> bool {
    let kinds = schema["oneOf"].as_array().into_iter().flatten();
    kinds.filter_map(|kind| kind["$ref"].as_str()).all(|name| name.ends_with("Report"))
}

/// Adds the names of all schemas that `value` refers to.
fn gather(value: &Value, names: &mut BTreeSet<String>) {
    match value {
        Value::Object(members) => {
            let path = members.get("$ref").and_then(Value::as_str);
            names.extend(path.and_then(|path| path.strip_prefix("#/components/schemas/")).map(str::to_owned));
            members.values().for_each(|member| gather(member, names));
        }
        Value::Array(items) => items.iter().for_each(|item| gather(item, names)),
        _ => {}
    }
}

/// The contract, with the heading of `page` above the table of each schema.
fn of_page<'a>(page: &str, document: &'a Value) -> Contract<'a> {
    let headings = headings(page);
    let mut by_schema = BTreeMap::new();
    for (index, line) in page.lines().enumerate() {
        if let Some(schema) = Table::of(line).and_then(|table| table.schema()) {
            let above = headings.iter().rev().find(|(at, _)| *at < index);
            let (_, heading) =
                above.unwrap_or_else(|| panic!("the table of {schema} has no heading above it"));
            by_schema.entry(schema.to_owned()).or_insert_with(|| (*heading).to_owned());
        }
    }
    let schemas = document["components"]["schemas"].as_object().expect("schemas");
    Contract { schemas, headings: by_schema }
}

/// `page` with the tables that its marks ask for.
fn with_tables(page: &str, document: &Value) -> String {
    let contract = of_page(page, document);
    let mut out = String::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        out.push_str(line);
        out.push('\n');
        if let Some(table) = Table::of(line) {
            assert!(lines.any(|line| line == END), "the table {line} has no end mark");
            out.push_str(&format!("\n{}\n{END}\n", render(&table, &contract, document)));
        } else {
            assert!(!line.starts_with("<!-- ") || line.contains(" codes of "), "{line} is not a known mark");
        }
    }
    out
}

fn render(table: &Table<'_>, contract: &Contract<'_>, document: &Value) -> String {
    match *table {
        Table::Request { schema, at } => {
            let mut rows = Vec::new();
            fields(contract, contract.component(schema), at, true, &mut rows);
            markdown(&["field", "type", "unit", "default", "meaning"], &rows)
        }
        Table::Answer { schema, at } => {
            let mut rows = Vec::new();
            fields(contract, contract.component(schema), at, false, &mut rows);
            markdown(&["field", "type", "unit", "meaning"], &rows)
        }
        Table::Kinds { schema } => {
            let kinds = contract.component(schema)["oneOf"].as_array().expect("kinds").iter();
            let rows = kinds.map(|kind| {
                let field = contract.field(kind);
                let name = contract.type_of(&field, false);
                let (_, meaning) = contract.default_and_meaning(&field, true);
                vec![name, first_paragraph(kind, contract).unwrap_or(meaning)]
            });
            markdown(&["kind", "meaning"], &rows.collect::<Vec<_>>())
        }
        Table::Meaning { schema } => {
            let words = contract.component(schema)["description"].as_str().expect("a description");
            words.split("\n\n").map(joined).collect::<Vec<_>>().join("\n\n") + "\n"
        }
        Table::Query { method, path } => {
            let operation = &document["paths"][path][method.to_lowercase()];
            let parameters = operation["parameters"].as_array().expect("parameters").iter();
            let rows = parameters.map(|parameter| {
                let mut schema = parameter["schema"].clone();
                let own = joined(schema["description"].as_str().unwrap_or_default());
                let said = joined(parameter["description"].as_str().unwrap_or_default());
                // A parameter without a description has the description of its type.
                schema["description"] = if said.is_empty() { own } else { said }.into();
                let name = parameter["name"].as_str().expect("a name");
                let field = contract.field(&schema);
                let (default, meaning) = contract.default_and_meaning(&field, parameter["required"] == true);
                vec![
                    format!("`{name}`"),
                    contract.type_of(&field, true),
                    contract.unit_of(name, &field).to_owned(),
                    default,
                    meaning,
                ]
            });
            markdown(&["parameter", "type", "unit", "default", "meaning"], &rows.collect::<Vec<_>>())
        }
    }
}

/// The first paragraph of the description of a kind's own schema.
fn first_paragraph(kind: &Value, contract: &Contract<'_>) -> Option<String> {
    let name = kind["$ref"].as_str()?.rsplit('/').next()?;
    let words = contract.component(name)["description"].as_str()?;
    words.split("\n\n").next().map(joined)
}

/// Appends the rows of an object's fields: required fields first, then the others, in the order of the
/// contract.
fn fields(contract: &Contract<'_>, object: &Value, at: &str, is_request: bool, rows: &mut Vec<Vec<String>>) {
    let properties = object["properties"].as_object().expect("an object has properties");
    let required: Vec<&str> =
        object["required"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
    for name in in_order(properties, &required) {
        let field = contract.field(&properties[name]);
        let path = if at.is_empty() { name.to_owned() } else { format!("{at}.{name}") };
        let is_required = required.contains(&name);
        let (default, meaning) = contract.default_and_meaning(&field, is_required || !is_request);
        let kind = contract.type_of(&field, is_request);
        let (kind, meaning) = match name {
            "report" => ("object".to_owned(), REPORT.to_owned()),
            _ => (kind, meaning),
        };
        let or_nothing = match () {
            () if is_request || !field.is_nullable => "",
            () if field.is_left_out() => ", or absent",
            () => " or `null`",
        };
        let unit = contract.unit_of(name, &field).to_owned();
        let mut row = vec![format!("`{path}`"), format!("{kind}{or_nothing}"), unit];
        row.extend(is_request.then_some(default));
        row.push(meaning);
        rows.push(row);
        if let Some(inner) = field.inline_object()
            && name != "report"
        {
            fields(contract, inner, &path, is_request, rows);
        }
    }
}

fn in_order<'a>(properties: &'a Map<String, Value>, required: &[&'a str]) -> Vec<&'a str> {
    let optional = properties.keys().map(String::as_str).filter(|name| !required.contains(name));
    required.iter().copied().chain(optional).collect()
}

/// The words of a text on one line.
fn joined(words: &str) -> String {
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

fn markdown(head: &[&str], rows: &[Vec<String>]) -> String {
    let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
    let head: Vec<String> = head.iter().map(|&name| name.to_owned()).collect();
    let rule = format!("|{}\n", "---|".repeat(head.len()));
    let rows =
        rows.iter().map(|row| line(&row.iter().map(|cell| cell.replace('|', "\\|")).collect::<Vec<_>>()));
    line(&head) + &rule + &rows.collect::<String>()
}
