//! The words of one line: a letter with a number right behind it, a component of a vector, or one of a few
//! longer words.

use super::super::number::Number;
use crate::dialect::Dialect;
use crate::nc::{Fault, WordFault};

/// Letters that carry a value, at most once a line.
const VALUES: [&str; 13] = ["X", "Y", "Z", "I", "J", "K", "A", "B", "C", "F", "S", "T", "D"];

/// The components of a vector.
const VECTOR: [&str; 3] = ["A3", "B3", "C3"];

/// G codes that are read, by their groups. Two codes of one group exclude each other.
const G_GROUPS: [&[u16]; 9] =
    [&[0, 1, 2, 3], &[4], &[17, 18, 19], &[40], &[54, 55, 56, 57], &[64, 641], &[90], &[93, 94], &[700, 710]];

/// M codes that are read, by their groups.
const M_GROUPS: [&[u16]; 4] = [&[3, 5], &[6], &[7, 8, 9], &[30]];

/// Digits of an N word, at most.
const NUMBER_DIGITS: usize = 8;

/// A word of several letters.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Keyword {
    /// TRAORI.
    BeginTipControl,
    /// TRAFOOF.
    EndTipControl,
    /// ORIWKS: vectors count along the axes of the workpiece.
    InWorkpiece,
    /// ORIAXES: the rotary axes move in step with the path.
    ByAxes,
    /// ORIVECT: the tool axis turns on a great circle.
    ByVectors,
    /// ORICURVE: the path of a second point of the tool turns the axis.
    ByCurve,
    /// POLYPATH: polynomials move the path and the second point.
    Polynomials,
    /// SUPA: the coordinates of the block are those of the machine.
    MachineZero,
}

const KEYWORDS: [(&str, Keyword); 8] = [
    ("TRAORI", Keyword::BeginTipControl),
    ("TRAFOOF", Keyword::EndTipControl),
    ("ORIWKS", Keyword::InWorkpiece),
    ("ORIAXES", Keyword::ByAxes),
    ("ORIVECT", Keyword::ByVectors),
    ("ORICURVE", Keyword::ByCurve),
    ("POLYPATH", Keyword::Polynomials),
    ("SUPA", Keyword::MachineZero),
];

/// The arguments of POLYPATH that are read.
const BOTH_GROUPS: &str = "(\"AXES\",\"VECT\")";

/// The words of a line.
#[derive(Debug, Default)]
pub struct Words<'t> {
    /// The N word.
    pub number: Option<u32>,
    values: [Option<f64>; VALUES.len()],
    pub vector: [Option<f64>; VECTOR.len()],
    pub g: Vec<u16>,
    pub m: Vec<u16>,
    pub keyword: Option<Keyword>,
    /// ADIS: the distance from a corner at which rounding begins.
    pub rounding: Option<f64>,
    /// What stands behind MCALL.
    pub modal_call: Option<&'t str>,
    /// The arguments of CYCLE832.
    pub smoothing: Option<&'t str>,
}

impl<'t> Words<'t> {
    /// # Errors
    /// When a character begins no word, a word stands twice, its number has another form, or two words
    /// exclude each other.
    pub fn of(line: &'t str, dialect: &Dialect) -> Result<Self, Fault> {
        let mut words = Self::default();
        let mut is_first = true;
        let mut rest = trimmed(line);
        while let Some(first) = rest.chars().next() {
            if first == ';' {
                break;
            }
            let end = rest.find(|c: char| !c.is_ascii_uppercase()).unwrap_or(rest.len());
            let (letters, behind) = rest.split_at(end);
            rest = match letters {
                "" => return Err(Fault::UnknownWord(first)),
                "N" if is_first => words.take_number(behind)?,
                "N" => return Err(Fault::Word("N", WordFault::Order)),
                "ADIS" => words.take_rounding(behind)?,
                "CYCLE" => words.take_cycle(behind)?,
                "MCALL" => words.take_call(behind)?,
                "G" | "M" => words.take_code(letters, behind)?,
                _ if letters.len() > 1 => words.take_keyword(letters, behind)?,
                _ => words.take(letters, behind, dialect)?,
            };
            rest = trimmed(rest);
            is_first = false;
        }
        Ok(words)
    }

    fn take_number(&mut self, text: &'t str) -> Result<&'t str, Fault> {
        let (number, rest) = Number::at_start(text).ok_or(Fault::Word("N", WordFault::Number))?;
        let count = number.count().filter(|_| number.whole.len() <= NUMBER_DIGITS);
        self.number = Some(count.ok_or(Fault::Word("N", WordFault::Form))?);
        cleanly("N", rest)
    }

    fn take_rounding(&mut self, text: &'t str) -> Result<&'t str, Fault> {
        let number = text.strip_prefix('=').and_then(Number::at_start);
        let (number, rest) = number.ok_or(Fault::Word("ADIS", WordFault::Number))?;
        if number.sign.is_some() {
            return Err(Fault::Word("ADIS", WordFault::Form));
        }
        if self.rounding.replace(number.value).is_some() {
            return Err(Fault::Word("ADIS", WordFault::Twice));
        }
        cleanly("ADIS", rest)
    }

    /// `832(0.01,_FINISH,1)`.
    fn take_cycle(&mut self, text: &'t str) -> Result<&'t str, Fault> {
        let inside = text.strip_prefix("832(").and_then(|inside| inside.split_once(')'));
        let (arguments, rest) = inside.ok_or(Fault::Word("CYCLE832", WordFault::Form))?;
        if self.smoothing.replace(arguments).is_some() {
            return Err(Fault::Word("CYCLE832", WordFault::Twice));
        }
        Ok(rest)
    }

    /// All up to the end of the line or to its comment.
    fn take_call(&mut self, text: &'t str) -> Result<&'t str, Fault> {
        let (call, rest) = text.split_at(text.find(';').unwrap_or(text.len()));
        if self.modal_call.replace(call.trim()).is_some() || !(call.is_empty() || call.starts_with(' ')) {
            return Err(Fault::Word("MCALL", WordFault::Form));
        }
        Ok(rest)
    }

    fn take_code(&mut self, letter: &str, text: &'t str) -> Result<&'t str, Fault> {
        let is_g = letter == "G";
        let (name, groups, codes): (_, &[&[u16]], _) =
            if is_g { ("G", &G_GROUPS, &mut self.g) } else { ("M", &M_GROUPS, &mut self.m) };
        let (number, rest) = Number::at_start(text).ok_or(Fault::Word(name, WordFault::Number))?;
        let code = number.count().and_then(|code| u16::try_from(code).ok());
        let group = groups.iter().find(|group| code.is_some_and(|code| group.contains(&code)));
        let (Some(code), Some(group)) = (code, group) else {
            return Err(if is_g { Fault::UnknownG(number.value) } else { Fault::UnknownM(number.value) });
        };
        if codes.iter().any(|other| group.contains(other)) {
            return Err(Fault::Conflict);
        }
        codes.push(code);
        cleanly(name, rest)
    }

    fn take_keyword(&mut self, letters: &str, rest: &'t str) -> Result<&'t str, Fault> {
        let first = letters.chars().next().unwrap_or_default();
        let known = KEYWORDS.iter().find(|(word, _)| *word == letters);
        let &(name, keyword) = known.ok_or(Fault::UnknownWord(first))?;
        if self.keyword.replace(keyword).is_some() {
            return Err(Fault::Conflict);
        }
        let rest = match keyword {
            Keyword::Polynomials => {
                rest.strip_prefix(BOTH_GROUPS).ok_or(Fault::Word(name, WordFault::Form))?
            }
            _ => rest,
        };
        // A number or an equal sign behind it would be an argument.
        if rest.is_empty() || rest.starts_with([' ', '\t', ';']) {
            Ok(rest)
        } else {
            Err(Fault::Word(name, WordFault::Form))
        }
    }

    fn take(&mut self, letter: &str, text: &'t str, dialect: &Dialect) -> Result<&'t str, Fault> {
        let Some(place) = VALUES.iter().position(|name| *name == letter) else {
            return Err(Fault::UnknownWord(letter.chars().next().unwrap_or_default()));
        };
        let vector = VECTOR.iter().position(|name| name.starts_with(letter));
        if let (Some(place), Some(text)) = (vector, text.strip_prefix("3=")) {
            let name = VECTOR[place];
            let (number, rest) = Number::at_start(text).ok_or(Fault::Word(name, WordFault::Number))?;
            check_form(name, number, None, dialect)?;
            if self.vector[place].replace(number.value).is_some() {
                return Err(Fault::Word(name, WordFault::Twice));
            }
            return cleanly(name, rest);
        }
        let name = VALUES[place];
        let (number, rest) = Number::at_start(text).ok_or(Fault::Word(name, WordFault::Number))?;
        let numbers = &dialect.numbers;
        let decimals = match name {
            "A" | "B" | "C" => dialect.five_axes.angle_decimals,
            "F" => numbers.max_feed_decimals,
            "S" => numbers.spindle_decimals,
            "T" | "D" => 0,
            _ => dialect.max_decimals,
        };
        check_form(name, number, Some(decimals), dialect)?;
        let is_count = matches!(name, "T" | "D");
        let is_unsigned = is_count || matches!(name, "F" | "S");
        if is_count && number.count().is_none() || is_unsigned && number.sign.is_some() {
            return Err(Fault::Word(name, WordFault::Form));
        }
        if self.values[place].replace(number.value).is_some() {
            return Err(Fault::Word(name, WordFault::Twice));
        }
        cleanly(name, rest)
    }

    pub fn get(&self, letter: char) -> Option<f64> {
        self.values[VALUES.iter().position(|name| name.starts_with(letter))?]
    }

    /// The first of `letters` that the line has.
    pub fn first_of(&self, letters: &str) -> Option<&'static str> {
        let has = |letter: &char| self.get(*letter).is_some();
        let letter = letters.chars().find(has)?;
        VALUES.into_iter().find(|name| name.starts_with(letter))
    }

    /// The numbers of three letters.
    pub fn three(&self, letters: [char; 3]) -> [Option<f64>; 3] {
        letters.map(|letter| self.get(letter))
    }

    pub fn has_vector(&self) -> bool {
        self.vector.iter().any(Option::is_some)
    }

    /// The components of the vector.
    ///
    /// # Errors
    /// When a component is missing, or all are zero.
    pub fn whole_vector(&self) -> Result<[f64; 3], Fault> {
        for (name, part) in VECTOR.into_iter().zip(self.vector) {
            part.ok_or(Fault::Word(name, WordFault::Missing))?;
        }
        let vector = self.vector.map(Option::unwrap_or_default);
        let is_zero = vector.iter().all(|part| *part == 0.0);
        if is_zero { Err(Fault::Word(VECTOR[0], WordFault::Range)) } else { Ok(vector) }
    }

    /// Whether the line has neither values nor codes. An N word or a longer word may stand in it.
    pub fn is_empty(&self) -> bool {
        self.values.iter().all(Option::is_none)
            && !self.has_vector()
            && self.g.is_empty()
            && self.m.is_empty()
    }
}

/// `text` without the blanks at its start.
fn trimmed(text: &str) -> &str {
    text.trim_start_matches([' ', '\t'])
}

/// # Errors
/// When a number has too many digits. `decimals` is none where any number of decimals is legal.
fn check_form(
    name: &'static str,
    number: Number,
    decimals: Option<u8>,
    dialect: &Dialect,
) -> Result<(), Fault> {
    let digits = number.whole.len() + number.decimals();
    let is_long = digits > dialect.numbers.max_digits as usize;
    let is_fine = decimals.is_some_and(|decimals| number.decimals() > usize::from(decimals));
    if is_long || is_fine { Err(Fault::Word(name, WordFault::Form)) } else { Ok(()) }
}

/// `rest`, unless the text of a number goes on in it.
fn cleanly<'t>(name: &'static str, rest: &'t str) -> Result<&'t str, Fault> {
    if rest.starts_with(['+', '-', '.', '=']) { Err(Fault::Word(name, WordFault::Number)) } else { Ok(rest) }
}
