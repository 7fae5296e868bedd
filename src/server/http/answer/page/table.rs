//! Shows any JSON value as a table of limited size.

use serde_json::{Map, Value};

use super::label::Label;
use super::number;
use toolpathd_plot::text::{clean, escape};

/// Most numbers of a list that are shown. Of a longer list only the length is shown.
const LONGEST_LIST: usize = 4;
/// Most rows of a table. The last row tells how many rows are left out.
const LONGEST_TABLE: usize = 40;
/// Most rows of a table within a row, and most rows that have such tables.
const LONGEST_INNER: usize = 12;
const MOST_WITH_INNER: usize = 12;
/// Most members of an object that are shown. A last row tells how many members are left out.
const MOST_MEMBERS: usize = 60;
/// Most levels of objects within objects. Of a deeper object only the number of members is shown.
const DEEPEST: usize = 3;
/// Most characters of a text. A longer text ends in an ellipsis.
const LONGEST_TEXT: usize = 500;

/// `value` as a table. Empty for an empty value.
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

/// An object of texts as a table. Its names are shown unchanged, not turned into words.
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

/// A row for each plain member. Then each member that is an object or a table follows, with a heading.
fn members_as_rows(members: &Map<String, Value>, unit: Option<&'static str>, depth: usize) -> String {
    let mut rows = String::new();
    let mut shown: Vec<_> = members.iter().take(MOST_MEMBERS).collect();
    // Plain members come first, so that below a heading only its own rows stand. In a box `min` precedes
    // `max`.
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

/// A list of objects as rows, with a column for each plain member. Tables within an
/// object follow below its row. `None` for other lists.
fn as_grid(items: &[Value]) -> Option<String> {
    let names = names(items)?;
    let is_inner = |name: &str| items.iter().any(|item| item.get(name).is_some_and(is_grid));
    let counts_another = |name: &str| name.strip_prefix("n_").is_some_and(is_inner);
    let (inner, plain): (Vec<_>, Vec<_>) = names
        .into_iter()
        .filter(|name| !counts_another(name))
        .map(|name| (name, Label::of(name)))
        .partition(|(name, _)| is_inner(name));
    let mut rows = head(plain.iter().map(|(_, label)| label));
    let width = plain.len().max(1);
    for (k, item) in items.iter().take(LONGEST_TABLE).enumerate() {
        let shown = |name: &str, label: &Label| {
            item.get(name).map_or(String::new(), |value| cell_of_column(value, label))
        };
        let cells = plain.iter().map(|(name, label)| format!("<td>{}</td>", shown(name, label)));
        rows += &format!("<tr>{}</tr>\n", cells.collect::<String>());
        for (name, label) in &inner {
            let list = item.get(*name).and_then(Value::as_array);
            let table = list.filter(|_| k < MOST_WITH_INNER).and_then(|list| as_plain_grid(list));
            let content = match table {
                Some(table) => format!("{}{}", label.words, wrap(&table)),
                None => format!("{}: {}", label.words, shown(name, label)),
            };
            rows += &format!("<tr class=\"inner\"><td colspan=\"{width}\">{content}</td></tr>\n");
        }
    }
    Some(rows + &left_out(items.len(), LONGEST_TABLE, width))
}

/// A list of objects as rows, of which lists are told by their lengths.
fn as_plain_grid(items: &[Value]) -> Option<String> {
    let columns: Vec<(&str, Label)> = names(items)?.into_iter().map(|name| (name, Label::of(name))).collect();
    let mut rows = head(columns.iter().map(|(_, label)| label));
    for item in items.iter().take(LONGEST_INNER) {
        let cells = columns.iter().map(|(name, label)| {
            format!(
                "<td>{}</td>",
                item.get(*name).map_or(String::new(), |value| cell_of_column(value, label))
            )
        });
        rows += &format!("<tr>{}</tr>\n", cells.collect::<String>());
    }
    Some(rows + &left_out(items.len(), LONGEST_INNER, columns.len()))
}

/// The names of the members of objects, in the order in which they come. `None` for other lists.
fn names(items: &[Value]) -> Option<Vec<&str>> {
    items.first()?.as_object()?;
    let mut names: Vec<&str> = Vec::new();
    for name in items.iter().take(LONGEST_TABLE).filter_map(Value::as_object).flat_map(Map::keys) {
        if names.len() < MOST_MEMBERS && !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    Some(names)
}

/// The first row of a list of objects: the names with their units.
fn head<'a>(labels: impl Iterator<Item = &'a Label>) -> String {
    let unit = |label: &Label| label.unit.map_or(String::new(), |unit| format!(", {unit}"));
    let cells = labels.map(|label| format!("<th>{}{}</th>", label.words, unit(label)));
    format!("<tr>{}</tr>\n", cells.collect::<String>())
}

/// A value below a name with its unit.
fn cell_of_column(value: &Value, label: &Label) -> String {
    match value {
        Value::Number(number) => number::short(number, label),
        _ => cell(value, &Label { unit: None, ..label.clone() }),
    }
}

/// The last row of a table of `count` rows that has only `most` of them.
fn left_out(count: usize, most: usize, width: usize) -> String {
    if count <= most {
        return String::new();
    }
    format!("<tr><td colspan=\"{}\">and {} more</td></tr>\n", width.max(1), count - most)
}

/// A value as the text of one cell.
fn cell(value: &Value, label: &Label) -> String {
    let with_unit = |text: String| match label.unit {
        // A time in seconds already has its unit and ends in h:mm:ss in parentheses.
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
            None if items.is_empty() => "none".into(),
            None => format!("{} entries", items.len()),
        },
        Value::Object(members) => format!("{} members", members.len()),
    }
}

/// A short list of numbers, such as a point, as text. `None` for other lists.
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

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn tables_within_rows_stand_below_them_and_their_counts_are_left_out() {
        let level = json!({
            "z_mm": -5.0, "n_islands": 2, "islands": [{"area_mm2": 4.0}, {"area_mm2": 9.5}], "not_reached": []
        });
        let text = table("levels", &json!([level]));
        let expected = "<table>\n<tr><th>not reached</th><th>z, mm</th></tr>\n<tr><td>none</td><td>-5</td></tr>\n\
            <tr class=\"inner\"><td colspan=\"2\">islands<table>\n<tr><th>area, mm\u{b2}</th></tr>\n\
            <tr><td>4</td></tr>\n<tr><td>9.5</td></tr>\n</table>\n</td></tr>\n</table>\n";
        assert_eq!(text, expected);
        let text = table("candidates", &json!([{"a": 1}, {"a": 2, "invalid_because": "it gouges"}]));
        assert!(text.contains("<th>invalid because</th>") && text.contains("it gouges"), "{text}");
        let long: Vec<Value> = (0..30).map(|k| json!({"a": k})).collect();
        let rows: Vec<Value> = (0..30).map(|_| json!({"z_mm": 1.0, "inner": long})).collect();
        let text = table("levels", &json!(rows));
        assert!(text.contains("and 18 more") && text.contains("inner: 30 entries") && text.len() < 20_000);
    }
}
