//! Measures a toolpath: its lengths, its times, its numbers of moves of each kind, and its bounding box.
//!
//! # Guarantees
//! * Lengths come from closed formulas, not from chords.
//! * The box contains all moves, rapids too.
//! * The time of a move is its length divided by its feed, as on a machine with unlimited acceleration. If
//!   any feed move of the toolpath has no feed, the toolpath has no cutting time.
//!
//! # Cost
//! O(n) for n moves.

use nalgebra::{Point3, Vector3};

use super::cutting::Cutting;
use super::motion_time::motion_time;
use super::path::{Move, Toolpath};
use super::units::{Acceleration, FeedRate};
use crate::geometry::curve::Curve;

/// How many moves of each kind a toolpath has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub struct MoveCounts {
    /// Number of rapids.
    pub rapid: usize,
    /// Number of lines at feed.
    pub line: usize,
    /// Number of arcs and helices.
    pub arc: usize,
    /// Number of parabolas.
    pub parabola: usize,
    /// Number of splines; always 0 in this version.
    pub spline: usize,
    /// Number of turns of the tool about its resting tip. Absent where there are none.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub turn: Option<usize>,
}

/// A box with sides along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub struct Bounds {
    /// The corner with the smallest coordinates, in mm.
    #[cfg_attr(feature = "wire", schema(value_type = crate::wire::Place))]
    pub min: Point3<f64>,
    /// The corner with the largest coordinates, in mm.
    #[cfg_attr(feature = "wire", schema(value_type = crate::wire::Place))]
    pub max: Point3<f64>,
}

/// Lengths and times of a toolpath, and the box around the toolpath. Every feed move counts as cutting.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub struct Measures {
    /// Length of all feed moves, in mm.
    pub cutting_length_mm: f64,
    /// Length of all rapids, in mm.
    pub rapid_length_mm: f64,
    /// Time of all feed moves at their feeds, in s. Absent where moves have no feed.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub cutting_time_s: Option<f64>,
    /// Time of all rapids at `rapid_feed_mm_per_min`, in s.
    pub rapid_time_s: f64,
    /// Time of cutting, rapids and dwells together, in s. Absent where moves have no feed.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub total_time_s: Option<f64>,
    /// Time of all pauses, in s.
    pub dwell_time_s: f64,
    /// Estimated time on a machine that accelerates and brakes, in s. The estimate takes the acceleration
    /// from `cutting` and assumes a control with look-ahead, which slows down in corners and on small arcs.
    /// Absent where moves have no feed.
    #[cfg_attr(feature = "wire", serde(skip_serializing_if = "Option::is_none"))]
    pub time_with_acceleration_s: Option<f64>,
    /// How many moves of each kind there are.
    pub moves: MoveCounts,
    /// The box around all positions of the tool's tip, in mm.
    pub bounds: Bounds,
}

/// Measures `toolpath` for the machine of `cutting`, or for the default machine without `cutting`.
pub fn measure_on(toolpath: &Toolpath, cutting: Option<&Cutting>) -> Measures {
    let rapid_feed = cutting.map_or(FeedRate::DEFAULT_RAPID, |cutting| cutting.rapid_feed);
    let acceleration = cutting.map_or(Acceleration::DEFAULT, |cutting| cutting.acceleration);
    let time_with_acceleration_s = motion_time(toolpath, rapid_feed, acceleration);
    Measures { time_with_acceleration_s, ..measure(toolpath, rapid_feed) }
}

/// Measures `toolpath` on a machine that traverses at `rapid_feed`, without the time with acceleration.
///
/// # Example
/// ```
/// use nalgebra::Point3;
/// use toolpathd_core::toolpath::{Role, Toolpath, measure::measure, units::FeedRate};
///
/// let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 12.0));
/// builder.rapid(Point3::new(0.0, 0.0, 2.0)).unwrap();
/// builder.line(Point3::new(3.0, 4.0, 2.0), FeedRate::from_mm_per_min(60.0), Role::Cut).unwrap();
/// let figures = measure(&builder.finish().unwrap(), FeedRate::from_mm_per_min(600.0).unwrap());
/// assert_eq!((figures.cutting_length_mm, figures.rapid_length_mm), (5.0, 10.0));
/// // 5 mm at 1 mm/s, and 10 mm at 10 mm/s.
/// assert_eq!((figures.cutting_time_s, figures.rapid_time_s), (Some(5.0), 1.0));
/// assert_eq!(figures.bounds.max, Point3::new(3.0, 4.0, 12.0));
/// ```
pub fn measure(toolpath: &Toolpath, rapid_feed: FeedRate) -> Measures {
    let start = toolpath.start();
    let mut measures = Measures {
        cutting_length_mm: 0.0,
        rapid_length_mm: 0.0,
        cutting_time_s: Some(0.0),
        rapid_time_s: 0.0,
        dwell_time_s: 0.0,
        total_time_s: None,
        time_with_acceleration_s: None,
        moves: MoveCounts::default(),
        bounds: Bounds { min: start, max: start },
    };
    for step in toolpath.moves() {
        match step {
            Move::Rapid { line } => {
                measures.moves.rapid += 1;
                measures.rapid_length_mm += line.length();
                measures.bounds.include(&Curve::Line(*line));
            }
            Move::Feed { along, rate, .. } => {
                match along {
                    Curve::Line(_) => measures.moves.line += 1,
                    Curve::Arc(_) => measures.moves.arc += 1,
                    Curve::Parabola(_) => measures.moves.parabola += 1,
                }
                let length = along.length();
                measures.cutting_length_mm += length;
                let seconds = rate.map(|rate| length / rate.mm_per_min() * 60.0);
                measures.cutting_time_s = measures.cutting_time_s.zip(seconds).map(|(sum, own)| sum + own);
                measures.bounds.include(along);
            }
            Move::Turn { seconds, .. } => {
                *measures.moves.turn.get_or_insert(0) += 1;
                measures.cutting_time_s = measures.cutting_time_s.zip(*seconds).map(|(sum, own)| sum + own);
            }
            Move::Dwell { seconds } => measures.dwell_time_s += seconds,
        }
    }
    measures.rapid_time_s = measures.rapid_length_mm / rapid_feed.mm_per_min() * 60.0;
    measures.total_time_s =
        measures.cutting_time_s.map(|cutting| cutting + measures.rapid_time_s + measures.dwell_time_s);
    measures
}

impl Bounds {
    fn include(&mut self, curve: &Curve) {
        for k in 0..3 {
            let mut axis = Vector3::zeros();
            axis[k] = 1.0;
            self.max[k] = self.max[k].max(curve.support(&axis));
            self.min[k] = self.min[k].min(-curve.support(&-axis));
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::geometry::curve::Direction;
    use crate::geometry::plane::Plane;
    use crate::toolpath::Role;

    fn feed(mm_per_min: f64) -> FeedRate {
        FeedRate::from_mm_per_min(mm_per_min).unwrap()
    }

    #[test]
    fn lengths_times_counts_and_bounds_are_closed_forms() {
        let mut builder = Toolpath::builder(Point3::new(0.0, 0.0, 50.0));
        builder.rapid(Point3::new(0.0, 0.0, 2.0)).unwrap();
        builder.line(Point3::new(0.0, 0.0, -1.0), feed(60.0), Role::Plunge).unwrap();
        let about = (Plane::Xy, Direction::Ccw);
        builder
            .arc(Point3::new(20.0, 0.0, -1.0), Point3::new(10.0, 0.0, -1.0), about, feed(600.0), Role::Cut)
            .unwrap();
        builder.dwell(1.5).unwrap();
        let about = (Plane::Zx, Direction::Ccw);
        builder
            .arc(Point3::new(30.0, 0.0, -1.0), Point3::new(25.0, 0.0, -1.0), about, feed(300.0), Role::Link)
            .unwrap();
        let measures = measure(&builder.finish().unwrap(), feed(4800.0));
        assert!((measures.cutting_length_mm - (3.0 + 15.0 * PI)).abs() < 1e-12);
        assert_eq!(measures.rapid_length_mm, 48.0);
        assert!((measures.cutting_time_s.unwrap() - (3.0 + 2.0 * PI / 2.0 + PI)).abs() < 1e-12);
        assert!((measures.rapid_time_s - 0.6).abs() < 1e-12);
        assert_eq!(measures.dwell_time_s, 1.5);
        assert!((measures.total_time_s.unwrap() - (5.1 + 2.0 * PI)).abs() < 1e-12);
        let counts = MoveCounts { rapid: 1, line: 1, arc: 2, ..MoveCounts::default() };
        assert_eq!(measures.moves, counts);
        let bounds = measures.bounds;
        assert!((bounds.min - Point3::new(0.0, -10.0, -1.0)).norm() < 1e-12);
        assert!((bounds.max - Point3::new(30.0, 0.0, 50.0)).norm() < 1e-12);
    }

    #[test]
    fn parabolas_count_with_their_extremes_and_lengths() {
        let mut builder = Toolpath::builder(Point3::new(-1.0, 1.0, 0.0));
        // y = x^2.
        builder
            .parabola(Point3::new(1.0, 1.0, 0.0), Point3::new(0.0, -1.0, 0.0), feed(60.0), Role::Cut)
            .unwrap();
        let measures = measure(&builder.finish().unwrap(), feed(1.0));
        let length = 5f64.sqrt() + 2f64.asinh() / 2.0;
        assert!((measures.cutting_length_mm - length).abs() < 1e-14);
        assert!((measures.total_time_s.unwrap() - length).abs() < 1e-14);
        assert_eq!(measures.moves, MoveCounts { parabola: 1, ..MoveCounts::default() });
        assert_eq!(measures.bounds.min, Point3::new(-1.0, 0.0, 0.0));
        assert_eq!(measures.bounds.max, Point3::new(1.0, 1.0, 0.0));
    }

    #[test]
    fn without_a_feed_there_are_lengths_and_no_cutting_time() {
        let mut builder = Toolpath::builder(Point3::origin());
        builder.line(Point3::new(3.0, 0.0, 0.0), feed(60.0), Role::Cut).unwrap();
        builder.line(Point3::new(3.0, 4.0, 0.0), None, Role::Cut).unwrap();
        builder.rapid(Point3::origin()).unwrap();
        let measures = measure(&builder.finish().unwrap(), feed(60.0));
        assert_eq!((measures.cutting_length_mm, measures.rapid_time_s), (7.0, 5.0));
        assert_eq!((measures.cutting_time_s, measures.total_time_s), (None, None));
    }

    #[test]
    fn an_empty_path_is_its_start() {
        let start = Point3::new(1.0, 2.0, 3.0);
        let measures = measure(&Toolpath::builder(start).finish().unwrap(), feed(1.0));
        assert_eq!(measures.bounds, Bounds { min: start, max: start });
        assert_eq!(measures.total_time_s, Some(0.0));
    }
}
