//! Numbers, variables and expressions of a line.
//!
//! Operators and functions are those of `operators`.

use super::operators::{Operator, applied, finite, function, whole};
use super::text::{blanks, name_at};
use super::values::{Value, Variable, Variables};
use crate::fault::Fault;

/// Deepest nesting of parentheses. Deeper nesting could exhaust the stack.
const MAX_DEPTH: usize = 48;

/// Reads values from one line without its comment.
pub struct Reader<'t, 'v> {
    pub text: &'t [u8],
    pub at: usize,
    pub variables: &'v Variables,
}

impl Reader<'_, '_> {
    pub fn skip_blanks(&mut self) {
        self.at = blanks(self.text, self.at);
    }

    pub fn peek(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    /// Takes `byte`, after blanks.
    pub fn take(&mut self, byte: u8) -> bool {
        self.skip_blanks();
        let found = self.peek() == Some(byte);
        self.at += usize::from(found);
        found
    }

    pub fn is_at_end(&mut self) -> bool {
        self.skip_blanks();
        self.at >= self.text.len()
    }

    /// Takes the name `word`, after blanks.
    pub fn take_name(&mut self, word: &str) -> bool {
        self.skip_blanks();
        match name_at(self.text, self.at) {
            Some((name, end)) if name == word => {
                self.at = end;
                true
            }
            _ => false,
        }
    }

    /// The name at this place, after blanks.
    pub fn name(&mut self) -> Option<String> {
        self.skip_blanks();
        let (name, end) = name_at(self.text, self.at)?;
        self.at = end;
        Some(name)
    }

    /// # Errors
    /// When no expression stands here, or it has no value.
    pub fn value(&mut self) -> Result<Value, Fault> {
        self.operations(0, 0)
    }

    /// # Errors
    /// As [`Reader::value`], and for a text.
    pub fn number(&mut self) -> Result<f64, Fault> {
        self.value()?.number()
    }

    /// A number as it is written behind an address letter, with a sign.
    ///
    /// # Errors
    /// When no number stands here.
    pub fn literal(&mut self) -> Result<f64, Fault> {
        let sign = match self.peek() {
            Some(b'-') => -1.0,
            Some(b'+') => 1.0,
            _ => return self.unsigned_literal(),
        };
        self.at += 1;
        Ok(sign * self.unsigned_literal()?)
    }

    fn unsigned_literal(&mut self) -> Result<f64, Fault> {
        let start = self.at;
        let mut points = 0;
        while let Some(byte @ (b'0'..=b'9' | b'.')) = self.peek() {
            points += usize::from(byte == b'.');
            if points == 2 {
                break;
            }
            self.at += 1;
        }
        let mut text = String::from_utf8_lossy(&self.text[start..self.at]).into_owned();
        if !text.bytes().any(|c| c.is_ascii_digit()) {
            return Err(Fault::NoNumber);
        }
        // EX and a whole number are a power of ten.
        let rest = &self.text[self.at..];
        let rest = rest[..rest.len().min(7)].to_ascii_uppercase();
        let sign = usize::from(matches!(rest.get(2), Some(b'-' | b'+')));
        let digits = rest.iter().skip(2 + sign).take_while(|c| c.is_ascii_digit()).count();
        if rest.starts_with(b"EX") && (1..=3).contains(&digits) {
            text.push('e');
            text.push_str(&String::from_utf8_lossy(&rest[2..2 + sign + digits]));
            self.at += 2 + sign + digits;
        }
        text.parse::<f64>().ok().filter(|value| value.is_finite()).ok_or(Fault::NoNumber)
    }

    /// Operands with operators of at least the rank `least`.
    fn operations(&mut self, least: usize, depth: usize) -> Result<Value, Fault> {
        let mut left = self.signed(depth)?;
        let mut has_compared = false;
        loop {
            let start = self.at;
            let Some(operator) = self.operator().filter(|operator| operator.rank() >= least) else {
                self.at = start;
                return Ok(left);
            };
            // `R1==1 AND R2==2` compares twice in one expression, which the control does not mean.
            if operator.rank() == 0 && has_compared {
                return Err(Fault::BadExpression);
            }
            has_compared |= operator.rank() == 0;
            let right = self.operations(operator.rank() + 1, depth + 1)?;
            left = applied(operator, &left, &right)?;
        }
    }

    fn operator(&mut self) -> Option<Operator> {
        use Operator::*;
        self.skip_blanks();
        if let Some((name, end)) = name_at(self.text, self.at) {
            let operator = match name.as_str() {
                "DIV" => Div,
                "MOD" => Mod,
                "AND" => And,
                "OR" => Or,
                "XOR" => Xor,
                "B_AND" => BitAnd,
                "B_OR" => BitOr,
                "B_XOR" => BitXor,
                _ => return None,
            };
            self.at = end;
            return Some(operator);
        }
        let signs: [(&[u8], Operator); 11] = [
            (b"<<", Join),
            (b"==", Equal),
            (b"<>", Unequal),
            (b"<=", LessOrEqual),
            (b">=", GreaterOrEqual),
            (b"<", Less),
            (b">", Greater),
            (b"*", Times),
            (b"/", Over),
            (b"+", Plus),
            (b"-", Minus),
        ];
        let rest = &self.text[self.at.min(self.text.len())..];
        let (sign, operator) = signs.iter().find(|(sign, _)| rest.starts_with(sign))?;
        self.at += sign.len();
        Some(*operator)
    }

    fn signed(&mut self, depth: usize) -> Result<Value, Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        self.skip_blanks();
        match self.peek() {
            Some(sign @ (b'-' | b'+')) => {
                self.at += 1;
                let value = self.signed(depth + 1)?.number()?;
                Ok(Value::Number(if sign == b'-' { -value } else { value }))
            }
            _ => self.operand(depth),
        }
    }

    fn operand(&mut self, depth: usize) -> Result<Value, Fault> {
        match self.peek() {
            Some(b'0'..=b'9' | b'.') => self.unsigned_literal().map(Value::Number),
            Some(b'"') => self.string().map(Value::Text),
            Some(b'(') => self.parentheses(depth),
            Some(b'$') => self.system_variable(),
            Some(b'R' | b'r') if name_at(self.text, self.at).is_none() => {
                let variable = self.parameter(depth)?;
                self.variables.value(&variable)
            }
            Some(_) => {
                let start = self.at;
                let name = self.name().ok_or(Fault::BadExpression)?;
                let value = self.named(&name, depth);
                if value == Err(Fault::BadExpression) {
                    self.at = start;
                }
                value
            }
            None => Err(Fault::BadExpression),
        }
    }

    /// A text in quotes.
    ///
    /// # Errors
    /// When no text stands here, or it has no end.
    pub fn string(&mut self) -> Result<String, Fault> {
        if !self.take(b'"') {
            return Err(Fault::BadExpression);
        }
        let rest = &self.text[self.at..];
        let end = rest.iter().position(|c| *c == b'"').ok_or(Fault::BadExpression)?;
        self.at += end + 1;
        Ok(String::from_utf8_lossy(&rest[..end]).into_owned())
    }

    fn parentheses(&mut self, depth: usize) -> Result<Value, Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        if !self.take(b'(') {
            return Err(Fault::BadExpression);
        }
        let value = self.operations(0, depth + 1)?;
        if self.take(b')') { Ok(value) } else { Err(Fault::BadExpression) }
    }

    fn system_variable(&mut self) -> Result<Value, Fault> {
        if self.text[self.at..].get(..3).is_some_and(|word| word.eq_ignore_ascii_case(b"$PI")) {
            let is_longer =
                self.text.get(self.at + 3).is_some_and(|c| c.is_ascii_alphanumeric() || *c == b'_');
            if !is_longer {
                self.at += 3;
                return Ok(Value::Number(std::f64::consts::PI));
            }
        }
        Err(Fault::AtMachine)
    }

    /// An R parameter: `R1` or `R[1]`.
    ///
    /// # Errors
    /// When none stands here, or its number is out of range.
    pub fn parameter(&mut self, depth: usize) -> Result<Variable, Fault> {
        self.at += 1;
        let number = match self.peek() {
            Some(b'[') => self.index(depth)?,
            Some(b'0'..=b'9') => {
                let digits = self.text[self.at..].iter().take_while(|c| c.is_ascii_digit()).count();
                let text = String::from_utf8_lossy(&self.text[self.at..self.at + digits]).into_owned();
                self.at += digits;
                text.parse().map_err(|_| Fault::BadExpression)?
            }
            _ => return Err(Fault::BadExpression),
        };
        u32::try_from(number)
            .ok()
            .filter(|number| *number <= 32_767)
            .map(Variable::Numbered)
            .ok_or(Fault::OutOfRange(number as f64))
    }

    /// A whole number in brackets.
    ///
    /// # Errors
    /// When none stands here.
    pub fn index(&mut self, depth: usize) -> Result<usize, Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        if !self.take(b'[') {
            return Err(Fault::BadExpression);
        }
        let value = self.operations(0, depth + 1)?.number()?;
        if !self.take(b']') {
            return Err(Fault::BadExpression);
        }
        if value.fract() == 0.0 && (0.0..=1e6).contains(&value) {
            Ok(value as usize)
        } else {
            Err(Fault::OutOfRange(value))
        }
    }

    /// The variable of this name, with the index of a field.
    ///
    /// # Errors
    /// When the index cannot be read.
    pub fn variable(&mut self, name: String, depth: usize) -> Result<Variable, Fault> {
        let index = if self.peek() == Some(b'[') { Some(self.index(depth)?) } else { None };
        Ok(Variable::Named(name, index))
    }

    fn named(&mut self, name: &str, depth: usize) -> Result<Value, Fault> {
        match name {
            "TRUE" => return Ok(Value::truth(true)),
            "FALSE" => return Ok(Value::truth(false)),
            "NOT" => return Ok(Value::truth(self.signed(depth + 1)?.number()? == 0.0)),
            "B_NOT" => {
                let bits = whole(self.signed(depth + 1)?.number()?)?;
                return Ok(Value::Number(!bits as f64));
            }
            _ => {}
        }
        if self.variables.is_defined(name) {
            let variable = self.variable(name.to_owned(), depth)?;
            return self.variables.value(&variable);
        }
        match name {
            "SIN" | "COS" | "TAN" | "ASIN" | "ACOS" | "ATAN2" | "SQRT" | "ABS" | "POT" | "TRUNC"
            | "ROUND" | "LN" | "EXP" | "MINVAL" | "MAXVAL" | "BOUND" => self.function(name, depth),
            // A variable of the control, or a function that asks the control.
            _ => Err(Fault::AtMachine),
        }
    }

    fn function(&mut self, name: &str, depth: usize) -> Result<Value, Fault> {
        if depth > MAX_DEPTH {
            return Err(Fault::TooDeep);
        }
        if !self.take(b'(') {
            return Err(Fault::BadExpression);
        }
        let mut arguments = vec![self.operations(0, depth + 1)?.number()?];
        while arguments.len() < 3 && self.take(b',') {
            arguments.push(self.operations(0, depth + 1)?.number()?);
        }
        if !self.take(b')') {
            return Err(Fault::BadExpression);
        }
        finite(function(name, &arguments)?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<Value, Fault> {
        let variables = Variables::new();
        Reader { text: text.as_bytes(), at: 0, variables: &variables }.value()
    }

    #[test]
    fn operators_bind_as_the_manual_says() {
        for (text, expected) in [
            ("2+3*4", 14.0),
            ("(2+3)*4", 20.0),
            ("10-2-3", 5.0),
            ("-2*3", -6.0),
            ("7 DIV 2", 3.0),
            ("7 MOD 4", 3.0),
            ("7/2", 3.5),
            ("6 B_AND 3", 2.0),
            ("1+1==2", 1.0),
            ("(1==1) AND (2<>2)", 0.0),
            ("NOT (1==2)", 1.0),
            ("SIN(30)", 0.5),
            ("ATAN2(1,1)", 45.0),
            ("POT(3)+SQRT(16)", 13.0),
            ("TRUNC(-1.5)", -1.0),
            ("ROUND(1.5)", 2.0),
            ("0.1+0.2==0.3", 1.0),
            ("MINVAL(2,MAXVAL(3,4))", 2.0),
            ("1.5EX3", 1500.0),
            ("$PI", std::f64::consts::PI),
            ("\"A\"<<\"B\"==\"AB\"", 1.0),
        ] {
            let found = value(text).and_then(|value| value.number()).unwrap();
            assert!((found - expected).abs() < 1e-12, "{text} {found}");
        }
    }

    #[test]
    fn what_has_no_value_is_told() {
        for text in ["1/0", "SQRT(-1)", "(1", "()", "R1", "ASIN(2)", "$P_TOOLNO", "FOO", ".", "-", "1==1==1"]
        {
            assert!(value(text).is_err(), "{text}");
        }
        for deep in ["(".repeat(5000), "-".repeat(5000), "NOT ".repeat(5000), "ABS(".repeat(5000)] {
            assert_eq!(value(&deep), Err(Fault::TooDeep));
        }
        assert_eq!(value("R1==1 AND R2==2"), Err(Fault::AtMachine));
    }
}
