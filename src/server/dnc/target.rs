//! Where programs are sent: an address with the settings of its line.

use std::fmt;
use std::io;
use std::str::FromStr;

use super::grbl::{self, Grbl};
use super::handshake::Handshake;
use super::line::Line;
use super::run::{Stop, run};
use super::sender::{Outcome, Progress, Sender};
use super::serial::Serial;
use super::settings::{Flow, Settings};
use super::tape::{Tape, TapeError};
use super::tcp::Tcp;

/// Most characters of a target's name.
const MOST_NAME: usize = 64;

/// Where a line leads to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Address {
    /// The path of a serial device.
    Serial(String),
    /// Host and port of a device server.
    Tcp(String),
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Serial(path) => write!(f, "serial:{path}"),
            Self::Tcp(address) => write!(f, "tcp:{address}"),
        }
    }
}

/// A control and how to send to it.
#[derive(Debug, Clone, PartialEq)]
pub struct Target {
    pub address: Address,
    pub settings: Settings,
}

impl Target {
    /// Checks the rules that concern address and settings together.
    ///
    /// # Errors
    /// A message for people.
    pub fn check(&self) -> Result<(), String> {
        if matches!(self.address, Address::Tcp(_)) && self.settings.flow == Flow::RtsCts {
            return Err("a TCP connection has no RTS and CTS; set `flow` to `xon-xoff` or `none`".to_owned());
        }
        self.settings.check()
    }

    /// Whether the sender keeps to the speed of the line. A connection has a speed only if `baud` gives it.
    pub fn is_paced(&self) -> bool {
        let has_speed = matches!(self.address, Address::Serial(_)) || self.settings.baud.is_some();
        has_speed && !self.settings.is_unpaced
    }
}

/// A target of the service, under its name.
#[derive(Debug, Clone, PartialEq)]
pub struct NamedTarget {
    pub name: String,
    pub target: Target,
}

/// Reads `NAME=serial:PATH` or `NAME=tcp:HOST:PORT`, followed by settings: `,baud=9600,format=7e2`.
impl FromStr for NamedTarget {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (name, rest) = text.split_once('=').ok_or_else(|| {
            format!(
                "`{text}` is not a target; write `NAME=serial:/dev/ttyUSB0,baud=9600` or `NAME=tcp:HOST:PORT`"
            )
        })?;
        let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.".contains(c);
        if name.is_empty() || name.len() > MOST_NAME || !name.chars().all(is_plain) {
            return Err(format!(
                "`{name}` is not a name of a target; use at most {MOST_NAME} letters, digits, `-`, `_` and `.`"
            ));
        }
        let in_target = |error: String| format!("target `{name}`: {error}");
        let mut parts = rest.split(',');
        let address = match parts.next().and_then(|address| address.split_once(':')) {
            Some(("serial", path)) if !path.is_empty() => Address::Serial(path.to_owned()),
            Some(("tcp", address)) if has_port(address) => Address::Tcp(address.to_owned()),
            _ => {
                return Err(in_target("the address is neither `serial:PATH` nor `tcp:HOST:PORT`".to_owned()));
            }
        };
        let mut settings = Settings::default();
        for part in parts {
            let (key, value) = part.split_once('=').ok_or_else(|| {
                in_target(format!("`{part}` is not a setting; write `NAME=VALUE`, such as `baud=9600`"))
            })?;
            settings.set(key, value).map_err(|error| in_target(format!("{key}: {error}")))?;
        }
        let target = Target { address, settings };
        target.check().map_err(in_target)?;
        Ok(Self { name: name.to_owned(), target })
    }
}

/// Whether the text ends with a port.
pub fn has_port(address: &str) -> bool {
    address.rsplit_once(':').is_some_and(|(host, port)| !host.is_empty() && port.parse::<u16>().is_ok())
}

/// Why nothing was sent.
#[derive(Debug, thiserror::Error)]
pub enum SendError {
    #[error(transparent)]
    Tape(#[from] TapeError),
    #[error(
        "{address} cannot be opened: {error}; check the address, the right to open it, and that no other program \
         uses it"
    )]
    Open { address: Address, error: io::Error },
}

/// Makes the sender of a program.
///
/// # Errors
/// When the line to the target cannot carry the program.
pub fn sender(program: &[u8], target: &Target) -> Result<Box<dyn Sender>, TapeError> {
    let settings = &target.settings;
    Ok(match settings.flow {
        Flow::Grbl => Box::new(Grbl::new(grbl::program(program)?, settings, target.is_paced())),
        Flow::None | Flow::XonXoff | Flow::RtsCts => {
            Box::new(Handshake::new(Tape::new(program, settings)?, settings, target.is_paced()))
        }
    })
}

/// Opens the line to a target and lets `sender` send. Blocks until the sending has ended.
///
/// # Errors
/// When the line cannot be opened. The outcome tells of failures that happen later.
pub fn send_by(
    sender: &mut dyn Sender,
    target: &Target,
    stop: &Stop,
    observe: &mut dyn FnMut(&Progress),
) -> Result<Outcome, SendError> {
    let Target { address, settings } = target;
    let opened: io::Result<Box<dyn Line>> = match address {
        Address::Serial(path) => Serial::open(path, settings).map(|line| Box::new(line) as _),
        Address::Tcp(address) => Tcp::open(address, settings).map(|line| Box::new(line) as _),
    };
    let mut line = opened.map_err(|error| SendError::Open { address: address.clone(), error })?;
    Ok(run(&mut *line, sender, stop, observe))
}

/// Sends a program to a target. Blocks until the sending has ended.
///
/// # Errors
/// When nothing was sent: the line cannot carry the program, or cannot be opened.
pub fn send(
    program: &[u8],
    target: &Target,
    stop: &Stop,
    observe: &mut dyn FnMut(&Progress),
) -> Result<Outcome, SendError> {
    send_by(&mut *sender(program, target)?, target, stop, observe)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_target_is_a_name_an_address_and_settings() {
        let read = |text: &str| text.parse::<NamedTarget>();
        let lathe = read("lathe-1=serial:/dev/ttyUSB0,baud=4800,format=7e1,flow=xon-xoff").expect("a target");
        assert_eq!((lathe.name.as_str(), lathe.target.settings.baud()), ("lathe-1", 4800));
        assert_eq!(lathe.target.address.to_string(), "serial:/dev/ttyUSB0");
        assert!(lathe.target.is_paced());
        let mill = read("mill=tcp:[::1]:4001").expect("a target");
        assert_eq!(mill.target.address, Address::Tcp("[::1]:4001".to_owned()));
        assert!(!mill.target.is_paced());
        assert!(read("mill=tcp:box:4001,baud=9600").expect("a target").target.is_paced());
        assert!(!read("mill=serial:/dev/ttyACM0,unpaced=true").expect("a target").target.is_paced());
        for (wrong, word) in [
            ("lathe", "NAME=serial"),
            ("a b=serial:/dev/ttyS0", "name"),
            ("a=usb:/dev/ttyS0", "serial:PATH"),
            ("a=tcp:box", "HOST:PORT"),
            ("a=tcp::4001", "HOST:PORT"),
            ("a=serial:/dev/ttyS0,bauds=9600", "`bauds`"),
            ("a=serial:/dev/ttyS0,baud=fast", "`fast`"),
            ("a=serial:/dev/ttyS0,baud", "`baud`"),
            ("a=tcp:box:1,flow=rts-cts", "no RTS and CTS"),
            ("a=serial:/dev/ttyS0,flow=grbl,leader=5", "NUL"),
        ] {
            let error = read(wrong).expect_err("not a target");
            assert!(error.contains(word), "{wrong}: {error}");
        }
    }
}
