//! NC text as every control of this family reads it: tokens, numbers, G and M codes, modal state.
//!
//! # Method
//! 1. [`Lexer`] cuts a line into words, comments and tape marks. Each token has its place in the line, so
//!    that a caller can copy unchanged text byte for byte.
//! 2. [`Decimal`] holds the number of a word exactly.
//! 3. [`effect`] says what a G word does, [`function`] what an M word does.
//! 4. [`Modal`] is the state that words leave for the next block.
//!
//! Nothing here decides what to do about unknown text. [`read`](super::read) refuses unknown text, and
//! [`rewrite`](super::rewrite) copies unknown text. The writer uses none of this module: `read` checks the
//! writer.

mod codes;
mod decimal;
mod fault;
mod lexer;
mod modal;

pub use codes::{Codes, Effect, Function, Place, effect, function, modal_group};
pub use decimal::{Decimal, SCALES, is_coordinate};
pub use fault::Fault;
pub use lexer::{Lexer, Token};
pub use modal::{Distance, FeedMode, Modal, Motion};
