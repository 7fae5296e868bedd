use proptest::prelude::*;

use super::*;

/// GRBL in simulated time: a receive buffer of 128 characters, which takes a line out of it now and then.
#[derive(Default)]
struct Mock {
    buffer: Vec<u8>,
    most_held: usize,
    lines: Vec<String>,
    answers: Vec<u8>,
    /// The number of the line that is refused, from 0.
    refused: Option<usize>,
    /// Commands, in order.
    commands: Vec<u8>,
    is_held: bool,
    /// What the machine says while it answers no line: from the line with this number on, for this time.
    pause: Option<(usize, Duration, &'static str)>,
    /// Whether it has started, and answers.
    is_awake: bool,
}

impl Mock {
    fn take(&mut self, bytes: &[u8]) {
        for byte in bytes {
            match *byte {
                STATUS | HOLD | RESET => {
                    self.commands.push(*byte);
                    match *byte {
                        STATUS if self.is_held => self.say("<Hold:0|MPos:0.000,0.000,0.000>"),
                        STATUS if self.pause.is_some_and(|(at, ..)| at == self.lines.len()) => {
                            let said = self.pause.map_or("", |(_, _, said)| said);
                            if !said.is_empty() {
                                self.say(said);
                            }
                        }
                        STATUS if self.is_awake => self.say("<Run|MPos:0.000,0.000,0.000>"),
                        HOLD => self.is_held = true,
                        RESET => {
                            self.buffer.clear();
                            self.say("");
                            self.say("Grbl 1.1h ['$' for help]");
                        }
                        _ => {}
                    }
                }
                byte => self.buffer.push(byte),
            }
        }
        self.most_held = self.most_held.max(self.buffer.len());
    }

    fn say(&mut self, answer: &str) {
        self.answers.extend_from_slice(answer.as_bytes());
        self.answers.extend_from_slice(b"\r\n");
    }

    /// Takes a line out of the buffer, if a whole one is there.
    fn run_line(&mut self) {
        let Some(end) = self.buffer.iter().position(|byte| *byte == b'\n') else { return };
        let line: Vec<u8> = self.buffer.drain(..=end).collect();
        let number = self.lines.len();
        self.lines.push(String::from_utf8_lossy(&line).trim_end().to_owned());
        // Data with the characters XON and XOFF. No XON follows the last XOFF.
        self.say("[MSG:\x11 pump \x13ok\x13]");
        if self.refused == Some(number) { self.say("error:20") } else { self.say("ok") }
    }
}

fn sender(text: &str) -> Grbl {
    let settings = Settings {
        flow: crate::dnc::settings::Flow::Grbl,
        patience: Duration::from_secs(30),
        ..Settings::default()
    };
    Grbl::new(program(text.as_bytes()).expect("a program"), &settings, true)
}

/// Lets `sender` send to `mock`, which takes a line each `interval`. Cancels after `cancel` lines.
fn simulate(sender: &mut Grbl, mock: &mut Mock, interval: Duration, cancel: Option<usize>) -> Outcome {
    let mut now = Duration::ZERO;
    let mut line_at = Duration::from_millis(100);
    for _ in 0..10_000_000 {
        if !mock.answers.is_empty() {
            let answers = std::mem::take(&mut mock.answers);
            answers.chunks(3).for_each(|part| sender.receive(part, now));
        }
        if cancel.is_some_and(|count| mock.lines.len() >= count) {
            sender.cancel(now);
        }
        match sender.next(now, 0) {
            Step::Write(bytes) => {
                mock.take(bytes);
                let count = bytes.len();
                sender.wrote(count, now);
            }
            Step::Wait(until) => {
                now = until.min(line_at).max(now + Duration::from_micros(100));
                if now >= line_at {
                    if !mock.is_held {
                        mock.run_line();
                    }
                    line_at = now + interval;
                    if let Some((_, time, _)) = mock.pause.filter(|(at, ..)| *at == mock.lines.len()) {
                        line_at = now + time;
                    }
                }
            }
            Step::Ended => return sender.outcome(now, 0),
        }
    }
    panic!("the sending does not end");
}

fn awake() -> Mock {
    Mock { is_awake: true, ..Mock::default() }
}

#[test]
fn a_board_that_restarts_is_waited_for_and_one_that_says_nothing_gets_nothing() {
    let mut sender = sender("G0 X1\n");
    let ms = Duration::from_millis;
    assert_eq!(sender.next(ms(0), 0), Step::Write(b"?"));
    sender.wrote(1, ms(0));
    assert_eq!(sender.next(ms(1), 0), Step::Wait(ms(1000)));
    sender.receive(b"\r\nGrbl 1.1h ['$' for help]\r\n", ms(900));
    assert_eq!(sender.next(ms(900), 0), Step::Write(b"G0 X1\n"));

    let mut alone = self::sender("G0 X1\n");
    let outcome = simulate(&mut alone, &mut Mock::default(), ms(10), None);
    assert_eq!((outcome.failure, outcome.left), (Some(Failure::NoGrbl), Left::Nothing));
}

#[test]
fn an_error_holds_resets_and_names_the_line_of_the_program() {
    let text = "(title)\nG0 X1\n\nG1 X2 F100 ; go\nG1 X3\nG1 X4\nM30\n";
    let mut mock = Mock { refused: Some(2), ..awake() };
    let outcome = simulate(&mut sender(text), &mut mock, Duration::from_millis(50), None);
    assert_eq!(outcome.failure, Some(Failure::Refused { line: 5, answer: "error:20".to_owned() }));
    assert_eq!(outcome.left, Left::Reset { is_confirmed: true });
    assert_eq!(mock.lines, ["G0 X1", "G1 X2 F100", "G1 X3"]);
    let commands = String::from_utf8(mock.commands).expect("ASCII");
    assert!(commands.starts_with('?') && commands.ends_with("!?\x18"), "{commands:?}");
}

#[test]
fn an_alarm_and_a_restart_end_the_sending() {
    for (said, failure) in [
        ("ALARM:2\r\n", Failure::Alarm { after_line: 1, answer: "ALARM:2".to_owned() }),
        ("Grbl 1.1h ['$' for help]\r\n", Failure::Restarted),
    ] {
        let mut sender = sender("G0 X1\nG0 X2\nG0 X3\n");
        let now = Duration::from_secs(1);
        sender.receive(b"<Idle|MPos:0,0,0>\r\n", now);
        assert!(matches!(sender.next(now, 0), Step::Write(b"G0 X1\n")));
        sender.wrote(6, now);
        assert!(matches!(sender.next(now, 0), Step::Write(b"G0 X2\n")));
        sender.wrote(6, now);
        sender.receive(b"ok\r\n", now);
        sender.receive(said.as_bytes(), now);
        match sender.next(now, 0) {
            Step::Write(bytes) => assert_eq!(bytes, b"!"),
            step => assert_eq!(step, Step::Ended),
        }
        assert_eq!(sender.failure, Some(failure));
    }
}

#[test]
fn a_machine_that_does_not_tell_of_its_rest_is_reset_after_a_while() {
    let mut sender = sender("G0 X1\n");
    let start = Duration::from_secs(1);
    sender.receive(b"<Idle>\r\n", start);
    assert!(matches!(sender.next(start, 0), Step::Write(b"G0 X1\n")));
    sender.wrote(6, start);
    sender.cancel(start);
    let (mut now, mut written) = (start, Vec::new());
    let outcome = loop {
        match sender.next(now, 0) {
            Step::Write(bytes) => {
                written.push(bytes[0]);
                sender.wrote(1, now);
            }
            Step::Wait(until) => now = until,
            Step::Ended => break sender.outcome(now, 0),
        }
    };
    assert_eq!((written.first(), written.last()), (Some(&HOLD), Some(&RESET)));
    assert!(now >= start + REST_LIMIT && now <= start + REST_LIMIT + RESET_LIMIT, "{now:?}");
    assert_eq!(outcome.left, Left::Reset { is_confirmed: false });
}

const HOUR: Duration = Duration::from_secs(3600);

#[test]
fn a_machine_that_says_that_it_pauses_or_moves_is_waited_for() {
    for said in ["<Hold:0|FS:0,0>", "<Hold:1|>", "<Door:1|>", "<Run|FS:100,0>", "<Tool|>"] {
        let mut mock = Mock { pause: Some((2, HOUR, said)), ..awake() };
        let text = "G0 X1\nG1 X2 F100\nM0\nG1 X3\nM30\n";
        let outcome = simulate(&mut sender(text), &mut mock, Duration::from_millis(50), None);
        assert_eq!((outcome.failure, outcome.left), (None, Left::Whole), "{said}");
        assert_eq!(mock.lines.len(), 5);
        // The machine is asked each second, and not more often.
        assert!((3590..=3602).contains(&mock.commands.len()), "{}", mock.commands.len());
        assert!(mock.commands.iter().all(|command| *command == STATUS));
    }
}

#[test]
fn an_idle_machine_is_waited_for_while_it_dwells_alone() {
    let idle = || Mock { pause: Some((1, HOUR, "<Idle|FS:0,0>")), ..awake() };
    let dwells = simulate(&mut sender("G0 X1\nG4 P3600\nM30\n"), &mut idle(), HOUR / 3600, None);
    assert_eq!((dwells.failure, dwells.left), (None, Left::Whole));
    let lost = simulate(&mut sender("G0 X1\nG1 X2 F100\nM30\n"), &mut idle(), HOUR / 3600, None);
    let time = Duration::from_secs(30);
    assert_eq!(lost.failure, Some(Failure::Stuck { line: 2, state: "Idle", time }));
    assert_eq!(lost.left, Left::Reset { is_confirmed: true });
}

#[test]
fn a_machine_that_answers_no_status_query_or_reports_an_alarm_is_reset() {
    let alarm = Failure::Alarm { after_line: 1, answer: "Alarm".to_owned() };
    for (said, failure) in [("", Failure::NoStatus(Duration::from_secs(30))), ("<Alarm|>", alarm)] {
        let mut mock = Mock { pause: Some((1, HOUR, said)), ..awake() };
        let outcome = simulate(&mut sender("G0 X1\nM0\nM30\n"), &mut mock, HOUR / 3600, None);
        assert_eq!(outcome.failure, Some(failure));
        assert_eq!(outcome.left, Left::Reset { is_confirmed: true });
    }
}

#[test]
fn a_setting_is_sent_alone() {
    let mut sender = sender("G0 X1\n$130=200\nG0 X2\n");
    let now = Duration::from_secs(1);
    sender.receive(b"<Idle>\r\n", now);
    for line in [b"G0 X1\n".as_slice(), b"$130=200\n", b"G0 X2\n"] {
        assert_eq!(sender.next(now, 0), Step::Write(line));
        sender.wrote(line.len(), now);
        assert!(matches!(sender.next(now, 0), Step::Wait(_)));
        sender.receive(b"ok\r\n", now);
    }
    assert_eq!(sender.next(now + Duration::from_secs(1), 0), Step::Ended);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Whatever the lines and the speeds are: the buffer never overruns, every line arrives once and in
    /// order, and the buffer is kept as full as the lines allow.
    #[test]
    fn the_buffer_never_overruns_and_no_line_is_lost(
        blocks in prop::collection::vec("[GXYZF][0-9.]{0,60}|\\$[0-9]{1,3}=[0-9]|G10L2P1X[0-9]", 1..60),
        interval in 1_u64..80,
    ) {
        let text = blocks.join("\r\n");
        let mut mock = awake();
        let outcome = simulate(&mut sender(&text), &mut mock, Duration::from_millis(interval), None);
        prop_assert_eq!(&outcome.failure, &None);
        prop_assert_eq!((outcome.left, outcome.delivery), (Left::Whole, Some(Delivery::Answered)));
        prop_assert_eq!(&mock.lines, &blocks);
        prop_assert!(mock.most_held < BUFFER, "{} characters in the buffer", mock.most_held);
        prop_assert_eq!(outcome.progress.n_lines, blocks.len());
    }

    /// A cancelled sending leaves no line in the buffer. The lines that were run are the first ones: those
    /// before the cancel, and perhaps one or two while the hold waits for the characters on their way.
    #[test]
    fn a_cancelled_sending_holds_and_resets(count in 1_usize..40, interval in 1_u64..50) {
        let blocks: Vec<String> = (0..50).map(|k| format!("G1 X{k}.125 Y{k}")).collect();
        let mut mock = awake();
        let outcome = simulate(&mut sender(&blocks.join("\n")), &mut mock, Duration::from_millis(interval), Some(count));
        prop_assert_eq!(outcome.failure, Some(Failure::Cancelled));
        prop_assert_eq!(outcome.left, Left::Reset { is_confirmed: true });
        let n_run = mock.lines.len();
        prop_assert!((count..=count + 2).contains(&n_run), "{} lines were run", n_run);
        prop_assert_eq!(&mock.lines, &blocks[..n_run]);
        prop_assert!(mock.buffer.is_empty());
    }
}
