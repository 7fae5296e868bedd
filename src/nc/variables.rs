//! Variables of a program. Each call has local variables of its own.

use std::collections::HashMap;

use super::control::Language;
use super::fault::Fault;

/// A value; `None` is vacant, as a variable of Fanuc that nothing has set.
pub type Value = Option<f64>;

/// The variables of one program run.
#[derive(Debug, Clone)]
pub struct Variables {
    language: Language,
    globals: HashMap<u32, Value>,
    named: HashMap<String, f64>,
    /// The local variables of each call; the first are those of the main program.
    calls: Vec<Locals>,
}

#[derive(Debug, Clone, Default)]
struct Locals {
    numbered: HashMap<u32, Value>,
    named: HashMap<String, f64>,
}

impl Variables {
    pub fn new(language: Language) -> Self {
        // What the last call has returned: nothing yet.
        let returned = ["_value", "_value_returned"].map(|name| (name.to_owned(), 0.0));
        let named = if language == Language::LinuxCnc { returned.into() } else { HashMap::new() };
        Self { language, globals: HashMap::new(), named, calls: vec![Locals::default()] }
    }

    /// The number of the last local variable.
    fn last_local(&self) -> u32 {
        if self.language == Language::LinuxCnc { 30 } else { 33 }
    }

    /// The variable with this number.
    ///
    /// # Errors
    /// When only the machine knows the value.
    pub fn numbered(&self, number: u32) -> Result<Value, Fault> {
        if number == 0 {
            return Ok(None);
        }
        if number <= self.last_local() {
            let found = self.calls.last().and_then(|locals| locals.numbered.get(&number)).copied();
            return Ok(found.unwrap_or((self.language == Language::LinuxCnc).then_some(0.0)));
        }
        match (self.globals.get(&number), self.language) {
            (Some(value), _) => Ok(*value),
            // Variables of LinuxCNC that no file holds are zero.
            (None, Language::LinuxCnc) if number <= 5000 => Ok(Some(0.0)),
            _ => Err(Fault::AtMachine),
        }
    }

    /// The variable with this name; a name that begins with `_` is known in all calls.
    ///
    /// # Errors
    /// When nothing has set it.
    pub fn named(&self, name: &str) -> Result<f64, Fault> {
        let found = if name.starts_with('_') {
            self.named.get(name)
        } else {
            self.calls.last().and_then(|locals| locals.named.get(name))
        };
        found.copied().ok_or(Fault::AtMachine)
    }

    /// # Errors
    /// When the variable belongs to the control and changes more than a number.
    pub fn set_numbered(&mut self, number: u32, value: Value) -> Result<(), Fault> {
        let own = if self.language == Language::LinuxCnc { 1..=5000 } else { 1..=999 };
        match number {
            3000 if self.language == Language::Fanuc => Err(Fault::Alarm),
            // Clocks and the stop with a message.
            3001 | 3002 | 3006 if self.language == Language::Fanuc => Ok(()),
            number if !own.contains(&number) => Err(Fault::AtMachine),
            number if number <= self.last_local() => {
                if let Some(locals) = self.calls.last_mut() {
                    locals.numbered.insert(number, value);
                }
                Ok(())
            }
            number => {
                self.globals.insert(number, value);
                Ok(())
            }
        }
    }

    pub fn set_named(&mut self, name: &str, value: f64) {
        let names = match self.calls.last_mut() {
            Some(locals) if !name.starts_with('_') => &mut locals.named,
            _ => &mut self.named,
        };
        names.insert(name.to_owned(), value);
    }

    /// Begins a call with local variables of its own.
    pub fn enter(&mut self, arguments: impl IntoIterator<Item = (u32, f64)>) {
        let numbered = arguments.into_iter().map(|(number, value)| (number, Some(value))).collect();
        self.calls.push(Locals { numbered, named: HashMap::new() });
    }

    /// Ends the last call.
    pub fn leave(&mut self) {
        if self.calls.len() > 1 {
            self.calls.pop();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn local_variables_belong_to_their_call() {
        let mut variables = Variables::new(Language::Fanuc);
        variables.set_numbered(1, Some(5.0)).unwrap();
        variables.set_numbered(100, Some(7.0)).unwrap();
        variables.enter([(1, 6.0)]);
        assert_eq!([1, 2, 100].map(|n| variables.numbered(n)), [Ok(Some(6.0)), Ok(None), Ok(Some(7.0))]);
        variables.leave();
        assert_eq!(variables.numbered(1), Ok(Some(5.0)));
        assert_eq!(variables.numbered(501), Err(Fault::AtMachine));
        assert_eq!(variables.set_numbered(3000, Some(1.0)), Err(Fault::Alarm));
    }

    #[test]
    fn variables_of_linuxcnc_are_zero_until_they_are_set() {
        let mut variables = Variables::new(Language::LinuxCnc);
        assert_eq!([1, 31, 5000].map(|n| variables.numbered(n)), [Ok(Some(0.0)); 3]);
        assert_eq!(variables.numbered(5420), Err(Fault::AtMachine));
        variables.set_named("_all", 1.0);
        variables.set_named("own", 2.0);
        variables.enter([]);
        assert_eq!((variables.named("_all"), variables.named("own")), (Ok(1.0), Err(Fault::AtMachine)));
    }
}
