//! The service as its callers meet it.

mod connection;
mod decoding;
mod negotiation;
mod programs;
mod shutdown;
mod support;
mod surfaces;
