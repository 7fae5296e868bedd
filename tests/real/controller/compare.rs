//! Compares the control's motions with the motions of the reader and with the toolpath itself.

use std::fmt;

use nalgebra::{Point3, Vector3};
use toolpathd_core::geometry::curve::{Arc, Curve, Direction, Parabola};
use toolpathd_core::toolpath::Toolpath;
use toolpathd_core::toolpath::measure::measure;
use toolpathd_core::toolpath::path::Move;
use toolpathd_core::toolpath::program::{Resolution, Units};
use toolpathd_core::toolpath::quantize::{Curves, MAX_DISPLACEMENT_STEPS, quantize};
use toolpathd_core::toolpath::units::FeedRate;
use toolpathd_post::Dialect;
use toolpathd_post::read::{Reader, Step};

use crate::canon::Motion;
use crate::hole;

/// Number of steps between the compared points of each motion.
const SAMPLES: u32 = 12;

/// Largest relative difference of lengths and times.
const AGREEMENT: f64 = 1e-3;

/// Largest difference of the radii of an arc in any program, mm: 1.5 units of the fourth decimal of an inch.
const MISMATCH_LIMIT_MM: f64 = 1.5 * 0.00254;

/// Numbers of compared motions, and the largest differences.
#[derive(Debug, Clone, Copy, Default)]
pub struct Figures {
    motions: usize,
    arcs: usize,
    holes: usize,
    parabolas: usize,
    to_text_mm: f64,
    to_path_mm: f64,
    to_path_inch_mm: f64,
    mismatch_mm: f64,
    lengths: f64,
    times: f64,
}

impl Figures {
    pub fn and(self, other: Self) -> Self {
        Self {
            motions: self.motions + other.motions,
            arcs: self.arcs + other.arcs,
            holes: self.holes + other.holes,
            parabolas: self.parabolas + other.parabolas,
            to_text_mm: self.to_text_mm.max(other.to_text_mm),
            to_path_mm: self.to_path_mm.max(other.to_path_mm),
            to_path_inch_mm: self.to_path_inch_mm.max(other.to_path_inch_mm),
            mismatch_mm: self.mismatch_mm.max(other.mismatch_mm),
            lengths: self.lengths.max(other.lengths),
            times: self.times.max(other.times),
        }
    }
}

impl fmt::Display for Figures {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "{} motions, {} arcs, {} holes, {} parabolas; apart from the text {:.5} mm, from the toolpath {:.5} mm (inch programs \
             {:.5} mm), radius mismatch {:.5} mm, lengths {:.5} %, times {:.5} %",
            self.motions,
            self.arcs,
            self.holes,
            self.parabolas,
            self.to_text_mm,
            self.to_path_mm,
            self.to_path_inch_mm,
            self.mismatch_mm,
            100.0 * self.lengths,
            100.0 * self.times
        )
    }
}

/// A motion of the control with its start. The centre of an arc may differ slightly from the exact centre.
pub struct Run {
    pub start: Point3<f64>,
    pub motion: Motion,
}

impl Run {
    /// The point at the fraction `t` of the motion. The radius of an arc changes in proportion to the angle.
    fn point_at(&self, t: f64) -> Point3<f64> {
        match self.motion {
            Motion::Arc { plane, direction, to, center, .. } => {
                let [s, e, c] = [self.start, to, center].map(|p| plane.to_local(&p));
                let (from, until) = ((s - c).xy(), (e - c).xy());
                let sign = if direction == Direction::Ccw { 1.0 } else { -1.0 };
                let turn =
                    (sign * from.perp(&until).atan2(from.dot(&until))).rem_euclid(std::f64::consts::TAU);
                let sweep = if s.xy() == e.xy() { std::f64::consts::TAU } else { turn };
                let angle = from.y.atan2(from.x) + sign * sweep * t;
                let r = from.norm() + (until.norm() - from.norm()) * t;
                let z = s.z + (e.z - s.z) * t;
                plane.to_workpiece(&Vector3::new(c.x + r * angle.cos(), c.y + r * angle.sin(), z))
            }
            Motion::Parabola { curve, .. } => curve.point_at(t),
            Motion::Line { to, .. } | Motion::Rapid { to } => self.start + (to - self.start) * t,
            Motion::Dwell { .. } => self.start,
        }
    }

    pub fn end(&self) -> Point3<f64> {
        match self.motion {
            Motion::Arc { to, .. } | Motion::Line { to, .. } | Motion::Rapid { to } => to,
            Motion::Parabola { curve, .. } => curve.end(),
            Motion::Dwell { .. } => self.start,
        }
    }

    /// Length in mm and time in s of a feed motion; zero for rapids and dwells.
    fn length_and_time(&self) -> (f64, f64) {
        let (length, rate) = match self.motion {
            Motion::Arc { plane, direction, to, mut center, rate } => {
                let n = plane.axes()[2];
                center[n] = self.start[n];
                let arc = Arc::with_center_near(plane, direction, self.start, to, center);
                (arc.map_or(f64::NAN, |arc| arc.length()), rate)
            }
            Motion::Parabola { curve, rate } => (curve.length(), rate),
            Motion::Line { to, rate } => ((to - self.start).norm(), rate),
            Motion::Rapid { .. } | Motion::Dwell { .. } => (0.0, 1.0),
        };
        (length, length / rate * 60.0)
    }
}

/// The motions with their starts.
fn runs(motions: &[Motion]) -> Vec<Run> {
    let mut start = Point3::origin();
    let mut runs = Vec::with_capacity(motions.len());
    for motion in motions {
        let run = Run { start, motion: *motion };
        start = run.end();
        runs.push(run);
    }
    runs
}

/// A feed step of the reader as a motion. An arc turns about the centre that the text gives.
fn as_written(along: &Curve, center: Option<Point3<f64>>, rate: FeedRate) -> Run {
    let (to, rate) = (along.end(), rate.mm_per_min());
    let motion = match (along, center) {
        (Curve::Arc(arc), Some(center)) => {
            Motion::Arc { plane: arc.plane(), direction: arc.direction(), to, center, rate }
        }
        (Curve::Parabola(curve), _) => Motion::Parabola { curve: *curve, rate },
        _ => Motion::Line { to, rate },
    };
    Run { start: along.start(), motion }
}

/// Checks motion by motion that the control makes the motions that the reader reads from the text.
pub fn with_text(text: &str, dialect: &Dialect, motions: &[Motion]) -> Result<Figures, String> {
    let is_inch = text.contains("G20");
    // The interpreter rounds each printed coordinate: of the ends of a motion, and of the centre of an arc.
    let printed = 2.0 * if is_inch { 25.4 * 0.5e-4 } else { 0.5e-4 } * 3f64.sqrt();
    let mut figures = Figures { motions: motions.len(), ..Figures::default() };
    let mut steps = Reader::new(text, dialect, MISMATCH_LIMIT_MM);
    let mut runs = runs(motions).into_iter().peekable();
    while let Some(run) = runs.next() {
        let placed = steps
            .next()
            .ok_or("the control moves on after the end of the text")?
            .map_err(|error| error.to_string())?;
        let fault =
            |what: &str| format!("line {}: {what}: {:?} against {:?}", placed.line, placed.step, run.motion);
        let mut apart: f64 = 0.0;
        if let Step::Hole(hole) = &placed.step {
            figures.holes += 1;
            let found = hole::take(hole, run, &mut runs, printed)
                .map_err(|error| format!("line {}: {error}", placed.line))?;
            figures.to_text_mm = figures.to_text_mm.max(found);
            continue;
        }
        match (placed.step, run.motion) {
            (Step::Rapid { to, .. }, Motion::Rapid { to: reached }) => {
                for (wanted, reached) in to.into_iter().zip(reached.iter()) {
                    apart = apart.max((wanted.unwrap_or(*reached) - reached).abs());
                }
            }
            (Step::Dwell { seconds }, Motion::Dwell { seconds: waited }) => {
                if (seconds - waited).abs() > 1e-3 {
                    return Err(fault("another dwell"));
                }
            }
            (
                Step::Feed { along, rate, radius_mismatch_mm, center },
                Motion::Line { rate: run_rate, .. } | Motion::Arc { rate: run_rate, .. },
            ) => {
                let is_arc = matches!(run.motion, Motion::Arc { .. });
                if matches!(along, Curve::Arc(_)) != is_arc || matches!(along, Curve::Parabola(_)) {
                    return Err(fault("another kind"));
                }
                if (rate.mm_per_min() - run_rate).abs() > 1e-4 * 25.4 {
                    return Err(fault("another feed"));
                }
                figures.arcs += usize::from(is_arc);
                figures.mismatch_mm = figures.mismatch_mm.max(radius_mismatch_mm);
                let said = as_written(&along, center, rate);
                for k in 0..=SAMPLES {
                    let t = f64::from(k) / f64::from(SAMPLES);
                    apart = apart.max(nearest(&run.point_at(t), t, 0.1, apart, |t| said.point_at(t)));
                }
            }
            (
                Step::Feed { along: Curve::Parabola(said), rate, .. },
                Motion::Parabola { curve, rate: run_rate },
            ) => {
                figures.parabolas += 1;
                if (rate.mm_per_min() - run_rate).abs() > 1e-4 * 25.4 {
                    return Err(fault("another feed"));
                }
                let points = |p: &Parabola| [p.start(), p.control(), p.end()];
                for (p, q) in points(&said).iter().zip(points(&curve)) {
                    apart = apart.max((p - q).norm());
                }
                if apart > 1e-9 || (run.start - curve.start()).norm() > printed {
                    return Err(fault("another parabola"));
                }
            }
            _ => return Err(fault("another kind")),
        }
        if apart > printed {
            return Err(fault(&format!("{apart} mm apart")));
        }
        figures.to_text_mm = figures.to_text_mm.max(apart);
    }
    match steps.next() {
        None => Ok(figures),
        Some(_) => Err("the control ends before the end of the text".into()),
    }
}

/// Checks that the control's cutting motions lie along the moves of the toolpath, and the moves along the
/// motions.
pub fn with_toolpath(
    toolpath: &Toolpath,
    motions: &[Motion],
    resolution: Resolution,
    curves: &Curves,
) -> Result<Figures, String> {
    let is_inch = resolution.units == Units::Inch;
    let printed = if is_inch { 25.4 * 0.5e-4 } else { 0.5e-4 } * 3f64.sqrt();
    let limit = MAX_DISPLACEMENT_STEPS * resolution.step_mm() + if is_inch { 2.0 * printed } else { 0.0 };
    let runs = runs(motions);
    let mut cutting =
        runs.iter().filter(|run| !matches!(run.motion, Motion::Rapid { .. } | Motion::Dwell { .. }));
    let (mut apart, mut length, mut time) = (0f64, 0.0, 0.0);
    for step in toolpath.moves() {
        let Move::Feed { along, .. } = step else { continue };
        let count = quantize(along, resolution, curves).map_err(|error| error.to_string())?.len();
        let mine: Vec<&Run> = cutting.by_ref().take(count).collect();
        if mine.len() < count {
            return Err("the control cuts less".into());
        }
        let whole: f64 = mine.iter().map(|run| run.length_and_time().0).sum();
        let slip = 0.03 + 8.0 * resolution.step_mm() / whole;
        let mut from = 0.0;
        let mut spans = Vec::with_capacity(count);
        for run in mine {
            let (own_length, own_time) = run.length_and_time();
            (length, time) = (length + own_length, time + own_time);
            let share = own_length / whole;
            for k in 0..=SAMPLES {
                let t = f64::from(k) / f64::from(SAMPLES);
                let off = nearest(&run.point_at(t), from + share * t, slip, apart, |t| along.point_at(t));
                apart = apart.max(off);
            }
            spans.push((run, from, share));
            from += share;
        }
        for k in (0..=4 * SAMPLES).filter(|_| count > 0) {
            let t = f64::from(k) / f64::from(4 * SAMPLES);
            let p = along.point_at(t);
            let off = spans
                .iter()
                .filter(|(_, from, share)| (from - slip..=from + share + slip).contains(&t))
                .map(|(run, from, share)| {
                    nearest(&p, (t - from) / share, slip / share, apart, |t| run.point_at(t))
                })
                .fold(f64::INFINITY, f64::min);
            apart = apart.max(off);
        }
        if apart > limit {
            return Err(format!("{apart} mm from {along:?}"));
        }
    }
    if cutting.next().is_some() {
        return Err("the control cuts more".into());
    }
    let rapid = FeedRate::from_mm_per_min(1e4).ok_or("no feed")?;
    let measures = measure(toolpath, rapid);
    let lengths = (length / measures.cutting_length_mm - 1.0).abs();
    let times = (time / measures.cutting_time_s.ok_or("a move without a feed")? - 1.0).abs();
    if measures.cutting_length_mm > 1.0 && !(lengths <= AGREEMENT && times <= AGREEMENT) {
        return Err(format!("lengths differ by {lengths}, times by {times}"));
    }
    let (to_path_mm, to_path_inch_mm) = if is_inch { (0.0, apart) } else { (apart, 0.0) };
    Ok(Figures { to_path_mm, to_path_inch_mm, lengths, times, ..Figures::default() })
}

/// The distance from `p` to the curve `at(fraction)`, searched within `width` of the fraction `guess`, mm.
/// The search stops at `enough`, and the result is never below `enough`.
fn nearest(p: &Point3<f64>, guess: f64, width: f64, enough: f64, at: impl Fn(f64) -> Point3<f64>) -> f64 {
    let off = |t: f64| (p - at(t)).norm();
    let mut least = off(guess.clamp(0.0, 1.0));
    if least <= enough {
        return enough;
    }
    let (mut from, mut to) = ((guess - width).clamp(0.0, 1.0), (guess + width).clamp(0.0, 1.0));
    least = least.min(off(from)).min(off(to));
    while to - from > 1e-8 && least > enough {
        let (a, b) = (from + 0.382 * (to - from), from + 0.618 * (to - from));
        let (off_a, off_b) = (off(a), off(b));
        if off_a < off_b {
            to = b
        } else {
            from = a
        }
        least = least.min(off_a).min(off_b);
    }
    least.max(enough)
}
