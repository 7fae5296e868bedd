//! The handshake by XON and XOFF on a pseudo terminal, at 4800 baud in 7E2: 436 characters a second.

use std::time::Duration;

use toolpathd_server::dnc::{Delivery, Failure, Left, Outcome, Progress, Stop, send};

use super::mock::{Control, Habits, Seen, program, tape};

const SETTINGS: &str = "baud=4800 format=7e2 leader=20";

fn send_to(habits: Habits, program: &[u8], list: &str) -> (Outcome, Seen) {
    let control = Control::start(habits);
    let target = control.target(list);
    let outcome = send(program, &target, &Stop::default(), &mut |_| {}).expect("the port opens");
    (outcome, control.end())
}

/// Checks that nothing was lost, doubled or too much.
fn assert_whole(outcome: &Outcome, seen: &Seen, tape: &[u8]) {
    assert_eq!(outcome.failure, None);
    assert_eq!((outcome.left, outcome.delivery), (Left::Whole, Some(Delivery::Transmitted)));
    assert!(seen.received == tape, "{} characters instead of {}", seen.received.len(), tape.len());
    assert!(seen.most_held <= 256, "the buffer overran: {} characters", seen.most_held);
    assert!(seen.most_after_off <= 64, "{} characters after XOFF", seen.most_after_off);
    assert_eq!(outcome.progress.n_lines, outcome.progress.n_lines_total);
    assert_eq!(outcome.progress.n_characters, tape.len());
}

#[test]
fn a_slow_control_holds_up_the_sender_and_is_never_overrun() {
    let program = program(70);
    let (outcome, seen) = send_to(Habits { rate: 250.0, ..Habits::STEADY }, &program, SETTINGS);
    assert_whole(&outcome, &seen, &tape(20, &program));
    assert!(seen.n_offs >= 3 && outcome.n_pauses == seen.n_offs, "{} XOFFs, {outcome:?}", seen.n_offs);
    assert_eq!(outcome.n_received, 2 * seen.n_offs);
}

#[test]
fn a_long_stop_in_mid_file_loses_nothing() {
    let program = program(60);
    let stop = Some((500, Duration::from_secs(3)));
    let mut waiting = 0;
    let control = Control::start(Habits { stop, ..Habits::STEADY });
    let target = control.target(SETTINGS);
    let mut count = |progress: &Progress| waiting += usize::from(progress.is_waiting);
    let outcome = send(&program, &target, &Stop::default(), &mut count).expect("the port opens");
    let seen = control.end();
    assert_whole(&outcome, &seen, &tape(20, &program));
    assert!(outcome.waited >= Duration::from_secs(2), "{:?}", outcome.waited);
    assert!(waiting > 10, "the wait was told {waiting} times only");
}

#[test]
fn a_control_that_takes_nothing_ends_the_sending_after_the_patience() {
    let stop = Some((300, Duration::from_secs(60)));
    let list = format!("{SETTINGS} patience=1");
    let (outcome, seen) = send_to(Habits { stop, ..Habits::STEADY }, &program(60), &list);
    assert_eq!(outcome.failure, Some(Failure::Silent(Duration::from_secs(1))));
    assert!(seen.most_held <= 256 && seen.n_offs == 1, "{seen:?}");
    assert_eq!(outcome.progress.n_characters, seen.received.len());
    assert!(tape(20, &program(60)).starts_with(&seen.received));
}

#[test]
fn a_control_that_goes_away_in_mid_file_is_told_with_what_was_sent() {
    let program = program(60);
    let (outcome, seen) = send_to(Habits { vanish: Some(600), ..Habits::STEADY }, &program, SETTINGS);
    assert!(matches!(outcome.failure, Some(Failure::Disconnected(_))), "{outcome:?}");
    assert!(tape(20, &program).starts_with(&seen.received));
    // What was taken for certain has arrived. The rest was on its way.
    let n_taken = outcome.progress.n_characters;
    assert!(n_taken <= seen.received.len() && n_taken + 64 >= seen.received.len(), "{n_taken}");
    let whole = seen.received[..n_taken].iter().filter(|byte| **byte == b'\n').count() - 1;
    assert_eq!(outcome.progress.n_lines, whole);
    assert_eq!(outcome.left, Left::HalfBlock { line: whole + 1 });
}

#[test]
fn a_cancelled_sending_ends_with_a_whole_block_and_the_end_mark() {
    let program = program(60);
    let control = Control::start(Habits { rate: 2000.0, ..Habits::STEADY });
    let (target, stop) = (control.target(SETTINGS), Stop::default());
    let asked = stop.clone();
    let mut cancel = |progress: &Progress| {
        if progress.n_characters >= 400 {
            asked.at_block();
        }
    };
    let outcome = send(&program, &target, &stop, &mut cancel).expect("the port opens");
    let seen = control.end();
    let n_lines = outcome.progress.n_lines;
    assert_eq!(outcome.failure, Some(Failure::Cancelled));
    assert_eq!(outcome.left, Left::Blocks { line: n_lines, has_end_mark: true });
    let text = String::from_utf8(program).expect("ASCII");
    let blocks: String = text.split_inclusive('\n').take(n_lines).collect();
    assert_eq!(seen.received, tape(20, blocks.as_bytes()));
    assert!((400..600).contains(&seen.received.len()), "{}", seen.received.len());
}

#[test]
fn a_port_has_one_sender_at_a_time_and_another_program_after_it() {
    let control = Control::start(Habits { rate: 1e6, ..Habits::STEADY });
    let target = control.target("baud=115200 leader=0");
    let other = target.clone();
    let mut refused = None;
    let mut intrude = |_: &Progress| {
        if refused.is_none() {
            refused = Some(send(b"M30\n", &other, &Stop::default(), &mut |_| {}).is_err());
        }
    };
    let (first, second) = (program(100), program(7));
    assert_eq!(send(&first, &target, &Stop::default(), &mut intrude).expect("it opens").failure, None);
    assert_eq!(send(&second, &target, &Stop::default(), &mut |_| {}).expect("it opens").failure, None);
    assert_eq!(control.end().received, [tape(0, &first), tape(0, &second)].concat());
    assert_eq!(refused, Some(true), "a second sender got the same port");
}
