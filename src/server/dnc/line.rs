//! A line to a control: characters go in and out without blocking.

use std::io;
use std::os::fd::AsFd;
use std::time::Duration;

use rustix::event::{PollFd, PollFlags, Timespec, poll};

use super::sender::Delivery;

/// A serial port or a connection.
pub trait Line {
    /// Reads what the control has sent. 0 if there is nothing.
    ///
    /// # Errors
    /// When the line is gone.
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize>;

    /// Gives characters to the system and returns how many it has taken. 0 if it has no room.
    ///
    /// # Errors
    /// When the line is gone.
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize>;

    /// Number of characters in the output queue of the system. 0 where the system does not tell.
    ///
    /// # Errors
    /// When the line is gone.
    fn queued(&self) -> io::Result<usize>;

    /// Waits until there is something to read, or room to write if `for_room`, or `time` is over.
    ///
    /// # Errors
    /// When the system cannot wait.
    fn wait(&self, for_room: bool, time: Duration) -> io::Result<()>;

    /// Throws away the output queue of the system, so that nothing goes out after the report of a failure.
    ///
    /// # Errors
    /// When the line is gone.
    fn discard(&mut self) -> io::Result<()>;

    /// Ends the sending, after everything was written, and tells what is known of its arrival.
    ///
    /// # Errors
    /// When the line was lost before its end.
    fn finish(&mut self) -> io::Result<Delivery>;
}

/// Takes the outcome of a read or write that does not block.
pub(super) fn without_blocking(outcome: io::Result<usize>) -> io::Result<usize> {
    match outcome {
        Err(error) if [io::ErrorKind::WouldBlock, io::ErrorKind::Interrupted].contains(&error.kind()) => {
            Ok(0)
        }
        outcome => outcome,
    }
}

/// As [`without_blocking`], for a read: its end is an error, because a control does not end a line.
pub(super) fn more(outcome: io::Result<usize>) -> io::Result<usize> {
    match outcome {
        Ok(0) => Err(io::Error::new(io::ErrorKind::UnexpectedEof, "closed by the other side")),
        outcome => without_blocking(outcome),
    }
}

/// Waits for `file` as [`Line::wait`] does.
pub(super) fn wait_for(file: &impl AsFd, for_room: bool, time: Duration) -> io::Result<()> {
    let room = if for_room { PollFlags::OUT } else { PollFlags::empty() };
    let mut files = [PollFd::new(file, PollFlags::IN | room)];
    let time = Timespec::try_from(time).unwrap_or(Timespec { tv_sec: 1, tv_nsec: 0 });
    match poll(&mut files, Some(&time)) {
        Ok(_) | Err(rustix::io::Errno::INTR) => Ok(()),
        Err(error) => Err(error.into()),
    }
}
