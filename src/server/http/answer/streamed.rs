//! The mark of an answer that is made while it is sent.

/// Marks the answer to an NC program that is rewritten while it arrives. It stands in the extensions of the
/// answer.
#[derive(Debug, Clone, Copy)]
pub struct Streamed;
