//! The motion along rails at a constant feed, and samples of it.
//!
//! The tip moves at the feed. Where the tip rests and the axis turns, the top of the tool moves at the feed.
//!
//! # Cost
//! O(n + m) for n spans and m samples.

use super::rail::{Piece, Point6, Rail, Span, tip, top};
use crate::budget::{Budget, Stopped};

/// Nodes and weights of Gauss and Legendre's rule with eight points on the range from -1 to 1. It integrates
/// polynomials up to degree 15 exactly.
const GAUSS: [[f64; 2]; 4] = [
    [0.183_434_642_495_649_8, 0.362_683_783_378_362],
    [0.525_532_409_916_329, 0.313_706_645_877_887_3],
    [0.796_666_477_413_626_7, 0.222_381_034_453_374_48],
    [0.960_289_856_497_536_3, 0.101_228_536_290_376_26],
];

/// Newton steps to the parameter at a time; the speed hardly changes along a span, so two or three do.
const STEPS: usize = 30;

/// The largest last Newton step to a parameter, as a part of its span. Smaller steps are rounding of the way.
const LAST_STEP: f64 = 1e-13;

/// The part by which a duration is shortened before its periods are counted. It is above rounding, so that
/// a duration of whole periods has one sample at its end and not two.
const ROUNDING: f64 = 1e-12;

/// Samples between two checks of the budget.
const BETWEEN_CHECKS: usize = 1024;

/// A place on the rails at a time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    pub t_s: f64,
    /// The piece, and the parameter in it.
    pub piece: usize,
    pub u: f64,
    pub at: Point6,
}

/// The motion at a constant feed.
pub struct ConstantFeed<'a> {
    spans: Vec<Paced<'a>>,
    /// The time at the end of each span, s.
    ends: Vec<f64>,
}

/// A span with its feed; whether the tip rests.
struct Paced<'a> {
    piece: usize,
    span: &'a Span,
    feed_mm_per_s: f64,
    rests: bool,
}

impl<'a> ConstantFeed<'a> {
    pub fn new(rail: &'a Rail) -> Self {
        let paced = |(k, piece): (usize, &'a Piece)| {
            let rests = piece.rests();
            let feeds = piece.feeds.iter();
            let spans = piece.spans.iter().zip(feeds);
            spans.map(move |(span, feed)| Paced { piece: k, span, feed_mm_per_s: *feed, rests })
        };
        let spans: Vec<Paced> = rail.pieces.iter().enumerate().flat_map(paced).collect();
        let mut time = 0.0;
        let ends = spans.iter().map(|paced| {
            time += way(paced.span, paced.rests, paced.span.to) / paced.feed_mm_per_s;
            time
        });
        let ends = ends.collect();
        Self { spans, ends }
    }

    pub fn duration_s(&self) -> f64 {
        self.ends.last().copied().unwrap_or(0.0)
    }

    /// The time at a parameter of a span, which counts over all pieces, s.
    pub fn time_at(&self, k: usize, u: f64) -> f64 {
        let begins = if k == 0 { 0.0 } else { self.ends[k - 1] };
        let Paced { span, feed_mm_per_s, rests, .. } = &self.spans[k];
        if u == span.to { self.ends[k] } else { begins + way(span, *rests, u) / feed_mm_per_s }
    }

    /// The length of the tip's way, mm.
    pub fn length_mm(&self) -> f64 {
        self.spans
            .iter()
            .filter(|paced| !paced.rests)
            .map(|Paced { span, .. }| way(span, false, span.to))
            .sum()
    }

    /// Places at times that are `period_s` apart, and the end. The last step may be shorter.
    pub fn samples(&self, period_s: f64, budget: &Budget) -> Result<Vec<Sample>, Stopped> {
        let duration = self.duration_s();
        let count = (duration / period_s * (1.0 - ROUNDING)).floor() as usize;
        let mut samples = Vec::with_capacity(count + 2);
        let mut k = 0;
        for n in 0..=count {
            if n.is_multiple_of(BETWEEN_CHECKS) {
                budget.check()?;
            }
            let t_s = n as f64 * period_s;
            while k + 1 < self.ends.len() && self.ends[k] <= t_s {
                k += 1;
            }
            let begins = if k == 0 { 0.0 } else { self.ends[k - 1] };
            let &Paced { piece, span, feed_mm_per_s, rests } = &self.spans[k];
            let u = parameter(span, rests, (t_s - begins) * feed_mm_per_s);
            samples.push(Sample { t_s, piece, u, at: span.jet(u)[0] });
        }
        if let Some(&Paced { piece, span, .. }) = self.spans.last() {
            samples.push(Sample { t_s: duration, piece, u: span.to, at: span.end() });
        }
        Ok(samples)
    }
}

fn speed(span: &Span, rests: bool, u: f64) -> f64 {
    let [_, first, ..] = span.jet(u);
    if rests { top(&first).norm() } else { tip(&first).norm() }
}

/// The way of the tip, or of the top where the tip rests, from the start of a span to a parameter, mm.
fn way(span: &Span, rests: bool, to: f64) -> f64 {
    let half = 0.5 * (to - span.from);
    let middle = 0.5 * (to + span.from);
    let sum = GAUSS.iter().map(|[node, weight]| {
        weight * (speed(span, rests, middle - half * node) + speed(span, rests, middle + half * node))
    });
    half * sum.sum::<f64>()
}

/// The parameter at which the way from the start of a span is `wanted` mm.
fn parameter(span: &Span, rests: bool, wanted: f64) -> f64 {
    let (mut low, mut high) = (span.from, span.to);
    let mut u = span.from + wanted / speed(span, rests, span.from).max(f64::MIN_POSITIVE);
    for _ in 0..STEPS {
        if !(low..=high).contains(&u) {
            u = 0.5 * (low + high);
        }
        let excess = way(span, rests, u) - wanted;
        if excess > 0.0 {
            high = u
        } else {
            low = u
        }
        let step = excess / speed(span, rests, u);
        if step.abs() <= LAST_STEP * (span.to - span.from) || high - low <= f64::EPSILON * span.to.abs() {
            break;
        }
        u -= step;
    }
    u.clamp(span.from, span.to)
}

/// A figure of the tip over the whole motion.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(feature = "wire", derive(serde::Serialize, utoipa::ToSchema))]
pub struct Peaks {
    /// Root of the mean square, in mm/s, mm/s2 or mm/s3.
    pub rms: f64,
    /// Largest value, in mm/s, mm/s2 or mm/s3.
    pub max: f64,
}

/// The rates by time of values that are all `period_s` apart.
pub fn differences(rows: &[nalgebra::Vector3<f64>], period_s: f64) -> Vec<nalgebra::Vector3<f64>> {
    rows.windows(2).map(|pair| (pair[1] - pair[0]) / period_s).collect()
}

/// Speed, acceleration and jerk of the tip, by differences of samples that are all `period_s` apart: mm/s,
/// mm/s2 and mm/s3.
pub fn peaks(tips: &[nalgebra::Vector3<f64>], period_s: f64) -> [Peaks; 3] {
    let mut rows = tips.to_vec();
    [(); 3].map(|()| {
        rows = differences(&rows, period_s);
        let squares: f64 = rows.iter().map(nalgebra::Vector3::norm_squared).sum();
        let rms = if rows.is_empty() { 0.0 } else { (squares / rows.len() as f64).sqrt() };
        Peaks { rms, max: rows.iter().map(nalgebra::Vector3::norm).fold(0.0, f64::max) }
    })
}
