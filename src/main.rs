//! The binary. It reads the settings and runs one of three commands: start the service, check a running
//! service, or print the contract (the OpenAPI description of the service).

use std::io::{IsTerminal, Read, Write};
use std::net::{IpAddr, Ipv4Addr, Ipv6Addr, TcpStream};
use std::process::ExitCode;
use std::time::Duration;

use clap::Parser;
use tokio::net::TcpListener;
use tokio::signal::unix::{SignalKind, signal};
use toolpathd::config::{Cli, Command, LogFormat, Settings};
use toolpathd::http::{App, contract, router, serve};
use tracing_subscriber::filter::{LevelFilter, Targets};
use tracing_subscriber::layer::SubscriberExt;
use tracing_subscriber::util::SubscriberInitExt;

type Failure = Box<dyn std::error::Error>;

fn main() -> ExitCode {
    let cli = Cli::parse();
    let outcome = match cli.command {
        Some(Command::Openapi) => print_contract(),
        Some(Command::Healthcheck) => check_health(&cli.settings),
        None | Some(Command::Serve) => run(&cli.settings),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("toolpathd: {error}");
            ExitCode::FAILURE
        }
    }
}

fn print_contract() -> Result<(), Failure> {
    Ok(writeln!(std::io::stdout(), "{}", contract())?)
}

/// Asks a running service for `/livez`. An image without a shell and curl uses this as its health check.
fn check_health(settings: &Settings) -> Result<(), Failure> {
    const PATIENCE: Duration = Duration::from_secs(3);
    let mut address = settings.listen;
    match address.ip().to_canonical() {
        ip if !ip.is_unspecified() => {}
        IpAddr::V4(_) => address.set_ip(Ipv4Addr::LOCALHOST.into()),
        IpAddr::V6(_) => address.set_ip(Ipv6Addr::LOCALHOST.into()),
    }
    let mut stream = TcpStream::connect_timeout(&address, PATIENCE)
        .map_err(|error| format!("{address} does not answer: {error}"))?;
    stream.set_read_timeout(Some(PATIENCE))?;
    stream.write_all(b"GET /livez HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")?;
    let mut answer = String::new();
    stream.read_to_string(&mut answer)?;
    match answer.split(' ').nth(1) {
        Some("200") => Ok(()),
        _ => Err(format!("{address} does not answer as it should").into()),
    }
}

fn run(settings: &Settings) -> Result<(), Failure> {
    settings.check()?;
    start_log(settings)?;
    let app = App::new(settings)?;
    tokio::runtime::Builder::new_multi_thread().enable_all().build()?.block_on(async {
        // The handlers come before the address is printed: a reader of the address may send a signal at once.
        let mut terminate = signal(SignalKind::terminate())?;
        let mut interrupt = signal(SignalKind::interrupt())?;
        let listener = TcpListener::bind(settings.listen)
            .await
            .map_err(|error| format!("cannot listen on {}: {error}", settings.listen))?;
        writeln!(std::io::stdout(), "listening on http://{}", listener.local_addr()?)?;
        let stop = async move {
            tokio::select! {
                _ = terminate.recv() => {}
                _ = interrupt.recv() => {}
            }
        };
        serve::serve(listener, router(&app), &app, stop).await?;
        Ok(())
    })
}

/// Starts the log on standard error. Standard output is for the address and the contract.
fn start_log(settings: &Settings) -> Result<(), Failure> {
    let targets: Targets = settings
        .log
        .parse()
        .map_err(|error| format!("--log `{}` is not understood: {error}", settings.log))?;
    let log = tracing_subscriber::fmt().with_max_level(LevelFilter::TRACE).with_writer(std::io::stderr);
    match settings.log_format {
        LogFormat::Text => {
            log.with_ansi(std::io::stderr().is_terminal()).finish().with(targets).init();
        }
        LogFormat::Json => {
            log.json().flatten_event(true).with_span_list(false).finish().with(targets).init();
        }
    }
    Ok(())
}
