//! The service as its callers meet it.

mod coding;
mod connection;
mod decoding;
mod events;
mod negotiation;
mod shutdown;
mod support;
mod surfaces;
