//! Reads programs in Heidenhain Klartext of any origin, for milling.
//!
//! # Method
//! 1. `script` divides the text into blocks and finds programs and labels. `cursor` reads names and values.
//! 2. `flow` runs the blocks; `statement` tells by its first words what a block is. `parameters` and `formula`
//!    hold what the program computes.
//! 3. `words` reads the words of a block that moves, `functions` its M words. `moves`, `circles` and `polar`
//!    make an element of the path of it, and `path` follows the elements. `corners` rounds or chamfers where
//!    two of them meet.
//! 4. `datum` places coordinates by cycles 7, 8, 10, 11, 26 and 247. `definitions` reads cycles for holes,
//!    `drilling` and `patterns` run them.
//!
//! # Guarantees
//! * DR+ turns as G3 in all three planes. An arc whose end is its start is a full circle.
//! * In a program in inches F counts tenths of an inch per minute.
//! * A tool call loses the place along the tool axis.
//! * Behind a cycle no feed is in force, because the manuals do not say that the feed before it is.
//!
//! # Reference
//! HEIDENHAIN user's manuals: TNC 407 pp. 118-119, 137; TNC 426/430 p. 154; iTNC 530 (340 49x-04) and its
//! *Cycle Programming*; TNC 320 (340 55x-03) p. 155; TNC 640 (34059x-05).

mod circles;
mod corners;
mod cursor;
mod datum;
mod definitions;
mod drilling;
mod flow;
mod formula;
mod functions;
mod jumps;
mod moves;
mod parameters;
mod path;
mod patterns;
mod polar;
mod script;
mod statement;
mod tools;
mod words;

use toolpathd_core::budget::{Budget, Stopped};

use super::Ran;
use super::machine::Machine;
use flow::Execution;
use script::Script;

/// Runs a program to its end, or to where no sense can be made of it.
///
/// # Errors
/// When the budget ends.
pub fn run<'a>(
    machine: &mut Machine<'a>,
    text: &'a [u8],
    skips_optional: bool,
    budget: &Budget,
) -> Result<Ran, Stopped> {
    budget.check()?;
    let script = Script::new(text, budget)?;
    Execution::new(machine, script, skips_optional).run_to_end(budget)
}

#[cfg(test)]
mod tests;
