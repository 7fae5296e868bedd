//! Sends a program to GRBL, line by line, and counts the characters in its receive buffer.
//!
//! GRBL 1.1 knows no XON and XOFF. It answers each line by `ok` or `error:N` when it takes the line out of
//! its receive buffer of 128 characters. So the lines that are not answered yet are the content of the
//! buffer.
//!
//! # Method
//! 1. Ask for the status (`?`) until GRBL answers. A board that restarts when its port is opened greets
//!    first.
//! 2. Send the next line if it fits beside the lines that are not answered. A line that writes to the EEPROM
//!    travels alone, because GRBL loses characters while it writes.
//! 3. Where GRBL answers no line for a second, ask for the status. While GRBL moves, dwells, or waits for
//!    its operator (M0, feed hold, open door), wait as long as that lasts.
//! 4. On `error:N`, `ALARM:N`, silence or cancel: stop sending, hold the feed (`!`), ask for the status until
//!    the machine is at rest, then reset (0x18). The reset empties the buffers, so no line after a faulty one
//!    is run, and no half line.
//!
//! Every other character of an answer is data, XON and XOFF too.
//!
//! # Reference
//! The wiki of GRBL 1.1, page *Grbl v1.1 Interface*, sections *Streaming Protocol: Character-Counting*,
//! *EEPROM Issues* and *Real-time Commands*.

mod program;
mod status;

use std::collections::VecDeque;
use std::time::Duration;

use super::in_flight::InFlight;
use super::sender::{Delivery, Failure, Left, Outcome, Progress, Sender, Step};
use super::settings::Settings;
pub use program::{Program, program};
use status::State;

/// Characters of the receive buffer of GRBL. The lines in it are kept below this.
pub const BUFFER: usize = 128;

const STATUS: u8 = b'?';
const HOLD: u8 = b'!';
const RESET: u8 = 0x18;

/// How long a board may take to start, and how often it is asked meanwhile.
const GREETING_LIMIT: Duration = Duration::from_secs(10);
const GREETING_INTERVAL: Duration = Duration::from_secs(1);

/// How long the machine may take to come to rest, and how often it is asked meanwhile. A machine that does
/// not tell is reset all the same: that stops it at once.
const REST_LIMIT: Duration = Duration::from_secs(10);
const REST_INTERVAL: Duration = Duration::from_millis(200);

/// How long GRBL may take to greet after a reset.
const RESET_LIMIT: Duration = Duration::from_secs(2);

/// A silence that is told as waiting, and after which GRBL is asked for its status. Shorter ones are common.
const WAITING: Duration = Duration::from_secs(1);

/// How often a machine that answers no line is asked for its status.
const STATUS_INTERVAL: Duration = Duration::from_secs(1);

/// Most characters of an answer that are kept.
const MOST_ANSWER: usize = 256;

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Phase {
    Greeting,
    Sending,
    Holding,
    Resetting,
    Ended,
}

/// A line that GRBL has not answered.
#[derive(Debug, Clone, Copy)]
struct Pending {
    length: usize,
    line: usize,
    is_alone: bool,
    dwells: bool,
}

/// Sends a [`Program`].
#[derive(Debug)]
pub struct Grbl {
    program: Program,
    /// Number of blocks that were begun, and of characters of the program that were given to the system.
    n_begun: usize,
    at: usize,
    pending: VecDeque<Pending>,
    /// Sum of the lengths of `pending`.
    in_buffer: usize,
    /// The last line of the program that GRBL has answered.
    answered: usize,
    phase: Phase,
    /// When the phase began, and when the status is asked for next.
    since: Duration,
    ask_at: Duration,
    /// A command that goes out before any other character.
    command: Option<u8>,
    answer: Vec<u8>,
    /// When GRBL answered a line last, and when it last showed that it will answer the next one.
    went_on: Duration,
    alive_at: Duration,
    /// The last status since then.
    state: Option<State>,
    patience: Duration,
    in_flight: InFlight,
    failure: Option<Failure>,
    left: Left,
    n_received: usize,
}

impl Grbl {
    /// `is_paced` tells whether the speed of the line is known.
    pub fn new(program: Program, settings: &Settings, is_paced: bool) -> Self {
        Self {
            program,
            n_begun: 0,
            at: 0,
            pending: VecDeque::new(),
            in_buffer: 0,
            answered: 0,
            phase: Phase::Greeting,
            since: Duration::ZERO,
            ask_at: Duration::ZERO,
            command: None,
            answer: Vec::new(),
            went_on: Duration::ZERO,
            alive_at: Duration::ZERO,
            state: None,
            patience: settings.patience,
            in_flight: InFlight::new(is_paced.then(|| settings.characters_per_s())),
            failure: None,
            left: Left::Nothing,
            n_received: 0,
        }
    }

    fn enter(&mut self, phase: Phase, command: Option<u8>, now: Duration) {
        (self.phase, self.command, self.since) = (phase, command, now);
        self.go_on(now);
    }

    /// Notes that GRBL goes on.
    fn go_on(&mut self, now: Duration) {
        (self.went_on, self.alive_at, self.state) = (now, now, None);
    }

    /// Stops the machine because of `failure`.
    fn hold(&mut self, failure: Failure, now: Duration) {
        self.failure.get_or_insert(failure);
        self.ask_at = now + REST_INTERVAL;
        self.enter(Phase::Holding, Some(HOLD), now);
    }

    fn end(&mut self, left: Left, now: Duration) {
        self.left = left;
        self.enter(Phase::Ended, None, now);
    }

    /// Takes an answer without its line end.
    fn answered(&mut self, answer: &str, now: Duration) {
        let is_greeting = answer.starts_with("Grbl");
        match self.phase {
            Phase::Greeting if is_greeting || answer.starts_with('<') => {
                self.enter(Phase::Sending, None, now);
            }
            Phase::Sending if is_greeting => {
                self.failure = Some(Failure::Restarted);
                self.end(Left::Restarted, now);
            }
            Phase::Sending | Phase::Holding if answer == "ok" => self.pop(now),
            Phase::Sending if answer.starts_with("error:") => {
                let line = self.pending.front().map_or(self.answered, |pending| pending.line);
                self.pop(now);
                self.hold(Failure::Refused { line, answer: answer.to_owned() }, now);
            }
            Phase::Sending if answer.starts_with("ALARM:") => {
                let failure = Failure::Alarm { after_line: self.answered, answer: answer.to_owned() };
                self.hold(failure, now);
            }
            // A status that was asked for before the first line may come late.
            Phase::Sending if self.is_held(now) => {
                if let Some(state) = State::read(answer) {
                    self.judge(state, now);
                }
            }
            Phase::Holding if status::is_at_rest(answer) => self.enter(Phase::Resetting, Some(RESET), now),
            Phase::Resetting if is_greeting && self.command.is_none() => {
                self.end(Left::Reset { is_confirmed: true }, now);
            }
            _ => {}
        }
    }

    /// Takes a status of a machine that answers no line.
    fn judge(&mut self, state: State, now: Duration) {
        let dwells = self.pending.front().is_some_and(|pending| pending.dwells);
        match state {
            State::Alarm => {
                let answer = state.name().to_owned();
                self.hold(Failure::Alarm { after_line: self.answered, answer }, now);
                return;
            }
            State::Moving | State::Paused | State::Other => self.alive_at = now,
            State::Idle if dwells => self.alive_at = now,
            State::Idle | State::Sleep => {}
        }
        self.state = Some(state);
    }

    /// Why a sending to a machine ends that shows no sign of going on.
    fn stuck(&self) -> Failure {
        let line = self.pending.front().map_or(self.answered, |pending| pending.line);
        match self.state {
            Some(state @ (State::Idle | State::Sleep)) => {
                Failure::Stuck { line, state: state.name(), time: self.patience }
            }
            _ => Failure::NoStatus(self.patience),
        }
    }

    /// Takes the oldest line out of the buffer.
    fn pop(&mut self, now: Duration) {
        if let Some(pending) = self.pending.pop_front() {
            self.in_buffer -= pending.length;
            self.answered = pending.line;
            self.go_on(now);
        }
    }

    /// Begins the next line if there is one and GRBL has room for it.
    fn begin_line(&mut self) {
        let Some(block) = self.program.blocks().get(self.n_begun) else { return };
        let length = block.end - self.at;
        let program::Block { is_alone, dwells, .. } = *block;
        let is_apart =
            self.pending.is_empty() || !is_alone && self.pending.back().is_some_and(|last| !last.is_alone);
        if is_apart && self.in_buffer + length < BUFFER {
            self.pending.push_back(Pending { length, line: block.line, is_alone, dwells });
            self.in_buffer += length;
            self.n_begun += 1;
        }
    }

    /// The end of the line that was begun last.
    fn begun_end(&self) -> usize {
        self.n_begun.checked_sub(1).map_or(0, |last| self.program.blocks()[last].end)
    }

    /// Moves to the next phase where it is time, and chooses a command.
    fn tick(&mut self, now: Duration) {
        let lasted = now.saturating_sub(self.since);
        let asks = |interval: Duration| now + interval;
        match self.phase {
            Phase::Greeting if lasted >= GREETING_LIMIT.min(self.patience) => {
                self.failure = Some(Failure::NoGrbl);
                self.end(Left::Nothing, now);
            }
            Phase::Sending if self.pending.is_empty() && self.n_begun == self.program.blocks().len() => {
                self.answered = self.program.n_lines();
                self.end(Left::Whole, now);
            }
            Phase::Sending if !self.pending.is_empty() && now >= self.alive_at + self.patience => {
                self.hold(self.stuck(), now);
            }
            Phase::Sending if self.is_held(now) && now >= self.ask_at && self.command.is_none() => {
                (self.command, self.ask_at) = (Some(STATUS), asks(STATUS_INTERVAL));
            }
            Phase::Holding if lasted >= REST_LIMIT => self.enter(Phase::Resetting, Some(RESET), now),
            Phase::Resetting if lasted >= RESET_LIMIT => {
                self.end(Left::Reset { is_confirmed: false }, now);
            }
            Phase::Greeting if now >= self.ask_at => {
                (self.command, self.ask_at) = (Some(STATUS), asks(GREETING_INTERVAL));
            }
            Phase::Holding if now >= self.ask_at && self.command.is_none() => {
                (self.command, self.ask_at) = (Some(STATUS), asks(REST_INTERVAL));
            }
            _ => {}
        }
    }

    /// The time at which [`Self::tick`] has something to do if GRBL says nothing.
    fn next_tick(&self) -> Duration {
        match self.phase {
            Phase::Greeting => self.ask_at.min(self.since + GREETING_LIMIT.min(self.patience)),
            Phase::Sending | Phase::Ended => {
                self.ask_at.max(self.went_on + WAITING).min(self.alive_at + self.patience)
            }
            Phase::Holding => self.ask_at.min(self.since + REST_LIMIT),
            Phase::Resetting => self.since + RESET_LIMIT,
        }
    }
}

impl Sender for Grbl {
    fn receive(&mut self, bytes: &[u8], now: Duration) {
        self.n_received += bytes.len();
        for byte in bytes {
            if *byte == b'\n' {
                let answer = String::from_utf8_lossy(&std::mem::take(&mut self.answer)).into_owned();
                self.answered(answer.trim_end_matches('\r'), now);
            } else if self.answer.len() < MOST_ANSWER {
                self.answer.push(*byte);
            }
        }
    }

    fn next(&mut self, now: Duration, queued: usize) -> Step<'_> {
        self.tick(now);
        if self.phase == Phase::Ended {
            return Step::Ended;
        }
        // A command may wait behind a few characters on the line, but behind no line of the program.
        let room = self.in_flight.room(now, queued);
        let time_of_room = self.in_flight.time_of_room(now, queued).min(self.next_tick());
        if self.command.is_some() {
            return if room > 0 { Step::Write(self.command.as_slice()) } else { Step::Wait(time_of_room) };
        }
        if self.phase == Phase::Sending && self.at == self.begun_end() {
            self.begin_line();
        }
        if self.phase != Phase::Sending || self.at == self.begun_end() {
            return Step::Wait(self.next_tick());
        }
        if room == 0 {
            return Step::Wait(time_of_room);
        }
        let rest = &self.program.text()[self.at..self.begun_end()];
        Step::Write(&rest[..room.min(rest.len())])
    }

    fn wrote(&mut self, count: usize, now: Duration) {
        if count == 0 {
            return;
        }
        self.in_flight.wrote(count, now);
        if self.command.take().is_none() {
            self.at += count;
        }
    }

    fn cancel(&mut self, now: Duration) {
        match self.phase {
            Phase::Greeting => {
                self.failure = Some(Failure::Cancelled);
                self.end(Left::Nothing, now);
            }
            Phase::Sending => self.hold(Failure::Cancelled, now),
            Phase::Holding | Phase::Resetting | Phase::Ended => {}
        }
    }

    fn give_up(&mut self, failure: Failure, now: Duration) {
        self.failure.get_or_insert(failure);
        let left = match self.phase {
            Phase::Ended => return,
            _ if self.at == 0 => Left::Nothing,
            Phase::Resetting => Left::Reset { is_confirmed: false },
            _ => Left::HalfBlock { line: self.answered + 1 },
        };
        self.end(left, now);
    }

    fn is_held(&self, now: Duration) -> bool {
        !self.pending.is_empty() && now >= self.went_on + WAITING
    }

    fn is_paused(&self) -> bool {
        self.state == Some(State::Paused)
    }

    fn progress(&mut self, now: Duration, queued: usize) -> Progress {
        Progress {
            n_characters: self.at.saturating_sub(self.in_flight.characters(now, queued)),
            n_characters_total: self.program.text().len(),
            n_lines: self.answered,
            n_lines_total: self.program.n_lines(),
            is_waiting: self.is_held(now),
            is_paused: self.is_paused(),
        }
    }

    fn outcome(&mut self, now: Duration, queued: usize) -> Outcome {
        Outcome {
            progress: self.progress(now, queued),
            n_pauses: 0,
            waited: Duration::ZERO,
            n_received: self.n_received,
            failure: self.failure.clone(),
            left: self.left,
            delivery: self.failure.is_none().then_some(Delivery::Answered),
        }
    }
}

#[cfg(test)]
mod tests;
