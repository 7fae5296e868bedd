//! The documents agree with the service: their examples are run, and their tables match the contract.

mod codes;
mod curl;
mod examples;
mod fields;
mod links;
mod page;
mod readme;
mod recipe;
mod schema;
