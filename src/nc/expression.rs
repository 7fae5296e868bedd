//! Numbers, variables and expressions of a line.
//!
//! Both languages write an expression in brackets, a variable after `#`, and functions with their argument
//! in brackets. They differ in the rank of AND, OR and XOR, and in what these do: Fanuc takes the bits of
//! whole numbers, LinuxCNC the truth. Angles are in degrees.

use super::control::Language;
use super::fault::Fault;
use super::variables::{Value, Variables};

/// Deepest nesting of brackets. Deeper nesting could exhaust the stack.
const MAX_DEPTH: usize = 64;

/// Longest name of a variable or a label, bytes.
const MAX_NAME: usize = 128;

/// Reads values from one line.
pub struct Reader<'a> {
    pub line: &'a [u8],
    pub at: usize,
    pub variables: &'a Variables,
    pub language: Language,
}

/// A value as it stands in a line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Read {
    pub value: Value,
    /// A number without a point, neither a variable nor an expression.
    pub lacks_point: bool,
    /// Whether the value is a number as it is written.
    pub is_literal: bool,
}

/// A variable that a line names.
#[derive(Debug, Clone, PartialEq)]
pub enum Variable {
    Numbered(u32),
    Named(String),
}

impl<'a> Reader<'a> {
    pub fn skip_blanks(&mut self) {
        while matches!(self.line.get(self.at), Some(b' ' | b'\t')) {
            self.at += 1;
        }
    }

    fn peek(&self) -> Option<u8> {
        self.line.get(self.at).copied()
    }

    /// Takes `byte`, after blanks.
    pub fn take(&mut self, byte: u8) -> bool {
        self.skip_blanks();
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    /// Takes the keyword, in letters of any case, after blanks.
    pub fn take_word(&mut self, word: &str) -> bool {
        self.skip_blanks();
        let found = self.line[self.at..].get(..word.len());
        let is_found = found.is_some_and(|text| text.eq_ignore_ascii_case(word.as_bytes()));
        self.at += if is_found { word.len() } else { 0 };
        is_found
    }

    /// The value of a word: a number, a variable, an expression or a function, with a sign.
    pub fn value(&mut self) -> Result<Read, Fault> {
        self.signed(0)
    }

    /// The right side of an assignment. Fanuc's needs no brackets.
    pub fn assigned(&mut self) -> Result<Value, Fault> {
        match self.language {
            Language::Fanuc => self.operations(0, 0),
            _ => self.value().map(|read| read.value),
        }
    }

    fn signed(&mut self, depth: usize) -> Result<Read, Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        self.skip_blanks();
        let sign = match self.peek() {
            Some(b'-') => -1.0,
            Some(b'+') => 1.0,
            _ => return self.unsigned(depth),
        };
        self.at += 1;
        self.skip_blanks();
        let read = match self.peek() {
            Some(b'-' | b'+') if self.language != Language::None => self.signed(depth + 1)?,
            Some(b'-' | b'+') => return Err(Fault::NoNumber),
            _ => self.unsigned(depth)?,
        };
        Ok(Read { value: read.value.map(|value| sign * value), ..read })
    }

    fn unsigned(&mut self, depth: usize) -> Result<Read, Fault> {
        let computed = |value| Ok(Read { value, lacks_point: false, is_literal: false });
        match self.peek() {
            Some(b'0'..=b'9' | b'.') => self.number(),
            _ if self.language == Language::None => Err(Fault::NoNumber),
            Some(b'#') => {
                let variable = self.variable(depth + 1)?;
                computed(self.value_of(&variable)?)
            }
            Some(b'[') => computed(self.brackets(depth + 1)?),
            Some(letter) if letter.is_ascii_alphabetic() => computed(self.function(depth + 1)?),
            _ => Err(Fault::NoNumber),
        }
    }

    fn number(&mut self) -> Result<Read, Fault> {
        let start = self.at;
        let (mut digits, mut points) = (0, 0);
        while let Some(byte @ (b'0'..=b'9' | b'.')) = self.peek() {
            if byte == b'.' && points == 1 {
                break;
            }
            points += usize::from(byte == b'.');
            digits += usize::from(byte != b'.');
            self.at += 1;
        }
        let text = std::str::from_utf8(&self.line[start..self.at]).unwrap_or_default();
        let value = text.parse::<f64>().ok().filter(|value| digits > 0 && value.is_finite());
        let value = value.ok_or(Fault::NoNumber)?;
        Ok(Read { value: Some(value), lacks_point: points == 0, is_literal: true })
    }

    /// The variable after `#`.
    pub fn variable(&mut self, depth: usize) -> Result<Variable, Fault> {
        if !self.take(b'#') {
            return Err(Fault::BadExpression);
        }
        if self.language == Language::LinuxCnc && self.take(b'<') {
            return Ok(Variable::Named(self.name()?));
        }
        let number = self.signed(depth + 1)?.value.ok_or(Fault::NoValue("the number is vacant"))?;
        if (0.0..=100_000.0).contains(&number) && (number - number.round()).abs() < 1e-6 {
            Ok(Variable::Numbered(number.round() as u32))
        } else {
            Err(Fault::OutOfRange(number))
        }
    }

    /// A name up to `>`, in lower case and without blanks.
    pub fn name(&mut self) -> Result<String, Fault> {
        let rest = &self.line[self.at..];
        let end = rest.iter().position(|c| *c == b'>').filter(|end| *end <= MAX_NAME);
        let end = end.ok_or(Fault::BadExpression)?;
        self.at += end + 1;
        let letters = rest[..end].iter().filter(|c| !c.is_ascii_whitespace());
        Ok(letters.map(|c| c.to_ascii_lowercase() as char).collect())
    }

    fn value_of(&self, variable: &Variable) -> Result<Value, Fault> {
        match variable {
            Variable::Numbered(number) => self.variables.numbered(*number),
            Variable::Named(name) => self.variables.named(name).map(Some),
        }
    }

    /// An expression in brackets.
    pub fn brackets(&mut self, depth: usize) -> Result<Value, Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        if !self.take(b'[') {
            return Err(Fault::BadExpression);
        }
        let value = self.operations(0, depth)?;
        if self.take(b']') { Ok(value) } else { Err(Fault::BadExpression) }
    }

    /// Operands with operators of at least the rank `least`.
    fn operations(&mut self, least: usize, depth: usize) -> Result<Value, Fault> {
        let mut left = self.signed(depth)?.value;
        loop {
            let start = self.at;
            let Some((operator, rank)) = self.operator().filter(|(_, rank)| *rank >= least) else {
                self.at = start;
                return Ok(left);
            };
            let right = self.operations(rank + 1, depth + 1)?;
            left = self.applied(operator, left, right)?;
        }
    }

    fn operator(&mut self) -> Option<(Operator, usize)> {
        self.skip_blanks();
        let linuxcnc = self.language == Language::LinuxCnc;
        if linuxcnc && self.take_word("**") {
            return Some((Operator::Power, 4));
        }
        let (logic_and, logic_or) = if linuxcnc { (0, 0) } else { (3, 2) };
        let table = [
            ("MOD", Operator::Mod, 3),
            ("AND", Operator::And, logic_and),
            ("XOR", Operator::Xor, logic_or),
            ("OR", Operator::Or, logic_or),
            ("EQ", Operator::Eq, 1),
            ("NE", Operator::Ne, 1),
            ("GT", Operator::Gt, 1),
            ("GE", Operator::Ge, 1),
            ("LT", Operator::Lt, 1),
            ("LE", Operator::Le, 1),
            ("*", Operator::Times, 3),
            ("/", Operator::Over, 3),
            ("+", Operator::Plus, 2),
            ("-", Operator::Minus, 2),
        ];
        table.into_iter().find(|(word, ..)| self.take_word(word)).map(|(_, operator, rank)| (operator, rank))
    }

    fn applied(&self, operator: Operator, left: Value, right: Value) -> Result<Value, Fault> {
        use Operator::*;
        let truth = |is_true: bool| Some(f64::from(u8::from(is_true)));
        if left.is_none() != right.is_none() && matches!(operator, Eq | Ne) {
            return Ok(truth(operator == Ne));
        }
        let (a, b) = (left.unwrap_or(0.0), right.unwrap_or(0.0));
        let bits = |value: f64| value.round() as i64;
        let is_fanuc = self.language != Language::LinuxCnc;
        let value = match operator {
            Power => a.powf(b),
            Times => a * b,
            Over if b == 0.0 => return Err(Fault::NoValue("division by zero")),
            Over => a / b,
            Mod if b == 0.0 => return Err(Fault::NoValue("division by zero")),
            // LinuxCNC's remainder is never negative.
            Mod if !is_fanuc => a.rem_euclid(b),
            Mod => a % b,
            Plus => a + b,
            Minus => a - b,
            And if is_fanuc => (bits(a) & bits(b)) as f64,
            Or if is_fanuc => (bits(a) | bits(b)) as f64,
            Xor if is_fanuc => (bits(a) ^ bits(b)) as f64,
            And => return Ok(truth(a != 0.0 && b != 0.0)),
            Or => return Ok(truth(a != 0.0 || b != 0.0)),
            Xor => return Ok(truth((a != 0.0) != (b != 0.0))),
            Eq => return Ok(truth(equal(a, b))),
            Ne => return Ok(truth(!equal(a, b))),
            Gt => return Ok(truth(a > b && !equal(a, b))),
            Ge => return Ok(truth(a > b || equal(a, b))),
            Lt => return Ok(truth(a < b && !equal(a, b))),
            Le => return Ok(truth(a < b || equal(a, b))),
        };
        finite(value)
    }

    fn function(&mut self, depth: usize) -> Result<Value, Fault> {
        let start = self.at;
        while self.peek().is_some_and(|c| c.is_ascii_alphabetic()) {
            self.at += 1;
        }
        let name: String = self.line[start..self.at].iter().map(|c| c.to_ascii_uppercase() as char).collect();
        if self.language == Language::LinuxCnc && name == "EXISTS" {
            return Err(Fault::AtMachine);
        }
        let known = [
            "SIN", "COS", "TAN", "ASIN", "ACOS", "ATAN", "SQRT", "SQR", "ABS", "ROUND", "RND", "FIX", "FUP",
            "LN", "EXP",
        ];
        if !known.contains(&name.as_str()) {
            self.at = start;
            return Err(Fault::NoNumber);
        }
        let a = self.brackets(depth)?.unwrap_or(0.0);
        let in_domain = |is_in: bool| if is_in { Ok(()) } else { Err(Fault::NoValue("outside the domain")) };
        let value = match name.as_str() {
            "SIN" => a.to_radians().sin(),
            "COS" => a.to_radians().cos(),
            "TAN" => a.to_radians().tan(),
            "ASIN" => {
                in_domain(a.abs() <= 1.0)?;
                a.asin().to_degrees()
            }
            "ACOS" => {
                in_domain(a.abs() <= 1.0)?;
                a.acos().to_degrees()
            }
            "ATAN" if self.take(b'/') => {
                let b = self.brackets(depth)?.unwrap_or(0.0);
                let angle = a.atan2(b).to_degrees();
                // Fanuc counts from 0 to 360.
                if self.language == Language::LinuxCnc { angle } else { angle.rem_euclid(360.0) }
            }
            "ATAN" => a.atan().to_degrees(),
            "SQRT" | "SQR" => {
                in_domain(a >= 0.0)?;
                a.sqrt()
            }
            "ABS" => a.abs(),
            "ROUND" | "RND" => a.round(),
            "FIX" if self.language == Language::LinuxCnc => a.floor(),
            "FUP" if self.language == Language::LinuxCnc => a.ceil(),
            "FIX" => a.trunc(),
            "FUP" => a.signum() * a.abs().ceil(),
            "LN" => {
                in_domain(a > 0.0)?;
                a.ln()
            }
            _ => a.exp(),
        };
        finite(value)
    }
}

fn finite(value: f64) -> Result<Value, Fault> {
    if value.is_finite() { Ok(Some(value)) } else { Err(Fault::NoValue("the result is not finite")) }
}

/// Whether two values count as equal: both languages allow for the rounding of sums of decimals.
fn equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs().max(b.abs()))
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Operator {
    Power,
    Times,
    Over,
    Mod,
    Plus,
    Minus,
    And,
    Or,
    Xor,
    Eq,
    Ne,
    Gt,
    Ge,
    Lt,
    Le,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(language: Language, text: &str) -> Result<Value, Fault> {
        let variables = Variables::new(language);
        let mut reader = Reader { line: text.as_bytes(), at: 0, variables: &variables, language };
        reader.value().map(|read| read.value)
    }

    #[test]
    fn operators_bind_as_in_each_language() {
        let fanuc = |text| value(Language::Fanuc, text);
        let linuxcnc = |text| value(Language::LinuxCnc, text);
        for (text, expected) in [
            ("[2+3*4]", 14.0),
            ("[[2+3]*4]", 20.0),
            ("[10-2-3]", 5.0),
            ("-[2*3]", -6.0),
            ("[7 MOD 4]", 3.0),
            ("[1 LT 2]", 1.0),
            ("SIN[30]", 0.5),
            ("SQRT[2+2]", 2.0),
            ("ATAN[1]/[1]", 45.0),
            ("[2*-3]", -6.0),
        ] {
            for of in [fanuc(text), linuxcnc(text)] {
                assert!((of.unwrap().unwrap() - expected).abs() < 1e-12, "{text}");
            }
        }
        assert_eq!((fanuc("[6 AND 3]"), linuxcnc("[6 AND 3]")), (Ok(Some(2.0)), Ok(Some(1.0))));
        assert_eq!((fanuc("FIX[-1.5]"), linuxcnc("FIX[-1.5]")), (Ok(Some(-1.0)), Ok(Some(-2.0))));
        assert_eq!(linuxcnc("[2**3*2]"), Ok(Some(16.0)));
        assert_eq!(fanuc("[#1 EQ #0]"), Ok(Some(1.0)));
        assert_eq!(fanuc("[#1 EQ 0]"), Ok(Some(0.0)));
    }

    #[test]
    fn what_has_no_value_is_told() {
        for text in ["[1/0]", "SQRT[-1]", "[1", "[]", "#501", "ASIN[2]", "LOG[1]", ".", "-"] {
            assert!(value(Language::Fanuc, text).is_err(), "{text}");
        }
        assert!(value(Language::None, "[1]").is_err());
        let deep = "[".repeat(5000);
        assert_eq!(value(Language::Fanuc, &deep), Err(Fault::TooDeep));
    }
}
