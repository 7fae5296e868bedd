//! The words of one line.

use super::Fault;

/// A line has at most this many G words, and as many M words: one of each modal group.
const MAX_CODES: usize = 16;

/// Digits of a number: more than any control reads.
const MAX_NUMBER_LENGTH: usize = 40;

/// Letters that carry a value, at most once a line.
const VALUES: &str = "FHIJKNPQSTXYZ";

/// Values by letter, and the G and M codes in tenths.
pub struct Words {
    values: [Option<f64>; 26],
    /// Which of them are written with a decimal point.
    has_point: [bool; 26],
    g: Codes,
    m: Codes,
}

#[derive(Default)]
struct Codes {
    tenths: [i32; MAX_CODES],
    count: usize,
}

impl Codes {
    fn push(&mut self, value: f64, letter: char) -> Result<(), Fault> {
        let tenths = value * 10.0;
        if tenths != tenths.round() || !(0.0..10_000.0).contains(&tenths) {
            return Err(if letter == 'G' { Fault::UnknownG(value) } else { Fault::UnknownM(value) });
        }
        let slot = self.tenths.get_mut(self.count).ok_or(Fault::Conflict)?;
        *slot = tenths as i32;
        self.count += 1;
        Ok(())
    }

    fn all(&self) -> &[i32] {
        &self.tenths[..self.count]
    }
}

impl Words {
    /// # Errors
    /// When a character begins no word, a number cannot be read or a word stands twice.
    pub fn of(line: &str) -> Result<Self, Fault> {
        let mut words =
            Self { values: [None; 26], has_point: [false; 26], g: Codes::default(), m: Codes::default() };
        let mut rest = line.trim();
        if rest == "%" {
            return Ok(words);
        }
        while let Some(c) = rest.chars().next() {
            let after = &rest[c.len_utf8()..];
            rest = match c {
                ';' => break,
                '(' => &after[after.find(')').ok_or(Fault::OpenComment)? + 1..],
                ' ' | '\t' => after,
                _ => words.word(c.to_ascii_uppercase(), after)?,
            };
        }
        Ok(words)
    }

    pub fn g(&self) -> &[i32] {
        self.g.all()
    }

    pub fn m(&self) -> &[i32] {
        self.m.all()
    }

    pub fn get(&self, letter: char) -> Option<f64> {
        index(letter).and_then(|k| self.values[k])
    }

    /// The first of `letters` that the line has.
    pub fn first_of(&self, letters: &str) -> Option<char> {
        letters.chars().find(|&letter| self.get(letter).is_some())
    }

    /// The first of `letters` that is written with a decimal point, and the first without.
    pub fn pointed(&self, letters: &str) -> (Option<char>, Option<char>) {
        let first = |wanted: bool| {
            letters.chars().find(|&letter| {
                index(letter).is_some_and(|k| self.values[k].is_some() && self.has_point[k] == wanted)
            })
        };
        (first(true), first(false))
    }

    /// Whether two G words are of one group.
    pub fn has_conflict(&self) -> bool {
        let group = |tenths: i32| match tenths {
            0..=39 | 51 | 800 => 1,
            170..=199 => 2,
            200..=219 => 3,
            430 | 490 => 4,
            540..=599 => 5,
            610..=649 => 6,
            other => 100 + other,
        };
        let all = self.g.all();
        all.iter().enumerate().any(|(k, &one)| all[..k].iter().any(|&other| group(one) == group(other)))
    }

    /// Takes the word that `letter` begins and returns what follows it.
    fn word<'a>(&mut self, letter: char, after: &'a str) -> Result<&'a str, Fault> {
        let is_code = letter == 'G' || letter == 'M';
        if !is_code && !VALUES.contains(letter) {
            return Err(Fault::UnknownWord(letter));
        }
        let digits = after.trim_start_matches([' ', '\t']);
        let end = digits.find(|c: char| !(c.is_ascii_digit() || "+-.".contains(c))).unwrap_or(digits.len());
        let (number, rest) = digits.split_at(end);
        let value = Some(number)
            .filter(|number| number.len() <= MAX_NUMBER_LENGTH && number.bytes().any(|c| c.is_ascii_digit()))
            .and_then(|number| number.parse::<f64>().ok())
            .ok_or(Fault::BadNumber(letter))?;
        match letter {
            'G' => self.g.push(value, letter)?,
            'M' => self.m.push(value, letter)?,
            _ => {
                let k = index(letter).ok_or(Fault::UnknownWord(letter))?;
                self.has_point[k] = number.contains('.');
                if self.values[k].replace(value).is_some() {
                    return Err(Fault::Twice(letter));
                }
            }
        }
        Ok(rest)
    }
}

fn index(letter: char) -> Option<usize> {
    letter.is_ascii_uppercase().then(|| letter as usize - 'A' as usize)
}
