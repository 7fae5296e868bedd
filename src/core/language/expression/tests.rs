//! Tests of expressions: texts, domains, values and derivatives.

mod domains;
mod jets;
mod texts;
mod trees;

use super::Expression;

fn parsed(text: &str) -> Expression {
    Expression::parse(text).unwrap_or_else(|error| panic!("{text}: {error}"))
}
