//! How long the stages of a computed answer took.

use std::time::Duration;

/// Travels in the extensions of the response, from where it is measured to where it is told.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct StageTimes {
    /// Waiting for a worker.
    pub queue: Option<Duration>,
    /// From the first byte of the body to a job.
    pub parse: Option<Duration>,
    pub compute: Option<Duration>,
    /// From the outcome to bytes.
    pub encode: Option<Duration>,
}

impl StageTimes {
    /// The stages that took place, in their order.
    pub fn iter(&self) -> impl Iterator<Item = (&'static str, Duration)> {
        let Self { queue, parse, compute, encode } = *self;
        [("queue", queue), ("parse", parse), ("compute", compute), ("encode", encode)]
            .into_iter()
            .filter_map(|(stage, duration)| Some((stage, duration?)))
    }
}
