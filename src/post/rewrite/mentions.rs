//! The modes that a text sets anywhere, also in lines that are not understood.
//!
//! Where a part of the program may have run that was not followed, a mode that no line of the text sets in
//! another way is still in force.

use super::block::Block;
use super::lines::{line_end, split};
use crate::nc::{Effect, Modal, effect};

/// The end of a subprogram, in tenths.
const RETURN: i32 = 990;

/// The ends of a program, in tenths.
const ENDS: [i32; 2] = [20, 300];

/// What the G words of a text do.
#[derive(Debug, Clone, Default)]
pub struct Mentions {
    effects: Vec<Effect>,
    /// A G word has a computed number.
    is_any: bool,
    /// The first end of a program in the text is that of a subprogram.
    pub is_subprogram: bool,
}

impl Mentions {
    /// The modes that a text sets.
    pub fn find(text: &[u8]) -> Self {
        let (mut found, mut has_ended) = (Self::default(), false);
        for line in split(text) {
            let line = &line[..line.len() - line_end(line).len()];
            found.take(line);
            let block = Block::read(line);
            let returns = block.m.has(RETURN);
            if !has_ended && (returns || ENDS.iter().any(|end| block.m.has(*end))) {
                (found.is_subprogram, has_ended) = (returns, true);
            }
        }
        found
    }

    /// Takes the G words of a line, whatever else stands there.
    pub fn take(&mut self, line: &[u8]) {
        let mut rest = line;
        while let Some(at) = rest.iter().position(|c| matches!(c, b'G' | b'g' | b'(' | b';')) {
            let own = rest[at];
            rest = &rest[at + 1..];
            match own {
                b';' => return,
                b'(' => match rest.iter().position(|c| *c == b')') {
                    Some(end) => rest = &rest[end + 1..],
                    None => return,
                },
                _ => self.code(rest),
            }
        }
    }

    /// Takes the number behind a G.
    fn code(&mut self, text: &[u8]) {
        let text = text.trim_ascii_start();
        let length = text.iter().position(|c| !matches!(c, b'0'..=b'9' | b'.')).unwrap_or(text.len());
        let number = std::str::from_utf8(&text[..length]).ok().and_then(|digits| digits.parse::<f64>().ok());
        let tenths = number.map(|number| (10.0 * number).round()).filter(|tenths| *tenths < 1e5);
        match tenths {
            Some(tenths) => {
                let effect = effect(tenths as i32);
                if !self.effects.contains(&effect) {
                    self.effects.push(effect);
                }
            }
            // A variable or an expression; a letter is that of a word such as GOTO.
            None => self.is_any |= text.first().is_some_and(|c| matches!(c, b'#' | b'[' | b'<')),
        }
    }

    /// The modes in which the text starts: those of a program that starts, or what is known where another
    /// program calls it.
    pub fn start<P: Copy + PartialEq, F: Copy + PartialEq>(&self) -> Modal<P, F> {
        if self.is_subprogram { self.forget(&Modal::START) } else { Modal::START }
    }

    /// The modes that are still known after another part of the program, or another program, has run. Motion,
    /// plane, distance mode, feed and position are unknown. Units, centre mode, feed mode and modifiers are
    /// taken to be as before unless the text sets others.
    pub fn forget<P: Copy + PartialEq, F: Copy + PartialEq>(&self, modes: &Modal<P, F>) -> Modal<P, F> {
        let kept = Modal { distance: None, plane: None, motion: None, feed: None, at: [None; 3], ..*modes };
        if self.is_any {
            return Modal { modifiers: u16::MAX, ..Modal::UNKNOWN };
        }
        self.effects.iter().fold(kept, |kept, effect| {
            let mut other = kept;
            other.apply(*effect);
            Modal { motion: None, ..kept.common_with(&other) }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::nc::Modifier;
    use toolpathd_core::toolpath::program::Units;

    fn forgotten(text: &str) -> Modal<i64, i64> {
        Mentions::find(text.as_bytes()).forget(&Modal::START)
    }

    #[test]
    fn what_the_text_sets_elsewhere_is_not_kept() {
        let kept = forgotten("G21 G90\nX#1 (G20)\nGOTO 5 ;G20\nIF [#1 GT 3] GOTO 5");
        assert_eq!((kept.units, kept.distance, kept.modifiers), (Some(Units::Mm), None, 0));
        assert_eq!(forgotten("G0 X#1 G20").units, None);
        assert_eq!(forgotten("X#1G93").feed_mode, None);
        assert_eq!(forgotten("g 90.1 x#1").centers, None);
        assert_eq!(forgotten("G66 P9100 R#1").modifiers, Modifier::ModalMacro as u16);
        assert_eq!(forgotten("G41 D#101\nG40").modifiers, Modifier::CutterCompensation as u16);
        assert_eq!(forgotten("G#1").units, None);
    }

    #[test]
    fn the_first_end_tells_a_subprogram() {
        let is_subprogram = |text: &str| Mentions::find(text.as_bytes()).is_subprogram;
        assert!(is_subprogram("O1000\nG1 X1\nM99\n%") && !is_subprogram("O1\nM98 P2\nM30\nO2\nM99"));
        assert!(!is_subprogram("G1 X1"));
    }
}
