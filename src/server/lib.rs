//! The HTTP service, the sending of programs to controls, the check of receipts, the settings, and the log.

mod check;
pub mod commands;
pub mod config;
pub mod dnc;
pub mod http;
mod log;
mod receipt;
