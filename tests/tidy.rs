//! The architecture as a test: which layer may name which, what the core never touches, how long a file may
//! be.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Modules of the crate with the modules they may name. What is not listed here does not exist.
const LAYERS: &[(&str, &[&str])] = &[
    ("parallel", &[]),
    ("budget", &["parallel"]),
    ("geometry", &["budget"]),
    ("language", &["budget", "geometry"]),
    ("machining", &["budget", "geometry"]),
    ("toolpath", &["budget", "geometry", "machining"]),
    ("operations", &["budget", "geometry", "language", "machining", "toolpath"]),
    ("post", &["budget", "geometry", "machining", "toolpath"]),
    ("plot", &["budget", "geometry", "machining", "toolpath"]),
    (
        "http",
        &[
            "budget",
            "geometry",
            "language",
            "machining",
            "toolpath",
            "operations",
            "parallel",
            "post",
            "plot",
            "config",
        ],
    ),
    ("config", &[]),
    ("main", &["http", "config"]),
    ("lib", &[]),
];

/// The layers that meet the outside world.
const OUTER: &[&str] = &["http", "config", "main"];

/// What the core never names: the outside world, the clock, the terminal.
#[rustfmt::skip]
const OUTSIDE: &[&str] = &[
    "axum", "clap", "eprintln!", "http_body", "hyper", "mime", "println!", "prometheus_client", "rayon", "serde", "sha2",
    "std::env", "std::fs", "std::io", "std::net", "std::process", "SystemTime", "tokio", "tower", "tracing",
    "utoipa",
];

/// What can be read in one sitting.
const LONGEST_FILE: usize = 420;

#[test]
fn dependencies_point_down() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let layer = layer_of(&path);
        let Some((_, allowed)) = LAYERS.iter().find(|(name, _)| *name == layer) else {
            wrong.push(format!("{}: the layer {layer} is not in the list", path.display()));
            continue;
        };
        for (number, line) in code_lines(&text) {
            for named in modules_named(line) {
                let known = LAYERS.iter().any(|(name, _)| *name == named);
                if known && named != layer && !allowed.contains(&named.as_str()) {
                    wrong.push(format!("{}:{number}: {layer} names {named}", path.display()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_core_touches_nothing_outside() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let layer = layer_of(&path);
        if OUTER.contains(&layer.as_str()) {
            continue;
        }
        for (number, line) in code_lines(&text) {
            for word in OUTSIDE {
                if names(line, word) {
                    wrong.push(format!("{}:{number}: names {word}", path.display()));
                }
            }
            if layer != "budget" && names(line, "Instant") {
                wrong.push(format!("{}:{number}: reads the clock", path.display()));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn files_can_be_read_in_one_sitting() {
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        let lines = text.lines().count();
        if lines > LONGEST_FILE {
            wrong.push(format!("{}: {lines} lines, {LONGEST_FILE} at most", path.display()));
        }
        if !text.starts_with("//!") && !path.ends_with("tests.rs") {
            wrong.push(format!("{}: does not begin by saying what it is for", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn comments_are_no_wider_than_the_code() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let settings = fs::read_to_string(root.join("rustfmt.toml")).unwrap();
    let width: usize =
        settings.lines().find_map(|line| line.strip_prefix("max_width = ")).unwrap().trim().parse().unwrap();
    let mut wrong = Vec::new();
    for (path, text) in sources() {
        for (number, line) in text.lines().enumerate() {
            let comment = line.trim_start().starts_with("//");
            // A table has a line for each of its rows.
            let table = line.trim_start_matches([' ', '/', '!']).starts_with('|');
            if comment && !table && line.chars().count() > width {
                wrong.push(format!("{}:{}: {line}", path.display(), number + 1));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn the_tree_explains_itself() {
    for (path, _) in sources() {
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(!["mod", "utils", "util", "common", "misc", "helpers"].contains(&name), "{}", path.display());
        let folder = path.parent().unwrap();
        if folder != Path::new("src") {
            let head = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder).with_extension("rs");
            assert!(head.is_file(), "{} has no file that heads it", folder.display());
        }
    }
}

#[test]
fn modules_beside_each_other_form_no_circle() {
    let modules: BTreeMap<Vec<String>, String> =
        sources().into_iter().map(|(path, text)| (module_of(&path), text)).collect();
    // From one module to another beside it under the same parent: those that each names, with its
    // descendants.
    let mut named: BTreeMap<(Vec<String>, String), BTreeSet<String>> = BTreeMap::new();
    for (module, text) in modules.iter().filter(|(module, _)| !module.iter().any(|name| name == "tests")) {
        let code = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or_default();
        for other in paths_in(code).filter_map(|path| resolve(&path, module, &modules)) {
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
            circles.push(format!("{}::{start} is in a circle", parent.join("::")));
        }
    }
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn the_files_that_the_architecture_names_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let text = fs::read_to_string(root.join("docs/ARCHITECTURE.md")).unwrap();
    let named = text.split('`').skip(1).step_by(2);
    let paths: Vec<&str> = named
        .filter(|name| ["src/", "openapi/", "docs/", "tests/"].iter().any(|at| name.starts_with(at)))
        .collect();
    assert!(paths.len() > 40, "the paths were not found");
    for path in paths {
        let found = root.join(path).exists() || root.join(path).with_extension("rs").exists();
        assert!(found, "docs/ARCHITECTURE.md names {path}");
    }
}

/// The segments of a module's path, without the crate.
fn module_of(path: &Path) -> Vec<String> {
    let inner = path.strip_prefix("src").unwrap().with_extension("");
    inner.components().map(|name| name.as_os_str().to_str().unwrap().to_owned()).collect()
}

/// The paths that code names: of every `use`, its lists unfolded, and those that begin with the crate, a
/// parent or the module itself.
fn paths_in(code: &str) -> impl Iterator<Item = Vec<String>> {
    let code: Vec<&str> = code_lines(code).map(|(_, line)| line).collect();
    let code = code.join(" ");
    let mut paths = Vec::new();
    for (at, _) in code.match_indices("use ") {
        let statement = code[at + 4..].split(';').next().unwrap_or_default();
        unfold("", &statement.replace(char::is_whitespace, ""), &mut paths);
    }
    for first in ["crate::", "super::", "self::"] {
        for (at, _) in code.match_indices(first) {
            let is_path = |c: &char| c.is_alphanumeric() || *c == '_' || *c == ':';
            paths.push(code[at..].chars().take_while(is_path).collect());
        }
    }
    let segments =
        |path: String| path.split("::").filter(|name| !name.is_empty()).map(str::to_owned).collect();
    paths.into_iter().map(segments)
}

/// Appends the single paths of a tree of imports.
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

/// The module in which a path that `module` names ends, if it is another one.
fn resolve(
    path: &[String],
    module: &[String],
    modules: &BTreeMap<Vec<String>, String>,
) -> Option<Vec<String>> {
    let mut at = module.to_vec();
    let mut rest = path;
    match rest.first()?.as_str() {
        "crate" => {
            at.clear();
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
        _ => {}
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
    assert!(files.len() > 20, "the sources were not found");
    files
}

/// The top-level module a file belongs to.
fn layer_of(path: &Path) -> String {
    let first = path.components().nth(1).unwrap().as_os_str().to_str().unwrap();
    first.trim_end_matches(".rs").to_owned()
}

/// The first path segments after the crate's name.
fn modules_named(line: &str) -> Vec<String> {
    let mut named = Vec::new();
    for prefix in ["crate::", "toolpathd::"] {
        for (at, _) in line.match_indices(prefix) {
            let rest = line[at + prefix.len()..].chars();
            named.push(rest.take_while(|c| c.is_alphanumeric() || *c == '_').collect());
        }
    }
    named
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
