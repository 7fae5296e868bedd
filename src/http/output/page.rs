//! A picture and the figures that belong to it, as one page that needs nothing from elsewhere.

use serde_json::Value;

/// The page: `svg` as it is, and the members of `answer` but its toolpath as text.
pub fn page(title: &str, svg: &str, answer: &Value) -> String {
    let mut shown = answer.clone();
    if let Some(members) = shown.as_object_mut() {
        members.remove("toolpath");
    }
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>{}</title></head>\n\
         <body>\n{svg}<pre>{}</pre>\n</body></html>\n",
        escaped(title),
        escaped(&format!("{shown:#}")),
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
