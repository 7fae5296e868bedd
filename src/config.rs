//! The settings: every one a flag, each with an environment variable.

use std::net::SocketAddr;
use std::time::Duration;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// What the program is asked to do.
#[derive(Debug, Parser)]
#[command(name = "toolpathd", version, about = "Turns part data into CNC toolpaths, over HTTP")]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub settings: Settings,
}

#[derive(Debug, Clone, Copy, Subcommand)]
pub enum Command {
    /// Serve requests (what happens without a subcommand, too)
    Serve,
    /// Print the OpenAPI contract
    Openapi,
    /// Ask the service at the listen address of this machine whether it lives; exit code 0 if so
    Healthcheck,
}

/// How log lines are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    Text,
    Json,
}

#[derive(Debug, Clone, Args)]
pub struct Settings {
    /// Address to listen on; port 0 takes a free one, which the log names
    #[arg(long, env = "TOOLPATHD_LISTEN", default_value = "127.0.0.1:8080", global = true)]
    pub listen: SocketAddr,

    /// Computations at a time [default: the number of processors]
    #[arg(long, env = "TOOLPATHD_WORKERS", value_parser = clap::value_parser!(u16).range(1..=1024), global = true)]
    pub workers: Option<u16>,

    /// Requests that may wait for a worker; one more is refused with 503
    #[arg(long, env = "TOOLPATHD_QUEUE", default_value_t = 64, value_parser = clap::value_parser!(u16).range(0..=10_000), global = true)]
    pub queue: u16,

    /// Largest request body, bytes
    #[arg(long, env = "TOOLPATHD_BODY_LIMIT", default_value_t = Limits::DEFAULT.body_bytes, global = true)]
    pub body_limit: usize,

    /// Most points of a surface
    #[arg(long, env = "TOOLPATHD_MAX_SURFACE_POINTS", default_value_t = Limits::DEFAULT.surface_points, global = true)]
    pub max_surface_points: usize,

    /// Most section planes of a milling job
    #[arg(long, env = "TOOLPATHD_MAX_SECTIONS", default_value_t = Limits::DEFAULT.sections, global = true)]
    pub max_sections: usize,

    /// Most moves of a toolpath that is sent
    #[arg(long, env = "TOOLPATHD_MAX_MOVES", default_value_t = Limits::DEFAULT.moves, global = true)]
    pub max_moves: usize,

    /// Seconds within which a request's headers must be complete
    #[arg(long, env = "TOOLPATHD_HEADER_TIMEOUT_S", default_value = "10", value_parser = seconds, global = true)]
    pub header_timeout_s: Duration,

    /// Seconds a request body may go without progress
    #[arg(long, env = "TOOLPATHD_BODY_TIMEOUT_S", default_value = "20", value_parser = seconds, global = true)]
    pub body_timeout_s: Duration,

    /// Seconds a request may wait and compute; at shutdown nothing is waited for longer than 28 s
    #[arg(long, env = "TOOLPATHD_DEADLINE_S", default_value = "25", value_parser = seconds, global = true)]
    pub deadline_s: Duration,

    /// How log lines are written
    #[arg(long, env = "TOOLPATHD_LOG_FORMAT", value_enum, default_value = "text", global = true)]
    pub log_format: LogFormat,

    /// What is logged: a level, or directives such as `info,hyper=debug`
    #[arg(long, env = "TOOLPATHD_LOG", default_value = "info", global = true)]
    pub log: String,
}

impl Settings {
    /// Computations at a time.
    pub fn workers(&self) -> usize {
        match self.workers {
            Some(workers) => usize::from(workers),
            None => std::thread::available_parallelism().map_or(1, usize::from),
        }
    }

    pub fn limits(&self) -> Limits {
        Limits {
            body_bytes: self.body_limit,
            surface_points: self.max_surface_points,
            sections: self.max_sections,
            moves: self.max_moves,
        }
    }
}

/// How large a request may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limits {
    /// Bytes of a request body.
    pub body_bytes: usize,
    /// Points of one surface.
    pub surface_points: usize,
    /// Section planes of one milling job.
    pub sections: usize,
    /// Moves of one toolpath that is sent.
    pub moves: usize,
}

impl Limits {
    /// The limits written into the contract; a server may be set otherwise and says so at `/v1/limits`.
    pub const DEFAULT: Limits =
        Limits { body_bytes: 16 * 1024 * 1024, surface_points: 250_000, sections: 20_000, moves: 500_000 };
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("`{text}` is not a number of seconds"))?;
    if (0.001..=86_400.0).contains(&seconds) {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err(format!("{text} s is outside 0.001..=86400 s"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_is_consistent_and_every_flag_has_a_variable() {
        use clap::CommandFactory;
        let command = Cli::command();
        command.clone().debug_assert();
        for argument in
            command.get_arguments().filter(|a| !["help", "version"].contains(&a.get_id().as_str()))
        {
            let variable = argument.get_env().and_then(|v| v.to_str()).unwrap_or_default();
            assert!(variable.starts_with("TOOLPATHD_"), "{} has no variable", argument.get_id());
        }
    }

    #[test]
    fn nothing_serves() {
        let cli = Cli::parse_from(["toolpathd"]);
        assert!(cli.command.is_none());
        assert_eq!(cli.settings.limits(), Limits::DEFAULT);
        assert_eq!(cli.settings.header_timeout_s, Duration::from_secs(10));
    }

    #[test]
    fn flags_may_follow_the_subcommand() {
        let cli = Cli::parse_from(["toolpathd", "serve", "--listen", "127.0.0.1:0", "--workers", "3"]);
        assert!(matches!(cli.command, Some(Command::Serve)));
        assert_eq!(cli.settings.workers(), 3);
    }

    #[test]
    fn a_timeout_of_no_time_is_refused() {
        assert!(Cli::try_parse_from(["toolpathd", "--deadline-s", "0"]).is_err());
        assert!(Cli::try_parse_from(["toolpathd", "--deadline-s", "nan"]).is_err());
    }
}
