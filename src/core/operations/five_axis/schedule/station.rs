//! Stations of a path and the limits of a motion along it, as [`super::schedule`] takes them.

use crate::budget::Stopped;

/// The derivatives of one coordinate by the parameter of the path, at one station.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Derivatives {
    pub first: f64,
    pub second: f64,
    /// Before and after the station. The third derivative may jump there.
    pub third: [f64; 2],
}

/// A place on the path.
#[derive(Debug, Clone, PartialEq)]
pub struct Station {
    /// The parameter of the path.
    pub u: f64,
    /// The most du/dt at the station; infinite without a cap.
    pub speed_cap: f64,
    /// One for each coordinate.
    pub coordinates: Vec<Derivatives>,
}

/// The limits of one coordinate, in its unit by s, s2 and s3. Each may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    pub speed: f64,
    pub acceleration: f64,
    pub jerk: f64,
}

/// The limits of the vector of the first three coordinates, as Euclidean norms. Each may be infinite.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TipLimits {
    pub acceleration: f64,
    pub jerk: f64,
}

/// Why there is no schedule.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ScheduleError {
    #[error("a schedule needs at least one station")]
    NoStations,
    #[error(
        "station {station} has {found} coordinates, but there are limits for {expected}; give limits for each"
    )]
    Coordinates { station: usize, found: usize, expected: usize },
    #[error("station {station} has a number that is not finite")]
    NotFinite { station: usize },
    #[error("the parameter does not grow from station {} to station {station}", station - 1)]
    NotIncreasing { station: usize },
    #[error(
        "nothing bounds the speed at station {station}: it has no cap, and every first derivative is 0; change the parameter"
    )]
    StandsStill { station: usize },
    #[error("the speed cap of station {station} is not above 0")]
    NoSpeed { station: usize },
    #[error("the limits of coordinate {coordinate} are not all above 0")]
    BadLimits { coordinate: usize },
    #[error("the limits of the tip are not all above 0")]
    BadTipLimits,
    #[error("tip limits need at least three coordinates")]
    NoTip,
    #[error("the numbers of the path or its limits are too large or too small to compute with")]
    OutOfRange,
    #[error(transparent)]
    Stopped(#[from] Stopped),
}

/// A node between two stations.
pub fn between(from: &Station, to: &Station, u: f64) -> Station {
    let length = to.u - from.u;
    let part = ((u - from.u) / length).clamp(0.0, 1.0);
    let coordinates =
        from.coordinates.iter().zip(&to.coordinates).map(|(a, b)| derivatives(a, b, length, part)).collect();
    // The square of the cap is linear between stations.
    let square = (1.0 - part) * from.speed_cap.powi(2) + part * to.speed_cap.powi(2);
    Station { u, speed_cap: square.sqrt(), coordinates }
}

/// The derivatives in an interval, from those at its ends: the first one is a quintic.
fn derivatives(a: &Derivatives, b: &Derivatives, length: f64, part: f64) -> Derivatives {
    let (h, hh) = (length / 5.0, length * length / 20.0);
    let mut points = [
        a.first,
        a.first + h * a.second,
        a.first + 2.0 * h * a.second + hh * a.third[1],
        b.first - 2.0 * h * b.second + hh * b.third[0],
        b.first - h * b.second,
        b.first,
    ];
    // De Casteljau's algorithm, as far as a parabola.
    for count in (3..6).rev() {
        for k in 0..count {
            points[k] += part * (points[k + 1] - points[k]);
        }
    }
    let [p, q, r, ..] = points;
    let (left, right) = (p + part * (q - p), q + part * (r - q));
    let third = 20.0 * (r - 2.0 * q + p) / (length * length);
    Derivatives {
        first: left + part * (right - left),
        second: 5.0 * (right - left) / length,
        third: [third, third],
    }
}

/// Checks the stations and the limits.
///
/// # Errors
/// The first fault found.
pub fn check(stations: &[Station], limits: &[Limits], tip: Option<&TipLimits>) -> Result<(), ScheduleError> {
    let positive = |value: f64| value > 0.0;
    for (coordinate, l) in limits.iter().enumerate() {
        if ![l.speed, l.acceleration, l.jerk].into_iter().all(positive) {
            return Err(ScheduleError::BadLimits { coordinate });
        }
    }
    if let Some(tip) = tip {
        if ![tip.acceleration, tip.jerk].into_iter().all(positive) {
            return Err(ScheduleError::BadTipLimits);
        }
        if limits.len() < 3 {
            return Err(ScheduleError::NoTip);
        }
    }
    if stations.is_empty() {
        return Err(ScheduleError::NoStations);
    }
    for (station, s) in stations.iter().enumerate() {
        let (found, expected) = (s.coordinates.len(), limits.len());
        if found != expected {
            return Err(ScheduleError::Coordinates { station, found, expected });
        }
        let finite =
            |d: &Derivatives| [d.first, d.second, d.third[0], d.third[1]].iter().all(|x| x.is_finite());
        if !s.u.is_finite() || s.speed_cap.is_nan() || !s.coordinates.iter().all(finite) {
            return Err(ScheduleError::NotFinite { station });
        }
        if s.speed_cap <= 0.0 {
            return Err(ScheduleError::NoSpeed { station });
        }
        if s.speed_cap.is_infinite() && s.coordinates.iter().all(|d| d.first == 0.0) {
            return Err(ScheduleError::StandsStill { station });
        }
        if station > 0 && s.u <= stations[station - 1].u {
            return Err(ScheduleError::NotIncreasing { station });
        }
    }
    Ok(())
}
