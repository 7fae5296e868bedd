//! Connects a sender with a line until the sending ends.

use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicU8, Ordering};
use std::time::{Duration, Instant};

use super::line::Line;
use super::sender::{Failure, Outcome, Progress, Sender, Step};

/// Longest time without a look at the stop. A shorter time would cost more than anybody could notice.
const LOOK_INTERVAL: Duration = Duration::from_millis(50);

/// Shortest time between two reports of progress while nothing else changes.
const PROGRESS_INTERVAL: Duration = Duration::from_millis(100);

/// Most reads before the next write. A control that never stops talking must not keep a stop from being seen.
const MOST_READS: usize = 64;

/// Asks a sending to stop. Clones ask the same sending.
#[derive(Debug, Clone, Default)]
pub struct Stop(Arc<AtomicU8>);

impl Stop {
    const AT_BLOCK: u8 = 1;
    const AT_ONCE: u8 = 2;

    /// Asks to bring the control into a known state and to end.
    pub fn at_block(&self) {
        self.0.fetch_max(Self::AT_BLOCK, Ordering::Relaxed);
    }

    /// Asks to end at once. The control may be left with half a block.
    pub fn at_once(&self) {
        self.0.fetch_max(Self::AT_ONCE, Ordering::Relaxed);
    }

    pub fn is_asked(&self) -> bool {
        self.asked() > 0
    }

    fn asked(&self) -> u8 {
        self.0.load(Ordering::Relaxed)
    }
}

/// Sends until the sender ends, and tells `observe` how far it has come.
pub fn run(
    line: &mut dyn Line,
    sender: &mut dyn Sender,
    stop: &Stop,
    observe: &mut dyn FnMut(&Progress),
) -> Outcome {
    let begun = Instant::now();
    let mut told = Told::default();
    let failed = loop {
        match advance(line, sender, stop, begun) {
            Ok(true) => {}
            Ok(false) => break None,
            Err(error) => break Some(error),
        }
        told.tell(sender, line, begun.elapsed(), observe);
    };
    let now = begun.elapsed();
    let is_line_gone = failed.is_some();
    if let Some(error) = failed {
        sender.give_up(Failure::Disconnected(error.to_string()), now);
    }
    let queued = line.queued().unwrap_or_default();
    let mut outcome = sender.outcome(now, queued);
    if !is_line_gone && outcome.delivery.is_none() {
        end(line, queued, &mut outcome);
    }
    observe(&outcome.progress);
    outcome
}

/// Ends a line that still stands. `queued` is the number of characters in its output queue.
fn end(line: &mut dyn Line, queued: usize, outcome: &mut Outcome) {
    if queued > 0 {
        // The failure is told already; a line that does not discard is gone, and so are its characters.
        let _ = line.discard();
        return;
    }
    // A cancelled sending ends its connection properly too, so that the end mark arrives.
    let finished = line.finish();
    if outcome.failure.is_none() {
        match finished {
            Ok(delivery) => outcome.delivery = Some(delivery),
            Err(error) => outcome.failure = Some(Failure::Disconnected(error.to_string())),
        }
    }
}

/// Takes one step. Returns whether there is another one.
fn advance(line: &mut dyn Line, sender: &mut dyn Sender, stop: &Stop, begun: Instant) -> io::Result<bool> {
    let mut answer = [0; 256];
    for _ in 0..MOST_READS {
        let count = line.read(&mut answer)?;
        if count == 0 {
            break;
        }
        sender.receive(&answer[..count], begun.elapsed());
    }
    let now = begun.elapsed();
    match stop.asked() {
        0 => {}
        Stop::AT_BLOCK => sender.cancel(now),
        _ => {
            sender.give_up(Failure::Cancelled, now);
            return Ok(false);
        }
    }
    let queued = line.queued()?;
    match sender.next(now, queued) {
        Step::Write(bytes) => {
            let count = line.write(bytes)?;
            sender.wrote(count, begun.elapsed());
            if count == 0 {
                line.wait(true, LOOK_INTERVAL)?;
            }
        }
        Step::Wait(until) => line.wait(false, until.saturating_sub(now).min(LOOK_INTERVAL))?,
        Step::Ended => return Ok(false),
    }
    Ok(true)
}

/// What was told of the progress, and when.
#[derive(Default)]
struct Told {
    last: Option<Duration>,
    /// Whether the control held up the sender, and waited for its operator.
    was: [bool; 2],
}

impl Told {
    fn tell(
        &mut self,
        sender: &mut dyn Sender,
        line: &dyn Line,
        now: Duration,
        observe: &mut dyn FnMut(&Progress),
    ) {
        let is_due = self.last.is_none_or(|last| now >= last + PROGRESS_INTERVAL);
        if is_due || [sender.is_held(now), sender.is_paused()] != self.was {
            let progress = sender.progress(now, line.queued().unwrap_or_default());
            (self.last, self.was) = (Some(now), [progress.is_waiting, progress.is_paused]);
            observe(&progress);
        }
    }
}
