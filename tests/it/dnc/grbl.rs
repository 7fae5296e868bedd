//! GRBL on a pseudo terminal: a receive buffer of 128 characters, and answers that hold 0x11 and 0x13.

use std::io::{ErrorKind, Read, Write};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use toolpathd_server::dnc::{Address, Delivery, Failure, Left, Progress, Stop, Target, send};

use super::mock::settings;

/// What GRBL has seen.
#[derive(Debug, Default)]
struct Seen {
    lines: Vec<String>,
    most_held: usize,
    commands: Vec<u8>,
}

struct Grbl {
    path: String,
    end: Sender<()>,
    thread: JoinHandle<Seen>,
    _other_side: TTYPort,
}

impl Grbl {
    /// Takes a line in each `interval`, and refuses the line with this number, from 0.
    fn start(interval: Duration, refused: Option<usize>) -> Self {
        Self::with(Habits { interval, refused, resumes_after: None })
    }

    fn with(habits: Habits) -> Self {
        let (port, other_side) = TTYPort::pair().expect("a pair of pseudo terminals");
        let path = other_side.name().expect("a name");
        let (end, ended) = channel();
        let thread = std::thread::spawn(move || live(port, habits, &ended));
        Self { path, end, thread, _other_side: other_side }
    }

    fn target(&self) -> Target {
        self.target_with("")
    }

    fn target_with(&self, more: &str) -> Target {
        let settings = settings(&format!("flow=grbl unpaced=true {more}"));
        Target { address: Address::Serial(self.path.clone()), settings }
    }

    fn end(self) -> Seen {
        let _ = self.end.send(());
        self.thread.join().expect("GRBL does not panic")
    }
}

/// How GRBL takes lines.
#[derive(Debug, Clone, Copy)]
struct Habits {
    interval: Duration,
    /// The number of the line that is refused, from 0.
    refused: Option<usize>,
    /// GRBL stands at M0 for this time, until its operator lets it go on; for ever without a time.
    resumes_after: Option<Duration>,
}

fn live(mut port: TTYPort, habits: Habits, ended: &Receiver<()>) -> Seen {
    let Habits { interval, refused, resumes_after } = habits;
    port.set_timeout(Duration::from_millis(1)).expect("a timeout");
    let mut seen = Seen::default();
    let mut buffer: Vec<u8> = Vec::new();
    let mut is_held = false;
    let mut paused_at: Option<Instant> = None;
    let mut line_at = Instant::now();
    loop {
        let mut part = [0; 64];
        let count = match port.read(&mut part) {
            Ok(count) => count,
            Err(error) if error.kind() == ErrorKind::TimedOut => 0,
            Err(_) => return seen,
        };
        let mut say = |text: &str| port.write_all(format!("{text}\r\n").as_bytes()).expect("it listens");
        for byte in &part[..count] {
            match byte {
                b'?' => say(if is_held || paused_at.is_some() {
                    "<Hold:0|FS:0,0>"
                } else {
                    "<Run|FS:500,8000|\x11\x13>"
                }),
                b'!' => is_held = true,
                0x18 => {
                    (is_held, paused_at, buffer) = (false, None, Vec::new());
                    say("\r\nGrbl 1.1h ['$' for help]");
                }
                byte => buffer.push(*byte),
            }
            if b"?!\x18".contains(byte) {
                seen.commands.push(*byte);
            }
        }
        if paused_at.is_some_and(|at| resumes_after.is_some_and(|time| at.elapsed() >= time)) {
            paused_at = None;
            say("ok");
        }
        seen.most_held = seen.most_held.max(buffer.len());
        let end = buffer.iter().position(|byte| *byte == b'\n');
        if let Some(end) = end.filter(|_| !is_held && paused_at.is_none() && line_at.elapsed() >= interval) {
            line_at = Instant::now();
            let line: Vec<u8> = buffer.drain(..=end).collect();
            seen.lines.push(String::from_utf8(line).expect("ASCII").trim_end().to_owned());
            if seen.lines.last().is_some_and(|line| line == "M0") {
                paused_at = Some(Instant::now());
                continue;
            }
            say("[MSG:\x11 data \x13ok\x13]");
            say(if refused == Some(seen.lines.len() - 1) { "error:22" } else { "ok" });
        }
        if count == 0 && ended.try_recv().is_ok() {
            return seen;
        }
    }
}

fn blocks(n: usize) -> Vec<String> {
    (0..n).map(|k| format!("G1 X{}.{:03} Y{} F{}", k % 300, k * 37 % 1000, k * k % 1000, 100 + k)).collect()
}

#[test]
fn lines_are_sent_within_the_buffer_and_every_one_is_answered() {
    let blocks = blocks(300);
    let text: String =
        blocks.iter().enumerate().map(|(k, block)| format!("{block} (no {k}!)\r\n\r\n")).collect();
    let grbl = Grbl::start(Duration::from_millis(2), None);
    let outcome = send(text.as_bytes(), &grbl.target(), &Stop::default(), &mut |_| {}).expect("it opens");
    let seen = grbl.end();
    assert_eq!((outcome.failure, outcome.left), (None, Left::Whole));
    assert_eq!(outcome.delivery, Some(Delivery::Answered));
    assert_eq!(seen.lines, blocks);
    assert!((64..128).contains(&seen.most_held), "{} characters in the buffer", seen.most_held);
    assert_eq!((seen.commands.as_slice(), outcome.progress.n_lines), (b"?".as_slice(), 600));
}

#[test]
fn an_error_stops_the_machine_and_names_the_line_of_the_program() {
    let blocks = blocks(60);
    let text = format!("%\n(title)\n{}\n%\n", blocks.join("\n"));
    let grbl = Grbl::start(Duration::from_millis(5), Some(30));
    let outcome = send(text.as_bytes(), &grbl.target(), &Stop::default(), &mut |_| {}).expect("it opens");
    let seen = grbl.end();
    assert_eq!(outcome.failure, Some(Failure::Refused { line: 33, answer: "error:22".to_owned() }));
    assert_eq!(outcome.left, Left::Reset { is_confirmed: true });
    // The lines that waited in the buffer are run until the hold arrives, and none after it.
    assert!(seen.lines.len() <= 33 && blocks.starts_with(&seen.lines), "{}", seen.lines.len());
    assert!(seen.commands.ends_with(b"!?\x18"), "{:?}", seen.commands);
}

#[test]
fn a_cancelled_sending_holds_the_feed_and_resets_after_the_rest() {
    let blocks = blocks(200);
    let grbl = Grbl::start(Duration::from_millis(5), None);
    let stop = Stop::default();
    let asked = stop.clone();
    let mut cancel = |progress: &Progress| {
        if progress.n_lines >= 20 {
            asked.at_block();
        }
    };
    let text = blocks.join("\n");
    let outcome = send(text.as_bytes(), &grbl.target(), &stop, &mut cancel).expect("it opens");
    let seen = grbl.end();
    assert_eq!(outcome.failure, Some(Failure::Cancelled));
    assert_eq!(outcome.left, Left::Reset { is_confirmed: true });
    assert!(blocks.starts_with(&seen.lines) && seen.lines.len() < 200, "{}", seen.lines.len());
    assert!(seen.commands.ends_with(b"!?\x18"), "{:?}", seen.commands);
}

#[test]
fn a_program_pause_outlasts_the_patience_and_is_told() {
    let resumes_after = Some(Duration::from_secs(4));
    let grbl = Grbl::with(Habits { interval: Duration::from_millis(2), refused: None, resumes_after });
    let target = grbl.target_with("patience=2");
    let mut pauses = Vec::new();
    let mut watch = |progress: &Progress| {
        if pauses.last() != Some(&progress.is_paused) {
            pauses.push(progress.is_paused);
        }
    };
    let text = b"G0 X1\nM0\nG0 X2\nM30\n";
    let outcome = send(text, &target, &Stop::default(), &mut watch).expect("it opens");
    let seen = grbl.end();
    assert_eq!((outcome.failure, outcome.left), (None, Left::Whole));
    assert_eq!(seen.lines, ["G0 X1", "M0", "G0 X2", "M30"]);
    assert_eq!(pauses, [false, true, false]);
    assert!(seen.commands.iter().all(|command| *command == b'?'), "{:?}", seen.commands);
}

#[test]
fn a_pause_without_an_operator_is_ended_by_a_cancel() {
    let interval = Duration::from_millis(2);
    let grbl = Grbl::with(Habits { interval, refused: None, resumes_after: None });
    let stop = Stop::default();
    let asked = stop.clone();
    let mut cancel = |progress: &Progress| {
        if progress.is_paused {
            asked.at_block();
        }
    };
    let text = b"G0 X1\nM0\nG0 X2\nM30\n";
    let outcome = send(text, &grbl.target(), &stop, &mut cancel).expect("it opens");
    let seen = grbl.end();
    assert_eq!(outcome.failure, Some(Failure::Cancelled));
    assert_eq!(outcome.left, Left::Reset { is_confirmed: true });
    assert_eq!(seen.lines, ["G0 X1", "M0"]);
}
