//! Proves that no line or arc from a given start S can pass all points up to some point of a sequence.
//!
//! A line or an arc from S lies on a circle through S; a line counts as a circle. Each point that has to be
//! passed excludes the circles that do not come within the tolerance of the point. When the points up to and
//! including some point have excluded all circles, every line or arc from S ends before that point.
//!
//! # Method
//! 1. About each point lies a disc with the tolerance as its radius. Discs that contain S exclude no circle
//!    and are skipped. An inversion about S turns every other disc into a disc, and each circle through S
//!    into a line. A circle is possible if its line meets the discs of all points.
//! 2. Two discs that are far apart fix a frame of coordinates in which every line that meets both is
//!    y = m x + t with a small slope m. The line is written as the point (m, t) of a second plane. If the
//!    centre of a further disc has the first coordinate x, the lines that meet the disc have m x + t between
//!    two bounds, which hold for all possible slopes.
//! 3. The possible points (m, t) form a convex polygon. Each new disc cuts it with its two bounds. When the
//!    polygon is empty, no circle is possible.
//!
//! # Cost
//! O(v) for each point, where v is the number of corners of the polygon.

use nalgebra::Vector2;

use super::Shapes;
use super::candidate::Rule;

/// Points taken one by one before every second, every third and so on is enough: neighbours exclude much the
/// same circles.
const DENSE: usize = 24;

/// The largest sine by which the lines of a frame may lean (`WIDEST`). A pair of discs replaces the frame if
/// its sine is smaller by the factor `BETTER`.
const WIDEST: f64 = 0.5;
const BETTER: f64 = 0.5;

/// Points before the first frame is tried. Once there is a frame, the next one is tried when the number of
/// points has doubled.
const FIRST_FRAME: usize = 4;

/// A disc cuts the polygon only if the cut is deeper than this part of the strip's half width: more corners
/// cost more time than they exclude.
const SLIVER: f64 = 0.04;

/// Allowance for rounding, as a part of the numbers compared.
const ROUNDING: f64 = 1e-9;

/// The circles through `from` within the tolerance of all points taken so far.
pub struct Fan {
    from: Vector2<f64>,
    tolerance: f64,
    shapes: Shapes,
    discs: Vec<Disc>,
    next_frame: usize,
    frame: Option<Frame>,
    /// The corners (m, t) of the polygon, in order.
    polygon: Vec<Vector2<f64>>,
    spare: Vec<Vector2<f64>>,
}

/// A disc after the inversion, which moves the end of each vector d from the place to d / |d|^2. The disc of
/// the tolerance e about the point at d becomes the disc with the centre d / (|d|^2 - e^2) and the radius e /
/// (|d|^2 - e^2).
#[derive(Debug, Clone, Copy)]
struct Disc {
    center: Vector2<f64>,
    radius: f64,
}

/// How far above `c` the line (m, t) passes.
fn height_over(line: &Vector2<f64>, c: Vector2<f64>) -> f64 {
    line.x * c.x + line.y - c.y
}

/// Coordinates along the line through the centres of two discs that are far apart compared with their radii.
/// Lines that meet both discs are y = m x + t with a small slope m. Without a frame, no circle is excluded.
#[derive(Debug, Clone, Copy)]
struct Frame {
    origin: Vector2<f64>,
    along: Vector2<f64>,
    /// The largest sine by which lines lean.
    sine: f64,
    /// The square root of 1 + m^2 for the largest slope m.
    stretch: f64,
}

impl Frame {
    fn local(&self, c: Vector2<f64>) -> Vector2<f64> {
        let d = c - self.origin;
        Vector2::new(self.along.dot(&d), self.along.perp(&d))
    }
}

impl Fan {
    pub fn new(rule: &Rule) -> Self {
        Self {
            from: Vector2::zeros(),
            tolerance: rule.tolerance_mm,
            shapes: rule.shapes,
            discs: Vec::new(),
            next_frame: FIRST_FRAME,
            frame: None,
            polygon: Vec::new(),
            spare: Vec::new(),
        }
    }

    /// The points after `first` that the fan has to take.
    pub fn worth(first: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(Some(first + 1), move |k| Some(k + 1 + (k - first) / DENSE))
    }

    /// Starts again with all circles through `from`.
    pub fn restart(&mut self, from: Vector2<f64>) {
        self.from = from;
        self.discs.clear();
        self.next_frame = FIRST_FRAME;
        self.frame = None;
    }

    /// Whether a circle of the set may pass through `p`.
    pub fn admits(&self, p: Vector2<f64>) -> bool {
        let (Some(frame), d) = (self.frame, p - self.from) else { return true };
        let c = frame.local(d / d.norm_squared());
        let slack = ROUNDING * (c.x.abs() + c.y.abs());
        let [least, most] = self.heights_over(c);
        least <= slack && most >= -slack
    }

    /// The least and the largest height over `c` of the lines in the polygon.
    fn heights_over(&self, c: Vector2<f64>) -> [f64; 2] {
        let heights = self.polygon.iter().map(|corner| height_over(corner, c));
        heights.fold([f64::INFINITY, f64::NEG_INFINITY], |[least, most], height| {
            [least.min(height), most.max(height)]
        })
    }

    /// Keeps the circles that pass within the tolerance of `p`; `false` if no circle is left.
    pub fn take(&mut self, p: Vector2<f64>) -> bool {
        let d = p - self.from;
        let power = d.norm_squared() - self.tolerance * self.tolerance;
        if power <= 0.0 {
            return true;
        }
        let disc = Disc { center: d / power, radius: self.tolerance / power };
        self.discs.push(disc);
        if self.discs.len() == self.next_frame {
            let is_better = self.turn_frame();
            self.next_frame += if self.frame.is_none() { FIRST_FRAME } else { self.discs.len() };
            if is_better {
                // A line of the plane becomes a line through the origin, which is the image of infinity.
                let far = Disc { center: Vector2::zeros(), radius: ROUNDING * disc.center.norm() };
                return (self.shapes == Shapes::ArcsAndLines || self.clip(far))
                    && (0..self.discs.len()).all(|k| self.clip(self.discs[k]));
            }
        }
        self.frame.is_none() || self.clip(disc)
    }

    /// Makes a frame of the last disc and the one halfway, if that frame is better; the polygon then starts
    /// again. Returns whether it did. For n points, that happens O(log n) times.
    fn turn_frame(&mut self) -> bool {
        let [a, b] = [self.discs[self.discs.len() / 2], self.discs[self.discs.len() - 1]];
        let apart = b.center - a.center;
        let sine = (a.radius + b.radius) / apart.norm();
        // NaN if the discs coincide.
        let is_better = sine < self.frame.map_or(WIDEST, |frame| BETTER * frame.sine);
        if !is_better {
            return false;
        }
        let slope = sine / (1.0 - sine * sine).sqrt();
        let stretch = (1.0 + slope * slope).sqrt() * (1.0 + ROUNDING);
        self.frame = Some(Frame { origin: a.center, along: apart.normalize(), sine, stretch });
        let height = a.radius * stretch;
        self.polygon.clear();
        self.polygon.extend(
            [(-slope, -height), (slope, -height), (slope, height), (-slope, height)]
                .map(|(m, t)| Vector2::new(m, t)),
        );
        true
    }

    /// Cuts off the lines that miss a disc; `false` if no line is left. The line (m, t) meets the disc with
    /// the centre (x, y) and the radius r if |y - m x - t| <= r sqrt(1 + m^2). The largest possible slope
    /// replaces m under the root.
    fn clip(&mut self, disc: Disc) -> bool {
        let Some(frame) = self.frame else { return true };
        let c = frame.local(disc.center);
        let half_width = disc.radius * frame.stretch + ROUNDING * disc.radius;
        let [least, most] = self.heights_over(c);
        for (side, farthest) in [(1.0, most), (-1.0, -least)] {
            let over = |corner: &Vector2<f64>| side * height_over(corner, c) - half_width;
            if farthest <= (1.0 + SLIVER) * half_width {
                continue;
            }
            self.spare.clear();
            for (k, corner) in self.polygon.iter().enumerate() {
                let next = self.polygon[(k + 1) % self.polygon.len()];
                let (here, there) = (over(corner), over(&next));
                if here <= 0.0 {
                    self.spare.push(*corner);
                }
                if (here < 0.0) != (there < 0.0) && here != 0.0 && there != 0.0 {
                    self.spare.push(corner + (next - corner) * (here / (here - there)));
                }
            }
            std::mem::swap(&mut self.polygon, &mut self.spare);
            if self.polygon.is_empty() {
                return false;
            }
        }
        true
    }
}
