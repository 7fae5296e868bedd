//! Every link of the documents to a file or a heading of this package has its target.

use std::path::Path;

use super::page::{anchor, headings, read, root};

/// The paths of all documents, with the decisions.
fn documents() -> Vec<String> {
    let mut paths = vec!["README.md".to_owned(), "CHANGELOG.md".to_owned()];
    for folder in ["docs", "docs/decisions"] {
        let entries = std::fs::read_dir(root().join(folder)).expect("a folder");
        let names = entries.map(|entry| entry.expect("an entry").file_name().into_string().expect("a name"));
        paths.extend(names.filter(|name| name.ends_with(".md")).map(|name| format!("{folder}/{name}")));
    }
    paths
}

/// The targets of the links `[text](target)` outside of fenced blocks.
fn links(markdown: &str) -> Vec<&str> {
    let mut in_block = false;
    let mut found = Vec::new();
    for line in markdown.lines() {
        in_block ^= line.starts_with("```");
        if !in_block {
            found.extend(line.split("](").skip(1).filter_map(|rest| rest.split(')').next()));
        }
    }
    found
}

#[test]
fn every_link_leads_to_an_existing_file_and_heading() {
    let (mut dead, mut n_links) = (Vec::new(), 0);
    for path in documents() {
        let markdown = read(&path);
        for link in links(&markdown).into_iter().filter(|link| !link.contains("://")) {
            n_links += 1;
            let (file, place) = link.split_once('#').unwrap_or((link, ""));
            let target = match file {
                "" => path.clone(),
                file => Path::new(&path)
                    .parent()
                    .expect("a folder")
                    .join(file)
                    .to_str()
                    .expect("UTF-8")
                    .to_owned(),
            };
            let is_there = root().join(&target).exists()
                && (place.is_empty()
                    || headings(&read(&target)).iter().any(|(_, title)| anchor(title) == place));
            if !is_there {
                dead.push(format!("{path}: the link {link} leads nowhere"));
            }
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
    assert!(n_links > 10, "only {n_links} links were found");
}

/// The modules that the third cell of a row names, as `a/b` or as `a/{b, c}`.
fn modules(row: &str) -> Vec<String> {
    let cell = row.trim_matches('|').split('|').nth(2).unwrap_or_default();
    let paths = cell.split('`').skip(1).step_by(2).filter(|path| path.contains('/'));
    let each = |path: &str| match path.split_once('{') {
        Some((folder, names)) => {
            names.trim_end_matches('}').split(", ").map(|name| format!("{folder}{name}")).collect()
        }
        None => vec![path.to_owned()],
    };
    paths.flat_map(each).collect()
}

#[test]
fn every_module_that_the_papers_page_names_exists() {
    let page = read("docs/papers.md");
    let named: Vec<String> = page.lines().filter(|line| line.starts_with("| ")).flat_map(modules).collect();
    assert!(named.len() > 10, "only these modules were found: {named:?}");
    let missing: Vec<_> =
        named.iter().filter(|name| !root().join(format!("src/{name}.rs")).exists()).collect();
    assert!(missing.is_empty(), "docs/papers.md names modules that do not exist: {missing:?}");
}
