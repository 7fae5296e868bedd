//! Tests of receipts through the interface and the command line.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};

use serde_json::{Value, json};

use super::support::{app, post};

const PATH: &str = "/v1/programs/verify?receipt=true";

/// The text of an example of the endpoint.
fn example(name: &str) -> String {
    let path = format!("{}/openapi/examples/programs-verify/{name}.json", env!("CARGO_MANIFEST_DIR"));
    fs::read_to_string(path).expect("an example")
}

fn json_of(text: &str) -> Value {
    serde_json::from_str(text).expect("JSON")
}

async fn answer(arguments: &[&str], body: &str) -> Value {
    let answer = post(&app(arguments), PATH, body.to_owned(), &[]).await;
    assert_eq!(answer.status, 200, "{}", answer.text());
    answer.json()
}

/// A folder of its own for the files of a test.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("toolpathd-{name}-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        Self(folder)
    }

    fn write(&self, name: &str, text: &str) -> String {
        let path = self.0.join(name);
        fs::write(&path, text).expect("a file");
        path.display().to_string()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

fn check(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_toolpathd");
    Command::new(program).arg("check").args(arguments).output().expect("the program")
}

#[tokio::test]
async fn a_receipt_has_the_bound_of_each_move_whatever_the_threads() {
    let body = example("faults");
    let one = answer(&["--workers", "1"], &body).await;
    let other = answer(&["--workers", "4"], &body).await;
    assert_eq!(one["receipt"], other["receipt"]);
    let receipt = &one["receipt"];
    assert_eq!(receipt["schema"], "toolpathd-receipt-1");
    assert_eq!(receipt["verdict"], "fail");
    assert_eq!(receipt.get("signature"), None);
    let moves = receipt["moves"].as_array().expect("moves");
    assert_eq!(moves.len() as u64, one["report"]["n_moves"].as_u64().expect("a number"));
    let depth_on = |line: u64| {
        let own = moves.iter().find(|own| own["line"] == line).expect("a move of the line");
        own["gouge_mm"].as_f64().expect("a bound")
    };
    // Line 7 runs 0.01 mm into the wall. The lines before it enter nowhere.
    assert!((depth_on(7) - 0.01).abs() < 1e-3 && depth_on(6) < 1e-3, "{receipt}");
    let bound = receipt["bounds"]["gouge_mm"].as_f64();
    assert_eq!(bound, one["report"]["gouge_max_mm"]["bound"].as_f64());
    let without = post(&app(&["--workers", "1"]), "/v1/programs/verify", body, &[]).await.json();
    assert_eq!(without.get("receipt"), None);
    assert_eq!(without["report"], one["report"]);
}

#[tokio::test]
async fn the_command_line_checks_receipts() {
    let folder = Folder::new("receipt");
    for name in ["pocket", "clamp", "faults"] {
        let body = example(name);
        let sent = json_of(&body);
        let program = sent["nc"].as_str().map_or_else(|| sent["toolpath"].to_string(), str::to_owned);
        let answer = answer(&["--workers", "1"], &body).await;
        let files = [
            folder.write("answer.json", &answer.to_string()),
            folder.write("program", &program),
            folder.write("part.json", &body),
        ];
        let files: Vec<&str> = files.iter().map(String::as_str).collect();
        let told = check(&files);
        let is_good = name != "faults";
        assert_eq!(told.status.success(), is_good, "{told:?}");
        let text = if is_good { told.stdout } else { told.stderr };
        assert!(String::from_utf8_lossy(&text).contains("the receipt holds: verdict"), "{name}");
        folder.write("program", &program.replacen('0', "1", 1));
        let stale = check(&files);
        assert!(!stale.status.success());
        assert!(String::from_utf8_lossy(&stale.stderr).contains("stale: program"), "{stale:?}");
    }
}

/// The key of 32 times the byte 7 in PEM (RFC 8410).
const PRIVATE: &str = "-----BEGIN PRIVATE KEY-----\nMC4CAQAwBQYDK2VwBCIEIAcHBwcHBwcHBwcHBwcHBwcHBwcHBwcHBwcHBwcHBwcH\n-----END PRIVATE KEY-----\n";

#[tokio::test]
async fn a_receipt_is_signed_by_the_key_of_the_service() {
    let folder = Folder::new("signed");
    let key = folder.write("key.pem", PRIVATE);
    let body = example("pocket");
    let mut answer = answer(&["--workers", "1", "--receipt-key", &key], &body).await;
    let public = answer["receipt"]["signature"]["public_key"].as_str().expect("a key").to_owned();
    // The key in the form of `openssl pkey -pubout`: a head of 12 bytes, and the key.
    let head = [48, 42, 48, 5, 6, 3, 43, 101, 112, 3, 33, 0];
    let der = [&head[..], &base64_bytes(&public)].concat();
    let pem =
        |der: &[u8]| format!("-----BEGIN PUBLIC KEY-----\n{}\n-----END PUBLIC KEY-----\n", base64_text(der));
    let own = folder.write("own.pem", &pem(&der));
    let base_point = [&head[..], &[0x58], &[0x66; 31]].concat();
    let other = folder.write("other.pem", &pem(&base_point));
    let program = folder.write("program.nc", json_of(&body)["nc"].as_str().expect("a text"));
    let part = folder.write("part.json", &body);
    let receipt = folder.write("receipt.json", &answer["receipt"].to_string());
    let told = |key: &str, receipt: &str| {
        let told = check(&["--key", key, receipt, &program, &part]);
        (told.status.success(), String::from_utf8_lossy(&[told.stdout, told.stderr].concat()).into_owned())
    };
    let (is_good, text) = told(&own, &receipt);
    assert!(is_good && text.contains("signed by the key that was asked for"), "{text}");
    let (is_good, text) = told(&other, &receipt);
    assert!(!is_good && text.contains("another key"), "{text}");
    answer["receipt"]["signature"] = json!(null);
    let unsigned = folder.write("receipt.json", &answer["receipt"].to_string());
    let (is_good, text) = told(&own, &unsigned);
    assert!(!is_good && text.contains("not signed"), "{text}");
}

fn base64_bytes(text: &str) -> Vec<u8> {
    use base64::Engine;
    base64::prelude::BASE64_STANDARD.decode(text).expect("base64")
}

fn base64_text(bytes: &[u8]) -> String {
    use base64::Engine;
    base64::prelude::BASE64_STANDARD.encode(bytes)
}
