//! Checks numbers, counts and texts of a request. The check goes on after a violation, so that all violations
//! are collected.

use super::words;
use crate::http::error::{ApiError, FieldCode, FieldError, MAX_ERRORS};
use crate::http::pointer::Pointer;

/// Largest magnitude of a coordinate or a length, mm. A number beyond a kilometre is a mistake.
pub const MAX_MAGNITUDE_MM: f64 = 1e6;

/// Smallest legal length (mm), feed (mm/min) or speed (1/min). A smaller number is a mistake, and the
/// quotient of two legal numbers is always finite.
pub const MIN_POSITIVE: f64 = 1e-3;

/// A closed range of numbers.
#[derive(Debug, Clone, Copy)]
pub struct Range {
    pub min: f64,
    pub max: f64,
}

impl Range {
    /// Legal lengths, feeds and speeds.
    pub const POSITIVE: Range = Range { min: MIN_POSITIVE, max: MAX_MAGNITUDE_MM };
    /// Legal lengths that may be nothing.
    pub const NOT_NEGATIVE: Range = Range { min: 0.0, max: MAX_MAGNITUDE_MM };
    /// Legal heights and coordinates.
    pub const COORDINATE: Range = Range { min: -MAX_MAGNITUDE_MM, max: MAX_MAGNITUDE_MM };

    pub fn holds(&self, value: f64) -> bool {
        (self.min..=self.max).contains(&value)
    }
}

/// A number with its unit as text. `unit` is empty for a plain number.
fn with_unit(value: f64, unit: &str) -> String {
    let value = format!("{value:?}");
    format!("{} {unit}", value.trim_end_matches(".0")).trim_end().to_owned()
}

/// Whether a number is beyond all that a part or a machine may have.
fn is_too_large(value: f64, range: Range) -> bool {
    value.abs() > MAX_MAGNITUDE_MM && range.max <= MAX_MAGNITUDE_MM
}

/// What is wrong with a number outside `range`: the code and the sentence.
pub fn fault_of_number(value: f64, range: Range, unit: &str) -> (FieldCode, String) {
    if is_too_large(value, range) {
        let most = with_unit(MAX_MAGNITUDE_MM, unit);
        let detail = format!("{} is too large; no number may be beyond {most}", with_unit(value, unit));
        (FieldCode::TooLarge, detail)
    } else {
        let (value, min, max) =
            (with_unit(value, unit), with_unit(range.min, ""), with_unit(range.max, unit));
        (FieldCode::OutOfRange, format!("{value} is not allowed; send {min} to {max}"))
    }
}

/// The violations found so far: the first [`MAX_ERRORS`] violations, and the number of all.
#[derive(Debug, Default)]
pub struct Violations {
    first: Vec<FieldError>,
    total: usize,
}

impl Violations {
    pub fn add(&mut self, at: &Pointer, code: FieldCode, detail: impl Into<String>) {
        self.add_made(|| FieldError::new(at, code, detail));
    }

    /// As [`Self::add`], for a violation that is made only where it is listed.
    pub fn add_made(&mut self, make: impl FnOnce() -> FieldError) {
        self.total += 1;
        if self.first.len() < MAX_ERRORS {
            self.first.push(make());
        }
    }

    /// As [`Self::add`], for byte `offset` of an expression or a section curve.
    pub fn add_in_text(&mut self, at: &Pointer, offset: usize, code: FieldCode, detail: impl Into<String>) {
        self.add_made(|| FieldError::in_text(at, offset, code, detail));
    }

    /// Checks that a number of the given unit is in `range`.
    pub fn number(&mut self, at: &Pointer, value: f64, range: Range, unit: &str) {
        if is_too_large(value, range) || !range.holds(value) {
            self.add_made(|| {
                let (code, detail) = fault_of_number(value, range, unit);
                FieldError::new(at, code, detail)
            });
        }
    }

    /// As [`Self::number`], for a number that may be absent.
    pub fn optional(&mut self, at: &Pointer, value: Option<f64>, range: Range, unit: &str) {
        if let Some(value) = value {
            self.number(at, value, range, unit);
        }
    }

    /// Checks that a whole number is in a range.
    pub fn integer(&mut self, at: &Pointer, value: u32, (min, max): (u32, u32)) {
        if !(min..=max).contains(&value) {
            self.add(at, FieldCode::OutOfRange, words::outside(value, min, max));
        }
    }

    /// Checks the number of points. `false` means that there are too many points to check each of them.
    pub fn count_of_points(&mut self, at: &Pointer, count: usize, least: usize, most: usize) -> bool {
        if count > most {
            self.add(at, FieldCode::LimitExceeded, format!("there are {count} points; send at most {most}"));
        } else if count < least {
            let detail = format!("there are {count} points; send at least {least}");
            self.add(at, FieldCode::TooFewPoints, detail);
        }
        count <= most
    }

    /// Checks the length of a text.
    pub fn text(&mut self, at: &Pointer, value: &str, max_characters: usize) {
        let characters = value.chars().count();
        if characters > max_characters {
            self.add(at, FieldCode::TooLong, words::too_long(characters, max_characters));
        }
    }

    /// The number of violations.
    pub fn total(&self) -> usize {
        self.total
    }

    /// The error of a body with at least one violation.
    pub fn into_error(self) -> ApiError {
        ApiError::invalid_among(self.total, self.first)
    }

    /// `Ok` where there is no violation.
    ///
    /// # Errors
    /// The error with all violations.
    pub fn result(self) -> Result<(), ApiError> {
        if self.total == 0 { Ok(()) } else { Err(self.into_error()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn many_violations_are_counted_but_not_all_listed() {
        let mut violations = Violations::default();
        for k in 0..5000 {
            violations.number(&Pointer::root().index(k), -1.0, Range::POSITIVE, "mm");
        }
        let error = violations.result().expect_err("violations");
        assert_eq!(error.errors().len(), MAX_ERRORS);
        assert_eq!(error.detail(), "5000 violations; the first at #/0");
    }
}
