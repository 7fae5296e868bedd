//! The real program: how it ends, its health check, its address and its contract.

use std::io::Write;
use std::net::{SocketAddr, TcpStream};
use std::process::Command;
use std::time::{Duration, Instant};

use super::binary::Program;
use super::support::{MILL, connect, post_head, read_answer, write};

/// Time after the signal within which the requests of a try are sent. The program takes them for half a
/// second.
const IN_TIME: Duration = Duration::from_millis(400);

#[test]
fn requests_that_have_begun_before_the_program_is_terminated_are_answered() {
    // A busy machine delays some of the tries, which then tell nothing.
    assert!((0..20).any(|_| are_answered_in_time()), "no try sent its requests in time");
}

/// Terminates a program amid requests and fails unless they are answered. False if this side was late.
fn are_answered_in_time() -> bool {
    let mut program = Program::start(&["--workers", "1"]);
    let mut kept_alive = connect(program.address);
    write(&mut kept_alive, "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n");
    let answer = read_answer(&mut kept_alive).expect("an answer").to_ascii_lowercase();
    assert!(!answer.contains("connection: close"));

    let mut in_its_body = connect(program.address);
    write(&mut in_its_body, &format!("{}{{", post_head(MILL, 3)));
    let mut in_its_headers = connect(program.address);
    write(&mut in_its_headers, "GET /livez HT");
    let mut silent = connect(program.address);
    std::thread::sleep(Duration::from_millis(100));
    let terminated = Instant::now();
    program.terminate();
    let Ok(mut just_in_time) = TcpStream::connect(program.address) else {
        assert!(terminated.elapsed() > IN_TIME, "the program takes no connection");
        return false;
    };
    just_in_time.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
    while !is_draining(program.address) {
        if terminated.elapsed() > IN_TIME {
            return false;
        }
        std::thread::sleep(Duration::from_millis(10));
    }

    for (stream, text) in [
        (&mut silent, "GET /readyz HTTP/1.1\r\nHost: here\r\n\r\n"),
        (&mut just_in_time, "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n"),
        (&mut kept_alive, "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n"),
        (&mut in_its_headers, "TP/1.1\r\nHost: here\r\n\r\n"),
    ] {
        // What is sent too late may find its connection closed.
        let sent = stream.write_all(text.as_bytes());
        if terminated.elapsed() > IN_TIME {
            return false;
        }
        sent.expect("the request can be written");
    }
    let answer = read_answer(&mut silent).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("connection: close"), "{answer}");
    let answer = read_answer(&mut just_in_time).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("connection: close"), "{answer}");
    let answer = read_answer(&mut kept_alive).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("connection: close"), "{answer}");
    assert!(read_answer(&mut in_its_headers).expect("an answer").starts_with("HTTP/1.1 200"));

    // This is longer than idle connections are kept after termination.
    std::thread::sleep(Duration::from_millis(1200));
    write(&mut in_its_body, " }");
    let answer = read_answer(&mut in_its_body).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 422") && answer.contains("connection: close"), "{answer}");
    assert_eq!(program.exit_code(), Some(0));
    true
}

/// Whether the program says that it takes no further requests.
fn is_draining(address: SocketAddr) -> bool {
    let Ok(mut stream) = TcpStream::connect(address) else { return false };
    let ask = b"GET /readyz HTTP/1.1\r\nHost: here\r\nConnection: close\r\n\r\n";
    stream.set_read_timeout(Some(Duration::from_secs(20))).expect("a timeout");
    stream.write_all(ask).is_ok()
        && read_answer(&mut stream).is_some_and(|answer| answer.starts_with("HTTP/1.1 503"))
}

#[test]
fn an_idle_program_ends_within_three_seconds() {
    // A busy machine delays some of the tries, and a program that waits of itself waits in all.
    let mut tries = (0..5).map(|_| {
        let mut program = Program::start(&["--workers", "1"]);
        let _idle = connect(program.address);
        let started = Instant::now();
        program.terminate();
        assert_eq!(program.exit_code(), Some(0));
        started.elapsed()
    });
    assert!(tries.any(|took| took < Duration::from_secs(3)), "it ended later each time");
}

#[test]
fn the_healthcheck_command_succeeds_only_if_the_service_answers() {
    let program = Program::start(&["--workers", "1"]);
    let healthcheck = |address: &str| {
        let arguments = ["healthcheck", "--listen", address];
        Command::new(env!("CARGO_BIN_EXE_toolpathd")).args(arguments).status().expect("a status").success()
    };
    assert!(healthcheck(&program.address.to_string()));
    assert!(healthcheck(&format!("0.0.0.0:{}", program.address.port())));
    assert!(healthcheck(&format!("[::ffff:0.0.0.0]:{}", program.address.port())));
    drop(program);
    assert!(!healthcheck("127.0.0.1:9"));
    let program = Program::start(&["--listen", "[::]:0", "--allow-public"]);
    let port = program.address.port();
    assert!(healthcheck(&format!("[::]:{port}")) && healthcheck(&format!("[::1]:{port}")));
}

#[test]
fn a_public_address_is_refused_without_allow_public() {
    for address in ["0.0.0.0:0", "[::]:0"] {
        let output = Command::new(env!("CARGO_BIN_EXE_toolpathd"))
            .args(["--listen", address])
            .output()
            .expect("the program starts");
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            said.contains(address) && said.contains("--allow-public"),
            "the message does not help: {said}"
        );
    }
}

#[test]
fn the_openapi_command_prints_the_contract() {
    let output =
        Command::new(env!("CARGO_BIN_EXE_toolpathd")).arg("openapi").output().expect("the program starts");
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), toolpathd_server::http::contract());
}
