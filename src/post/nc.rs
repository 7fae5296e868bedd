//! NC text as Fanuc, LinuxCNC and similar controls read it: tokens, numbers, G and M codes, modal state.
//!
//! # Method
//! 1. [`Lexer`] divides a line into words, comments and percent signs. Each token has its place in the line,
//!    so that callers can copy text byte for byte.
//! 2. [`Decimal`] holds the number of a word exactly.
//! 3. [`effect`] says what a G word does, [`function`] what an M word does.
//! 4. [`Modal`] holds the modal state.
//!
//! This module does not decide what happens to unknown text: [`read`](super::read) refuses it, and
//! [`rewrite`](super::rewrite) copies it. The writer of programs does not use this module, so `read` checks
//! the writer independently.

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
