//! The documents hold what the service does: their examples are run, their tables are those of the contract.

mod codes;
mod curl;
mod examples;
mod fields;
mod links;
mod page;
mod readme;
mod recipe;
mod schema;
