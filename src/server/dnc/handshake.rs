//! Sends a tape to a control that holds up the sender by XOFF and XON, by its wires, or not at all.
//!
//! # Cancel
//! A control runs a block at its line end. So the block that is under way goes out whole, then the end mark
//! `%` on a line of its own, which ends the reading of the control. XOFF holds as before. If the control does
//! not let the block go out within [`CANCEL_PATIENCE`], the block stays a half without a line end.

use std::time::Duration;

use super::format::Format;
use super::in_flight::InFlight;
use super::sender::{Failure, Left, Outcome, Progress, Sender, Step};
use super::settings::{Flow, Settings};
use super::tape::{LineCounter, Tape, XOFF, XON};

/// How long a cancelled sending waits for the control to take the rest of its block and the end mark. A
/// shutdown of the service waits 28 s in all.
pub const CANCEL_PATIENCE: Duration = Duration::from_secs(20);

/// Sends a [`Tape`].
#[derive(Debug, Clone)]
pub struct Handshake {
    tape: Tape,
    /// Number of characters of the tape that were given to the system.
    at: usize,
    /// The end of what is to be sent of the tape.
    end: usize,
    /// Number of characters of the end mark that were given to the system.
    mark_at: usize,
    in_flight: InFlight,
    format: Format,
    flow: Flow,
    patience: Duration,
    /// Since when XOFF, or waiting for the first XON, stands.
    held_since: Option<Duration>,
    /// The last time at which the system or the control let the sending go on.
    went_on: Duration,
    cancelled: Option<Duration>,
    failure: Option<Failure>,
    lines: LineCounter,
    n_pauses: usize,
    waited: Duration,
    n_received: usize,
}

impl Handshake {
    /// `is_paced` tells whether the speed of the line is known.
    pub fn new(tape: Tape, settings: &Settings, is_paced: bool) -> Self {
        let end = tape.bytes().len();
        Self {
            tape,
            at: 0,
            end,
            mark_at: 0,
            in_flight: InFlight::new(is_paced.then(|| settings.characters_per_s())),
            format: settings.format(),
            flow: settings.flow,
            patience: settings.patience,
            held_since: settings.waits_for_xon.then_some(Duration::ZERO),
            went_on: Duration::ZERO,
            cancelled: None,
            failure: None,
            lines: LineCounter::default(),
            n_pauses: 0,
            waited: Duration::ZERO,
            n_received: 0,
        }
    }

    /// The end mark of a cancelled sending that has sent blocks.
    fn mark(&self) -> &'static [u8] {
        let is_wanted = self.cancelled.is_some()
            && !self.tape.is_after_program(self.end)
            && !self.tape.is_before_program(self.end);
        if is_wanted { self.tape.end_mark() } else { b"" }
    }

    /// The characters that are still to be sent.
    fn rest(&self) -> &[u8] {
        if self.at < self.end { &self.tape.bytes()[self.at..self.end] } else { &self.mark()[self.mark_at..] }
    }

    fn go_on(&mut self, now: Duration) {
        self.went_on = now;
        if let Some(since) = self.held_since.take() {
            self.waited += now.saturating_sub(since);
        }
    }

    /// The time at which the patience with the control ends.
    fn limit(&self) -> Duration {
        let limit = self.went_on + self.patience;
        self.cancelled.map_or(limit, |cancelled| limit.min(cancelled + CANCEL_PATIENCE))
    }

    /// Number of characters of the tape that the line has taken for certain.
    fn taken(&self, now: Duration, queued: usize) -> usize {
        (self.at + self.mark_at).saturating_sub(self.in_flight.characters(now, queued)).min(self.at)
    }

    /// `taken` is the number of characters that the line has taken for certain.
    fn left(&mut self, taken: usize) -> Left {
        let line = self.lines.whole_lines(&self.tape, taken);
        if self.tape.is_before_program(self.at) {
            return Left::Nothing;
        }
        if taken < self.at || !self.tape.is_block_start(self.at) {
            return Left::HalfBlock { line: line + 1 };
        }
        if self.tape.is_after_program(self.at) {
            return Left::Whole;
        }
        let mark = self.tape.end_mark();
        Left::Blocks { line, has_end_mark: !mark.is_empty() && self.mark_at == mark.len() }
    }
}

impl Sender for Handshake {
    fn receive(&mut self, bytes: &[u8], now: Duration) {
        self.n_received += bytes.len();
        if self.flow != Flow::XonXoff {
            return;
        }
        for byte in bytes {
            match self.format.data(*byte) {
                XOFF if self.held_since.is_none() => {
                    self.held_since = Some(now);
                    self.n_pauses += 1;
                    self.went_on = now;
                }
                XON => self.go_on(now),
                _ => {}
            }
        }
    }

    fn next(&mut self, now: Duration, queued: usize) -> Step<'_> {
        let in_flight = self.in_flight.characters(now, queued);
        if self.failure.is_some() || self.rest().is_empty() && in_flight == 0 {
            return Step::Ended;
        }
        if now >= self.limit() {
            let failure = match self.cancelled {
                Some(_) => Failure::Cancelled,
                None => Failure::Silent(self.patience),
            };
            self.give_up(failure, now);
            return Step::Ended;
        }
        if self.rest().is_empty() {
            return Step::Wait(self.in_flight.time_of_room(now, queued).min(self.limit()));
        }
        if self.held_since.is_some() {
            return Step::Wait(self.limit());
        }
        match self.in_flight.room(now, queued) {
            0 => Step::Wait(self.in_flight.time_of_room(now, queued).min(self.limit())),
            room => {
                let rest = self.rest();
                Step::Write(&rest[..room.min(rest.len())])
            }
        }
    }

    fn wrote(&mut self, count: usize, now: Duration) {
        if count == 0 {
            return;
        }
        self.in_flight.wrote(count, now);
        self.went_on = now;
        if self.at < self.end {
            self.at += count;
        } else {
            self.mark_at += count;
        }
    }

    fn cancel(&mut self, now: Duration) {
        if self.cancelled.is_none() && !self.tape.is_after_program(self.at) {
            self.cancelled = Some(now);
            self.end = self.tape.block_end(self.at);
        }
    }

    fn give_up(&mut self, failure: Failure, now: Duration) {
        self.go_on(now);
        self.failure.get_or_insert(failure);
    }

    fn is_held(&self, _: Duration) -> bool {
        self.held_since.is_some()
    }

    fn progress(&mut self, now: Duration, queued: usize) -> Progress {
        let taken = self.taken(now, queued);
        Progress {
            n_characters: taken,
            n_characters_total: self.tape.bytes().len(),
            n_lines: self.lines.whole_lines(&self.tape, taken),
            n_lines_total: self.tape.n_lines(),
            is_waiting: self.is_held(now),
            is_paused: false,
        }
    }

    fn outcome(&mut self, now: Duration, queued: usize) -> Outcome {
        let progress = self.progress(now, queued);
        let failure = self.failure.clone().or(self.cancelled.map(|_| Failure::Cancelled));
        Outcome {
            progress,
            n_pauses: self.n_pauses,
            waited: self.waited,
            n_received: self.n_received,
            failure,
            left: self.left(progress.n_characters),
            delivery: None,
        }
    }
}

#[cfg(test)]
mod tests;
