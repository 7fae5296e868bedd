//! What every way of sending has in common: steps, progress, and how a sending ends.

use std::fmt;
use std::time::Duration;

use serde::Serialize;
use utoipa::ToSchema;

/// What to do next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step<'a> {
    /// Write some of these characters, and tell their number by [`Sender::wrote`].
    Write(&'a [u8]),
    /// Write nothing until this time, unless the control says something before.
    Wait(Duration),
    /// The sending has ended; [`Sender::outcome`] tells how.
    Ended,
}

/// Decides what is written when. Times are measured from the beginning of the sending. `queued` is the number
/// of characters in the system's output queue.
pub trait Sender: Send {
    /// Takes characters that the control has sent.
    fn receive(&mut self, bytes: &[u8], now: Duration);

    /// Tells what to do now.
    fn next(&mut self, now: Duration, queued: usize) -> Step<'_>;

    /// Tells that the first `count` characters of [`Step::Write`] were given to the system.
    fn wrote(&mut self, count: usize, now: Duration);

    /// Asks for the end of the sending. The sender first brings the control into a known state.
    fn cancel(&mut self, now: Duration);

    /// Ends the sending at once: no further character can or shall be written.
    fn give_up(&mut self, failure: Failure, now: Duration);

    /// Whether the control holds up the sender.
    fn is_held(&self, now: Duration) -> bool;

    /// Whether the control says that it waits for its operator.
    fn is_paused(&self) -> bool {
        false
    }

    fn progress(&mut self, now: Duration, queued: usize) -> Progress;

    /// How the sending ended. To be called after [`Step::Ended`] or [`Sender::give_up`].
    fn outcome(&mut self, now: Duration, queued: usize) -> Outcome;
}

/// How far a sending has come.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Progress {
    /// Number of characters that the line has taken. Those that are on their way do not count.
    pub n_characters: usize,
    pub n_characters_total: usize,
    /// Number of whole lines of the program that the line has taken; with GRBL, that the control has
    /// answered.
    pub n_lines: usize,
    pub n_lines_total: usize,
    /// Whether the control holds up the sender.
    pub is_waiting: bool,
    /// Whether the control says that it waits for its operator.
    pub is_paused: bool,
}

/// How a sending ended.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    pub progress: Progress,
    /// Number of times that the control held up the sender, and how long altogether.
    pub n_pauses: usize,
    pub waited: Duration,
    /// Number of characters that the control has sent, XON and XOFF included.
    pub n_received: usize,
    /// Why the program was not sent to its end.
    pub failure: Option<Failure>,
    pub left: Left,
    /// What is known of the arrival of a program that was sent to its end.
    pub delivery: Option<Delivery>,
}

/// Why a program was not sent to its end.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    Cancelled,
    /// The line is gone, with the words of the system.
    Disconnected(String),
    /// The control took nothing for this time.
    Silent(Duration),
    /// The control does not answer as GRBL does.
    NoGrbl,
    /// GRBL answered neither a line nor a status query for this time.
    NoStatus(Duration),
    /// GRBL had nothing to do for this time, but did not answer this line.
    Stuck {
        line: usize,
        state: &'static str,
        time: Duration,
    },
    /// GRBL refused a line of the program: its number, and the answer.
    Refused {
        line: usize,
        answer: String,
    },
    /// GRBL raised an alarm: its words, and the last line that it has answered.
    Alarm {
        after_line: usize,
        answer: String,
    },
    /// GRBL was restarted by something else than this sending.
    Restarted,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cancelled => write!(f, "the sending was cancelled"),
            Self::Disconnected(why) => write!(f, "the line is gone ({why})"),
            Self::Silent(time) => write!(
                f,
                "the control took nothing for {} s: check its reader and its XON, or raise `patience`",
                time.as_secs_f64()
            ),
            Self::NoGrbl => {
                write!(f, "the control does not answer as GRBL 1.1 does: check the port, `baud` and `format`")
            }
            Self::NoStatus(time) => write!(
                f,
                "GRBL answered no line and no status query for {} s: check the cable and the board",
                time.as_secs_f64()
            ),
            Self::Stuck { line, state, time } => write!(
                f,
                "GRBL reports `{state}`, but has not answered line {line} for {} s, so characters were lost: \
                 check the cable, `baud` and `format`",
                time.as_secs_f64()
            ),
            Self::Refused { line, answer } => write!(f, "GRBL refused line {line} with `{answer}`"),
            Self::Alarm { after_line: 0, answer } => write!(f, "GRBL raised `{answer}` before line 1"),
            Self::Alarm { after_line, answer } => write!(f, "GRBL raised `{answer}` after line {after_line}"),
            Self::Restarted => write!(f, "GRBL was restarted while it had lines to run"),
        }
    }
}

/// What the control was left with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Left {
    /// No character of the program.
    Nothing,
    /// The whole program.
    Whole,
    /// Whole blocks, the last of them from this line of the program, and perhaps the end mark `%` after them.
    Blocks { line: usize, has_end_mark: bool },
    /// Half a block, from this line of the program.
    HalfBlock { line: usize },
    /// GRBL at rest after a feed hold and a soft reset, with empty buffers. `is_confirmed` if GRBL has said
    /// so.
    Reset { is_confirmed: bool },
    /// GRBL, which something else has reset, perhaps in motion.
    Restarted,
}

impl fmt::Display for Left {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Nothing => write!(f, "the control has nothing of the program"),
            Self::Whole => write!(f, "the control has the whole program"),
            Self::Blocks { line: 0, has_end_mark: true } => {
                write!(f, "the control has no block of the program")
            }
            Self::Blocks { line: 0, has_end_mark: false } => {
                write!(f, "the control has no block of the program, but waits for more: reset the control")
            }
            Self::Blocks { line, has_end_mark: true } => {
                write!(f, "the control has whole blocks up to line {line} and the end mark % after them")
            }
            Self::Blocks { line, has_end_mark: false } => {
                write!(
                    f,
                    "the control has whole blocks up to line {line} and waits for more: reset the control"
                )
            }
            Self::HalfBlock { line } => write!(
                f,
                "the control may have a part of line {line}: reset the control before the next program"
            ),
            Self::Reset { is_confirmed: true } => {
                write!(f, "GRBL was reset after a feed hold and its buffers are empty")
            }
            Self::Restarted => {
                write!(f, "GRBL was reset by something else: home the machine before the next program")
            }
            Self::Reset { is_confirmed: false } => {
                write!(f, "GRBL was told to hold and to reset, but did not confirm: look at the machine")
            }
        }
    }
}

/// What is known of the arrival of the characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = Arrival)]
pub enum Delivery {
    /// The serial port has put all of them on the wire. Nothing tells whether the control has read them.
    Transmitted,
    /// The system has them for the peer of the connection. Nothing tells whether they have arrived.
    HandedOver,
    /// The peer has closed the connection after their end, so it has received all of them.
    PeerClosed,
    /// The control has answered every line.
    Answered,
}

impl Delivery {
    /// What is known, for people.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Transmitted => "the port has transmitted them, the control has confirmed nothing",
            Self::HandedOver => "the system has handed them over, the other side has confirmed nothing",
            Self::PeerClosed => "the other side has received them and closed the connection",
            Self::Answered => "the control has answered every line",
        }
    }
}
