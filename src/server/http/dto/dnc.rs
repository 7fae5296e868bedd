//! The controls to which programs can be sent, and the report of a program that was sent.

use serde::Serialize;
use utoipa::ToSchema;

use crate::dnc::{Address, Delivery, Ends, Flow, Marks, NamedTarget, Outcome, Settings};

/// The controls to which this server may send programs.
#[derive(Debug, Serialize, ToSchema)]
pub struct DncTargets {
    /// All controls, in the order of the configuration.
    pub targets: Vec<DncTarget>,
}

/// A control, and how programs are sent to it.
#[derive(Debug, Serialize, ToSchema)]
pub struct DncTarget {
    /// Name of the control: the last part of the path `/v1/dnc/{target}`.
    name: String,
    /// Kind of the line.
    line: LineKind,
    /// Whether a program is being sent to the control now.
    is_busy: bool,
    /// Speed of the line, in bits a second: a plain number.
    baud: u32,
    /// Data bits, parity and stop bits, such as `7e2`.
    format: String,
    /// Whether the sender keeps to the speed of the line. Otherwise the line sets the pace.
    is_paced: bool,
    /// How the control holds up the sender.
    flow: Flow,
    /// How lines end.
    ends: Ends,
    /// Whether a program without `%` at its start and end gets them.
    adds_marks: bool,
    /// Number of NUL characters before the program.
    leader: u32,
    /// Number of NUL characters after the program.
    trailer: u32,
    /// Whether the sender waits for an XON of the control before the first character.
    waits_for_xon: bool,
    /// Longest time in which the control takes nothing, in s. Then the sending ends. With GRBL: in which it
    /// answers no status query, or has nothing to do.
    patience_s: f64,
}

impl DncTarget {
    pub fn of(named: &NamedTarget, is_busy: bool) -> Self {
        let NamedTarget { name, target } = named;
        let settings = &target.settings;
        // The settings that have defaults are read by their functions.
        let Settings {
            flow,
            baud: _,
            format: _,
            is_unpaced: _,
            ends,
            marks,
            leader: _,
            trailer,
            waits_for_xon,
            patience,
        } = *settings;
        Self {
            name: name.clone(),
            line: match target.address {
                Address::Serial(_) => LineKind::Serial,
                Address::Tcp(_) => LineKind::Tcp,
            },
            is_busy,
            baud: settings.baud(),
            format: settings.format().to_string(),
            is_paced: target.is_paced(),
            flow,
            ends,
            adds_marks: marks == Marks::Add,
            leader: settings.leader(),
            trailer,
            waits_for_xon,
            patience_s: patience.as_secs_f64(),
        }
    }
}

/// Kind of a line to a control.
#[derive(Debug, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
enum LineKind {
    /// A serial port of the server.
    Serial,
    /// A TCP connection to a device server.
    Tcp,
}

/// A program that was sent to its end.
#[derive(Debug, Serialize, ToSchema)]
pub struct SentProgram {
    /// Name of the control.
    target: String,
    /// Number of lines of the program.
    n_lines: usize,
    /// Number of characters that were sent, with leader, `%` and trailer.
    n_characters: usize,
    /// Time of the sending, in s.
    duration_s: f64,
    /// Number of times that the control held up the sender by XOFF.
    n_pauses: usize,
    /// Time that the sender waited for XON, in s.
    waited_s: f64,
    /// Number of characters that the control has sent, XON and XOFF included.
    n_received: usize,
    /// What is known of the arrival of the characters: the serial port has `transmitted` them, the system has
    /// them for the other side of the connection (`handed_over`), the other side has received them and closed
    /// the connection (`peer_closed`), or GRBL has `answered` every line.
    arrival: Delivery,
}

impl SentProgram {
    pub fn of(target: String, outcome: &Outcome, duration_s: f64) -> Self {
        Self {
            target,
            n_lines: outcome.progress.n_lines,
            n_characters: outcome.progress.n_characters,
            duration_s: milliseconds(duration_s),
            n_pauses: outcome.n_pauses,
            waited_s: milliseconds(outcome.waited.as_secs_f64()),
            n_received: outcome.n_received,
            arrival: outcome.delivery.unwrap_or(Delivery::HandedOver),
        }
    }
}

/// Seconds rounded to a millisecond: further digits are noise.
fn milliseconds(seconds: f64) -> f64 {
    (seconds * 1e3).round() / 1e3
}
