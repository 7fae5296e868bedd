//! The documents agree with the service: their examples are run, and every operation has a section.

mod codes;
mod curl;
mod examples;
mod five_axis_words;
mod links;
mod operations;
mod page;
mod readme;
mod recipe;
