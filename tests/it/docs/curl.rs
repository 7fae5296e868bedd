//! Parses and sends curl commands without curl. Only the options that the documents use are supported.

use std::collections::HashMap;
use std::io::{Read, Write};
use std::net::SocketAddr;

use super::page::root;
use crate::api::support::connect;

/// The address of the service in the documents.
const WRITTEN_ADDRESS: &str = "http://127.0.0.1:8080";

/// The request that curl would send, and the file to which curl would write the answer.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Curl {
    pub method: String,
    pub target: String,
    pub headers: Vec<(String, String)>,
    pub body: Option<Body>,
    /// The file of `-o`.
    pub saved_as: Option<String>,
}

/// The body of a request as the command names it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Body {
    /// `--data TEXT`.
    Text(String),
    /// `--data @FILE`: the file without its line ends.
    Joined(String),
    /// `--data-binary @FILE` and `-T FILE`: the file as it is.
    Whole(String),
    /// `-F NAME=@FILE` and `-F NAME=TEXT`: the names of the parts, each with a file or a text.
    Parts(Vec<(String, Part)>),
}

/// A part of a form.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Part {
    File(String),
    Text(String),
}

/// The line between the parts of a form.
const BOUNDARY: &str = "----------boundary";

/// An answer over a socket.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub content_type: String,
    pub body: String,
}

/// The curl commands of a shell block. `cargo` commands are skipped; any other command is an error.
pub fn commands(shell: &str) -> Result<Vec<Curl>, String> {
    let joined = shell.replace("\\\n", " ");
    let lines = joined.lines().map(str::trim).filter(|line| !line.is_empty());
    let mut commands = Vec::new();
    for line in lines {
        let words = words(line)?;
        match words.first().map(String::as_str) {
            Some("curl") => commands.push(Curl::of(&words[1..]).map_err(|fault| format!("{fault}: {line}"))?),
            Some("cargo") => {}
            _ => return Err(format!("neither curl nor cargo: {line}")),
        }
    }
    Ok(commands)
}

/// Splits a line of shell into words, without their quotes. A comment ends the line. A line that the shell
/// would expand or act on is an error.
fn words(line: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut chars = line.chars();
    while let Some(c) = chars.next() {
        match c {
            '\'' | '"' => {
                let text: String = chars.by_ref().take_while(|&end| end != c).collect();
                if c == '"' && text.contains(['$', '`', '\\']) {
                    return Err(format!("the shell would expand \"{text}\""));
                }
                word.get_or_insert_default().push_str(&text);
            }
            ' ' => words.extend(word.take()),
            '#' if word.is_none() => break,
            '$' | '`' | '|' | '>' | '<' | '&' | ';' | '*' | '?' | '\\' => {
                return Err(format!("the shell would act on {c}: {line}"));
            }
            c => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    Ok(words)
}

impl Curl {
    /// The request that curl would send for these arguments. An option that is not supported is an error.
    fn of(arguments: &[String]) -> Result<Self, String> {
        let (mut url, mut headers, mut body, mut saved_as) = (None, Vec::new(), None, None);
        let mut method = "GET";
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let mut value = || rest.next().cloned().ok_or(format!("{argument} lacks its value"));
            match argument.as_str() {
                "-s" | "-N" | "-sN" => {}
                "-H" => {
                    let header = value()?;
                    let (name, text) = header.split_once(':').ok_or(format!("{header} is not a header"))?;
                    headers.push((name.to_lowercase(), text.trim().to_owned()));
                }
                "--data" | "--data-binary" => {
                    method = "POST";
                    let data = value()?;
                    body = Some(match (data.strip_prefix('@'), argument.as_str()) {
                        (Some(file), "--data") => Body::Joined(file.to_owned()),
                        (Some(file), _) => Body::Whole(file.to_owned()),
                        (None, _) => Body::Text(data),
                    });
                }
                "-F" => {
                    method = "POST";
                    let part = part(&value()?)?;
                    match &mut body {
                        Some(Body::Parts(parts)) => parts.push(part),
                        _ => body = Some(Body::Parts(vec![part])),
                    }
                }
                "-T" => {
                    method = "PUT";
                    body = Some(Body::Whole(value()?));
                }
                "-o" => saved_as = Some(value()?),
                // The head of the answer goes to a file that nothing reads.
                "-D" => drop(value()?),
                option if option.starts_with('-') => {
                    return Err(format!("the option {option} is not supported"));
                }
                address if url.is_none() => url = Some(address),
                second => return Err(format!("{second} is a second address")),
            }
        }
        let target = url.and_then(|url| url.strip_prefix(WRITTEN_ADDRESS));
        let target = target.ok_or(format!("the address does not begin with {WRITTEN_ADDRESS}"))?;
        if method == "POST" && headers.iter().all(|(name, _)| name != "content-type") {
            // Curl sends these content types unless a header names another one.
            let media_type = match &body {
                Some(Body::Parts(_)) => format!("multipart/form-data; boundary={BOUNDARY}"),
                _ => "application/x-www-form-urlencoded".to_owned(),
            };
            headers.push(("content-type".into(), media_type));
        }
        if headers.iter().all(|(name, _)| name != "accept") {
            headers.push(("accept".into(), "*/*".into()));
        }
        Ok(Self { method: method.into(), target: target.into(), headers, body, saved_as })
    }

    /// Sends the request. A file is looked up in `files`, which earlier commands of the document wrote, and
    /// then in the package.
    pub fn send(&self, address: SocketAddr, files: &HashMap<String, Vec<u8>>) -> Answer {
        let bytes = |name: &String| match files.get(name) {
            Some(bytes) => bytes.clone(),
            None => std::fs::read(root().join(name)).unwrap_or_else(|error| panic!("{name}: {error}")),
        };
        let body = match &self.body {
            None => Vec::new(),
            Some(Body::Text(text)) => text.clone().into_bytes(),
            Some(Body::Joined(name)) => {
                bytes(name).into_iter().filter(|byte| !b"\r\n\0".contains(byte)).collect()
            }
            Some(Body::Whole(name)) => bytes(name),
            Some(Body::Parts(parts)) => form(parts, bytes),
        };
        let mut head = format!("{} {} HTTP/1.1\r\nhost: {address}\r\n", self.method, self.target);
        for (name, value) in &self.headers {
            head.push_str(&format!("{name}: {value}\r\n"));
        }
        head.push_str(&format!("connection: close\r\ncontent-length: {}\r\n\r\n", body.len()));
        let mut stream = connect(address);
        stream.write_all(head.as_bytes()).expect("the request can be written");
        stream.write_all(&body).expect("the request can be written");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("an answer");
        Answer::of(&answer)
    }
}

/// The part that a value of `-F` describes.
fn part(value: &str) -> Result<(String, Part), String> {
    let (name, content) = value.split_once('=').ok_or(format!("{value} is no part"))?;
    let part = match content.strip_prefix('@') {
        Some(file) => Part::File(file.to_owned()),
        None => Part::Text(content.to_owned()),
    };
    Ok((name.to_owned(), part))
}

/// The body of a form, as curl sends it: each file with its name without folders.
fn form(parts: &[(String, Part)], bytes: impl Fn(&String) -> Vec<u8>) -> Vec<u8> {
    let mut body = Vec::new();
    for (name, part) in parts {
        let (file_name, content) = match part {
            Part::File(file) => {
                let last = file.rsplit('/').next().unwrap_or(file);
                (format!("; filename=\"{last}\""), bytes(file))
            }
            Part::Text(text) => (String::new(), text.clone().into_bytes()),
        };
        let head =
            format!("--{BOUNDARY}\r\nContent-Disposition: form-data; name=\"{name}\"{file_name}\r\n\r\n");
        body.extend([head.as_bytes(), &content, b"\r\n"].concat());
    }
    body.extend(format!("--{BOUNDARY}--\r\n").into_bytes());
    body
}

impl Answer {
    fn of(bytes: &[u8]) -> Self {
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").expect("the end of the head");
        let head = String::from_utf8_lossy(&bytes[..end]).to_lowercase();
        let header = |name: &str| {
            let line = head.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(": "));
            line.unwrap_or_default().to_owned()
        };
        let body = &bytes[end + 4..];
        let body = if header("transfer-encoding") == "chunked" { joined(body) } else { body.to_owned() };
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        Self {
            status,
            content_type: header("content-type"),
            body: String::from_utf8_lossy(&body).into_owned(),
        }
    }
}

/// Joins a chunked body. Fails if the body does not end, because this is a failure of the service.
fn joined(mut chunks: &[u8]) -> Vec<u8> {
    let mut whole = Vec::new();
    loop {
        let end = chunks.windows(2).position(|two| two == b"\r\n").expect("the length of a chunk");
        let length = std::str::from_utf8(&chunks[..end]).expect("a length");
        let length = usize::from_str_radix(length, 16).expect("a length");
        if length == 0 {
            return whole;
        }
        whole.extend(&chunks[end + 2..end + 2 + length]);
        chunks = &chunks[end + 2 + length + 2..];
    }
}

#[test]
fn a_parsed_command_is_the_request_that_curl_would_send() {
    let shell = "cargo run --release  # first\n\
        curl -s 'http://127.0.0.1:8080/v1/arcs/fit?nc=true' \\\n  -H 'Accept: application/json' --data @a.json -o out\n\
        curl -T a.ngc http://127.0.0.1:8080/v1/arcs/fit\n";
    let found = commands(shell).expect("commands");
    let header = |name: &str, value: &str| (name.to_owned(), value.to_owned());
    assert_eq!(
        found[0].headers,
        [header("accept", "application/json"), header("content-type", "application/x-www-form-urlencoded")]
    );
    assert_eq!((found[0].method.as_str(), found[0].target.as_str()), ("POST", "/v1/arcs/fit?nc=true"));
    assert_eq!(found[0].body, Some(Body::Joined("a.json".into())));
    assert_eq!(found[0].saved_as.as_deref(), Some("out"));
    assert_eq!((found[1].method.as_str(), &found[1].body), ("PUT", &Some(Body::Whole("a.ngc".into()))));
    assert_eq!(found[1].headers, [header("accept", "*/*")]);
}

#[test]
fn a_command_with_unsupported_parts_is_refused() {
    for shell in [
        "curl --insecure http://127.0.0.1:8080/livez",
        "curl http://127.0.0.1:9090/livez",
        "curl http://127.0.0.1:8080/livez | head",
        "curl http://127.0.0.1:8080/livez?$QUERY",
        "curl --data \"$(cat a)\" http://127.0.0.1:8080/livez",
        "curl http://127.0.0.1:8080/livez -o",
        "wget http://127.0.0.1:8080/livez",
    ] {
        assert!(commands(shell).is_err(), "this command was not refused: {shell}");
    }
}

#[test]
fn the_chunks_of_a_body_are_joined() {
    let answer =
        Answer::of(b"HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n3\r\nG0 \r\n2\r\nX1\r\n0\r\n\r\n");
    assert_eq!((answer.status, answer.body.as_str()), (200, "G0 X1"));
}
