//! The table of dialects. Each dialect is one file.

pub mod fanuc;
pub mod linuxcnc;

use super::dialect::Dialect;

/// Every dialect, in the order of the documentation.
pub const DIALECTS: &[&Dialect] = &[&linuxcnc::LINUXCNC, &fanuc::FANUC];

/// The dialect called `name`.
pub fn dialect(name: &str) -> Option<&'static Dialect> {
    DIALECTS.iter().copied().find(|dialect| dialect.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::post::dialect::Frame;

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
