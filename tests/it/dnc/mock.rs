//! A control on a pseudo terminal, with a receive buffer of 256 characters.

use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use toolpathd_server::dnc::{Address, Settings, Target};

const XON: u8 = 0x11;
const XOFF: u8 = 0x13;

/// Places of the buffer: all, those at which the control sends XOFF, and XON.
const BUFFER: usize = 256;
const OFF_AT: usize = 192;
const ON_AT: usize = 64;

/// How a control reads, and when it fails.
#[derive(Debug, Clone, Copy)]
pub struct Habits {
    /// Characters a second that the control takes out of its buffer.
    pub rate: f64,
    /// After so many received characters the control reads nothing for a time.
    pub stop: Option<(usize, Duration)>,
    /// After so many received characters the control goes away.
    pub vanish: Option<usize>,
}

impl Habits {
    pub const STEADY: Self = Self { rate: 300.0, stop: None, vanish: None };
}

/// What a control has seen.
#[derive(Debug)]
pub struct Seen {
    pub received: Vec<u8>,
    /// Most characters in the buffer. More than 256 are an overrun.
    pub most_held: usize,
    /// Most characters received after an XOFF and before the next XON.
    pub most_after_off: usize,
    pub n_offs: usize,
}

/// A control that runs on a thread of its own until [`Control::end`].
pub struct Control {
    pub path: String,
    /// Number of characters that the control has received.
    n_received: Arc<AtomicUsize>,
    end: Sender<()>,
    thread: JoinHandle<Seen>,
    /// Keeps the terminal open between two senders.
    _other_side: TTYPort,
}

impl Control {
    pub fn start(habits: Habits) -> Self {
        let (port, other_side) = TTYPort::pair().expect("a pair of pseudo terminals");
        let path = other_side.name().expect("a name");
        let (end, ended) = channel();
        let n_received = Arc::new(AtomicUsize::new(0));
        let count = Arc::clone(&n_received);
        let thread = std::thread::spawn(move || live(port, habits, &ended, &count));
        Self { path, n_received, end, thread, _other_side: other_side }
    }

    /// Waits until the control has received so many characters. Fails if they do not come.
    pub fn until_received(&self, count: usize) {
        let limit = Instant::now() + Duration::from_secs(30);
        while self.n_received.load(Ordering::Relaxed) < count {
            assert!(Instant::now() < limit, "{:?} of {count} characters came", self.n_received);
            std::thread::sleep(Duration::from_millis(5));
        }
    }

    /// The control as a target with these settings.
    pub fn target(&self, list: &str) -> Target {
        Target { address: Address::Serial(self.path.clone()), settings: settings(list) }
    }

    /// Ends the control once it has read everything.
    pub fn end(self) -> Seen {
        let _ = self.end.send(());
        self.thread.join().expect("the control does not panic")
    }
}

/// Settings in the words of a target: `baud=4800 ends=lf`.
pub fn settings(list: &str) -> Settings {
    let mut settings = Settings::default();
    for pair in list.split_whitespace() {
        let (name, value) = pair.split_once('=').expect("a pair");
        settings.set(name, value).expect("a legal value");
    }
    settings
}

fn live(mut port: TTYPort, habits: Habits, ended: &Receiver<()>, n_received: &AtomicUsize) -> Seen {
    port.set_timeout(Duration::from_millis(2)).expect("a timeout");
    let mut seen = Seen { received: Vec::new(), most_held: 0, most_after_off: 0, n_offs: 0 };
    // Characters read out of the buffer, and received since XOFF.
    let (mut read, mut after_off) = (0.0_f64, None);
    let mut stop = habits.stop;
    let mut stopped_until = None;
    let mut last = Instant::now();
    loop {
        let mut part = [0; BUFFER];
        let count = match port.read(&mut part) {
            Ok(count) => count,
            Err(error) if error.kind() == ErrorKind::TimedOut => 0,
            Err(_) => return seen,
        };
        seen.received.extend_from_slice(&part[..count]);
        n_received.store(seen.received.len(), Ordering::Relaxed);
        let held = seen.received.len() - read as usize;
        seen.most_held = seen.most_held.max(held);
        if let Some(after) = &mut after_off {
            *after += count;
            seen.most_after_off = seen.most_after_off.max(*after);
        } else if held >= OFF_AT {
            port.write_all(&[XOFF]).expect("the sender listens");
            after_off = Some(0);
            seen.n_offs += 1;
        }
        if habits.vanish.is_some_and(|at| seen.received.len() >= at) {
            return seen;
        }
        let now = Instant::now();
        if let Some((_, time)) = stop.take_if(|(at, _)| seen.received.len() >= *at) {
            stopped_until = Some(now + time);
        }
        if stopped_until.is_none_or(|until| now >= until) {
            let step = habits.rate * (now - last).as_secs_f64();
            read = (read + step).min(seen.received.len() as f64);
        }
        last = now;
        let held = seen.received.len() - read as usize;
        if after_off.is_some() && held <= ON_AT {
            port.write_all(&[XON]).expect("the sender listens");
            after_off = None;
        }
        if count == 0 && ended.try_recv().is_ok() {
            return seen;
        }
    }
}

/// A program of `n` blocks.
pub fn program(n: usize) -> Vec<u8> {
    let blocks = (0..n).map(|k| format!("N{k} G1 X{}.{:03} Y-{}\n", k % 300, k * 7 % 1000, k % 90));
    blocks.collect::<String>().into_bytes()
}

/// What the control must receive for a program: leader, `%`, program, `%`.
pub fn tape(leader: usize, program: &[u8]) -> Vec<u8> {
    [&vec![0; leader], b"%\n".as_slice(), program, b"%\n"].concat()
}
