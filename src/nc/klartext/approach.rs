//! APPR and DEP: how the tool comes to a contour and leaves it, by LT, LN, CT and LCT.
//!
//! # Method
//! 1. All lengths and radii are those of the path of the tool's centre. The place beside the first or the
//!    last point of the contour lies across the contour at the radius of the cutter; with R0 it is the point.
//! 2. APPR waits for the next element, whose direction it needs. The tool goes from its start to an auxiliary
//!    point, and from there to the contour: straight along it (LT), straight across it (LN), or by an arc
//!    that touches it (CT). The arc of LCT touches the way to the auxiliary point, too.
//! 3. To the auxiliary point the tool goes at the feed, or by the rapid, of the block before; LCT goes there
//!    at its own feed.
//! 4. DEP is the same way round, and ends the compensation.
//!
//! # Guarantees
//! Controls differ in how such a block moves along the tool axis, so that another height is refused. Without
//! RL or RR the side of LN, CT and LCT is not certain: newer controls stop there.
//!
//! # Reference
//! HEIDENHAIN user's manuals: TNC 410 pp. 71-72; iTNC 530 (340 49x-03) p. 230; TNC 620 (01/2022) p. 147;
//! TNC 640 (34059x-02) p. 199; TNC7 (81762x-16), *Approach functions*.

use nalgebra::{Rotation2, Vector2};
use toolpathd_core::geometry::curve::Direction;

use super::cursor::Cursor;
use super::functions::Functions;
use super::path::{NO_WAY_MM, PathElement, in_plane};
use super::script::Block;
use super::words::{Feed, Sort, Words};
use super::{Approach, Execution, Form, Rate};
use crate::block::Line;
use crate::fault::Fault;
use crate::machine::{At, Side};
use crate::offset_curve::left_of;

/// Largest centre angle of an arc, degrees.
const MAX_CENTER_ANGLE: f64 = 360.0;

/// M functions that end a program, change a tool or call a cycle.
const CALLING: [u32; 5] = [2, 6, 30, 89, 99];

/// A line or an arc of the way, in the plane.
struct LineOrArc {
    to: Vector2<f64>,
    about: Option<Pivot>,
}

/// The centre of an arc, and whether the arc turns counterclockwise.
#[derive(Clone, Copy)]
struct Pivot {
    center: Vector2<f64>,
    is_left: bool,
}

impl Pivot {
    /// The arc of a radius with a sign that touches a contour at `at`; a positive radius lies on the side of
    /// the tool.
    fn beside(at: Vector2<f64>, along: Vector2<f64>, across: Vector2<f64>, radius: f64) -> Self {
        let center = at + across * radius;
        Self { center, is_left: left_of(along).dot(&(center - at)) > 0.0 }
    }

    /// The place that lies `degrees` before another on the arc, or behind it where the angle is negative.
    fn before(&self, at: Vector2<f64>, degrees: f64) -> Vector2<f64> {
        let angle = if self.is_left { -degrees } else { degrees };
        self.center + Rotation2::new(angle.to_radians()) * (at - self.center)
    }

    /// Where a line from `outside` touches the circle so that it goes on in the sense of the arc; with
    /// `leaves` where a line to `outside` does. `None` from inside the circle.
    fn touched(&self, outside: Vector2<f64>, radius: f64, leaves: bool) -> Option<Vector2<f64>> {
        let seen = outside - self.center;
        let distance = seen.norm();
        if distance < radius + NO_WAY_MM {
            return None;
        }
        let angle = (radius / distance).acos();
        let angle = if self.is_left == leaves { -angle } else { angle };
        Some(self.center + Rotation2::new(angle) * (seen * (radius / distance)))
    }
}

impl<'a> Execution<'a, '_> {
    /// `APPR CT X+10 Y+20 CCA180 R+10 RR F100`.
    pub(super) fn approach(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        self.drop_approach();
        self.settle();
        let before = self.path.ends_rapid;
        let first: Rate = (self.machine.feed_mode, self.machine.feed);
        let Some((words, functions, form)) = self.begin_lead(block, cursor, true) else { return };
        let (side, span) = words.side.unwrap_or((None, [0, 0]));
        let to = self.machine.placed(words.axes);
        let fault = match form {
            _ if self.side.is_some() => Some(Fault::Conflict),
            _ if words.feed == Some(Feed::Rapid) => Some(Fault::Conflict),
            _ if words.axes == [None; 3] => Some(Fault::NoAxis),
            Form::Along(_) => None,
            _ if side.is_none() => Some(Fault::Lacks("RL or RR")),
            _ => None,
        };
        if let Some(fault) = fault.or(self.height_fault(&to)) {
            return self.refuse_lead(block, Some(fault), &functions);
        }
        if let Some((_, span)) = words.functions.iter().find(|(number, _)| CALLING.contains(number)) {
            self.refuse(block, *span, Fault::Conflict);
            return self.lose_place();
        }
        let (line, span) = block.place(span[0], span[1]);
        let radius_mm = match side {
            None => Some(0.0),
            Some(_) => self.machine.approach_radius(line, span),
        };
        let Some(radius_mm) = radius_mm else { return self.refuse_lead(block, None, &functions) };
        let second = (self.machine.feed_mode, self.machine.feed);
        let first = match form {
            Form::ArcAndLine(_) => Some(second),
            _ => Some(first).filter(|_| !before),
        };
        let from = self.machine.at;
        self.side = side;
        self.forget_tangent();
        self.path.approach =
            Some(Approach { line: block.line(), form, from, side, radius_mm, first, second });
        self.machine.at = to;
        self.end_functions(block, &functions, false);
    }

    /// Controls move along the tool axis in different ways.
    fn height_fault(&self, to: &At) -> Option<Fault> {
        let n = self.machine.plane.axes()[2];
        (to[n] != self.machine.at[n]).then_some(Fault::HeightInLead)
    }

    /// Reads the words of APPR and DEP. `None` where one is refused.
    fn begin_lead(
        &mut self,
        block: &Block<'a>,
        cursor: &mut Cursor<'_>,
        is_approach: bool,
    ) -> Option<(Words, Functions, Form)> {
        let name = cursor.keyword();
        let start = cursor.at;
        cursor.at += name.len();
        let own: &[Sort] = match name {
            b"LT" | b"LN" => &[Sort::Length],
            b"CT" => &[Sort::CenterAngle, Sort::Radius],
            b"LCT" => &[Sort::Radius],
            _ => {
                self.refuse(block, [start, cursor.word_end()], Fault::NotRead);
                self.lose_place();
                return None;
            }
        };
        let mut allowed = vec![Sort::Feed, Sort::Function];
        allowed.extend(own);
        if is_approach || name == b"LCT" {
            allowed.push(Sort::Axis);
        }
        if is_approach {
            allowed.push(Sort::Side);
        }
        let words = self.scan(block, cursor, &allowed);
        let functions = self.begin_functions(block, &words);
        if let Some((mode, feed)) = self.rate_of(words.feed) {
            self.set_feed((mode, Some(feed)));
        }
        if words.is_broken || self.is_modal_call || !self.has_no_machine_zero(block, &functions) {
            self.refuse_lead(block, self.is_modal_call.then_some(Fault::Conflict), &functions);
            return None;
        }
        match form(name, &words) {
            Ok(form) => Some((words, functions, form)),
            Err(fault) => {
                self.refuse_lead(block, Some(fault), &functions);
                None
            }
        }
    }

    /// Refuses APPR or DEP. An end of the program in its block stays one.
    fn refuse_lead(&mut self, block: &Block<'a>, fault: Option<Fault>, functions: &Functions) {
        if let Some(fault) = fault {
            self.refuse_block(block, fault);
        }
        self.lose_place();
        self.end_functions(block, functions, false);
    }

    /// Refuses an approach behind which no element comes.
    pub(super) fn drop_approach(&mut self) {
        if let Some(approach) = self.path.approach.take() {
            self.machine.refuse(approach.line.refused(Fault::Lacks("the next element")));
            self.lose_place();
        }
    }

    /// Runs the approach that waits, to the start of an element. False where that is refused.
    pub(super) fn run_approach(&mut self, approach: &Approach<'a>, element: &PathElement<'a>) -> bool {
        let plane = self.machine.plane;
        let places = (in_plane(&approach.from, plane), in_plane(&element.from, plane));
        let Some(along) = element.tangents(plane).map(|[begins, _]| begins) else {
            self.machine.refuse_state(element.line, Fault::NoTangent);
            return false;
        };
        let (Some(start), Some(point)) = places else {
            self.machine.refuse_state(approach.line, Fault::UnknownStart(['X', 'Y', 'Z'][plane.axes()[0]]));
            return false;
        };
        let across = self.across(along, approach.side);
        let end = point + across * approach.radius_mm;
        let Some(form) = self.placed_form(approach.line, approach.form) else { return false };
        let ways = match form {
            Form::Along(length) => [line_to(end - along * length), line_to(end)],
            Form::Across(length) => [line_to(end + across * length), line_to(end)],
            Form::Arc(radius, degrees) => {
                let pivot = Pivot::beside(end, along, across, radius);
                [line_to(pivot.before(end, degrees)), LineOrArc { to: end, about: Some(pivot) }]
            }
            Form::ArcAndLine(radius) => {
                let pivot = Pivot::beside(end, along, across, radius);
                let Some(touched) = pivot.touched(start, radius, false) else {
                    self.machine.refuse(approach.line.refused(Fault::NoTangent));
                    return false;
                };
                [line_to(touched), LineOrArc { to: end, about: Some(pivot) }]
            }
        };
        let now: Rate = (self.machine.feed_mode, self.machine.feed);
        self.machine.at = approach.from;
        for (way, rate) in ways.iter().zip([approach.first, Some(approach.second)]) {
            self.run_way(approach.line, way, rate);
        }
        (self.machine.feed_mode, self.machine.feed) = now;
        if let Some(side) = approach.side.filter(|_| approach.radius_mm > 0.0) {
            self.machine.compensate_from_here(approach.line, side, approach.radius_mm);
        }
        self.machine.at = element.from;
        true
    }

    /// `DEP LCT X+10 Y+12 R8 F100`.
    pub(super) fn depart(&mut self, block: &Block<'a>, cursor: &mut Cursor<'_>) {
        self.drop_approach();
        self.settle();
        let Some((words, functions, form)) = self.begin_lead(block, cursor, false) else { return };
        let to = self.machine.placed(words.axes);
        let is_rapid = words.feed == Some(Feed::Rapid);
        let is_straight = matches!(form, Form::Along(_) | Form::Across(_));
        let fault = match form {
            _ if is_rapid && !is_straight => Some(Fault::Conflict),
            Form::ArcAndLine(_) if words.axes == [None; 3] => Some(Fault::NoAxis),
            Form::Along(_) => None,
            _ if self.side.is_none() => Some(Fault::Lacks("RL or RR")),
            _ => None,
        };
        if let Some(fault) = fault.or(self.height_fault(&to)) {
            return self.refuse_lead(block, Some(fault), &functions);
        }
        let Some(along) = self.tangent() else {
            self.machine.refuse_state(block.line(), Fault::Lacks("an element before it"));
            return self.refuse_lead(block, None, &functions);
        };
        let across = self.across(along, self.side);
        self.side = None;
        self.machine.end_compensation();
        self.machine.stand_beside();
        let plane = self.machine.plane;
        let (Some(from), Some(form)) =
            (in_plane(&self.machine.at, plane), self.placed_form(block.line(), form))
        else {
            return self.lose_place();
        };
        let mut ways = Vec::new();
        match form {
            Form::Along(length) => ways.push(line_to(from + along * length)),
            Form::Across(length) => ways.push(line_to(from + across * length)),
            Form::Arc(radius, degrees) => {
                let pivot = Pivot::beside(from, along, across, radius);
                ways.push(LineOrArc { to: pivot.before(from, -degrees), about: Some(pivot) });
            }
            Form::ArcAndLine(radius) => {
                let pivot = Pivot::beside(from, along, across, radius);
                let end = in_plane(&to, plane);
                let touched = end.and_then(|end| pivot.touched(end, radius, true));
                let (Some(end), Some(touched)) = (end, touched) else {
                    return self.refuse_lead(block, Some(Fault::NoTangent), &functions);
                };
                ways.extend([LineOrArc { to: touched, about: Some(pivot) }, line_to(end)]);
            }
        }
        let rate = Some((self.machine.feed_mode, self.machine.feed)).filter(|_| !is_rapid);
        for way in &ways {
            self.run_way(block.line(), way, rate);
        }
        self.path.ends_rapid = is_rapid;
        self.forget_tangent();
        self.end_functions(block, &functions, true);
    }

    /// The direction across the contour to the side of the tool.
    fn across(&self, along: Vector2<f64>, side: Option<Side>) -> Vector2<f64> {
        match side.map(|side| self.machine.side_placed(side)) {
            Some(Side::Left) => left_of(along),
            _ => -left_of(along),
        }
    }

    /// A form with lengths where the program's coordinates lie.
    fn placed_form(&mut self, line: Line<'a>, form: Form) -> Option<Form> {
        let Some((factor, _)) = self.machine.placement.in_plane(self.machine.plane) else {
            self.machine.refuse(line.refused(Fault::Ellipse));
            return None;
        };
        Some(match form {
            Form::Along(length) => Form::Along(length * factor),
            Form::Across(length) => Form::Across(length * factor),
            Form::Arc(radius, degrees) => Form::Arc(radius * factor, degrees),
            Form::ArcAndLine(radius) => Form::ArcAndLine(radius * factor),
        })
    }

    /// A line or an arc from where the tool stands, at a feed or by a rapid.
    fn run_way(&mut self, line: Line<'a>, way: &LineOrArc, rate: Option<Rate>) {
        let [a, b, _] = self.machine.plane.axes();
        let mut to = self.machine.at;
        (to[a], to[b]) = (Some(way.to.x), Some(way.to.y));
        let Some((mode, feed)) = rate else { return self.machine.rapid(line, to) };
        (self.machine.feed_mode, self.machine.feed) = (mode, feed);
        match way.about {
            None => self.machine.line(line, to),
            Some(Pivot { center, is_left }) => {
                let direction = if is_left { Direction::Ccw } else { Direction::Cw };
                let direction = self.sense(self.machine.plane, direction);
                self.machine.arc_about(line, to, center.into(), direction, 1);
            }
        }
    }
}

fn line_to(to: Vector2<f64>) -> LineOrArc {
    LineOrArc { to, about: None }
}

/// The form that a name and its words state.
fn form(name: &[u8], words: &Words) -> Result<Form, Fault> {
    let positive = |value: f64| if value > 0.0 { Ok(value) } else { Err(Fault::OutOfRange(value)) };
    let length = || words.length.ok_or(Fault::Lacks("LEN")).and_then(positive);
    let radius = || words.radius.map(|(mm, _)| mm).filter(|mm| *mm != 0.0).ok_or(Fault::Missing('R'));
    Ok(match name {
        b"LT" => Form::Along(length()?),
        b"LN" => Form::Across(length()?),
        b"LCT" => Form::ArcAndLine(positive(radius()?)?),
        _ => {
            let degrees = words.center_angle.ok_or(Fault::Lacks("CCA")).and_then(positive)?;
            if degrees > MAX_CENTER_ANGLE {
                return Err(Fault::OutOfRange(degrees));
            }
            Form::Arc(radius()?, degrees)
        }
    })
}
