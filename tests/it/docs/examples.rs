//! Sends every curl command of the documents to a service and compares the answers with those shown.

use std::collections::HashMap;
use std::net::{SocketAddr, TcpListener};

use serde_json::Value;

use super::curl::{Answer, commands};
use super::page::{Block, blocks, read};
use super::recipe;
use crate::api::support::{Server, app, aside};

/// The documents whose commands are sent.
const DOCUMENTS: &[&str] = &["README.md", "docs/api.md", "docs/operations.md", "docs/mes.md"];

/// The gap in an answer that a document shows. It stands for any text.
const GAP: &str = "...";

#[tokio::test(flavor = "multi_thread")]
async fn every_curl_command_of_the_documents_gets_the_answer_shown() {
    // The documents send to a control named `lathe` behind a device server.
    let lathe = TcpListener::bind("127.0.0.1:0").expect("a port");
    let target = format!("lathe=tcp:{}", lathe.local_addr().expect("an address"));
    std::thread::spawn(move || {
        for mut stream in lathe.incoming().flatten() {
            let _ = std::io::copy(&mut stream, &mut std::io::sink());
        }
    });
    let app = app(&["--workers", "1", "--dnc-target", &target]);
    let server = Server::start(&app).await;
    let address = server.address;
    let faults =
        aside(move || DOCUMENTS.iter().flat_map(|path| faults_of(path, address)).collect::<Vec<_>>());
    let faults = faults.await;
    server.stop().await;
    assert!(faults.is_empty(), "{}", faults.join("\n\n"));
}

/// The faults of the examples of a document.
fn faults_of(path: &str, address: SocketAddr) -> Vec<String> {
    let markdown = read(path);
    let blocks = blocks(&markdown);
    // Files that a reader has beside those of the package.
    let mut files: HashMap<String, Vec<u8>> = recipe::files_of(&blocks).into_iter().collect();
    let mut faults = Vec::new();
    let mut n_commands = 0;
    for (index, block) in blocks.iter().enumerate().filter(|(_, block)| block.language == "sh") {
        let at = format!("{path}:{}", block.line);
        let commands = commands(&block.text).unwrap_or_else(|fault| panic!("{at}: {fault}"));
        n_commands += commands.len();
        let shown = blocks.get(index + 1).filter(|next| next.language.is_empty());
        for (k, command) in commands.iter().enumerate() {
            let answer = command.send(address, &files);
            let shown = shown.filter(|_| k + 1 == commands.len());
            if let Err(fault) = compare(&answer, shown) {
                faults.push(format!("{at}: {}: {fault}", command.target));
            }
            if let Some(name) = &command.saved_as {
                files.insert(name.clone(), answer.body.into_bytes());
            }
        }
    }
    assert!(n_commands > 0, "{path} has no command");
    faults
}

/// Compares an answer with the block that follows its command. Returns what differs.
fn compare(answer: &Answer, shown: Option<&Block>) -> Result<(), String> {
    let text = shown.map_or("", |block| block.text.as_str());
    if text.starts_with("{\"type\":") {
        return compare_problems(answer, text);
    }
    if !(200..300).contains(&answer.status) {
        return Err(format!("the answer has status {}: {}", answer.status, answer.body));
    }
    if answer.body.trim().is_empty() {
        return Err("the answer is empty".into());
    }
    if text.is_empty() {
        return Ok(());
    }
    let is_json = answer.content_type == "application/json";
    let readable = |text: &str| if is_json { squeezed(text) } else { text.trim_end().to_owned() };
    let (shown, told) = (readable(text), readable(&answer.body));
    fit(&shown, &told).map_err(|part| {
        format!("the answer lacks this part, or has it in another place:\n{part}\nThe answer is\n{told}")
    })
}

/// Compares the members of a problem that programs read. The sentences for people may change.
fn compare_problems(answer: &Answer, shown: &str) -> Result<(), String> {
    let stable = |text: &str| {
        let problem: Value = serde_json::from_str(text).map_err(|error| format!("{error}: {text}"))?;
        let errors = problem["errors"].as_array().into_iter().flatten();
        let errors: Vec<_> =
            errors.map(|error| ["pointer", "code", "offset"].map(|name| error[name].clone())).collect();
        let members = ["type", "status", "code"].map(|name| problem[name].clone());
        Ok::<_, String>((members, errors))
    };
    let (told, shown) = (stable(&answer.body)?, stable(shown)?);
    if told != shown || told.0[1] != answer.status {
        return Err(format!("the answer is the problem {told:?}, but the document shows {shown:?}"));
    }
    Ok(())
}

/// Removes the white space between the tokens of a JSON text.
fn squeezed(json: &str) -> String {
    let (mut in_text, mut escaped) = (false, false);
    let mut kept = String::with_capacity(json.len());
    for c in json.chars() {
        if in_text || !c.is_whitespace() {
            kept.push(c);
        }
        in_text ^= c == '"' && !escaped;
        escaped = c == '\\' && !escaped;
    }
    kept
}

/// Checks that the parts of `shown` between its gaps follow each other in `told`, from its start to its end.
///
/// # Errors
/// Returns the first part that does not follow.
fn fit<'a>(shown: &'a str, told: &str) -> Result<(), &'a str> {
    let parts: Vec<&str> = shown.split(GAP).collect();
    let mut rest = told;
    for (k, part) in parts.iter().enumerate() {
        let is_last = k + 1 == parts.len();
        let at = match k {
            0 => rest.starts_with(part).then_some(0),
            _ if is_last && rest.ends_with(part) => Some(rest.len() - part.len()),
            _ => rest.find(part),
        };
        rest = &rest[at.ok_or(*part)? + part.len()..];
        if is_last && !rest.is_empty() && !part.is_empty() {
            return Err(part);
        }
    }
    Ok(())
}

#[test]
fn a_gap_matches_any_text_and_all_other_text_matches_itself() {
    assert_eq!(fit("G0 X1\n...\nM30", "G0 X1\nY2\nM30"), Ok(()));
    assert_eq!(fit("{\"id\":\"...\",\"n\":2...", "{\"id\":\"a-b\",\"n\":2,\"m\":3}"), Ok(()));
    assert_eq!(fit("...M30...M30", "M30 M30 M30"), Ok(()));
    assert_eq!(fit("G0 X1", "G0 X12"), Err("G0 X1"));
    assert_eq!(fit("G0 X1\n...\nM30", "G0 X1\nM2"), Err("\nM30"));
    assert_eq!(fit("...M3...M30", "M30"), Err("M30"));
    assert_eq!(squeezed("{\"a b\": [1,\n 2], \"c\\\" d\": 3}"), "{\"a b\":[1,2],\"c\\\" d\":3}");
}
