//! Values and variables of SINUMERIK programs: R parameters, and what DEF and PROC define.
//!
//! # Guarantees
//! * The control keeps R parameters and global variables from one program to the next. Such a variable that
//!   this program has not set has no value here.
//! * A variable that a block sets has no value in the same block: controls and manuals do not agree on it.

use std::cell::Cell;
use std::collections::{HashMap, HashSet};

use crate::fault::Fault;

/// Most elements of one field, and most of all variables: more is an error of the program.
const MAX_ELEMENTS: usize = 10_000;
const MAX_VARIABLES: usize = 100_000;

/// Longest text of a variable, bytes.
const MAX_TEXT: usize = 400;

/// A value of an expression. Truths are 1 and 0.
#[derive(Debug, Clone, PartialEq)]
pub enum Value {
    Number(f64),
    Text(String),
}

/// What a variable holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    Real,
    Int,
    Bool,
    Text,
}

/// A variable as a line names it.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub enum Variable {
    /// An R parameter.
    Numbered(u32),
    /// A name, and the index in a field.
    Named(String, Option<usize>),
}

#[derive(Debug, Clone)]
struct Defined {
    kind: Kind,
    is_field: bool,
    values: Vec<Value>,
}

/// The variables of one run.
#[derive(Debug, Clone, Default)]
pub struct Variables {
    numbered: HashMap<u32, f64>,
    /// The variables of each call; the first are those of the main program.
    calls: Vec<HashMap<String, Defined>>,
    n_defined: usize,
    /// Set by the block that runs.
    fresh: HashSet<Variable>,
    /// Variables whose value has been refused.
    lost: HashSet<Variable>,
    /// Whether the block that runs has met one of these.
    has_met_lost: Cell<bool>,
}

impl Value {
    pub fn truth(is_true: bool) -> Self {
        Value::Number(f64::from(u8::from(is_true)))
    }

    /// # Errors
    /// When the value is a text.
    pub fn number(&self) -> Result<f64, Fault> {
        match self {
            Value::Number(value) => Ok(*value),
            Value::Text(_) => Err(Fault::NoValue("a text is no number")),
        }
    }
}

impl Kind {
    /// The kind that a word of DEF names.
    pub fn named(word: &str) -> Option<Self> {
        Some(match word {
            "REAL" => Kind::Real,
            "INT" => Kind::Int,
            "BOOL" => Kind::Bool,
            "STRING" => Kind::Text,
            _ => return None,
        })
    }

    fn nothing(self) -> Value {
        if self == Kind::Text { Value::Text(String::new()) } else { Value::Number(0.0) }
    }

    /// A value as a variable of this kind holds it.
    ///
    /// # Errors
    /// When the kind cannot hold the value.
    pub fn hold(self, value: Value) -> Result<Value, Fault> {
        match (self, value) {
            (Kind::Text, Value::Text(text)) if text.len() <= MAX_TEXT => Ok(Value::Text(text)),
            (Kind::Text, _) => Err(Fault::NoValue("the variable holds a text")),
            (Kind::Real, value) => value.number().map(Value::Number),
            (Kind::Bool, value) => value.number().map(|value| Value::truth(value != 0.0)),
            (Kind::Int, value) => {
                // A part of 0.5 or more counts as one, as the manual says.
                let value = (value.number()? + 0.5).floor();
                if value.abs() <= f64::from(i32::MAX) {
                    Ok(Value::Number(value))
                } else {
                    Err(Fault::OutOfRange(value))
                }
            }
        }
    }
}

impl Variables {
    pub fn new() -> Self {
        Self { calls: vec![HashMap::new()], ..Self::default() }
    }

    pub fn begin_block(&mut self) {
        self.fresh.clear();
        self.has_met_lost.set(false);
    }

    /// Whether the block that runs has read a variable whose value has been refused before.
    pub fn has_met_lost(&self) -> bool {
        self.has_met_lost.get()
    }

    /// The value of a variable has been refused.
    pub fn lose(&mut self, variable: &Variable) {
        if self.lost.len() < MAX_ELEMENTS {
            self.lost.insert(variable.clone());
        }
    }

    /// Begins a call with variables of its own.
    pub fn enter(&mut self) {
        self.calls.push(HashMap::new());
    }

    /// Ends the last call.
    pub fn leave(&mut self) {
        if self.calls.len() > 1
            && let Some(ended) = self.calls.pop()
        {
            self.n_defined -= ended.values().map(|defined| defined.values.len()).sum::<usize>();
        }
    }

    pub fn is_defined(&self, name: &str) -> bool {
        self.calls.last().is_some_and(|call| call.contains_key(name))
    }

    fn defined(&self, name: &str) -> Option<&Defined> {
        self.calls.last().and_then(|call| call.get(name))
    }

    /// Defines a variable, or a field of `count` elements.
    ///
    /// # Errors
    /// When the field is too large, or the name is defined already.
    pub fn define(&mut self, name: &str, kind: Kind, count: Option<usize>) -> Result<(), Fault> {
        let n = count.unwrap_or(1);
        if n == 0 || n > MAX_ELEMENTS || self.n_defined + n > MAX_VARIABLES {
            return Err(Fault::OutOfRange(n as f64));
        }
        if self.is_defined(name) {
            return Err(Fault::BadExpression);
        }
        let Some(call) = self.calls.last_mut() else { return Ok(()) };
        let defined = Defined { kind, is_field: count.is_some(), values: vec![kind.nothing(); n] };
        call.insert(name.to_owned(), defined);
        self.n_defined += n;
        Ok(())
    }

    /// # Errors
    /// When nothing has set the variable, or only the block that runs.
    pub fn value(&self, variable: &Variable) -> Result<Value, Fault> {
        if self.lost.contains(variable) {
            self.has_met_lost.set(true);
            return Err(Fault::AtMachine);
        }
        if self.fresh.contains(variable) {
            return Err(Fault::SetInBlock);
        }
        match variable {
            Variable::Numbered(number) => {
                self.numbered.get(number).map(|value| Value::Number(*value)).ok_or(Fault::AtMachine)
            }
            Variable::Named(name, index) => {
                let defined = self.defined(name).ok_or(Fault::AtMachine)?;
                let index = element(defined, *index)?;
                Ok(defined.values[index].clone())
            }
        }
    }

    /// # Errors
    /// When the variable is not defined, or cannot hold the value.
    pub fn set(&mut self, variable: &Variable, value: Value) -> Result<(), Fault> {
        match variable {
            Variable::Numbered(number) => {
                let value = value.number()?;
                if self.numbered.len() >= MAX_VARIABLES && !self.numbered.contains_key(number) {
                    return Err(Fault::OutOfRange(f64::from(*number)));
                }
                self.numbered.insert(*number, value);
            }
            Variable::Named(name, index) => {
                let defined = self.calls.last_mut().and_then(|call| call.get_mut(name));
                let defined = defined.ok_or(Fault::AtMachine)?;
                let index = element(defined, *index)?;
                defined.values[index] = defined.kind.hold(value)?;
            }
        }
        self.lost.remove(variable);
        self.fresh.insert(variable.clone());
        Ok(())
    }
}

fn element(defined: &Defined, index: Option<usize>) -> Result<usize, Fault> {
    if index.is_some() != defined.is_field {
        return Err(Fault::BadExpression);
    }
    let index = index.unwrap_or(0);
    if index < defined.values.len() { Ok(index) } else { Err(Fault::OutOfRange(index as f64)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn variables_belong_to_their_call_and_parameters_to_all() {
        let mut variables = Variables::new();
        let (r1, depth) = (Variable::Numbered(1), Variable::Named("DEPTH".into(), None));
        assert_eq!(variables.value(&r1), Err(Fault::AtMachine));
        variables.define("DEPTH", Kind::Int, None).unwrap();
        variables.set(&depth, Value::Number(2.5)).unwrap();
        variables.set(&r1, Value::Number(7.0)).unwrap();
        assert_eq!(variables.value(&depth), Err(Fault::SetInBlock));
        variables.begin_block();
        assert_eq!(variables.value(&depth), Ok(Value::Number(3.0)));
        variables.enter();
        assert_eq!(variables.value(&depth), Err(Fault::AtMachine));
        assert_eq!(variables.value(&r1), Ok(Value::Number(7.0)));
        variables.leave();
        assert!(variables.is_defined("DEPTH"));
    }
}
