//! The service as its callers meet it.

mod coding;
mod connection;
mod decoding;
mod determinism;
mod events;
mod models;
mod negotiation;
mod operation;
mod program;
mod shutdown;
mod support;
mod surfaces;
