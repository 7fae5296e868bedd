//! How long the steps of an answer took.

use std::time::Duration;

/// Travels in the extensions of the response, from where it is measured to where it is told.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Timing {
    /// Waiting for a place on the pool.
    pub queue: Duration,
    /// Decoding the body and converting it to a job; not its arrival.
    pub parse: Duration,
    pub compute: Duration,
    /// Representing the outcome.
    pub encode: Duration,
}

impl Timing {
    /// The steps by name, in their order.
    pub fn steps(&self) -> [(&'static str, Duration); 4] {
        let Self { queue, parse, compute, encode } = *self;
        [("queue", queue), ("parse", parse), ("compute", compute), ("encode", encode)]
    }
}
