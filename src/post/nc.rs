//! NC text as Fanuc, LinuxCNC and similar controls read it: tokens, numbers, G and M codes, and the modal
//! state.
//!
//! [`Lexer`] divides a line into words, comments and percent signs, and gives the place of each in the line.
//! [`Decimal`] holds the number of a word exactly. [`effect`] says what a G word does, and [`function`] what
//! an M word does. [`Modal`] holds the modal state.
//!
//! Unknown text is left to the caller: [`read`](super::read) refuses it, and [`rewrite`](super::rewrite)
//! copies it. The writer of programs does not use this module. So `read`, which does use it, is an
//! independent check of the writer.

mod codes;
mod decimal;
mod fault;
mod lexer;
mod modal;

pub use codes::{Codes, Effect, Function, PositionEffect, effect, function, modal_group};
pub use decimal::{Decimal, SCALES, is_coordinate};
pub use fault::{Fault, WordFault};
pub use lexer::{Lexer, Token};
pub use modal::{Distance, FeedMode, Modal, Modifier, Motion};
