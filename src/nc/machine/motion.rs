//! What the axis words of a block do: rapids, cuts, and the codes that take axis words as data.

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::curve::{Curve, Line as Segment, Parabola};
use toolpathd_core::geometry::plane::Plane;
use toolpathd_core::toolpath::units::FeedRate;

use super::{AXES, At, Block, Code, Family, Fault, FeedMode, Line, Machine, Meaning, Motion, OFFSETS};

/// A shorter way is none, mm. Sums of coordinates differ by some 1e-12 mm from what they should be, and under
/// G93 the shortest way takes the whole time of its block.
const NO_WAY_MM: f64 = 1e-9;

impl Machine<'_> {
    /// Gives the axis words of a block to the code that takes them, or to the motion in force.
    pub(super) fn move_by(&mut self, line: Line<'_>, block: &mut Block, meanings: &[(Code, Meaning)]) {
        if self.place_coordinates(line, block, meanings) {
            return;
        }
        let has = |wanted: Meaning| meanings.iter().any(|(_, meaning)| *meaning == wanted);
        for (code, meaning) in meanings {
            match meaning {
                Meaning::SetData => return self.set_data(line, block),
                Meaning::Home => return self.go_home(line, block),
                Meaning::Local => return self.shift_locally(line, block),
                Meaning::SetPlace => return self.set_place(line, block),
                Meaning::UnsetPlace { .. } | Meaning::RestorePlace if !self.control.is_strict => {
                    let named = AXES.map(|letter| block.has(&[letter]));
                    let axes = if named.contains(&true) { named } else { [true; 3] };
                    block.use_up(&AXES);
                    return self.unset_place(*meaning, axes);
                }
                Meaning::Dwell if !self.control.is_strict => return,
                Meaning::Parabola => return self.parabola(line, block, *code),
                Meaning::NotRead | Meaning::Unknown => {
                    // Its words are its own, and where it leads is not known.
                    block.use_up(b"ABCDEFHIJKLPQRUVWXYZ");
                    return;
                }
                Meaning::Cycle(number) => self.begin_cycle(line, *number, *code),
                _ => {}
            }
        }
        if meanings.iter().any(|(code, _)| code.tenths == 431 || code.tenths == 432) {
            return;
        }
        let has_axes = block.has(&AXES) || self.has_polar_words();
        if self.has_cycle() {
            // LinuxCNC drills where a block names a place; the others do for R alone, too.
            if has_axes || block.has(b"R") && !self.control.is(Family::LinuxCnc) {
                self.drill(line, block);
            }
            return;
        }
        let is_arc = matches!(self.motion, Some(Motion::Arc(_)));
        let arc = meanings.iter().find(|(_, meaning)| matches!(meaning, Meaning::Motion(Motion::Arc(_))));
        if let Some((code, _)) = arc
            && self.control.is_strict
            && !has_axes
            && !block.has(&OFFSETS)
            && !block.has(b"R")
        {
            return self.refuse_code(line, *code, Fault::NoCenter);
        }
        if !has_axes && !(is_arc && (block.has(&OFFSETS) || block.has(b"R"))) {
            return;
        }
        let on_machine = has(Meaning::Machine);
        match self.motion {
            None => {
                self.refuse_state(line, Fault::NoMotion);
                block.use_up(b"XYZIJKR");
            }
            Some(Motion::Arc(_)) if on_machine => {
                self.refuse(line.refused(Fault::Conflict));
                block.use_up(b"XYZIJKR");
            }
            Some(Motion::Arc(direction)) => self.arc(line, block, direction),
            Some(motion) => {
                let to = if on_machine {
                    if !self.is_absolute && self.control.is_strict {
                        self.refuse(line.refused(Fault::Conflict));
                    }
                    self.machine_target(line, block)
                } else {
                    self.target(line, block)
                };
                if motion == Motion::Rapid {
                    self.rapid(line, to);
                } else {
                    self.line(line, to);
                }
            }
        }
    }

    /// A rapid to a place that may not be known.
    pub(crate) fn rapid(&mut self, line: Line<'_>, to: At) {
        let moves = to != self.at || to.contains(&None);
        match (Self::place(&self.at), Self::place(&to)) {
            (Ok(from), Ok(to)) if self.is_compensating() && from != to => {
                self.follow(Curve::Line(Segment { start: from, end: to }), None, line);
            }
            (Ok(_), Ok(_)) if self.is_compensating() => {}
            (Ok(from), Ok(to)) => {
                let [from, to] = self.displace(from, to);
                if let Err(error) = self.record.rapid(from, to, line.number) {
                    self.refuse_path(line, error);
                }
            }
            _ if moves => {
                self.record.n_rapids_not_counted += 1;
                self.displaced = None;
            }
            _ => {}
        }
        self.at = to;
    }

    /// The ends of a cut, both known. A cut with an unknown end is refused.
    pub(crate) fn ends(&mut self, line: Line<'_>, to: &At) -> Option<[Point3<f64>; 2]> {
        let fault = match (Self::place(&self.at), Self::place(to)) {
            (Ok(from), Ok(to)) => return Some([from, to]),
            (Err(axis), _) => Fault::UnknownStart(axis),
            (_, Err(axis)) => Fault::UnknownEnd(axis),
        };
        self.refuse_state(line, fault);
        None
    }

    /// A straight cut.
    pub(crate) fn line(&mut self, line: Line<'_>, to: At) {
        if let Some([start, end]) = self.ends(line, &to) {
            let [start, end] = self.displace(start, end);
            let length = (end - start).norm();
            if length < NO_WAY_MM {
                self.rate(line, 0.0);
                return;
            }
            if let Some(rate) = self.rate(line, length) {
                self.cut(line, Curve::Line(Segment { start, end }), rate);
            }
        }
        self.at = to;
    }

    /// Records a cut at a rate.
    pub(crate) fn cut(&mut self, line: Line<'_>, curve: Curve, rate: FeedRate) {
        let speed = self.speed.filter(|_| self.is_turning);
        if self.is_compensating() {
            return self.follow(curve, Some((rate, speed)), line);
        }
        if self.displaced.is_some() && !matches!(curve, Curve::Line(_)) {
            return self.refuse(line.refused(Fault::ArcAfterCompensation));
        }
        if let Err(error) = self.record.feed(curve, rate, speed, line.number) {
            self.refuse_path(line, error);
        }
    }

    /// The feed of a move of this length; `None` where there is none, which is refused.
    pub(crate) fn rate(&mut self, line: Line<'_>, length_mm: f64) -> Option<FeedRate> {
        let fault = match (self.feed_mode, self.feed) {
            (FeedMode::InverseTime, None) => Fault::NoInverseTime,
            (_, None | Some(0.0)) => Fault::NoFeed,
            (FeedMode::PerTurn, Some(_)) if self.speed.is_none_or(|speed| speed == 0.0) => {
                Fault::NoSpindleSpeed
            }
            (mode, Some(feed)) => {
                let value = match mode {
                    FeedMode::PerMinute => feed,
                    // A block without a way has no feed, and takes no time.
                    FeedMode::InverseTime if length_mm == 0.0 => feed,
                    FeedMode::InverseTime => feed * length_mm,
                    FeedMode::PerTurn => feed * self.speed.unwrap_or(0.0),
                };
                match FeedRate::from_mm_per_min(value) {
                    Some(rate) => return Some(rate),
                    None => Fault::OutOfRange(value),
                }
            }
        };
        self.refuse_state(line, fault);
        None
    }

    /// G5.1: a parabola in the plane of X and Y, with I and J from the start to the control point.
    fn parabola(&mut self, line: Line<'_>, block: &mut Block, code: Code) {
        let offsets = [b'I', b'J'].map(|letter| block.take(letter));
        let has_both = offsets.iter().any(Option::is_some);
        if self.plane != Plane::Xy || block.has(b"Z") || !has_both {
            self.refuse_code(line, code, Fault::Conflict);
            block.use_up(&AXES);
            return;
        }
        let [i, j] = offsets.map(|slot| slot.map_or(0.0, |slot| self.length_mm(line, slot)));
        let to = self.target(line, block);
        if let Some([start, end]) = self.ends(line, &to) {
            let control = start + self.placement.direction(Vector3::new(i, j, 0.0));
            match Parabola::new(start, control, end) {
                Ok(parabola) => {
                    let curve = Curve::Parabola(parabola);
                    if let Some(rate) = self.rate(line, curve.length()) {
                        self.cut(line, curve, rate);
                    }
                }
                Err(_) => self.refuse(line.refused(Fault::NotFinite)),
            }
        }
        self.at = to;
        // It is not modal here: a block that follows it without a G word is not read.
        self.motion = None;
    }

    /// Whether words of the other family are ignored beside a word that overrides them.
    pub(super) fn ignores_overridden(&self) -> bool {
        self.control.is(Family::Fanuc)
    }
}
