//! How the numbers of a text are written.

/// How the numbers of a line are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Writing {
    /// What stands between the numbers; a blank stands for any number of blanks and tabs.
    pub separator: char,
    pub has_decimal_comma: bool,
}

impl Writing {
    pub const BLANKS: Self = Self { separator: ' ', has_decimal_comma: false };

    /// How a line is written; `None` for a line that does not consist of numbers.
    ///
    /// A line without `;` and tabs whose numbers have one comma each, between blanks, has decimal commas:
    /// `1,5 2,5 0,1`. Where commas stand before blanks, or nothing else divides the line, commas separate.
    pub fn of(line: &str) -> Option<Self> {
        let line = line.trim();
        // A comma beside a blank stands between numbers, and not within one.
        let has_loose_comma = line.contains(", ") || line.contains(" ,");
        let candidates: &[(char, bool)] = if line.contains(';') {
            &[(';', false), (';', true)]
        } else if line.contains('\t') {
            &[('\t', false), ('\t', true), (' ', false), (' ', true), (',', false)]
        } else if has_loose_comma {
            &[(',', false)]
        } else {
            &[(' ', false), (' ', true), (',', false)]
        };
        let all =
            candidates.iter().map(|&(separator, has_decimal_comma)| Self { separator, has_decimal_comma });
        let mut fitting = all.filter(|writing| writing.numbers(line).is_ok_and(|numbers| numbers.len() > 1));
        fitting.next()
    }

    /// The numbers of a line.
    ///
    /// # Errors
    /// What is wrong, for people.
    pub fn numbers(self, line: &str) -> Result<Vec<f64>, String> {
        let line = line.trim();
        if self.separator == ' ' {
            return line.split_whitespace().map(|word| self.number(word)).collect();
        }
        // A separator may end the line.
        let line = line.strip_suffix(self.separator).unwrap_or(line);
        line.split(self.separator).map(|word| self.number(word.trim())).collect()
    }

    fn number(self, word: &str) -> Result<f64, String> {
        if is_missing(word) {
            return Err("a number is missing: leave the line out".to_owned());
        }
        let not_read = || format!("\"{}\" is no number", word.chars().take(40).collect::<String>());
        // Names such as `inf` are numbers for Rust.
        if !word.bytes().all(|byte| byte.is_ascii_digit() || b"+-.,eEdD".contains(&byte)) {
            return Err(not_read());
        }
        let mut plain = word.replace(['d', 'D'], "e");
        if self.has_decimal_comma {
            let is_between_digits = plain.split_once(',').is_none_or(|(before, behind)| {
                before.ends_with(|c: char| c.is_ascii_digit())
                    && behind.starts_with(|c: char| c.is_ascii_digit())
            });
            if plain.contains('.') || plain.matches(',').count() > 1 || !is_between_digits {
                return Err(not_read());
            }
            plain = plain.replace(',', ".");
        }
        plain.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(not_read)
    }

    /// The separator, for people.
    pub fn separator_name(self) -> &'static str {
        match self.separator {
            ';' => "semicolons",
            ',' => "commas",
            '\t' => "tabs",
            _ => "blanks",
        }
    }
}

/// Whether a word stands for a missing number.
fn is_missing(word: &str) -> bool {
    word.is_empty() || ["nan", "null", "none", "n/a", "-"].contains(&word.to_ascii_lowercase().as_str())
}

/// Whether a line that is no point was meant as one: two of its words or more are numbers, or one is a number
/// and the others are missing.
pub fn is_broken_point(line: &str) -> bool {
    let line = line.trim();
    if line.starts_with(['#', '%', '!', '/']) {
        return false;
    }
    let separator = [';', '\t', ','].into_iter().find(|separator| line.contains(*separator));
    let words: Vec<&str> = match separator {
        Some(separator) => line.split(separator).map(|word| word.trim().trim_matches('"')).collect(),
        None => line.split_whitespace().collect(),
    };
    let is_number = |word: &&&str| word.parse::<f64>().is_ok_and(f64::is_finite);
    let n_numbers = words.iter().filter(is_number).count();
    let n_missing = words.iter().filter(|word| is_missing(word)).count();
    n_numbers > 1 || n_missing > 0 && n_numbers + n_missing == words.len() && words.len() > 1
}
