//! What a program needs that its dialect cannot write.

use super::dialect::{Dialect, LengthOffsets};
use toolpathd_core::toolpath::cutting::Coolant;
use toolpathd_core::toolpath::program::{Program, SafeHome, Smoothing, SmoothingMode, Units};
use toolpathd_core::toolpath::tool::Tool;

/// What a dialect cannot write.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Missing {
    #[error("the dialect {dialect} has no programs in {units}")]
    Units { dialect: &'static str, units: &'static str },
    /// `has_others` tells whether the dialect has words for other work offsets.
    #[error("the dialect {dialect} has no word for G{number}")]
    WorkOffset { dialect: &'static str, number: u8, has_others: bool },
    #[error("the dialect {dialect} cannot write this safe home")]
    SafeHome { dialect: &'static str, has: &'static [SafeHome] },
    #[error("the dialect {dialect} cannot write this coolant")]
    Coolant { dialect: &'static str, has: &'static [Coolant] },
    #[error("the dialect {dialect} has no numbers of length offsets")]
    LengthOffset { dialect: &'static str },
    #[error("the dialect {dialect} has no tool {number}")]
    ToolNumber { dialect: &'static str, number: u32, most: u32 },
    #[error("the dialect {dialect} has no length offset {number}")]
    LengthOffsetNumber { dialect: &'static str, number: u32, most: u32 },
    #[error("the dialect {dialect} has no word for smoothing")]
    Smoothing { dialect: &'static str },
    #[error("the smoothing of the dialect {dialect} takes no {member}")]
    SmoothingMember { dialect: &'static str, member: &'static str },
    #[error("the smoothing of the dialect {dialect} needs a tolerance of the path")]
    SmoothingTolerance { dialect: &'static str },
    #[error("the smoothing of the dialect {dialect} has no such mode")]
    SmoothingMode { dialect: &'static str, has: &'static [SmoothingMode] },
    #[error("programs in the dialect {dialect} state the radius of the tool, and no tool is given")]
    Tool { dialect: &'static str },
}

/// All that the dialect cannot write.
pub fn missing(dialect: &Dialect, program: &Program, coolant: Coolant, tool: Option<&Tool>) -> Vec<Missing> {
    let (abilities, name) = (&dialect.abilities, dialect.name);
    let mut missing = Vec::new();
    let units = program.resolution.units;
    if !abilities.units.contains(&units) {
        let units = match units {
            Units::Mm => "mm",
            Units::Inch => "inches",
        };
        missing.push(Missing::Units { dialect: name, units });
    }
    if let Some(number) = program.work_offset.filter(|number| !abilities.work_offsets.contains(number)) {
        let has_others = !abilities.work_offsets.is_empty();
        missing.push(Missing::WorkOffset { dialect: name, number, has_others });
    }
    if program.safe_home != SafeHome::None && !abilities.safe_homes.contains(&program.safe_home) {
        missing.push(Missing::SafeHome { dialect: name, has: abilities.safe_homes });
    }
    if coolant != Coolant::Off && !abilities.coolants.contains(&coolant) {
        missing.push(Missing::Coolant { dialect: name, has: abilities.coolants });
    }
    let number = tool.and_then(|tool| tool.number);
    if let Some(number) = number.filter(|number| *number > abilities.max_tool) {
        missing.push(Missing::ToolNumber { dialect: name, number, most: abilities.max_tool });
    }
    if let Some((tool, number)) = tool.and_then(|tool| Some((tool, tool.length_offset?))) {
        match abilities.length_offsets {
            Some(LengthOffsets { most, .. }) if number > most => {
                missing.push(Missing::LengthOffsetNumber { dialect: name, number, most });
            }
            None if number != tool.places().0 => missing.push(Missing::LengthOffset { dialect: name }),
            _ => {}
        }
    }
    if tool.is_none() && abilities.needs_tool {
        missing.push(Missing::Tool { dialect: name });
    }
    missing.extend(program.smoothing.into_iter().flat_map(|smoothing| of_smoothing(dialect, smoothing)));
    missing
}

fn of_smoothing(dialect: &Dialect, smoothing: Smoothing) -> Vec<Missing> {
    let (dialect, words) = (dialect.name, dialect.smoothing);
    let Some(words) = words else { return vec![Missing::Smoothing { dialect }] };
    let Smoothing { tolerance_mm, tolerance_deg, mode } = smoothing;
    let mut missing = Vec::new();
    if tolerance_mm.is_some() && !words.takes_tolerance {
        missing.push(Missing::SmoothingMember { dialect, member: "tolerance_mm" });
    }
    if tolerance_mm.is_none() && words.needs_tolerance {
        missing.push(Missing::SmoothingTolerance { dialect });
    }
    if tolerance_deg.is_some() && !words.takes_degrees {
        missing.push(Missing::SmoothingMember { dialect, member: "tolerance_deg" });
    }
    match mode {
        Some(_) if words.modes.is_empty() => {
            missing.push(Missing::SmoothingMember { dialect, member: "mode" });
        }
        Some(mode) if !words.modes.contains(&mode) => {
            missing.push(Missing::SmoothingMode { dialect, has: words.modes });
        }
        _ => {}
    }
    missing
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DIALECTS;
    use crate::dialects::deckel::DECKEL;
    use crate::dialects::siemens::SIEMENS;
    use toolpathd_core::toolpath::program::Resolution;

    const PLAIN: Program = Program::plain(Resolution { units: Units::Mm, decimals: 3 });

    #[test]
    fn every_dialect_writes_a_program_that_asks_for_nothing() {
        for dialect in DIALECTS {
            assert!(missing(dialect, &PLAIN, Coolant::Off, Some(&Tool::ball(3.0))).is_empty());
        }
    }

    #[test]
    fn everything_that_is_missing_is_named() {
        let offset = Tool { number: Some(1), length_offset: Some(2), ..Tool::ball(3.0) };
        let program = Program {
            resolution: Resolution { units: Units::Inch, decimals: 3 },
            work_offset: Some(58),
            safe_home: SafeHome::G28,
            ..PLAIN
        };
        assert_eq!(missing(&DECKEL, &program, Coolant::Flood, Some(&offset)).len(), 5);
        assert_eq!(missing(&DECKEL, &PLAIN, Coolant::Off, None), [Missing::Tool { dialect: "deckel" }]);
        let found = missing(&SIEMENS, &program, Coolant::Mist, Some(&offset));
        let dialect = "siemens";
        assert_eq!(
            found,
            [
                Missing::WorkOffset { dialect, number: 58, has_others: true },
                Missing::SafeHome { dialect, has: &[SafeHome::None, SafeHome::G53] },
            ]
        );
    }
}
