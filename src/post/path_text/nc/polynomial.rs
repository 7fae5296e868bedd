//! Blocks of Siemens with polynomials (PO), and with a second point of the tool (ORICURVE).
//!
//! # Method
//! A polynomial states the end of a coordinate and the coefficients of the powers from 2 on of a parameter
//! that runs from 0 to PL. The coefficient of the first power follows from both ends. The second point (XH,
//! YH, ZH) lies on the tool axis above the tip. The block becomes poses within the chords of the reader.

use nalgebra::{Point3, Vector3};

use super::super::way::parts;
use super::super::{Fault, PathFault, coordinate, direction};
use super::Reader;
use super::motion::Stand;
use crate::nc::{Distance, FeedMode, Motion};
use toolpathd_core::toolpath::pose::{Pace, Waypoint};

const TIP: [&str; 3] = ["X", "Y", "Z"];
const SECOND: [&str; 3] = ["XH", "YH", "ZH"];

/// Powers from 2 on, at most: polynomials of degree 5.
const MOST_POWERS: usize = 4;

/// Whether a line states a second point or a polynomial.
pub(super) fn is_curve(text: &str) -> bool {
    let code = text.split([';', '(']).next().unwrap_or_default();
    code.contains("XH=") || code.contains("PO[")
}

/// A coordinate of a block: its end, and the coefficients of the powers from 2 on.
#[derive(Debug, Clone, Copy, Default)]
struct Coordinate {
    end: Option<f64>,
    powers: [f64; MOST_POWERS],
}

/// The words of one block, in the units of the program.
#[derive(Debug, Default)]
struct Words {
    tip: [Coordinate; 3],
    second: [Coordinate; 3],
    length: Option<f64>,
    feed: Option<f64>,
    /// Whether G1 or POLY stands in the block.
    begins_cut: bool,
    /// Whether G94 stands in the block.
    is_per_minute: bool,
}

impl Reader<'_> {
    /// A block with a second point or with polynomials.
    pub(super) fn curve(&mut self, text: &str) -> Result<(), Fault> {
        let words = Words::of(text)?;
        if words.is_per_minute && self.modal.feed_mode != Some(FeedMode::PerMinute) {
            (self.modal.feed_mode, self.modal.feed) = (Some(FeedMode::PerMinute), None);
        }
        if let Some(feed) = words.feed {
            self.modal.feed = Some(feed);
        }
        if words.begins_cut {
            self.modal.motion = Some(Motion::Line);
        }
        if self.modal.motion != Some(Motion::Line) {
            let advice = "write G1 or POLY in this block";
            let word = "a second point or a polynomial under G0, G2 or G3".to_owned();
            return Err(PathFault::Refused { word, advice }.into());
        }
        let has_second = words.second.iter().any(|own| own.end.is_some());
        if has_second && !(self.keeps_tip() && self.has_second_point) {
            let advice = "write ORICURVE under TRAORI before it";
            return Err(PathFault::Refused { word: "a second point".to_owned(), advice }.into());
        }
        if self.survey.keeps_tip && !self.keeps_tip() {
            return Err(PathFault::OutsideTip.into());
        }
        if self.modal.distance == Some(Distance::Incremental) {
            let advice = "write absolute coordinates";
            return Err(PathFault::Refused { word: "a polynomial under G91".to_owned(), advice }.into());
        }
        let from = self.stand().ok_or(PathFault::NoStart)?;
        let unit_mm = self.unit_mm();
        let length = words.length.unwrap_or(1.0);
        let of_tip = Polynomial::new(&words.tip, from.at.coords, unit_mm, length, self.shift)?;
        let of_second = if has_second {
            let whole: Option<Vec<f64>> = words.second.iter().map(|own| own.end).collect();
            let end = whole.map(|end| Vector3::from_iterator(end) * unit_mm);
            // The first block states the point where it begins and ends.
            let start = self.second.or(end).ok_or_else(not_whole)?;
            Some(Polynomial::new(&words.second, start, unit_mm, length, [0.0; 3])?)
        } else {
            None
        };
        let at = |part: f64| {
            let tip = of_tip.at(part);
            let axis = of_second.as_ref().map(|second| direction(second.at(part) - tip)).transpose()?;
            Ok::<_, PathFault>(Stand { at: Point3::from(tip), vector: axis.or(from.vector), ..from })
        };
        // Where the second point meets the tip, the tool has no axis.
        let to = at(1.0)?;
        let stand = |part: f64| at(part).unwrap_or(to);
        let count = parts(|part| self.pose(&stand(part)), self.reading.chords, 1)?;
        if self.trail.is_empty() {
            self.trail.push(Waypoint::new(self.pose(&from), Pace::Rapid))?;
        }
        self.divided(words.feed.is_some(), &from, count, stand)?;
        self.modal.at = [0, 1, 2].map(|k| Some(to.at[k]));
        self.vector = to.vector;
        self.second = of_second.map(|second| second.at(1.0));
        Ok(())
    }
}

impl Words {
    fn of(text: &str) -> Result<Self, PathFault> {
        let mut words = Self::default();
        let code = text.split(';').next().unwrap_or_default().to_ascii_uppercase();
        // Blanks inside a list belong to it.
        let mut depth = 0;
        let joined: String = code
            .chars()
            .filter(|c| {
                depth += i32::from(*c == '(') - i32::from(*c == ')');
                depth == 0 || !c.is_whitespace()
            })
            .collect();
        for word in joined.split_whitespace() {
            words.take(word)?;
        }
        Ok(words)
    }

    fn take(&mut self, word: &str) -> Result<(), PathFault> {
        let twice = || PathFault::Twice(word.to_owned());
        if let Some(list) = word.strip_prefix("PO[") {
            let (name, list) = list.split_once("]=(").ok_or_else(|| unknown(word))?;
            let list = list.strip_suffix(')').ok_or_else(|| unknown(word))?;
            let own = self.coordinate(name).ok_or_else(|| unknown(word))?;
            for (k, text) in list.split(',').enumerate() {
                let value = number(text, word)?;
                match k {
                    0 if own.end.replace(value).is_some() => return Err(twice()),
                    0 => {}
                    1..=MOST_POWERS => own.powers[k - 1] = value,
                    _ => return Err(PathFault::BadNumber(word.to_owned())),
                }
            }
            return Ok(());
        }
        if word == "POLY" || word == "G1" || word == "G01" {
            self.begins_cut = true;
            return Ok(());
        }
        if word == "G94" {
            self.is_per_minute = true;
            return Ok(());
        }
        let split = word.find(|c: char| !c.is_ascii_alphabetic()).unwrap_or(word.len());
        let (name, value) = word.split_at(split);
        let value = number(value.strip_prefix('=').unwrap_or(value), word)?;
        let place = match name {
            "N" => return Ok(()),
            "F" => &mut self.feed,
            "PL" if value > 0.0 => &mut self.length,
            "PL" => return Err(PathFault::BadNumber(word.to_owned())),
            name => &mut self.coordinate(name).ok_or_else(|| unknown(word))?.end,
        };
        if place.replace(value).is_some() { Err(twice()) } else { Ok(()) }
    }

    fn coordinate(&mut self, name: &str) -> Option<&mut Coordinate> {
        let of = |names: [&str; 3]| names.iter().position(|own| *own == name);
        match (of(TIP), of(SECOND)) {
            (Some(k), _) => Some(&mut self.tip[k]),
            (_, Some(k)) => Some(&mut self.second[k]),
            _ => None,
        }
    }
}

/// A point that runs along three polynomials of the part of a block, from 0 to 1; mm.
struct Polynomial {
    start: Vector3<f64>,
    /// The coefficients of the powers from 1 on.
    powers: [Vector3<f64>; MOST_POWERS + 1],
}

impl Polynomial {
    fn new(
        words: &[Coordinate; 3],
        start: Vector3<f64>,
        unit_mm: f64,
        length: f64,
        shift: [f64; 3],
    ) -> Result<Self, PathFault> {
        let mut powers = [Vector3::zeros(); MOST_POWERS + 1];
        for (k, Coordinate { end, powers: own }) in words.iter().enumerate() {
            let end = coordinate(end.map_or(start[k], |end| end * unit_mm + shift[k]))?;
            let mut first = end - start[k];
            for (n, own) in own.iter().enumerate() {
                let scaled = coordinate(own * unit_mm * length.powi(n as i32 + 2))?;
                powers[n + 1][k] = scaled;
                first -= scaled;
            }
            powers[0][k] = first;
        }
        Ok(Self { start, powers })
    }

    fn at(&self, part: f64) -> Vector3<f64> {
        self.powers.iter().rev().fold(Vector3::zeros(), |sum, power| (sum + power) * part) + self.start
    }
}

fn not_whole() -> PathFault {
    let advice = "state XH, YH and ZH in the first block that has one of them";
    PathFault::Refused { word: "a second point with one or two coordinates".to_owned(), advice }
}

fn unknown(word: &str) -> PathFault {
    PathFault::Unknown(word.to_owned())
}

fn number(text: &str, word: &str) -> Result<f64, PathFault> {
    let value: Option<f64> = text.parse().ok().filter(|value: &f64| value.is_finite());
    value.ok_or_else(|| PathFault::BadNumber(word.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::path_text::nc::read;
    use crate::path_text::{PathText, PathTextError, ReadSettings};
    use toolpathd_core::machine::Straying;

    fn text_of(lines: &str) -> Result<PathText, PathTextError> {
        let reading =
            ReadSettings { feed: None, limit: 10_000, chords: Straying { tip_mm: 1e-3, axis: 1e-4 } };
        let text = format!("G710 G90 G94\nTRAORI\nORIVECT\nG0 X0 Y0 Z0 A3=0 B3=0 C3=1\n{lines}\n");
        read(&text, None, 50.0, reading)
    }

    #[test]
    fn polynomials_of_two_points_are_read() {
        let lines = "ORICURVE\nG1 X0 Y0 Z0 XH=0 YH=0 ZH=50 F600\nN7 POLY PO[X]=(20., 1, -0.5) PO[Y]=(0) PO[Z]=(0) PO[XH]=(40,2.0) PO[YH]=(0) PO[ZH]=(50) PL=2";
        let path = text_of(lines).unwrap().path;
        for (k, at) in path.iter().skip(1).enumerate() {
            let p = 2.0 * k as f64 / (path.len() - 2) as f64;
            // x(2) = 20 and xh(2) = 40 give the first powers.
            let x = 10.0 * p + p * p - 0.5 * p.powi(3);
            let x = x + p * (20.0 - (20.0 + 4.0 - 4.0)) / 2.0;
            let far = (16.0 * p + 2.0 * p * p) - x;
            assert!((at.pose.tip - Point3::new(x, 0.0, 0.0)).norm() < 1e-9, "{at:?}");
            let axis = Vector3::new(far, 0.0, 50.0).normalize();
            assert!(at.pose.axis.angle(&axis) < 1e-9, "{at:?}");
        }
        assert!(path.len() > 10);
    }

    #[test]
    fn what_polynomials_leave_open_is_refused() {
        for (lines, wanted) in [
            ("G1 X5 XH=0 YH=0 ZH=50 F600", "a second point"),
            ("ORICURVE\nG1 F600 X5 XH=5 YH=0", "state XH, YH and ZH"),
            ("ORICURVE\nX5 XH=5 YH=0 ZH=50", "write G1 or POLY"),
            ("PO[X]=(1,2,3,4,5,6)", "PO[X]"),
            ("PO[Q]=(1)", "PO[Q]"),
            ("PO[X]=(1) PL=0", "PL=0"),
            ("PO[X]=(1) PO[X]=(2)", "PO[X]"),
            ("PO[X]=(1) A3=1", "A3"),
            ("ORICURVE\nG1 F600 X0 XH=0 YH=0 ZH=50\nPOLY PO[X]=(1) PO[XH]=(1) PO[YH]=(0) PO[ZH]=(0)", "axis"),
        ] {
            let error = text_of(lines).expect_err(lines).to_string();
            assert!(error.contains(wanted), "{lines}: {error}");
        }
    }
}
