//! Finds the errors of a request body, so that the caller can correct all of them at once.
//!
//! # Method
//! A decoder stops at its first error. To find further errors, a copy of the body is repaired and decoded
//! again:
//! 1. The value at which the decoder stopped is replaced by a placeholder, such as 1000 or "x". A member that
//!    the request must not have is removed instead.
//! 2. The copy is decoded. If the decoder stops again, step 1 is repeated. If it stops at the same value,
//!    step 1 takes the next placeholder.
//! 3. When the decoder reaches the end, the values of the copy are checked. Errors that a placeholder causes
//!    are not reported.
//!
//! A whole number with a decimal point, such as `12.0`, is accepted where an integer is needed.
//!
//! # Cost
//! The repair ends when no placeholder is left to try, after [`MOST_TRIES`] decodings, or after
//! [`MOST_BYTES`] decoded bytes. Then the errors found so far are reported.

use serde_json::{Value, json};

use super::{IntoJob, decode_at};
use crate::config::Limits;
use crate::http::error::{ApiError, FieldCode, FieldError, MAX_ERRORS};

/// Most bytes that are decoded again, over all repetitions. A large body is therefore reported with fewer
/// violations.
const MOST_BYTES: usize = 4 << 20;

/// Most decodings of one body, however small the body is.
const MOST_TRIES: usize = 400;

/// Whole numbers from here on may not be exact in floating point (2^53 is about 9.007e15).
const LARGEST_WHOLE: f64 = 9e15;

/// The job of a body that did not decode. `first` is the error of the first decoding. There is a job only
/// where every error was a whole number with a decimal point.
///
/// # Errors
/// `invalid_request` with all violations that were found.
pub fn job<T: IntoJob>(text: &str, first: FieldError, limits: &Limits) -> Result<T::Job, ApiError> {
    let Ok(body) = serde_json::from_str::<Value>(text) else { return Err(ApiError::invalid(vec![first])) };
    let mut mending =
        Mending { body, found: Vec::new(), mended: Vec::new(), renamed: Vec::new(), tried: None };
    let tries = (MOST_BYTES / text.len().max(1)).clamp(1, MOST_TRIES);
    let mut error = first;
    for _ in 0..tries {
        if !mending.mend(&error) {
            break;
        }
        let text = mending.body.to_string();
        match decode_at::<T>(&text) {
            Err(next) => error = next,
            Ok(request) => match request.into_job(limits) {
                Ok(job) if mending.found.is_empty() => return Ok(job),
                Ok(_) => break,
                Err(rules) if mending.found.is_empty() && mending.mended.is_empty() => return Err(rules),
                Err(rules) => {
                    rules.errors().iter().for_each(|error| mending.note(error));
                    break;
                }
            },
        }
    }
    let Mending { mut found, .. } = mending;
    if found.is_empty() {
        found.push(error);
    }
    let total = found.len();
    found.truncate(MAX_ERRORS);
    Err(ApiError::invalid_among(total, found))
}

/// A body under repair.
struct Mending {
    body: Value,
    found: Vec<FieldError>,
    /// Pointers to the members that have stand-ins.
    mended: Vec<String>,
    /// Pointers to objects in which a name, such as `kind`, has a stand-in. The name decides which other
    /// members the object has, so missing and unknown members of the object are not reported.
    renamed: Vec<String>,
    /// The pointer that got the last stand-in, and how many earlier stand-ins it had.
    tried: Option<(String, usize)>,
}

impl Mending {
    /// Remembers a violation, unless a stand-in causes it.
    fn note(&mut self, error: &FieldError) {
        let is_within = |place: &String| {
            let rest = error.pointer.strip_prefix(place.as_str());
            rest.is_some_and(|rest| rest.is_empty() || rest.starts_with('/'))
        };
        let is_of_name =
            !matches!(error.code, FieldCode::WrongType | FieldCode::WrongLength | FieldCode::UnknownValue);
        let is_of_stand_in =
            self.mended.iter().any(is_within) || is_of_name && self.renamed.iter().any(is_within);
        if !is_of_stand_in && !self.found.contains(error) {
            self.found.push(error.clone());
        }
    }

    /// Puts a stand-in where the decoder stopped, or removes an unknown member. `false` where no stand-in is
    /// left.
    fn mend(&mut self, error: &FieldError) -> bool {
        let Some(place) = path(&error.pointer) else { return false };
        if let Some(number) = self.body.pointer_mut(&place)
            && let Some(whole) = whole(number)
        {
            *number = whole;
            return true;
        }
        self.note(error);
        let tried = match &self.tried {
            Some((last, count)) if *last == error.pointer => count + 1,
            _ => 0,
        };
        self.tried = Some((error.pointer.clone(), tried));
        let Some((parent, name)) = place.rsplit_once('/') else { return false };
        if matches!(error.code, FieldCode::UnknownField | FieldCode::Unsupported) {
            let parent = self.body.pointer_mut(parent).and_then(Value::as_object_mut);
            return parent.is_some_and(|parent| parent.remove(&unescaped(name)).is_some());
        }
        let Some(stand_in) = self.stand_in(error, &place, tried) else { return false };
        if tried == 0 {
            self.mended.push(error.pointer.clone());
            if error.code == FieldCode::UnknownValue || name == "kind" {
                let parent = error.pointer.rsplit_once('/').map_or("#", |(parent, _)| parent);
                self.renamed.push(parent.to_owned());
            }
        }
        match self.body.pointer_mut(parent) {
            Some(Value::Object(members)) => {
                members.insert(unescaped(name), stand_in);
                true
            }
            Some(Value::Array(items)) => {
                let item = name.parse::<usize>().ok().and_then(|index| items.get_mut(index));
                item.map(|item| *item = stand_in).is_some()
            }
            _ => false,
        }
    }

    /// The stand-in to try at a place after `tried` earlier ones. `None` where all have been tried.
    fn stand_in(&self, error: &FieldError, place: &str, tried: usize) -> Option<Value> {
        let named = error.detail.rsplit_once("; use ").map_or("", |(_, names)| names);
        let names = named.split('`').skip(1).step_by(2).map(|name| json!(name));
        let lengths = match self.body.pointer(place) {
            Some(Value::Array(items)) => {
                let zero = items.first().cloned().unwrap_or(json!(0));
                (1..5)
                    .map(|n| Value::Array((0..n).map(|k| items.get(k).unwrap_or(&zero).clone()).collect()))
                    .collect()
            }
            _ => Vec::new(),
        };
        // A large number is tried first, because it seldom breaks a rule together with other members.
        let plain = [json!(1000), json!(1), json!("x"), json!({}), json!([]), json!(true)];
        names.take(1).chain(lengths).chain(plain).nth(tried)
    }
}

/// The integer for a whole number that was written with a decimal point. `None` for other values.
fn whole(value: &Value) -> Option<Value> {
    let number = value.as_f64().filter(|_| value.is_f64())?;
    (number.fract() == 0.0 && number.abs() < LARGEST_WHOLE).then(|| json!(number as i64))
}

/// A pointer without its `#` and its percent encoding, as `Value::pointer` takes it.
fn path(pointer: &str) -> Option<String> {
    let text = pointer.strip_prefix('#')?;
    let decoded = percent_encoding::percent_decode_str(text).decode_utf8().ok()?;
    Some(decoded.into_owned())
}

fn unescaped(name: &str) -> String {
    name.replace("~1", "/").replace("~0", "~")
}
