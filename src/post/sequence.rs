//! Several operations in one program: what changes from one to the next, and what cannot be joined.
//!
//! * Another tool: the tool goes up to the safe home, spindle and coolant stop, the control changes the tool,
//!   all modes are stated again, and spindle and coolant start.
//! * The same tool and another work offset: the tool goes up to the safe home, because the difference in
//!   height between the two offsets is unknown.
//! * The same tool and offset: the tool goes up to the higher one of both clearance planes, and spindle and
//!   coolant change only where the operations differ.

use super::dialect::Syntax;
use super::header::Remark;
use super::lower::Lowered;
use super::{Operation, ProgramJob};
use toolpathd_core::toolpath::program::{Program, SafeHome};

/// Why operations cannot stand in one program.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Unjoinable {
    #[error("a program has at least one operation")]
    Nothing,
    #[error("the operations ask for different programs")]
    Programs,
    #[error("the dialect {dialect} has one operation to a program")]
    Several { dialect: &'static str },
    #[error("the dialect {dialect} has no tool change, and the operations have several tools")]
    ToolChange { dialect: &'static str },
    #[error("lines of your own change the tool, and the operations have several tools")]
    OwnToolChange,
    #[error("two different tools have the number {number}")]
    TwoTools { number: u32 },
    #[error("operations of the tool {number} have different length offsets")]
    LengthOffsets { number: u32 },
    /// `has_homes` tells whether the dialect has words for a safe home.
    #[error("the tool or its work offset changes, and the tool does not move to a safe home before")]
    NoSafeHome { has_homes: bool },
    #[error("the tool leans or turns in one of several operations")]
    Leaning,
}

/// What changes at the beginning of an operation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Change {
    pub tool: bool,
    pub work_offset: bool,
}

impl Change {
    /// Whether the tool or the work offset changes. The tool then leaves the part before the operation, and
    /// the operation starts at an unknown position of the tool.
    pub fn leaves(self) -> bool {
        self.tool || self.work_offset
    }
}

/// An operation on its way into a program.
pub struct Part<'a> {
    pub operation: &'a Operation<'a>,
    pub change: Change,
    pub lowered: Lowered,
    pub remarks: Vec<Remark>,
}

/// What changes at the beginning of each operation.
///
/// # Errors
/// When the operations cannot stand in one program.
pub fn changes(operations: &[Operation]) -> Result<Vec<Change>, Unjoinable> {
    let [first, later @ ..] = operations else { return Err(Unjoinable::Nothing) };
    let mut changes = vec![Change { tool: true, work_offset: true }];
    let dialect = first.job.dialect;
    if later.is_empty() {
        return Ok(changes);
    }
    if dialect.syntax == Syntax::Deckel {
        return Err(Unjoinable::Several { dialect: dialect.name });
    }
    if operations.iter().any(|operation| operation.job.five_axes.is_some()) {
        return Err(Unjoinable::Leaning);
    }
    let number = |operation: &Operation| operation.job.tool_numbers().0;
    let has_several = later.iter().any(|operation| number(operation) != number(first));
    if has_several && !dialect.changes_tools() {
        return Err(Unjoinable::ToolChange { dialect: dialect.name });
    }
    if has_several && !first.job.program.custom.tool_change.is_empty() {
        return Err(Unjoinable::OwnToolChange);
    }
    for pair in operations.windows(2) {
        changes.push(change([&pair[0].job, &pair[1].job])?);
    }
    for (k, one) in operations.iter().enumerate() {
        let (number, length_offset) = one.job.tool_numbers();
        for other in operations[..k].iter().filter(|other| other.job.tool_numbers().0 == number) {
            let cutters = [one, other].map(|own| own.job.tool.map(|tool| (tool.shape, tool.radius_mm)));
            if cutters[0].zip(cutters[1]).is_some_and(|(one, other)| one != other) {
                return Err(Unjoinable::TwoTools { number });
            }
            if other.job.tool_numbers().1 != length_offset {
                return Err(Unjoinable::LengthOffsets { number });
            }
        }
    }
    Ok(changes)
}

/// What changes between two operations.
fn change(jobs: [&ProgramJob; 2]) -> Result<Change, Unjoinable> {
    let [before, after] = jobs.map(|job| job.program);
    let without_offset = |program: &Program| Program { work_offset: None, ..program.clone() };
    if without_offset(before) != without_offset(after) || jobs[0].dialect.name != jobs[1].dialect.name {
        return Err(Unjoinable::Programs);
    }
    let tool = jobs[0].tool_numbers().0 != jobs[1].tool_numbers().0;
    let work_offset = before.work_offset != after.work_offset;
    let change = Change { tool, work_offset };
    // A control without a word for it goes up by itself when it changes the tool.
    let has_homes = jobs[0].dialect.abilities.safe_homes.iter().any(|home| *home != SafeHome::None);
    if change.leaves() && after.safe_home == SafeHome::None && (has_homes || !tool) {
        return Err(Unjoinable::NoSafeHome { has_homes });
    }
    Ok(change)
}
