//! Q parameters and what the program has stored in them.
//!
//! # Guarantees
//! * A parameter that the program has not set has no value: what the control keeps in it is only known there.
//! * The control itself sets Q100 to Q199, so that these have no value either. Q120 to Q122, the angles of
//!   the rotary axes for the plane of the program, are zero behind a plane of three angles of zero.

use std::collections::HashMap;

use crate::fault::Fault;

/// The kinds of parameters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Kind {
    /// Q: for all programs.
    Plain,
    /// QL: for one program.
    Local,
    /// QR: kept when the control is switched off.
    Kept,
}

/// A parameter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct Key {
    pub kind: Kind,
    pub number: u32,
}

/// The values of all parameters. `None` stands for a value that an earlier refusal has left open.
#[derive(Debug, Default)]
pub struct Parameters {
    values: HashMap<Key, Option<f64>>,
    local: HashMap<Key, Option<f64>>,
    /// The local ones of the programs that have called.
    callers: Vec<HashMap<Key, Option<f64>>>,
    /// The plane of the program is level by three angles of zero, so that Q120 to Q122 are zero.
    pub is_level: bool,
}

/// Whether the control keeps the angle of a rotary axis in the parameter.
fn is_angle(key: Key) -> bool {
    key.kind == Kind::Plain && (120..=122).contains(&key.number)
}

impl Key {
    /// The parameter of a cycle.
    pub fn of_cycle(number: u16) -> Self {
        Self { kind: Kind::Plain, number: u32::from(number) }
    }

    fn is_legal(self) -> bool {
        self.number < if self.kind == Kind::Plain { 2000 } else { 500 }
    }
}

impl Parameters {
    /// The value of a parameter.
    ///
    /// # Errors
    /// When it has none; `None` where that follows from an earlier refusal.
    pub fn get(&self, key: Key) -> Result<f64, Option<Fault>> {
        if !key.is_legal() {
            return Err(Some(Fault::OutOfRange(f64::from(key.number))));
        }
        if is_angle(key) && self.is_level {
            return Ok(0.0);
        }
        if key.kind == Kind::Plain && (100..200).contains(&key.number) {
            return Err(Some(Fault::AtMachine));
        }
        match self.of_kind(key).get(&key) {
            None => Err(Some(Fault::AtMachine)),
            Some(None) => Err(None),
            Some(Some(value)) => Ok(*value),
        }
    }

    /// Stores a value, or that it is left open by a refusal.
    ///
    /// # Errors
    /// When there is no such parameter.
    pub fn set(&mut self, key: Key, value: Result<f64, ()>) -> Result<(), Fault> {
        if !key.is_legal() {
            return Err(Fault::OutOfRange(f64::from(key.number)));
        }
        // The program's own value is not the control's.
        self.is_level &= !is_angle(key);
        let values = if key.kind == Kind::Local { &mut self.local } else { &mut self.values };
        values.insert(key, value.ok());
        Ok(())
    }

    fn of_kind(&self, key: Key) -> &HashMap<Key, Option<f64>> {
        if key.kind == Kind::Local { &self.local } else { &self.values }
    }

    /// Forgets a value, because the control changes it.
    pub fn forget(&mut self, key: Key) {
        self.values.remove(&key);
        self.local.remove(&key);
    }

    /// A program is called, which has local parameters of its own.
    pub fn enter(&mut self) {
        self.callers.push(std::mem::take(&mut self.local));
    }

    /// The called program ends.
    pub fn leave(&mut self) {
        self.local = self.callers.pop().unwrap_or_default();
    }
}
