//! What a request brings: its id, trace and keys, the form of the answer that it asks for, and its body.
//!
//! Here belongs what reads the head or the body of a request. The fields of a body are the business of
//! [`decode`](super::decode) and [`dto`](super::dto).

pub mod accept;
pub mod arrival;
pub mod body;
pub mod coding;
pub mod multipart;
pub mod negotiation;
pub mod representation;
pub mod request_id;
pub mod retry;
pub mod trace;
