//! The service as its callers meet it.

mod coding;
mod connection;
mod decoding;
mod events;
mod examples;
mod models;
mod negotiation;
mod programs;
mod shutdown;
mod support;
