//! The caller's trace, which a request continues (W3C Trace Context, `traceparent`).

use std::fmt;
use std::hash::{BuildHasher, Hasher, RandomState};

use axum::http::{HeaderMap, HeaderName, HeaderValue};

pub const HEADER: HeaderName = HeaderName::from_static("traceparent");

/// The trace of the caller, with a span of this service below the caller's span.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Trace {
    id: String,
    span: u64,
    flags: u8,
}

impl Trace {
    /// Continues the caller's trace. `None` where the caller sent no `traceparent`, or one that is not legal.
    pub fn of(headers: &HeaderMap) -> Option<Self> {
        let mut lines = headers.get_all(HEADER).iter();
        let (only, None) = (lines.next()?, lines.next()) else { return None };
        let (id, flags) = parse(only.to_str().ok()?)?;
        // A span id of zero is not legal.
        let span = RandomState::new().build_hasher().finish().max(1);
        Some(Self { id: id.to_owned(), span, flags })
    }

    pub fn id(&self) -> &str {
        &self.id
    }

    pub fn header_value(&self) -> HeaderValue {
        HeaderValue::from_str(&self.to_string()).unwrap_or(HeaderValue::from_static(""))
    }
}

impl fmt::Display for Trace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "00-{}-{:016x}-{:02x}", self.id, self.span, self.flags)
    }
}

/// The id and the flags of a `traceparent`. Versions after 00 may append fields.
fn parse(text: &str) -> Option<(&str, u8)> {
    let mut fields = text.split('-');
    let version = hex(fields.next()?, 2)?;
    let id = hex(fields.next()?, 32)?;
    let parent = hex(fields.next()?, 16)?;
    let flags = hex(fields.next()?, 2)?;
    let is_known = version == "00" && fields.next().is_none() || version != "00" && version != "ff";
    let is_zero = |digits: &str| digits.bytes().all(|digit| digit == b'0');
    // The sampled flag is the only one that version 00 defines.
    let flags = u8::from_str_radix(flags, 16).ok()? & 1;
    (is_known && !is_zero(id) && !is_zero(parent)).then_some((id, flags))
}

fn hex(digits: &str, length: usize) -> Option<&str> {
    let is_hex = digits.bytes().all(|digit| matches!(digit, b'0'..=b'9' | b'a'..=b'f'));
    (digits.len() == length && is_hex).then_some(digits)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ID: &str = "4bf92f3577b34da6a3ce929d0e0e4736";
    const PARENT: &str = "00f067aa0ba902b7";

    fn of(lines: &[&str]) -> Option<Trace> {
        let mut headers = HeaderMap::new();
        for line in lines {
            headers.append(HEADER, line.parse().expect("a header"));
        }
        Trace::of(&headers)
    }

    #[test]
    fn a_trace_is_continued_under_a_span_of_our_own() {
        let sent = format!("00-{ID}-{PARENT}-01");
        let trace = of(&[&sent]).expect("a trace");
        let answered = trace.to_string();
        assert!(answered.starts_with(&format!("00-{ID}-")) && answered.ends_with("-01"), "{answered}");
        assert!(!answered.contains(PARENT));
        assert_eq!(parse(&answered), Some((ID, 1)));
        assert_eq!(parse(&format!("cc-{ID}-{PARENT}-03-more")), Some((ID, 1)));
    }

    #[test]
    fn an_illegal_traceparent_gives_no_trace() {
        let zeros = "0".repeat(32);
        for bad in [
            String::new(),
            "00".to_owned(),
            format!("00-{ID}-{PARENT}"),
            format!("00-{ID}-{PARENT}-01-more"),
            format!("ff-{ID}-{PARENT}-01"),
            format!("00-{zeros}-{PARENT}-01"),
            format!("00-{ID}-{}-01", &zeros[..16]),
            format!("00-{}-{PARENT}-01", ID.to_uppercase()),
            format!("00-{ID}x-{PARENT}-01"),
            format!("0-{ID}-{PARENT}-01"),
        ] {
            assert_eq!(of(&[&bad]), None, "{bad}");
        }
        let sent = format!("00-{ID}-{PARENT}-01");
        assert_eq!(of(&[&sent, &sent]), None);
    }
}
