//! Recognises bodies that are not JSON, and names what each one is: the text of a spreadsheet, a text in
//! another encoding, or JSON with numbers such as NaN.

/// A message that says what `body` is and what to send instead. `fault_at` is the byte where the JSON parser
/// stopped. `None` for a body that is not recognised.
pub fn named(body: &[u8], fault_at: Option<usize>) -> Option<&'static str> {
    match body {
        [0xef, 0xbb, 0xbf, ..] => {
            return Some("the body begins with a byte order mark: send UTF-8 without it");
        }
        [0xff, 0xfe, ..] | [0xfe, 0xff, ..] | [0, _, 0, _, ..] | [_, 0, _, 0, ..] => {
            return Some("the body is UTF-16: send UTF-8");
        }
        _ => {}
    }
    let rest = fault_at.and_then(|at| body.get(at.saturating_sub(1)..)).unwrap_or_default();
    let begins = |word: &[u8]| {
        let near = &rest[..rest.len().min(word.len() + 2)];
        near.windows(word.len()).any(|found| found.eq_ignore_ascii_case(word))
    };
    if [&b"nan"[..], b"infinity", b"-inf"].into_iter().any(begins) {
        return Some("JSON has no NaN and no Infinity: send finite numbers");
    }
    let text = body.trim_ascii();
    let first_line = text.split(|byte| *byte == b'\n').next().unwrap_or_default();
    let is_table = first_line.iter().any(|byte| b",;\t".contains(byte)) && text.contains(&b'\n');
    let begins_as_json = text.first().is_some_and(|byte| b"{[\"".contains(byte));
    (is_table && !begins_as_json)
        .then_some("the body looks like a table of comma-separated values: send JSON")
}
