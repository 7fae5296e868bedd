//! `toolpathd dnc send` as people use it.

use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};

use super::mock::{Control, Habits, program, tape};

/// A file that is removed with this value.
struct Temporary(PathBuf);

impl Temporary {
    fn new(name: &str, text: &[u8]) -> Self {
        let path = std::env::temp_dir().join(format!("toolpathd-{}-{name}", std::process::id()));
        std::fs::write(&path, text).expect("a file");
        Self(path)
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn start(file: &Temporary, flags: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_toolpathd"))
        .args(["dnc", "send"])
        .args(flags)
        .arg(&file.0)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts")
}

fn text(output: &Output) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

#[test]
fn a_program_is_sent_and_told_in_a_line() {
    let program = program(50);
    let file = Temporary::new("whole.nc", &program);
    let control = Control::start(Habits { rate: 1e6, ..Habits::STEADY });
    let flags = ["--port", &control.path, "--baud", "9600", "--format", "7e2", "--flow", "xon-xoff"];
    let output = start(&file, &flags).wait_with_output().expect("an end");
    let (told, error) = text(&output);
    assert!(output.status.success(), "{error}");
    assert!(told.starts_with("sent 50 lines, ") && told.contains("transmitted"), "{told}");
    assert_eq!(error, "", "a progress bar without a terminal");
    assert_eq!(control.end().received, tape(50, &program));
}

#[test]
fn an_interrupt_ends_the_sending_at_the_end_of_a_block_with_an_exit_code() {
    let program = program(500);
    let file = Temporary::new("long.nc", &program);
    let control = Control::start(Habits { rate: 1e6, ..Habits::STEADY });
    let child = start(&file, &["--port", &control.path, "--baud", "4800", "--leader", "0"]);
    control.until_received(300);
    let interrupt = format!("kill -INT {}", child.id());
    assert!(Command::new("sh").args(["-c", &interrupt]).status().expect("a shell").success());
    let output = child.wait_with_output().expect("an end");
    let (told, error) = text(&output);
    assert_eq!((output.status.code(), told.as_str()), (Some(1), ""), "{error}");
    let seen = control.end().received;
    let n_lines = seen.iter().filter(|byte| **byte == b'\n').count() - 2;
    assert!(n_lines > 5 && program.len() > seen.len(), "{n_lines}");
    assert!(
        seen.ends_with(b"\n%\n") && tape(0, &program).starts_with(&seen[..seen.len() - 2]),
        "half a block"
    );
    assert_eq!(error.lines().count(), 1);
    for part in ["cancelled", &format!("whole blocks up to line {n_lines} and the end mark")] {
        assert!(error.contains(part), "{error}");
    }
}

#[test]
fn what_cannot_be_sent_is_refused_in_a_sentence() {
    let umlaut = Temporary::new("umlaut.nc", "G0 X1\n(\u{fc}ber)\n".as_bytes());
    let plain = Temporary::new("plain.nc", b"G0 X1\n");
    for (file, flags, words) in [
        (&umlaut, vec!["--port", "/dev/null"], "line 2 holds the byte 0xC3"),
        (&plain, vec!["--port", "/dev/no-such-port"], "serial:/dev/no-such-port cannot be opened"),
        (&plain, vec!["--port", "/dev/null", "--flow", "none", "--wait-for-xon"], "`wait-for-xon`"),
    ] {
        let output = start(file, &flags).wait_with_output().expect("an end");
        let (_, error) = text(&output);
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(error.contains(words) && error.lines().count() == 1, "{error}");
    }
}

#[test]
fn an_estimate_tells_the_time_and_the_starving_feed_and_opens_no_port() {
    let file = Temporary::new("estimate.nc", &b"G1X100.123Y-100.123\n".repeat(1000));
    let flags = ["--port", "/dev/no-such-port", "--estimate", "--leader", "0", "--marks", "as-is"];
    let output = start(&file, &flags).wait_with_output().expect("an end");
    let (told, error) = text(&output);
    assert!(output.status.success(), "{error}");
    for part in ["22.9 s at 9600 baud in 7e2", "873 characters a second", "above 262 mm/min"] {
        assert!(told.contains(part), "{told}");
    }
}
