//! The words of one line of an NC program of any control: a name and a number.
//!
//! `X1.5`, `TX+0.2` and `A3=0.2` are a name with a number; `TRAORI` and `LN` are names alone. Comments, block
//! numbers, marks and strings are skipped.

use super::PathFault;

/// Names and numbers with more characters are refused.
const MAX_LENGTH: usize = 40;

/// Names whose value must be a number.
const MOVING: [&str; 11] = ["G", "F", "X", "Y", "Z", "A", "B", "C", "A3", "B3", "C3"];

/// A word in capital letters.
#[derive(Debug, Clone, PartialEq)]
pub struct Word {
    pub name: String,
    pub value: Option<f64>,
}

/// # Errors
/// When the line has variables, or a number that cannot be read.
pub fn words(line: &str) -> Result<Vec<Word>, PathFault> {
    let bytes = line.as_bytes();
    let mut words: Vec<Word> = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        match bytes[at] {
            b';' => break,
            b'(' => at = skip_to(bytes, at, b')'),
            b'"' => at = skip_to(bytes, at + 1, b'"'),
            b'#' | b'[' | b'{' => return Err(PathFault::Variables),
            c if c.is_ascii_alphabetic() || c == b'_' => {
                let end = at + run(&bytes[at..], |c| c.is_ascii_alphabetic() || c == b'_');
                // Digits before an equals sign belong to the name.
                let digits = run(&bytes[end..], |c| c.is_ascii_digit());
                let equals = bytes[end + digits..].first() == Some(&b'=');
                let name_end = if equals { end + digits } else { end };
                let gap = name_end + usize::from(equals);
                let gap = gap + run(&bytes[gap..], |c| c == b' ');
                let length = run(&bytes[gap..], |c| c.is_ascii_digit() || b"+-.".contains(&c));
                let name = line[at..name_end].to_ascii_uppercase();
                if name.len() > MAX_LENGTH || length > MAX_LENGTH {
                    return Err(PathFault::BadNumber(line[at..].chars().take(MAX_LENGTH).collect()));
                }
                let text = &line[gap..gap + length];
                let value = match (length, equals) {
                    (0, true) if MOVING.contains(&name.as_str()) => return Err(PathFault::Variables),
                    (0, _) => None,
                    _ => Some(text.parse().map_err(|_| PathFault::BadNumber(text.to_owned()))?),
                };
                words.push(Word { name, value });
                at = gap + length;
            }
            // Blanks, marks, and the number of a block of Klartext.
            _ => at += 1,
        }
    }
    Ok(words)
}

fn run(bytes: &[u8], is: impl Fn(u8) -> bool) -> usize {
    bytes.iter().position(|c| !is(*c)).unwrap_or(bytes.len())
}

/// The place behind the next `mark`.
fn skip_to(bytes: &[u8], from: usize, mark: u8) -> usize {
    from + bytes[from..].iter().position(|c| *c == mark).map_or(bytes.len() - from, |k| k + 1)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn shown(line: &str) -> String {
        let text = |word: &Word| match word.value {
            Some(value) => format!("{}:{value}", word.name),
            None => word.name.clone(),
        };
        words(line).unwrap().iter().map(text).collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn the_words_of_every_family_are_read() {
        assert_eq!(shown("N10 G43.4H1 X-1.5Y.5 (Z9) A 3."), "N:10 G:43.4 H:1 X:-1.5 Y:0.5 A:3");
        assert_eq!(
            shown("12 LN X+1 Y-2 TX+0.6 TZ+0.8 FMAX M128 ; x"),
            "LN X:1 Y:-2 TX:0.6 TZ:0.8 FMAX M:128"
        );
        assert_eq!(shown("G1 X=1 A3=0.6 B3=0 C3=.8"), "G:1 X:1 A3:0.6 B3:0 C3:0.8");
        assert_eq!(shown("TRAORI(1)"), "TRAORI");
        assert_eq!(shown("T=\"MILL 6\" D1 _CAMTOL=0.01"), "T D:1 _CAMTOL:0.01");
        assert_eq!(shown("MSG(\"X1\")"), "MSG");
        assert_eq!(words("X#1"), Err(PathFault::Variables));
        assert_eq!(words("X=R1"), Err(PathFault::Variables));
        assert!(matches!(words("X1.2.3"), Err(PathFault::BadNumber(_))));
    }

    proptest! {
        #[test]
        fn no_line_panics(line in "(?s).{0,80}") {
            let _ = words(&line);
        }
    }
}
