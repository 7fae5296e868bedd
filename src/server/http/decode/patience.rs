//! Stops the reading of a long body when the budget of its computation ends.

use serde::de::Error;

use toolpathd_core::budget::{Budget, Stopped};

/// Values between two checks of the budget: some tenth of a millisecond of reading.
const VALUES: usize = 4096;

/// Counts the values that were read, and checks the budget now and then.
pub struct Patience<'a> {
    budget: &'a Budget,
    values: usize,
    stopped: Option<Stopped>,
}

impl<'a> Patience<'a> {
    pub fn new(budget: &'a Budget) -> Self {
        Self { budget, values: 0, stopped: None }
    }

    /// Counts one value.
    ///
    /// # Errors
    /// An error that ends the reading when the budget has ended. [`Self::result`] then tells why.
    pub fn spend<E: Error>(&mut self) -> Result<(), E> {
        self.values += 1;
        if self.values.is_multiple_of(VALUES) {
            self.stopped = self.budget.check().err();
            if self.stopped.is_some() {
                return Err(E::custom("the reading was stopped"));
            }
        }
        Ok(())
    }

    /// # Errors
    /// The reason when the budget has ended the reading.
    pub fn result(&self) -> Result<(), Stopped> {
        self.stopped.map_or(Ok(()), Err)
    }
}
