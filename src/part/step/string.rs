//! Texts between quotes in ISO 10303-21, which write other letters than ASCII by escapes.

/// The text that `bytes` stand for, without the quotes around them. What is no valid escape stays as it is.
pub fn decode(bytes: &[u8]) -> String {
    let mut text = String::new();
    let mut rest = bytes;
    while let Some((first, behind)) = rest.split_first() {
        if rest.starts_with(b"''") {
            text.push('\'');
            rest = &rest[2..];
        } else if let Some((decoded, n)) = escape(rest) {
            text.push_str(&decoded);
            rest = &rest[n..];
        } else {
            let n = 1 + behind.iter().take_while(|byte| !b"'\\".contains(byte)).count();
            let n = if *first == b'\\' { 1 } else { n };
            text.push_str(&String::from_utf8_lossy(&rest[..n]));
            rest = &rest[n..];
        }
    }
    text
}

/// The escape at the start of `bytes`: its text and its length.
fn escape(bytes: &[u8]) -> Option<(String, usize)> {
    if bytes.starts_with(b"\\\\") {
        return Some(("\\".to_owned(), 2));
    }
    if bytes.starts_with(b"\\S\\") {
        let letter = char::from(bytes.get(3)?.checked_add(128)?);
        return Some((letter.to_string(), 4));
    }
    if bytes.starts_with(b"\\P") && bytes.get(3) == Some(&b'\\') {
        return Some((String::new(), 4));
    }
    if bytes.starts_with(b"\\X\\") {
        let code = number(bytes.get(3..5)?)?;
        return Some((char::from_u32(code)?.to_string(), 5));
    }
    let width = match bytes.get(..4)? {
        b"\\X2\\" => 4,
        b"\\X4\\" => 8,
        _ => return None,
    };
    let end = bytes.windows(4).position(|four| four == b"\\X0\\")?;
    let digits = bytes.get(4..end)?;
    let codes: Vec<u32> = digits.chunks(width).map(number).collect::<Option<_>>()?;
    let text = if width == 4 {
        let codes: Vec<u16> = codes.iter().map(|code| *code as u16).collect();
        String::from_utf16_lossy(&codes)
    } else {
        codes.iter().map(|code| char::from_u32(*code).unwrap_or(char::REPLACEMENT_CHARACTER)).collect()
    };
    Some((text, end + 4))
}

fn number(digits: &[u8]) -> Option<u32> {
    u32::from_str_radix(std::str::from_utf8(digits).ok()?, 16).ok()
}
