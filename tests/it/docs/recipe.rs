//! Runs the README's recipe: a few lines of Python that make a request from a CSV table of points.
//!
//! The test needs no Python. A Rust function does the same as the lines that group the points, and the rest
//! of the request is read from the README.

use serde_json::{Value, json};

use super::page::{Block, blocks, read};

/// The lines of the recipe that do the same as [`grid`].
const GROUPING: &str = "\
open(\"job.json\", \"w\").close()
text = open(\"points.csv\").read()
if \";\" in text:
    text = text.replace(\",\", \".\").replace(\";\", \",\")
points = sorted([*map(float, line.split(\",\"))] for line in text.split())
pitch = max(b[0] - a[0] for a, b in zip(points, points[1:]))
columns = [[points[0]]]
for point in points[1:]:
    if point[0] > columns[-1][-1][0] + pitch / 10:
        columns.append([])
    columns[-1].append(point)
";

/// The expression that stands for the points in the body of the recipe.
const POINTS: &str = "[sorted(c, key=lambda p: p[1]) for c in columns]";

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

/// The points of a table `x,y,z`, or `x;y;z` with decimal commas, as a grid: a list of points for each column,
/// sorted by x and then by y. A column ends where x grows by more than a tenth of the largest step.
fn grid(csv: &str) -> Value {
    let text = if csv.contains(';') { csv.replace(',', ".").replace(';', ",") } else { csv.to_owned() };
    let number = |cell: &str| cell.parse::<f64>().expect("a number");
    let mut points: Vec<Vec<f64>> =
        text.split_whitespace().map(|line| line.split(',').map(number).collect()).collect();
    points.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let largest = points.windows(2).map(|pair| pair[1][0] - pair[0][0]).fold(0.0, f64::max);
    let mut columns: Vec<Vec<Vec<f64>>> =
        points.chunk_by(|a, b| b[0] - a[0] <= largest / 10.0).map(<[_]>::to_vec).collect();
    columns.iter_mut().for_each(|column| column.sort_by(|a, b| a[1].total_cmp(&b[1])));
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

#[test]
fn points_that_scatter_in_x_make_the_columns_of_a_grid() {
    let measured = "0.004;0;2,1\n-0,003;15;3,5\n0,001;30,002;2\n20,002;30;4\n19,996;0;4\n20;15;6,5\n";
    let columns = grid(measured);
    let of = |i: usize| columns[i].as_array().map_or(0, Vec::len);
    assert_eq!((columns.as_array().map(Vec::len), of(0), of(1)), (Some(2), 3, 3));
    assert_eq!(columns[0][1], json!([-0.003, 15.0, 3.5]));
    assert_eq!(columns[1][0], json!([19.996, 0.0, 4.0]));
}
