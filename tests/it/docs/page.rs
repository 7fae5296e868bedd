//! Reads the fenced blocks and the headings of a markdown file, with line numbers.

use std::fs;
use std::path::{Path, PathBuf};

/// The root of the package.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

/// The text of a file, by its path in the package.
pub fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// A fenced block.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Block {
    /// The line of the opening fence, from 1.
    pub line: usize,
    /// The word after the opening fence: `sh`, `csv`, or nothing.
    pub language: String,
    pub text: String,
}

/// The fenced blocks of a markdown text, in order.
pub fn blocks(markdown: &str) -> Vec<Block> {
    let mut blocks = Vec::new();
    let mut open: Option<Block> = None;
    for (index, line) in markdown.lines().enumerate() {
        match (line.strip_prefix("```"), open.as_mut()) {
            (Some(language), None) => {
                let language = language.trim().to_owned();
                open = Some(Block { line: index + 1, language, text: String::new() });
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (None, Some(block)) => {
                block.text.push_str(line);
                block.text.push('\n');
            }
            (None, None) => {}
        }
    }
    assert_eq!(open, None, "a fenced block does not end");
    blocks
}

/// The headings of a markdown text, without `#`, with the indices of their lines.
pub fn headings(markdown: &str) -> Vec<(usize, &str)> {
    let mut in_block = false;
    let mut found = Vec::new();
    for (index, line) in markdown.lines().enumerate() {
        in_block ^= line.starts_with("```");
        if !in_block && line.starts_with('#') {
            found.push((index, line.trim_start_matches('#').trim()));
        }
    }
    found
}

/// The anchor of a heading, as renderers of markdown make it.
pub fn anchor(heading: &str) -> String {
    let kept = heading.chars().filter(|c| c.is_alphanumeric() || [' ', '-', '_'].contains(c));
    kept.collect::<String>().to_lowercase().replace(' ', "-")
}

#[test]
fn blocks_end_at_their_fence_and_headings_inside_blocks_do_not_count() {
    let found = blocks("text\n```sh\ncargo test\n```\n# End\n```\n# no heading\n```\n");
    let languages: Vec<_> = found.iter().map(|block| (block.line, block.language.as_str())).collect();
    assert_eq!(languages, [(2, "sh"), (6, "")]);
    assert_eq!(found[0].text, "cargo test\n");
    assert_eq!(
        headings("# Start\n```\n# no heading\n```\n## The `kind`\n"),
        [(0, "Start"), (4, "The `kind`")]
    );
    assert_eq!(anchor("`POST /v1/surfaces/mill`"), "post-v1surfacesmill");
}
