//! Programs of Heidenhain.

use toolpathd_core::budget::{Budget, Stopped};

use super::Ran;
use super::machine::Machine;

/// Runs a program to its end, or to where no sense can be made of it.
///
/// # Errors
/// When the budget ends.
pub fn run<'a>(
    _machine: &mut Machine<'a>,
    _text: &'a [u8],
    _skips_optional: bool,
    budget: &Budget,
) -> Result<Ran, Stopped> {
    budget.check()?;
    Ok(Ran { n_lines: 0, n_blocks: 0 })
}
