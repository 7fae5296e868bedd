//! Measures the real program under more load than it can serve. Refused requests must be refused at once, and
//! accepted requests must be answered about as fast as without refusals. Prints the figures, and fails beyond
//! generous limits.

mod client;
mod program;

use std::net::SocketAddr;
use std::process::ExitCode;
use std::sync::{Arc, Barrier};
use std::thread;
use std::time::{Duration, Instant};

use client::{Client, partial_head};
use program::Program;

/// Settings of the service: few workers and a short queue, so that most clients of the large crowd are
/// refused.
const SETTINGS: [&str; 4] = ["--workers", "2", "--queue", "4"];

/// Number of clients in the large crowd.
const CROWD: usize = 64;
/// Numbers of clients in the small crowds, of which none is refused. The fastest small crowd gives the peak.
const SMALL_CROWDS: [usize; 3] = [2, 4, 6];

/// Number of rounds. The crowds take turns, so that other load on the machine affects all crowds alike.
const ROUNDS: usize = 4;
/// How long each crowd is measured in a round, after `WARM_UP`.
const MEASURED: Duration = Duration::from_secs(2);
/// Time at the start of each round that does not count.
const WARM_UP: Duration = Duration::from_millis(300);

/// How long a refused client waits before it asks again: a twentieth of the second in `Retry-After`. Clients
/// run on the same processors as the service. Without a wait they would mostly measure themselves.
const PATIENCE: Duration = Duration::from_millis(50);

/// Least answers per second of the large crowd, as a fraction of the peak. The aim is 0.9, and 50 ms for
/// `REFUSED_WITHIN`, when the service has two processors for itself. The limits are wider, because the
/// clients run on the same processors.
const GOODPUT_AT_LEAST: f64 = 0.8;
/// Longest time of 99 % of the refusals.
const REFUSED_WITHIN: Duration = Duration::from_millis(100);

/// Number of connections that stop within the head of a request.
const PARTIAL_HEADS: usize = 200;
/// Time after which the service must have closed all of these connections.
const CLOSED_WITHIN: Duration = Duration::from_secs(12);
/// Longest time of an answer to another client meanwhile.
const ANSWERED_WITHIN: Duration = Duration::from_millis(200);

fn main() -> ExitCode {
    let program = Program::start(&SETTINGS);
    let mut failures = overload(program.address);
    failures.extend(partial_heads(program.address));
    for failure in &failures {
        eprintln!("overload: {failure}");
    }
    if failures.is_empty() { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

/// Compares the answers per second of the large crowd with the peak of the small crowds, and checks that
/// refusals are fast. Returns the failures.
fn overload(address: SocketAddr) -> Vec<String> {
    let job = Arc::new(job());
    let alone = crowd(address, &job, 1);
    println!("1 client: {:.1} ms a job", alone.answered.percentile(0.5).as_secs_f64() * 1e3);
    let mut small = SMALL_CROWDS.map(|_| Load::default());
    let mut large = Load::default();
    for _ in 0..ROUNDS {
        for (load, clients) in small.iter_mut().zip(SMALL_CROWDS) {
            load.add(crowd(address, &job, clients));
        }
        large.add(crowd(address, &job, CROWD));
    }
    let mut peak = 0_f64;
    for (load, clients) in small.iter().zip(SMALL_CROWDS) {
        println!("{clients} clients: {:.1} answers/s, {} refused", load.goodput(), load.refused.0.len());
        peak = peak.max(load.goodput());
    }
    let (share, refused) = (large.goodput() / peak, large.refused.percentile(0.99));
    println!(
        "{CROWD} clients: {:.1} answers/s, {:.0} % of the peak; {} refused, median {:?}, p99 {refused:?}",
        large.goodput(),
        share * 100.0,
        large.refused.0.len(),
        large.refused.percentile(0.5),
    );
    let mut failures = Vec::new();
    if share < GOODPUT_AT_LEAST {
        failures.push(format!("goodput fell to {share:.2} of the peak"));
    }
    if large.refused.0.is_empty() || refused > REFUSED_WITHIN {
        failures.push(format!("p99 of {} refusals is {refused:?}", large.refused.0.len()));
    }
    failures
}

/// Checks that connections which stop within the head of a request are closed and do not delay other clients.
/// Returns the failures.
fn partial_heads(address: SocketAddr) -> Vec<String> {
    let opened = Instant::now();
    let stuck: Vec<_> = (0..PARTIAL_HEADS).map(|_| partial_head(address)).collect();
    let mut client = Client::new(address);
    let mut slowest = Duration::ZERO;
    while opened.elapsed() < CLOSED_WITHIN {
        let started = Instant::now();
        assert_eq!(client.get("/livez"), 200);
        slowest = slowest.max(started.elapsed());
        thread::sleep(Duration::from_millis(50));
    }
    let open = stuck.into_iter().filter(|stream| !client::is_closed(stream)).count();
    println!(
        "{PARTIAL_HEADS} partial heads: {open} open after {CLOSED_WITHIN:?}; others answered within {slowest:?}"
    );
    let mut failures = Vec::new();
    if open > 0 {
        failures.push(format!("{open} of {PARTIAL_HEADS} partial heads were still open"));
    }
    if slowest > ANSWERED_WITHIN {
        failures.push(format!("a request took {slowest:?} beside partial heads"));
    }
    failures
}

/// Durations of requests.
#[derive(Default)]
struct Times(Vec<Duration>);

impl Times {
    fn percentile(&self, share: f64) -> Duration {
        let mut sorted = self.0.clone();
        sorted.sort();
        let last = sorted.len().saturating_sub(1);
        sorted.get((share * last as f64).round() as usize).copied().unwrap_or_default()
    }
}

/// The measurements of crowds of one size.
#[derive(Default)]
struct Load {
    rounds: u32,
    answered: Times,
    refused: Times,
}

impl Load {
    fn add(&mut self, other: Load) {
        self.rounds += other.rounds;
        self.answered.0.extend(other.answered.0);
        self.refused.0.extend(other.refused.0);
    }

    /// Answers per second.
    fn goodput(&self) -> f64 {
        self.answered.0.len() as f64 / (MEASURED * self.rounds).as_secs_f64()
    }
}

/// Lets a number of clients send the job again and again, and measures them.
fn crowd(address: SocketAddr, job: &Arc<String>, clients: usize) -> Load {
    let start = Arc::new(Barrier::new(clients));
    let run = |_| {
        let (job, start) = (Arc::clone(job), Arc::clone(&start));
        thread::spawn(move || {
            let mut client = Client::new(address);
            start.wait();
            client_of_crowd(&mut client, &job)
        })
    };
    let threads: Vec<_> = (0..clients).map(run).collect();
    let mut load = Load { rounds: 1, ..Load::default() };
    for thread in threads {
        let (answered, refused) = thread.join().expect("the client lives");
        load.answered.0.extend(answered);
        load.refused.0.extend(refused);
    }
    load
}

/// The durations of the answers and of the refusals that one client got within the measured time.
fn client_of_crowd(client: &mut Client, job: &str) -> (Vec<Duration>, Vec<Duration>) {
    let begin = Instant::now() + WARM_UP;
    let end = begin + MEASURED;
    let (mut answered, mut refused) = (Vec::new(), Vec::new());
    while Instant::now() < end {
        let started = Instant::now();
        let status = client.post("/v1/surfaces/mill?toolpath=false", job);
        let is_counted = (begin..end).contains(&Instant::now());
        let times = match status {
            200 => &mut answered,
            503 => &mut refused,
            other => panic!("answered {other}"),
        };
        if is_counted {
            times.push(started.elapsed());
        }
        if status == 503 {
            thread::sleep(PATIENCE);
        }
    }
    (answered, refused)
}

/// The body of a job: finishing a wave of 60 mm by 60 mm, which takes some 50 ms.
fn job() -> String {
    let row = |i: u32| {
        let point = |j: u32| {
            let (x, y) = (f64::from(i) * 5.0, f64::from(j) * 5.0);
            let z = 10.0 * (std::f64::consts::PI * x / 40.0).sin() * (std::f64::consts::PI * y / 40.0).cos();
            format!("[{x},{y},{z:.6}]")
        };
        format!("[{}]", (0..13).map(point).collect::<Vec<_>>().join(","))
    };
    let points = (0..13).map(row).collect::<Vec<_>>().join(",");
    format!(
        r#"{{"surface":{{"kind":"point_grid","points":[{points}]}},"tool":{{"shape":"ball","diameter_mm":10}},
        "strategy":{{"kind":"cl_cartesian","stepover_mm":1.5}},"tolerance_mm":0.01,"cutting":{{"feed_mm_per_min":800}}}}"#
    )
}
