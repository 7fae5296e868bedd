//! The real program: how it ends, its health check, its address and its contract.

use std::process::Command;
use std::time::{Duration, Instant};

use super::binary::Program;
use super::support::{MILL, connect, post_head, read_answer, write};

#[test]
fn requests_that_have_begun_before_the_program_is_terminated_are_answered() {
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
    program.terminate();
    let mut just_in_time = connect(program.address);
    std::thread::sleep(Duration::from_millis(100));

    write(&mut silent, "GET /readyz HTTP/1.1\r\nHost: here\r\n\r\n");
    let answer = read_answer(&mut silent).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 503") && answer.contains("connection: close"), "{answer}");
    write(&mut just_in_time, "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n");
    let answer = read_answer(&mut just_in_time).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("connection: close"), "{answer}");
    write(&mut kept_alive, "GET /livez HTTP/1.1\r\nHost: here\r\n\r\n");
    let answer = read_answer(&mut kept_alive).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 200") && answer.contains("connection: close"), "{answer}");
    write(&mut in_its_headers, "TP/1.1\r\nHost: here\r\n\r\n");
    assert!(read_answer(&mut in_its_headers).expect("an answer").starts_with("HTTP/1.1 200"));

    // This is longer than idle connections are kept after termination.
    std::thread::sleep(Duration::from_millis(1200));
    write(&mut in_its_body, " }");
    let answer = read_answer(&mut in_its_body).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 422") && answer.contains("connection: close"), "{answer}");
    assert_eq!(program.exit_code(), Some(0));
}

#[test]
fn an_idle_program_ends_within_three_seconds() {
    let mut program = Program::start(&["--workers", "1"]);
    let _idle = connect(program.address);
    let started = Instant::now();
    program.terminate();
    assert_eq!(program.exit_code(), Some(0));
    assert!(started.elapsed() < Duration::from_secs(3), "it ended only after {:?}", started.elapsed());
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
