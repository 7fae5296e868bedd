//! A program at the full speed of a pseudo terminal.

use std::io::{ErrorKind, Read, Write};
use std::sync::Arc;
use std::time::{Duration, Instant};

use serialport::{SerialPort, TTYPort};
use toolpathd_server::dnc::{Address, Left, Stop, Target, send};

use super::mock::{program, settings, tape};

/// The reader checks every byte. Once in a megabyte it sends XOFF, waits, and sends XON.
#[test]
fn a_hundred_megabytes_at_full_speed_arrive_without_loss() {
    let block = program(40_000);
    // With its marks and without a leader the program goes out as it is.
    let expected = Arc::new(tape(0, &block.repeat(100_000_000 / block.len() + 1)));
    let program = Arc::clone(&expected);
    let (mut port, other_side) = TTYPort::pair().expect("a pair of pseudo terminals");
    let path = other_side.name().expect("a name");
    port.set_timeout(Duration::from_secs(10)).expect("a timeout");
    let n_bytes = expected.len();
    let reader = std::thread::spawn(move || {
        let mut part = vec![0; 64 * 1024];
        let (mut at, mut pause_at, mut n_pauses) = (0, 1_000_000, 0);
        while at < expected.len() {
            match port.read(&mut part) {
                Ok(count) => {
                    assert!(part[..count] == expected[at..at + count], "a byte differs after {at}");
                    at += count;
                }
                Err(error) if error.kind() == ErrorKind::TimedOut => panic!("nothing came after {at}"),
                Err(error) => panic!("{error}"),
            }
            if at >= pause_at {
                (pause_at, n_pauses) = (pause_at + 1_000_000, n_pauses + 1);
                port.write_all(b"\x13").expect("the sender listens");
                std::thread::sleep(Duration::from_millis(5));
                port.write_all(b"\x11").expect("the sender listens");
            }
        }
        // The sender may wait for its last characters to leave, so the port stays open until then.
        (n_pauses, port)
    });
    let target = Target { address: Address::Serial(path), settings: settings("unpaced=true leader=0") };
    let begun = Instant::now();
    let outcome = send(&program, &target, &Stop::default(), &mut |_| {}).expect("the port opens");
    let seconds = begun.elapsed().as_secs_f64();
    let (n_pauses, _port) = reader.join().expect("every byte arrives");
    assert_eq!((outcome.failure, outcome.left), (None, Left::Whole));
    assert_eq!(outcome.progress.n_characters, n_bytes);
    assert_eq!(n_pauses, n_bytes / 1_000_000);
    println!("{n_bytes} bytes in {seconds:.1} s, {n_pauses} pauses");
}
