//! The commands of the binary: start the service, check a running service, print the contract (the OpenAPI
//! description of the service), send a program to a control, or check a receipt.

use std::io::{IsTerminal, Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, TcpStream};
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant};

use crate::check::check;
use crate::config::{Checking, Cli, Command, Dnc, LogFormat, Sending, Settings};
use crate::dnc::{Estimate, Outcome, Progress, Stop, Target, estimate, send};
use crate::http::{App, contract, router, serve};
use clap::Parser;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use tokio::net::TcpListener;
use tokio::signal::unix::{Signal, SignalKind, signal};
use tokio::sync::oneshot;
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

type Failure = Box<dyn std::error::Error>;

/// Reads the settings from flags and environment variables, and runs the command that they name.
pub fn run() -> ExitCode {
    let cli = Cli::parse();
    let outcome = match cli.command {
        Some(Command::Openapi) => print_contract(),
        Some(Command::Healthcheck) => check_health(&cli.settings),
        Some(Command::Dnc(Dnc::Send(sending))) => send_program(&sending),
        Some(Command::Check(checking)) => check_receipt(&checking, &cli.settings),
        None | Some(Command::Serve) => serve_until_signal(&cli.settings),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "toolpathd: {error}");
            ExitCode::FAILURE
        }
    }
}

fn print_contract() -> Result<(), Failure> {
    Ok(writeln!(std::io::stdout(), "{}", contract())?)
}

/// Checks a receipt, and tells what holds.
fn check_receipt(checking: &Checking, settings: &Settings) -> Result<(), Failure> {
    let text = check(checking, &settings.limits())?;
    Ok(writeln!(std::io::stdout(), "{text}")?)
}

/// Asks a running service for `/livez`. An image without a shell and curl uses this as its health check.
fn check_health(settings: &Settings) -> Result<(), Failure> {
    const ANSWER_TIMEOUT: Duration = Duration::from_secs(3);
    let mut address = settings.listen;
    match address.ip().to_canonical() {
        ip if !ip.is_unspecified() => {}
        IpAddr::V4(_) => address.set_ip(Ipv4Addr::LOCALHOST.into()),
        IpAddr::V6(_) => address.set_ip(Ipv6Addr::LOCALHOST.into()),
    }
    let mut stream = TcpStream::connect_timeout(&address, ANSWER_TIMEOUT)
        .map_err(|error| format!("{address} does not answer: {error}"))?;
    stream.set_read_timeout(Some(ANSWER_TIMEOUT))?;
    stream.write_all(b"GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer)?;
    match answer.split(' ').nth(1) {
        Some("200") => Ok(()),
        _ => Err(format!("{address} does not answer as it should").into()),
    }
}

fn serve_until_signal(settings: &Settings) -> Result<(), Failure> {
    settings.check()?;
    let lines = start_log(settings)?;
    raise_limit_of_files();
    let app = App::new(settings);
    let runtime = tokio::runtime::Builder::new_multi_thread().enable_all().build()?;
    let served = runtime.block_on(async {
        // The handlers come before the address is printed: a reader of the address may send a signal at once.
        let mut signals = Signals::new()?;
        let listener = TcpListener::bind(settings.listen)
            .await
            .map_err(|error| format!("cannot listen on {}: {error}", settings.listen))?;
        let address = listener.local_addr()?;
        // Nobody may be there to read the address.
        let _ = writeln!(std::io::stdout(), "listening on http://{address}");
        let (stop, stopped) = oneshot::channel();
        tokio::spawn(async move {
            signals.next().await;
            let _ = stop.send(());
            signals.next().await;
            std::process::exit(SECOND_SIGNAL);
        });
        let stopped = async move {
            let _ = stopped.await;
        };
        Ok::<_, Failure>(serve(listener, router(&app), &app, stopped).await?)
    });
    // A computation that has not noticed yet that it must stop does not hold up the end.
    runtime.shutdown_background();
    lines.finish();
    served
}

/// The exit code after a second signal, which ends the program at once.
const SECOND_SIGNAL: i32 = 130;

/// The signals that end the service: SIGTERM, SIGINT and SIGHUP.
struct Signals([Signal; 3]);

impl Signals {
    fn new() -> std::io::Result<Self> {
        let of = |kind| signal(kind);
        Ok(Self([of(SignalKind::terminate())?, of(SignalKind::interrupt())?, of(SignalKind::hangup())?]))
    }

    async fn next(&mut self) {
        let [terminate, interrupt, hangup] = &mut self.0;
        tokio::select! {
            _ = terminate.recv() => {}
            _ = interrupt.recv() => {}
            _ = hangup.recv() => {}
        }
    }
}

/// Permits as many open files as the system lets this process have: each connection is one.
fn raise_limit_of_files() {
    use rustix::process::{Resource, getrlimit, setrlimit};
    let mut limit = getrlimit(Resource::Nofile);
    limit.current = limit.maximum;
    if let Err(error) = setrlimit(Resource::Nofile, limit) {
        tracing::warn!(%error, "the limit of open files stays low");
    }
}

/// Starts the log on standard error. Standard output is for the address and the contract.
fn start_log(settings: &Settings) -> Result<crate::log::Lines, Failure> {
    let targets: Targets = settings
        .log
        .parse()
        .map_err(|error| format!("--log `{}` is not understood: {error}", settings.log))?;
    let (lines, writer) = crate::log::lines(std::io::stderr())?;
    let log = tracing_subscriber::fmt()
        .with_max_level(LevelFilter::TRACE)
        .log_internal_errors(false)
        .with_writer(move || writer.clone());
    match settings.log_format {
        LogFormat::Text => {
            log.with_ansi(std::io::stderr().is_terminal()).finish().with(targets).init();
        }
        LogFormat::Json => {
            log.json().flatten_event(true).with_span_list(false).finish().with(targets).init();
        }
    }
    Ok(lines)
}

/// Sends a program to a control. The first signal ends the sending at the end of a block, the second at once.
fn send_program(sending: &Sending) -> Result<(), Failure> {
    let target = sending.target()?;
    let program = read_program(&sending.file)?;
    let name = sending.file.display();
    if sending.estimate {
        let estimate =
            Estimate::of(&program, &target.settings).map_err(|error| format!("{name}: {error}"))?;
        return tell_estimate(&estimate, &target);
    }
    let stop = Stop::default();
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
    let begun = Instant::now();
    let outcome = runtime.block_on(async {
        let mut terminate = signal(SignalKind::terminate())?;
        let mut interrupt = signal(SignalKind::interrupt())?;
        let asked = stop.clone();
        let mut sending = tokio::task::spawn_blocking(move || {
            let bar = bar();
            let outcome = send(&program, &target, &asked, &mut |progress| show(&bar, progress, begun));
            bar.finish_and_clear();
            outcome
        });
        loop {
            tokio::select! {
                outcome = &mut sending => return Ok::<_, Failure>(outcome?),
                _ = terminate.recv() => {}
                _ = interrupt.recv() => {}
            }
            if stop.is_asked() { stop.at_once() } else { stop.at_block() }
        }
    })?;
    let outcome = outcome.map_err(|error| format!("{name}: {error}"))?;
    let Outcome { progress, n_pauses, waited, n_received: _, failure, left, delivery } = outcome;
    let Progress { n_characters, n_lines, n_lines_total, .. } = progress;
    if let Some(failure) = failure {
        let sent =
            format!("{n_lines} of {n_lines_total} lines and {n_characters} characters were sent for certain");
        return Err(format!("{name}: {failure}; {sent}; {left}").into());
    }
    let seconds = begun.elapsed().as_secs_f64();
    let known = delivery.map_or("", |delivery| delivery.meaning());
    writeln!(
        std::io::stdout(),
        "sent {n_lines} lines, {n_characters} characters in {seconds:.1} s; {known}"
    )?;
    if n_pauses > 0 {
        let waited = waited.as_secs_f64();
        writeln!(std::io::stdout(), "pauses that the control made: {n_pauses}, {waited:.1} s in all")?;
    }
    Ok(())
}

fn read_program(path: &Path) -> Result<Vec<u8>, Failure> {
    let mut program = Vec::new();
    if path == Path::new("-") {
        std::io::stdin().read_to_end(&mut program)?;
    } else {
        program = std::fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
    }
    Ok(program)
}

fn tell_estimate(estimate: &Estimate, target: &Target) -> Result<(), Failure> {
    let Estimate { n_characters, n_lines, characters_per_s, time, blocks_per_s, starving_feed } = estimate;
    let (baud, format, seconds) = (target.settings.baud(), target.settings.format(), time.as_secs_f64());
    let pace = if target.is_paced() { "" } else { " (the sender itself keeps no pace)" };
    writeln!(
        std::io::stdout(),
        "{n_lines} lines, {n_characters} characters: {seconds:.1} s at {baud} baud in {format}, which is \
         {characters_per_s:.0} characters a second{pace}\n\
         {blocks_per_s:.1} blocks a second: moves of {} mm arrive too slowly for feeds above \
         {starving_feed:.0} mm/min",
        estimate::MOVE_MM
    )?;
    Ok(())
}

/// A progress bar on standard error; it shows nothing where standard error is no terminal.
fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(None, ProgressDrawTarget::stderr());
    let style = ProgressStyle::with_template("{bar:24} {percent:>3} % {msg}");
    bar.with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}

/// Rates are not taken over a shorter time: the first characters would show millions per second.
const SHORTEST: Duration = Duration::from_millis(1);

fn show(bar: &ProgressBar, progress: &Progress, begun: Instant) {
    let Progress { n_characters, n_characters_total, n_lines, n_lines_total, is_waiting, is_paused } =
        *progress;
    bar.set_length(n_characters_total as u64);
    bar.set_position(n_characters as u64);
    let rate = n_characters as f64 / begun.elapsed().max(SHORTEST).as_secs_f64();
    let state = match (n_characters_total - n_characters) as f64 / rate {
        _ if is_paused => "the machine waits for its operator".to_owned(),
        _ if is_waiting => "waiting for the control".to_owned(),
        left if left.is_finite() => format!("{rate:.0} characters/s, {left:.0} s left"),
        _ => "starting".to_owned(),
    };
    bar.set_message(format!("line {n_lines} of {n_lines_total}, {n_characters} characters, {state}"));
}
