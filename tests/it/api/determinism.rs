//! The same request gives the same bytes: when it is repeated, sent at the same time by several callers,
//! after a restart, and on any number of threads.

use std::net::SocketAddr;
use std::thread;

use super::binary::Program;
use super::support::{MILL, connect, read_answer, write};

const JOB: &str = include_str!("../../../openapi/examples/surfaces-mill/freeform.json");
const FORMATS: [&str; 4] = ["json", "gcode", "svg", "html"];
const CALLERS: usize = 4;
const REPEATS: usize = 3;

/// The answers to the job in all formats, without the id of the request.
fn bodies(address: SocketAddr, caller: &str) -> Vec<String> {
    let mut stream = connect(address);
    let mut answered = |format: &str| {
        let id = format!("id-of-{caller}-{format}");
        let head = format!("POST {MILL}?format={format} HTTP/1.1\r\nHost: here\r\nX-Request-Id: {id}\r\n");
        write(&mut stream, &format!("{head}Content-Length: {}\r\n\r\n{JOB}", JOB.len()));
        let answer = read_answer(&mut stream).expect("an answer");
        assert!(answer.starts_with("HTTP/1.1 200"), "{answer}");
        let (_, body) = answer.split_once("\r\n\r\n").expect("a body");
        body.replace(&id, "")
    };
    FORMATS.map(&mut answered).into()
}

#[test]
fn the_same_request_gives_the_same_bytes_after_a_restart_and_on_any_number_of_threads() {
    let expected = bodies(Program::start(&["--workers", "1"]).address, "first");
    let program = Program::start(&["--workers", "2"]);
    let address = program.address;
    thread::scope(|scope| {
        for caller in 0..CALLERS {
            let expected = &expected;
            scope.spawn(move || {
                for repeat in 0..REPEATS {
                    assert!(
                        bodies(address, &format!("{caller}-{repeat}")) == *expected,
                        "caller {caller} got other bytes"
                    );
                }
            });
        }
    });
}
