//! Names in DXF files: of layers, blocks and kinds of entities.
//!
//! A name is read as UTF-8. Where the bytes are no UTF-8, it is read in code page 1252, which holds Latin-1.
//! `\U+` with four hexadecimal digits stands for one character. Names in other code pages are read as wrong
//! characters, and two of them still differ where their bytes differ.

/// The characters of code page 1252 from 0x80 to 0x9f. Five bytes mean nothing, and keep their number.
const WINDOWS: [char; 32] = [
    '€', '\u{81}', '‚', 'ƒ', '„', '…', '†', '‡', 'ˆ', '‰', 'Š', '‹', 'Œ', '\u{8d}', 'Ž', '\u{8f}', '\u{90}',
    '‘', '’', '“', '”', '•', '–', '—', '˜', '™', 'š', '›', 'œ', '\u{9d}', 'ž', 'Ÿ',
];

/// The most characters of a name. A longer name is cut.
const LONGEST: usize = 255;

/// The characters of a name.
pub fn decoded(bytes: &[u8]) -> String {
    let text = match std::str::from_utf8(bytes) {
        Ok(text) => text.to_owned(),
        Err(_) => bytes.iter().map(|byte| of_code_page(*byte)).collect(),
    };
    let text = if text.contains("\\U+") { unescaped(&text) } else { text };
    if text.len() > LONGEST { text.chars().take(LONGEST).collect() } else { text }
}

/// A name in which capital and small letters are alike, as in the comparison of names in DXF.
pub fn key(name: &str) -> String {
    name.to_uppercase()
}

fn of_code_page(byte: u8) -> char {
    match byte {
        0x80..=0x9f => WINDOWS[usize::from(byte - 0x80)],
        _ => char::from(byte),
    }
}

/// The text with a character in the place of each `\U+` and its four digits.
fn unescaped(text: &str) -> String {
    let mut parts = text.split("\\U+");
    let mut plain = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let character =
            part.get(..4).and_then(|digits| u32::from_str_radix(digits, 16).ok()).and_then(char::from_u32);
        match character {
            Some(character) => {
                plain.push(character);
                plain.push_str(&part[4..]);
            }
            None => {
                plain.push_str("\\U+");
                plain.push_str(part);
            }
        }
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_utf8_or_of_code_page_1252_with_escapes() {
        assert_eq!(decoded("Außen".as_bytes()), "Außen");
        assert_eq!(decoded(b"Au\xdfen \x80"), "Außen €");
        assert_eq!(decoded(b"Au\\U+00DFen"), "Außen");
        assert_eq!(decoded(b"\\U+00"), "\\U+00");
        assert_eq!(decoded(b"\\U+D800x"), "\\U+D800x");
        assert_eq!(key("Außen"), key("AUSSEN"));
        assert_eq!(decoded("ä".repeat(600).as_bytes()).chars().count(), 255);
    }
}
