//! Reads the files in which shops keep parts: drawings, points and solids.
//!
//! # Guarantees
//! * Nothing is dropped: an entity is read, or it is listed with the reason why it was left out, or the file
//!   is refused with the place in it.
//! * A length has the unit that the file states. A file without a unit says so.
//! * Every loop ends, by a limit or by the size of the file; a budget ends every reader.

pub mod drawing;
pub mod dxf;
pub mod fault;
pub mod format;
pub mod left_out;
pub mod points;
pub mod step;
pub mod unit;
