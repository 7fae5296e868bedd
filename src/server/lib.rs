//! The HTTP service, the sending of programs to controls, the settings of both, and the log.

pub mod commands;
pub mod config;
pub mod dnc;
pub mod http;
mod log;
