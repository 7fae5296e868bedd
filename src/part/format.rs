//! The format of a file, by its contents, and by its name where the contents do not tell.

/// A format of files of parts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// A drawing of AutoCAD, as text or binary.
    Dxf,
    /// A text of points.
    Points,
    /// ISO 10303-21.
    Step,
    /// A format that is known and not read, with its name.
    Other(&'static str),
}

/// How many bytes of a file are looked at.
const HEAD: usize = 4096;

impl Format {
    /// The format of a file with this name.
    pub fn of(name: &str, bytes: &[u8]) -> Self {
        let head = &bytes[..bytes.len().min(HEAD)];
        Self::by_mark(head).or_else(|| Self::by_name(name)).unwrap_or_else(|| Self::by_text(head))
    }

    /// By a mark at the beginning of the file.
    fn by_mark(head: &[u8]) -> Option<Self> {
        let text = head.strip_prefix(b"\xef\xbb\xbf").unwrap_or(head).trim_ascii_start();
        let marks: [(&[u8], Self); 7] = [
            (b"AutoCAD Binary DXF", Self::Dxf),
            (b"ISO-10303-21", Self::Step),
            (b"AC10", Self::Other("DWG")),
            (b"PK\x03\x04", Self::Other("ZIP (3MF)")),
            (b"ply", Self::Other("PLY")),
            (b"%PDF", Self::Other("PDF")),
            (b"glTF", Self::Other("glTF")),
        ];
        let marked = marks.into_iter().find(|(mark, _)| text.starts_with(mark)).map(|(_, format)| format);
        marked.or_else(|| begins_as_dxf(text).then_some(Self::Dxf))
    }

    fn by_name(name: &str) -> Option<Self> {
        let (_, ending) = name.rsplit_once('.')?;
        Some(match ending.to_ascii_lowercase().as_str() {
            "dxf" => Self::Dxf,
            "step" | "stp" | "p21" => Self::Step,
            "csv" | "xyz" | "txt" | "asc" | "pts" | "dat" | "tsv" => Self::Points,
            "igs" | "iges" => Self::Other("IGES"),
            "stl" => Self::Other("STL"),
            "obj" => Self::Other("OBJ"),
            "dwg" => Self::Other("DWG"),
            "3mf" => Self::Other("3MF"),
            "ply" => Self::Other("PLY"),
            _ => return None,
        })
    }

    /// By the kind of text: IGES has sections in column 73, STL begins with `solid`; numbers are points.
    fn by_text(head: &[u8]) -> Self {
        if head.len() > 80 && head[72] == b'S' && head[..80].is_ascii() {
            return Self::Other("IGES");
        }
        if head.starts_with(b"solid") {
            return Self::Other("STL");
        }
        let is_text = head.iter().all(|byte| *byte >= b' ' || byte.is_ascii_whitespace());
        if is_text { Self::Points } else { Self::Other("an unknown format") }
    }
}

/// Whether a text begins with a section or a remark of DXF.
fn begins_as_dxf(text: &[u8]) -> bool {
    let head = String::from_utf8_lossy(text);
    let mut lines = head.lines().map(str::trim);
    match (lines.next(), lines.next()) {
        (Some("0"), Some("SECTION")) => true,
        (Some("999"), Some(_)) => lines.next() == Some("0") || lines.next() == Some("999"),
        _ => false,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn contents_decide_before_the_name() {
        for (name, bytes, format) in [
            ("a.dxf", "  0\r\nSECTION\r\n", Format::Dxf),
            ("a.txt", "0\nSECTION\n", Format::Dxf),
            ("part", "999\nmade by\n0\nSECTION\n", Format::Dxf),
            ("a", "AutoCAD Binary DXF\r\n\u{1a}\0", Format::Dxf),
            ("a.dat", "ISO-10303-21;\nHEADER;", Format::Step),
            ("a.csv", "x;y;z\n1;2;3", Format::Points),
            ("a", "1 2 3\n4 5 6\n", Format::Points),
            ("a.stl", "solid a\n", Format::Other("STL")),
            ("a", "solid a\n", Format::Other("STL")),
            ("a.3mf", "PK\x03\x04", Format::Other("ZIP (3MF)")),
            ("a.bin", "\0\u{1}\u{2}", Format::Other("an unknown format")),
            ("", "", Format::Points),
        ] {
            assert_eq!(Format::of(name, bytes.as_bytes()), format, "{name}");
        }
    }
}
