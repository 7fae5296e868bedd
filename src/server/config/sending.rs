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
    fn flags_name_the_line_the_handshake_and_the_tape() {
        let all = "--port /dev/ttyUSB0 --baud 4800 --format 7e1 --flow xon-xoff --unpaced --ends crlf --marks as-is \
                   --leader 7 --trailer 9 --wait-for-xon --patience 30 part.nc";
        let target = sending(all).expect("flags").target().expect("a target");
        let mut settings = Settings::default();
        for (name, value) in Settings::NAMES
            .iter()
            .zip(["4800", "7e1", "xon-xoff", "true", "crlf", "as-is", "7", "9", "true", "30"])
        {
            settings.set(name, value).expect("a legal value");
        }
        assert_eq!(target, Target { address: Address::Serial("/dev/ttyUSB0".to_owned()), settings });
        let short = sending("--tcp box:4001 part.nc").expect("flags").target().expect("a target");
        assert_eq!(short.settings, Settings::default());
    }

    #[test]
    fn a_line_is_needed_and_flags_that_contradict_each_other_are_refused() {
        for wrong in
            ["part.nc", "--port a --tcp b:1 part.nc", "--tcp b part.nc", "--port a", "--port a --flow dtr x"]
        {
            assert!(sending(wrong).is_err(), "{wrong}");
        }
        assert!(sending("--tcp b:1 --flow rts-cts x").expect("flags").target().is_err());
    }
}
