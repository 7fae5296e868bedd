//! Reads programs in Heidenhain Klartext of any origin, for milling.
//!
//! # Method
//! 1. `script` divides the text into blocks and finds programs and labels. `cursor` reads names and values.
//! 2. `flow` runs the blocks; `statement` tells by its first words what a block is. `parameters` and
//!    `formula` hold what the program computes.
//! 3. `words` reads the words of a block that moves, `functions` its M words. `moves`, `circles` and `polar`
//!    make an element of the path of it, and `path` follows the elements. `corners` rounds or chamfers where
//!    two of them meet, `approach` leads to a contour and from it.
//! 4. `datum` places coordinates by cycles 7, 8, 10, 11, 26 and 247. `definitions` reads cycles for holes,
//!    `drilling` holds what they say, `holes` and `patterns` run them.
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

mod approach;
mod circles;
mod corners;
mod cursor;
mod datum;
mod definitions;
mod drilling;
mod flow;
mod formula;
mod functions;
mod holes;
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
use super::block::Line;
use super::codes::FeedMode;
use super::machine::{At, Machine, Side};
use datum::Transform;
use drilling::Cycle;
use parameters::Parameters;
use path::Path;
use patterns::Point;
use polar::CirclePole;
use script::{Block, Script};

/// A program on its way.
pub struct Execution<'a, 'm> {
    pub machine: &'m mut Machine<'a>,
    pub script: Script<'a>,
    pub parameters: Parameters,
    /// The index of the block that runs next, and of the one that runs.
    pub next: usize,
    pub index: usize,
    /// The index of the program that runs.
    pub program: usize,
    calls: Vec<Call<'a>>,
    repeats: Vec<Repeat>,
    n_blocks: usize,
    /// Blocks, places and infeeds, and long blocks more than once: the measure of the work.
    n_steps: usize,
    pub has_ended: bool,
    skips_optional: bool,
    pub path: Path<'a>,
    pub pole: Option<CirclePole>,
    pub side: Option<Side>,
    /// The feed of the tool call, mm/min.
    pub auto_feed: Option<f64>,
    /// A cycle has run since the last F: which feed is in force is not certain.
    pub has_cycle_feed: bool,
    /// F counts mm per turn, by M136.
    pub is_per_turn: bool,
    pub transforms: Vec<Transform>,
    /// A shift of the datum whose definition may go on, with its last block.
    pub shift: Option<(Block<'a>, [f64; 3])>,
    pub cycle: Option<Cycle>,
    /// The cycle runs behind each positioning, by M89.
    pub is_modal_call: bool,
    /// The words of a cycle of the older form that is under way, in the order of their blocks.
    pub parts: Vec<(u32, f64)>,
    pub points: Vec<Point>,
}

/// The way to a contour or from it. Lengths are in mm of the program.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Form {
    Along(f64),
    Across(f64),
    /// A radius with its sign, and the centre angle in degrees.
    Arc(f64, f64),
    ArcAndLine(f64),
}

/// A feed with its mode; `None` for one that is not known.
type Rate = (FeedMode, Option<f64>);

/// An approach that waits for the first element of the contour.
#[derive(Debug, Clone, Copy)]
pub struct Approach<'a> {
    line: Line<'a>,
    form: Form,
    from: At,
    side: Option<Side>,
    radius_mm: f64,
    /// The feed to the auxiliary point; `None` for a rapid.
    first: Option<Rate>,
    second: Rate,
}

/// A call under way.
struct Call<'a> {
    /// The block behind the call.
    back: usize,
    line: Line<'a>,
    /// What a called program puts aside: the index of the calling program and whether that is in inches.
    program: Option<(usize, bool)>,
    n_repeats: usize,
}

/// A part of a program that is repeated.
struct Repeat {
    /// The block that repeats it, and its label.
    index: usize,
    label: usize,
    again: u32,
    /// A jump has left the part, and controls may disagree on its count.
    was_left: bool,
}

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
