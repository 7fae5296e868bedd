//! The text of a statement: its major word, and the words and numbers behind it.

use super::super::PathFault;
use super::super::table::Row;

/// The major word of a statement in capitals, and what follows it. A label before it is left out.
pub fn parts_of(statement: &str) -> (String, Option<&str>) {
    const TEXTS: [&str; 5] = ["PARTNO", "PPRINT", "INSERT", "REMARK", "TPRINT"];
    for word in TEXTS {
        let begins = statement.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word));
        let rest = statement.get(word.len()..).unwrap_or_default();
        if begins && !rest.starts_with(|c: char| c.is_ascii_alphabetic()) {
            let rest = rest.trim_start();
            return (word.to_owned(), Some(rest.strip_prefix('/').unwrap_or(rest)));
        }
    }
    let (word, rest) = match statement.split_once('/') {
        Some((word, rest)) => (word, Some(rest)),
        None => (statement, None),
    };
    let word = match word.split_once(')') {
        Some((label, word)) if label.chars().all(|c| c.is_ascii_alphanumeric()) => word,
        _ => word,
    };
    let word = word.trim().to_ascii_uppercase();
    let compact: String = word.split(',').map(str::trim).collect::<Vec<_>>().join(",");
    // LOAD/TOOL,n is one word, and so is UNLOAD/TOOL.
    let tool = rest.map(str::trim_start).and_then(|rest| {
        let is_tool = rest.get(..4).is_some_and(|start| start.eq_ignore_ascii_case("TOOL"));
        is_tool.then(|| rest[4..].trim_start().trim_start_matches([',', '/']))
    });
    match tool {
        Some(rest) if compact == "LOAD" => ("LOAD/TOOL".to_owned(), Some(rest)),
        _ => (compact, rest),
    }
}

/// The arguments of a statement in capitals.
pub fn words(text: &str) -> Result<Vec<String>, PathFault> {
    if text.trim().is_empty() {
        return Ok(Vec::new());
    }
    let word = |word: &str| match word.trim() {
        "" => Err(PathFault::Blank),
        word => Ok(word.to_ascii_uppercase()),
    };
    text.split(',').map(word).collect()
}

/// The numbers among the arguments of a statement whose words its row takes all.
pub fn minors(major: &str, row: &Row, text: &str) -> Result<Vec<f64>, PathFault> {
    let mut numbers = Vec::new();
    for word in words(text)? {
        match number(&word) {
            Ok(value) => numbers.push(value),
            Err(_) if row.takes(&word) => {}
            Err(_) => {
                return Err(PathFault::Refused {
                    word: format!("{major}/{}", shown(&word)),
                    advice: row.says,
                });
            }
        }
    }
    Ok(numbers)
}

pub fn numbers(text: &str) -> Result<Vec<f64>, PathFault> {
    words(text)?.iter().map(|word| number(word)).collect()
}

pub fn number(word: &str) -> Result<f64, PathFault> {
    // Fortran writes exponents with D.
    let plain = word.trim().replace(['D', 'd'], "E");
    let is_number = plain.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    plain
        .parse::<f64>()
        .ok()
        .filter(|x| x.is_finite() && is_number)
        .ok_or_else(|| PathFault::BadNumber(shown(word)))
}

pub fn three(numbers: &[f64]) -> Result<[f64; 3], PathFault> {
    numbers.try_into().map_err(|_| PathFault::Count(numbers.len()))
}

/// The beginning of a text, for a message.
pub fn shown(text: &str) -> String {
    text.chars().take(40).collect()
}
