//! Runs the README's recipe: a few lines of Python that make a request from a CSV table of points.
//!
//! The test needs no Python. A Rust function does the same as the lines that group the points, and the rest
//! of the request is read from the README.

use serde_json::{Value, json};

use super::page::{Block, blocks, read};

/// The lines of the recipe that do the same as [`grid`].
const GROUPING: &str = "\
columns = {}
for x, y, z in sorted([float(cell) for cell in row] for row in csv.reader(open(\"points.csv\"))):
    columns.setdefault(x, []).append([x, y, z])
";

/// The expression that stands for the points in the body of the recipe.
const POINTS: &str = "list(columns.values())";

/// The name of the file that the recipe writes, and its bytes. `None` if the document has no recipe.
pub fn body_of(blocks: &[Block]) -> Option<(String, Vec<u8>)> {
    let of = |language: &str| blocks.iter().find(|block| block.language == language);
    let (csv, python) = (of("csv")?, of("python")?);
    assert!(
        python.text.contains(GROUPING),
        "the recipe groups its points in another way than this test:\n{GROUPING}"
    );
    let (_, rest) = python.text.split_once("\njob = {\n").expect("the body");
    let (body, rest) = rest.split_once("\n}\n").expect("the end of the body");
    assert_eq!(rest.trim(), "json.dump(job, open(\"job.json\", \"w\"))");
    let body = format!("{{{}}}", body.trim_end().trim_end_matches(','));
    let body = body.replace(POINTS, &grid(&csv.text).to_string());
    let body: Value = serde_json::from_str(&body).expect("a body that is also JSON");
    Some(("job.json".to_owned(), body.to_string().into_bytes()))
}

/// The points of a table `x,y,z` as a grid: a list of points for each x, sorted by x and then by y.
fn grid(csv: &str) -> Value {
    let number = |cell: &str| cell.trim().parse::<f64>().expect("a number");
    let mut points: Vec<Vec<f64>> = csv.lines().map(|line| line.split(',').map(number).collect()).collect();
    points.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let columns: Vec<&[Vec<f64>]> = points.chunk_by(|a, b| a[0] == b[0]).collect();
    json!(columns)
}

#[test]
fn the_readme_has_a_recipe_for_points_in_a_csv_table() {
    assert!(body_of(&blocks(&read("README.md"))).is_some(), "README.md has no recipe");
}

#[test]
fn table_rows_in_any_order_become_a_sorted_grid() {
    assert_eq!(
        grid("5,0,1\n0,5,2\n0,0,3\n5,5,4\n"),
        json!([[[0.0, 0.0, 3.0], [0.0, 5.0, 2.0]], [[5.0, 0.0, 1.0], [5.0, 5.0, 4.0]]])
    );
}
