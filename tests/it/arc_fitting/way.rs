//! Lines and arcs by plain geometry: an arc is a centre, a start angle and a sweep. The fit computes arcs in
//! another way.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector2;

/// The largest sweep of an arc, radians.
pub const WIDEST: f64 = 350.0 / 180.0 * PI;

/// Allowance for rounding in the angle of half a turn, radians.
const HALF_A_TURN: f64 = 1e-9;

#[derive(Debug, Clone, Copy)]
pub enum Way {
    Line { from: Vector2<f64>, to: Vector2<f64> },
    Arc { center: Vector2<f64>, radius: f64, start: f64, sweep: f64, ends: [Vector2<f64>; 2] },
}

impl Way {
    pub fn line(from: Vector2<f64>, to: Vector2<f64>) -> Self {
        Self::Line { from, to }
    }

    /// The arc between two places that turns by `sweep` radians; a positive sweep turns counterclockwise.
    pub fn arc(from: Vector2<f64>, to: Vector2<f64>, sweep: f64) -> Self {
        let half = 0.5 * (to - from);
        let center = from + half + Vector2::new(-half.y, half.x) / (0.5 * sweep).tan();
        let d = from - center;
        Self::Arc { center, radius: d.norm(), start: d.y.atan2(d.x), sweep, ends: [from, to] }
    }

    /// The full circle about `center` that starts and ends at `from`.
    pub fn turn(center: Vector2<f64>, from: Vector2<f64>, is_ccw: bool) -> Self {
        let d = from - center;
        let sweep = if is_ccw { TAU } else { -TAU };
        Self::Arc { center, radius: d.norm(), start: d.y.atan2(d.x), sweep, ends: [from, from] }
    }

    pub fn length(&self) -> f64 {
        match self {
            Self::Line { from, to } => (to - from).norm(),
            Self::Arc { radius, sweep, .. } => radius * sweep.abs(),
        }
    }

    /// The place at the distance `s` (mm) along the way.
    pub fn at(&self, s: f64) -> Vector2<f64> {
        match *self {
            Self::Line { from, to } => from + (to - from).normalize() * s,
            Self::Arc { center, radius, start, sweep, .. } => {
                let angle = start + sweep.signum() * s / radius;
                center + Vector2::new(angle.cos(), angle.sin()) * radius
            }
        }
    }

    /// The direction of motion at the distance `s` (mm) along the way.
    pub fn direction(&self, s: f64) -> Vector2<f64> {
        match *self {
            Self::Line { from, to } => (to - from).normalize(),
            Self::Arc { center, sweep, .. } => {
                let spoke = self.at(s) - center;
                Vector2::new(-spoke.y, spoke.x).normalize() * sweep.signum()
            }
        }
    }

    pub fn distance(&self, p: Vector2<f64>) -> f64 {
        match *self {
            Self::Line { from, to } => {
                let along = to - from;
                let foot = ((p - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
                (p - from - along * foot).norm()
            }
            Self::Arc { center, radius, sweep, ends, .. } => {
                if self.turned(p) <= sweep.abs() {
                    ((p - center).norm() - radius).abs()
                } else {
                    (p - ends[0]).norm().min((p - ends[1]).norm())
                }
            }
        }
    }

    /// The angle from the start of an arc to the place on its circle that is nearest to `p`, in the direction
    /// of the arc, in [0, 2 pi). The place may lie beyond the end of the arc. 0 for a line.
    fn turned(&self, p: Vector2<f64>) -> f64 {
        let Self::Arc { center, start, sweep, .. } = *self else { return 0.0 };
        let d = p - center;
        let angle = sweep.signum() * (d.y.atan2(d.x) - start);
        if angle < 0.0 { angle + TAU } else { angle }
    }

    /// The first place at or after `reached` that is within `e` of `p`, as a distance along the way. `None`
    /// if there is no such place.
    fn first_near(&self, p: Vector2<f64>, e: f64, reached: f64) -> Option<f64> {
        if (self.at(reached) - p).norm() <= e {
            return Some(reached);
        }
        // The place `reached` is too far from `p`. The next places near `p` lie on both sides of the foot, up
        // to `half` away.
        let (foot, half) = match *self {
            Self::Line { from, to } => {
                let along = (to - from).normalize();
                let (foot, beside) = ((p - from).dot(&along), (p - from).perp(&along));
                (foot, (e * e - beside * beside).max(0.0).sqrt())
            }
            Self::Arc { center, radius, .. } => {
                let d = (p - center).norm();
                let square = (e - d + radius) * (e + d - radius) / (4.0 * radius * d);
                let foot = self.turned(p) * radius;
                (
                    if foot < reached { foot + TAU * radius } else { foot },
                    2.0 * radius * square.clamp(0.0, 1.0).sqrt().asin(),
                )
            }
        };
        let first = (foot - half).max(reached);
        let nearest = foot.min(self.length());
        let is_near = foot >= reached && first <= self.length() && (self.at(nearest) - p).norm() <= e;
        is_near.then_some(first)
    }

    /// Whether the lines between the points turn about the centre of an arc as far as the arc, give or take
    /// half a turn. True for a line.
    pub fn winds(&self, points: &[Vector2<f64>]) -> bool {
        let Self::Arc { center, sweep, .. } = *self else { return true };
        let turned = points.windows(2).map(|pair| {
            let [a, b] = [pair[0] - center, pair[1] - center];
            let turned = sweep.signum() * a.perp(&b).atan2(a.dot(&b));
            // Rounding may give half a turn either sign; it counts in the direction of the arc.
            if turned < HALF_A_TURN - PI { turned + TAU } else { turned }
        });
        (turned.sum::<f64>() - sweep.abs()).abs() < PI
    }

    /// How far the lines between points lie inside the circle of an arc at most, mm. 0 for a line.
    pub fn dip(&self, points: &[Vector2<f64>]) -> f64 {
        let Self::Arc { center, radius, .. } = *self else { return 0.0 };
        let inside = points.windows(2).map(|pair| radius - Self::line(pair[0], pair[1]).distance(center));
        inside.fold(0.0, f64::max)
    }

    /// Whether the way passes the points in order: each point has a place on the way within `e`, and these
    /// places never go back.
    pub fn passes(&self, points: &[Vector2<f64>], e: f64) -> bool {
        let mut reached = 0.0;
        points.iter().all(|p| match self.first_near(*p, e, reached) {
            Some(s) => {
                reached = s;
                true
            }
            None => false,
        })
    }
}

/// The least distance within which the way passes all points in order, accurate to some 1e-10 of the points'
/// extent. It is infinite for an arc that leads round the other way.
pub fn order_deviation(way: &Way, points: &[Vector2<f64>]) -> f64 {
    if !way.winds(points) {
        return f64::INFINITY;
    }
    let least = points.iter().map(|p| way.distance(*p)).fold(0.0, f64::max);
    // The farthest point has only one place within `least`, and rounding may move this place.
    let slack = 1e-11 * (way.length() + least);
    if way.passes(points, least + slack) {
        return least;
    }
    let (mut low, mut high) = (least, least + way.length());
    for _ in 0..36 {
        let middle = 0.5 * (low + high);
        (low, high) = if way.passes(points, middle) { (low, middle) } else { (middle, high) };
    }
    high
}
