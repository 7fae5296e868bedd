//! The control's own smoothing: what a program asks for, and a shop's own lines that choose it themselves.

use super::ProgramJob;
use super::custom::CustomPart;
use super::dialect::{Dialect, Frame, Syntax};
use super::nc::{Lexer, Token};
use super::words::FeedWord;
use toolpathd_core::toolpath::program::{Custom, Smoothing};

/// A line of the shop's own that chooses the smoothing.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "the program asks for smoothing, and line {} of the {part} chooses it too: {line:?}; leave one of them out",
    index + 1
)]
pub struct OwnSmoothing {
    pub part: CustomPart,
    pub index: usize,
    pub line: String,
}

/// The first of the shop's own lines before the first motion that chooses the smoothing.
pub fn own_smoothing(dialect: &Dialect, custom: &Custom) -> Option<OwnSmoothing> {
    let header = custom.header.iter().enumerate().map(|line| (CustomPart::Header, line));
    let tool_change = custom.tool_change.iter().enumerate().map(|line| (CustomPart::ToolChange, line));
    let mut lines = header.chain(tool_change);
    let (part, (index, line)) = lines.find(|(_, (_, line))| chooses(dialect, line))?;
    Some(OwnSmoothing { part, index, line: line.clone() })
}

/// Cycles and modes of Siemens by their names.
const SIEMENS_NAMES: [&str; 3] = ["CYCLE832", "COMPCAD", "COMPCURV"];

fn chooses(dialect: &Dialect, line: &str) -> bool {
    let Some(words) = dialect.smoothing else { return false };
    match dialect.syntax {
        Syntax::Klartext => line.trim_start().starts_with("CYCL DEF 32."),
        Syntax::Siemens(_) => {
            let code = line.split(';').next().unwrap_or_default().to_ascii_uppercase();
            // Every second part of a line stands in quotes.
            let code: String = code.split('"').step_by(2).collect();
            SIEMENS_NAMES.iter().any(|name| code.contains(name)) || has_code(&code, words.own)
        }
        Syntax::Iso(_) => has_code(line, words.own),
        Syntax::Deckel => false,
    }
}

fn has_code(line: &str, codes: &[i32]) -> bool {
    Lexer::new(line.as_bytes()).any(|(_, token)| match token {
        Token::Word { letter: b'G', number, .. } => std::str::from_utf8(number)
            .ok()
            .and_then(|number| number.parse::<f64>().ok())
            .is_some_and(|number| codes.contains(&((number * 10.0).round() as i32))),
        _ => false,
    })
}

/// The smoothing that the words of a program choose. None where they choose none, or where the shop's own
/// lines do.
pub fn in_force(job: &ProgramJob) -> Option<Smoothing> {
    if own_smoothing(job.dialect, &job.program.custom).is_some() {
        return None;
    }
    let (words, unit_mm) = (job.dialect.smoothing?, job.program.resolution.step_mm());
    let keeps_path = match job.dialect.syntax {
        Syntax::Iso(iso) | Syntax::Siemens(iso) => {
            iso.start.iter().any(|frame| matches!(frame, Frame::Blending { .. }))
        }
        Syntax::Klartext | Syntax::Deckel => false,
    };
    match job.program.smoothing {
        Some(smoothing) => Some(Smoothing { mode: smoothing.mode.or(words.usual_mode), ..smoothing }),
        None if keeps_path => {
            Some(Smoothing { tolerance_mm: Some(unit_mm), tolerance_deg: None, mode: None })
        }
        None => None,
    }
}

/// A tolerance in units of the program or in degrees, with at least `usual` decimals, and as many more as it
/// has, up to `most`. It is never rounded up.
pub fn tolerance(value: f64, usual: u8, most: u8) -> FeedWord {
    // The product of a decimal number and its scale misses a whole number by a few units of the last place.
    const ROUNDING: f64 = 1e-9;
    let with = |decimals: u8| {
        let scaled = value * 10f64.powi(i32::from(decimals));
        let digits = (scaled + ROUNDING).floor();
        (FeedWord { digits: digits as i64, decimals }, (scaled - digits).abs() <= ROUNDING)
    };
    let usual = usual.min(most);
    (usual..=most).map(with).find(|(_, is_exact)| *is_exact).map_or(with(most).0, |(word, _)| word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_tolerance_is_exact_or_rounded_down() {
        for (value, digits, decimals) in
            [(0.01, 10, 3), (0.0005, 5, 4), (0.12345, 1234, 4), (0.3, 300, 3), (0.00009, 0, 4)]
        {
            assert_eq!(tolerance(value, 3, 4), FeedWord { digits, decimals }, "{value}");
        }
    }
}
