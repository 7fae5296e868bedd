//! Text on a sheet: cleaned, escaped, and cut to a width.

/// Height of the usual text, mm of paper.
pub const SIZE_MM: f64 = 2.5;
pub const TITLE_SIZE_MM: f64 = 4.2;

/// Most characters of a text that a line of a sheet or a page shows.
const MAX_CHARACTERS: usize = 1000;

/// `text` on one line, at most its first thousand characters. Control characters become spaces. Characters
/// that XML forbids, and marks that change the direction of text, are removed.
pub fn clean(text: &str) -> String {
    let mut cleaned = String::new();
    for c in text.chars().take(MAX_CHARACTERS) {
        if c.is_whitespace() || c.is_control() {
            if !cleaned.is_empty() && !cleaned.ends_with(' ') {
                cleaned.push(' ');
            }
        } else if !is_invisible(c) {
            cleaned.push(c);
        }
    }
    cleaned.truncate(cleaned.trim_end().len());
    cleaned
}

fn is_invisible(c: char) -> bool {
    matches!(c, '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{feff}')
        || matches!(c, '\u{fffe}' | '\u{ffff}')
}

/// `text` escaped for use as character data or as an attribute value, in XML and in HTML.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            _ => escaped.push(c),
        }
    }
    escaped
}

/// The width of `text`, as a multiple of its height: an upper estimate for common sans-serif fonts.
pub fn width(text: &str) -> f64 {
    text.chars().map(width_of).sum()
}

fn width_of(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 0.33,
        'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.98,
        'A'..='Z' => 0.74,
        _ if c < '\u{1100}' => 0.61,
        _ => 1.0,
    }
}

/// `text` in at most `max_lines` lines (at least one) of at most `width_max` text heights each. Lines break
/// at spaces if possible. Text that does not fit is replaced by an ellipsis.
pub fn wrap(text: &str, width_max: f64, max_lines: usize) -> Vec<String> {
    let mut lines = Vec::new();
    let mut rest = text;
    while lines.len() + 1 < max_lines && width(rest) > width_max {
        let fits = fitting(rest, width_max);
        let at = rest[..fits].rfind(' ').unwrap_or(fits);
        lines.push(rest[..at].to_owned());
        rest = rest[at..].trim_start();
    }
    lines.push(cut(rest, width_max));
    lines
}

/// `text`, or as much as fits with an ellipsis.
pub fn cut(text: &str, width_max: f64) -> String {
    if width(text) <= width_max {
        return text.to_owned();
    }
    let fits = fitting(text, width_max - width_of('\u{2026}').max(1.0));
    format!("{}\u{2026}", text[..fits].trim_end())
}

/// The length in bytes of the part that fits, at least one character.
fn fitting(text: &str, width_max: f64) -> usize {
    let mut used = 0.0;
    for (at, c) in text.char_indices() {
        used += width_of(c);
        if used > width_max && at > 0 {
            return at;
        }
    }
    text.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn control_characters_become_spaces_and_direction_marks_vanish() {
        assert_eq!(clean(" a\r\n\tb\u{0}\u{1b}c\u{202e}d\u{ffff} \u{85}"), "a b cd");
        assert_eq!(clean(&"x".repeat(5000)).len(), MAX_CHARACTERS);
        assert_eq!(escape("<a b=\"c\">&'"), "&lt;a b=&quot;c&quot;&gt;&amp;&#39;");
    }

    #[test]
    fn lines_fit_and_only_an_ellipsis_replaces_text() {
        let text = "proved deviation 0.0095 mm, gouge 0.0098 mm";
        assert_eq!(wrap(text, 100.0, 2), [text]);
        assert_eq!(wrap(text, 16.0, 3).join(" "), text);
        let two = wrap(text, 10.0, 2);
        assert_eq!(two.len(), 2);
        assert!(two[1].ends_with('\u{2026}'), "{two:?}");
        for line in wrap(&"W".repeat(99), 10.0, 3) {
            assert!(width(&line) <= 10.0);
        }
        assert_eq!(wrap("", 10.0, 2), [""]);
    }
}
