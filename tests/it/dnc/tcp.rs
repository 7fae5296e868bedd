//! Sending to a device server over TCP.

use std::io::{Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use toolpathd_server::dnc::{Address, Delivery, Failure, Left, Outcome, Stop, Target, send};

use super::mock::{program, settings, tape};

/// A device server that takes one connection and lets `serve` have it.
fn server<T: Send + 'static>(
    serve: impl FnOnce(TcpStream) -> T + Send + 'static,
) -> (SocketAddr, JoinHandle<T>) {
    let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
    let address = listener.local_addr().expect("an address");
    let thread = std::thread::spawn(move || serve(listener.accept().expect("a connection").0));
    (address, thread)
}

fn send_to(address: SocketAddr, program: &[u8], list: &str) -> Outcome {
    let target = Target { address: Address::Tcp(address.to_string()), settings: settings(list) };
    send(program, &target, &Stop::default(), &mut |_| {}).expect("the connection opens")
}

#[test]
fn a_peer_that_closes_after_the_end_has_received_everything() {
    let program = program(5000);
    let (address, thread) = server(|mut stream| {
        let mut received = Vec::new();
        stream.read_to_end(&mut received).expect("the program");
        received
    });
    let outcome = send_to(address, &program, "leader=3");
    assert_eq!((outcome.failure, outcome.left), (None, Left::Whole));
    assert_eq!(outcome.delivery, Some(Delivery::PeerClosed));
    assert!(thread.join().expect("no panic") == tape(3, &program), "the program arrived changed");
}

#[test]
fn a_peer_that_stays_open_has_confirmed_nothing() {
    let (address, thread) = server(|mut stream| {
        let mut received = [0; 6];
        stream.read_exact(&mut received).expect("the program");
        (received, stream)
    });
    let begun = Instant::now();
    let outcome = send_to(address, b"G0\n", "marks=as-is leader=3 patience=1");
    assert_eq!((outcome.failure, outcome.delivery), (None, Some(Delivery::HandedOver)));
    assert!(begun.elapsed() >= Duration::from_secs(1), "it waited for {:?} only", begun.elapsed());
    let (received, _still_open) = thread.join().expect("no panic");
    assert_eq!(&received, b"\0\0\0G0\n");
}

#[test]
fn xoff_in_the_stream_holds_a_paced_sender_within_64_characters() {
    let program = program(60);
    let (address, thread) = server(|mut stream| {
        let (mut received, mut part) = (Vec::new(), [0; 64]);
        while received.len() < 500 {
            let count = stream.read(&mut part).expect("characters");
            received.extend_from_slice(&part[..count]);
        }
        // What has come already is not late, also where a busy machine has kept this side from reading.
        stream.set_nonblocking(true).expect("a socket");
        while let Ok(count @ 1..) = stream.read(&mut part) {
            received.extend_from_slice(&part[..count]);
        }
        stream.set_nonblocking(false).expect("a socket");
        stream.write_all(b"\x13").expect("the sender listens");
        stream.set_read_timeout(Some(Duration::from_millis(700))).expect("a timeout");
        let begun = Instant::now();
        let mut n_late = 0;
        while begun.elapsed() < Duration::from_secs(1) {
            let count = stream.read(&mut part).unwrap_or(0);
            n_late += count;
            received.extend_from_slice(&part[..count]);
        }
        stream.write_all(b"\x11").expect("the sender listens");
        stream.set_read_timeout(None).expect("no timeout");
        stream.read_to_end(&mut received).expect("the rest");
        (received, n_late)
    });
    let outcome = send_to(address, &program, "baud=4800 leader=0");
    let (received, n_late) = thread.join().expect("no panic");
    assert!(received == tape(0, &program), "the program arrived changed");
    assert!(n_late <= 64, "{n_late} characters after XOFF");
    assert_eq!((outcome.failure, outcome.n_pauses), (None, 1));
}

#[test]
fn a_peer_that_goes_away_ends_the_sending() {
    let (address, thread) = server(|mut stream| {
        let mut part = [0; 300];
        stream.read_exact(&mut part).expect("characters");
    });
    let outcome = send_to(address, &program(2000), "baud=19200 leader=0");
    thread.join().expect("no panic");
    assert!(matches!(outcome.failure, Some(Failure::Disconnected(_))), "{outcome:?}");
    assert!(matches!(outcome.left, Left::HalfBlock { .. }), "{outcome:?}");
    let closed = TcpListener::bind("127.0.0.1:0").expect("a port").local_addr().expect("an address");
    let target = Target { address: Address::Tcp(closed.to_string()), settings: settings("") };
    let error = send(b"G0\n", &target, &Stop::default(), &mut |_| {}).expect_err("nobody listens");
    assert!(error.to_string().contains(&closed.to_string()), "{error}");
}
