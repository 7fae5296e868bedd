//! Tests of expressions: their texts, their domains, and their values and derivatives compared with random
//! trees.

mod domains;
mod jets;
mod texts;
mod trees;

use super::Expression;

fn parsed(text: &str) -> Expression {
    Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}
