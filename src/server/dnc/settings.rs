//! How a program is sent: the settings of the line, the handshake and the tape.

use std::fmt;
use std::str::FromStr;
use std::time::Duration;

use serde::Serialize;
use utoipa::ToSchema;

use super::format::Format;

/// Number of NUL characters before the program. They keep the line busy while the control's reader gets
/// ready; a control skips everything before the first `%`. 50 take 57 ms at 9600 baud in 7E2.
const LEADER: u32 = 50;

/// Most characters of leader or trailer. More than 6 m of paper tape would be a slip of the finger.
const MOST_FEED: u32 = 2500;

/// Longest silence of a control: a long cut, or a stop by the operator.
const PATIENCE: Duration = Duration::from_secs(600);

/// The speeds in bits a second that are accepted. Speeds of machine controls are 4800 to 115200.
const SPEEDS: std::ops::RangeInclusive<u32> = 50..=4_000_000;

/// How a control holds up the sender.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = FlowName)]
pub enum Flow {
    /// Not at all: the control takes everything at the speed of the line.
    None,
    /// By the characters XOFF (0x13) and XON (0x11).
    XonXoff,
    /// By the wires RTS and CTS, in the hardware of the port.
    RtsCts,
    /// By the answer of GRBL to each line.
    Grbl,
}

/// How lines end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, ToSchema)]
#[serde(rename_all = "snake_case")]
#[schema(as = EndsName)]
pub enum Ends {
    AsIs,
    Lf,
    #[serde(rename = "crlf")]
    CrLf,
}

/// Whether a program without `%` at its start and end gets them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marks {
    Add,
    AsIs,
}

/// A setting with a closed list of values.
trait Named: Copy + PartialEq + 'static {
    const NAMES: &'static [(&'static str, Self)];

    fn of(text: &str) -> Result<Self, String> {
        let found = Self::NAMES.iter().find(|(name, _)| *name == text);
        found.map(|(_, value)| *value).ok_or_else(|| {
            let names: Vec<&str> = Self::NAMES.iter().map(|(name, _)| *name).collect();
            format!("`{text}` is unknown; use one of `{}`", names.join("`, `"))
        })
    }

    fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, value)| *value == self).map_or("", |(name, _)| name)
    }
}

impl Named for Flow {
    const NAMES: &'static [(&'static str, Self)] =
        &[("xon-xoff", Self::XonXoff), ("rts-cts", Self::RtsCts), ("grbl", Self::Grbl), ("none", Self::None)];
}

impl Named for Ends {
    const NAMES: &'static [(&'static str, Self)] =
        &[("as-is", Self::AsIs), ("lf", Self::Lf), ("crlf", Self::CrLf)];
}

impl Named for Marks {
    const NAMES: &'static [(&'static str, Self)] = &[("add", Self::Add), ("as-is", Self::AsIs)];
}

macro_rules! text_of_names {
    ($($kind:ty),+) => {$(
        impl FromStr for $kind {
            type Err = String;

            fn from_str(text: &str) -> Result<Self, String> {
                Self::of(text)
            }
        }

        impl fmt::Display for $kind {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.name())
            }
        }
    )+};
}

text_of_names!(Flow, Ends, Marks);

/// How a program is sent. `None` stands for the default, which depends on `flow`.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    pub flow: Flow,
    /// Bits a second.
    pub baud: Option<u32>,
    pub format: Option<Format>,
    /// Whether the sender leaves the pace to the line, as USB adapters and pseudo terminals do.
    pub is_unpaced: bool,
    pub ends: Ends,
    pub marks: Marks,
    /// Number of NUL characters before and after the program.
    pub leader: Option<u32>,
    pub trailer: u32,
    /// Whether the control starts the sender by XON.
    pub waits_for_xon: bool,
    /// How long the control may take nothing.
    pub patience: Duration,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            flow: Flow::XonXoff,
            baud: None,
            format: None,
            is_unpaced: false,
            ends: Ends::AsIs,
            marks: Marks::Add,
            leader: None,
            trailer: 0,
            waits_for_xon: false,
            patience: PATIENCE,
        }
    }
}

impl Settings {
    /// The names that [`Settings::set`] takes.
    pub const NAMES: [&'static str; 10] = [
        "baud",
        "format",
        "flow",
        "unpaced",
        "ends",
        "marks",
        "leader",
        "trailer",
        "wait-for-xon",
        "patience",
    ];

    /// Sets one setting by its name.
    ///
    /// # Errors
    /// A message for people when there is no such setting, or the value is not legal.
    pub fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        match name {
            "baud" => self.baud = Some(baud(value)?),
            "format" => self.format = Some(value.parse()?),
            "flow" => self.flow = value.parse()?,
            "unpaced" => self.is_unpaced = yes_or_no(value)?,
            "ends" => self.ends = value.parse()?,
            "marks" => self.marks = value.parse()?,
            "leader" => self.leader = Some(feed(value)?),
            "trailer" => self.trailer = feed(value)?,
            "wait-for-xon" => self.waits_for_xon = yes_or_no(value)?,
            "patience" => self.patience = patience(value)?,
            _ => {
                return Err(format!(
                    "there is no setting `{name}`; there are `{}`",
                    Self::NAMES.join("`, `")
                ));
            }
        }
        Ok(())
    }

    /// Bits a second: 9600 unless set, 115200 for GRBL.
    pub fn baud(&self) -> u32 {
        self.baud.unwrap_or(if self.flow == Flow::Grbl { 115_200 } else { 9600 })
    }

    /// The frame of a character: 7E2 unless set, 8N1 for GRBL.
    pub fn format(&self) -> Format {
        let seven_e_two =
            Format { has_seven_bits: true, parity: super::format::Parity::Even, has_two_stops: true };
        self.format.unwrap_or(if self.flow == Flow::Grbl { Format::EIGHT_N_ONE } else { seven_e_two })
    }

    /// Number of NUL characters before the program: 50 unless set, none for GRBL.
    pub fn leader(&self) -> u32 {
        self.leader.unwrap_or(if self.flow == Flow::Grbl { 0 } else { LEADER })
    }

    /// Characters a second.
    pub fn characters_per_s(&self) -> f64 {
        self.format().characters_per_s(self.baud())
    }

    /// Checks the rules that concern several settings together.
    ///
    /// # Errors
    /// A message for people that names the settings which contradict each other.
    pub fn check(&self) -> Result<(), String> {
        if self.flow == Flow::Grbl && self.format().has_seven_bits {
            return Err("GRBL reads 8 data bits; set `format` to `8n1`".to_owned());
        }
        if self.flow == Flow::Grbl && (self.leader() > 0 || self.trailer > 0) {
            return Err("GRBL takes no NUL characters; set `leader` and `trailer` to 0".to_owned());
        }
        if self.waits_for_xon && self.flow != Flow::XonXoff {
            return Err(format!("`wait-for-xon` needs `flow` `xon-xoff`, not `{}`", self.flow));
        }
        Ok(())
    }
}

/// Reads a speed in bits a second.
///
/// # Errors
/// A message for people when the text is no speed.
pub fn baud(text: &str) -> Result<u32, String> {
    let baud = text.parse().ok().filter(|baud| SPEEDS.contains(baud));
    baud.ok_or_else(|| format!("`{text}` is not a speed of {} to {} baud", SPEEDS.start(), SPEEDS.end()))
}

/// Reads a number of NUL characters.
///
/// # Errors
/// A message for people when the text is no such number.
pub fn feed(text: &str) -> Result<u32, String> {
    let count = text.parse().ok().filter(|count| *count <= MOST_FEED);
    count.ok_or_else(|| format!("`{text}` is not a number of NUL characters from 0 to {MOST_FEED}"))
}

/// Reads how long the control may take nothing, in seconds.
///
/// # Errors
/// A message for people when the text is no such time.
pub fn patience(text: &str) -> Result<Duration, String> {
    let seconds = text.parse().ok().filter(|seconds| (0.1..=86_400.0).contains(seconds));
    let seconds = seconds.ok_or_else(|| format!("`{text}` is not a time of 0.1 to 86400 s"))?;
    Ok(Duration::from_secs_f64(seconds))
}

fn yes_or_no(text: &str) -> Result<bool, String> {
    text.parse().map_err(|_| format!("`{text}` is neither `true` nor `false`"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_sets_a_setting_and_others_are_refused() {
        let values = ["4800", "7e1", "none", "true", "crlf", "as-is", "3", "7", "true", "2.5"];
        let mut settings = Settings::default();
        for (name, value) in Settings::NAMES.iter().zip(values) {
            let before = settings.clone();
            settings.set(name, value).expect("a legal value");
            assert_ne!(settings, before, "{name} sets nothing");
            let refused = settings.set(name, "?").expect_err("not legal");
            assert!(refused.contains("`?`"), "{refused}");
        }
        assert_eq!((settings.baud(), settings.leader(), settings.trailer), (4800, 3, 7));
        assert_eq!((settings.format().to_string().as_str(), settings.patience.as_millis()), ("7e1", 2500));
        let unknown = settings.set("bauds", "9600").expect_err("unknown");
        assert!(unknown.contains("`bauds`") && unknown.contains("`wait-for-xon`"), "{unknown}");
        for (name, value) in [("baud", "0"), ("leader", "2501"), ("patience", "nan"), ("patience", "0")] {
            assert!(settings.set(name, value).is_err(), "{name}={value}");
        }
    }

    #[test]
    fn defaults_are_those_of_a_tape_control_or_of_grbl() {
        let tape = Settings::default();
        assert_eq!((tape.baud(), tape.format().to_string().as_str(), tape.leader()), (9600, "7e2", 50));
        assert_eq!(tape.check(), Ok(()));
        let grbl = Settings { flow: Flow::Grbl, ..Settings::default() };
        assert_eq!((grbl.baud(), grbl.format().to_string().as_str(), grbl.leader()), (115_200, "8n1", 0));
        assert_eq!(grbl.check(), Ok(()));
    }

    #[test]
    fn settings_that_contradict_each_other_are_refused() {
        for list in ["flow=grbl format=7e1", "flow=grbl leader=1", "flow=none wait-for-xon=true"] {
            let mut settings = Settings::default();
            for pair in list.split(' ') {
                let (name, value) = pair.split_once('=').expect("a pair");
                settings.set(name, value).expect("a legal value");
            }
            assert!(settings.check().is_err(), "{list}");
        }
    }
}
