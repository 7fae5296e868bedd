//! How long an answer may take where it may take longer than one computation. The mark stands in the
//! extensions of the answer; layers and the connection read it.

/// The time that an answer may take. An answer without this mark is one computation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AllowedTime {
    /// The answer to an NC program that is rewritten while it arrives.
    OfStream,
    /// Any time: the answer, as events, to a program that is being sent to a control.
    Any,
}
