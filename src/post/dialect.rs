//! What differs between the programs of different controls, as data.

use super::dialects;
pub use crate::toolpath::quantize::Parabolas;

/// How a control is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    pub name: &'static str,
    pub description: &'static str,
    /// Without the dot.
    pub file_extension: &'static str,
    pub comment: Comment,
    pub line_end: &'static str,
    /// Characters, without the line end.
    pub max_line_length: usize,
    /// The first and the last line of every program, where there must be such.
    pub tape_mark: Option<&'static str>,
    /// The line that says which program this is; none where a program is known by its file.
    pub program_number: Option<ProgramNumber>,
    pub default_decimals_mm: u8,
    pub default_decimals_inch: u8,
    pub max_decimals: u8,
    pub numbers: Numbers,
    pub block_numbers: BlockNumbers,
    pub dwell: Dwell,
    pub parabolas: Parabolas,
    /// The lines before the first motion and after the last.
    pub start: &'static [Frame],
    pub end: &'static [Frame],
}

/// How text for people is set off: `open`, a label, `separator`, the text, `close`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Comment {
    pub open: &'static str,
    pub separator: &'static str,
    pub close: &'static str,
}

/// A letter and the number with leading zeros, from 1 to `max`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ProgramNumber {
    pub letter: char,
    pub digits: usize,
    pub max: u32,
}

/// What numbers a control reads.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Numbers {
    /// Where a missing decimal point changes the value of a coordinate or feed, every one has it, also whole ones.
    pub point: Point,
    /// Digits of one number, before and after the point.
    pub max_digits: u32,
    pub spindle_decimals: u8,
    pub max_spindle_rpm: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Point {
    WhereNeeded,
    Always,
}

/// Numbers of blocks: `step`, twice `step` and so on up to `max`, then again from `step`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockNumbers {
    pub step: u32,
    pub max: u32,
}

/// What the P of G4 counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dwell {
    /// With three decimals.
    Seconds,
    /// Whole ones.
    Milliseconds,
}

/// One part of a program's start or end. What the job does not ask for leaves no line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// What people should know: name, notes, tool, figures, warnings.
    Header,
    Text(&'static str),
    /// A text that depends on the units.
    ByUnits {
        mm: &'static str,
        inch: &'static str,
    },
    /// Words before a distance of one unit of the last decimal, and after it.
    Blending {
        before: &'static str,
        after: &'static str,
    },
    WorkOffset,
    /// The way up to the machine's end of Z, as the program asks for it.
    SafeHome,
    ToolChange,
    SpindleOn,
    CoolantOn,
    /// A line of its own.
    LengthOffset,
    /// In the block of the first motion along Z, a rapid.
    LengthOffsetInFirstMotionAlongZ,
}

/// Every dialect, in the order of the documentation.
pub const DIALECTS: &[&Dialect] = &[&dialects::linuxcnc::LINUXCNC, &dialects::fanuc::FANUC];

/// The dialect called `name`.
pub fn dialect(name: &str) -> Option<&'static Dialect> {
    DIALECTS.iter().copied().find(|dialect| dialect.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_dialect_is_found_by_its_name() {
        for known in DIALECTS {
            assert_eq!(dialect(known.name), Some(*known));
            assert!((1..=known.max_decimals).contains(&known.default_decimals_mm));
            assert!((1..=known.max_decimals).contains(&known.default_decimals_inch));
            assert!(known.block_numbers.step > 0 && known.block_numbers.step <= known.block_numbers.max);
        }
        assert_eq!(dialect("LinuxCNC"), None);
    }

    #[test]
    fn every_program_begins_with_a_length_offset_and_a_tool_in_this_order() {
        for dialect in DIALECTS {
            let place = |wanted: &[Frame]| dialect.start.iter().position(|frame| wanted.contains(frame));
            let tool = place(&[Frame::ToolChange]);
            let offset = place(&[Frame::LengthOffset, Frame::LengthOffsetInFirstMotionAlongZ]);
            assert!(tool.is_some() && tool < offset, "{}", dialect.name);
            let home = place(&[Frame::SafeHome]);
            assert!(home.is_some() && home < tool, "{}", dialect.name);
            assert_eq!(dialect.end.first(), Some(&Frame::SafeHome), "{}", dialect.name);
        }
    }
}
