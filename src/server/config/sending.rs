//! The arguments of `toolpathd dnc send`.

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;

use crate::dnc::settings::{baud, feed, patience};
use crate::dnc::target::has_port;
use crate::dnc::{Address, Ends, Flow, Format, Marks, Settings, Target};

/// A program, and where it is sent to.
#[derive(Debug, Clone, Args)]
pub struct Sending {
    /// The program; `-` reads standard input
    pub file: PathBuf,

    /// Serial device, such as `/dev/ttyUSB0`
    #[arg(long, conflicts_with = "tcp", required_unless_present = "tcp")]
    port: Option<String>,

    /// Device server, such as `192.168.0.5:4001`
    #[arg(long, value_parser = host_and_port)]
    tcp: Option<String>,

    /// Bits a second [default: 9600; 115200 with `--flow grbl`]; over TCP the sender has no
    /// pace unless this is given
    #[arg(long, value_parser = baud)]
    baud: Option<u32>,

    /// Data bits, parity and stop bits [default: 7e2; 8n1 with `--flow grbl`]
    #[arg(long)]
    format: Option<Format>,

    /// How the control holds up the sender: `xon-xoff`, `rts-cts`, `grbl` or `none`
    #[arg(long, default_value_t = Settings::default().flow)]
    flow: Flow,

    /// Leave the pace to the line instead of the baud rate, for USB and pseudo terminals
    #[arg(long)]
    unpaced: bool,

    /// How lines end: `as-is`, `lf` or `crlf`
    #[arg(long, default_value_t = Settings::default().ends)]
    ends: Ends,

    /// Whether a missing `%` is added at the start and at the end: `add` or `as-is`
    #[arg(long, default_value_t = Settings::default().marks)]
    marks: Marks,

    /// Number of NUL characters before the program [default: 50; 0 with `--flow grbl`]
    #[arg(long, value_parser = feed)]
    leader: Option<u32>,

    /// Number of NUL characters after the program
    #[arg(long, value_parser = feed, default_value_t = Settings::default().trailer)]
    trailer: u32,

    /// Wait for an XON of the control before the first character
    #[arg(long)]
    wait_for_xon: bool,

    /// Longest time in which the control takes nothing, in seconds; then the sending ends
    #[arg(long, value_parser = patience, default_value = "600")]
    patience: Duration,

    /// Send nothing; tell how long the sending would take
    #[arg(long)]
    pub estimate: bool,
}

impl Sending {
    /// Where the program is sent to, and how.
    ///
    /// # Errors
    /// A message for people that names the flags which contradict each other.
    pub fn target(&self) -> Result<Target, String> {
        let address = match (&self.port, &self.tcp) {
            (Some(path), _) => Address::Serial(path.clone()),
            (None, address) => Address::Tcp(address.clone().unwrap_or_default()),
        };
        let settings = Settings {
            flow: self.flow,
            baud: self.baud,
            format: self.format,
            is_unpaced: self.unpaced,
            ends: self.ends,
            marks: self.marks,
            leader: self.leader,
            trailer: self.trailer,
            waits_for_xon: self.wait_for_xon,
            patience: self.patience,
        };
        let target = Target { address, settings };
        target.check()?;
        Ok(target)
    }
}

fn host_and_port(text: &str) -> Result<String, String> {
    if has_port(text) {
        Ok(text.to_owned())
    } else {
        Err(format!("`{text}` is not an address; write `HOST:PORT`, such as `192.168.0.5:4001`"))
    }
}

#[cfg(test)]
mod tests {
    use clap::Parser;
    use clap::error::ErrorKind;

    use super::*;
    use crate::config::{Cli, Command, Dnc};

    fn sending(flags: &str) -> Result<Sending, clap::Error> {
        let cli = Cli::try_parse_from(["toolpathd", "dnc", "send"].into_iter().chain(flags.split(' ')))?;
        match cli.command {
            Some(Command::Dnc(Dnc::Send(sending))) => Ok(sending),
            _ => unreachable!("another command"),
        }
    }

    #[test]
    fn each_flag_sets_the_setting_of_its_name_and_no_other() {
        let defaults = sending("--port /dev/ttyUSB0 part.nc").expect("flags").target().expect("a target");
        let serial = Address::Serial("/dev/ttyUSB0".to_owned());
        assert_eq!(defaults, Target { address: serial.clone(), settings: Settings::default() });
        let values: [&str; Settings::NAMES.len()] =
            ["4800", "7e1", "none", "true", "crlf", "as-is", "7", "9", "true", "30"];
        for (name, value) in Settings::NAMES.iter().zip(values) {
            let flag = if value == "true" { format!("--{name}") } else { format!("--{name} {value}") };
            let sending = sending(&format!("--port /dev/ttyUSB0 {flag} part.nc")).expect(name);
            let mut settings = Settings::default();
            settings.set(name, value).expect("a legal value");
            assert_ne!(settings, Settings::default(), "`{value}` is the default of {name}");
            let target = sending.target().expect("a target");
            assert_eq!(target, Target { address: serial.clone(), settings }, "{flag}");
        }
        let short = sending("--tcp box:4001 part.nc").expect("flags").target().expect("a target");
        let address = Address::Tcp("box:4001".to_owned());
        assert_eq!(short, Target { address, settings: Settings::default() });
    }

    #[test]
    fn a_line_is_needed_and_flags_that_contradict_each_other_are_refused() {
        for (wrong, kind) in [
            ("part.nc", ErrorKind::MissingRequiredArgument),
            ("--port a", ErrorKind::MissingRequiredArgument),
            ("--port a --tcp b:1 part.nc", ErrorKind::ArgumentConflict),
            ("--tcp b part.nc", ErrorKind::ValueValidation),
            ("--port a --flow dtr x", ErrorKind::ValueValidation),
        ] {
            assert_eq!(sending(wrong).expect_err(wrong).kind(), kind, "{wrong}");
        }
        let target = sending("--tcp b:1 --flow rts-cts x").expect("flags").target();
        assert!(target.expect_err("no wires over TCP").contains("no RTS and CTS"));
    }
}
