//! The modes in which a program arrives at the blocks to which it jumps.
//!
//! # Method
//! Read the text with the modes that hold before each block, and collect for each label the modes that are
//! common to the block above it and to all GOTO blocks that name it. A label may stand above its jumps, so
//! repeat until nothing changes. Modes only get lost from pass to pass.
//!
//! # Guarantees
//! On whatever way the program arrives at a label, the modes of the label hold. No modes are told for a label
//! to which M97, M98, M99, or P or Q of a cycle lead, nor where a jump is computed.
//!
//! # Cost
//! At most [`MAX_PASSES`] readings of the text.

use std::collections::{BTreeMap, BTreeSet};

use super::block::Block;
use super::labels::{Jumps, Labels};
use super::lines::{line_end, split};
use super::mentions::Mentions;
use super::modes::Modes;
use crate::dialect::Dialect;
use toolpathd_core::budget::{Budget, Stopped};

/// Readings of the text. Loops within loops need one more each; where more would be needed, no modes are
/// told.
const MAX_PASSES: usize = 16;

/// Lines between two checks of the budget.
const LINES_BETWEEN_CHECKS: usize = 1024;

/// The modes at labels.
#[derive(Debug, Default)]
pub struct Arrivals {
    /// None for a label at which nothing is known.
    modes: BTreeMap<u64, Option<Modes>>,
}

impl Arrivals {
    /// The modes at the labels of `text`, whose jumps `labels` holds.
    ///
    /// # Errors
    /// When the budget is spent.
    pub fn find(
        text: &[u8],
        labels: &Labels,
        reading: (&Dialect, &Mentions),
        budget: &Budget,
    ) -> Result<Self, Stopped> {
        let mut arrivals = Self::default();
        for _ in 0..if labels.are_known() { MAX_PASSES } else { 0 } {
            let mut met = BTreeSet::new();
            if !arrivals.pass(text, labels, reading, budget, &mut met)? {
                arrivals.modes.retain(|label, _| met.contains(label));
                return Ok(arrivals);
            }
        }
        Ok(Self::default())
    }

    /// The modes at the label with this N word, if they are known.
    pub fn at(&self, word: &[u8]) -> Option<&Modes> {
        if self.modes.is_empty() {
            return None;
        }
        self.modes.get(&super::labels::number(word)?)?.as_ref()
    }

    /// Whether the jumps of a line behind the text may lead to a label whose modes are told.
    pub fn are_broken_by(&self, jumps: &Jumps) -> bool {
        let is_told = |target: &u64| self.modes.get(target).is_some_and(Option::is_some);
        jumps.targets.iter().any(is_told) || !jumps.are_clear && self.modes.values().any(Option::is_some)
    }

    /// Reads the text once, and notes the labels in it. Returns whether the modes of a label have changed.
    fn pass(
        &mut self,
        text: &[u8],
        labels: &Labels,
        (dialect, mentions): (&Dialect, &Mentions),
        budget: &Budget,
        met: &mut BTreeSet<u64>,
    ) -> Result<bool, Stopped> {
        let (mut modes, mut has_changed) = (mentions.start(), false);
        for (k, line) in split(text).enumerate() {
            if k.is_multiple_of(LINES_BETWEEN_CHECKS) {
                budget.check()?;
            }
            let line = &line[..line.len() - line_end(line).len()];
            let block = if k == 0 { Block::read_first(line) } else { Block::read(line) }.on(dialect);
            if let Some(label) = labels.label(&line[block.number.clone()]) {
                met.insert(label);
                has_changed |= self.arrive(label, Some(&modes));
                modes = self.modes.get(&label).copied().flatten().unwrap_or(mentions.forget(&modes));
            }
            modes = modes.read(&block, dialect, mentions).0;
            for target in Jumps::of(line, &block).targets {
                has_changed |= self.arrive(target, Some(&modes).filter(|_| block.is_plain_jump));
            }
        }
        Ok(has_changed)
    }

    /// Notes that the program arrives at `label` with `modes`, or in a way that tells none. Returns whether
    /// that changes the modes of the label.
    fn arrive(&mut self, label: u64, modes: Option<&Modes>) -> bool {
        let known = self.modes.entry(label).or_insert(modes.copied());
        let common = known.as_ref().zip(modes).map(|(known, modes)| known.common_with(modes));
        let has_changed = *known != common;
        *known = common;
        has_changed
    }
}
