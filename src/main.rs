//! The binary. [`toolpathd_server::commands`] holds what its commands do.

use std::process::ExitCode;

fn main() -> ExitCode {
    toolpathd_server::commands::run()
}
