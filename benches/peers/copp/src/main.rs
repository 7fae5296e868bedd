//! Compares the schedule of this project with the optimum of copp's TOPP3.
//!
//! `yardstick [intervals] [part of a name]` prints for each test path the time of copp, the time of this
//! schedule, and their ratio. `intervals` is the number of equal intervals between the stations of this
//! schedule.
//!
//! `yardstick fit` compares the spline in the tolerance tube with copp's fit of waypoints.

mod copp_time;
mod excess;
mod fit;
mod paths;

use std::time::Instant;

use toolpathd_core::budget::Budget;
use toolpathd_core::operations::five_axis::schedule::schedule;

fn main() {
    let mut arguments = std::env::args().skip(1).peekable();
    if arguments.peek().is_some_and(|first| first == "fit") {
        return fit::compare();
    }
    let intervals: usize = arguments.next().and_then(|x| x.parse().ok()).unwrap_or(1000);
    let part = arguments.next().unwrap_or_default();
    println!(
        "path            | copp, s  | grid | copp ms | here, s  | ratio  | us/station | excess: speed, acceleration, jerk"
    );
    for case in paths::cases().iter().filter(|case| case.name.contains(&part)) {
        let stations = case.stations(intervals);
        let begin = Instant::now();
        let here = match schedule(&stations, &case.limits, None, &Budget::unlimited()) {
            Ok(here) => here,
            Err(error) => {
                println!("{:15} | {error}", case.name);
                continue;
            }
        };
        let us = begin.elapsed().as_secs_f64() * 1e6 / intervals as f64;
        let [v, a, j] = excess::by_differences(case, &here);
        let begin = Instant::now();
        match copp_time::refined(case) {
            Ok((copp, grid)) => println!(
                "{:15} | {copp:8.5} | {grid:4} | {:7.0} | {:8.5} | {:.4} | {us:10.2} | {v:.4} {a:.4} {j:.4}",
                case.name,
                begin.elapsed().as_secs_f64() * 1e3,
                here.duration_s(),
                here.duration_s() / copp,
            ),
            Err(error) => println!(
                "{:15} | {error} | {:8.5} | {us:10.2} | {v:.4} {a:.4} {j:.4}",
                case.name,
                here.duration_s()
            ),
        }
    }
}
