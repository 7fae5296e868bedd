use std::collections::VecDeque;

use proptest::prelude::*;

use super::*;
use crate::dnc::in_flight::MOST;

/// A control with a receive buffer of 256 characters, on a line with a speed, in simulated time.
struct Control {
    /// Characters a second: of the line, and of the reader of the buffer.
    rate: f64,
    drain: f64,
    /// The reader stops from the first to the second time.
    stop: (f64, f64),
    /// Characters on the line, each with the time of its arrival.
    line: VecDeque<(f64, u8)>,
    received: Vec<u8>,
    read: f64,
    is_off: bool,
    n_since_off: usize,
    most_since_off: usize,
    most_held: usize,
    /// Answers, each with the time of its arrival.
    answers: VecDeque<(f64, u8)>,
    /// Time from XOFF to its arrival.
    latency: f64,
}

impl Control {
    fn new(rate: f64, drain: f64) -> Self {
        Self {
            rate,
            drain,
            stop: (0.0, 0.0),
            line: VecDeque::new(),
            received: Vec::new(),
            read: 0.0,
            is_off: false,
            n_since_off: 0,
            most_since_off: 0,
            most_held: 0,
            answers: VecDeque::new(),
            latency: 1.0 / rate,
        }
    }

    fn write(&mut self, bytes: &[u8], now: f64) {
        for byte in bytes {
            let free = self.line.back().map_or(now, |(at, _)| at.max(now));
            self.line.push_back((free + 1.0 / self.rate, *byte));
        }
    }

    fn held(&self) -> usize {
        self.received.len() - self.read as usize
    }

    /// Lets the control live for the time `step` until `now`.
    fn live(&mut self, now: f64, step: f64) {
        while let Some((_, byte)) = self.line.pop_front_if(|(at, _)| *at <= now) {
            self.received.push(byte);
            self.n_since_off += usize::from(self.is_off);
            if self.held() >= 192 && !self.is_off {
                self.is_off = true;
                self.n_since_off = 0;
                self.answers.push_back((now + self.latency, XOFF));
            }
        }
        self.most_since_off = self.most_since_off.max(self.n_since_off);
        self.most_held = self.most_held.max(self.held());
        if !(self.stop.0..self.stop.1).contains(&now) {
            self.read = (self.read + self.drain * step).min(self.received.len() as f64);
        }
        if self.is_off && self.held() <= 64 {
            self.is_off = false;
            self.answers.push_back((now + self.latency, XON));
        }
    }
}

/// Lets `sender` send to `control`. It oversleeps by `jitter` seconds each time. `cancel` is the number of
/// received characters at which the sending is cancelled. Returns the time it took.
fn simulate(sender: &mut Handshake, control: &mut Control, jitter: f64, cancel: Option<usize>) -> f64 {
    let step = 0.25 / control.rate;
    let mut wake = 0.0;
    for k in 0..50_000_000_u64 {
        let seconds = k as f64 * step;
        let now = Duration::from_secs_f64(seconds);
        control.live(seconds, step);
        let mut has_answer = false;
        while let Some((_, byte)) = control.answers.pop_front_if(|(at, _)| *at <= seconds) {
            sender.receive(&[byte], now);
            has_answer = true;
        }
        if cancel.is_some_and(|count| control.received.len() >= count) {
            sender.cancel(now);
        }
        if seconds < wake && !has_answer {
            continue;
        }
        match sender.next(now, 0) {
            Step::Write(bytes) => {
                assert!(bytes.len() <= MOST && !bytes.is_empty());
                control.write(bytes, seconds);
                let count = bytes.len();
                sender.wrote(count, now);
                wake = seconds + jitter;
            }
            Step::Wait(until) => wake = until.as_secs_f64() + jitter,
            Step::Ended => {
                control.live(seconds + 1e-9, 0.0);
                return seconds;
            }
        }
    }
    panic!("the sending does not end");
}

/// A program of about `length` characters.
fn program(length: usize) -> Vec<u8> {
    let blocks = (0..).map(|k| format!("N{k} G1 X{}.{:03} Y-{}\r\n", k % 300, k * 7 % 1000, k % 90));
    let mut text = String::new();
    for block in blocks {
        if text.len() >= length {
            return text.into_bytes();
        }
        text.push_str(&block);
    }
    unreachable!()
}

fn sender(program: &[u8], list: &str) -> Handshake {
    let mut settings = Settings::default();
    for pair in list.split_whitespace() {
        let (name, value) = pair.split_once('=').expect("a pair");
        settings.set(name, value).expect("a legal value");
    }
    let tape = Tape::new(program, &settings).expect("a tape");
    Handshake::new(tape, &settings, true)
}

#[test]
fn a_fast_control_takes_the_program_at_the_speed_of_the_line() {
    let program = program(2000);
    let mut sender = sender(&program, "");
    let mut control = Control::new(9600.0 / 11.0, 1e9);
    let seconds = simulate(&mut sender, &mut control, 0.0, None);
    assert_eq!(control.received, sender.tape.bytes());
    let ideal = control.received.len() as f64 / control.rate;
    assert!((ideal..ideal + 0.01).contains(&seconds), "{seconds} s instead of {ideal} s");
    let outcome = sender.outcome(Duration::from_secs_f64(seconds), 0);
    assert_eq!((outcome.failure, outcome.left, outcome.n_pauses), (None, Left::Whole, 0));
    assert_eq!(outcome.progress.n_lines, outcome.progress.n_lines_total);
}

#[test]
fn a_stop_of_ten_seconds_in_mid_file_loses_nothing() {
    let program = program(3000);
    let mut sender = sender(&program, "");
    let mut control = Control { stop: (1.0, 11.0), ..Control::new(9600.0 / 11.0, 600.0) };
    let seconds = simulate(&mut sender, &mut control, 0.001, None);
    assert_eq!(control.received, sender.tape.bytes());
    assert!(control.most_held <= 256, "{}", control.most_held);
    assert!(seconds > 11.0);
    let outcome = sender.outcome(Duration::from_secs_f64(seconds), 0);
    assert!(outcome.waited > Duration::from_secs(9) && outcome.n_pauses >= 2, "{outcome:?}");
}

#[test]
fn a_control_that_stays_silent_ends_the_sending_after_the_patience() {
    let program = program(3000);
    let mut sender = sender(&program, "patience=5");
    let mut control = Control { stop: (0.5, 1e9), ..Control::new(1000.0, 800.0) };
    let seconds = simulate(&mut sender, &mut control, 0.0, None);
    assert!(seconds > 5.0 && seconds < 7.0, "{seconds}");
    let outcome = sender.outcome(Duration::from_secs_f64(seconds), 0);
    assert_eq!(outcome.failure, Some(Failure::Silent(Duration::from_secs(5))));
    assert_eq!(outcome.progress.n_characters, control.received.len());
    assert!(sender.tape.bytes().starts_with(&control.received));
}

#[test]
fn sending_begins_at_the_controls_xon_where_that_is_asked() {
    let mut sender = sender(b"G0 X1\n", "wait-for-xon=true leader=0");
    let start = Duration::from_secs(3);
    assert_eq!(sender.next(start, 0), Step::Wait(Duration::from_secs(600)));
    assert!(sender.is_held(start));
    sender.receive(b"\x91", start);
    assert_eq!(sender.next(start, 0), Step::Write(b"%\nG0 X1\n%\n"));
}

#[test]
fn other_characters_of_the_control_do_not_start_a_held_sender() {
    let mut sender = sender(b"G0 X1\n", "leader=0");
    sender.receive(b"\x93", Duration::ZERO);
    sender.receive(b"\x12\x14 \x00A", Duration::ZERO);
    assert!(matches!(sender.next(Duration::ZERO, 0), Step::Wait(_)));
    sender.receive(b"\x11", Duration::ZERO);
    assert!(matches!(sender.next(Duration::ZERO, 0), Step::Write(_)));
    let mut deaf = self::sender(b"G0 X1\n", "flow=none leader=0");
    deaf.receive(b"\x13", Duration::ZERO);
    assert!(matches!(deaf.next(Duration::ZERO, 0), Step::Write(_)));
}

#[test]
fn a_lost_line_is_told_with_the_line_that_may_have_arrived_in_part() {
    let mut sender = sender(b"G0 X1\nG0 X2\nG0 X3\n", "leader=0 ends=lf");
    sender.wrote(2 + 6 + 6, Duration::ZERO);
    // Seven characters were still on their way.
    sender.give_up(Failure::Disconnected("gone".to_owned()), Duration::ZERO);
    let outcome = sender.outcome(Duration::from_secs_f64(7.5 / (9600.0 / 11.0)), 0);
    assert_eq!((outcome.progress.n_characters, outcome.progress.n_lines), (7, 0));
    assert_eq!(outcome.left, Left::HalfBlock { line: 1 });
    let mut early = self::sender(b"G0 X1\n", "leader=5");
    early.wrote(3, Duration::ZERO);
    early.give_up(Failure::Cancelled, Duration::ZERO);
    assert_eq!(early.outcome(Duration::ZERO, 0).left, Left::Nothing);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// The control's buffer never overruns and no character is lost, whatever the speeds are. After its XOFF
    /// the control receives at most what was on its way, and what arrives while the XOFF is on its way.
    #[test]
    fn a_control_is_never_overrun(
        baud in prop::sample::select(vec![4800_u32, 9600, 19_200, 38_400, 115_200]),
        drain in 0.05..1.5_f64,
        stop in (0.0..2.0_f64, 0.0..3.0_f64),
        jitter in 0.0..20.0_f64,
        latency in 0.0..8.0_f64,
    ) {
        let program = program(1500);
        let mut sender = sender(&program, &format!("baud={baud} patience=60"));
        let rate = f64::from(baud) / 11.0;
        let (jitter, latency) = (jitter / rate, latency / rate);
        let mut control =
            Control { stop: (stop.0, stop.0 + stop.1), latency, ..Control::new(rate, drain * rate) };
        simulate(&mut sender, &mut control, jitter, None);
        prop_assert_eq!(&control.received, sender.tape.bytes());
        prop_assert!(control.most_held <= 256, "{} characters in the buffer", control.most_held);
        let law = MOST as f64 + latency * rate + 2.0;
        prop_assert!(control.most_since_off as f64 <= law, "{} characters after XOFF", control.most_since_off);
    }

    /// A cancelled sending ends at the end of a block, with the end mark.
    #[test]
    fn a_cancelled_sending_ends_with_a_whole_block_and_the_end_mark(
        at in 0_usize..1400,
        drain in 0.2..1.5_f64,
        ends in "lf|crlf|as-is",
    ) {
        let program = program(1500);
        let mut sender = sender(&program, &format!("baud=115200 ends={ends} trailer=4"));
        let rate = 115_200.0 / 11.0;
        let mut control = Control::new(rate, drain * rate);
        let seconds = simulate(&mut sender, &mut control, 0.0, Some(at));
        let outcome = sender.outcome(Duration::from_secs_f64(seconds), 0);
        prop_assert_eq!(outcome.failure, Some(Failure::Cancelled));
        let n_lines = outcome.progress.n_lines;
        if outcome.left == Left::Nothing {
            prop_assert!(control.received.iter().all(|byte| *byte == 0));
        } else {
            prop_assert_eq!(outcome.left, Left::Blocks { line: n_lines, has_end_mark: true });
            let text = String::from_utf8(control.received).unwrap();
            let lines: Vec<&str> = text.trim_start_matches('\0').lines().collect();
            let whole: Vec<&str> = std::str::from_utf8(&program).unwrap().lines().take(n_lines).collect();
            prop_assert!(text.ends_with('\n'));
            prop_assert_eq!(lines, [&["%"], &whole[..], &["%"]].concat());
        }
    }
}
