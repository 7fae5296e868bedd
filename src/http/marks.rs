//! Marks in the extensions of requests and answers, which layers read.

/// How a request came: over a connection with a place, or over one that is beyond the limit and is there for
/// health checks and metrics only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    Regular,
    Spare,
}

/// Marks an answer whose body is still being made while its head is sent.
#[derive(Debug, Clone, Copy)]
pub struct Streamed;

/// Marks an answer that may take any time: a program goes out to a control meanwhile.
#[derive(Debug, Clone, Copy)]
pub struct Endless;
