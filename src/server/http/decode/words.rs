//! Messages of the decoder in plain words, without names of Rust types.

/// The message about a name that is not in `names`.
pub fn unknown(name: &str, names: &[&str]) -> String {
    let one_of = if names.len() > 1 { "one of " } else { "" };
    format!("`{name}` is unknown; use {one_of}`{}`", names.join("`, `"))
}

/// The plain message for an error about a type, a value or a length.
pub fn plain(message: &str) -> String {
    if let Some((got, expected)) =
        parts(message, "invalid type: ").or_else(|| parts(message, "invalid value: "))
    {
        return format!("send {}, not {}", expectation(expected), sent(got));
    }
    if let Some((got, expected)) = parts(message, "invalid length ") {
        return format!("send {}, not an array of {got}", expectation(expected));
    }
    if message.starts_with("trailing characters") || message.contains("expected sequence end") {
        return "the array is too long".to_owned();
    }
    message.to_owned()
}

fn parts<'a>(message: &'a str, start: &str) -> Option<(&'a str, &'a str)> {
    message.strip_prefix(start)?.rsplit_once(", expected ")
}

/// What the decoder expected, in plain words.
fn expectation(expected: &str) -> String {
    match expected {
        "f64" | "f32" => "a number".to_owned(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of 0 or more".to_owned(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".to_owned(),
        "a boolean" => "`true` or `false`".to_owned(),
        "a string" | "string" | "str" | "a borrowed string" => "a text".to_owned(),
        "a sequence" => "an array".to_owned(),
        "a map" | "map" => "an object".to_owned(),
        "variant identifier" | "string or map" => "a name".to_owned(),
        "unit" => "`null`".to_owned(),
        _ if expected.starts_with("struct ") => "an object".to_owned(),
        _ if expected.starts_with("enum ") => "a name".to_owned(),
        _ => {
            let count = expected
                .strip_prefix("a tuple of size ")
                .or_else(|| expected.strip_prefix("an array of length "))
                .map(|count| count.trim_end_matches(" elements").to_owned());
            count.map_or_else(|| expected.to_owned(), |count| format!("an array of {count}"))
        }
    }
}

/// What the caller sent, in plain words.
fn sent(got: &str) -> String {
    for kind in ["integer ", "floating point ", "boolean "] {
        if let Some(value) = got.strip_prefix(kind) {
            return value.to_owned();
        }
    }
    match got {
        "sequence" => "an array".to_owned(),
        "map" => "an object".to_owned(),
        "null" | "unit value" | "Option value" => "`null`".to_owned(),
        _ => got.strip_prefix("string ").map_or_else(|| got.to_owned(), |text| format!("the text {text}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_message_says_what_to_send_and_what_was_sent() {
        for (message, words) in [
            ("invalid type: string \"ten\", expected f64", "send a number, not the text \"ten\""),
            (
                "invalid type: floating point `12.5`, expected u32",
                "send a whole number of 0 or more, not `12.5`",
            ),
            ("invalid type: null, expected struct Tool", "send an object, not `null`"),
            ("invalid type: sequence, expected a string", "send a text, not an array"),
            ("invalid length 3, expected an array of length 2", "send an array of 2, not an array of 3"),
            ("invalid value: integer `-1`, expected u32", "send a whole number of 0 or more, not `-1`"),
        ] {
            assert_eq!(plain(message), words);
        }
    }
}
