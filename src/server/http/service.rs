//! What every request passes, whatever it asks for, and what supervisors ask.
//!
//! Here belong the layers around all handlers: the record of each request in log and metrics, the check of
//! the host name, admission, the memory of answers, and the shape of failures; and the routes for health
//! checks, metrics and the pages of the documentation.

pub mod admission;
pub mod answer_memory;
pub mod cors;
mod counted_body;
pub mod docs;
pub mod envelope;
pub mod guard;
pub mod health;
pub mod metrics;
pub mod observe;
pub mod repeated_key;
