//! Tool calls: the tool, the plane of the tool axis, the speed and the feed.

use toolpathd_core::geometry::plane::Plane;

use super::Execution;
use super::cursor::{Broken, Cursor};
use super::datum::Transform;
use super::script::Block;
use crate::codes::FeedMode;
use crate::fault::Fault;

/// The largest number of a tool.
const MAX_TOOL: f64 = 99_999_999.0;

/// Differences of radii that count as none, mm: well below every unit of a program.
const SAME_RADIUS_MM: f64 = 1e-6;

/// What a tool call names.
enum Tool {
    Number(u32),
    Name(String),
}

impl<'a> Execution<'a, '_> {
    /// `TOOL CALL 5 Z S2500 F350 DL+0.1`. Without a tool it changes the speed or the feed alone.
    pub(super) fn call_tool(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let start = cursor.at;
        let tool = match self.tool(cursor) {
            Ok(tool) => tool,
            Err(broken) => {
                self.refuse_broken(block, Broken { start, ..broken });
                cursor.at = broken.end.max(cursor.at);
                None
            }
        };
        let has_tool = tool.is_some();
        match tool {
            Some(Tool::Number(number)) => self.machine.put_in_tool(block.line(), Some(number), None),
            Some(Tool::Name(name)) => self.machine.put_in_tool(block.line(), None, Some(name)),
            None => {}
        }
        while !cursor.is_done() && !self.machine.is_full() {
            let start = cursor.at;
            if let Err(broken) = self.tool_word(block, cursor) {
                cursor.at = cursor.word_end().max(broken.end).max(start + 1);
                self.refuse_broken(block, Broken { start, end: cursor.at, ..broken });
            }
        }
        if has_tool {
            // The tools have different lengths along the axis of the tool.
            self.machine.at[self.machine.plane.axes()[2]] = None;
            self.forget_tangent();
        }
    }

    /// `TOOL DEF 1 L+0 R+10`. Where the path of the centre is computed, its radius has to be the one of the
    /// request.
    pub(super) fn define_tool(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        self.machine.left.add("TOOL DEF", block.line().number);
        let tool = match self.tool(cursor) {
            Ok(tool) => tool,
            Err(broken) => return self.refuse_broken(block, broken),
        };
        while !cursor.is_done() {
            let start = cursor.at;
            let is_radius = cursor.letters("R");
            if !is_radius && !cursor.letters("L") {
                return self.refuse(block, [start, cursor.word_end()], Fault::UnusedWord);
            }
            let mm = match cursor.value(&self.parameters) {
                Ok(value) => value * self.machine.unit_mm(),
                Err(broken) => return self.refuse_broken(block, Broken { start, ..broken }),
            };
            let number = match &tool {
                Some(Tool::Number(number)) => Some(*number),
                _ => None,
            };
            if let (true, Some(given)) = (is_radius, self.machine.given_radius(number))
                && given.is_none_or(|given| (given - mm).abs() > SAME_RADIUS_MM)
            {
                let by = mm - given.unwrap_or(0.0);
                self.refuse(block, [start, cursor.at], Fault::ChangesTool(by));
            }
        }
    }

    fn tool(&mut self, cursor: &mut Cursor<'_>) -> Result<Option<Tool>, Broken> {
        cursor.skip_blanks();
        let start = cursor.at;
        let broken =
            |cursor: &Cursor<'_>, fault| Broken { fault: Some(fault), start, end: cursor.word_end() };
        match cursor.peek() {
            Some(b'"') => {
                let end = cursor.text.len();
                let fault = Broken { fault: Some(Fault::NoWord), start, end };
                cursor.name().map(|name| Some(Tool::Name(name))).ok_or(fault)
            }
            Some(b'0'..=b'9' | b'Q') => {
                let number = cursor.value(&self.parameters)?;
                // A point parts the index of a stepped tool from its number.
                let whole = number.trunc();
                if !(0.0..=MAX_TOOL).contains(&whole) {
                    return Err(broken(cursor, Fault::OutOfRange(number)));
                }
                Ok(Some(Tool::Number(whole as u32)))
            }
            _ => Ok(None),
        }
    }

    fn tool_word(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) -> Result<(), Broken> {
        let start = cursor.at;
        let fault = |cursor: &Cursor<'_>, fault| Broken { fault: Some(fault), start, end: cursor.word_end() };
        for (name, plane) in [("X", Plane::Yz), ("Y", Plane::Zx), ("Z", Plane::Xy)] {
            if cursor.phrase(name) {
                self.select_plane(block, plane);
                return Ok(());
            }
        }
        for name in ["DL", "DR2", "DR"] {
            if cursor.letters(name) {
                cursor.take(b'=');
                let mm = cursor.value(&self.parameters)? * self.machine.unit_mm();
                // The tip stands higher by a length, and the contour runs farther out by a radius.
                if mm != 0.0 && (name != "DR" || self.machine.computes_compensation()) {
                    return Err(fault(cursor, Fault::ChangesTool(mm)));
                }
                self.machine.left.add(name, block.line().number);
                return Ok(());
            }
        }
        if cursor.letters("S") {
            let speed = cursor.value(&self.parameters)?;
            if speed < 0.0 {
                return Err(fault(cursor, Fault::OutOfRange(speed)));
            }
            self.machine.speed = Some(speed);
            return Ok(());
        }
        if cursor.letters("F") {
            let feed = self.feed_word(cursor, start)?;
            let rate = self.rate_of(Some(feed));
            let (mode, feed) = rate.ok_or(fault(cursor, Fault::UnusedWord))?;
            self.set_feed((mode, Some(feed)));
            self.auto_feed = Some(feed).filter(|_| mode == FeedMode::PerMinute);
            return Ok(());
        }
        Err(fault(cursor, Fault::UnusedWord))
    }

    /// The plane of a tool axis. Turns of the datum lie in it.
    fn select_plane(&mut self, block: &Block<'a>, plane: Plane) {
        if plane == self.machine.plane {
            return;
        }
        if self.transforms.iter().any(|transform| matches!(transform, Transform::Rotation(_))) {
            self.refuse_block(block, Fault::Conflict);
        }
        self.machine.plane = plane;
        self.lose_pole();
    }
}
