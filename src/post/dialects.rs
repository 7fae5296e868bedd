//! The table of dialects. Each dialect is one file and one line.

use super::dialect::Dialect;

/// Declares the module of each dialect, and lists the dialects in the order of the documentation.
macro_rules! dialects {
    ($($module:ident::$name:ident),+ $(,)?) => {
        $(pub mod $module;)+

        /// Every dialect, in the order of the documentation. The first is the default.
        pub const DIALECTS: &[&Dialect] = &[$(&$module::$name),+];
    };
}

dialects! {
    linuxcnc::LINUXCNC,
    fanuc::FANUC,
    haas::HAAS,
    siemens::SIEMENS,
    heidenhain::HEIDENHAIN,
    grbl::GRBL,
    deckel::DECKEL,
    mach4::MACH4,
    okuma::OKUMA,
    mazak::MAZAK,
    iso::ISO,
}

/// The dialect called `name`.
pub fn dialect(name: &str) -> Option<&'static Dialect> {
    DIALECTS.iter().copied().find(|dialect| dialect.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dialect::{Frame, Iso, Syntax};

    #[test]
    fn every_dialect_is_found_by_its_name() {
        for known in DIALECTS {
            assert_eq!(dialect(known.name), Some(*known));
            assert!((1..=known.max_decimals).contains(&known.default_decimals_mm), "{}", known.name);
            assert!((1..=known.max_decimals).contains(&known.default_decimals_inch), "{}", known.name);
        }
        assert_eq!(dialect("LinuxCNC"), None);
    }

    #[test]
    fn the_tool_changes_before_its_length_offset_is_selected() {
        for dialect in DIALECTS {
            let (Syntax::Iso(iso) | Syntax::Siemens(iso)) = dialect.syntax else { continue };
            let Iso { start, end, block_numbers, reference_point, machine_zero, .. } = iso;
            assert!(block_numbers.step > 0 && block_numbers.step <= block_numbers.max);
            let place = |wanted: &[Frame]| start.iter().position(|frame| wanted.contains(frame));
            let tool = place(&[Frame::ToolChange]);
            let offset = place(&[Frame::LengthOffset, Frame::LengthOffsetInFirstMotionAlongZ]);
            assert!(tool < offset || dialect.name == "grbl" && tool.or(offset).is_none(), "{}", dialect.name);
            if !reference_point.is_empty() || !machine_zero.is_empty() {
                let home = place(&[Frame::SafeHome]);
                assert!(home.is_some() && (tool.is_none() || home < tool), "{}", dialect.name);
                let first = end.iter().find(|frame| **frame != Frame::SmoothingOff);
                assert_eq!(first, Some(&Frame::SafeHome), "{}", dialect.name);
            }
        }
    }
}
