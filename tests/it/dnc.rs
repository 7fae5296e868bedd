//! DNC against mock controls: on pseudo terminals, on TCP connections, by the command and over HTTP.

mod command;
mod grbl;
mod http;
mod mock;
mod serial;
mod speed;
mod tcp;
