use proptest::prelude::*;

use super::*;
use crate::budget::Stopped;

const FREE: Limits = Limits { speed: f64::INFINITY, acceleration: f64::INFINITY, jerk: f64::INFINITY };
const AXIS: Limits = Limits { speed: 500.0, acceleration: 5_000.0, jerk: 100_000.0 };

fn run(stations: &[Station], limits: &[Limits]) -> Result<Schedule, ScheduleError> {
    schedule(stations, limits, None, &Budget::unlimited())
}

/// A line with one coordinate that is the parameter.
fn line(length: f64, intervals: usize, speed_cap: f64) -> Vec<Station> {
    let along = Derivatives { first: 1.0, second: 0.0, third: [0.0; 2] };
    let at = |k: usize| length * k as f64 / intervals as f64;
    (0..=intervals).map(|k| Station { u: at(k), speed_cap, coordinates: vec![along] }).collect()
}

/// A circle in the plane by its length, and a third coordinate that swings `waves` times.
fn circle(radius: f64, length: f64, waves: f64, intervals: usize) -> Vec<Station> {
    let at = |k: usize| {
        let u = length * k as f64 / intervals as f64;
        let turn = |amplitude: f64, w: f64, phase: f64| {
            let angle = w * u + phase;
            Derivatives {
                first: -amplitude * w * angle.sin(),
                second: -amplitude * w * w * angle.cos(),
                third: [amplitude * w * w * w * angle.sin(); 2],
            }
        };
        let quarter = std::f64::consts::FRAC_PI_2;
        let w = std::f64::consts::TAU * waves / length;
        let coordinates =
            vec![turn(radius, 1.0 / radius, 0.0), turn(radius, 1.0 / radius, -quarter), turn(3.0, w, 0.3)];
        Station { u, speed_cap: 150.0, coordinates }
    };
    (0..=intervals).map(at).collect()
}

/// The shortest time from rest to rest over a length, with limits of speed, acceleration and jerk.
fn seven_phases(length: f64, l: Limits) -> f64 {
    let time_to = |v: f64| {
        if v * l.jerk < l.acceleration * l.acceleration {
            2.0 * (v / l.jerk).sqrt()
        } else {
            v / l.acceleration + l.acceleration / l.jerk
        }
    };
    let (mut low, mut high) = (0.0, l.speed);
    for _ in 0..200 {
        let v = 0.5 * (low + high);
        if v * time_to(v) < length { low = v } else { high = v }
    }
    2.0 * time_to(low) + (length - low * time_to(low)) / low
}

#[test]
fn a_line_takes_the_time_of_seven_phases() {
    for length in [0.001, 0.1, 1.0, 10.0, 100.0, 10_000.0] {
        for intervals in [1, 2, 100, 1000] {
            let here = run(&line(length, intervals, f64::INFINITY), &[AXIS]).unwrap().duration_s();
            let best = seven_phases(length, AXIS);
            // Few stations leave few nodes far from the ends, where the jerk changes.
            let most = if intervals < 100 { 1.03 } else { 1.012 };
            assert!(here >= best * 0.9999 && here < best * most, "{length} {intervals}: {here} {best}");
        }
    }
}

#[test]
fn the_motion_is_continuous_and_rests_at_both_ends() {
    let schedule = run(&circle(10.0, 60.0, 3.0, 300), &[AXIS; 3]).unwrap();
    let count = 20_000;
    let motion = |k: usize| schedule.at(schedule.duration_s() * k as f64 / count as f64);
    let dt = schedule.duration_s() / count as f64;
    for k in 0..count {
        let (a, b) = (motion(k), motion(k + 1));
        assert!((b.u - a.u - 0.5 * dt * (a.speed + b.speed)).abs() < 1e-7, "{k}");
        assert!((b.speed - a.speed - 0.5 * dt * (a.acceleration + b.acceleration)).abs() < 1e-3, "{k}");
        assert!((b.acceleration - a.acceleration).abs() < 2.0 * dt * a.jerk.abs().max(b.jerk.abs()) + 1e-6);
        assert!((schedule.time_at(a.u) - dt * k as f64).abs() < 1e-6, "{k}");
    }
    assert_eq!((motion(0).u, motion(0).speed), (0.0, 0.0));
    assert_eq!((motion(count).u, motion(count).speed), (60.0, 0.0));
}

#[test]
fn limits_hold_between_stations_and_are_nearly_used() {
    let stations = circle(10.0, 60.0, 4.0, 400);
    let schedule = run(&stations, &[AXIS; 3]).unwrap();
    let exact = circle(10.0, 60.0, 4.0, 40_000);
    let bounds = |a: &Station, b: &Station| -> Vec<DerivativeBounds> {
        let range = |x: f64, y: f64| [x.min(y), x.max(y)];
        a.coordinates
            .iter()
            .zip(&b.coordinates)
            .map(|(a, b)| DerivativeBounds {
                first: range(a.first, b.first),
                second: range(a.second, b.second),
                third: range(a.third[0], b.third[0]),
            })
            .collect()
    };
    let slowdown = exact
        .windows(2)
        .map(|w| schedule.slowdown_for([w[0].u, w[1].u], &bounds(&w[0], &w[1]), 150.0, &[AXIS; 3], None))
        .fold(0.0, f64::max);
    assert!(slowdown > 0.995 && slowdown < 1.01, "{slowdown}");
    let slowed = schedule.clone().slowed(slowdown);
    assert!((slowed.duration_s() - slowdown * schedule.duration_s()).abs() < 1e-12);
}

#[test]
fn the_tip_keeps_its_limits_in_every_direction() {
    let tip = TipLimits { acceleration: 400.0, jerk: 20_000.0 };
    let stations = circle(10.0, 60.0, 1e-9, 400);
    let schedule = schedule(&stations, &[FREE; 3], Some(&tip), &Budget::unlimited()).unwrap();
    // The speed of the circle is the root of acceleration by radius, halfway at least.
    let halfway = schedule.at(0.5 * schedule.duration_s());
    assert!((halfway.speed - (400.0f64 * 10.0).sqrt()).abs() < 0.2, "{halfway:?}");
}

#[test]
fn faults_are_refused_with_their_station() {
    let stations = line(10.0, 4, 50.0);
    let with = |change: &dyn Fn(&mut Vec<Station>)| {
        let mut stations = stations.clone();
        change(&mut stations);
        run(&stations, &[AXIS]).unwrap_err()
    };
    assert_eq!(with(&|s| s[2].coordinates[0].first = 0.0), ScheduleError::StandsStill { station: 2 });
    assert_eq!(with(&|s| s[3].u = 1.0), ScheduleError::NotIncreasing { station: 3 });
    assert_eq!(with(&|s| s[1].speed_cap = 0.0), ScheduleError::NoSpeed { station: 1 });
    assert_eq!(with(&|s| s[1].coordinates[0].second = f64::NAN), ScheduleError::NotFinite { station: 1 });
    assert_eq!(with(&|s| s.clear()), ScheduleError::NoStations);
    let bad = Limits { jerk: 0.0, ..AXIS };
    assert_eq!(run(&stations, &[bad]), Err(ScheduleError::BadLimits { coordinate: 0 }));
}

#[test]
fn a_single_station_takes_no_time() {
    let schedule = run(&line(1.0, 4, 50.0)[..1], &[AXIS]).unwrap();
    assert_eq!((schedule.duration_s(), schedule.at(1.0).u), (0.0, 0.0));
}

#[test]
fn infinite_limits_leave_the_cap() {
    let schedule = run(&line(10.0, 50, 50.0), &[FREE]).unwrap();
    assert!(schedule.duration_s() >= 0.2 && schedule.duration_s() < 0.21, "{}", schedule.duration_s());
    let unlimited = run(&line(10.0, 50, f64::INFINITY), &[FREE]).unwrap();
    assert!(unlimited.duration_s().is_finite());
    let no_jerk = run(&line(10.0, 50, 50.0), &[Limits { jerk: f64::INFINITY, ..AXIS }]).unwrap();
    let best = 10.0 / 50.0 + 50.0 / 5_000.0;
    assert!(no_jerk.duration_s() < 1.02 * best && no_jerk.duration_s() > 0.999 * best);
}

#[test]
fn a_cancelled_budget_stops() {
    let budget = Budget::unlimited();
    budget.cancel();
    let result = schedule(&line(10.0, 50, 50.0), &[AXIS], None, &budget);
    assert_eq!(result, Err(ScheduleError::Stopped(Stopped::Cancelled)));
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_caps_and_derivatives_give_a_finite_time(
        steps in prop::collection::vec(
            (-3.0..2.0f64, -1.0..1.5f64, prop::array::uniform3(-1.0..1.0f64)),
            2..60,
        ),
        scale in -3.0..3.0f64,
    ) {
        let mut u = 0.0;
        let stations: Vec<Station> = steps
            .iter()
            .map(|(step, cap, [first, second, third])| {
                u += 10f64.powf(*step + scale);
                let along = Derivatives { first: 1.0, second: 0.0, third: [0.0; 2] };
                let other = Derivatives { first: *first, second: *second, third: [*third, -third] };
                Station { u, speed_cap: 10f64.powf(*cap), coordinates: vec![along, other] }
            })
            .collect();
        let schedule = run(&stations, &[AXIS, AXIS]).unwrap();
        prop_assert!(schedule.duration_s().is_finite() && schedule.duration_s() > 0.0);
        for s in &stations {
            let motion = schedule.at(schedule.time_at(s.u));
            prop_assert!(motion.speed <= s.speed_cap * (1.0 + 1e-6), "{motion:?} {s:?}");
            let d = s.coordinates[1];
            let acceleration = d.second * motion.speed.powi(2) + d.first * motion.acceleration;
            prop_assert!(acceleration.abs() <= AXIS.acceleration * (1.0 + 1e-6));
        }
    }
}
