//! How long each step of an answer took, for the header `Server-Timing`, the log and the metrics.

use std::time::Duration;

use axum::http::{HeaderName, HeaderValue};

pub const SERVER_TIMING: HeaderName = HeaderName::from_static("server-timing");

/// Times of the steps. They travel in the extensions of the response to the log and the metrics.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// Time of waiting for a worker.
    pub queue: Duration,
    /// Time of decoding the body and converting it to a job, without the arrival of the body.
    pub parse: Duration,
    pub compute: Duration,
    /// Time of encoding the answer.
    pub encode: Duration,
}

impl Timing {
    /// The steps by name, in their order.
    pub fn steps(&self) -> [(&'static str, Duration); 4] {
        let Self { queue, parse, compute, encode } = *self;
        [("queue", queue), ("parse", parse), ("compute", compute), ("encode", encode)]
    }

    /// The value of the header, with times in milliseconds.
    pub fn header_value(&self) -> HeaderValue {
        let text =
            self.steps().map(|(name, time)| format!("{name};dur={:.3}", time.as_secs_f64() * 1e3)).join(", ");
        HeaderValue::from_str(&text).unwrap_or(HeaderValue::from_static(""))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_milliseconds() {
        let of = Duration::from_micros;
        let timing = Timing { queue: of(0), parse: of(1), compute: of(2_500_000), encode: of(1500) };
        assert_eq!(
            timing.header_value(),
            "queue;dur=0.000, parse;dur=0.001, compute;dur=2500.000, encode;dur=1.500"
        );
    }
}
