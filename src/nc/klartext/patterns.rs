//! Places of cycles: CYCL CALL, CYCL CALL POS, CYCL CALL PAT with PATTERN DEF, and cycles 220 and 221.
//!
//! # Method
//! * CYCL CALL POS moves across and then down to the cycle; its Z is added to the surface.
//! * CYCL CALL PAT rises to the height at which it was called, or to the second clearance if that is higher,
//!   before it moves across.
//! * Cycles 220 and 221 run the cycle in force at once, with a surface and clearances of their own. They go
//!   to the second clearance, across to the first place, and from place to place at the clearance that Q301
//!   says.
//!
//! Where the manuals leave open at which height a pattern ends, the height is not known behind it.

use super::Execution;
use super::cursor::{Broken, Cursor};
use super::drilling::{Drilling, Values};
use super::script::Block;
use super::words::{Feed, Sort};
use crate::fault::Fault;
use crate::placement::Coordinate;

/// Most places of one pattern.
const MAX_PLACES: f64 = 100_000.0;

/// A place of PATTERN DEF, mm: along the axes of the plane, and how far the surface lies higher.
#[derive(Debug, Clone, Copy)]
pub struct Point {
    pub place: [f64; 2],
    pub raised: f64,
}

/// The heights between which a pattern moves, in coordinates of the answer.
#[derive(Clone, Copy)]
struct Heights {
    first: f64,
    between: f64,
}

impl<'a> Execution<'a, '_> {
    /// `CYCL CALL`, and its forms with places.
    pub(super) fn call_cycles(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        if cursor.phrase("POS") {
            return self.call_at(block, cursor);
        }
        if cursor.phrase("PAT") {
            return self.call_pattern(block, cursor);
        }
        let words = self.scan(block, cursor, &[Sort::Function]);
        let functions = self.begin_functions(block, &words);
        self.call_cycle(block, [0, 0]);
        self.end_functions(block, &functions, false);
    }

    /// `CYCL CALL POS X+20 Y+30 Z+0 FMAX M3`.
    fn call_at(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let words = self.scan(block, cursor, &[Sort::Axis, Sort::Feed, Sort::Function]);
        let functions = self.begin_functions(block, &words);
        self.is_modal_call = false;
        let Some(drilling) = self.drilling(block).filter(|_| !words.is_broken) else {
            return self.lose_place();
        };
        let n = self.machine.plane.axes()[2];
        let mut across = words.axes;
        let raised = match across[n].take() {
            Some(Coordinate::Absolute(mm)) => mm,
            _ => return self.refuse_block(block, Fault::NoAxis),
        };
        let has_both =
            across.iter().filter(|axis| matches!(axis, Some(Coordinate::Absolute(_)))).count() == 2;
        let surface = drilling.surface.and_then(|surface| self.height(surface + raised));
        let is_above = self.machine.at[n].zip(surface).is_none_or(|(at, surface)| at > surface);
        if !has_both || surface.is_none() || !is_above || words.feed != Some(Feed::Rapid) {
            // Below the surface the tool rises first, to a height that the manuals do not state.
            self.refuse_block(block, if has_both { Fault::NotRead } else { Fault::NoAxis });
            return self.lose_place();
        }
        let mut to = self.machine.placed(across);
        to[n] = self.machine.at[n];
        self.machine.rapid(block.line(), to);
        self.make_hole(block, &drilling, raised);
        self.end_functions(block, &functions, false);
    }

    /// `PATTERN DEF POS1 (X+10 Y+20 Z+0) POS2 (...)`.
    pub(super) fn define_pattern(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        self.points.clear();
        while !cursor.is_done() {
            let start = cursor.at;
            match self.pattern_point(cursor) {
                Ok(point) => self.points.push(point),
                Err(broken) => {
                    self.refuse_broken(block, Broken { start, ..broken });
                    self.points.clear();
                    return;
                }
            }
        }
    }

    fn pattern_point(&self, cursor: &mut Cursor<'_>) -> Result<Point, Broken> {
        let start = cursor.at;
        let fault = |cursor: &Cursor<'_>, fault| Broken { fault: Some(fault), start, end: cursor.word_end() };
        if !cursor.letters("POS") || cursor.whole().is_none() {
            return Err(fault(cursor, Fault::NotRead));
        }
        if !cursor.take(b'(') {
            return Err(fault(cursor, Fault::NoWord));
        }
        let mut axes = [None; 3];
        while !cursor.take(b')') {
            cursor.skip_blanks();
            let axis = b"XYZ".iter().position(|letter| cursor.peek() == Some(*letter));
            let Some(axis) = axis.filter(|axis| axes[*axis].is_none()) else {
                return Err(fault(cursor, Fault::UnusedWord));
            };
            cursor.at += 1;
            // The parenthesis is no part of the number.
            axes[axis] = Some(cursor.value(&self.parameters)? * self.machine.unit_mm());
        }
        let [a, b, n] = self.machine.plane.axes();
        match (axes[a], axes[b]) {
            (Some(first), Some(second)) => {
                Ok(Point { place: [first, second], raised: axes[n].unwrap_or(0.0) })
            }
            _ => Err(fault(cursor, Fault::NoAxis)),
        }
    }

    /// `CYCL CALL PAT FMAX M3`.
    fn call_pattern(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        let words = self.scan(block, cursor, &[Sort::Feed, Sort::Function]);
        let functions = self.begin_functions(block, &words);
        let Some(drilling) = self.drilling(block).filter(|_| !words.is_broken) else {
            return self.lose_place();
        };
        let n = self.machine.plane.axes()[2];
        let (Some(first), Some(top)) = (self.machine.at[n], drilling.surface) else {
            return self.machine.refuse_state(block.line(), Fault::UnknownStart(['X', 'Y', 'Z'][n]));
        };
        if self.points.is_empty() {
            self.machine.refuse_state(block.line(), Fault::Lacks("PATTERN DEF"));
            return self.lose_place();
        }
        if words.feed != Some(Feed::Rapid) {
            self.refuse_block(block, Fault::Lacks("FMAX"));
            return self.lose_place();
        }
        for point in self.points.clone() {
            let high = self.height(top + point.raised + drilling.second.max(drilling.clearance));
            let safe = high.map_or(first, |high| high.max(first));
            if self.machine.is_full() || !self.spend(block, 1) {
                return;
            }
            self.rapid_to(block, safe);
            self.go_across(block, point.place);
            self.make_hole(block, &drilling, point.raised);
        }
        if self.machine.at[n] != Some(first) {
            self.machine.at[n] = None;
        }
        self.end_functions(block, &functions, false);
    }

    /// A rapid to a place in the plane of the tool, at the same height.
    fn go_across(&mut self, block: &Block<'a>, place: [f64; 2]) {
        let [a, b, n] = self.machine.plane.axes();
        let mut across = [None; 3];
        (across[a], across[b]) = (Some(Coordinate::Absolute(place[0])), Some(Coordinate::Absolute(place[1])));
        let mut to = self.machine.placed(across);
        to[n] = self.machine.at[n];
        self.machine.rapid(block.line(), to);
    }

    /// Cycles 220 and 221, which run where they are defined.
    pub(super) fn run_pattern(&mut self, block: &Block<'a>, number: u32, values: &Values) {
        let Some(mut drilling) = self.drilling(block) else { return };
        let unit = self.machine.unit_mm();
        let own = |number: u16| values.get(&number).copied().unwrap_or(0.0);
        let places = if number == 220 { on_circle(&own, unit) } else { in_rows(&own, unit) };
        let is_legal = own(200) >= 0.0 && own(204) >= 0.0 && matches!(own(301), 0.0 | 1.0);
        let places = match places {
            Ok(places) if is_legal && drilling.surface.is_some() => places,
            Err(fault) => return self.refuse_block(block, fault),
            Ok(_) => return self.refuse_block(block, Fault::NotRead),
        };
        let (top, clearance, second) = (own(203) * unit, own(200) * unit, own(204) * unit);
        let at_second = own(301) == 1.0 || second <= clearance;
        let between = if own(301) == 1.0 { second.max(clearance) } else { clearance };
        let (Some(first), Some(between)) =
            (self.height(top + second.max(clearance)), self.height(top + between))
        else {
            return self.machine.refuse_state(block.line(), Fault::UnknownStart('Z'));
        };
        if self.has_changed(&drilling, &[200, 203, 204]) {
            return self.refuse_block(block, Fault::ChangedCycle);
        }
        drilling.place(top, clearance, if own(301) == 1.0 { second } else { 0.0 });
        self.run_at(block, &drilling, &places, Heights { first, between });
        if !at_second {
            self.machine.at[self.machine.plane.axes()[2]] = None;
        }
    }

    fn run_at(&mut self, block: &Block<'a>, drilling: &Drilling, places: &[[f64; 2]], heights: Heights) {
        for (k, place) in places.iter().enumerate() {
            if self.machine.is_full() || !self.spend(block, 1) {
                return;
            }
            self.rapid_to(block, if k == 0 { heights.first } else { heights.between });
            self.go_across(block, *place);
            self.drill(block, drilling, 0.0);
        }
    }
}

/// The number of places that a parameter states.
fn count(value: f64) -> Result<usize, Fault> {
    if (1.0..=MAX_PLACES).contains(&value) && value.fract() == 0.0 {
        Ok(value as usize)
    } else {
        Err(Fault::OutOfRange(value))
    }
}

/// The places of cycle 220 on a circle, mm. The tool goes straight from one to the next.
fn on_circle(own: &dyn Fn(u16) -> f64, unit: f64) -> Result<Vec<[f64; 2]>, Fault> {
    let number = count(own(241))?;
    let whole = own(246) - own(245);
    let step = match (own(247), number) {
        (_, 1) => 0.0,
        (step, _) if step != 0.0 => step,
        _ if whole.abs() == 360.0 => whole / number as f64,
        _ if whole == 0.0 || whole.abs() > 360.0 => return Err(Fault::OutOfRange(own(246))),
        // The last hole lies at the stopping angle.
        _ => whole / (number - 1) as f64,
    };
    if own(365) != 0.0 {
        return Err(Fault::UnsureParameter(365));
    }
    let radius = own(244) / 2.0;
    let place = |k: usize| {
        let (sin, cos) = (own(245) + step * k as f64).to_radians().sin_cos();
        [(own(216) + radius * cos) * unit, (own(217) + radius * sin) * unit]
    };
    Ok((0..number).map(place).collect())
}

/// The places of cycle 221 in rows, mm: one row forth, the next one back.
fn in_rows(own: &dyn Fn(u16) -> f64, unit: f64) -> Result<Vec<[f64; 2]>, Fault> {
    let (columns, rows) = (count(own(242))?, count(own(243))?);
    count((columns as f64) * (rows as f64))?;
    let (sin, cos) = own(224).to_radians().sin_cos();
    let place = |row: usize, column: usize| {
        let (x, y) = (own(237) * column as f64, own(238) * row as f64);
        [(own(225) + x * cos - y * sin) * unit, (own(226) + x * sin + y * cos) * unit]
    };
    let mut places = Vec::new();
    for row in 0..rows {
        for k in 0..columns {
            places.push(place(row, if row % 2 == 0 { k } else { columns - 1 - k }));
        }
    }
    Ok(places)
}
