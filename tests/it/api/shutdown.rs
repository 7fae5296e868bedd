//! The end of the real program: nothing that has reached it is lost.

use std::io::{BufRead, BufReader};
use std::net::SocketAddr;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use super::support::{MILL, connect, post_head, read_answer, write};

/// The program on a free port; killed when a test fails.
struct Program {
    child: Child,
    address: SocketAddr,
}

impl Program {
    fn start() -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_toolpathd"))
            .args(["--listen", "127.0.0.1:0", "--workers", "1", "--log", "warn"])
            .stdout(Stdio::piped())
            .spawn()
            .expect("the program starts");
        let mut line = String::new();
        BufReader::new(child.stdout.take().expect("its output")).read_line(&mut line).expect("a line");
        let address = line.trim().strip_prefix("listening on http://").expect("an address");
        Self { address: address.parse().expect("an address"), child }
    }

    fn terminate(&self) {
        let kill = format!("kill -TERM {}", self.child.id());
        assert!(Command::new("sh").args(["-c", &kill]).status().expect("a shell").success());
    }

    fn exit_code(&mut self) -> Option<i32> {
        let limit = Instant::now() + Duration::from_secs(10);
        while Instant::now() < limit {
            if let Some(status) = self.child.try_wait().expect("a status") {
                return status.code();
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        None
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn requests_under_way_are_answered_whole() {
    let mut program = Program::start();
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
    let mut program = Program::start();
    let _idle = connect(program.address);
    let started = Instant::now();
    program.terminate();
    assert_eq!(program.exit_code(), Some(0));
    assert!(started.elapsed() < Duration::from_secs(3));
}

#[test]
fn health_is_told_by_the_exit_code() {
    let program = Program::start();
    let healthcheck = |address: &str| {
        let arguments = ["healthcheck", "--listen", address];
        Command::new(env!("CARGO_BIN_EXE_toolpathd")).args(arguments).status().expect("a status").success()
    };
    assert!(healthcheck(&program.address.to_string()));
    assert!(healthcheck(&format!("0.0.0.0:{}", program.address.port())));
    drop(program);
    assert!(!healthcheck("127.0.0.1:9"));
}

#[test]
fn the_contract_is_printed() {
    let output = Command::new(env!("CARGO_BIN_EXE_toolpathd")).arg("openapi").output().expect("its output");
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stdout).trim_end(), toolpathd::http::contract());
}
