//! DNC: sends NC programs to machine controls over serial lines and TCP connections.
//!
//! # Method
//! 1. [`Tape`], or [`grbl::program`] for GRBL, checks the program and turns it into characters for the line.
//!    A program that the line cannot carry is refused before the first character is sent.
//! 2. A [`Sender`] decides what is written when. It does no input or output and reads no clock: the time and
//!    the characters of the control go in, the characters to write come out.
//! 3. [`run()`] connects a sender with a [`Line`]: a serial port or a TCP connection.
//!
//! # Guarantees
//! * On a line with a known speed, at most [`in_flight::MOST`] characters are on their way: given to the
//!   system and not yet taken by the line. A control that sends XOFF then receives at most these characters,
//!   and those sent while its XOFF is under way.
//! * A sending ends in a state that [`Left`] names. The sender appends nothing to half a block. Until the
//!   control is reset, a next program would continue that half.

pub mod estimate;
pub mod format;
pub mod grbl;
pub mod handshake;
pub mod in_flight;
pub mod line;
pub mod run;
pub mod sender;
pub mod serial;
pub mod settings;
pub mod tape;
pub mod target;
pub mod tcp;

pub use estimate::Estimate;
pub use format::Format;
pub use line::Line;
pub use run::{Stop, run};
pub use sender::{Delivery, Failure, Left, Outcome, Progress, Sender};
pub use settings::{Ends, Flow, Marks, Settings};
pub use tape::{Tape, TapeError};
pub use target::{Address, NamedTarget, SendError, Target, send, send_by};
