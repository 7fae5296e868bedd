//! The state of the machine in a status report of GRBL: `<Hold:0|MPos:0.000,0.000,0.000|FS:0,0>`.
//!
//! # Reference
//! The wiki of GRBL 1.1, page *Grbl v1.1 Interface*, section *Real-time Status Reports*. `Tool` is a state of
//! grblHAL: the machine waits for a tool that its operator changes.

/// What a machine that answers no line is doing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// At rest, with nothing to do: a dwell is told so, too.
    Idle,
    /// An axis moves.
    Moving,
    /// The machine waits for its operator: at M0, after a feed hold, or at an open door.
    Paused,
    Alarm,
    /// Asleep until a reset.
    Sleep,
    /// Another state, such as the check mode.
    Other,
}

impl State {
    /// The state of a status report; `None` for another answer.
    pub fn read(answer: &str) -> Option<Self> {
        let report = answer.strip_prefix('<')?;
        let end = report.find(['|', ':', ',', '>']).unwrap_or(report.len());
        Some(match &report[..end] {
            "Idle" => Self::Idle,
            "Run" | "Jog" | "Home" => Self::Moving,
            "Hold" | "Door" | "Tool" => Self::Paused,
            "Alarm" => Self::Alarm,
            "Sleep" => Self::Sleep,
            _ => Self::Other,
        })
    }

    /// The state in the words of GRBL.
    pub fn name(self) -> &'static str {
        match self {
            Self::Idle => "Idle",
            Self::Moving => "Run",
            Self::Paused => "Hold",
            Self::Alarm => "Alarm",
            Self::Sleep => "Sleep",
            Self::Other => "another state",
        }
    }
}

/// Whether an answer says that no axis moves.
pub fn is_at_rest(answer: &str) -> bool {
    ["<Idle", "<Hold:0", "<Alarm", "<Door:0", "<Door:1", "<Tool", "<Sleep", "<Check", "ALARM:"]
        .iter()
        .any(|state| answer.starts_with(state))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_report_begins_with_its_state() {
        for (answer, state) in [
            ("<Idle|MPos:0.000,0.000,0.000|FS:0,0>", Some(State::Idle)),
            ("<Hold:1|WPos:0,0,0>", Some(State::Paused)),
            ("<Door:3>", Some(State::Paused)),
            ("<Run,MPos:0.000,0.000,0.000>", Some(State::Moving)),
            ("<Alarm>", Some(State::Alarm)),
            ("<Check|FS:0,0>", Some(State::Other)),
            ("<Idler>", Some(State::Other)),
            ("ok", None),
            ("[MSG:<Idle>]", None),
        ] {
            assert_eq!(State::read(answer), state, "{answer}");
        }
    }

    #[test]
    fn a_machine_that_slows_down_is_not_at_rest() {
        for (answer, is_still) in [
            ("<Hold:0|>", true),
            ("<Hold:1|>", false),
            ("<Door:1|>", true),
            ("<Door:2|>", false),
            ("<Run|>", false),
        ] {
            assert_eq!(is_at_rest(answer), is_still, "{answer}");
        }
    }
}
