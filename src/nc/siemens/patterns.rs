//! Patterns of holes: HOLES1 (a row), HOLES2 (a circle), CYCLE801 (a grid or a frame) and CYCLE802 (places).
//!
//! # Method
//! 1. Behind the parameters later versions have masks, hidden places and a plane; values that this reader
//!    does not know are refused. No manual at hand lists these masks, nor the parameters of CYCLE802.
//! 2. A pattern moves by rapids from hole to hole. The modal cycle runs at each.
//! 3. In which order CYCLE801 runs its holes is not stated. The ways between them count as rapids that are
//!    not known, and so does the place behind the pattern.

use toolpathd_core::geometry::plane::Plane;

use super::Mill;
use super::values::Value;
use crate::block::Line;
use crate::fault::Fault;
use crate::placement::Coordinate;

/// Most holes of one pattern. More would be an error of the program.
const MAX_HOLES: f64 = 10_000.0;

/// The parameters of CYCLE802: two masks and nine places before _VARI.
const MAX_PLACES: usize = 9;

/// The mask of CYCLE802 that makes all nine coordinates absolute.
const ALL_ABSOLUTE: f64 = 111_111_111.0;

/// Places in the plane, mm of the program.
struct Holes {
    places: Vec<[f64; 2]>,
    /// The control runs them in this order, or in the opposite order from the end that is nearer.
    is_ordered: bool,
}

/// The parameters of a pattern; absent ones are zero.
struct Values<'v> {
    arguments: &'v [Option<Value>],
    unit: f64,
    /// The number of the plane in the last mask.
    plane: f64,
}

/// What a parameter is called where it is refused.
type Wrong = &'static str;

impl Values<'_> {
    fn number(&self, index: usize) -> Result<f64, Wrong> {
        match self.arguments.get(index) {
            Some(Some(Value::Number(value))) => Ok(*value),
            Some(Some(Value::Text(text))) if !text.trim().is_empty() => Err("_HIDE"),
            _ => Ok(0.0),
        }
    }

    fn is_given(&self, index: usize) -> bool {
        matches!(self.arguments.get(index), Some(Some(_)))
    }

    fn length(&self, index: usize) -> Result<f64, Wrong> {
        Ok(self.number(index)? * self.unit)
    }

    fn count(&self, index: usize, name: Wrong) -> Result<usize, Wrong> {
        let number = self.number(index)?;
        let is_legal = number.fract() == 0.0 && (1.0..=MAX_HOLES).contains(&number);
        if is_legal { Ok(number as usize) } else { Err(name) }
    }

    /// What stands behind the parameters from `first` on: reserved ones, hidden places, and the plane.
    fn check_rest(&self, first: usize, plane: usize) -> Result<(), Wrong> {
        for index in first..self.arguments.len() {
            let value = self.number(index)?;
            let is_plane = index == plane && value == self.plane;
            if value != 0.0 && !is_plane {
                return Err(if index == plane { "_DMODE" } else { "behind _VARI" });
            }
        }
        Ok(())
    }

    fn holes(&self, name: &str) -> Result<Holes, Wrong> {
        match name {
            "HOLES1" => self.row(),
            "HOLES2" => self.circle(),
            "CYCLE801" => self.grid(),
            _ => self.places(),
        }
    }

    fn at(&self, degrees: f64, mm: f64) -> Result<[f64; 2], Wrong> {
        let (sin, cos) = degrees.to_radians().sin_cos();
        Ok([self.length(0)? + mm * cos, self.length(1)? + mm * sin])
    }

    /// HOLES1(SPCA, SPCO, STA1, FDIS, DBH, NUM, _VARI, _UMODE, _HIDE, _NSP, _DMODE).
    fn row(&self) -> Result<Holes, Wrong> {
        let number = self.count(5, "NUM")?;
        self.check_rest(6, 10)?;
        let (first, step) = (self.length(3)?, self.length(4)?);
        if first < 0.0 || step < 0.0 || step == 0.0 && number > 1 {
            return Err(if first < 0.0 { "FDIS" } else { "DBH" });
        }
        let places: Result<_, _> =
            (0..number).map(|k| self.at(self.number(2)?, first + step * k as f64)).collect();
        Ok(Holes { places: places?, is_ordered: true })
    }

    /// HOLES2(CPA, CPO, RAD, STA1, INDA, NUM, _VARI, _UMODE, _HIDE, _NSP, _DMODE). The thousands of _VARI
    /// tell a full circle (1) from a part of one (2); the tens would lead from hole to hole on the circle.
    fn circle(&self) -> Result<Holes, Wrong> {
        let number = self.count(5, "NUM")?;
        self.check_rest(7, 10)?;
        let (own, whole) = (self.number(4)?, 360.0 / number as f64);
        let step = match self.number(6)? {
            0.0 if own == 0.0 => whole,
            1000.0 if own == 0.0 || (own - whole).abs() < 1e-9 => whole,
            0.0 => own,
            2000.0 if own != 0.0 => own,
            _ => return Err("_VARI"),
        };
        let radius = self.length(2)?;
        if radius <= 0.0 {
            return Err("RAD");
        }
        let places: Result<_, _> =
            (0..number).map(|k| self.at(self.number(3)? + step * k as f64, radius)).collect();
        Ok(Holes { places: places?, is_ordered: true })
    }

    /// CYCLE801(_SPCA, _SPCO, _STA, _DIS1, _DIS2, _NUM1, _NUM2, _VARI, _UMODE, _ANG1, _ANG2, _HIDE, _NSP,
    /// _DMODE). _VARI is 0 for a grid, 1 for its frame.
    fn grid(&self) -> Result<Holes, Wrong> {
        let (columns, rows) = (self.count(5, "_NUM1")?, self.count(6, "_NUM2")?);
        let is_frame = match self.number(7)? {
            0.0 => false,
            1.0 => true,
            _ => return Err("_VARI"),
        };
        self.check_rest(8, 13)?;
        if columns as f64 * rows as f64 > MAX_HOLES {
            return Err("_NUM2");
        }
        let (sin, cos) = self.number(2)?.to_radians().sin_cos();
        let (x, y) = (self.length(0)?, self.length(1)?);
        let (across, up) = (self.length(3)?, self.length(4)?);
        let mut places = Vec::new();
        for row in 0..rows {
            for column in 0..columns {
                let is_inside = row > 0 && row + 1 < rows && column > 0 && column + 1 < columns;
                if is_frame && is_inside {
                    continue;
                }
                let (u, v) = (across * column as f64, up * row as f64);
                places.push([x + u * cos - v * sin, y + u * sin + v * cos]);
            }
        }
        Ok(Holes { is_ordered: places.len() == 1, places })
    }

    /// CYCLE802(_XA, _YA, _X0, _Y0, _X1, _Y1, ..., _X8, _Y8, _VARI, _UMODE, _DMODE).
    fn places(&self) -> Result<Holes, Wrong> {
        for (index, name) in [(0, "_XA"), (1, "_YA")] {
            if self.number(index)? != ALL_ABSOLUTE {
                return Err(name);
            }
        }
        let rest = 2 + 2 * MAX_PLACES;
        self.check_rest(rest, rest + 2)?;
        let mut places = Vec::new();
        for index in (2..rest).step_by(2) {
            match (self.is_given(index), self.is_given(index + 1)) {
                (true, true) if places.len() == (index - 2) / 2 => {
                    places.push([self.length(index)?, self.length(index + 1)?]);
                }
                (false, false) => {}
                _ => return Err("a place"),
            }
        }
        if places.is_empty() { Err("a place") } else { Ok(Holes { places, is_ordered: true }) }
    }
}

impl<'a> Mill<'a, '_> {
    /// Runs a pattern by its name. Parameters that are not known are refused.
    pub fn run_pattern(&mut self, line: Line<'a>, name: &str, arguments: &[Option<Value>], span: [usize; 2]) {
        self.settle(line);
        self.tangent = None;
        self.assume_units(line);
        let plane = match self.machine.plane {
            Plane::Xy => 1.0,
            Plane::Zx => 2.0,
            Plane::Yz => 3.0,
        };
        let values = Values { arguments, unit: self.machine.unit_mm(), plane };
        let Holes { mut places, mut is_ordered } = match values.holes(name) {
            Ok(holes) => holes,
            Err(wrong) => {
                self.refuse(line, span, Fault::CycleParameter(wrong));
                return self.lose_place();
            }
        };
        if !self.count(line, places.len()) {
            return;
        }
        if name == "HOLES1" {
            match self.is_nearer_to_last(&places) {
                Some(true) => places.reverse(),
                Some(false) => {}
                // From which end the control begins is not known.
                None => is_ordered = places.len() == 1,
            }
        }
        let [a, b, _] = self.machine.plane.axes();
        for [x, y] in places {
            let mut coordinates = [None; 3];
            (coordinates[a], coordinates[b]) = (Some(Coordinate::Absolute(x)), Some(Coordinate::Absolute(y)));
            (self.owed[a], self.owed[b]) = (Some(0.0), Some(0.0));
            if !is_ordered {
                (self.machine.at[a], self.machine.at[b]) = (None, None);
            }
            let to = self.machine.placed(coordinates);
            self.machine.rapid(line, to);
            if let Some(cycle) = self.modal_cycle.clone() {
                self.run_cycle(line, &cycle);
            }
            if self.machine.is_full() {
                return;
            }
        }
        if !is_ordered {
            (self.machine.at[a], self.machine.at[b]) = (None, None);
        }
    }

    /// HOLES1 begins at the end of the row that is nearer. `None` where the place of the tool is not known.
    fn is_nearer_to_last(&self, holes: &[[f64; 2]]) -> Option<bool> {
        let [a, b, _] = self.machine.plane.axes();
        let at = self.in_program();
        let (Some(x), Some(y)) = (at[a], at[b]) else { return None };
        let way = |hole: Option<&[f64; 2]>| hole.map_or(0.0, |[u, v]| (u - x).hypot(v - y));
        Some(way(holes.last()) < way(holes.first()) - 1e-9)
    }
}
