//! An answer as one self-contained HTML page: the picture, and the members of the JSON answer as tables.
//!
//! The page loads no other file: no script, no font, no style sheet. In print the picture is alone on a sheet
//! and keeps its scale; the tables follow on further sheets.

mod label;
mod number;
mod table;

use serde_json::Value;

use toolpathd_plot::text::{clean, escape};

const STYLE: &str = include_str!("page/style.css");

/// Members of an answer that come first, in this order.
const FIRST: [&str; 4] = ["meta", "warnings", "report", "measures"];
/// Members that are not shown as tables: the footer shows the first one, the picture shows the toolpath, and
/// NC text has a form of its own.
const NOT_TABLES: [&str; 3] = ["engine_version", "toolpath", "nc"];

/// The page of `answer`. `svg` goes into the page unchanged.
pub fn page(title: &str, svg: &str, answer: &Value) -> String {
    let title = escape(&clean(title));
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <header><h1>{title}</h1></header>\n<main>\n<figure>\n{svg}</figure>\n\
         <p class=\"again\" aria-hidden=\"true\">{title}</p>\n<div class=\"tables\">\n{}</div>\n</main>\n{}\
         </body>\n</html>\n",
        sections(answer),
        footer(answer),
    )
}

fn sections(answer: &Value) -> String {
    let others = answer.as_object().into_iter().flatten().map(|(name, _)| name.as_str());
    let others = others.filter(|name| !FIRST.contains(name) && !NOT_TABLES.contains(name));
    FIRST.into_iter().chain(others).filter_map(|name| section(name, answer.get(name)?)).collect()
}

/// A member as a table with a heading. `None` for an empty member.
fn section(name: &str, value: &Value) -> Option<String> {
    let table = match name {
        // The names are the caller's own, so they are shown unchanged.
        "meta" => table::verbatim(value),
        _ => table::table(name, value),
    };
    let heading = label::Label::of(name).words;
    (!table.is_empty())
        .then(|| format!("<section class=\"{}\">\n<h2>{heading}</h2>\n{table}</section>\n", escape(name)))
}

fn footer(answer: &Value) -> String {
    let version = answer.get("engine_version").and_then(Value::as_str).unwrap_or_default();
    format!("<footer>toolpathd {}</footer>\n", escape(&clean(version)))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use serde_json::json;

    use super::*;

    fn answer() -> Value {
        json!({
            "engine_version": "0.1.0",
            "meta": {"part_id": "DIE-7", "<b>": "\"&"},
            "warnings": [{"code": "no_spindle_speed", "detail": "`cutting.spindle_rpm` is absent"}],
            "report": {"n_passes": 42, "gouge_max_mm": 0.009_782_272_6, "places": vec![[1.0, 2.0]; 500]},
            "measures": {
                "total_time_s": 3_812.44, "cutting_length_mm": 3_551.317_158,
                "moves": {"rapid": 12, "arc": 418}, "bounds": {"min": [-1.5, 0.0, 12.0], "max": [80.0, 80.5, 30.015]}
            },
            "toolpath": {"start": [0, 0, 0]},
        })
    }

    #[test]
    fn the_page_says_what_the_answer_says() {
        let page = page("Die 7", "<svg></svg>", &answer());
        for expected in [
            "<html lang=\"en\">",
            "<meta charset=\"utf-8\">",
            "<title>Die 7</title>",
            "<h1>Die 7</h1>",
            "<figure>\n<svg></svg></figure>",
            "<tr><th>part_id</th><td>DIE-7</td></tr>",
            "<tr><th>&lt;b&gt;</th><td>&quot;&amp;</td></tr>",
            "<tr><th>passes</th><td>42</td></tr>",
            "<tr><th>max gouge</th><td>0.009783 mm</td></tr>",
            "<tr><th>places</th><td>500 entries</td></tr>",
            "<tr><th>total time</th><td>3812.44 s (1:03:32)</td></tr>",
            "<tr><th>cutting length</th><td>3551.317 mm</td></tr>",
            "<tr><th>arc</th><td>418</td></tr>",
            "<tr><th>min</th><td>-1.5, 0, 12 mm</td></tr>",
            "<td>no_spindle_speed</td><td>`cutting.spindle_rpm` is absent</td>",
            "<footer>toolpathd 0.1.0</footer>",
        ] {
            assert!(page.contains(expected), "{expected} is not in\n{page}");
        }
        assert!(!page.contains("start") && !page.contains("<script"), "{page}");
        let sections: Vec<usize> =
            FIRST.iter().map(|name| page.find(&format!("class=\"{name}\"")).unwrap()).collect();
        assert!(sections.is_sorted(), "{sections:?}");
    }

    #[test]
    fn an_empty_member_has_no_heading() {
        let page = page("", "", &json!({"warnings": [], "report": {}, "meta": null}));
        assert!(!page.contains("<h2>"), "{page}");
        let _ = super::page("", "", &json!(7));
    }

    #[test]
    fn a_large_answer_is_summarised() {
        let mut deep = json!(1);
        for _ in 0..100 {
            deep = json!({ "a": deep });
        }
        let wide: serde_json::Map<String, Value> = (0..10_000).map(|k| (format!("k{k}"), json!(k))).collect();
        let rows: Vec<Value> = (0..10_000).map(|k| json!({"z_mm": k, "chosen": "x".repeat(5_000)})).collect();
        let page = page("", "", &json!({"report": {"deep": deep, "wide": wide, "levels": rows}}));
        assert!(page.len() < 100_000, "{}", page.len());
    }

    proptest! {
        #[test]
        fn no_text_of_the_answer_becomes_markup(name in any::<String>(), text in any::<String>()) {
            let told = |name: &str, text: &str| page(text, "", &json!({
                "meta": {name: text}, "report": {name: text, "list": [{name: text}], "inner": {name: [text]}},
                "warnings": [{"code": name, "detail": text}], name: text,
            }));
            let tags = |page: &str| page.matches('<').count();
            // A page of plain words in the same members has the same number of tags.
            prop_assume!(!name.is_empty() && !FIRST.contains(&&*name) && !NOT_TABLES.contains(&&*name));
            prop_assume!(name != "list" && name != "inner" && name != "code" && name != "detail");
            prop_assert_eq!(tags(&told(&name, &text)), tags(&told("plain", "words")));
        }
    }
}
