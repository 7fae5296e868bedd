//! Checks the sources: what computations must not name, what their texts must not hold, which modules depend
//! on each other in a circle, and how long a file may be. The compiler checks which crate may name which.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The crates below the server, each with its folder. They are computations: they name no file, no socket, no
/// terminal and no clock.
const COMPUTING: &[&str] = &["core", "nc", "part", "post", "plot"];

/// Words of the standard library that a crate of computations must not name. Its manifest tells which other
/// libraries it may name.
const OUTSIDE: &[&str] =
    &["eprintln!", "println!", "std::env", "std::fs", "std::io", "std::net", "std::process", "SystemTime"];

/// Most lines of a source file. A longer file cannot be read in one sitting.
const LONGEST_FILE: usize = 420;

#[test]
fn the_computations_name_no_file_no_socket_and_no_clock() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let module = module_of(&path);
        if !COMPUTING.contains(&module[0].as_str()) {
            continue;
        }
        for (number, line) in code_lines(&text) {
            for word in OUTSIDE {
                if names(line, word) {
                    wrong.push(format!("{}:{number}: a computation must not name {word}", path.display()));
                }
            }
            if module != ["core", "budget"] && names(line, "Instant") {
                wrong.push(format!("{}:{number}: names the clock; only `budget` may", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The crates below the server state facts in the words of the field. The server alone knows members of bodies,
/// which its texts put between backticks, and endpoints. Words of programs and of expressions that the crates quote
/// stand in no backticks. `wire` describes points for the contract.
#[test]
fn texts_of_the_computations_name_no_member_of_a_body_and_no_endpoint() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let module = module_of(&path);
        let is_wire = module == ["core", "wire"];
        if !COMPUTING.contains(&module[0].as_str()) || module.iter().any(|name| name == "tests") || is_wire {
            continue;
        }
        for (number, line) in code_lines(without_tests(&text)) {
            for mark in ["`", "/v1/"] {
                if line.contains(mark) {
                    wrong.push(format!("{}:{number}: a text holds {mark}: {}", path.display(), line.trim()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn source_files_are_short_and_begin_with_a_module_comment() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let lines = text.lines().count();
        if lines > LONGEST_FILE {
            wrong.push(format!("{}: {lines} lines; at most {LONGEST_FILE} are allowed", path.display()));
        }
        if !text.starts_with("//!") && !path.ends_with("tests.rs") {
            wrong.push(format!(
                "{}: does not begin with a `//!` comment that says what the file is for",
                path.display()
            ));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn comments_are_no_wider_than_rustfmt_allows_for_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let settings = fs::read_to_string(root.join("rustfmt.toml")).unwrap();
    let width: usize =
        settings.lines().find_map(|line| line.strip_prefix("max_width = ")).unwrap().trim().parse().unwrap();
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        for (number, line) in text.lines().enumerate() {
            let comment = line.trim_start().starts_with("//");
            // A row of a table must stay on one line.
            let table = line.trim_start_matches([' ', '/', '!']).starts_with('|');
            if comment && !table && line.chars().count() > width {
                wrong.push(format!(
                    "{}:{}: a comment wider than {width}: {line}",
                    path.display(),
                    number + 1
                ));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn no_file_has_a_catch_all_name_and_every_folder_has_a_file_of_its_name() {
    for (path, _) in sources() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(
            !["mod", "utils", "util", "common", "misc", "helpers"].contains(&name),
            "{}: the name does not say what the file holds",
            path.display()
        );
        let folder = path.parent().unwrap();
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let is_crate = folder == Path::new("src") || root.join(folder).join("lib.rs").is_file();
        let head = root.join(folder).with_extension("rs");
        assert!(is_crate || head.is_file(), "{} lacks a file of the same name beside it", folder.display());
    }
}

#[test]
fn modules_with_the_same_parent_do_not_depend_on_each_other_in_a_circle() {
    let modules: BTreeMap<Vec<String>, String> =
        sources().into_iter().map(|(path, text)| (module_of(&path), text)).collect();
    // The key is a parent and the name of a child. The value holds the other children of this parent that the
    // child or its descendants name.
    let mut named: BTreeMap<(Vec<String>, String), BTreeSet<String>> = BTreeMap::new();
    for (module, text) in modules.iter().filter(|(module, _)| !module.iter().any(|name| name == "tests")) {
        for other in paths_in(without_tests(text)).filter_map(|path| resolve(&path, module, &modules)) {
            let common = module.iter().zip(&other).take_while(|(a, b)| a == b).count();
            if let (Some(from), Some(to)) = (module.get(common), other.get(common)) {
                named.entry((module[..common].to_vec(), from.clone())).or_default().insert(to.clone());
            }
        }
    }
    let mut circles = Vec::new();
    for (parent, start) in named.keys() {
        let mut reached = BTreeSet::new();
        let mut open = vec![start.clone()];
        while let Some(module) = open.pop() {
            for next in named.get(&(parent.clone(), module)).into_iter().flatten() {
                if reached.insert(next.clone()) {
                    open.push(next.clone());
                }
            }
        }
        if reached.contains(start) {
            circles.push(format!("{}::{start} depends on itself through other modules", parent.join("::")));
        }
    }
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn every_file_that_the_architecture_names_exists() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/ARCHITECTURE.md")).unwrap();
    let named = text.split('`').skip(1).step_by(2);
    let paths: Vec<&str> = named
        .filter(|name| ["src/", "openapi/", "docs/", "tests/"].iter().any(|at| name.starts_with(at)))
        .collect();
    assert!(paths.len() > 40, "only {} paths were found in docs/ARCHITECTURE.md", paths.len());
    for path in paths {
        let found = root.join(path).exists() || root.join(path).with_extension("rs").exists();
        assert!(found, "docs/ARCHITECTURE.md names {path}, which does not exist");
    }
}

/// A word of the glossary names types of its own meaning alone: they are in the modules of its row, and each of
/// these modules (or one below it, where the row ends it with a slash) has one.
#[test]
fn types_named_by_a_word_of_the_glossary_are_where_its_row_tells() {
    let architecture = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/ARCHITECTURE.md");
    let text = fs::read_to_string(architecture).unwrap();
    let glossary = text.split("## Glossary").nth(1).unwrap();
    let rows: Vec<Vec<&str>> = glossary
        .lines()
        .filter(|line| line.starts_with("| "))
        .map(|line| line.trim_matches('|').split('|').collect())
        .skip(1)
        .collect();
    assert!(rows.len() > 40, "only {} words were found", rows.len());
    let mut types = BTreeMap::<String, Vec<String>>::new();
    for (path, text) in sources() {
        let module = module_of(&path);
        if !module.iter().any(|name| name == "tests") {
            for name in code_lines(without_tests(&text)).filter_map(|(_, line)| type_defined(line)) {
                types.entry(name.to_owned()).or_default().push(module.join("/"));
            }
        }
    }
    let mut wrong = Vec::new();
    for row in &rows {
        let named: Vec<&str> = row[2].split('`').skip(1).step_by(2).collect();
        let covers = |named: &str, module: &str| {
            if named.ends_with('/') { module.starts_with(named) } else { module == named }
        };
        let own: Vec<&String> =
            row[0].split([',', ';']).filter_map(|word| types.get(&camel_case(word))).flatten().collect();
        for module in own.iter().filter(|module| !named.iter().any(|named| covers(named, module))) {
            wrong.push(format!("{module} has a type named by{}, which its row does not tell", row[0]));
        }
        for named in named.iter().filter(|named| !own.iter().any(|module| covers(named, module))) {
            wrong.push(format!("the row of{}tells of {named}, where no type has its name", row[0]));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// The name of the type that a line of code defines.
fn type_defined(line: &str) -> Option<&str> {
    let rest = line.trim_start();
    // The standard library names this type of `Deref`.
    if rest.starts_with("type Target ") {
        return None;
    }
    let rest = match rest.strip_prefix("pub") {
        Some(public) => public.split_once(' ')?.1,
        None => rest,
    };
    let name = ["struct ", "enum ", "trait ", "type "].iter().find_map(|kind| rest.strip_prefix(kind))?;
    name.split(|c: char| !c.is_alphanumeric()).next()
}

/// A word of the glossary as the name of a type.
fn camel_case(word: &str) -> String {
    word.split_whitespace().map(|part| part[..1].to_uppercase() + &part[1..]).collect()
}

/// The path of the module in a file, by segments. The first segment is the folder of the crate.
fn module_of(path: &Path) -> Vec<String> {
    let inner = path.strip_prefix("src").unwrap().with_extension("");
    let names = inner.components().map(|name| name.as_os_str().to_str().unwrap().to_owned());
    names.filter(|name| name != "lib").collect()
}

/// The module paths that code names: every path of every `use`, and every path that begins with `crate`,
/// `super` or `self`.
fn paths_in(code: &str) -> impl Iterator<Item = Vec<String>> {
    let code: Vec<&str> = code_lines(code).map(|(_, line)| line).collect();
    let code = code.join(" ");
    let mut paths = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let statement = code[at + 4..].split(';').next().unwrap_or_default();
        unfold("", &statement.replace(char::is_whitespace, ""), &mut paths);
    }
    for first in ["crate::", "super::", "self::", "toolpathd_"] {
        for (at, _) in code.match_indices(first) {
            let is_path = |c: &char| c.is_alphanumeric() || *c == '_' || *c == ':';
            paths.push(code[at..].chars().take_while(is_path).collect());
        }
    }
    let segments =
        |path: String| path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
    paths.into_iter().map(segments)
}

/// Splits a tree of imports, such as `a::{b, c::d}`, and appends each single path to `paths`.
fn unfold(before: &str, tree: &str, paths: &mut Vec<String>) {
    let Some((head, list)) = tree.split_once('{') else {
        paths.push(format!("{before}{tree}"));
        return;
    };
    let before = format!("{before}{head}");
    let (mut depth, mut item) = (0, String::new());
    for c in list.chars() {
        match c {
            ',' if depth == 0 => unfold(&before, &std::mem::take(&mut item), paths),
            '}' if depth == 0 => break,
            _ => {
                depth += i32::from(c == '{') - i32::from(c == '}');
                item.push(c);
            }
        }
    }
    if !item.is_empty() {
        unfold(&before, &item, paths);
    }
}

/// The module that `path` leads to, if `module` names the path. `None` if it leads to no other module.
fn resolve(
    path: &[String],
    module: &[String],
    modules: &BTreeMap<Vec<String>, String>,
) -> Option<Vec<String>> {
    let mut at = module.to_vec();
    let mut rest = path;
    match rest.first()?.as_str() {
        "crate" => {
            at.truncate(1);
            rest = &rest[1..];
        }
        "super" | "self" => {
            while let Some(step @ ("super" | "self")) = rest.first().map(String::as_str) {
                if step == "super" {
                    at.pop();
                }
                rest = &rest[1..];
            }
        }
        first => {
            if let Some(name) = first.strip_prefix("toolpathd_") {
                at = vec![name.to_owned()];
                rest = &rest[1..];
            }
        }
    }
    at.extend_from_slice(rest);
    while !at.is_empty() && !modules.contains_key(&at) {
        at.pop();
    }
    (!at.is_empty() && at != module).then_some(at)
}

/// Every Rust file below `src`, with its text, by path relative to the package.
fn sources() -> Vec<(PathBuf, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut folders = vec![root.join("src")];
    let mut files = Vec::new();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                files.push((path.strip_prefix(root).unwrap().to_owned(), text));
            }
        }
    }
    files.sort();
    assert!(files.len() > 20, "only {} source files were found", files.len());
    files
}

/// The text of a file before its tests.
fn without_tests(text: &str) -> &str {
    text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default()
}

/// Numbered lines without comments.
fn code_lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    text.lines().enumerate().map(|(k, line)| (k + 1, line.split("//").next().unwrap_or("")))
}

/// Whether `line` holds `word` as a whole word.
fn names(line: &str, word: &str) -> bool {
    line.match_indices(word).any(|(at, _)| {
        let before = line[..at].chars().next_back();
        let after = line[at + word.len()..].chars().next();
        let joins = |c: Option<char>| c.is_some_and(|c| c.is_alphanumeric() || c == '_');
        !joins(before) && (word.ends_with('!') || !joins(after))
    })
}
