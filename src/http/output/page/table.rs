//! Any JSON value as a table of bounded size.

use serde_json::{Map, Value};

use super::label::Label;
use super::number;
use crate::plot::text::{clean, escape};

/// Longer lists are told by their length.
const LONGEST_LIST: usize = 4;
const LONGEST_TABLE: usize = 40;
/// Members of an object beyond this are told by their number.
const MOST_MEMBERS: usize = 60;
const DEEPEST: usize = 3;
const LONGEST_TEXT: usize = 500;

/// `value` as a table; empty for what has nothing in it.
pub fn table(name: &str, value: &Value) -> String {
    let label = Label::of(name);
    let rows = match value {
        Value::Object(members) => members_as_rows(members, label.unit, 0),
        Value::Array(items) if items.is_empty() => String::new(),
        Value::Array(items) => as_grid(items).unwrap_or_else(|| row(&label, value)),
        Value::Null => String::new(),
        _ => row(&label, value),
    };
    wrap(&rows)
}

/// An object of texts under names that are not to be read.
pub fn verbatim(value: &Value) -> String {
    let members = value.as_object().into_iter().flatten().take(MOST_MEMBERS);
    let rows = members.map(|(name, value)| {
        let label = Label { words: show_text(name), unit: None, is_bound: false };
        row(&label, value)
    });
    wrap(&rows.collect::<String>())
}

fn wrap(rows: &str) -> String {
    if rows.is_empty() { String::new() } else { format!("<table>\n{rows}</table>\n") }
}

/// A row for each member; after them each object among them, as a heading and its own rows.
fn members_as_rows(members: &Map<String, Value>, unit: Option<&'static str>, depth: usize) -> String {
    let mut rows = String::new();
    let mut shown: Vec<_> = members.iter().take(MOST_MEMBERS).collect();
    // Below a heading stand its own rows alone; and of a box, the least comes first.
    shown.sort_by_key(|(name, value)| (value.is_object() || is_grid(value), *name == "max"));
    for (name, value) in shown {
        let mut label = Label::of(name);
        label.unit = label.unit.or(unit);
        rows += &match value {
            Value::Object(inner) if depth < DEEPEST && !inner.is_empty() => {
                heading(&label.words) + &members_as_rows(inner, label.unit, depth + 1)
            }
            Value::Array(items) => match as_grid(items) {
                Some(grid) => {
                    format!("{}<tr><td colspan=\"2\">{}</td></tr>\n", heading(&label.words), wrap(&grid))
                }
                None => row(&label, value),
            },
            _ => row(&label, value),
        };
    }
    if members.len() > MOST_MEMBERS {
        rows += &heading(&format!("and {} more", members.len() - MOST_MEMBERS));
    }
    rows
}

fn heading(words: &str) -> String {
    format!("<tr class=\"group\"><th colspan=\"2\">{words}</th></tr>\n")
}

fn row(label: &Label, value: &Value) -> String {
    format!("<tr><th>{}</th><td>{}</td></tr>\n", label.words, cell(value, label))
}

fn is_grid(value: &Value) -> bool {
    value.get(0).is_some_and(Value::is_object)
}

/// A list of like objects: a column for each member of the first.
fn as_grid(items: &[Value]) -> Option<String> {
    let first = items.first()?.as_object()?;
    let columns: Vec<(&String, Label)> =
        first.keys().take(MOST_MEMBERS).map(|name| (name, Label::of(name))).collect();
    let head: String = columns.iter().map(|(_, label)| format!("<th>{}</th>", label.words)).collect();
    let mut rows = format!("<tr>{head}</tr>\n");
    for item in items.iter().take(LONGEST_TABLE) {
        let cells = columns.iter().map(|(name, label)| {
            format!("<td>{}</td>", item.get(*name).map_or(String::new(), |value| cell(value, label)))
        });
        rows += &format!("<tr>{}</tr>\n", cells.collect::<String>());
    }
    if items.len() > LONGEST_TABLE {
        let more = items.len() - LONGEST_TABLE;
        rows += &format!("<tr><td colspan=\"{}\">and {more} more</td></tr>\n", columns.len().max(1));
    }
    Some(rows)
}

/// A value on one line.
fn cell(value: &Value, label: &Label) -> String {
    let with_unit = |text: String| match label.unit {
        // Seconds come with their unit.
        Some(unit) if !text.ends_with(')') => format!("{text} {unit}"),
        _ => text,
    };
    match value {
        Value::Null => "\u{2013}".into(),
        Value::Bool(is_true) => if *is_true { "yes" } else { "no" }.into(),
        Value::Number(number) => with_unit(number::show(number, label)),
        Value::String(text) => show_text(text),
        Value::Array(items) => match numbers(items, label) {
            Some(text) => with_unit(text),
            None => format!("{} entries", items.len()),
        },
        Value::Object(members) => format!("{} members", members.len()),
    }
}

/// A short list of numbers, such as a point.
fn numbers(items: &[Value], label: &Label) -> Option<String> {
    let is_short = !items.is_empty() && items.len() <= LONGEST_LIST;
    let show = |item: &Value| Some(number::show(item.as_number()?, label));
    let texts: Option<Vec<String>> = if is_short { items.iter().map(show).collect() } else { None };
    texts.map(|texts| texts.join(", "))
}

fn show_text(text: &str) -> String {
    let text = clean(text);
    match text.char_indices().nth(LONGEST_TEXT) {
        Some((end, _)) => format!("{}\u{2026}", escape(&text[..end])),
        None => escape(&text),
    }
}
