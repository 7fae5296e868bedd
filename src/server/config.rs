//! The settings of the program. Each setting can be given as a flag or as an environment variable.

mod checking;
mod limits;
mod sending;

use std::net::SocketAddr;
use std::time::Duration;

use axum::http::{HeaderValue, Uri};
use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::dnc::NamedTarget;
use crate::receipt::SigningKey;
pub use checking::Checking;
pub use limits::Limits;
pub use sending::Sending;

/// The command line of the program.
#[derive(Debug, Parser)]
#[command(name = "toolpathd", version, about = "Turns part data into CNC toolpaths, over HTTP")]
pub struct Cli {
    #[command(subcommand)]
    pub command: Option<Command>,
    #[command(flatten)]
    pub settings: Settings,
}

#[derive(Debug, Clone, Subcommand)]
pub enum Command {
    /// Serve requests; also the default without a subcommand
    Serve,
    /// Print the OpenAPI contract
    Openapi,
    /// Check that the service at the listen address answers; exit code 0 if it does
    Healthcheck,
    /// Send NC programs to machine controls
    #[command(subcommand)]
    Dnc(Dnc),
    /// Check a receipt of `/v1/programs/verify`: prove all that it states anew. The exit code is 0 where the
    /// receipt holds and its verdict is `pass`
    Check(Checking),
}

#[derive(Debug, Clone, Subcommand)]
pub enum Dnc {
    /// Send a program over a serial port or a TCP connection; Ctrl-C stops at the end of a block, GRBL is
    /// held and reset
    Send(Sending),
}

/// How log lines are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum LogFormat {
    Text,
    Json,
}

#[derive(Debug, Clone, Args)]
#[command(next_help_heading = "Settings of the service")]
pub struct Settings {
    /// Address to listen on; port 0 takes a free port, and the program prints the address that it uses
    #[arg(long, env = "TOOLPATHD_LISTEN", default_value = "127.0.0.1:8080", global = true)]
    pub listen: SocketAddr,

    /// Permit an address that other machines reach; the service has no authentication
    #[arg(long, env = "TOOLPATHD_ALLOW_PUBLIC", value_parser = clap::builder::BoolishValueParser::new(), global = true)]
    pub allow_public: bool,

    /// Origins whose pages may call this service, such as `https://mes.example`; separate several with
    /// commas, or repeat the flag
    #[arg(long, env = "TOOLPATHD_CORS_ORIGIN", value_delimiter = ',', value_parser = origin, global = true)]
    pub cors_origin: Vec<HeaderValue>,

    /// Names under which callers reach this service, such as `cam.example.com`; separate several with commas,
    /// or repeat the flag. `*` stands for any name. Addresses, `localhost` and names without a dot need not
    /// be listed
    #[arg(long, env = "TOOLPATHD_HOST", value_delimiter = ',', global = true)]
    pub host: Vec<String>,

    /// Most connections open at a time; a further connection gets 503 for all but health checks and metrics
    #[arg(long, env = "TOOLPATHD_CONNECTIONS", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=1_000_000), global = true)]
    pub connections: u32,

    /// Most connections of one address at a time (of one /64 network for IPv6); a further connection gets 503
    /// for all but health checks and metrics. Raise this behind a proxy
    #[arg(long, env = "TOOLPATHD_CONNECTIONS_PER_ADDRESS", default_value_t = 512, value_parser = clap::value_parser!(u32).range(1..=1_000_000), global = true)]
    pub connections_per_address: u32,

    /// Most computations at a time [default: the number of processors]
    #[arg(long, env = "TOOLPATHD_WORKERS", value_parser = clap::value_parser!(u16).range(1..=1024), global = true)]
    pub workers: Option<u16>,

    /// Most requests that may wait for a worker; a further request is refused with 503
    #[arg(long, env = "TOOLPATHD_QUEUE", default_value_t = 64, value_parser = clap::value_parser!(u16).range(0..=10_000), global = true)]
    pub queue: u16,

    /// Largest request body, in bytes; a larger body is refused with 413
    #[arg(long, env = "TOOLPATHD_BODY_LIMIT", default_value_t = Limits::DEFAULT.body_bytes, value_parser = body_bytes, global = true)]
    pub body_limit: usize,

    /// Bytes of memory that the service may use; computations are stopped at 72 % of them [default: the
    /// memory of the machine, or the limit of the control group]
    #[arg(long, env = "TOOLPATHD_MEMORY", value_parser = clap::value_parser!(u64).range(64 * 1024 * 1024..), global = true)]
    pub memory: Option<u64>,

    /// Most bytes of all request bodies held at a time; a body beyond that is refused with 503. Must be at
    /// least --body-limit [default: an eighth of --memory, at most 268435456]
    #[arg(long, env = "TOOLPATHD_BODY_MEMORY", global = true)]
    pub body_memory: Option<usize>,

    /// Most bytes of all answers that wait for their callers; an answer beyond that is replaced by 503
    /// [default: an eighth of --memory, at most 268435456]
    #[arg(long, env = "TOOLPATHD_ANSWER_MEMORY", global = true)]
    pub answer_memory: Option<usize>,

    /// Most points of a surface
    #[arg(long, env = "TOOLPATHD_MAX_SURFACE_POINTS", default_value_t = Limits::DEFAULT.surface_points, global = true)]
    pub max_surface_points: usize,

    /// Most points or knots of a curve
    #[arg(long, env = "TOOLPATHD_MAX_CURVE_POINTS", default_value_t = Limits::DEFAULT.curve_points, global = true)]
    pub max_curve_points: usize,

    /// Most elements of an interpolated curve
    #[arg(long, env = "TOOLPATHD_MAX_ELEMENTS", default_value_t = Limits::DEFAULT.elements, global = true)]
    pub max_elements: usize,

    /// Most places at which one request drops a cutter
    #[arg(long, env = "TOOLPATHD_MAX_DROP_POINTS", default_value_t = Limits::DEFAULT.drop_points, global = true)]
    pub max_drop_points: usize,

    /// Most section planes of a milling job
    #[arg(long, env = "TOOLPATHD_MAX_SECTIONS", default_value_t = Limits::DEFAULT.sections, global = true)]
    pub max_sections: usize,

    /// Most moves of a toolpath, sent or computed
    #[arg(long, env = "TOOLPATHD_MAX_MOVES", default_value_t = Limits::DEFAULT.moves, global = true)]
    pub max_moves: usize,

    /// Most CL points of a milling job; a twenty-fifth where the cutter is lowered onto the surface
    #[arg(long, env = "TOOLPATHD_MAX_CL_POINTS", default_value_t = Limits::DEFAULT.cl_points, global = true)]
    pub max_cl_points: usize,

    /// Most points of all wires of a model
    #[arg(long, env = "TOOLPATHD_MAX_WIRE_POINTS", default_value_t = Limits::DEFAULT.wire_points, global = true)]
    pub max_wire_points: usize,

    /// Most samples of a motion
    #[arg(long, env = "TOOLPATHD_MAX_SAMPLES", default_value_t = Limits::DEFAULT.samples, global = true)]
    pub max_samples: usize,

    /// Most steps of the interpolation of a curve; a value of the curve takes one for each of its operations
    #[arg(long, env = "TOOLPATHD_MAX_CURVE_STEPS", default_value_t = Limits::DEFAULT.curve_steps, global = true)]
    pub max_curve_steps: u64,

    /// Most comparisons of the cutter with earlier cuts, of one pattern of a pocket
    #[arg(long, env = "TOOLPATHD_MAX_CUT_COMPARISONS", default_value_t = Limits::DEFAULT.cut_comparisons, global = true)]
    pub max_cut_comparisons: u64,

    /// Most programs rewritten as streams at a time; a further program is refused with 503
    #[arg(long, env = "TOOLPATHD_STREAMS", default_value_t = 16, value_parser = clap::value_parser!(u16).range(1..=1024), global = true)]
    pub streams: u16,

    /// Largest program that is rewritten as a stream, in bytes
    #[arg(long, env = "TOOLPATHD_STREAM_BYTES", default_value_t = 16 * 1024 * 1024 * 1024, global = true)]
    pub stream_bytes: u64,

    /// Longest duration of a stream, in seconds
    #[arg(long, env = "TOOLPATHD_STREAM_DEADLINE_S", default_value = "3600", value_parser = seconds, global = true)]
    pub stream_deadline_s: Duration,

    /// Time within which the headers of a request must be complete, in seconds
    #[arg(long, env = "TOOLPATHD_HEADER_TIMEOUT_S", default_value = "10", value_parser = seconds, global = true)]
    pub header_timeout_s: Duration,

    /// Longest pause within a request body, in seconds; a longer pause is answered with 408
    #[arg(long, env = "TOOLPATHD_BODY_TIMEOUT_S", default_value = "20", value_parser = seconds, global = true)]
    pub body_timeout_s: Duration,

    /// Longest time in which a request body must arrive, in seconds; a slower body is answered with 408
    #[arg(long, env = "TOOLPATHD_BODY_DEADLINE_S", default_value = "120", value_parser = seconds, global = true)]
    pub body_deadline_s: Duration,

    /// Longest time in which a caller takes none of the pieces of 32 KiB in which an answer is sent, in
    /// seconds; then the connection is closed
    #[arg(long, env = "TOOLPATHD_WRITE_TIMEOUT_S", default_value = "20", value_parser = seconds, global = true)]
    pub write_timeout_s: Duration,

    /// Longest time for which a request waits for a worker, in seconds; then it is refused with 503
    #[arg(long, env = "TOOLPATHD_QUEUE_WAIT_S", default_value = "10", value_parser = seconds, global = true)]
    pub queue_wait_s: Duration,

    /// Longest computation, in seconds, without the wait for a worker; a longer one is answered with 504. At
    /// shutdown the program ends after at most 28 s, whatever this setting is
    #[arg(long, env = "TOOLPATHD_DEADLINE_S", default_value = "25", value_parser = seconds, global = true)]
    pub deadline_s: Duration,

    /// Control to which the service may send programs: `NAME=serial:/dev/ttyUSB0,baud=9600,format=7e2` or
    /// `NAME=tcp:HOST:PORT`, with the settings of `dnc send`; separate several with semicolons, or repeat the
    /// flag
    #[arg(long, env = "TOOLPATHD_DNC_TARGET", value_delimiter = ';', global = true)]
    pub dnc_target: Vec<NamedTarget>,

    /// File with the private key that signs receipts, in PEM, as `openssl genpkey -algorithm ed25519` writes
    /// it; without it receipts are not signed
    #[arg(long, env = "TOOLPATHD_RECEIPT_KEY", global = true)]
    pub receipt_key: Option<SigningKey>,

    /// How log lines are written
    #[arg(long, env = "TOOLPATHD_LOG_FORMAT", value_enum, default_value = "text", global = true)]
    pub log_format: LogFormat,

    /// Which events are logged: a level, or directives such as `info,hyper=debug`
    #[arg(long, env = "TOOLPATHD_LOG", default_value = "info", global = true)]
    pub log: String,
}

impl Settings {
    /// Checks the rules that concern several settings together.
    ///
    /// # Errors
    /// A message for people that names the settings which contradict each other.
    pub fn check(&self) -> Result<(), String> {
        if !self.allow_public && !self.listen.ip().to_canonical().is_loopback() {
            return Err(format!(
                "{} is reached from other machines, and there is no authentication; if that is meant, say \
                 --allow-public (TOOLPATHD_ALLOW_PUBLIC=true)",
                self.listen
            ));
        }
        for (k, target) in self.dnc_target.iter().enumerate() {
            let earlier = &self.dnc_target[..k];
            if earlier.iter().any(|other| other.name == target.name) {
                return Err(format!("--dnc-target names `{}` twice", target.name));
            }
            let address = &target.target.address;
            if let Some(other) = earlier.iter().find(|other| other.target.address == *address) {
                return Err(format!(
                    "--dnc-target `{}` and `{}` both lead to {address}",
                    other.name, target.name
                ));
            }
        }
        if let Some(body_memory) = self.body_memory.filter(|memory| *memory < self.body_limit) {
            return Err(format!(
                "--body-memory {body_memory} is less than the largest body, --body-limit {}",
                self.body_limit
            ));
        }
        Ok(())
    }

    /// Bytes of bodies and bytes of answers that are held at a time; `memory` is what the process may use.
    pub fn held_bytes(&self, memory: Option<u64>) -> (usize, usize) {
        let eighth = memory.and_then(|memory| usize::try_from(memory / 8).ok());
        let usual = eighth.unwrap_or(usize::MAX).min(256 * 1024 * 1024);
        (self.body_memory.unwrap_or(usual.max(self.body_limit)), self.answer_memory.unwrap_or(usual))
    }

    /// Number of computations that run at a time: the setting, else the number of processors.
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
            curve_points: self.max_curve_points,
            elements: self.max_elements,
            drop_points: self.max_drop_points,
            sections: self.max_sections,
            moves: self.max_moves,
            cl_points: self.max_cl_points,
            wire_points: self.max_wire_points,
            samples: self.max_samples,
            curve_steps: self.max_curve_steps,
            cut_comparisons: self.max_cut_comparisons,
        }
    }
}

fn body_bytes(text: &str) -> Result<usize, String> {
    let most = 1_usize << 40;
    match text.parse() {
        Ok(bytes) if (1..=most).contains(&bytes) => Ok(bytes),
        Ok(bytes) => Err(format!("{bytes} bytes are outside 1..={most} bytes")),
        Err(_) => Err(format!("`{text}` is not a number of bytes")),
    }
}

fn seconds(text: &str) -> Result<Duration, String> {
    let seconds: f64 = text.parse().map_err(|_| format!("`{text}` is not a number of seconds"))?;
    if (0.001..=86_400.0).contains(&seconds) {
        Ok(Duration::from_secs_f64(seconds))
    } else {
        Err(format!("{text} s is outside 0.001..=86400 s"))
    }
}

/// Parses an origin as browsers send it: scheme, host and perhaps a port, in lower case, without a path.
fn origin(text: &str) -> Result<HeaderValue, String> {
    let uri: Uri = text.parse().map_err(|_| format!("`{text}` is not an origin"))?;
    let (scheme, authority) = (uri.scheme_str().unwrap_or_default(), uri.authority());
    let written = format!("{scheme}://{}", authority.map_or("", |authority| authority.as_str()));
    let is_origin = ["http", "https"].contains(&scheme) && authority.is_some() && !written.contains('@');
    if is_origin && written == text && text == text.to_ascii_lowercase() {
        HeaderValue::from_str(text).map_err(|_| format!("`{text}` is not an origin"))
    } else {
        Err(format!(
            "`{text}` is not an origin; write it as https://host or https://host:port, in lower case"
        ))
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
    fn without_a_subcommand_the_program_serves_with_default_settings() {
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
    fn a_public_address_needs_allow_public() {
        let check = |flags: &[&str]| Cli::parse_from(["toolpathd"].iter().chain(flags)).settings.check();
        for loopback in ["127.0.0.1:80", "127.9.9.9:80", "[::1]:80", "[::ffff:127.0.0.1]:80"] {
            assert_eq!(check(&["--listen", loopback]), Ok(()));
        }
        for public in ["0.0.0.0:80", "[::]:80", "192.168.0.7:80", "[::ffff:10.0.0.1]:80"] {
            let error = check(&["--listen", public]).expect_err("public");
            assert!(error.contains(public) && error.contains("--allow-public"), "{error}");
            assert_eq!(check(&["--listen", public, "--allow-public"]), Ok(()));
        }
        assert!(check(&["--body-limit", "1000", "--body-memory", "999"]).is_err());
    }

    #[test]
    fn targets_are_separated_by_semicolons_and_each_has_a_name_and_an_address_of_its_own() {
        let parse = |list: &str| Cli::try_parse_from(["toolpathd", "--dnc-target", list]);
        let two = "lathe=serial:/dev/ttyS0,baud=4800,format=7e1;mill=tcp:10.0.0.5:4001,flow=none";
        let settings = parse(two).expect("two targets").settings;
        assert_eq!(settings.dnc_target.len(), 2);
        assert_eq!(settings.check(), Ok(()));
        assert!(parse("lathe=serial:/dev/ttyS0,bauds=4800").is_err());
        for twice in ["a=tcp:box:1;a=tcp:box:2", "a=tcp:box:1;b=tcp:box:1"] {
            assert!(parse(twice).expect("targets").settings.check().is_err(), "{twice}");
        }
    }

    #[test]
    fn an_origin_is_a_scheme_and_a_host_and_perhaps_a_port() {
        let parse = |list: &str| Cli::try_parse_from(["toolpathd", "--cors-origin", list]);
        let cli = parse("https://mes.example,http://localhost:3000").expect("two origins");
        assert_eq!(cli.settings.cors_origin, ["https://mes.example", "http://localhost:3000"]);
        for wrong in
            "* null mes.example https:// https://a/ https://a/b https://A ftp://a https://u@a".split(' ')
        {
            assert!(parse(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn a_time_of_zero_or_nan_is_refused() {
        assert!(Cli::try_parse_from(["toolpathd", "--deadline-s", "0"]).is_err());
        assert!(Cli::try_parse_from(["toolpathd", "--deadline-s", "nan"]).is_err());
    }
}
