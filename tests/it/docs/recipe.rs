//! The README's recipe: a table of points and a job, which a reader saves as files and sends.

use super::page::{Block, blocks, read};

/// The files that the reader of a document saves: the first block of each language, with the name that the
/// text tells.
pub fn files_of(blocks: &[Block]) -> Vec<(String, Vec<u8>)> {
    let of = |language: &str, name: &str| {
        let block = blocks.iter().find(|block| block.language == language)?;
        Some((name.to_owned(), block.text.clone().into_bytes()))
    };
    match (of("csv", "points.csv"), of("json", "job.json")) {
        (Some(points), Some(job)) => vec![points, job],
        _ => Vec::new(),
    }
}

#[test]
fn the_readme_has_a_recipe_for_points_in_a_csv_table() {
    let readme = read("README.md");
    let files = files_of(&blocks(&readme));
    assert_eq!(files.len(), 2, "README.md has no recipe");
    for (name, _) in files {
        assert!(readme.contains(&format!("`{name}`")), "README.md does not tell the name {name}");
    }
}
