//! The commands of a shell block, as the shell would read them: curl and jq. Only what the documents use is
//! supported.

use super::curl::{Body, Curl};
use super::jq::Jq;

/// A command of a document.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Command {
    Curl(Curl),
    Jq(Jq),
}

/// The commands of a shell block. `cargo` commands are skipped; any other command is an error.
pub fn commands(shell: &str) -> Result<Vec<Command>, String> {
    let mut commands = Vec::new();
    for line in lines(&shell.replace("\\\n", " ")) {
        let words = words(&line)?;
        let named = |fault: String| format!("{fault}: {line}");
        match words.first().map(String::as_str) {
            Some("curl") => commands.push(Command::Curl(Curl::of(&words[1..]).map_err(named)?)),
            Some("jq") => commands.push(Command::Jq(Jq::of(&words[1..]).map_err(named)?)),
            // A comment has no words.
            Some("cargo") | None => {}
            _ => return Err(format!("no curl, jq or cargo: {line}")),
        }
    }
    Ok(commands)
}

/// The lines that are not empty. A line goes on to the end of its quotes; a comment has none.
fn lines(shell: &str) -> Vec<String> {
    let mut lines = vec![String::new()];
    let (mut quote, mut is_comment) = (None, false);
    for c in shell.chars() {
        let line = lines.last_mut().expect("a line");
        match (c, quote) {
            ('\n', None) => {
                is_comment = false;
                lines.push(String::new());
                continue;
            }
            ('#', None) if line.is_empty() || line.ends_with(' ') => is_comment = true,
            ('\'' | '"', None) if !is_comment => quote = Some(c),
            (c, Some(open)) if c == open => quote = None,
            _ => {}
        }
        line.push(c);
    }
    lines.into_iter().map(|line| line.trim().to_owned()).filter(|line| !line.is_empty()).collect()
}

/// Splits a line of shell into words, without their quotes. A comment ends the line. A `>` that stands alone
/// is a word. A line on which the shell would act otherwise is an error.
fn words(line: &str) -> Result<Vec<String>, String> {
    let mut words = Vec::new();
    let mut word: Option<String> = None;
    let mut chars = line.chars().peekable();
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
            '>' if word.is_none() && chars.peek() == Some(&' ') => words.push(">".into()),
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

#[test]
fn a_parsed_command_is_the_request_that_curl_would_send() {
    let shell = "cargo run --release  # first\n\
        curl -s 'http://127.0.0.1:8080/v1/arcs/fit?nc=true' \\\n  -H 'Accept: application/json' --data @a.json -o out\n\
        curl -T a.ngc http://127.0.0.1:8080/v1/arcs/fit\n";
    let found = commands(shell).expect("commands");
    let found: Vec<Curl> = found
        .into_iter()
        .map(|command| match command {
            Command::Curl(curl) => curl,
            Command::Jq(jq) => panic!("{jq:?}"),
        })
        .collect();
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
        "curl http://127.0.0.1:8080/livez > out",
        "jq . in.json >> out.json",
        "jq -c . in.json > out.json",
        "jq . in.json",
    ] {
        assert!(commands(shell).is_err(), "this command was not refused: {shell}");
    }
}

#[test]
fn a_filter_of_several_lines_is_one_word() {
    let found =
        commands("# it's a comment\njq '{a: .b,\n  c: (.d > 2)}' in.json > out.json\n").expect("a command");
    let filter = "{a: .b,\n  c: (.d > 2)}".to_owned();
    assert_eq!(found, [Command::Jq(Jq { filter, read: "in.json".into(), saved_as: "out.json".into() })]);
}
