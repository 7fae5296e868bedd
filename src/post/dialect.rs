//! What differs between the programs of different controls, as data.

use super::dialects;

/// How a control is written to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Dialect {
    pub name: &'static str,
    pub description: &'static str,
    /// Without the dot.
    pub file_extension: &'static str,
    pub comment: CommentStyle,
    pub line_end: &'static str,
    /// Characters, without the line end.
    pub max_line_length: usize,
    pub default_decimals_mm: u8,
    pub default_decimals_inch: u8,
    pub max_decimals: u8,
    pub block_numbers: BlockNumbers,
    /// The lines before the first motion and after the last.
    pub start: &'static [Frame],
    pub end: &'static [Frame],
}

/// How text for people is set off.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum CommentStyle {
    Parentheses,
}

/// Numbers of blocks: `step`, twice `step` and so on up to `max`, then again from `step`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BlockNumbers {
    pub step: u32,
    pub max: u32,
}

/// One part of a program's start or end. What the job does not ask for leaves no line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Frame {
    /// Name, tool, notes and warnings.
    Header,
    Text(&'static str),
    /// The line that sets every mode the program relies on.
    Safety {
        mm: &'static str,
        inch: &'static str,
    },
    /// Words before a distance of one unit of the last decimal, and after it.
    Blending {
        before: &'static str,
        after: &'static str,
    },
    WorkOffset,
    ToolChange,
    LengthOffset,
    SpindleOn,
    CoolantOn,
}

/// Every dialect, in the order of the documentation.
pub const DIALECTS: &[&Dialect] = &[&dialects::linuxcnc::LINUXCNC];

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
}
