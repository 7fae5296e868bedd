//! Sends programs to the controls that the configuration names: to each control one program at a time.
//!
//! A sending runs on its own thread. If the caller goes away, the service asks the sending to stop; the
//! sending first brings the control into a known state. A shutdown of the service asks all of them.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use tracing::Span;

use super::encoded::Encoded;
use crate::dnc::target::sender;
use crate::dnc::{NamedTarget, Outcome, Progress, SendError, Sender, Stop, TapeError, send_by};
use crate::http::byte_limit::HeldBytes;
use crate::http::dto::dnc::{DncTarget, DncTargets, SentProgram};
use crate::http::error::SentPart;
use crate::http::error::{ApiError, Code};
use toolpathd_core::budget::ProgressSink;

/// The names of the stages in progress events.
const SENDING: &str = "sending";
const WAITING: &str = "waiting";
const PAUSED: &str = "paused";

/// All controls of this server.
#[derive(Debug)]
pub struct Controls(Vec<Arc<Control>>);

/// A control, and whether a program is being sent to it.
#[derive(Debug)]
struct Control {
    named: NamedTarget,
    state: Mutex<State>,
}

#[derive(Debug, Clone)]
enum State {
    Free,
    Busy(Stop),
    /// The service shuts down.
    Closed,
}

impl Control {
    fn state(&self) -> std::sync::MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Controls {
    pub fn new(targets: &[NamedTarget]) -> Self {
        let control =
            |named: &NamedTarget| Arc::new(Control { named: named.clone(), state: Mutex::new(State::Free) });
        Self(targets.iter().map(control).collect())
    }

    /// The controls for the answer of `/v1/dnc`.
    pub fn list(&self) -> DncTargets {
        let target = |control: &Arc<Control>| {
            DncTarget::of(&control.named, matches!(*control.state(), State::Busy(_)))
        };
        DncTargets { targets: self.0.iter().map(target).collect() }
    }

    /// Asks all sendings to stop, and lets no other one begin.
    pub fn close(&self) {
        for control in &self.0 {
            if let State::Busy(stop) = std::mem::replace(&mut *control.state(), State::Closed) {
                stop.at_block();
            }
        }
    }

    /// The control with this name.
    ///
    /// # Errors
    /// `not_found`, with the names of all controls.
    pub fn find(&self, name: &str) -> Result<Found, ApiError> {
        let found = self.0.iter().find(|control| control.named.name == name);
        found.map(|control| Found(Arc::clone(control))).ok_or_else(|| {
            let names: Vec<&str> = self.0.iter().map(|control| control.named.name.as_str()).collect();
            let detail = if names.is_empty() {
                "this server sends to no control; start it with `--dnc-target NAME=serial:/dev/ttyUSB0,baud=9600` \
                 or `--dnc-target NAME=tcp:HOST:PORT`"
                    .to_owned()
            } else {
                format!("there is no control of this name; there are `{}`", names.join("`, `"))
            };
            ApiError::new(Code::NotFound, detail)
        })
    }
}

/// A control of the configuration.
#[derive(Debug, Clone)]
pub struct Found(Arc<Control>);

impl Found {
    /// Makes the sender of a program.
    ///
    /// # Errors
    /// `not_sendable` when the line cannot carry the program.
    pub fn sender(&self, program: &[u8]) -> Result<Box<dyn Sender>, ApiError> {
        Ok(sender(program, &self.0.named.target)?)
    }

    /// Takes the control for a sending.
    ///
    /// # Errors
    /// `target_busy`, and `overloaded` during a shutdown.
    pub fn take(self) -> Result<Taken, ApiError> {
        let mut state = self.0.state();
        match *state {
            State::Free => {}
            State::Busy(_) => {
                let detail = format!(
                    "another program is being sent to `{}`; wait until `is_busy` in `GET /v1/dnc` is `false`",
                    self.0.named.name
                );
                return Err(ApiError::new(Code::TargetBusy, detail));
            }
            State::Closed => {
                return Err(ApiError::new(Code::Overloaded, "the service is shutting down"));
            }
        }
        let stop = Stop::default();
        *state = State::Busy(stop.clone());
        drop(state);
        Ok(Taken { control: self.0, stop })
    }
}

/// A control that is taken for one sending. Dropping the value frees the control.
pub struct Taken {
    control: Arc<Control>,
    stop: Stop,
}

impl Drop for Taken {
    fn drop(&mut self) {
        let mut state = self.control.state();
        if matches!(*state, State::Busy(_)) {
            *state = State::Free;
        }
    }
}

impl Taken {
    /// Sends the program of `sender`, and tells `listener` how far it has come. Dropping the future asks the
    /// sending to stop; the bytes of the program are `held` until the sending has ended.
    ///
    /// # Errors
    /// `target_unreachable` when nothing was sent, and `sending_stopped` when not everything was sent.
    pub async fn send(
        self,
        mut sender: Box<dyn Sender>,
        held: HeldBytes,
        listener: Option<Arc<dyn ProgressSink>>,
    ) -> Result<Encoded, ApiError> {
        let _stop = StopOnDrop(self.stop.clone());
        let span = Span::current();
        let sending = move || {
            let _entered = span.enter();
            let begun = Instant::now();
            let NamedTarget { name, target } = &self.control.named;
            let mut was_paused = false;
            let mut observe = |progress: &Progress| {
                if progress.is_paused && !was_paused {
                    tracing::info!(
                        target_name = name,
                        line = progress.n_lines + 1,
                        "waiting for the operator"
                    );
                }
                was_paused = progress.is_paused;
                if let Some(listener) = &listener {
                    let stage = stage(progress);
                    listener.progress(stage, progress.n_characters, progress.n_characters_total);
                }
            };
            let outcome = send_by(&mut *sender, target, &self.stop, &mut observe);
            // The control is free before the answer is sent, so that the caller finds it free.
            let name = name.clone();
            drop((self, held));
            answer(name, outcome?, begun)
        };
        let ended = tokio::task::spawn_blocking(sending).await;
        ended.map_err(|_| {
            ApiError::new(
                Code::InternalError,
                "the service failed while sending: look at the machine, and report the request id",
            )
        })?
    }
}

/// The name of the stage in which a sending is.
fn stage(progress: &Progress) -> &'static str {
    match progress {
        Progress { is_paused: true, .. } => PAUSED,
        Progress { is_waiting: true, .. } => WAITING,
        _ => SENDING,
    }
}

/// The answer to a sending that has begun. The log holds it too: the caller may have gone away.
fn answer(name: String, outcome: Outcome, begun: Instant) -> Result<Encoded, ApiError> {
    let Progress { n_characters, n_lines, n_lines_total, .. } = outcome.progress;
    let failure = outcome.failure.as_ref().map(tracing::field::display);
    tracing::info!(target_name = name, n_lines, n_characters, failure, left = %outcome.left, "sent");
    match &outcome.failure {
        None => Encoded::json(&SentProgram::of(name, &outcome, begun.elapsed().as_secs_f64())),
        Some(failure) => {
            let left = outcome.left;
            let detail =
                format!("{failure}; {n_lines} of {n_lines_total} lines were sent for certain; {left}");
            Err(ApiError::new(Code::SendingStopped, detail).after(SentPart::from(&outcome)))
        }
    }
}

struct StopOnDrop(Stop);

impl Drop for StopOnDrop {
    fn drop(&mut self) {
        self.0.at_block();
    }
}

impl From<TapeError> for ApiError {
    fn from(error: TapeError) -> Self {
        Self::new(Code::NotSendable, error.to_string())
    }
}

impl From<SendError> for ApiError {
    fn from(error: SendError) -> Self {
        match error {
            SendError::Tape(error) => error.into(),
            // The address is a setting of the server, and none of the caller's business.
            SendError::Open { address: _, error } => Self::new(
                Code::TargetUnreachable,
                format!("the line cannot be opened: {error}; check the cable and `--dnc-target`"),
            ),
        }
    }
}
