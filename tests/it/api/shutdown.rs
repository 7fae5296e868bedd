//! The end of the real program: nothing that has reached it is lost.

use std::process::Command;
use std::time::{Duration, Instant};

use super::binary::Program;
use super::support::{MILL, connect, post_head, read_answer, write};

#[test]
fn requests_under_way_are_answered_whole() {
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

    // Longer than any grace for the idle.
    std::thread::sleep(Duration::from_millis(1200));
    write(&mut in_its_body, " }");
    let answer = read_answer(&mut in_its_body).expect("an answer");
    assert!(answer.starts_with("HTTP/1.1 422") && answer.contains("connection: close"), "{answer}");
    assert_eq!(program.exit_code(), Some(0));
}

#[test]
fn an_idle_program_ends_soon() {
    let mut program = Program::start(&["--workers", "1"]);
    let _idle = connect(program.address);
    let started = Instant::now();
    program.terminate();
    assert_eq!(program.exit_code(), Some(0));
    assert!(started.elapsed() < Duration::from_secs(3));
}

#[test]
fn the_health_command_tells_health_by_its_exit_code() {
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
fn a_public_address_needs_allow_public() {
    for address in ["0.0.0.0:0", "[::]:0"] {
        let output = Command::new(env!("CARGO_BIN_EXE_toolpathd"))
            .args(["--listen", address])
            .output()
            .expect("it ends by itself");
        assert_eq!(output.status.code(), Some(1));
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(said.contains(address) && said.contains("--allow-public"), "{said}");
    }
}

#[test]
fn the_contract_is_printed() {
    let output = Command::new(env!("CARGO_BIN_EXE_toolpathd")).arg("openapi").output().expect("its output");
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), toolpathd::http::contract());
}
