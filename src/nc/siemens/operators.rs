//! Operators and functions of expressions.
//!
//! The ranks of the operators are those of the manual *Job planning*: comparisons bind weakest, and NOT binds
//! strongest. Angles are in degrees. Values that differ by a part of 1e-12 count as equal.

use super::values::Value;
use crate::fault::Fault;

/// Parts of the larger value below which two values count as equal.
const SAME: f64 = 1e-12;

/// Longest text that an expression makes, bytes.
const MAX_TEXT: usize = 400;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Operator {
    Times,
    Over,
    Div,
    Mod,
    Plus,
    Minus,
    BitAnd,
    BitXor,
    BitOr,
    And,
    Xor,
    Or,
    Join,
    Equal,
    Unequal,
    Less,
    Greater,
    LessOrEqual,
    GreaterOrEqual,
}

impl Operator {
    /// A higher rank binds stronger.
    pub fn rank(self) -> usize {
        use Operator::*;
        match self {
            Times | Over | Div | Mod => 9,
            Plus | Minus => 8,
            BitAnd => 7,
            BitXor => 6,
            BitOr => 5,
            And => 4,
            Xor => 3,
            Or => 2,
            Join => 1,
            _ => 0,
        }
    }
}

/// The value of a function; angles are in degrees.
///
/// # Errors
/// When the function has no value there, or takes other arguments.
pub fn function(name: &str, arguments: &[f64]) -> Result<f64, Fault> {
    let in_domain = |is_in: bool| if is_in { Ok(()) } else { Err(Fault::NoValue("outside the domain")) };
    let a = arguments[0];
    Ok(match (name, arguments) {
        ("SIN", [_]) => a.to_radians().sin(),
        ("COS", [_]) => a.to_radians().cos(),
        ("TAN", [_]) => a.to_radians().tan(),
        ("ASIN", [_]) => {
            in_domain(a.abs() <= 1.0)?;
            a.asin().to_degrees()
        }
        ("ACOS", [_]) => {
            in_domain(a.abs() <= 1.0)?;
            a.acos().to_degrees()
        }
        ("ATAN2", [_, b]) => a.atan2(*b).to_degrees(),
        ("SQRT", [_]) => {
            in_domain(a >= 0.0)?;
            a.sqrt()
        }
        ("ABS", [_]) => a.abs(),
        ("POT", [_]) => a * a,
        ("TRUNC", [_]) if is_same(a, a.round()) => a.round(),
        ("TRUNC", [_]) => a.trunc(),
        ("ROUND", [_]) => (a + 0.5).floor(),
        ("LN", [_]) => {
            in_domain(a > 0.0)?;
            a.ln()
        }
        ("EXP", [_]) => a.exp(),
        ("MINVAL", [_, b]) => a.min(*b),
        ("MAXVAL", [_, b]) => a.max(*b),
        ("BOUND", [_, most, value]) if a <= *most => value.clamp(a, *most),
        _ => return Err(Fault::BadExpression),
    })
}

fn is_same(a: f64, b: f64) -> bool {
    (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// # Errors
/// When the value is not finite.
pub fn finite(value: f64) -> Result<Value, Fault> {
    if value.is_finite() { Ok(Value::Number(value)) } else { Err(Fault::NoValue("the result is not finite")) }
}

/// The bits of a whole number.
///
/// # Errors
/// When the number is not whole, or too large.
pub fn whole(value: f64) -> Result<i32, Fault> {
    if value.fract() == 0.0 && value.abs() <= f64::from(i32::MAX) {
        Ok(value as i32)
    } else {
        Err(Fault::OutOfRange(value))
    }
}

/// The value of an operator between two operands.
///
/// # Errors
/// When there is none.
pub fn applied(operator: Operator, left: &Value, right: &Value) -> Result<Value, Fault> {
    use Operator::*;
    if operator == Join {
        return match (left, right) {
            (Value::Text(a), Value::Text(b)) if a.len() + b.len() <= MAX_TEXT => {
                Ok(Value::Text(format!("{a}{b}")))
            }
            _ => Err(Fault::BadExpression),
        };
    }
    if let (Value::Text(a), Value::Text(b)) = (left, right) {
        let is_same = a.eq_ignore_ascii_case(b);
        return match operator {
            Equal if is_same == (a == b) => Ok(Value::truth(is_same)),
            Unequal if is_same == (a == b) => Ok(Value::truth(!is_same)),
            _ => Err(Fault::BadExpression),
        };
    }
    let (a, b) = (left.number()?, right.number()?);
    let bits = |of: fn(i32, i32) -> i32| Ok(Value::Number(f64::from(of(whole(a)?, whole(b)?))));
    let divides = || if b == 0.0 { Err(Fault::NoValue("division by zero")) } else { Ok(()) };
    match operator {
        Times => finite(a * b),
        Over => {
            divides()?;
            finite(a / b)
        }
        Div => {
            divides()?;
            finite(f64::from(whole(a)?.wrapping_div(whole(b)?)))
        }
        Mod => {
            divides()?;
            finite(f64::from(whole(a)?.wrapping_rem(whole(b)?)))
        }
        Plus => finite(a + b),
        Minus => finite(a - b),
        BitAnd => bits(|a, b| a & b),
        BitOr => bits(|a, b| a | b),
        BitXor => bits(|a, b| a ^ b),
        And => Ok(Value::truth(a != 0.0 && b != 0.0)),
        Or => Ok(Value::truth(a != 0.0 || b != 0.0)),
        Xor => Ok(Value::truth((a != 0.0) != (b != 0.0))),
        Equal => Ok(Value::truth(is_same(a, b))),
        Unequal => Ok(Value::truth(!is_same(a, b))),
        Less => Ok(Value::truth(a < b && !is_same(a, b))),
        Greater => Ok(Value::truth(a > b && !is_same(a, b))),
        LessOrEqual => Ok(Value::truth(a < b || is_same(a, b))),
        GreaterOrEqual => Ok(Value::truth(a > b || is_same(a, b))),
        Join => Err(Fault::BadExpression),
    }
}
