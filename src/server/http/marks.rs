//! Marks in the extensions of requests and answers, which layers read.

/// How a request came: over a connection with a place, or over one that is beyond the limit and is there for
/// health checks and metrics only.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrival {
    Regular,
    Spare,
}

/// Marks the answer to an NC program that is rewritten while it arrives.
#[derive(Debug, Clone, Copy)]
pub struct Streamed;

/// Marks the answer, as events, to a program that is being sent to a control. It may take any time.
#[derive(Debug, Clone, Copy)]
pub struct Endless;
