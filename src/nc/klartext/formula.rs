//! Formulas of Q parameters, and the functions FN 0 to FN 13.
//!
//! # Method
//! Functions bind their operand first, then `^`, then `*` and `/`, then `+` and `-`; operations of one rank
//! run from left to right. Angles are in degrees.
//!
//! # Guarantees
//! What controls of different age compute in different ways is refused: a power of a power, of a negated
//! base or of a function without parentheses, the sign of zero, and the remainder of a negative number.

use super::cursor::{Broken, Cursor};
use super::parameters::Parameters;
use crate::fault::Fault;

/// Deepest nesting of parentheses and functions.
const MAX_DEPTH: usize = 64;

const FUNCTIONS: [&str; 16] = [
    "ASIN", "ACOS", "ATAN", "SQRT", "FRAC", "SIN", "COS", "TAN", "ABS", "INT", "LOG", "EXP", "NEG", "SGN",
    "SQ", "LN",
];

/// Reads a formula.
pub struct Formula<'t, 'p> {
    pub cursor: Cursor<'t>,
    pub parameters: &'p Parameters,
}

/// An operand, and whether a power may follow it.
struct Operand {
    value: f64,
    is_plain: bool,
}

impl Formula<'_, '_> {
    fn broken(&self, start: usize, fault: Fault) -> Broken {
        Broken { fault: Some(fault), start, end: self.cursor.word_end().max(start + 1) }
    }

    fn checked(&self, start: usize, value: f64) -> Result<f64, Broken> {
        if value.is_finite() {
            Ok(value)
        } else {
            Err(self.broken(start, Fault::NoValue("the result is not finite")))
        }
    }

    /// The whole formula, up to the end of the block.
    pub fn read(&mut self) -> Result<f64, Broken> {
        let value = self.sum(0)?;
        if self.cursor.is_done() { Ok(value) } else { Err(self.broken(self.cursor.at, Fault::BadExpression)) }
    }

    pub fn sum(&mut self, depth: usize) -> Result<f64, Broken> {
        let start = self.cursor.at;
        let mut left = self.product(depth)?;
        loop {
            if self.cursor.take(b'+') {
                left += self.product(depth)?;
            } else if self.cursor.take(b'-') {
                left -= self.product(depth)?;
            } else {
                return self.checked(start, left);
            }
        }
    }

    fn product(&mut self, depth: usize) -> Result<f64, Broken> {
        let start = self.cursor.at;
        let mut left = self.power(depth)?;
        loop {
            if self.cursor.take(b'*') {
                left *= self.power(depth)?;
            } else if self.cursor.take(b'/') || self.cursor.phrase("DIV") {
                let right = self.power(depth)?;
                left = self.quotient(start, left, right)?;
            } else if self.cursor.take(b'%') {
                let right = self.power(depth)?;
                if left < 0.0 || right <= 0.0 {
                    return Err(self.broken(start, Fault::BadExpression));
                }
                left %= right;
            } else {
                return self.checked(start, left);
            }
        }
    }

    fn quotient(&self, start: usize, left: f64, right: f64) -> Result<f64, Broken> {
        if right == 0.0 {
            return Err(self.broken(start, Fault::NoValue("division by zero")));
        }
        Ok(left / right)
    }

    fn power(&mut self, depth: usize) -> Result<f64, Broken> {
        let start = self.cursor.at;
        let base = self.operand(depth)?;
        if !self.cursor.take(b'^') {
            return Ok(base.value);
        }
        let exponent = self.operand(depth)?.value;
        self.cursor.skip_blanks();
        if !base.is_plain || self.cursor.peek() == Some(b'^') {
            return Err(self.broken(start, Fault::BadExpression));
        }
        self.checked(start, base.value.powf(exponent))
    }

    fn operand(&mut self, depth: usize) -> Result<Operand, Broken> {
        self.cursor.skip_blanks();
        let start = self.cursor.at;
        if depth > MAX_DEPTH {
            return Err(self.broken(start, Fault::TooDeep));
        }
        if self.cursor.take(b'(') {
            let value = self.sum(depth + 1)?;
            let is_closed = self.cursor.take(b')');
            return if is_closed {
                Ok(Operand { value, is_plain: true })
            } else {
                Err(self.broken(start, Fault::BadExpression))
            };
        }
        if let Some(sign @ (b'-' | b'+')) = self.cursor.peek() {
            self.cursor.at += 1;
            let inner = self.operand(depth + 1)?;
            let is_minus = sign == b'-';
            let value = if is_minus { -inner.value } else { inner.value };
            return Ok(Operand { value, is_plain: inner.is_plain && !is_minus });
        }
        if let Some(name) = FUNCTIONS.iter().find(|name| self.takes_function(name)) {
            let argument = self.operand(depth + 1)?.value;
            return Ok(Operand { value: self.applied(start, name, argument)?, is_plain: false });
        }
        if self.cursor.phrase("PI") {
            return Ok(Operand { value: std::f64::consts::PI, is_plain: true });
        }
        if matches!(self.cursor.peek(), Some(b'Q' | b'0'..=b'9' | b'.' | b',')) {
            return Ok(Operand { value: self.cursor.value(self.parameters)?, is_plain: true });
        }
        Err(self.broken(start, Fault::BadExpression))
    }

    /// Takes the name of a function. A parameter may follow it without a blank.
    fn takes_function(&mut self, name: &str) -> bool {
        let mut probe = self.cursor;
        let is_found = probe.letters(name)
            && (!probe.peek().is_some_and(|c| c.is_ascii_alphabetic()) || probe.parameter().is_some());
        self.cursor.at += if is_found { name.len() } else { 0 };
        is_found
    }

    fn applied(&self, start: usize, name: &str, a: f64) -> Result<f64, Broken> {
        let is_legal = match name {
            "ASIN" | "ACOS" => a.abs() <= 1.0,
            "SQRT" => a >= 0.0,
            "LN" | "LOG" => a > 0.0,
            "SGN" => a != 0.0,
            _ => true,
        };
        if !is_legal {
            return Err(self.broken(start, Fault::NoValue("outside the domain")));
        }
        let value = match name {
            "SIN" => sine(a),
            "COS" => sine(90.0 - a),
            "TAN" => sine(a) / sine(90.0 - a),
            "ASIN" => a.asin().to_degrees(),
            "ACOS" => a.acos().to_degrees(),
            "ATAN" => a.atan().to_degrees(),
            "SQRT" => a.sqrt(),
            "SQ" => a * a,
            "ABS" => a.abs(),
            "INT" => a.trunc(),
            "FRAC" => a.fract(),
            "LN" => a.ln(),
            "LOG" => a.log10(),
            "EXP" => a.exp(),
            "NEG" => -a,
            _ => a.signum(),
        };
        self.checked(start, value)
    }

    /// The value that FN 0 to FN 8 or FN 13 assigns, from behind the equals sign.
    pub fn assigned(&mut self, function: u32) -> Result<f64, Broken> {
        let start = self.cursor.at;
        let prefix = match function {
            5 => "SQRT",
            6 => "SIN",
            7 => "COS",
            _ => "",
        };
        self.cursor.skip_blanks();
        if !self.cursor.letters(prefix) {
            return Err(self.broken(start, Fault::BadExpression));
        }
        let a = self.cursor.value(self.parameters)?;
        let operator = match function {
            1 => "+",
            2 => "-",
            3 => "*",
            4 => "DIV",
            8 => "LEN",
            13 => "ANG",
            _ => "",
        };
        self.cursor.skip_blanks();
        if !(self.cursor.letters(operator) || function == 4 && self.cursor.take(b'/')) {
            return Err(self.broken(start, Fault::BadExpression));
        }
        let b = if operator.is_empty() { 0.0 } else { self.cursor.value(self.parameters)? };
        if !self.cursor.is_done() {
            return Err(self.broken(self.cursor.at, Fault::BadExpression));
        }
        let value = match function {
            1 => a + b,
            2 => a - b,
            3 => a * b,
            4 => self.quotient(start, a, b)?,
            5..=7 => self.applied(start, prefix, a)?,
            8 => a.hypot(b),
            13 if a == 0.0 && b == 0.0 => {
                return Err(self.broken(start, Fault::NoValue("outside the domain")));
            }
            13 => a.atan2(b).to_degrees().rem_euclid(360.0),
            _ => a,
        };
        self.checked(start, value)
    }
}

/// The sine of an angle in degrees; multiples of 90 degrees are exact.
fn sine(degrees: f64) -> f64 {
    match degrees.rem_euclid(360.0) {
        0.0 | 180.0 => 0.0,
        90.0 => 1.0,
        270.0 => -1.0,
        angle => angle.to_radians().sin(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<f64, Option<Fault>> {
        let parameters = Parameters::default();
        let cursor = Cursor::new(text.as_bytes());
        Formula { cursor, parameters: &parameters }.read().map_err(|broken| broken.fault)
    }

    #[test]
    fn operations_have_the_ranks_of_the_manual() {
        for (text, expected) in [
            ("5 * 3 + 2 * 10", 35.0),
            ("SQ 10 - 3 ^ 3", 73.0),
            ("10 - 2 - 3", 5.0),
            ("8 / 4 / 2", 1.0),
            ("2 * (3 + 4)", 14.0),
            ("SIN 30 + 1", 1.5),
            ("- 5 + 2 * -3", -11.0),
            ("COS 60 * TAN 45", 0.5),
            ("ATAN 1 + ACOS 0 + ASIN 1", 225.0),
            ("INT 3,7 + FRAC 3,25 - ABS -2", 1.25),
            ("LN EXP 2 + LOG 1000", 5.0),
            ("NEG 3 + SGN -2 + SQRT 16", 0.0),
            ("400 % 360", 40.0),
            ("10 ^ -1 + 2 ^ NEG 1", 0.6),
            ("2 * PI / 2", std::f64::consts::PI),
        ] {
            let found = value(text).unwrap();
            assert!((found - expected).abs() < 1e-12, "{text}: {found}");
        }
    }

    #[test]
    fn what_has_no_certain_value_is_refused() {
        for text in
            ["", "1 +", "(1", "1)", "2^3^2", "-2^2", "SQ 2^2", "1/0", "SQRT -1", "SGN 0", "-5 % 3", "5 X"]
        {
            assert!(value(text).is_err(), "{text}");
        }
        assert_eq!(value("Q5 + 1"), Err(Some(Fault::AtMachine)));
        assert_eq!(value(&"(".repeat(9000)), Err(Some(Fault::TooDeep)));
        assert_eq!(value(&"-".repeat(9000)), Err(Some(Fault::TooDeep)));
        assert_eq!(value(&"SQ ".repeat(9000)), Err(Some(Fault::TooDeep)));
    }
}
