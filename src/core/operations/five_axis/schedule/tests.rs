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
struct Circle {
    radius: f64,
    length: f64,
    waves: f64,
}

impl Circle {
    /// The amplitude, the phase and the angle by the length of each coordinate.
    fn swings(&self) -> [[f64; 3]; 3] {
        let w = std::f64::consts::TAU * self.waves / self.length;
        let turn = 1.0 / self.radius;
        [[self.radius, 0.0, turn], [self.radius, -std::f64::consts::FRAC_PI_2, turn], [3.0, 0.3, w]]
    }

    fn at(&self, u: f64) -> Station {
        let derivatives = |[amplitude, phase, w]: [f64; 3]| {
            let (sin, cos) = (w * u + phase).sin_cos();
            Derivatives {
                first: -amplitude * w * sin,
                second: -amplitude * w * w * cos,
                third: [amplitude * w * w * w * sin; 2],
            }
        };
        Station { u, speed_cap: 150.0, coordinates: self.swings().map(derivatives).to_vec() }
    }

    fn stations(&self, intervals: usize) -> Vec<Station> {
        (0..=intervals).map(|k| self.at(self.length * k as f64 / intervals as f64)).collect()
    }

    fn expansions(&self, range: [f64; 2]) -> [Expansion; 3] {
        let middle = self.at(0.5 * (range[0] + range[1]));
        [0, 1, 2].map(|k| {
            let ([amplitude, _, w], own) = (self.swings()[k], middle.coordinates[k]);
            Expansion {
                middle: [own.first, own.second / 2.0, own.third[0] / 6.0, -own.second * w * w / 24.0],
                error: amplitude * w.powi(5) / 24.0 * 0.5 * (range[1] - range[0]),
            }
        })
    }
}

fn circle(radius: f64, length: f64, waves: f64, intervals: usize) -> Vec<Station> {
    Circle { radius, length, waves }.stations(intervals)
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

/// The part of the limits that is used at a place, as the factor of the speed, by the formulas themselves.
fn used_at(motion: &Motion, station: &Station, limits: &[Limits], tip: &TipLimits) -> f64 {
    let (v, a, j) = (motion.speed, motion.acceleration, motion.jerk);
    let mut factor = v / station.speed_cap;
    let (mut tip_acceleration, mut tip_jerk) = (0.0, 0.0);
    for (own, limits) in station.coordinates.iter().zip(limits) {
        let acceleration = own.second * v * v + own.first * a;
        let jerk = own.third[0] * v * v * v + 3.0 * own.second * v * a + own.first * j;
        factor = factor.max((own.first * v).abs() / limits.speed);
        factor = factor.max((acceleration.abs() / limits.acceleration).sqrt());
        factor = factor.max((jerk.abs() / limits.jerk).cbrt());
        tip_acceleration += acceleration * acceleration;
        tip_jerk += jerk * jerk;
    }
    factor = factor.max((tip_acceleration.sqrt() / tip.acceleration).sqrt());
    factor.max((tip_jerk.sqrt() / tip.jerk).cbrt())
}

#[test]
fn limits_are_bounded_between_stations_and_nearly_used() {
    let path = Circle { radius: 10.0, length: 60.0, waves: 4.0 };
    let tip = TipLimits { acceleration: 6_000.0, jerk: 120_000.0 };
    let schedule = schedule(&path.stations(400), &[AXIS; 3], Some(&tip), &Budget::unlimited()).unwrap();
    for slowness in [1.0, 1.3] {
        let schedule = schedule.clone().slowed(slowness);
        let mut largest = 0.0_f64;
        for (k, range) in schedule.intervals().enumerate() {
            let expansions = path.expansions(range);
            let course = Course {
                range,
                coordinates: &expansions,
                limits: &[AXIS; 3],
                tip: Some(&tip),
                // The circle itself moves at the feed.
                paced: &[expansions[0], expansions[1], Expansion::default()],
                feed: 150.0,
            };
            let found = schedule.slowdown_for(k, &course);
            // The bound is less sharp in the long intervals at the ends.
            if (1..=schedule.intervals().count() - 2).contains(&k) {
                largest = largest.max(found.bound);
            }
            // At the end the jerk is that of the next interval.
            for part in 1..20 {
                let u = range[0] + (range[1] - range[0]) * f64::from(part) / 20.0;
                let motion = schedule.at(schedule.time_at(u));
                let used = used_at(&motion, &path.at(u), &[AXIS; 3], &tip);
                assert!(used <= found.bound + 1e-9, "{k} {part}: {used} {found:?}");
                assert!(
                    part != 10 || k == 0 || (used - found.at_middle).abs() < 1e-3,
                    "{k}: {used} {found:?}"
                );
            }
        }
        assert!(largest * slowness > 0.995 && largest * slowness < 1.005, "{largest}");
    }
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
    let stands_still = |s: &mut Vec<Station>| {
        s[2].coordinates[0].first = 0.0;
        s[2].speed_cap = f64::INFINITY;
    };
    assert_eq!(with(&stands_still), ScheduleError::StandsStill { station: 2 });
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
