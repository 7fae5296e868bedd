//! The words of one line, as `words` reads them and `mill` uses them.

use std::collections::BTreeMap;

use super::codes::Meaning;
use crate::fault::Refusal;

/// What a coordinate counts from.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum From {
    /// As G90 and G91 say.
    Mode,
    Zero,
    Tool,
    /// DC, ACP and ACN of rotary axes.
    Circle,
}

/// A value with the bytes of its word.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Given {
    pub value: f64,
    pub from: From,
    pub start: usize,
    pub end: usize,
}

/// A tool that a block calls.
#[derive(Debug, Clone, PartialEq)]
pub enum Tool {
    Number(u32),
    Name(String),
}

/// The words of one line.
#[derive(Debug, Default)]
pub struct Block {
    pub codes: Vec<(Meaning, [usize; 2])>,
    pub axes: [Option<Given>; 3],
    pub centers: [Option<Given>; 3],
    pub middles: [Option<Given>; 3],
    /// X1, Y1 and Z1 of G74 and G75.
    pub machine_axes: [Option<Given>; 3],
    pub values: BTreeMap<&'static str, Given>,
    /// F, S, D, P and H.
    pub letters: BTreeMap<u8, Given>,
    pub functions: Vec<(u32, [usize; 2])>,
    pub tool: Option<Tool>,
    pub refusals: Vec<Refusal>,
    /// A word cannot be read: the block does nothing.
    pub is_void: bool,
    /// The words of orientations and of other axes, refused unless a transformation was refused before.
    pub others: Vec<[usize; 2]>,
}

impl Block {
    pub fn has(&self, wanted: Meaning) -> bool {
        self.codes.iter().any(|(meaning, _)| *meaning == wanted)
    }

    pub fn has_axes(&self) -> bool {
        self.axes.iter().any(Option::is_some)
    }

    pub fn value(&self, name: &str) -> Option<Given> {
        self.values.get(name).copied()
    }
}
